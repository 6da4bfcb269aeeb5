# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses whose stops, plays or cables change their state within a temperature range: last-slip linear programs.

With S = B K⁻¹Rᵀ, the slips of the joints and the positions of the parts are

    p = s0 + B K⁻¹G T − A λ − S h,   z = z0 + R K⁻¹G T − Sᵀ λ − A_z h

For every λ and T there is one state, so ranges of z and h that hold at ΔT = 0 by connectedness hold at all T likewise.
The running maximum of p_i is reached while joint i slips at λ_i = +f_i, as in
:mod:`statejump.kinds.truss.bounds.ranges`.
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, nan

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.core.start import FRICTIONLESS
from statejump.kinds.truss.bounds.branches import Branches, Part
from statejump.kinds.truss.bounds.ranges import SINGULAR, Temperatures, Verdict, ranges_that_hold, ways
from statejump.kinds.truss.bounds.sliding import Sliding
from statejump.kinds.truss.bounds.stops import NONE, Box, Rows, farthest_branch, valid_box
from statejump.kinds.truss.joints import JOINTS

MOST_JOINTS = 60  # of linear programs
NODES = 40  # of branch and bound
NEAR = 1e-7  # smallest half range of a slip over the slide that friction of the joint itself permits


@dataclass(frozen=True)
class Hot:
    """Rest states within a temperature range.

    :param at: the truss at ΔT = 0, and the ranges of its parts; None: not computed
    :param rows: the ranges of p at ΔT = 0
    """

    verdict: Verdict
    at: tuple[Branches, Box] | None = None
    rows: Rows | None = None

    def extent(self, gains: np.ndarray, by_part: np.ndarray, start: np.ndarray, most: tuple[float, float]
               ) -> tuple[float, float]:
        """Return the spread of the output −gains λ − by_part h within the range, and the largest jump from the start.

        :param gains: (m, joints); ``by_part``: (m, parts); ``start``: value at the start of the case (m,)
        :param most: spread and jump after any history
        """
        if self.at is None:
            return nan, nan
        if self.verdict.kind == "never_slips":
            return 0.0, 0.0
        of, box = self.at
        directions, factor = ways(np.hstack((gains * of.limit_N, by_part * (0.5 * (box.most - box.least)))))
        ends = np.array([[farthest_branch(of, box, -sign * way @ gains, -sign * way @ by_part, NODES, self.rows).bound
                          for sign in (1.0, -1.0)] for way in directions])
        begin = directions @ start
        found = ends.sum(axis=1), np.maximum(ends[:, 0] - begin, ends[:, 1] + begin)
        sizes = [factor * float(one.max()) if factor else float(np.linalg.norm(one)) for one in found]
        return min(sizes[0], most[0]), min(sizes[1], most[1])


