# SPDX-License-Identifier: GPL-3.0-or-later
"""Worst state jump and worst excursion of a truss over temperature histories, beside their bounds."""
from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf, isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import diags

from statejump.core.errors import NotAllowed, Range, StatejumpError
from statejump.core.output import write_atomically
from statejump.core.progress import OnProgress
from statejump.core.tables import Shown, write_rows
from statejump.core.units import text
from statejump.kinds.truss.answers.jumps import node_jumps, quick_path
from statejump.kinds.truss.bounds.history import LEAST, all_slides, large_enough
from statejump.kinds.truss.bounds.outputs import Output, chosen
from statejump.kinds.truss.bounds.ranges import parsed_range
from statejump.kinds.truss.bounds.result import Bounds, plain
from statejump.kinds.truss.bounds.sliding import sliding
from statejump.kinds.truss.bounds.study import bounds
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, solve
from statejump.kinds.truss.worst.histories import CORNERS, Histories, histories
from statejump.kinds.truss.worst.search import JUMP, QUANTITIES, Search, excursions, jumps
from statejump.schema.rules import WHOLE, Rule

PATHS, CYCLES = 300, 3
PATHS_RULE = Rule(WHOLE, allowed=Range(1, 1_000_000))
CYCLES_RULE = Rule(WHOLE, allowed=Range(1, 100))
ABOVE = 1e-6  # relative excess over a bound that is rounding
MOST_ROWS = 3  # of a vector output, for which given histories are derived
AGREE = 1e-2  # relative difference between the search and the case that is reported


@dataclass(frozen=True)
class Worst:
    """The worst history found for a quantity of an output; numbers are in the unit of the output.

    :param quantity: "residual jump" or "peak", both from the start of the case
    :param found: the quantity in the run of ``case``
    :param bound: bound of the linear truss; NaN: none
    :param guaranteed: bound of the state jump over any history, with the margin of exact geometry; NaN: none
    :param nominal: the quantity in the case of the user; NaN: its program does not return to ΔT = 0
    """

    output: Output
    quantity: str
    found: float
    bound: float
    guaranteed: float
    nominal: float
    case: TrussCase

    @property
    def share(self) -> float:
        """The quantity over its bound."""
        return self.found / self.bound if self.bound > 0 else nan

    @property
    def verdict(self) -> str:
        """How close the history comes to the bound."""
        what = f"{self.output.name}, {self.quantity}: {text(self.found, self.output.unit, 5)}"
        if not isfinite(self.share):
            return f"{what}; no bound: a worse history may exist"
        if self.share <= 1 + ABOVE:
            return f"{what}, {100 * self.share:.4g} % of the bound"
        return (f"{what}, {100 * (self.share - 1):.2g} % above the bound of the linear truss: rotations and "
                "temperatures change its stiffness")

    def record(self) -> dict[str, Any]:
        """Return the result as plain values."""
        unit = self.output.unit
        numbers = {"found": self.found, "bound": self.bound, "guaranteed": self.guaranteed, "nominal": self.nominal}
        return {"output": self.output.name, "quantity": self.quantity,
                **{f"{key}_{unit}": plain(value) for key, value in numbers.items()},
                "found_over_bound": plain(self.share), "case": f"{self.case.name}.toml"}


@dataclass(frozen=True)
class WorstHistories:
    """The worst histories of all outputs, and facts about the search."""

    name: str
    text: str
    worst: Sequence[Worst]
    facts: Sequence[str]
    paths: int
    seed: int

    def summary_lines(self) -> list[Shown | str]:
        """Return the table and the lines that the command prints."""
        heads = ["output", "quantity", "found", "bound", "found / bound", "the case", "found / the case"]
        rows = [[one.output.name, one.quantity, *(_shown(value, one.output.unit) for value in (one.found, one.bound)),
                 _number(one.share, 5), _shown(one.nominal, one.output.unit),
                 _number(one.found / (one.nominal or nan), 4)] for one in self.worst]
        table = Shown(f"worst histories of {self.name}: {self.text}; from the start of the case", heads, rows,
                      left=("output", "quantity"))
        return [table, *(one.verdict for one in self.worst), *self.facts]

    def record(self) -> dict[str, Any]:
        """Return the result as plain values, as in ``worst.json``."""
        return {"case": self.name, "range": self.text, "paths": self.paths, "seed": self.seed,
                "facts": list(self.facts), "worst": [one.record() | {"verdict": one.verdict} for one in self.worst]}

    def write(self, folder: Path) -> list[Path]:
        """Write the table and a case of each history into a folder; return the paths."""
        with write_atomically(folder / "worst.json") as stream:
            json.dump(self.record(), stream, indent=1)
        table = write_rows(folder / "worst.csv", [
            {"output": one.output.name, "unit": one.output.unit, "quantity": one.quantity, "found": one.found,
             "bound": one.bound, "nominal": one.nominal, "case": f"{one.case.name}.toml"} for one in self.worst])
        return [table, folder / "worst.json", *(one.case.save(folder / f"{one.case.name}.toml") for one in self.worst)]


