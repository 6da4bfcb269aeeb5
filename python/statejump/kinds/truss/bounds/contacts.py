# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of trusses with clearance revolutes: ranges of contacts, linear programs, rest states that come close."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import nan
from typing import Any

import numpy as np
from scipy.sparse import vstack

from statejump.core.errors import StatejumpError
from statejump.kinds.truss.bounds.clearance import Clearances, clearances
from statejump.kinds.truss.bounds.clearance_history import attained_clearance
from statejump.kinds.truss.bounds.clearance_verdict import verdict_of_clearance
from statejump.kinds.truss.bounds.contact_states import farthest_state
from statejump.kinds.truss.bounds.coupled import Coupled, coupled
from statejump.kinds.truss.bounds.extremes import farthest
from statejump.kinds.truss.bounds.history import Attained
from statejump.kinds.truss.bounds.margin import (
    Arms, Bars, bars_of, defects, joined, relative, torsion_arms,
)
from statejump.kinds.truss.bounds.outputs import Output, chosen
from statejump.kinds.truss.bounds.ranges import Temperatures, ways
from statejump.kinds.truss.bounds.result import Bound, Bounds
from statejump.kinds.truss.bounds.sectors import Sectors, forces, highest, propagated
from statejump.kinds.truss.bounds.simulated import repeated, simulated
from statejump.kinds.truss.bounds.states import kept_cables
from statejump.kinds.truss.case import TrussCase

MOST_ROWS = 24  # of an output whose rows are bounded one by one
ROUNDS = 20  # of the margin
GROWTH = 1.05  # of forces that do not yet contain themselves
NOT_IN_MARGIN = ("beam", "body")


def with_clearance(case: TrussCase) -> bool:
    """Whether a case has revolutes with clearance."""
    return len(case.resolve().revolutes.names) > 0


@dataclass(frozen=True)
class Contacts:
    """Everything that bounds of outputs need.

    :param linear: linear programs of the linear truss
    :param wide: those of the truss with the forces of exact geometry as further joints
    """

    linear: Coupled
    wide: Coupled
    quality: str
    why: str


def contacts(of: Clearances) -> Contacts:
    """Return ranges of the contacts and programs, with the margin of exact geometry if it exists."""
    programs = coupled(of, propagated(of))
    rows, bars, arms = _rows(of)
    for section in NOT_IN_MARGIN:
        if len(of.truss.elements[section].names):
            return Contacts(programs, programs, "estimate",
                            f"the margin of exact geometry is not derived for [[{section}]]")
    moved, _ = of.respond(rows.T.toarray())
    compliance = np.abs(rows @ moved)
    elastic = np.abs(rows[:bars.count] @ moved)
    index = np.arange(bars.count)
    elastic[index, index] = np.abs((rows @ moved)[index, index] - 1 / bars.stiffness)
    most = np.full(rows.shape[0], 1e-300)
    for _ in range(ROUNDS):
        wide = of.with_forces(rows, most)
        try:
            at = propagated(wide)
        except StatejumpError:
            break
        now = _defects(of, at, rows, bars, arms, compliance, elastic, most)
        if now is None:
            break
        if np.all(now <= most):
            return Contacts(programs, coupled(wide, at), "linear",
                            "contacts are exact; the margin covers exact geometry near the linear rest states")
        most = np.where(now > most, GROWTH * now, most)
    return Contacts(programs, programs, "estimate",
                    "the margin of exact geometry does not converge: the truss is nearly a mechanism")


def _defects(of: Clearances, at: Sectors, rows: Any, bars: Bars, arms: Arms, compliance: np.ndarray,
             elastic: np.ndarray, most_N: np.ndarray) -> np.ndarray | None:
    """Return bounds of the forces of exact geometry along rows, at ranges of the contacts."""
    by_state, start = rows @ of.by_state, of.start
    bare = Sectors(at.least_rad, at.most_rad, at.inner_m, at.outer_m, at.friction_N)
    half = np.maximum(highest(of, bare, by_state) - by_state @ start, highest(of, bare, -by_state) + by_state @ start)
    count = of.count
    # Friction acts at radii that change with the depth.
    friction = at.friction_N * np.asarray(of.truss.revolutes.journal_radius_m + of.truss.revolutes.radial_clearance_m)
    revolute = arms.latch < count
    rubbing = np.where(revolute, friction[np.minimum(arms.latch, count - 1)], 0.0)
    limited = replace(arms, friction_N_m=rubbing)
    found = defects(bars, limited, half, compliance, elastic, most_N)
    if found is None:
        return None
    deeper = at.friction_N * 0.5 * (at.outer_m - at.inner_m)
    extra = np.where(revolute, deeper[np.minimum(arms.latch, count - 1)], 0.0) / arms.radius_m
    found[len(found) - 2 * len(arms.radius_m):] += np.tile(extra, 2)
    return found


