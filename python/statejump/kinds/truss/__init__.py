# SPDX-License-Identifier: GPL-3.0-or-later
"""Kind ``truss``: trusses of many joints with friction and clearance."""
from __future__ import annotations

from typing import Any, ClassVar

from statejump.core.later import Later
from statejump.kinds.protocol import Kind
from statejump.kinds.truss.case import TrussCase


class Truss(Kind[TrussCase]):
    """The kind as one object."""

    name: ClassVar[str] = "truss"
    Case = TrussCase
    # Columns by item follow in this order.
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

    reduced = Later("statejump.kinds.truss.running:reduced")
    traced = Later("statejump.kinds.truss.trace:traced")
    dynamic = Later("statejump.kinds.truss.running:dynamic")
    quick = Later("statejump.kinds.truss.outcomes:quick")
    dem_input = Later("statejump.kinds.truss.dem:dem_input")
    check_dem: Any = Later("statejump.kinds.truss.running:check_dem")
    dem: Any = Later("statejump.kinds.truss.running:dem")
    dem_run = Later("statejump.kinds.truss.result:dem_run")
    compare = Later("statejump.kinds.truss.compare:compare")
    difference = Later("statejump.kinds.truss.compare:difference")
    names = Later("statejump.kinds.truss.result:names")
    scene = Later("statejump.kinds.truss.result:scene")
    outcomes = Later("statejump.kinds.truss.outcomes:outcomes")
    surface = Later("statejump.kinds.truss.reflector:surface")
    contact_problems = Later("statejump.kinds.truss.contact_problems:contact_problems")
    creak = Later("statejump.kinds.truss.creak:creak")
    bounds = Later("statejump.kinds.truss.bounds.study:bounds")
    worst = Later("statejump.kinds.truss.worst.study:worst")
    modes = Later("statejump.kinds.truss.modes:modes")
    design = Later("statejump.design.study:design")
    control = Later("statejump.kinds.truss.control.study:control")
    answers = Later("statejump.kinds.truss.answers.study:answer")
    sheet = Later("statejump.kinds.truss.figure:sheet")
    summary_lines = Later("statejump.kinds.truss.summary:summary_lines")
    describe = Later("statejump.kinds.truss.summary:describe")
    page = Later("statejump.kinds.truss.page:page")
    draw = Later("statejump.kinds.truss.figure:draw")


KIND = Truss()
