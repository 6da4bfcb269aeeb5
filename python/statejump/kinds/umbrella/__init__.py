# SPDX-License-Identifier: GPL-3.0-or-later
"""Kind ``umbrella``: one rib of an umbrella antenna, two links and a joint with clearance, the paper's section 4."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from statejump.core.comparison import Comparison, Quantity
from statejump.core.progress import Tell
from statejump.core.run import Columns, Run
from statejump.core.tables import Shown
from statejump.kinds.protocol import Kind
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.words import WORDS

if TYPE_CHECKING:
    from statejump.control.study import Study
    from statejump.core.charts import Chart
    from statejump.core.figures import Sheet
    from statejump.core.results_folder import Results
    from statejump.kinds.umbrella.quasi_static import QuasiStatic
    from statejump.laws.curves import Joint
    from statejump.paper.energy import Accounts
    from statejump.paper.figures.runs import Part
    from statejump.paper.figures.study import Figures
    from statejump.paper.hold import Held
    from statejump.paper.slow import Slow


class Umbrella(Kind):
    """The kind as one object."""

    name: ClassVar[str] = "umbrella"
    Case = UmbrellaCase
    WORDS = WORDS
    # Both models have all of them.
    COLUMNS = (
        "time_s",
        "temperature_change_K",
        "theta2_rad",  # of AB, from A to B, anticlockwise from AC
        "theta4_rad",  # of BC, from C to B
        "length_ab_m",
        "length_bc_m",
        "centroid_ab_x_m",  # the paper's X_G1, and so on
        "centroid_ab_y_m",
        "centroid_bc_x_m",
        "centroid_bc_y_m",
        "bearing_x_m",
        "bearing_y_m",
        "journal_x_m",
        "journal_y_m",
        "eccentricity_x_m",  # journal minus bearing centre
        "eccentricity_y_m",
        "penetration_depth_m",  # negative: gap
        "normal_force_N",
        "tangential_force_N",  # friction on the journal, along the normal turned by +90 degrees
        "slipping",
        "kinetic_energy_J",
        "axial_energy_J",
        "contact_energy_J",
        "torsion_energy_J",
        "axial_dissipation_J",
        "pin_dissipation_J",
        "friction_dissipation_J",
        "impact_dissipation_J",
        "thermal_work_J",
    )

    OUTCOMES = (
        "theta2_jump_rad",
        "theta4_jump_rad",
        "theta2_range_rad",
        "theta4_range_rad",
        "first_contact_temperature_change_K",
        "contacts",
        "energy_residue_J",
    )
    AT_PROGRAM_END = ("theta2_change_at_program_end_rad", "theta4_change_at_program_end_rad")

    def laws(self, case: UmbrellaCase) -> Joint:
        """Return the joint as the curves of the laws want it."""
        from statejump.laws import curves

        return curves.Joint(
            case.title, case.joint.journal_radius_m, case.bearing_radius_m, case.joint.contact_length_m,
            case.effective_young_modulus_Pa, curves.reduced_mass_kg(case.link_ab.mass_kg, case.link_bc.mass_kg),
        )

    def quasi_static(self, case: UmbrellaCase) -> QuasiStatic:
        from statejump.kinds.umbrella.quasi_static import quasi_static

        return quasi_static(case)

    def reduced(self, case: UmbrellaCase, tell: Tell) -> Run:
        from statejump.kinds.umbrella import reduced

        return reduced.run(case, tell)

    def dem_input(self, case: UmbrellaCase) -> dict[str, Any]:
        from statejump.kinds.umbrella import dem

        return dem.dem_input(case)

    def dem_run(self, case: UmbrellaCase, columns: Columns, about: Mapping[str, Any]) -> Run:
        from statejump.kinds.umbrella import result

        return result.dem_run(case, columns, about)

    def compare(self, case: UmbrellaCase, reduced: Run, dem: Run) -> Comparison:
        from statejump.kinds.umbrella import compare

        return compare.compare(case, reduced, dem)

    def difference(self, case: UmbrellaCase, first: Run, second: Run) -> list[Quantity]:
        from statejump.kinds.umbrella import compare

        return compare.difference(case, first, second)

    def names(self, case: UmbrellaCase) -> dict[str, list[str]]:
        from statejump.kinds.umbrella import result

        return result.names(case)

    def scene(self, case: UmbrellaCase) -> dict[str, Any]:
        from statejump.kinds.umbrella import result

        return result.scene(case)

    def sheet(self, case: UmbrellaCase, runs: Sequence[Run]) -> Sheet:
        from statejump.kinds.umbrella import figure

        return figure.sheet(case, runs)

    def told(self, case: UmbrellaCase, runs: Mapping[str, Run]) -> list[Shown | str]:
        from statejump.kinds.umbrella import words

        return words.told(case, runs)

    def describe(self, case: UmbrellaCase) -> list[str]:
        from statejump.kinds.umbrella import words

        return words.describe(case)

    def charts(self, case: UmbrellaCase) -> list[Chart]:
        from statejump.kinds.umbrella import charts

        return charts.charts(case)

    def outcomes(self, case: UmbrellaCase, run: Run) -> dict[str, float]:
        from statejump.kinds.umbrella import outcomes

        return outcomes.outcomes(case, run)

    def control(self, case: UmbrellaCase, **settings: Any) -> Study:
        """Return what makes the state jump smaller; see :func:`.control.control`."""
        from statejump.kinds.umbrella import control

        case.need_jump("'statejump control'")
        found = control.control(case, **settings)
        found.remarks += case.thermal_notes
        return found

    def figures(self, case: UmbrellaCase, results: Results, part: Part) -> Figures:
        """Draw the paper's Figures 13 to 16 of the case in both models, and test its claims."""
        from statejump.paper.figures import study

        return study.make(case, results, part)

    def slow(self, case: UmbrellaCase, results: Results, tell: Tell) -> Slow:
        """Hold both models against the quasi-static path, ever slower."""
        from statejump.paper import slow

        return slow.make(case, results, tell)

    def hold(self, case: UmbrellaCase, results: Results, tell: Tell) -> Held:
        """Leave the loaded joint alone, by friction that holds and by friction that creeps."""
        from statejump.paper import hold

        return hold.make(case, results, tell)

    def energy(self, case: UmbrellaCase, results: Results, tell: Tell) -> Accounts:
        """Draw up the energy account against the steps of both models."""
        from statejump.paper import energy

        return energy.make(case, results, tell)


KIND = Umbrella()