@dataclass(frozen=True)
class _Problem:
    """The last-slip programs: p = slide + by_friction (λ, T) + by_force h."""

    limit_N: np.ndarray
    hot: Branches
    box: Box
    by_friction: np.ndarray
    by_force: np.ndarray
    slide: np.ndarray
    begins: np.ndarray
    near: np.ndarray

    def slipped(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return bounds of p that joints reach while they slip, if all p are within ranges."""
        found = [self.begins.copy(), self.begins.copy()]
        for joint in np.flatnonzero(self.limit_N > 0):
            for side, sign in enumerate((-1.0, 1.0)):
                reached = self._last(joint, sign, low, high)
                found[side][joint] += sign * max(0.0, reached - sign * self.begins[joint])
        return found[0], found[1]

    def _last(self, joint: int, sign: float, low: np.ndarray, high: np.ndarray) -> float:
        """Return the bound of sign · p of a joint while it slips with this sign; −inf: it cannot slip."""
        unit = np.zeros((1, len(self.hot.limit_N)))
        unit[0, joint] = sign / self.limit_N[joint]
        least, most = low - self.slide, high - self.slide
        (most if sign > 0 else least)[joint] = sign * inf  # the range that is sought
        rows = Rows(np.vstack((self.by_friction, unit)), np.vstack((self.by_force, np.zeros(len(self.hot.parts)))),
                    np.append(least, 1.0), np.append(most, 1.0))
        found = farthest_branch(self.hot, self.box, sign * self.by_friction[joint], sign * self.by_force[joint], NODES,
                                rows)
        return -inf if found.bound <= 0.5 * NONE else found.bound + sign * float(self.slide[joint])


def within_stops(of: Sliding, linear: Branches, by_part: np.ndarray, temperatures: Temperatures) -> Hot:
    """Return the rest states within a temperature range, and whether joints slip.

    :param by_part: K⁻¹Rᵀ (dofs, parts)
    """
    partial = {joint.section for joint in JOINTS if joint.slips_in_part}
    rubbing = np.flatnonzero(of.limit_N > 0)
    for index in rubbing:
        if of.joints[index].section in partial or of.truss.sticking == "partial_slip":
            return Hot(Verdict("bounded", f"never ratchets: {of.joints[index]} slips partially in every cycle, all "
                                          "slips stay bounded"))
    if np.any(of.truss.sliders.play_m > 0):
        return Hot(Verdict("unknown", "no verdict is derived for plays of sliders"))
    if len(rubbing) > MOST_JOINTS:
        return Hot(Verdict("unknown", f"not computed for more than {MOST_JOINTS} joints with friction"))
    thermal = of.solve(of.heating_N_per_K @ temperatures.of_elements)
    hot = _heated(linear, np.array([part.row for part in linear.parts]) @ thermal, temperatures)
    try:
        box, rest = valid_box(hot, of.truss.name), valid_box(linear, of.truss.name)
    except StatejumpError:
        return Hot(Verdict("unknown", "positions and forces of stops, plays and cables have no confirmed range at "
                                      "these temperatures"))
    flexible = of.compliance + np.diag(1 / of.sticking_N_per_m)
    slides = of.slides @ thermal
    middle = 0.5 * (temperatures.lowest_K + temperatures.highest_K)
    begins = of.slide_m if of.truss.start_friction == FRICTIONLESS else np.zeros(len(of.limit_N))
    slips = of.slides @ by_part
    begun = _start(of, linear, flexible, slips, begins)
    if begun:
        return Hot(Verdict("unknown", begun))
    problem = _Problem(of.limit_N, hot, box, np.hstack((-flexible, slides)), -slips, of.slide_m + slides @ middle,
                       begins, NEAR * np.diag(flexible) * of.limit_N + 1e-300)
    low, high = ranges_that_hold(problem.slipped, begins, problem.near, start_holds=False)
    # Joints without friction slide freely.
    free = of.limit_N == 0
    low, high = np.where(free, -inf, low), np.where(free, inf, high)
    slip = free | (np.maximum(high - begins, begins - low) > 2 * problem.near)
    rows = Rows(-flexible, -slips, low - of.slide_m, high - of.slide_m)
    if not slip[rubbing].any():
        return Hot(Verdict("never_slips", "never slips, the jump is zero", slips=slip & ~free), (linear, rest), rows)
    return Hot(Verdict("bounded", "never ratchets: all slips stay bounded; whether they end in every history is not "
                                  "certified with stops, plays or cables", slips=slip), (linear, rest), rows)


def changes_branch(of: Sliding, linear: Branches, temperatures: Temperatures) -> bool:
    """Whether a part may change its state within a temperature range."""
    thermal = np.array([part.row for part in linear.parts]) @ of.solve(of.heating_N_per_K @ temperatures.of_elements)
    ends = np.sort(np.array([thermal * temperatures.lowest_K, thermal * temperatures.highest_K]), axis=0).sum(axis=2)
    half = np.abs(linear.by_friction) @ linear.limit_N
    for part, low, high in zip(linear.parts, linear.position_m - half + ends[0], linear.position_m + half + ends[1]):
        corners = part.points[:, 0]
        if np.any((corners >= low) & (corners <= high)):
            return True
    return False


def _heated(of: Branches, thermal: np.ndarray, temperatures: Temperatures) -> Branches:
    """Return the equations with temperatures as further forces.

    :param thermal: z by T (parts, variables)
    """
    middle = 0.5 * (temperatures.lowest_K + temperatures.highest_K)
    half = 0.5 * (temperatures.highest_K - temperatures.lowest_K)
    return replace(of, position_m=of.position_m + thermal @ middle, by_friction=np.hstack((of.by_friction, -thermal)),
                   limit_N=np.append(of.limit_N, half))


def _start(of: Sliding, linear: Branches, flexible: np.ndarray, slips: np.ndarray, begins: np.ndarray) -> str:
    """Return why the slips at the start of the case are unknown; empty: no joint has slipped."""
    rubbing = np.flatnonzero(of.limit_N > 0)
    own = flexible[np.ix_(rubbing, rubbing)]
    if np.linalg.eigvalsh(own)[0] <= SINGULAR * np.trace(own):
        return "statics does not determine how sticking joints share their force"
    # Joints that stick: A λ = s0 − begins − S h.
    stuck = np.linalg.solve(own, np.column_stack(((of.slide_m - begins)[rubbing], slips[rubbing])))
    by_joint = linear.by_friction[:, rubbing]
    free = linear.position_m - by_joint @ stuck[:, 0]
    compliance = linear.compliance - by_joint @ stuck[:, 1:]
    force = _held_parts(linear, free, compliance)
    if force is None:
        return "the state of stops, plays and cables at the start is not determined"
    friction = stuck[:, 0] - stuck[:, 1:] @ force
    if np.any(np.abs(friction) > of.limit_N[rubbing] * (1 + 1e-9)):
        return "joints slip under the loads of the start"
    return ""


def _held_parts(linear: Branches, free: np.ndarray, compliance: np.ndarray) -> np.ndarray | None:
    """Return h while all joints stick; None: not determined, as at a rigid stop that sticks where it begins."""
    fixed = np.diag(compliance) <= SINGULAR**0.5 * np.diag(linear.compliance)
    force = np.zeros(len(free))
    for index in np.flatnonzero(fixed):
        line, at = _whole(linear.parts[index]), free[index]
        segment = int(np.searchsorted(line[:, 0], at))
        if not 0 < segment < len(line) or at in line[:, 0]:
            return None
        force[index] = np.interp(at, *line[segment - 1:segment + 1].T)
    kept = np.flatnonzero(~fixed)
    if not len(kept):
        return force
    held = replace(linear, parts=[linear.parts[index] for index in kept],
                   position_m=(free - compliance @ force)[kept], compliance=compliance[np.ix_(kept, kept)],
                   by_friction=linear.by_friction[kept])
    found = held.state(np.zeros(len(linear.limit_N)))
    if found is None:
        return None
    force[kept] = found
    return force


def _whole(part: Part) -> np.ndarray:
    """Return the corners of a polyline with far points of its unlimited branches."""
    far = 1e6 * (np.abs(part.points).max() + 1.0)
    return np.vstack((part.points[0] + far * part.ends[0], part.points, part.points[-1] + far * part.ends[1]))
