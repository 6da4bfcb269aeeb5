# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of the rest states of a truss over any temperature history, and of single outputs."""
from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import nan

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.kinds.truss.bounds.branches import parts_of
from statejump.kinds.truss.bounds.contacts import bounds_of_clearance, with_clearance
from statejump.kinds.truss.bounds.extremes import farthest, zonogon
from statejump.kinds.truss.bounds.gradients import by_stiffness, stiffness_names
from statejump.kinds.truss.bounds.history import MOST_K, attained
from statejump.kinds.truss.bounds.hot import Hot, changes_branch, within_stops
from statejump.kinds.truss.bounds.margin import Margin, margin
from statejump.kinds.truss.bounds.outputs import Output, chosen, spreads_m
from statejump.kinds.truss.bounds.ranges import Temperatures, WithinRange, parsed_range, within
from statejump.kinds.truss.bounds.result import Bound, Bounds
from statejump.kinds.truss.bounds.sliding import Sliding, sliding
from statejump.kinds.truss.bounds.simulated import MOST_SIMULATED, simulated
from statejump.kinds.truss.bounds.states import changing, kept_states
from statejump.kinds.truss.bounds.switching import bound_of, linear_branches, switching
from statejump.kinds.truss.bounds.walking import bounds_of_walking, walking
from statejump.kinds.truss.case import TrussCase

POINTS = 24  # ranges of the picture of the spread over the temperature range
MOST_FACTOR = 200.0  # on the range up to which joints settle
REACHED = 0.999  # of the bound over any history, where this picture ends


def bounds(case: TrussCase, output: Sequence[str] = (), range_K: str | tuple[float, float] | None = None,
           attain: bool = False, simulate: bool | None = None) -> Bounds:
    """Return bounds of the state jump over any temperature history.

    :param output: ``node:NAME``, ``node:NAME.x``, ``node:NAME.xy``, ``rms``, ``tilt``, ``zernike:K`` or ``point``, see
        docs/howto/bounds.md; default: the nodes with the largest spread
    :param range_K: lowest and highest ΔT [K] of every member, each by itself; default: the programs of the case
    :param attain: whether to find, write and simulate the history that attains the bound
    :param simulate: whether to simulate the case; default: with at most MOST_SIMULATED joints
    :raises StatejumpError: the truss is not of class A: a joint has clearance, a stop or a cable may change its state,
        or only friction holds a motion
    """
    box = None if range_K is None else parsed_range(range_K)
    output = [output] if isinstance(output, str) else output
    if with_clearance(case):
        return bounds_of_clearance(case, output, box, attain, simulate)
    try:
        of = sliding(case)
    except StatejumpError:  # also EngineFailed
        held = walking(case)
        if held is None:
            raise
        return bounds_of_walking(held, case, output, Temperatures.of_box(held, box) if box
                                 else Temperatures.of_programs(held), simulate)
    if not np.any(of.limit_N > 0):
        raise StatejumpError(code="bounds_without_friction", place=case.name, case=case.name)
    outputs = chosen(of, output, partial(spreads_m, of))
    exact = margin(of)
    if changing(of, lambda rows: np.abs(rows @ of.by_friction) @ of.limit_N + exact.of(rows)):
        return _switching(case, of, outputs, box, attain, simulate)
    facts = kept_states(of, lambda rows: np.abs(rows @ of.by_friction) @ of.limit_N + exact.of(rows))
    temperatures = Temperatures.of_box(of, box) if box else Temperatures.of_programs(of)
    found = within(of, temperatures)
    hot, by_part = _hot(of, temperatures)
    if hot is not None:
        facts.append("stops, plays or cables may change their state within the range of the temperatures")
    path = simulated(case, simulate, of.displacement_m)
    made, histories, elements = [], {}, stiffness_names(of)
    for one in outputs:
        rows = one.rows(of)
        gains, thermal = of.gains_of(rows)
        far = farthest(gains * of.limit_N)
        direction = far.direction(gains * of.limit_N)
        reached = attained(case, of, one, direction) if attain else None
        if reached is not None:
            histories[one.name] = reached
        elif attain:
            facts.append(f"no temperatures of single members up to {MOST_K:g} K lead to the bound of {one.name}")
        parts = np.abs(direction @ gains) * of.limit_N
        start = one.vector(path[0]) - one.vector(of.displacement_m)
        jump = min(far.bound + float(np.linalg.norm(start)), 2 * far.bound)
        in_range = (found.extent(gains, 2 * far.bound) if hot is None
                    else hot.extent(gains, rows @ by_part, start, (2 * far.bound, jump)))
        made.append(Bound(
            output=one, spread=2 * far.bound, reached=2 * far.reached, margin=_margin(exact, rows),
            jump=jump, range_spread=in_range[0], range_jump=in_range[1],
            simulated=nan if len(path) < 2 else one.change(path[0], path[-1]),
            attained=nan if reached is None else reached.spread, fraction=parts / (parts.sum() or 1.0),
            peak_thermal=temperatures.peak(thermal) if hot is None else (nan, nan),
            corners=zonogon(gains * of.limit_N) if len(rows) == 2 and len(of.joints) <= MOST_SIMULATED else None,
            path=one.vector(path) - one.vector(of.displacement_m),
            by_stiffness=by_stiffness(of, direction @ rows, direction @ gains) if elements else None))
    shows = box is not None and np.isfinite(found.verdict.factor)
    return Bounds(
        of.truss, "A", exact.quality, exact.why, facts, made, [str(joint) for joint in of.joints], of.limit_N,
        found.verdict if hot is None else hot.verdict, temperatures, histories,
        partial(_over_range, of, temperatures, found, made[0]) if shows else None, elements=elements)


