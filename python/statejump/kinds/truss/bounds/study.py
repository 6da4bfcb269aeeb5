# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of the rest states of a truss over any temperature history, and of single outputs."""
from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.core.figures import save
from statejump.core.output import write_atomically
from statejump.core.tables import Shown, write_csv
from statejump.core.units import text
from statejump.kinds.truss.bounds.figure import bars, staircase
from statejump.kinds.truss.bounds.history import MOST_K, Attained, attained
from statejump.kinds.truss.bounds.margin import Margin, margin
from statejump.kinds.truss.bounds.outputs import Output, chosen
from statejump.kinds.truss.bounds.ranges import Temperatures, Verdict, WithinRange, parsed_range, within
from statejump.kinds.truss.bounds.sliding import Sliding, sliding
from statejump.kinds.truss.bounds.states import kept_states
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.solve import path as start_of
from statejump.kinds.truss.solve import solve

MOST_SIMULATED = 100  # joints of a case that is simulated for comparison
POINTS = 24  # ranges of the picture of the spread over the temperature range
MOST_FACTOR = 200.0  # on the range up to which joints settle
REACHED = 0.999  # of the bound over any history, where this picture ends
RANKED = 10  # joints in the printed table


@dataclass(frozen=True)
class Bound:
    """Bounds of one output [m].

    :param spread_m: largest difference between two rest states after any temperature histories, linear
    :param margin_m: what exact geometry may add to it; NaN: not derived
    :param jump_m: bound of |rest state − start of the case| after any history, linear
    :param range_spread_m: spread within the temperature range; NaN: not computed
    :param range_jump_m: likewise
    :param simulated_m: |jump| of the case; NaN: not simulated
    :param attained_m: spread of the simulated history that attains the bound; NaN: not requested
    :param fraction: contribution of each joint to the spread
    :param peak_thermal_m: largest excursion from the equilibrium without friction due to temperature alone
    """

    output: Output
    spread_m: float
    margin_m: float
    jump_m: float
    range_spread_m: float
    range_jump_m: float
    simulated_m: float
    attained_m: float
    fraction: np.ndarray
    peak_thermal_m: tuple[float, float]

    def record(self) -> dict[str, Any]:
        """Return the bound as plain values."""
        numbers = {key: value for key, value in vars(self).items() if key.endswith("_m") and key != "peak_thermal_m"}
        return {"output": self.output.name, **{key: _plain(value) for key, value in numbers.items()},
                "peak_thermal_m": list(self.peak_thermal_m), "peak_friction_m": 0.5 * self.spread_m}


def _plain(value: float) -> float | None:
    return None if np.isnan(value) else float(value)


