# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of trusses whose stops, plays or cables change their state at the reference temperature."""
from __future__ import annotations

from dataclasses import dataclass, replace
from math import nan
from typing import Any

import numpy as np
from scipy.sparse import vstack

from statejump.core.errors import StatejumpError
from statejump.kinds.truss.bounds.branches import Branches, Part, parts_of
from statejump.kinds.truss.bounds.extremes import farthest
from statejump.kinds.truss.bounds.history import attained
from statejump.kinds.truss.bounds.hot import Hot
from statejump.kinds.truss.bounds.margin import Arms, Bars, arms_of, bars_of, defects, refuses_margin
from statejump.kinds.truss.bounds.outputs import Output
from statejump.kinds.truss.bounds.ranges import ways
from statejump.kinds.truss.bounds.result import Bound
from statejump.kinds.truss.bounds.sliding import Sliding
from statejump.kinds.truss.bounds.stops import Box, farthest_branch, valid_box
from statejump.kinds.truss.case import TrussCase

ROUNDS = 12  # of the margin
GROWTH = 1.05
MOST_ROWS = 24  # of an output whose rows are bounded one by one


@dataclass(frozen=True)
class Switching:
    """The reduced equations, and valid ranges of all parts.

    :param responses: K⁻¹ [Bᵀ, Rᵀ, further forces] (dofs, ...)
    :param wide: with the forces of exact geometry as further joints
    """

    of: Sliding
    linear: Branches
    box: Box
    wide: Branches
    wide_box: Box
    by_friction: np.ndarray
    by_part: np.ndarray
    by_defect: np.ndarray
    quality: str
    why: str


def linear_branches(of: Sliding, parts: list[Part]) -> tuple[Branches, np.ndarray]:
    """Return the equations of the linear truss with its parts, and K⁻¹Rᵀ (dofs, parts)."""
    rows = np.array([part.row for part in parts])
    by_part = of.solve(rows.T)
    return Branches(parts, np.array([part.position_m for part in parts]), rows @ of.by_friction, rows @ by_part,
                    of.limit_N), by_part


def switching(of: Sliding) -> Switching:
    """Return the equations of a truss with stops, plays or cables.

    :raises StatejumpError: no ranges of their positions and forces are confirmed
    """
    linear, by_part = linear_branches(of, parts_of(of))
    rows, name = np.array([part.row for part in linear.parts]), of.truss.name
    box = valid_box(linear, name)
    alone = Switching(of, linear, box, linear, box, of.by_friction, by_part, np.zeros((of.stiffness.shape[0], 0)),
                      "estimate", refuses_margin(of))
    if alone.why:
        return alone
    bars, arms = bars_of(of, all_cables=True), arms_of(of, all_plays=True)
    lines = vstack([bars.along, bars.across, arms.rows]).tocsr()
    rotates = vstack([bars.across, arms.rows])
    if not rotates.nnz or abs(rotates).max() < 1e-12:
        return replace(alone, quality="exact", why="no element rotates, so every part of the truss is linear")
    by_defect = of.solve(lines.T.toarray())
    most = np.zeros(lines.shape[0])
    for _ in range(ROUNDS):
        wide = replace(linear, by_friction=np.hstack((linear.by_friction, rows @ by_defect)),
                       limit_N=np.append(of.limit_N, most))
        try:
            wide_box = valid_box(wide, name)
        except StatejumpError:
            break
        now = _defects(of, bars, arms, lines, by_part, by_defect, wide_box, most)
        if now is None:
            break
        if np.all(now <= most):
            return replace(alone, wide=wide, wide_box=wide_box, by_defect=by_defect, quality="linear",
                           why="elements rotate; the margin covers exact geometry near the linear rest states")
        most = np.where(now > most, GROWTH * now, most)
    return replace(alone, why="the margin of exact geometry does not converge: the truss is nearly a mechanism")


def _defects(of: Sliding, bars: Bars, arms: Arms, lines: Any, by_part: np.ndarray, by_defect: np.ndarray, box: Box,
             most_N: np.ndarray) -> np.ndarray | None:
    force = np.maximum(np.abs(box.least), np.abs(box.most))
    half = np.abs(lines @ of.by_friction) @ of.limit_N + np.abs(lines @ by_part) @ force
    compliance = lines @ by_defect
    elastic = compliance[:bars.count].copy()
    elastic[np.arange(bars.count), np.arange(bars.count)] -= 1 / bars.stiffness
    return defects(bars, arms, half, np.abs(compliance), np.abs(elastic), most_N)


def bound_of(at: Switching, case: TrussCase, output: Output, path_m: np.ndarray, attain: bool, hot: Hot
             ) -> tuple[Bound, Any]:
    """Return the bounds of an output, and the simulated history that comes close.

    :param hot: rest states within the temperature range
    """
    of, rows = at.of, output.rows(at.of)
    gains, by_part, by_defect = rows @ at.by_friction, rows @ at.by_part, rows @ at.by_defect
    start = output.vector(path_m[0]) - output.vector(of.displacement_m)
    columns = np.hstack((gains * of.limit_N, by_part * (0.5 * (at.box.most - at.box.least))))
    directions, factor = ways(columns)
    if not factor and len(rows) <= MOST_ROWS:
        directions = np.eye(len(rows))
    ends = np.array([[_end(at.linear, at.box, sign, way @ gains, way @ by_part) for sign in (1.0, -1.0)]
                     for way in directions])  # (directions, sides, (bound, reached))
    widths = ends.sum(axis=1)
    begin = directions @ start
    jumps = np.maximum(ends[:, 0, 0] - begin, ends[:, 1, 0] + begin)
    worst = directions[int(widths[:, 1].argmax())]
    spread, jump = ((factor * float(one.max()) if factor else float(np.linalg.norm(one)))
                    for one in (widths[:, 0], jumps))
    if not factor:
        spread = min(spread, 2 * farthest(columns).bound)
    margin = nan if at.quality == "estimate" else 0.0
    if at.quality == "linear":
        wide = np.hstack((gains, by_defect))
        wider = [sum(_end(at.wide, at.wide_box, sign, way @ wide, way @ by_part, 1)[0] for sign in (1.0, -1.0))
                 for way in directions]
        total = factor * max(wider) if factor else float(np.linalg.norm(wider))
        margin = max(0.0, total - spread)
    history = attained(case, of, output, worst) if attain else None
    parts = np.abs(worst @ gains) * of.limit_N
    in_range = hot.extent(gains, by_part, start, (spread, min(jump, spread)))
    return Bound(
        output=output, spread=spread, reached=float(widths[:, 1].max()), margin=margin, jump=min(jump, spread),
        range_spread=in_range[0], range_jump=in_range[1],
        simulated=nan if len(path_m) < 2 else output.change(path_m[0], path_m[-1]),
        attained=nan if history is None else history.spread, fraction=parts / (parts.sum() or 1.0),
        peak_thermal=(nan, nan)), history


def _end(of: Branches, box: Box, sign: float, friction: np.ndarray, force: np.ndarray, nodes: int | None = None
         ) -> tuple[float, float]:
    """Return a bound of the largest sign · output, −friction · λ − force · h, and a value that a state reaches."""
    found = (farthest_branch(of, box, -sign * friction, -sign * force) if nodes is None
             else farthest_branch(of, box, -sign * friction, -sign * force, nodes))
    return found.bound, found.reached
