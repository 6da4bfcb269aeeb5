# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of trusses whose stops, plays or cables change their state: linear programs and branch and bound.

Variables: λ/f of all joints, and h of every part within its range. Rows: the convex hull of the polyline of every part.
Ranges are first assumed. They are valid if the programs leave every assumed end slack, because the rest states are
connected.
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from heapq import heappop, heappush
from itertools import count as numbers

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.kinds.truss.bounds.branches import Branches, Part
from statejump.kinds.truss.bounds.programs import Polytope, Solved

FACTORS = (3.0, 1.5, 10.0, 100.0)  # on the ranges without stops, for assumed ranges
ROUNDS = 8  # of tightening
ENOUGH = 0.98  # of ranges, above which another round is not worth its time
SLACK = 1e-3  # of an assumed range that must stay free
NODES = 300  # of branch and bound
GAP = 1e-6  # of the bound at which branch and bound ends
MOST_PARTS = 40  # of branch and bound
NONE = -1e250  # value of a state that was not sought
FLIPS = 3  # sweeps over the joints in the search for states


def clipped(part: Part, low: float, high: float, least: float, most: float) -> np.ndarray:
    """Return the corners (k, 2) of the polyline of a part within ranges of z and h."""
    first, last = part.points[0], part.points[-1]
    far = 2 * (abs(high - low) + abs(most - least) + np.abs(part.points).max() + 1.0)
    points = np.vstack((first + far * part.ends[0], part.points, last + far * part.ends[1]))
    for axis, end, side in ((0, low, 1.0), (0, high, -1.0), (1, least, 1.0), (1, most, -1.0)):
        inside = side * (points[:, axis] - end) >= 0
        made: list[np.ndarray] = []
        for index, point in enumerate(points):
            if index and inside[index] != inside[index - 1]:
                before = points[index - 1]
                share = (end - before[axis]) / (point[axis] - before[axis])
                made.append(before + share * (point - before))
            if inside[index]:
                made.append(point)
        if not made:
            return np.zeros((0, 2))
        points = np.array(made)
    return points