@dataclass(frozen=True)
class Bounds:
    """Bounds of a truss: what is guaranteed, and of each output."""

    of: Sliding
    margin: Margin
    facts: Sequence[str]
    bounds: Sequence[Bound]
    verdict: Verdict
    temperatures: Temperatures
    attained: Mapping[str, Attained]
    pictures_range: bool = False

    @property
    def guarantee(self) -> str:
        """What is guaranteed: exact, linear with a margin, or an estimate, and why."""
        if self.margin.quality != "linear":
            return f"class A, {self.margin.quality}: {self.margin.why}"
        most = max((bound.margin_m / bound.spread_m for bound in self.bounds if bound.spread_m > 0), default=0.0)
        return f"class A, linear, margin {100 * most:.2g} %: {self.margin.why}"

    def summary_lines(self) -> list[Shown | str]:
        """Return tables and lines that the command prints."""
        heads = ["output", "spread [µm]", "margin [%]", "jump [µm]", "in range, linear [µm]", "simulated [µm]",
                 "attained [µm]", "attained / spread"]
        rows = [[bound.output.name, _um(bound.spread_m), _number(100 * bound.margin_m / (bound.spread_m or 1.0)),
                 _um(bound.jump_m), _um(bound.range_jump_m), _um(bound.simulated_m), _um(bound.attained_m),
                 _number(bound.attained_m / (bound.spread_m or 1.0), 7)] for bound in self.bounds]
        found: list[Shown | str] = [self.guarantee, *self.facts]
        found.append(Shown(f"bounds of {self.of.truss.name}: any temperature history; jump, in range and simulated "
                           "from the start of the case", heads, rows, left=("output",)))
        found.append(Shown(f"joints by contribution to {self.bounds[0].output.name}",
                           ["joint", "contribution [%]", "slips in range"], self._ranking(), left=("joint",)))
        found += [f"{bound.output.name}: peak {text(bound.peak_thermal_m[0], 'm', 4)} to "
                  f"{text(bound.peak_thermal_m[1], 'm', 4)} by temperature, ± {text(0.5 * bound.spread_m, 'm', 4)} by "
                  "friction" for bound in self.bounds]
        return [*found, f"{self.temperatures.text}: {self.verdict.text}"]

    def _ranking(self) -> list[list[str]]:
        fraction, slips = self.bounds[0].fraction, self.verdict.slips
        order = np.argsort(-fraction, kind="stable")[:RANKED]
        return [[str(self.of.joints[index]), f"{100 * fraction[index]:.1f}",
                 "unknown" if slips is None else "may" if slips[index] else "never"] for index in order]

    def record(self) -> dict[str, Any]:
        """Return the bounds as plain values, as in ``bounds.json``."""
        return {
            "case": self.of.truss.name, "class": "A", "quality": self.margin.quality, "why": self.margin.why,
            "facts": list(self.facts), "bounds": [bound.record() for bound in self.bounds],
            "range": self.temperatures.text, "verdict": self.verdict.record(),
            "joints": [{"joint": str(joint), "friction_limit_N": float(limit),
                        "fraction": {bound.output.name: float(bound.fraction[index]) for bound in self.bounds}}
                       for index, (joint, limit) in enumerate(zip(self.of.joints, self.of.limit_N))],
        }

    def write(self, folder: Path) -> list[Path]:
        """Write bounds, ranking, picture and histories into a folder; return the paths."""
        numbers = [bound.record() for bound in self.bounds]
        keys = [key for key in numbers[0] if key != "peak_thermal_m"]
        table = write_csv(folder / "bounds.csv", keys, ([row[key] for key in keys] for row in numbers))
        joints = write_csv(
            folder / "joints.csv", ("joint", "friction_limit_N", *(bound.output.name for bound in self.bounds)),
            ((str(joint), float(limit), *(float(bound.fraction[index]) for bound in self.bounds))
             for index, (joint, limit) in enumerate(zip(self.of.joints, self.of.limit_N))))
        with write_atomically(folder / "bounds.json") as stream:
            json.dump(self.record(), stream, indent=1)
        cases = [one.case.save(folder / f"{one.case.name}.toml") for one in self.attained.values()]
        pictures = save(self.plot(), folder, "bounds")
        if self.pictures_range:
            pictures += save(self.plot_range(), folder, "bounds_over_range")
        return [table, joints, folder / "bounds.json", *cases, *pictures]

    def over_range(self, points: int = POINTS) -> tuple[np.ndarray, np.ndarray]:
        """Return factors on the temperature range, and the spread [m] of the first output within each range.

        The factors begin at half of the limit up to which joints settle, and end where the spread reaches the bound.
        """
        first, factor = self.bounds[0], self.verdict.factor
        if not np.isfinite(factor):
            return np.zeros(0), np.zeros(0)
        gain, _ = self.of.gains(first.output.row(self.of))
        factors, spreads = [], []
        for one in np.geomspace(0.25 * factor, MOST_FACTOR * factor, points):
            factors.append(one)
            spreads.append(within(self.of, self.temperatures.scaled(one)).spread(gain)[0])
            if not spreads[-1] < REACHED * first.spread_m:
                break
        return np.array(factors), np.array(spreads)

    def plot_range(self) -> Any:
        """Return the picture of the spread over the temperature range."""
        first = self.bounds[0]
        return staircase(self.of.truss.name, first.output.name, first.spread_m, self.temperatures.highest_K.max(),
                         self.temperatures.lowest_K.min(), *self.over_range())

    def plot(self) -> Any:
        """Return the picture of the bounds."""
        return bars(self.of.truss.name, [
            (bound.output.name, bound.spread_m, bound.range_spread_m, bound.attained_m, bound.simulated_m)
            for bound in self.bounds])


