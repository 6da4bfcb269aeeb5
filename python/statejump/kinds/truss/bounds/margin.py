# SPDX-License-Identifier: GPL-3.0-or-later
"""Margin between the linear bound and exact geometry.

A rest state u0 + v of exact geometry satisfies K v = −Bᵀλ − D(v). D is the force of each element minus its linear
part. Ranges of the rest states bound D, and D widens the ranges: :func:`margin` iterates to ranges that contain
themselves. States on other branches (snap-through) are not covered.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix, vstack

from statejump.kinds.truss.bounds.sliding import Sliding
from statejump.kinds.truss.bounds.states import Placed
from statejump.kinds.truss.joints import JOINTS

MOST_ROWS = 4000  # of elements and directions, for which the dense compliance is computed
ROUNDS = 60
WIDER = 1.01  # factor on defects, so that ranges contain themselves strictly
ZERO = 1e-12  # rotation of an element that counts as rounding


@dataclass(frozen=True)
class Margin:
    """Bounds of the defect forces.

    :param defect_N: bounds (rows,) of the forces along rows
    :param by_defect: K⁻¹Eᵀ (dofs, rows); None: linear, or no margin exists
    :param quality: "exact", "linear" or "estimate"
    :param why: reason for the quality
    """

    quality: str
    why: str
    defect_N: np.ndarray
    by_defect: np.ndarray | None = None

    def of(self, rows: np.ndarray) -> np.ndarray:
        """Return the half ranges that exact geometry adds to rows (k, dofs)."""
        if self.by_defect is None:
            return np.zeros(len(rows))
        return np.asarray(np.abs(rows @ self.by_defect) @ self.defect_N)

    def of_vector(self, rows: np.ndarray) -> float:
        """Return the norm that exact geometry adds to a vector output with rows (m, dofs)."""
        if self.by_defect is None:
            return 0.0
        return float(np.linalg.norm(rows @ self.by_defect, axis=0) @ self.defect_N)


@dataclass(frozen=True)
class Bars:
    """Links and springs: rows (elements, dofs) of their elongation and of two directions across them."""

    along: Any
    across: Any  # rows of the first direction of all, then of the second
    stiffness: np.ndarray
    free_m: np.ndarray
    length_m: np.ndarray

    @property
    def count(self) -> int:
        return len(self.length_m)


def bars_of(of: Placed, all_cables: bool = False) -> Bars:
    """Return the links, springs and taut cables, or all cables."""
    truss, place = of.truss, of.truss.nodes.position_m + of.displacement_m
    links, springs = truss.links, truss.springs
    length = np.linalg.norm(place[springs.nodes[:, 1]] - place[springs.nodes[:, 0]], axis=1)
    taut = all_cables | ~springs.cable | (length > springs.free_length_m)
    nodes = np.concatenate((links.nodes, springs.nodes[taut])).astype(int)
    free = np.concatenate((links.stress_free_length_m, springs.free_length_m[taut]))
    stiffness = np.concatenate((links.axial_stiffness_N / links.stress_free_length_m,
                                springs.stiffness_N_per_m[taut]))
    span = place[nodes[:, 1]] - place[nodes[:, 0]]
    length = np.linalg.norm(span, axis=1)
    along = span / length[:, None]
    first = np.cross(along, np.eye(3)[np.abs(along).argmin(axis=1)] if truss.dimension == 3 else [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first, axis=1)[:, None]
    across = [first] if truss.dimension == 2 else [first, np.cross(along, first)]
    rows = [relative(of, nodes, direction) for direction in (along, *across)]
    return Bars(rows[0], vstack(rows[1:]).tocsr(), stiffness, free, length)


def relative(of: Placed, pairs: np.ndarray, direction: np.ndarray) -> Any:
    """Return rows (pairs, dofs) of the motion of second nodes relative to first nodes along directions."""
    count, places = len(pairs), 3 * len(of.truss.nodes.names)
    numbers = np.repeat(np.arange(count), 3)
    axes = np.tile(np.arange(3), count)
    made = csr_matrix((count, places))
    for column, sign in ((1, 1.0), (0, -1.0)):
        sites = 3 * np.repeat(pairs[:, column], 3) + axes
        made = made + csr_matrix((sign * direction.ravel(), (numbers, sites)), shape=(count, places))
    return (made @ of.of_nodes[:places]).tocsr()


@dataclass(frozen=True)
class Arms:
    """Arms of latches and torsion springs: links whose rotation is that of the latch or the spring."""

    rows: Any  # of the motion along the first direction of all, then along the second
    latch: np.ndarray  # number of the latch
    radius_m: np.ndarray
    friction_N_m: np.ndarray
    moment_N_m: np.ndarray  # of preload and stiffness in the equilibrium
    stiffness_N_m: np.ndarray


def arms_of(of: Sliding, all_plays: bool = False) -> Arms:
    """Return the arms of latches and torsion springs.

    The stiffnesses of latches are those beyond the plays, or those of the equilibrium.
    """
    (section,) = (joint.section for joint in JOINTS if joint.turns and not joint.bends)
    latches = of.truss.joints[section]
    which = [index for index, joint in enumerate(of.joints) if joint.section == section]
    arms = [(latch, link) for latch, pair in enumerate(latches.links) for link in pair if link >= 0]
    pairs = np.array([of.truss.links.nodes[link] for _, link in arms], dtype=int).reshape(-1, 2)
    owner = np.array([latch for latch, _ in arms], dtype=int)
    place = of.truss.nodes.position_m + of.displacement_m
    span = place[pairs[:, 1]] - place[pairs[:, 0]]
    axis = latches.axis[owner]
    first = span - (span * axis).sum(axis=1, keepdims=True) * axis
    length = np.linalg.norm(first, axis=1)
    first /= length[:, None]
    rows = vstack([relative(of, pairs, first), relative(of, pairs, np.cross(axis, first))]).tocsr()
    rotation = (of.slide_m[which] / of.radius_m[which])[owner]
    edge, stiffness = latches.deadband_rad[owner], latches.stiffness_N_m_per_rad[owner]
    beyond = rotation - np.clip(rotation, -edge, edge)
    other = np.abs(latches.preload_moment_N_m[owner] + stiffness * beyond)
    springs = np.where(all_plays | (beyond != 0), stiffness, 0.0)
    made = Arms(rows, owner, length, latches.friction_moment_N_m[owner], other, springs)
    return joined(made, torsion_arms(of, len(latches.names)))


def torsion_arms(of: Placed, first: int) -> Arms:
    """Return the links that torsion springs turn; the springs have the numbers from ``first`` on."""
    truss, springs = of.truss, of.truss.elements["torsion_spring"]
    owners = [(spring, link) for spring, links in enumerate(springs.links) for link in links if link >= 0]
    spring = np.array([one for one, _ in owners], dtype=int)
    pairs = np.array([truss.links.nodes[link] for _, link in owners], dtype=int).reshape(-1, 2)
    place = truss.nodes.position_m + of.displacement_m
    span, axis = place[pairs[:, 1]] - place[pairs[:, 0]], springs.axis[spring].reshape(-1, 3)
    across = span - (span * axis).sum(axis=1, keepdims=True) * axis
    length = np.linalg.norm(across, axis=1)
    along = across / length[:, None]
    rows = vstack([relative(of, pairs, along), relative(of, pairs, np.cross(axis, along))]).tocsr()
    before = truss.nodes.position_m[pairs[:, 1]] - truss.nodes.position_m[pairs[:, 0]]
    turned = np.abs(np.arctan2((np.cross(before, span) * axis).sum(axis=1), (before * across).sum(axis=1)))
    angle = np.bincount(spring, turned, len(springs.names)) + np.abs(springs.bias_rad)
    stiffness = springs.stiffness_N_m_per_rad
    return Arms(rows, first + spring, length, np.zeros(len(spring)), (stiffness * angle)[spring], stiffness[spring])


def joined(one: Arms, other: Arms) -> Arms:
    """Return the arms of both."""
    first, second = len(one.radius_m), len(other.radius_m)
    rows = vstack([one.rows[:first], other.rows[:second], one.rows[first:], other.rows[second:]]).tocsr()
    return Arms(rows, *(np.concatenate((getattr(one, name), getattr(other, name))) for name in (
        "latch", "radius_m", "friction_N_m", "moment_N_m", "stiffness_N_m")))


def margin(of: Sliding) -> Margin:
    """Return the bounds of the defects of all rest states."""
    nothing = np.zeros(0)
    why = refuses_margin(of)
    if why:
        return Margin("estimate", why, nothing)
    bars = bars_of(of)
    arms = arms_of(of)
    rows = vstack([bars.along, bars.across, arms.rows]).tocsr()
    rotates = vstack([bars.across, arms.rows])
    if not rotates.nnz or abs(rotates).max() < ZERO:
        return _exact()
    if rows.shape[0] > MOST_ROWS:
        return Margin("estimate", "the truss has too many elements for a margin of exact geometry", nothing)
    friction = np.abs(rows @ of.by_friction) @ of.limit_N
    across = friction[bars.count:]
    if not np.any(across > ZERO * np.concatenate((np.tile(bars.length_m, bars.across.shape[0] // max(bars.count, 1)),
                                                  np.tile(arms.radius_m, 2)))):
        return _exact()
    by_defect = of.solve(rows.T.toarray())
    compliance = np.abs(rows @ by_defect)
    elastic = rows[:bars.count] @ by_defect
    elastic[np.arange(bars.count), np.arange(bars.count)] -= 1 / bars.stiffness
    found = iterated(lambda defect: defects(bars, arms, friction, compliance, np.abs(elastic), defect),
                     len(friction))
    if found is None:
        return Margin("estimate", "the margin of exact geometry does not converge: the truss is nearly a mechanism",
                      nothing)
    return Margin("linear", "elements rotate; the margin covers exact geometry near the linear rest states", found,
                  by_defect)


def refuses_margin(of: Sliding) -> str:
    """Return why no margin is derived; empty: it is."""
    without = (of.truss.elements, ("beam", "body")), (of.truss.joints, ("hinge", "rigid"))
    for parts, sections in without:
        for section in sections:  # the reactions of joints add no geometric stiffness to K
            if len(parts[section].names):
                return f"the margin of exact geometry is not derived for [[{section}]]"
    return ""


def _exact() -> Margin:
    return Margin("exact", "no element rotates, so the truss is linear between its rest states", np.zeros(0))


def iterated(defects: Callable[[np.ndarray], np.ndarray | None], size: int) -> np.ndarray | None:
    """Return defects that bound themselves; None if there are none."""
    now: np.ndarray | None = np.zeros(size)
    for _ in range(ROUNDS):
        assert now is not None
        wider = WIDER * now + 1e-300
        now = defects(wider)
        if now is None or not np.isfinite(now).all():
            return None
        if np.all(now <= wider):
            return wider
    return None


def defects(bars: Bars, arms: Arms, friction: np.ndarray, compliance: np.ndarray, elastic: np.ndarray,
            defect: np.ndarray) -> np.ndarray | None:
    """Return bounds of the defect forces of all rows within the ranges that friction and defects permit."""
    half, count, length = friction + compliance @ defect, bars.count, bars.length_m
    end = len(half) - 2 * len(arms.radius_m)
    along, across = half[:count], half[count:end]
    w = np.sqrt((across.reshape(-1, count) ** 2).sum(axis=0))
    least = length - along
    delta = np.hypot(*half[end:].reshape(2, -1))
    if np.any(least <= 0) or np.any(delta >= 0.5 * arms.radius_m):
        return None
    # Elongation: not the difference of large motions, but friction and defects times 1/k − R K⁻¹Rᵀ.
    longest = np.hypot(length + along, w)
    stretched = np.minimum(
        friction[:count] + elastic @ defect + np.abs(longest / bars.free_m - 1) * defect[:count] / bars.stiffness,
        along + w**2 / (2 * least))
    force = bars.stiffness * np.abs(bars.free_m)
    axial = force * w**2 / (2 * least**2)
    transverse = force * w * stretched / (length * least)
    return np.concatenate((axial, np.tile(transverse, len(across) // max(count, 1)),
                           np.tile(_at_arms(arms, delta), 2)))


def _at_arms(arms: Arms, delta_m: np.ndarray) -> np.ndarray:
    """Return bounds of the defect forces [N] at arms whose ends move by at most ``delta_m`` relative to each other.

    The gradient of the angle of an arm v is J v/|v|². It changes by |δ|/(|v| |v + δ|), to first order exactly up to
    |δ|²/(|v|² |v + δ|). The angle is the imaginary part of log(1 + δ/v).
    """
    share = delta_m / arms.radius_m
    second = 0.5 * share**2 / (1 - share)
    of_latch = [np.bincount(arms.latch, values)[arms.latch] for values in (share + second, second)]
    tilted = share / (arms.radius_m * (1 - share))
    return np.asarray(arms.friction_N_m * tilted + arms.moment_N_m * share * tilted
                      + arms.stiffness_N_m * (of_latch[0] * tilted + of_latch[1] / arms.radius_m))
