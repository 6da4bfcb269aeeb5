# SPDX-License-Identifier: GPL-3.0-or-later
"""A kind of case unknown to the package: a rod held at one end by friction, which expands and returns.

Its reduced model is a closed form. Its "DEM" is the same with a known error, without YADE. The kind has only what the
tests need to show that a kind can be added without changes to the package.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from statejump.core.case import Case
from statejump.core.comparison import Comparison, Quantity, models
from statejump.core.figures import Sheet
from statejump.core.progress import OnProgress
from statejump.core.run import Events, Run, columns_of
from statejump.core.tables import Shown
from statejump.kinds.protocol import Kind
from statejump.results import scene as drawing
from statejump.schema.fields import Section, definition, parameter, section, whole


@definition
class Rod(Section):
    """The rod."""

    length_m: float = parameter(..., "m", 0, 10, "the test", above=True)
    thermal_expansion_per_K: float = parameter(2e-5, "1/K", -1e-3, 1e-3, "the test")
    residue: float = parameter(0.1, "-", 0, 1, "share of the expansion that stays")


@definition
class Numerics(Section):
    """How it is sampled."""

    samples_per_cycle: int = whole(20, 2, 1000, "the test")
    error_m: float = parameter(0.0, "m", -1, 1, "of the model that stands for the DEM")
    tolerance_m: float = parameter(1e-9, "m", 0, 1, "the test", above=True)


@definition
class ToyCase(Case):
    """A rod that comes back with a residue."""

    KIND: ClassVar[str] = "toy"

    rod: Rod = section(Rod, required=True)
    numerics: Numerics = section(Numerics)

    @property
    def samples_per_cycle(self) -> int:
        return self.numerics.samples_per_cycle


class Toy(Kind[ToyCase]):
    name = "toy"
    Case = ToyCase
    COLUMNS = ("time_s", "temperature_change_K", "tip_m", "elastic_energy_J")
    OUTCOMES = ("tip_jump_m",)

    def _run(self, case: ToyCase, model: str, error_m: float) -> Run:
        time = np.linspace(0, case.duration_s, case.samples_per_cycle * case.thermal.cycles + 1)
        program = case.thermal_program()
        change = np.array([program.temperature_change(t) for t in time])
        largest = np.maximum.accumulate(np.abs(change))
        grown = case.rod.length_m * case.rod.thermal_expansion_per_K
        tip = grown * ((1 - case.rod.residue) * change + case.rod.residue * largest) + error_m * time
        columns = {"time_s": time, "temperature_change_K": change, "tip_m": tip, "elastic_energy_J": 0 * time}
        plain, energy = columns_of(columns)
        return Run(model, plain, energy, {}, {}, Events([]), {"tip_jump_m": float(tip[-1] - tip[0])}, self.names(case),
                   lambda: case)

    def reduced(self, case: ToyCase, on_progress: OnProgress) -> Run:
        on_progress(1.0)
        return self._run(case, "reduced", 0.0)

    def dem_input(self, case: ToyCase) -> dict[str, Any]:
        return case.to_dict()

    def dem(self, case: ToyCase, on_progress: OnProgress) -> Run:
        on_progress(1.0)
        return self._run(case, "dem", case.numerics.error_m)

    def compare(self, case: ToyCase, reduced: Run, dem: Run) -> Comparison:
        row = models("tip_jump", "m", reduced.summary["tip_jump_m"], dem.summary["tip_jump_m"],
                     case.numerics.tolerance_m)
        return Comparison(case, {"reduced": reduced, "dem": dem}, (row,))

    def difference(self, case: ToyCase, first: Run, second: Run) -> list[Quantity]:
        return list(self.compare(case, first, second).rows)

    def names(self, case: ToyCase) -> dict[str, list[str]]:
        return {}

    def scene(self, case: ToyCase) -> dict[str, Any]:
        tip = drawing.ref("history/tip_m")
        return drawing.description([{"name": "rod", "type": "frame", "points": [[0, 0, 0], [case.rod.length_m, 0, 0]]},
                                    {"name": "tip", "type": "block", "centre": [tip, 0.0, 0.0], "angle_rad": 0.0,
                                     "half_width_m": 0.01, "half_height_m": 0.01}], [], 0.0)

    def sheet(self, case: ToyCase, runs: Sequence[Run]) -> Sheet:
        def draw(axes: Any) -> None:
            for run in runs:
                axes.plot(run["temperature_change_K"], run["tip_m"])
            axes.set_xlabel("Temperature change [K]")
            axes.set_ylabel("Tip [m]")

        return Sheet([draw], 1, (5, 4), case.title)

    def summary_lines(self, case: ToyCase, runs: Mapping[str, Run]) -> list[Shown | str]:
        return [f"jump of the tip: {run.summary['tip_jump_m']:.6e} m" for run in runs.values()]

    def describe(self, case: ToyCase) -> list[str]:
        return [f"A rod of {case.rod.length_m:g} m that comes back with a residue."]

    def outcomes(self, case: ToyCase, run: Run) -> dict[str, float]:
        return {"tip_jump_m": run.summary["tip_jump_m"]}


KIND = Toy()
