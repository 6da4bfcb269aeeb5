# SPDX-License-Identifier: GPL-3.0-or-later
"""Input of the YADE script for a ``spring_slider`` case."""
from __future__ import annotations

import math
from typing import Any

from scipy.optimize import brentq

from statejump.core import physics
from statejump.core.thermal import parameters
from statejump.core.yade_process import common_values
from statejump.kinds.spring_slider import reduced, stable_step
from statejump.kinds.spring_slider.case import SpringSliderCase


def number_of_steps(case: SpringSliderCase) -> int:
    """Return the number of time steps, a multiple of the number of samples, so that the last sample is at the end."""
    wanted = case.dem_settings.time_step_s
    if wanted is None:
        wanted = case.dem_settings.time_step_fraction * stable_step.stable_time_step(case)
    samples = case.dem_settings.samples_per_cycle
    return math.ceil(case.period_s / wanted / samples) * samples * case.thermal.cycles


def time_step(case: SpringSliderCase) -> float:
    """Return the time step [s]: the requested step, reduced so that a whole number of steps fills the program."""
    return case.duration_s / number_of_steps(case)


def dem_input(case: SpringSliderCase) -> dict[str, Any]:
    """Return the input of the YADE script, as plain values."""
    values = common_values(case, number_of_steps(case))
    values["link"]["thermal_expansion_per_K"] = case.thermal_expansion_per_K
    values["bar_program"] = parameters(case.bar_program, case.period_s)
    values["dem"].update(tip_mass_kg=stable_step.tip_mass(case), start_displacement_m=start_displacement(case),
                         start_slide_m=start_slide(case))
    if case.joint.play_m:
        model = reduced.spring_slider(case)
        stiffness = stable_step.contact_stiffness(case, case.joint.normal_force_N)[1]
        values["dem"].update(friction_limit_N=case.friction_force_N, friction_stiffness_N_per_m=stiffness,
                             start_friction_N=model.start_load_N,
                             start_slip_m=model.start_middle_m - model.start_load_N / stiffness)
    return values


def start_displacement(case: SpringSliderCase) -> float:
    """Return the start position of the block [m]: that of the reduced model, plus the Hertz depth in a touched stop."""
    joint = case.joint
    model = reduced.spring_slider(case)
    if joint.stop_stiffness_N_per_m is not None:
        return model.start_displacement_m
    for side in (1, -1):
        clearance = case.clearance_m(side, 0.0)
        stiffness = stable_step.link_stiffness(case) + joint.preload_stiffness_N_per_m
        load = -side * (joint.preload_force_N + model.start_load_N) - stiffness * clearance
        if load > 0:
            hertz = physics.hertz_stiffness_N_per_m15(
                physics.effective_young_modulus_Pa(joint.young_modulus_Pa, joint.poisson_ratio), joint.pad_radius_m
            )
            deepest = float(physics.hertz_depth_m(load, hertz))
            depth = brentq(lambda there: hertz * there**1.5 + stiffness * there - load, 0.0, deepest)
            return side * (clearance + float(depth))
    return model.start_displacement_m


def start_slide(case: SpringSliderCase) -> float:
    """Return the slide [m] at which the contact with the floor carries the friction of the start. It is 0 for a joint
    with play, whose friction does not come from the floor."""
    if case.joint.play_m:
        return 0.0
    load_N = reduced.spring_slider(case).start_load_N
    return load_N / stable_step.contact_stiffness(case, case.joint.normal_force_N)[1] if load_N else 0.0