def _shown(value: float, unit: str) -> str:
    return text(value, unit) if isfinite(value) else ""


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}g}" if isfinite(value) else ""


def worst(case: TrussCase, range_K: str | tuple[float, float], output: Sequence[str] = (), groups: Sequence[str] = (),
          cycles: int = CYCLES, paths: int = PATHS, seed: int = 0,
          on_progress: OnProgress = lambda share: None) -> WorstHistories:
    """Search for the worst temperature histories of a truss.

    :param range_K: lowest and highest ΔT [K] of every member
    :param output: as for bounds, for example ``node:NAME.x``; default: the displacement that may differ most
    :param groups: patterns of names, separated by commas; members of a group have one common temperature
    :param cycles: largest number of cycles of a history
    :param paths: number of paths for each quantity of each output
    :raises StatejumpError: an argument is invalid, or no history has a path
    """
    low, high = parsed_range(range_K)
    PATHS_RULE.check("paths", paths)
    CYCLES_RULE.check("cycles", cycles)
    known = histories(case, low, high, groups)
    limits, reason, outputs = _bounded(case, known, [output] if isinstance(output, str) else output)
    search = Search(known, outputs, cycles, paths, np.random.default_rng(seed), on_progress)
    search.run(_given(known, limits, outputs, cycles))
    if search.best[outputs[0].name, JUMP].corners_K is None:
        raise StatejumpError(code="worst_without_path", place=case.name, case=case.name, first=search.failed[0])
    facts = [reason] if reason else [limits.guarantee] if limits else []
    if search.failed:
        facts.append(f"{len(search.failed)} of {search.solved} histories have no path, for example: {search.failed[0]}")
    nominal = solve(case)
    made = [_confirmed(case, known, one, quantity, search, limits, nominal, facts)
            for one in outputs for quantity in QUANTITIES]
    count = len(known.variables)
    return WorstHistories(case.name, f"{count} temperature(s) between {low:g} and {high:g} K, up to {cycles} cycle(s)",
                          made, facts, search.solved, seed)


def _bounded(case: TrussCase, known: Histories, names: Sequence[str]) -> tuple[Bounds | None, str, list[Output]]:
    """Return bounds or the reason why there are none, and the outputs."""
    limits, reason, outputs = None, "", list[Output]()
    try:
        limits = bounds(known.prepared, names, simulate=False)
    except NotAllowed:
        raise
    except StatejumpError as problem:
        reason = f"no bound: {problem}"
    if limits is not None:
        limits = limits if names else replace(limits, bounds=limits.bounds[:1])
        outputs = [one.output for one in limits.bounds]
    else:
        outputs = chosen(_Free(case.resolve()), names, lambda: np.abs(node_jumps(quick_path(case.resolve()))[-1]))
    return limits, reason, outputs if names else outputs[:1]


class _Free:
    """Displacements of the nodes of a truss, those of supports omitted."""

    def __init__(self, truss: ResolvedTruss) -> None:
        self.truss, self.of_nodes = truss, diags(1.0 - truss.nodes.fixed.ravel()).tocsr()


