# SPDX-License-Identifier: GPL-3.0-or-later
"""Limit of the jump for slow cycles, and predicted deviation from it at a finite rate."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from statejump import _engine
from statejump.core.engine_failures import engine
from statejump.core.errors import FailedRun
from statejump.core.physics import axial_stiffness_N_per_m, hertz_depth_m
from statejump.kinds.umbrella import reduced as model
from statejump.kinds.umbrella.case import UmbrellaCase

LOOP_SAMPLES = 2000  # per branch of the quasi-static path
ANGLES = ("theta2", "theta4")


def quasi_static(case: UmbrellaCase) -> _engine.ElasticLoop:
    """Return the path that is the limit of slow dynamics. :raises FailedRun: equilibrium does not determine it"""
    with engine("there is no quasi-static path", case=case.name):
        loop = _engine.elastic_loop(
            model.linkage(case), case.thermal_program(), case.start.contact_angle_rad, LOOP_SAMPLES,
            "mindlin",
        )
    if loop.separated:
        where = loop.events[-1]["temperature_change_K"]
        raise FailedRun(
            code="contact_force_vanishes", case=case.name, temperature_change_K=where, where_K=where,
        )
    return loop


def _end_rate(case: UmbrellaCase) -> float:
    """Rate [K/s] with which the program ends."""
    program = case.thermal_program()
    return float(program.temperature_rate(program.duration_s * (1 - 1e-9)))


def _cross(a: np.ndarray, b: np.ndarray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def equilibrium(
    case: UmbrellaCase, guess: dict[str, Any], couples_N_m: tuple[float, float]
) -> tuple[float, float]:
    """Return theta2 and theta4 [rad] of the slipping joint at ΔT = 0, with an applied couple on each link.

    :param guess: nearby state of the elastic loop; its force ratio F_t/F_N is kept
    """
    frame = np.array([case.frame.length_m, 0.0])
    links = (case.link_ab, case.link_bc)
    length = [link.stress_free_length_m for link in links]
    stiffness = [
        axial_stiffness_N_per_m(link.young_modulus_Pa, link.cross_section_area_m2, link.stress_free_length_m)
        for link in links
    ]
    hertz = float(
        _engine.normal_force(
            case.joint.normal_law, np.array([1.0]), case.joint.journal_radius_m, case.bearing_radius_m,
            case.joint.contact_length_m, case.effective_young_modulus_Pa,
        )["force_N"][0]
    )
    play = case.joint.radial_clearance_m
    normal = np.array([guess["eccentricity_x_m"], guess["eccentricity_y_m"]])
    normal /= np.linalg.norm(normal)
    normal_force, tangential_force = guess["normal_force_N"], guess["tangential_force_N"]
    start_force = normal_force * normal - tangential_force * np.array([-normal[1], normal[0]])
    angle = math.atan2(tangential_force, normal_force)  # angle from force to normal, constant during slip
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])

    def residual(x: np.ndarray) -> np.ndarray:
        u2, u4 = (np.array([math.cos(theta), math.sin(theta)]) for theta in x[:2])
        force = x[2:]  # on the bearing
        size = float(np.linalg.norm(force))
        n = turn @ force / size
        depth = hertz_depth_m(size * math.cos(angle), hertz)
        bearing = (length[0] + force @ u2 / stiffness[0]) * u2
        journal = (length[1] - force @ u4 / stiffness[1]) * u4
        contact = bearing + (case.bearing_radius_m + depth / 2) * n
        moment = case.torsion_spring.stiffness_N_m_per_rad * (x[1] - x[0] - case.free_flare_angle_rad)
        gap = (frame + journal - bearing - (play + depth) * n) / play
        return np.array([
            *gap,
            (_cross(contact, force) + moment + couples_N_m[0]) / (size * length[0]),
            (_cross(contact - frame, force) + moment - couples_N_m[1]) / (size * length[0]),
        ])

    x = np.array([guess["theta2_rad"], guess["theta4_rad"], *start_force])
    for _ in range(12):
        steps = np.array([1e-6, 1e-6, *(1e-6 * np.linalg.norm(x[2:]) for _ in range(2))])
        jacobian = np.column_stack([
            (residual(x + step * axis) - residual(x - step * axis)) / (2 * step)
            for step, axis in zip(steps, np.eye(4))
        ])
        x = x - np.linalg.solve(jacobian, residual(x))
    return float(x[0]), float(x[1])


def lag(case: UmbrellaCase, loop: _engine.ElasticLoop) -> tuple[float | None, float | None]:
    """Return the predicted deviations of the jumps of θ2 and θ4 [rad], caused by damping couples of the pins at the
    program's end.

    None if the joint sticks at the end, because an earlier state then determines the jump.
    """
    last = loop.events[-1]
    path = loop.columns()
    if not path["slipping"][-1]:
        return None, None
    span = path["temperature_change_K"][-1] - path["temperature_change_K"][-2]
    pin, rate = case.damping.pin_damping_N_m_s_per_rad, _end_rate(case)
    couples = [
        -pin * rate * (path[f"{a}_rad"][-1] - path[f"{a}_rad"][-2]) / span for a in ANGLES
    ]
    moved, still = equilibrium(case, last, (couples[0], couples[1])), equilibrium(case, last, (0.0, 0.0))
    return moved[0] - still[0], moved[1] - still[1]


def lag_at_parting(case: UmbrellaCase) -> tuple[float, float]:
    """Return the predicted false jump [rad] of a frictionless joint whose contact force vanishes during slip."""
    linkage = model.linkage(case)
    parting = linkage.first_contact_temperature_change()

    def slope(change: float, angle: float) -> dict[str, float]:
        """Return central differences from the points at ± the steps."""
        up = _engine.joint_point(linkage, parting + change, -1, angle)
        down = _engine.joint_point(linkage, parting - change, -1, -angle)
        return {k: (up[k] - down[k]) / 2 for k in ("theta2_rad", "theta4_rad", "spring_moment_N_m")}

    by_angle, by_change = slope(0.0, 1e-5), slope(1e-3, 0.0)
    height = case.ideal_position_m[1]
    force_rate = abs(by_change["spring_moment_N_m"]) / 1e-3 / height  # F' [N/K]
    rates = (by_change["theta2_rad"] + by_change["theta4_rad"]) / 1e-3
    pin = case.damping.pin_damping_N_m_s_per_rad
    reach = math.sqrt(math.pi * pin * abs(_end_rate(case)) / (case.joint.radial_clearance_m * force_rate))
    first, second = (by_angle[f"{a}_rad"] / 1e-5 * rates / 2 * reach for a in ANGLES)
    return first, second
