# SPDX-License-Identifier: GPL-3.0-or-later
"""Kind ``truss``: trusses of many joints with friction and clearance."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

from statejump.core.comparison import Comparison, Quantity
from statejump.core.errors import Interrupted
from statejump.core.progress import Tell
from statejump.core.run import Columns, Run
from statejump.core.tables import Shown
from statejump.kinds.protocol import Kind
from statejump.kinds.truss.case import TrussCase

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from statejump.control.study import Study
    from statejump.core.figures import Sheet
    from statejump.fe.ccx import Answer
    from statejump.kinds.truss.answers.study import TrussAnswers
    from statejump.kinds.truss.contact_problems import ContactProblem
    from statejump.kinds.truss.creak import Creak
    from statejump.kinds.truss.page import TrussPart
    from statejump.results.contents import Result
    from statejump.surface.design import Design


class Truss(Kind[TrussCase]):
    """The kind as one object."""

    name: ClassVar[str] = "truss"
    Case = TrussCase
    # Columns by item follow in the order given.
    COLUMNS = (
        "time_s",
        "temperature_change_K",
        "elastic_energy_J",  # of links, springs, torsion springs and contacts
        "kinetic_energy_J",
        "friction_dissipation_J",
        "damping_dissipation_J",  # of links, pins and contacts
        "impact_dissipation_J",  # of contacts across their surfaces, in motion
        "thermal_work_J",
        "external_work_J",  # of the dead loads and drives
    )
    OUTCOMES = (
        "largest_node_jump_m",
        "rms_node_jump_m",
        "reflector_rms_of_change_m",
        "reflector_rms_error_m",
        "reflector_tilt_change_rad",
        "reflector_depth_change_m",
        "friction_dissipation_J",
        "slipping_joints",
        "largest_axial_force_N",
    )
    AT_PROGRAM_END = ("largest_displacement_at_program_end_m",)
    OUTCOMES_OF = ("reduced",)

    def outcome_names(self, case: TrussCase) -> tuple[str, ...]:
        return tuple(name for name in self.OUTCOMES if case.reflector is not None or not name.startswith("reflector_"))

    def reduced(self, case: TrussCase, tell: Tell) -> Run:
        from statejump.kinds.truss import result, solve

        return result.reduced_run(case, solve.solve(case, tell), result.sample_times(case))

    def dynamic(self, case: TrussCase, tell: Tell) -> Run:
        from statejump.kinds.truss import motion, result

        try:
            return result.motion_run(case, motion.simulate(case, tell))
        except Interrupted as stopped:
            if stopped.run is not None:
                stopped.run = replace(result.motion_run(case, stopped.run), complete=False)
            raise stopped from None

    def dem_input(self, case: TrussCase) -> dict[str, Any]:
        from statejump.kinds.truss import dem

        return dem.dem_input(case)

    def check_dem(self, case: TrussCase) -> None:
        from statejump.core.yade_process import find_yade
        from statejump.kinds.truss import dem

        dem.check(case)
        find_yade()

    def dem(self, case: TrussCase, tell: Tell) -> Run:
        from statejump.kinds.truss import dem, result

        return dem.run(case, self.scene_module(), result.dem_run, tell)

    def dem_run(self, case: TrussCase, columns: Columns, about: Mapping[str, Any]) -> Run:
        from statejump.kinds.truss import result

        return result.dem_run(case, columns, about)

    def compare(self, case: TrussCase, reduced: Run, dem: Run) -> Comparison:
        from statejump.kinds.truss import compare

        return compare.compare(case, reduced, dem)

    def difference(self, case: TrussCase, first: Run, second: Run) -> list[Quantity]:
        from statejump.kinds.truss import compare

        return compare.difference(case, first, second)

    def names(self, case: TrussCase) -> dict[str, list[str]]:
        from statejump.kinds.truss import result

        return result.names(case)

    def scene(self, case: TrussCase) -> dict[str, Any]:
        from statejump.kinds.truss import result

        return result.scene(case)

    def sheet(self, case: TrussCase, runs: Sequence[Run]) -> Sheet:
        from statejump.kinds.truss import figure

        return figure.sheet(case, runs)

    def told(self, case: TrussCase, runs: Mapping[str, Run]) -> list[Shown | str]:
        from statejump.kinds.truss import words

        return words.told(case, runs)

    def describe(self, case: TrussCase) -> list[str]:
        from statejump.kinds.truss import words

        return words.describe(case)

    def quick(self, case: TrussCase) -> Run:
        from statejump.kinds.truss import outcomes

        return outcomes.quick(case)

    def page(self, result: Result, case: TrussCase) -> TrussPart | None:
        from statejump.kinds.truss import page

        return page.page(result, case)

    def outcomes(self, case: TrussCase, run: Run) -> dict[str, float]:
        from statejump.kinds.truss import outcomes

        return outcomes.outcomes(case, run)

    def draw(self, case: TrussCase, axes: Axes | None = None, names: bool = False) -> Figure:
        """Draw what the case says, before anything is solved."""
        from statejump.kinds.truss import draw

        return draw.draw(case, axes, names)

    def surface(self, case: TrussCase) -> tuple[Design, np.ndarray]:
        """Return the drawn surface of its reflector and the places of the nodes."""
        from statejump.kinds.truss import reflector

        return reflector.surface(case)

    def contact_problems(self, case: TrussCase, number: int, tell: Tell) -> list[ContactProblem]:
        """Return frictional contact problems of steps of the path."""
        from statejump.kinds.truss import contact_problems

        return contact_problems.contact_problems(case, number, tell)

    def creak(self, case: TrussCase, node: str, tell: Tell) -> Creak:
        """Return what a node feels while the truss moves; see :func:`statejump.truss.creak`."""
        from statejump.kinds.truss import creak

        return creak.creak(case, node, tell)

    def fe(self, case: TrussCase) -> Answer:
        """Return the truss with locked joints in CalculiX beside the solver."""
        from statejump.kinds.truss import fe

        return fe.answer(case)

    def control(self, case: TrussCase, **settings: Any) -> Study:
        """Return what keeps the jump of a node below a value; see :func:`statejump.truss.control`."""
        from statejump.kinds.truss.control import study

        case.need_jump("'statejump control'")
        found = study.control(case, **settings)
        found.remarks += case.thermal_notes
        return found

    def answers(self, case: TrussCase, **settings: Any) -> TrussAnswers:
        """Return what a designer asks of the truss; see :func:`statejump.truss.answers`."""
        from statejump.kinds.truss.answers import study

        case.need_jump("'statejump truss answers'")
        return study.study(case, **settings)


KIND = Truss()