def hull(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return rows (k, 2) and right-hand sides of the convex hull, row · (z, h) <= right."""
    return _hull(tuple(map(tuple, points.tolist())))


@lru_cache(1024)
def _hull(corners: tuple[tuple[float, ...], ...]) -> tuple[np.ndarray, np.ndarray]:
    points = np.array(corners)
    size = np.ptp(points, axis=0)
    scale = np.where(size > 0, size, 1.0)
    unit = (points - points[0]) / scale
    rows, right = [], []
    for i, one in enumerate(unit):
        for other in unit[i + 1:]:
            normal = np.array([one[1] - other[1], other[0] - one[0]])
            length = np.linalg.norm(normal)
            if length < 1e-12:
                continue
            for side in (1.0, -1.0):
                way = side * normal / length
                if np.all(unit @ way <= unit[i] @ way + 1e-12):
                    rows.append(way / scale)
                    right.append(float((way / scale) @ points[0] + (unit @ way).max()))
    for axis in range(2):
        for side in (1.0, -1.0):
            rows.append(side * np.eye(2)[axis])
            right.append(float((side * points[:, axis]).max()))
    return np.array(rows), np.array(right)


@dataclass(frozen=True)
class Box:
    """Ranges of z and h of every part."""

    low: np.ndarray
    high: np.ndarray
    least: np.ndarray
    most: np.ndarray

    def lines(self, of: Branches) -> list[np.ndarray]:
        """Return the corners of all polylines within the box."""
        return [clipped(part, self.low[index], self.high[index], self.least[index], self.most[index])
                for index, part in enumerate(of.parts)]


@dataclass(frozen=True)
class Rows:
    """Further rows of the programs: least <= by_friction λ + by_force h <= most."""

    by_friction: np.ndarray
    by_force: np.ndarray
    least: np.ndarray
    most: np.ndarray


class Programs:
    """The programs on polylines, given by their corners."""

    def __init__(self, of: Branches, lines: list[np.ndarray], more: Rows | None = None) -> None:
        self.of, self.points = of, lines
        self.empty = any(len(points) == 0 for points in self.points)
        if self.empty:
            return
        joints, parts = len(of.limit_N), len(of.parts)
        least = np.array([points[:, 1].min() for points in self.points])
        most = np.array([points[:, 1].max() for points in self.points])
        self.middle, self.half = 0.5 * (least + most), 0.5 * (most - least)
        # z by the variables.
        self.by_variable = -np.hstack((of.by_friction * of.limit_N, of.compliance * self.half))
        self.centre = of.position_m - of.compliance @ self.middle
        rows, right = [], []
        for index, points in enumerate(self.points):
            force = np.zeros(joints + parts)
            force[joints + index] = self.half[index]
            for (along_z, along_h), most_ in zip(*hull(points)):
                rows.append(along_z * self.by_variable[index] + along_h * force)
                right.append(most_ - along_z * self.centre[index] - along_h * self.middle[index])
        bounds = np.concatenate((np.ones(joints), (self.half > 0).astype(float)))
        found = Polytope(np.array(rows), np.full(len(rows), -np.inf), np.array(right), -bounds, bounds)
        self.polytope = found if more is None else self._with(found, more)

    def _with(self, found: Polytope, more: Rows) -> Polytope:
        shift = more.by_force @ self.middle
        made = np.hstack((more.by_friction * self.of.limit_N, more.by_force * self.half))
        return Polytope(np.vstack((found.rows, made)), np.append(found.least, more.least - shift),
                        np.append(found.most, more.most - shift), found.lowest, found.highest)

    def solved(self, friction: np.ndarray, force: np.ndarray) -> Solved:
        """Return the bound of friction · λ + force · h."""
        found = self.polytope.solved(np.concatenate((friction * self.of.limit_N, force * self.half)))
        return Solved(found.bound + float(force @ self.middle), found.x, found.dual)

    def narrower(self, box: Box) -> Box:
        """Return the ranges of z and h by the programs."""
        joints, ends = len(self.of.limit_N), []
        for index in range(len(self.of.parts)):
            for sign in (-1.0, 1.0):
                ends.append(sign * self.polytope.highest_value(sign * self.by_variable[index]) + self.centre[index])
            unit = np.zeros(joints + len(self.of.parts))
            unit[joints + index] = self.half[index]
            for sign in (-1.0, 1.0):
                ends.append(sign * self.polytope.highest_value(sign * unit) + self.middle[index])
        found = np.array(ends).reshape(-1, 4)
        # Rounding of the programs.
        found[:, [0, 2]] -= 1e-9 * np.abs(found[:, [0, 2]])
        found[:, [1, 3]] += 1e-9 * np.abs(found[:, [1, 3]])
        return Box(np.maximum(box.low, found[:, 0]), np.minimum(box.high, found[:, 1]),
                   np.maximum(box.least, found[:, 2]), np.minimum(box.most, found[:, 3]))


def valid_box(of: Branches, name: str) -> Box:
    """Return ranges of z and h that hold in all rest states.

    :raises StatejumpError: no assumed ranges are confirmed
    """
    half = np.abs(of.by_friction) @ of.limit_N + 1e-12
    force = half / np.maximum(np.diag(of.compliance), 1e-300)
    corners = np.array([np.abs(part.points[:, 1]).max() for part in of.parts])
    wide = np.array([np.abs(part.points[:, 0] - part.position_m).max() for part in of.parts])
    for factor in FACTORS:
        reach = factor * half + np.minimum(wide, 10 * factor * half)
        box = Box(of.position_m - reach, of.position_m + reach, -factor * force - 2 * corners,
                  factor * force + 2 * corners)
        found = _tightened(of, box)
        if found is not None and _is_inside(found, box):
            return found
    raise StatejumpError(code="bounds_of_open_stops", place=name, case=name)


def _tightened(of: Branches, box: Box) -> Box | None:
    """Return ranges of all rest states within a box; None: it contains none."""
    found = box
    for _ in range(ROUNDS):
        programs = Programs(of, found.lines(of))
        if programs.empty:
            return None
        now = programs.narrower(found)
        if np.all(_sizes(now) >= ENOUGH * _sizes(found)):
            break
        found = now
    return found


def _is_inside(found: Box, box: Box) -> bool:
    room_z, room_h = SLACK * (box.high - box.low), SLACK * (box.most - box.least)
    return bool(np.all((found.low > box.low + room_z) & (found.high < box.high - room_z)
                       & (found.least > box.least + room_h) & (found.most < box.most - room_h)))


def _sizes(box: Box) -> np.ndarray:
    return np.concatenate((box.high - box.low, box.most - box.least))


@dataclass(frozen=True)
class Farthest:
    """The largest value of friction · λ + force · h.

    :param bound: it is at most this
    :param reached: the value at a state with the friction ``state_N``
    """

    bound: float
    reached: float
    state_N: np.ndarray


def farthest_branch(of: Branches, box: Box, friction: np.ndarray, force: np.ndarray, nodes: int = NODES,
                    more: Rows | None = None) -> Farthest:
    """Return the largest value of friction · λ + force · h over all rest states, by branch and bound.

    :param more: further rows; states that obey them are not sought
    """
    best = _search(of, friction, force) if more is None else (NONE, np.zeros(len(of.limit_N)))
    order = numbers()
    root = Programs(of, box.lines(of), more)
    found = root.solved(friction, force)
    queue: list[tuple[float, int, Programs, Solved]] = [(-found.bound, next(order), root, found)]
    done = -np.inf
    for _ in range(nodes if len(of.parts) <= MOST_PARTS else 1):
        if not queue or np.isneginf(-queue[0][0]) or -queue[0][0] <= best[0] + GAP * abs(best[0]):
            break
        bound, _, programs, found = heappop(queue)
        if found.x is not None and more is None:
            best = max(best, _value(of, friction, force, found.x[:len(of.limit_N)] * of.limit_N), key=_first)
        cut = _cut(of, programs, found.x)
        if cut is None:
            done = max(done, -bound)
            continue
        part, corner = cut
        for points in (programs.points[part][:corner + 1], programs.points[part][corner:]):
            made = Programs(of, [*programs.points[:part], points, *programs.points[part + 1:]], more)
            value = made.solved(friction, force)
            if value.bound > best[0] + GAP * abs(best[0]):
                heappush(queue, (max(bound, -value.bound), next(order), made, value))
    left = -queue[0][0] if queue else -np.inf
    return Farthest(max(left, done, best[0] + GAP * abs(best[0])), *best)


def _first(pair: tuple[float, np.ndarray]) -> float:
    return pair[0]


def _cut(of: Branches, programs: Programs, x: np.ndarray | None) -> tuple[int, int] | None:
    """Return the part and the corner at which a node is divided; None: each part is on one branch."""
    joints, best, found = len(of.limit_N), 1e-9, None
    for index, points in enumerate(programs.points):
        if len(points) < 3:
            continue
        scale = np.ptp(points, axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        if x is None:
            return index, len(points) // 2
        at = np.array([programs.centre[index] + programs.by_variable[index] @ x,
                       programs.middle[index] + programs.half[index] * x[joints + index]])
        away = _distance(points / scale, at / scale)
        if away > best:
            best = away
            found = index, 1 + int(np.argmin((((points[1:-1] - at) / scale) ** 2).sum(axis=1)))
    return found


def _distance(points: np.ndarray, at: np.ndarray) -> float:
    """Return the distance of a point from a polyline."""
    found = np.inf
    for one, other in zip(points[:-1], points[1:]):
        way = other - one
        share = float(np.clip((at - one) @ way / max(way @ way, 1e-300), 0.0, 1.0))
        found = min(found, float(np.linalg.norm(one + share * way - at)))
    return found


def _value(of: Branches, friction: np.ndarray, force: np.ndarray, state_N: np.ndarray) -> tuple[float, np.ndarray]:
    found = of.state(np.clip(state_N, -of.limit_N, of.limit_N))
    if found is None:
        return -np.inf, state_N
    return float(friction @ state_N + force @ found), state_N


def _search(of: Branches, friction: np.ndarray, force: np.ndarray) -> tuple[float, np.ndarray]:
    """Return a large value and its friction: limits, improved joint by joint."""
    start = np.where(friction >= 0, 1.0, -1.0) * of.limit_N
    best = _value(of, friction, force, start)
    for _ in range(FLIPS):
        before = best[0]
        for joint in np.flatnonzero(of.limit_N > 0):
            for level in (-1.0, 1.0):
                tried = best[1].copy()
                if tried[joint] != level * of.limit_N[joint]:
                    tried[joint] = level * of.limit_N[joint]
                    best = max(best, _value(of, friction, force, tried), key=_first)
        if best[0] - before <= 1e-9 * abs(before):
            break
    return best
