# SPDX-License-Identifier: GPL-3.0-or-later
"""Stops, plays and cables of a truss as monotone polylines of force over position.

About the equilibrium without friction, with the tangents in K taken off, part l adds the force h_l at the position
z_l = z0 + r_l · q:

    z = z0 − Z λ − A h,   (z_l, h_l) on a polyline of its own

For every λ there is exactly one state, because the energy is convex.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

import numpy as np

from statejump.kinds.truss.bounds.sliding import Sliding
from statejump.kinds.truss.joints import JOINTS

AT_STOP = 1e-9  # distance to a stop over the slide or the clearance that counts as contact
MOST_CHANGES = 400  # of branches until a state is found
ROUNDED = 1e-11


@dataclass(frozen=True)
class Part:
    """A stop, play or cable.

    :param name: in messages
    :param row: r (dofs,)
    :param position_m: z0
    :param points: corners (k, 2) of the polyline (z, h), from the lowest; the first and the last segment are artificial
        ends of unlimited branches
    :param ends: unit directions of the first and the last branch, (2, 2)
    """

    name: str
    row: np.ndarray
    position_m: float
    points: np.ndarray
    ends: np.ndarray


def parts_of(of: Sliding) -> list[Part]:
    """Return the stops, plays and cables of a truss."""
    return [*_stops(of), *_plays(of), *_cables(of)]


def _part(name: str, row: np.ndarray, position: float, corners: list[tuple[float, float]], slopes: list[float],
          tangent: float) -> Part:
    """Return a part with forces g(z) at corners and slopes between and beyond them, less its tangent in K.

    ``slopes`` has the first branch, then the last one; inf: a rigid stop.
    """
    points = np.array(corners, dtype=float)
    ends = np.array([(-1.0, -slopes[0]) if np.isfinite(slopes[0]) else (0.0, -1.0),
                     (1.0, slopes[1]) if np.isfinite(slopes[1]) else (0.0, 1.0)])
    # h = g(z) − g(z0) − tangent (z − z0); g(z0) is such that h(z0) = 0, see the callers.
    points[:, 1] -= tangent * (points[:, 0] - position)
    ends[:, 1] -= tangent * ends[:, 0]
    return Part(name, row, position, points, ends)


def _stops(of: Sliding) -> Iterator[Part]:
    sliders = of.truss.sliders
    which = [index for index, joint in enumerate(of.joints) if joint.section == "slider"]
    # A rigid stop that is closed in the equilibrium carries the load of the joint.
    slides = of.slide_m[which]
    near = AT_STOP * np.maximum(np.abs(slides), 1e-12)
    closed = np.flatnonzero(np.isinf(sliders.stop_stiffness_N_per_m) & sliders.have_stops & (
        (np.abs(slides + sliders.clearance_minus_m) <= near) | (np.abs(slides - sliders.clearance_plus_m) <= near)))
    carried = dict(zip(closed, of.carried_N([which[number] for number in closed]))) if len(closed) else {}
    for number in np.flatnonzero(sliders.have_stops):
        joint = which[number]
        slide, row = float(of.slide_m[joint]), np.asarray(of.slides[joint].toarray()[0])
        minus, plus = -sliders.clearance_minus_m[number], sliders.clearance_plus_m[number]
        stiffness = float(sliders.stop_stiffness_N_per_m[number])
        beyond = slide - min(max(slide, minus), plus)
        base = float(carried.get(number, 0.0)) if np.isinf(stiffness) else stiffness * beyond
        tangent = stiffness if np.isfinite(stiffness) and beyond != 0 else 0.0
        corners = [(edge, -base) for edge in (minus, plus) if np.isfinite(edge)]
        slopes = [stiffness if np.isfinite(minus) else 0.0, stiffness if np.isfinite(plus) else 0.0]
        yield _part(f"stop of {of.joints[joint]}", row, slide, corners, slopes, tangent)


def _plays(of: Sliding) -> Iterator[Part]:
    for section in (joint.section for joint in JOINTS if joint.turns):
        which = [index for index, joint in enumerate(of.joints) if joint.section == section]
        hinges = of.truss.joints[section]
        for number, joint in enumerate(which):
            edge, stiffness = float(hinges.deadband_rad[number]), float(hinges.stiffness_N_m_per_rad[number])
            if edge <= 0 or stiffness <= 0:
                continue
            radius, slide = float(of.radius_m[joint]), float(of.slide_m[joint])
            edge, stiffness = radius * edge, stiffness / radius**2
            beyond = slide - min(max(slide, -edge), edge)
            row = np.asarray(of.slides[joint].toarray()[0])
            corners = [(-edge, -stiffness * beyond), (edge, -stiffness * beyond)]
            yield _part(f"play of {of.joints[joint]}", row, slide, corners, [stiffness, stiffness],
                        stiffness if beyond != 0 else 0.0)


def _cables(of: Sliding) -> Iterator[Part]:
    springs, place = of.truss.springs, of.truss.nodes.position_m + of.displacement_m
    for number in np.flatnonzero(springs.cable):
        first, second = springs.nodes[number]
        span = place[second] - place[first]
        length = float(np.linalg.norm(span))
        row = np.asarray((of.of_nodes[3 * second:3 * second + 3] - of.of_nodes[3 * first:3 * first + 3]).T
                         @ (span / length))
        stiffness, stretch = float(springs.stiffness_N_per_m[number]), length - float(springs.free_length_m[number])
        force = stiffness * max(0.0, stretch)
        yield _part(f"cable '{springs.names[number]}'", row, stretch, [(0.0, -force)], [0.0, stiffness],
                    stiffness if stretch > 0 else 0.0)


@dataclass(frozen=True)
class Branches:
    """The reduced equations z = z0 − Z λ − A h, e = −(G λ + H h).

    :param by_friction: Z (parts, joints); ``compliance``: A (parts, parts)
    :param limit_N: f of all joints, then bounds of further forces
    """

    parts: list[Part]
    position_m: np.ndarray
    by_friction: np.ndarray
    compliance: np.ndarray
    limit_N: np.ndarray

    def state(self, friction_N: np.ndarray) -> np.ndarray | None:
        """Return the forces h of the state with given friction; None: not found."""
        free = self.position_m - self.by_friction @ friction_N
        branch = np.array([int((part.points[:, 0] < part.position_m).sum()) for part in self.parts])
        for change in range(MOST_CHANGES):
            force, position, wrong = self._at(free, branch)
            if not wrong.any():
                return force
            # All at once, then one after another: a P-matrix has no cycle of single changes.
            which = np.flatnonzero(wrong) if change < MOST_CHANGES // 4 else np.flatnonzero(wrong)[:1]
            branch[which] += wrong[which]
        return None

    def _at(self, free: np.ndarray, branch: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return h, z and the changes of branches that their ends require, if each part is on a branch."""
        count = len(self.parts)
        start, way = np.empty((count, 2)), np.empty((count, 2))
        length = np.empty(count)
        for index, (part, at) in enumerate(zip(self.parts, branch)):
            last = len(part.points)
            start[index] = part.points[max(at - 1, 0)]
            way[index] = (-part.ends[0] if at == 0 else part.ends[1] if at == last
                          else part.points[at] - part.points[at - 1])
            length[index] = inf if at in (0, last) else 1.0
        # (z, h) = start + t way; on the first branch t <= 0.
        matrix = np.diag(way[:, 0]) + self.compliance * way[:, 1]
        t = np.linalg.solve(matrix, free - start[:, 0] - self.compliance @ start[:, 1])
        found = start + t[:, None] * way
        # Rounding of a position, or, on vertical branches, of a force.
        tiny = np.where(way[:, 0] != 0, ROUNDED * np.abs(self.position_m).max(initial=1e-6) / np.maximum(
            np.abs(way[:, 0]), 1e-300), ROUNDED * self.limit_N.max(initial=1e-300) / np.abs(way[:, 1]).clip(1e-300))
        first = branch == 0
        wrong = np.where(first, np.where(t > tiny, 1, 0), np.where(t < -tiny, -1, np.where(t > length + tiny, 1, 0)))
        return found[:, 1], found[:, 0], wrong
