# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the state jump of an ``umbrella`` case, and the parameters that it sweeps.

A joint that a biased torsion spring loads from the start has one quasi-static path, so one jump:
:mod:`.control_loaded`. Without it the motion after contact is chaotic and only statistics of an ensemble mean
anything: :mod:`.control_ensemble`.
"""
from __future__ import annotations

from typing import Any

from statejump.control.study import RUNS, Places, Study, check_wanted, refuse_places, refuse_runs
from statejump.core.errors import NotAllowed
from statejump.core.progress import Tell
from statejump.kinds.umbrella.case import UmbrellaCase

FRICTION = "joint.friction_coefficient"
CLEARANCE = "joint.radial_clearance_m"
SPRING = "torsion_spring.stiffness_N_m_per_rad"
BIAS = "torsion_spring.bias_rad"
DAMPING = "damping.axial_damping_ratio"
AREA = "link_ab.cross_section_area_m2"
OTHER_AREA = "link_bc.cross_section_area_m2"


def changes(case: UmbrellaCase, parameter: str, value: float) -> dict[str, Any]:
    """Return all values that change with a swept one."""
    if parameter == AREA:  # both links by the same factor
        factor = value / case.link_ab.cross_section_area_m2
        return {AREA: value, OTHER_AREA: case.link_bc.cross_section_area_m2 * factor}
    return {parameter: value}


def control(
    case: UmbrellaCase, jump_below: float | None = None, runs: int | None = None, with_dem: bool = False,
    tell: Tell = lambda share: None, places: Places = Places(),
) -> Study:
    """Study a rib.

    :param jump_below: wanted largest jump of θ2 [rad]; None: half of what the case has
    :param runs: size of the ensemble; None: the default, and the only choice where none is run
    :param places: there is nothing to choose from: none
    :raises StatejumpError: bad input, or a run failed
    """
    from statejump.kinds.umbrella import control_ensemble, control_loaded

    check_wanted(jump_below, "rad")
    refuse_places(places, case)
    if case.start.mode == "loaded":
        refuse_runs(runs, case)
        return control_loaded.study(case, jump_below, with_dem, tell)
    if runs is not None and runs < 2:
        raise NotAllowed("--runs", runs, "must be at least 2")
    return control_ensemble.study(case, jump_below, runs or RUNS, with_dem, tell)