def _rows(of: Clearances) -> tuple[Any, Bars, Arms]:
    bars, arms = bars_of(of), _arms(of)
    return vstack([bars.along, bars.across, arms.rows]).tocsr(), bars, arms


def _arms(of: Clearances) -> Arms:
    """Return the links that friction moments and torsion springs turn; the first numbers are those of revolutes."""
    truss, parts = of.truss, of.truss.revolutes
    owners = [(joint, link) for joint in range(of.count)
              for link in (parts.journal_link[joint], parts.bearing_link[joint]) if link >= 0]
    joint = np.array([one for one, _ in owners], dtype=int)
    pairs = np.array([truss.links.nodes[link] for _, link in owners], dtype=int).reshape(-1, 2)
    axis = np.asarray(parts.axis, dtype=float)[joint].reshape(-1, 3)
    place = truss.nodes.position_m + of.displacement_m
    span = place[pairs[:, 1]] - place[pairs[:, 0]]
    across = span - (span * axis).sum(axis=1, keepdims=True) * axis
    length = np.linalg.norm(across, axis=1)
    along = across / length[:, None]
    rows = vstack([relative(of, pairs, along), relative(of, pairs, np.cross(axis, along))]).tocsr()
    nothing = np.zeros(len(joint))
    return joined(Arms(rows, joint, length, nothing, nothing, nothing), torsion_arms(of, of.count))


def bounds_of_clearance(case: TrussCase, names: Sequence[str], box: tuple[float, float] | None,
                        attain: bool, simulate: bool | None) -> Bounds:
    """Return bounds of the state jump of a truss with clearance revolutes."""
    found = contacts(clearances(case))
    of, wide, at = found.linear.of, found.wide.of, found.wide.at
    facts = list(kept_cables(of, lambda rows: _half(wide, at, rows @ wide.by_state)))
    if np.all(found.wide.seen.least_N > 0):
        facts.append("all contacts of revolutes stay closed in all rest states")
    places = of.of_nodes[:3 * len(of.truss.nodes.names)]
    outputs = chosen(of, names, lambda: _half(wide, at, places @ wide.by_state).reshape(-1, 3))
    path = simulated(case, simulate)
    temperatures = Temperatures.of_box(of, box) if box else Temperatures.of_programs(of)
    verdict = verdict_of_clearance(case, temperatures, _least_N(found.linear.of, temperatures),
                                   repeated(case) if len(path) > 1 else None)
    made, histories = [], {}
    for output in outputs:
        bound, history = _bound(found, case, output, path, attain)
        made.append(bound)
        if history is not None:
            histories[output.name] = history
        elif attain:
            facts.append(f"no history of single members that leads near the bound of {output.name} was found")
    return Bounds(of.truss, "C", found.quality, found.why, facts, made, [str(joint) for joint in of.joints],
                  np.concatenate((at.friction_N, of.limit_N)), verdict, temperatures, histories, contacts=found)


def _least_N(of: Clearances, temperatures: Temperatures) -> np.ndarray | None:
    """Return the least contact forces over all states within a temperature range; None: contacts may open."""
    hot = of.heated(temperatures.of_elements, temperatures.lowest_K, temperatures.highest_K)
    try:
        least = forces(hot, propagated(hot)).least_N * np.cos(of.friction_angle_rad)
    except StatejumpError:
        return None
    return least if np.all(least > 0) else None


def _half(of: Clearances, at: Sectors, rows: np.ndarray) -> np.ndarray:
    """Return the largest deviations of rows · x from the equilibrium without friction."""
    start = of.start if len(of.start) == rows.shape[1] else np.pad(of.start, (0, rows.shape[1] - len(of.start)))
    return np.maximum(highest(of, at, rows) - rows @ start, highest(of, at, -rows) + rows @ start)


