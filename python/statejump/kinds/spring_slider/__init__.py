# SPDX-License-Identifier: GPL-3.0-or-later
"""Kind ``spring_slider``: a heated bar that pushes a block with friction between stops, the paper's section 3."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from statejump.core.comparison import Comparison, Quantity
from statejump.core.progress import Tell
from statejump.core.run import Columns, Event, Run
from statejump.core.tables import Shown
from statejump.kinds.protocol import Kind
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.kinds.spring_slider.words import WORDS

if TYPE_CHECKING:
    from statejump.control.study import Study
    from statejump.core.charts import Chart
    from statejump.core.figures import Sheet
    from statejump.fe.ccx import Answer
    from statejump.kinds.spring_slider.convergence import Convergence
    from statejump.kinds.spring_slider.statics import RestSets


class SpringSlider(Kind[SpringSliderCase]):
    """The kind as one object."""

    name: ClassVar[str] = "spring_slider"
    Case = SpringSliderCase
    WORDS = WORDS
    # Same names for both models; a model has some of them.
    COLUMNS = (
        "time_s",
        "temperature_change_K",
        "displacement_m",
        "axial_force_N",  # compression positive
        "friction_force_N",  # of the ground on the block
        "stop_force_N",  # of the stops on the block
        "elastic_energy_J",  # of the link
        "preload_energy_J",
        "contact_energy_J",
        "kinetic_energy_J",
        "friction_dissipation_J",
        "damping_dissipation_J",
        "thermal_work_J",
        "external_work_J",  # of the normal force
        "slipping",
        "stop_contact",
        "floor_normal_force_N",
        "stage",
    )

    OUTCOMES = (
        "state_jump_m",
        "first_slip_temperature_change_K",
        "stop_reached_temperature_change_K",
        "stop_left_temperature_change_K",
        "friction_dissipation_J",
        "largest_axial_force_N",
    )
    AT_PROGRAM_END = ("displacement_at_program_end_m",)

    def reduced(self, case: SpringSliderCase, tell: Tell) -> Run:
        from statejump.kinds.spring_slider import reduced

        return reduced.run(case, tell)

    def samples(self, case: SpringSliderCase, model: str) -> int:
        from statejump.kinds.spring_slider import reduced

        return len(reduced.sample_times(case)) if model == "reduced" else super().samples(case, model)

    def dem_input(self, case: SpringSliderCase) -> dict[str, Any]:
        from statejump.kinds.spring_slider import dem

        return dem.dem_input(case)

    def dem_run(self, case: SpringSliderCase, columns: Columns, about: Mapping[str, Any]) -> Run:
        from statejump.kinds.spring_slider import result

        return result.dem_run(case, columns, about)

    def compare(self, case: SpringSliderCase, reduced: Run, dem: Run) -> Comparison:
        from statejump.kinds.spring_slider import compare

        return compare.compare(case, reduced, dem)

    def difference(self, case: SpringSliderCase, first: Run, second: Run) -> list[Quantity]:
        from statejump.kinds.spring_slider import compare

        return compare.difference(case, first, second)

    def names(self, case: SpringSliderCase) -> dict[str, list[str]]:
        from statejump.kinds.spring_slider import result

        return result.names(case)

    def scene(self, case: SpringSliderCase) -> dict[str, Any]:
        from statejump.kinds.spring_slider import result

        return result.scene(case)

    def sheet(self, case: SpringSliderCase, runs: Sequence[Run]) -> Sheet:
        from statejump.kinds.spring_slider import figure

        return figure.sheet(case, runs)

    def told(self, case: SpringSliderCase, runs: Mapping[str, Run]) -> list[Shown | str]:
        from statejump.kinds.spring_slider import words

        return words.told(case, runs)

    def describe(self, case: SpringSliderCase) -> list[str]:
        from statejump.kinds.spring_slider import words

        return words.describe(case)

    def fe(self, case: SpringSliderCase) -> Answer:
        """Return the case in CalculiX, with frictional contact, beside the reduced model."""
        from statejump.kinds.spring_slider import fe

        return fe.answer(case)

    def statics(self, case: SpringSliderCase, friction_coefficient: float | None = None) -> RestSets:
        from statejump.kinds.spring_slider import statics

        return statics.statics(case, friction_coefficient)

    def charts(self, case: SpringSliderCase) -> list[Chart]:
        from statejump.kinds.spring_slider import charts

        return charts.charts(case)

    def event_reason(self, case: SpringSliderCase, event: Event, model: str, runs: Mapping[str, Run]) -> str:
        from statejump.kinds.spring_slider import words

        return words.event_reason(event, model, runs)

    def quick(self, case: SpringSliderCase) -> Run:
        from statejump.kinds.spring_slider import reduced

        return reduced.quick(case)

    def outcomes(self, case: SpringSliderCase, run: Run) -> dict[str, float]:
        from statejump.kinds.spring_slider import outcomes

        return outcomes.outcomes(case, run)

    def control(self, case: SpringSliderCase, **settings: Any) -> Study:
        """Return what makes the state jump smaller; see :func:`.control.control`."""
        from statejump.kinds.spring_slider import control

        case.need_jump("'statejump control'")
        found = control.control(case, **settings)
        found.remarks += case.thermal_notes
        return found

    def convergence(self, case: SpringSliderCase, tell: Tell, decades: int = 0) -> Convergence:
        """Return how the DEM approaches the reduced model; see :func:`.convergence.convergence`."""
        from statejump.kinds.spring_slider import convergence

        return convergence.convergence(case, tell, decades)


KIND = SpringSlider()