def _given(known: Histories, limits: Bounds | None, outputs: Sequence[Output], cycles: int) -> Iterator[np.ndarray]:
    """Yield histories from which the search begins: common temperatures, and those that lead to the bounds."""
    count = len(known.variables)
    for first, second in ((known.low_K, known.high_K), (known.high_K, known.low_K)):
        yield _repeated(np.array([np.full(count, first), np.full(count, second)]), cycles)
    if limits is None:
        return
    try:
        of = sliding(known.prepared)
    except StatejumpError:  # with clearances or free motions
        return
    # The first variable of the bounds is the common program, which no member follows.
    temperatures = replace(limits.temperatures, of_elements=limits.temperatures.of_elements[:, 1:],
                           lowest_K=limits.temperatures.lowest_K[1:], highest_K=limits.temperatures.highest_K[1:])
    heating = of.slides @ of.solve(of.heating_N_per_K @ temperatures.of_elements)
    for gain, thermal in (pair for output in outputs for pair in zip(*of.gains_of(output.rows(of)[:MOST_ROWS]))):
        for drive in ((gain * of.limit_N) @ heating, thermal @ temperatures.of_elements):
            ends = [np.where(sign * drive > 0, known.high_K, known.low_K) for sign in (1.0, -1.0)]
            for pair in (ends, ends[::-1]):
                yield _repeated(np.array(pair), cycles)
        ways = [partial(large_enough, least) for least in LEAST]
        if all(len(variable.items) == 1 for variable in known.variables):
            ways.insert(0, all_slides)  # type: ignore[arg-type]
        for way in ways:
            legs = way(of, temperatures, heating, gain)
            if legs is not None and np.isfinite(legs).all():
                yield from _within(known, legs, cycles)


def _within(known: Histories, legs: np.ndarray, cycles: int) -> Iterator[np.ndarray]:
    """Yield the corners of legs that begin and end at 0, cut off at the range; also in reverse order."""
    rests = np.flatnonzero(~legs.any(axis=1))
    corners = [legs[start + 1:end] for start, end in zip(rests, rests[1:]) if end > start + 1]
    found = np.array([one[[0, -1]] for one in corners])
    found = np.clip(found, known.low_K, known.high_K)
    for one in (found, found[::-1]):
        yield one[-cycles:]
        yield _repeated(one.reshape(-1, one.shape[2])[[0, -1]], cycles)


def _repeated(pair: np.ndarray, cycles: int) -> np.ndarray:
    assert len(pair) == CORNERS
    return np.repeat(pair[None], cycles, axis=0)


def _confirmed(case: TrussCase, known: Histories, output: Output, quantity: str, search: Search,
               limits: Bounds | None, nominal: TrussPath, facts: list[str]) -> Worst:
    """Return the worst history as a case, with the number of its run."""
    best = search.best[output.name, quantity]
    assert best.corners_K is not None
    short = output.name.removeprefix("node:")
    name = re.sub(r"[^A-Za-z0-9_-]", "_", f"{case.name}_worst_{quantity.split()[-1]}_{short}")
    made = known.case(best.corners_K, name, f"History with the worst {quantity} of {output.name}")
    path = solve(made)
    found = (float(jumps(output, path, known.returns_s(len(best.corners_K)))[-1]) if quantity == JUMP
             else float(excursions(output, path).max()))
    if abs(found - best.value) > AGREE * found:
        facts.append(f"{output.name}, {quantity}: the search with few increments found "
                     f"{text(best.value, output.unit, 5)}, the run of the case {text(found, output.unit, 5)}")
    bound, guaranteed = _limit(limits, output, quantity)
    own = float(excursions(output, nominal).max()) if quantity == "peak" else nan
    if quantity == JUMP and case.has_jump:
        own = float(jumps(output, nominal, nominal.states["time_s"][-1:])[0])
    return Worst(output, quantity, found, bound, guaranteed, own, made)


def _limit(limits: Bounds | None, output: Output, quantity: str) -> tuple[float, float]:
    """Return the bound of a quantity of the linear truss within the range, and that of any history, guaranteed."""
    if limits is None:
        return nan, nan
    bound = next(one for one in limits.bounds if one.output.name == output.name)
    if quantity == JUMP:
        within = bound.range_jump if isfinite(bound.range_jump) else inf
        return min(bound.jump, within), bound.jump + bound.margin
    if limits.letter != "A" or not output.scalar:
        return nan, nan
    start = float(bound.path[0, 0])
    low, high = bound.peak_thermal
    return max(high - start, start - low) + 0.5 * bound.spread, nan
