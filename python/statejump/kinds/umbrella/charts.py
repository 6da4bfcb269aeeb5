# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of an ``umbrella`` case on the page of ``statejump report``."""
from __future__ import annotations

from statejump.core.charts import TEMPERATURE, TIME, Axis, Chart
from statejump.kinds.umbrella.case import UmbrellaCase


def charts(case: UmbrellaCase) -> list[Chart]:
    """Return charts: both deflections over temperature, trajectory of the journal in its clearance, contact force."""
    return [
        Chart(TEMPERATURE, Axis("theta2_rad", "Deflection of AB, θ2 − θ2(0)", from_start=True),
              "Deflection-temperature loop", marks=True),
        Chart(TEMPERATURE, Axis("theta4_rad", "Deflection of BC, θ4 − θ4(0)", from_start=True),
              "Deflection-temperature loop of BC", marks=True),
        Chart(
            Axis("eccentricity_x_m", "Journal − bearing centre, along AC"), Axis("eccentricity_y_m", "across AC"),
            "Journal in its clearance", equal=True, rings_m=(case.joint.radial_clearance_m,),
        ),
        Chart(TIME, Axis("normal_force_N", "Normal force at the samples"), "Contact force over time"),
    ]
