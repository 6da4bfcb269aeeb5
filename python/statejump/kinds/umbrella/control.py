# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters of an ``umbrella`` case that a control study sweeps.

A joint that a biased torsion spring loads from the start has one quasi-static path, so one jump:
:mod:`statejump.control_loaded`. Without it the motion after contact is chaotic and only statistics
of an ensemble mean anything: :mod:`statejump.control_ensemble`.
"""
from __future__ import annotations

from typing import Any

from statejump.kinds.umbrella.case import UmbrellaCase, UmbrellaJoint

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


def most_friction() -> float:
    """Largest friction coefficient that a case may have."""
    return UmbrellaJoint.__fields__["friction_coefficient"].field_info.extra["high"]
