# SPDX-License-Identifier: GPL-3.0-or-later
"""Kind ``umbrella``: one rib of an umbrella antenna, two links and a clearance joint (section 4 of the paper)."""
from __future__ import annotations

from typing import ClassVar

from statejump.core.later import Later
from statejump.kinds.protocol import Kind
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.summary import LABELS


class Umbrella(Kind):
    """The kind as one object."""

    name: ClassVar[str] = "umbrella"
    Case = UmbrellaCase
    LABELS = LABELS
    # Both models have all of them.
    COLUMNS = (
        "time_s",
        "temperature_change_K",
        "theta2_rad",  # angle of AB, from A to B, anticlockwise from AC
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
        "tangential_force_N",  # friction on the journal, along the normal rotated by +90 degrees
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

    reduced = Later("statejump.kinds.umbrella.reduced:run")
    quasi_static = Later("statejump.kinds.umbrella.quasi_static:quasi_static")
    dem_input = Later("statejump.kinds.umbrella.dem:dem_input")
    dem_run = Later("statejump.kinds.umbrella.result:dem_run")
    compare = Later("statejump.kinds.umbrella.compare:compare")
    difference = Later("statejump.kinds.umbrella.compare:difference")
    names = Later("statejump.kinds.umbrella.result:names")
    scene = Later("statejump.kinds.umbrella.result:scene")
    outcomes = Later("statejump.kinds.umbrella.compare:outcomes")
    laws = Later("statejump.kinds.umbrella.figure:joint")
    sheet = Later("statejump.kinds.umbrella.figure:sheet")
    summary_lines = Later("statejump.kinds.umbrella.summary:summary_lines")
    describe = Later("statejump.kinds.umbrella.summary:describe")
    charts = Later("statejump.kinds.umbrella.summary:charts")


KIND = Umbrella()