def _um(value: float) -> str:
    return "" if np.isnan(value) else f"{1e6 * value:.6g}"


def _number(value: float, digits: int = 2) -> str:
    return "" if np.isnan(value) else f"{value:.{digits}g}"


def bounds(case: TrussCase, output: Sequence[str] = (), range_K: str | tuple[float, float] | None = None,
           attain: bool = False, simulate: bool | None = None) -> Bounds:
    """Return bounds of the state jump over any temperature history.

    :param output: ``node:NAME`` or ``node:NAME.x``; default: the nodes with the largest spread
    :param range_K: lowest and highest ΔT [K] of every member, each by itself; default: the programs of the case
    :param attain: whether to find, write and simulate the history that attains the bound
    :param simulate: whether to simulate the case; default: with at most MOST_SIMULATED joints
    :raises StatejumpError: the truss is not of class A: a joint has clearance, a stop or a cable may change its state,
        or only friction holds a motion
    """
    box = None if range_K is None else parsed_range(range_K)
    of = sliding(case)
    if not np.any(of.limit_N > 0):
        raise StatejumpError(code="bounds_without_friction", place=case.name, case=case.name)
    outputs = chosen(of, [output] if isinstance(output, str) else output)
    exact = margin(of)
    facts = kept_states(of, lambda rows: np.abs(rows @ of.by_friction) @ of.limit_N + exact.of(rows))
    temperatures = Temperatures.of_box(of, box) if box else Temperatures.of_programs(of)
    found = within(of, temperatures)
    simulate = len(of.joints) <= MOST_SIMULATED if simulate is None else simulate
    path = (solve(case).states["displacement_m"] if simulate
            else start_of(of.truss, progress=lambda share: share <= 0).states["displacement_m"][:1])
    made, histories = [], {}
    for one in outputs:
        reached = attained(case, of, one) if attain else None
        if reached is not None:
            histories[one.name] = reached
        elif attain:
            facts.append(f"no temperatures of single members up to {MOST_K:g} K lead to the bound of {one.name}")
        made.append(_bound(of, one, exact, found, temperatures, path, reached))
    return Bounds(of, exact, facts, made, found.verdict, temperatures, histories,
                  pictures_range=box is not None and np.isfinite(found.verdict.factor))


def _bound(of: Sliding, output: Output, exact: Margin, found: WithinRange, temperatures: Temperatures,
           path_m: np.ndarray, reached: Attained | None) -> Bound:
    row = output.row(of)
    gain, thermal = of.gains(row)
    parts = np.abs(gain) * of.limit_N
    spread = 2 * float(parts.sum())
    start = float(output.value(path_m[0]) - output.value(of.displacement_m))
    in_range = found.spread(gain)
    return Bound(
        output=output, spread_m=spread, jump_m=min(0.5 * spread + abs(start), spread),
        margin_m=nan if exact.quality == "estimate" else 2 * float(exact.of(row[None])[0]),
        range_spread_m=in_range[0], range_jump_m=in_range[1],
        simulated_m=nan if len(path_m) < 2 else abs(float(output.value(path_m[-1]) - output.value(path_m[0]))),
        attained_m=nan if reached is None else reached.spread_m, fraction=parts / (parts.sum() or 1.0),
        peak_thermal_m=temperatures.peak(thermal))
