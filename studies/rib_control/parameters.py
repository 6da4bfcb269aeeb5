# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters that a control study of an umbrella sweeps."""
from __future__ import annotations

from typing import Any

from statejump.kinds.umbrella.case import UmbrellaCase

FRICTION = "joint.friction_coefficient"
CLEARANCE = "joint.radial_clearance_m"
SPRING = "torsion_spring.stiffness_N_m_per_rad"
BIAS = "torsion_spring.bias_rad"
DAMPING = "damping.axial_damping_ratio"
AREA = "link_ab.cross_section_area_m2"
OTHER_AREA = "link_bc.cross_section_area_m2"


def changes(case: UmbrellaCase, parameter: str, value: float) -> dict[str, Any]:
    """Return all values that change together with a swept one."""
    if parameter == AREA:  # both links by the same factor
        factor = value / case.link_ab.cross_section_area_m2
        return {AREA: value, OTHER_AREA: case.link_bc.cross_section_area_m2 * factor}
    return {parameter: value}
