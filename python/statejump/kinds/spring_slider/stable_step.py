# SPDX-License-Identifier: GPL-3.0-or-later
"""Stable time step of the spring-slider scene.

``_engine.critical_time_step_s`` returns the stability limit of leapfrog for one oscillator. The slider is an oscillator
along two axes:

- across the floor (y): the floor's normal stiffness k_n, and k_t of a touching stop;
- along the bar (x): the link, k_t of the floor and k_n of a stop.

Contacts have the Hertz-Mindlin stiffness at their largest force. For the floor this is twice the normal force, because
a sudden load overshoots to twice its value. Because of impact, the force of a stop is twice the force that would hold
thermal overlap and preload rigidly. A stop with a given stiffness keeps that stiffness. The dashpots of all contacts
along an axis are added.
"""
from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from statejump import _engine
from statejump.core import physics

if TYPE_CHECKING:
    from statejump.kinds.spring_slider.case import SpringSliderCase


def tip_mass(case: SpringSliderCase) -> float:
    """Mass at the tip of the bar [kg]: the slider plus a third of the bar (exact for a uniform rod)."""
    link = case.link
    bar = link.density_kg_per_m3 * link.cross_section_area_m2 * link.stress_free_length_m
    return bar / 3 + case.dem_settings.slider_mass_kg


def largest_stop_force(case: SpringSliderCase) -> float:
    """Largest force [N] of a rigid stop that holds the whole thermal overlap and the preload."""
    link, stiffness, preload = case.link, link_stiffness(case), case.joint.preload_force_N
    force = 0.0
    for change in case.turning_changes_K:
        stroke = link.stress_free_length_m * case.thermal_strain(change)
        force = max(force, *(stiffness * (side * stroke - case.clearance_m(side, change)) - side * preload
                             for side in (1, -1)))
    return force


def link_stiffness(case: SpringSliderCase) -> float:
    """Largest k = E A/l_T [N/m]: that of the shortest stress-free length of the temperature program."""
    link = case.link
    strain = min(0.0, *(case.thermal_strain(change) for change in case.turning_changes_K))
    return physics.axial_stiffness_N_per_m(
        link.young_modulus_Pa, link.cross_section_area_m2, link.stress_free_length_m * (1 + strain)
    )


def contact_stiffness(case: SpringSliderCase, force_N: float) -> tuple[float, float]:
    """Normal and tangential stiffness k_n, k_t [N/m] of one pad under a normal force [N]."""
    joint = case.joint
    hertz = physics.hertz_stiffness_N_per_m15(
        physics.effective_young_modulus_Pa(joint.young_modulus_Pa, joint.poisson_ratio), joint.pad_radius_m
    )
    normal = float(physics.hertz_tangent_N_per_m(force_N, hertz))
    return normal, normal * physics.shear_over_normal_stiffness(joint.poisson_ratio)


def stable_time_step(case: SpringSliderCase) -> float:
    """Largest stable time step [s] of the DEM run of a case."""
    floor_normal, floor_tangential = contact_stiffness(case, 2 * case.joint.normal_force_N)
    stop_normal, stop_tangential = contact_stiffness(case, 2 * largest_stop_force(case))
    if case.joint.stop_stiffness_N_per_m is not None:
        stop_normal, stop_tangential = case.joint.stop_stiffness_N_per_m, 0.0
    link = link_stiffness(case) + case.joint.preload_stiffness_N_per_m
    mass = tip_mass(case)
    axes = (
        (0.0, (floor_normal, stop_tangential)),
        (link, (floor_tangential, stop_normal)),
    )
    steps: list[float] = []
    for spring, contacts in axes:
        # Each dashpot is 2 zeta sqrt(k m).
        damping = 2 * sqrt(mass) * (
            case.dem_settings.link_damping_ratio * sqrt(spring)
            + case.dem_settings.contact_damping_ratio * sum(sqrt(k) for k in contacts)
        )
        steps.append(_engine.critical_time_step_s(mass, spring + sum(contacts), damping))
    return min(steps)
