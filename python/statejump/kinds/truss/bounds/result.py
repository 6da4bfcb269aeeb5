# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of a truss: tables, files, pictures."""
from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.figures import save
from statejump.core.output import write_atomically
from statejump.core.tables import Shown, write_csv
from statejump.core.units import text
from statejump.kinds.truss.bounds.figure import bars, coloured, sectors_figure, staircase, zonogon_figure
from statejump.kinds.truss.bounds.history import Attained
from statejump.kinds.truss.bounds.outputs import Output
from statejump.kinds.truss.bounds.ranges import Temperatures, Verdict
from statejump.kinds.truss.resolved import ResolvedTruss

MOST_DRAWN = 500  # joints in the picture of the truss
RANKED = 10  # joints in the printed table
NUMBERS = ("spread", "reached", "margin", "jump", "range_spread", "range_jump", "simulated", "attained")
UNITS = {"m": ("µm", 1e6), "rad": ("µrad", 1e6)}


@dataclass(frozen=True)
class Bound:
    """Bounds of one output, in its unit: m or rad. ``spread_m`` or ``spread_rad`` are the same as ``spread``.

    :param spread: bound of the largest difference between two rest states after any temperature histories, linear
    :param reached: largest difference of two rest states that was found, linear; the spread if it is exact
    :param margin: what exact geometry may add to the spread; NaN: not derived
    :param jump: bound of the difference of a rest state from the start of the case, after any history, linear
    :param range_spread: spread within the temperature range; NaN: not computed
    :param range_jump: likewise
    :param simulated: size of the jump of the case; NaN: not simulated
    :param attained: spread of the simulated history that attains the bound; NaN: not requested
    :param fraction: contribution of each joint to the spread
    :param peak_thermal: largest excursion from the equilibrium without friction due to temperature alone
    :param corners: corners (k, 2) of the rest states of an output with two components, from their centre
    :param path: the path of the case from this centre
    :param by_stiffness: derivatives of the spread by the logarithm of the stiffness of each element; None: not computed
    """

    output: Output
    spread: float
    reached: float
    margin: float
    jump: float
    range_spread: float
    range_jump: float
    simulated: float
    attained: float
    fraction: np.ndarray
    peak_thermal: tuple[float, float]
    corners: np.ndarray | None = None
    path: np.ndarray = field(default_factory=lambda: np.zeros((0, 1)))
    by_stiffness: np.ndarray | None = None

    def __getattr__(self, name: str) -> Any:
        what, _, unit = name.rpartition("_")
        if what in (*NUMBERS, "peak_thermal") and unit == self.output.unit:
            return getattr(self, what)
        raise AttributeError(name)

    def record(self) -> dict[str, Any]:
        """Return the bound as plain values."""
        unit = self.output.unit
        return {"output": self.output.name, **{f"{name}_{unit}": plain(getattr(self, name)) for name in NUMBERS},
                f"peak_thermal_{unit}": [plain(one) for one in self.peak_thermal],
                f"peak_friction_{unit}": plain(0.5 * self.spread), "unbounded": bool(np.isinf(self.spread))}

    def shown(self, name: str) -> str:
        """Return a number as text in the unit of tables; empty: not computed."""
        value = getattr(self, name)
        return "" if np.isnan(value) else f"{UNITS[self.output.unit][1] * value:.6g}"


def plain(value: float) -> float | None:
    """Return a number; None: it is not computed, or infinite."""
    return float(value) if np.isfinite(value) else None


