# SPDX-License-Identifier: GPL-3.0-or-later
"""Kind ``spring_slider``: a heated bar pushes a block with friction between stops (section 3 of the paper)."""
from __future__ import annotations

from typing import ClassVar

from statejump.core.later import Later
from statejump.kinds.protocol import Kind
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.kinds.spring_slider.summary import LABELS

_SAMPLES = Later("statejump.kinds.spring_slider.reduced:number_of_samples")


class SpringSlider(Kind[SpringSliderCase]):
    """The kind as one object."""

    name: ClassVar[str] = "spring_slider"
    Case = SpringSliderCase
    LABELS = LABELS
    # Names common to both models; each model has some of these columns.
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

    def samples(self, case: SpringSliderCase, model: str) -> int:
        number: int = _SAMPLES(case) if model == "reduced" else super().samples(case, model)
        return number

    reduced = Later("statejump.kinds.spring_slider.reduced:run")
    quick = Later("statejump.kinds.spring_slider.reduced:quick")
    dem_input = Later("statejump.kinds.spring_slider.dem:dem_input")
    dem_run = Later("statejump.kinds.spring_slider.result:dem_run")
    compare = Later("statejump.kinds.spring_slider.compare:compare")
    difference = Later("statejump.kinds.spring_slider.compare:difference")
    names = Later("statejump.kinds.spring_slider.result:names")
    scene = Later("statejump.kinds.spring_slider.result:scene")
    outcomes = Later("statejump.kinds.spring_slider.compare:outcomes")
    statics = Later("statejump.kinds.spring_slider.statics:statics")
    control = Later("statejump.kinds.spring_slider.control:control")
    sheet = Later("statejump.kinds.spring_slider.figure:sheet")
    summary_lines = Later("statejump.kinds.spring_slider.summary:summary_lines")
    describe = Later("statejump.kinds.spring_slider.summary:describe")
    charts = Later("statejump.kinds.spring_slider.summary:charts")
    event_reason = Later("statejump.kinds.spring_slider.summary:event_reason")


KIND = SpringSlider()