def _hot(of: Sliding, temperatures: Temperatures) -> tuple[Hot | None, np.ndarray]:
    """Return the rest states within a temperature range, and K⁻¹Rᵀ of parts; None: all parts keep their state."""
    parts = parts_of(of)
    if not parts:
        return None, np.zeros((0, 0))
    linear, by_part = linear_branches(of, parts)
    changes = changes_branch(of, linear, temperatures)
    return within_stops(of, linear, by_part, temperatures) if changes else None, by_part


def _switching(case: TrussCase, of: Sliding, outputs: Sequence[Output], box: tuple[float, float] | None, attain: bool,
               simulate: bool | None) -> Bounds:
    """Return the bounds of a truss whose stops, plays or cables change their state."""
    at = switching(of)
    path = simulated(case, simulate)
    temperatures = Temperatures.of_box(of, box) if box else Temperatures.of_programs(of)
    hot = within_stops(of, at.linear, at.by_part, temperatures)
    made, histories = [], {}
    for output in outputs:
        bound, history = bound_of(at, case, output, path, attain, hot)
        made.append(bound)
        if history is not None:
            histories[output.name] = history
    facts = [f"{len(at.linear.parts)} stops, plays and cables are bounded branch by branch"]
    return Bounds(of.truss, "B", at.quality, at.why, facts, made, [str(joint) for joint in of.joints], of.limit_N,
                  hot.verdict, temperatures, histories)


def _margin(exact: Margin, rows: np.ndarray) -> float:
    if exact.quality == "estimate":
        return nan
    return 2 * exact.of_vector(rows)


def _over_range(of: Sliding, temperatures: Temperatures, found: WithinRange, first: Bound
                ) -> tuple[np.ndarray, np.ndarray]:
    """Return factors on the temperature range, and the spread of the first output within each range.

    The factors begin below the limit up to which joints settle, and end where the spread reaches the bound.
    """
    rows = first.output.rows(of)
    gains, _ = of.gains_of(rows)
    factors, spreads = [], []
    for one in np.geomspace(0.25 * found.verdict.factor, MOST_FACTOR * found.verdict.factor, POINTS):
        factors.append(one)
        scaled = temperatures.scaled(one)
        hot, by_part = _hot(of, scaled)
        spreads.append(within(of, scaled).extent(gains, first.spread)[0] if hot is None else hot.extent(
            gains, rows @ by_part, np.zeros(len(rows)), (first.spread, first.spread))[0])
        if not spreads[-1] < REACHED * first.spread:
            break
    return np.array(factors), np.array(spreads)