def _bound(found: Contacts, case: TrussCase, output: Output, path_m: np.ndarray, attain: bool
           ) -> tuple[Bound, Attained | None]:
    of, at = found.linear.of, found.linear.at
    rows = output.rows(of)
    linear = rows @ of.by_state
    start = output.vector(path_m[0]) - output.vector(of.displacement_m)
    worst, spread, jump = _extent(found.linear, rows, start)
    total = spread if found.wide is found.linear else max(spread, _extent(found.wide, rows, start)[1])
    states = [farthest_state(of, side * worst @ linear) for side in (1.0, -1.0)]
    reached = (nan if states[0] is None or states[1] is None
               else float(np.linalg.norm(linear @ (states[0].state - states[1].state))))
    parts = _parts(of, at, worst @ linear)
    history = None
    if attain and states[0] is not None and states[1] is not None:
        history = attained_clearance(case, of, output, [states[0], states[1]], parts, spread)
    margin = total - spread if found.quality == "linear" else nan
    return Bound(
        output=output, spread=spread, reached=reached, margin=margin, jump=jump,
        range_spread=spread, range_jump=jump,
        simulated=nan if len(path_m) < 2 else output.change(path_m[0], path_m[-1]),
        attained=nan if history is None else history.spread, fraction=parts / (parts.sum() or 1.0),
        peak_thermal=(nan, nan)), history


def _extent(programs: Coupled, rows: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, float, float]:
    """Return the direction in which an output spreads most, and bounds of its spread and of its jump."""
    gains = rows @ programs.of.by_state
    columns = _generators(programs.of, programs.at, gains)
    directions, factor = ways(columns)
    worst, spread, jump = _along(programs, gains, start, directions, factor)
    if not factor:
        far = farthest(columns)
        worst, spread = far.direction(columns), min(spread, 2 * far.bound)
        if len(rows) <= MOST_ROWS:
            _, alone, jump_alone = _along(programs, gains, start, np.eye(len(rows)), 0.0)
            spread, jump = min(spread, alone), min(jump, jump_alone)
    return worst, spread, min(spread, jump)


def _along(programs: Coupled, gains: np.ndarray, start: np.ndarray, directions: np.ndarray, factor: float
           ) -> tuple[np.ndarray, float, float]:
    """Return the same by the widths in directions; see :func:`ways`."""
    zero = gains @ programs.of.start
    high, low = (np.array([sign * programs.of_state(sign * way @ gains) - way @ zero for way in directions])
                 for sign in (1.0, -1.0))
    widths, begin = high - low, directions @ start
    jumps = np.maximum(high - begin, begin - low)
    worst = directions[int(widths.argmax())]
    if factor:
        return worst, factor * float(widths.max()), factor * float(jumps.max())
    return worst, float(np.linalg.norm(widths)), float(np.linalg.norm(jumps))


def _generators(of: Clearances, at: Sectors, rows: np.ndarray) -> np.ndarray:
    """Return columns (m, n) such that differences of two rest states are rows · x = 2 Σ c_i λ_i with |λ_i| <= 1."""
    middle, half = at.middle_rad, np.minimum(at.half_rad, np.pi)
    normal = np.stack((np.cos(middle), np.sin(middle)), axis=1)
    left = np.stack((-normal[:, 1], normal[:, 0]), axis=1)
    along = 0.5 * (at.outer_m - np.cos(half) * np.where(half < np.pi / 2, at.inner_m, at.outer_m))
    across = at.outer_m * np.sin(np.minimum(half, np.pi / 2))
    shifts = rows[:, :2 * of.count].reshape(len(rows), of.count, 2)
    return np.concatenate(((shifts * normal).sum(axis=2) * along, (shifts * left).sum(axis=2) * across,
                           rows[:, 2 * of.count:3 * of.count] * at.friction_N, rows[:, 3 * of.count:] * of.limit_N),
                          axis=1)


def _parts(of: Clearances, at: Sectors, row: np.ndarray) -> np.ndarray:
    """Return the widths of row · x by each joint."""
    count = of.count
    shifts = np.zeros((count, count, 2))
    shifts[np.arange(count), np.arange(count)] = row[:2 * count].reshape(count, 2)
    width = at.support(shifts) + at.support(-shifts) + 2 * np.abs(row[2 * count:3 * count]) * at.friction_N
    return np.concatenate((width, 2 * np.abs(row[3 * count:]) * of.limit_N))