@dataclass(frozen=True)
class Bounds:
    """Bounds of a truss: what is guaranteed, and of each output.

    :param letter: class of the truss: "A", "B" or "C"
    :param quality: "exact", "linear" or "estimate"
    :param spread_in_range: spread of the first output within the range times a factor; None: no picture
    """

    truss: ResolvedTruss
    letter: str
    quality: str
    why: str
    facts: Sequence[str]
    bounds: Sequence[Bound]
    joints: Sequence[str]
    limit_N: np.ndarray
    verdict: Verdict
    temperatures: Temperatures
    attained: Mapping[str, Attained]
    over_range: Callable[[], tuple[np.ndarray, np.ndarray]] | None = None
    contacts: Any = None  # Contacts of clearance revolutes
    elements: Sequence[str] = ()  # links and springs of Bound.by_stiffness

    @property
    def guarantee(self) -> str:
        """What is guaranteed: exact, linear with a margin, or an estimate, and why."""
        if self.quality != "linear":
            return f"class {self.letter}, {self.quality}: {self.why}"
        most = max((bound.margin / bound.spread for bound in self.bounds if bound.spread > 0), default=0.0)
        return f"class {self.letter}, linear, margin {100 * most:.2g} %: {self.why}"

    def summary_lines(self) -> list[Shown | str]:
        """Return tables and lines that the command prints."""
        found: list[Shown | str] = [self.guarantee, *self.facts]
        found += [self._table(unit, symbol) for unit, (symbol, _) in UNITS.items()
                  if any(bound.output.unit == unit for bound in self.bounds)]
        found.append(Shown(f"joints by contribution to {self.bounds[0].output.name}",
                           ["joint", "contribution [%]", "slips in range"], self._ranking(), left=("joint",)))
        found += [f"{bound.output.name}: peak {text(bound.peak_thermal[0], bound.output.unit, 4)} to "
                  f"{text(bound.peak_thermal[1], bound.output.unit, 4)} by temperature, "
                  f"± {text(0.5 * bound.spread, bound.output.unit, 4)} by friction" for bound in self.bounds
                  if not np.isnan(bound.peak_thermal[0])]
        return [*found, f"{self.temperatures.text}: {self.verdict.text}"]

    def _table(self, unit: str, symbol: str) -> Shown:
        heads = ["output", f"spread [{symbol}]", f"reached [{symbol}]", "margin [%]", f"jump [{symbol}]",
                 f"in range, linear [{symbol}]", f"simulated [{symbol}]", f"attained [{symbol}]", "attained / spread"]
        rows = [[bound.output.name, bound.shown("spread"), bound.shown("reached"),
                 _number(100 * bound.margin / (bound.spread or 1.0)), bound.shown("jump"), bound.shown("range_jump"),
                 bound.shown("simulated"), bound.shown("attained"), _number(bound.attained / (bound.spread or 1.0), 7)]
                for bound in self.bounds if bound.output.unit == unit]
        return Shown(f"bounds of {self.truss.name}: any temperature history; jump, in range and simulated "
                     "from the start of the case", heads, rows, left=("output",))

    def _ranking(self) -> list[list[str]]:
        fraction, slips = self.bounds[0].fraction, self.verdict.slips
        order = np.argsort(-fraction, kind="stable")[:RANKED]
        return [[self.joints[index], f"{100 * fraction[index]:.1f}",
                 "unknown" if slips is None else "may" if slips[index] else "never"] for index in order]

    def record(self) -> dict[str, Any]:
        """Return the bounds as plain values, as in ``bounds.json``."""
        return {
            "case": self.truss.name, "class": self.letter, "quality": self.quality, "why": self.why,
            "facts": list(self.facts), "bounds": [bound.record() for bound in self.bounds],
            "range": self.temperatures.text, "verdict": self.verdict.record(),
            "joints": [{"joint": joint, "friction_limit_N": plain(limit),
                        "fraction": {bound.output.name: float(bound.fraction[index]) for bound in self.bounds},
                        "spread_by_limit": {bound.output.name: plain(bound.spread * bound.fraction[index] / limit)
                                            if limit > 0 else None for bound in self.bounds}}
                       for index, (joint, limit) in enumerate(zip(self.joints, self.limit_N))],
            "elements": [{"element": element, "spread_by_log_stiffness": {
                bound.output.name: float(bound.by_stiffness[index]) for bound in self.bounds
                if bound.by_stiffness is not None}} for index, element in enumerate(self.elements)],
        }

    def write(self, folder: Path) -> list[Path]:
        """Write bounds, ranking, pictures and histories into a folder; return the paths."""
        keys = ["output", *(f"{name}_{unit}" for unit in UNITS if any(one.output.unit == unit for one in self.bounds)
                            for name in NUMBERS)]
        table = write_csv(folder / "bounds.csv", keys,
                          ([row.get(key) for key in keys] for row in (bound.record() for bound in self.bounds)))
        joints = write_csv(
            folder / "joints.csv", ("joint", "friction_limit_N", *(bound.output.name for bound in self.bounds)),
            ((joint, float(limit), *(float(bound.fraction[index]) for bound in self.bounds))
             for index, (joint, limit) in enumerate(zip(self.joints, self.limit_N))))
        with write_atomically(folder / "bounds.json") as stream:
            json.dump(self.record(), stream, indent=1)
        cases = [one.case.save(folder / f"{one.case.name}.toml") for one in self.attained.values()]
        pictures = save(self.plot(), folder, "bounds")
        if len(self.joints) <= MOST_DRAWN:
            pictures += save(coloured(self.truss, self.joints, self.bounds[0]), folder, "bounds_joints")
        if self.contacts is not None:
            pictures += save(sectors_figure(self.truss.name, self.contacts), folder, "bounds_sectors")
        if self.over_range is not None:
            pictures += save(self.plot_range(), folder, "bounds_over_range")
        for bound in self.bounds:
            if bound.corners is not None:
                pictures += save(zonogon_figure(self.truss.name, bound), folder,
                                 "bounds_plane" + "".join(c if c.isalnum() else "_" for c in bound.output.name))
        return [table, joints, folder / "bounds.json", *cases, *pictures]

    def plot_range(self) -> Any:
        """Return the picture of the spread over the temperature range."""
        first = self.bounds[0]
        assert self.over_range is not None
        return staircase(self.truss.name, first.output, first.spread, self.temperatures.highest_K.max(),
                         self.temperatures.lowest_K.min(), *self.over_range())

    def plot(self) -> Any:
        """Return the picture of the bounds."""
        return bars(self.truss.name, self.bounds)


def _number(value: float, digits: int = 2) -> str:
    return "" if np.isnan(value) else f"{value:.{digits}g}"
