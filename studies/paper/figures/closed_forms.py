# SPDX-License-Identifier: GPL-3.0-or-later
"""Geometry and statics of the rib without time integration: limits of θ2, first contact, static path."""
from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import brentq

from statejump import _engine
from statejump.core.physics import apex_m, axial_stiffness_N_per_m
from statejump.kinds.umbrella import compare, reduced as model
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.schema.paths import with_values

CIRCLE = np.linspace(0, 2 * np.pi, 721)


def _theta2(case: UmbrellaCase, lengths: tuple[Any, Any], eccentricity: tuple[Any, Any]) -> Any:
    """Return θ2 from the link lengths and the distance between the tips of the links (numbers or broadcast arrays)."""
    x, y = case.frame.length_m - eccentricity[0], -np.asarray(eccentricity[1])
    foot, height = apex_m(*lengths, np.hypot(x, y))
    return np.arctan2(y, x) + np.arctan2(height, foot)


def envelope(case: UmbrellaCase, change_K: np.ndarray, margin_m: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return, for every temperature, the extremes of θ2 [rad] over all positions in the clearance, for rigid links.

    θ2 has no stationary point inside the clearance circle, so its extremes are on the rim.
    """
    change = np.linspace(np.min(change_K), np.max(change_K), 201)[:, None]
    radius = np.array([case.clearance_m(value) for value in change[:, 0]])[:, None] + margin_m
    angles = _theta2(case, case.link_lengths_m(change), (radius * np.cos(CIRCLE), radius * np.sin(CIRCLE)))
    low, high = (np.interp(change_K, change[:, 0], side) for side in (angles.min(axis=1), angles.max(axis=1)))
    return low, high


def closed_form_first_contact(case: UmbrellaCase) -> float | None:
    """Return ΔT [K] of first contact without initial vibration; None: no closed form; infinity: no contact."""
    return compare.closed_form_first_contact(with_values(case, {"start.mode": "matched"}))


def static_deflection(case: UmbrellaCase, change_K: float) -> float | None:
    """Return θ2 − θ2(0) [rad] of rigid links in frictionless contact; None before the first contact."""
    contact = closed_form_first_contact(case)
    if contact is None or change_K < contact:
        return None
    return float(_engine.joint_point(model.linkage(case), change_K, -1, 0.0)["theta2_rad"] - case.theta2_rad)


def static_deflection_elastic(case: UmbrellaCase, change_K: float) -> float | None:
    """Return θ2 − θ2(0) [rad] for elastic links, contact and spring. The joint force F lies along AC; moment
    equilibrium with the spring determines it."""
    spring = case.torsion_spring.stiffness_N_m_per_rad
    if spring == 0 or static_deflection(case, change_K) is None:
        return None
    joint, free = case.joint, case.free_flare_angle_rad
    first, second = case.link_lengths_m(change_K)
    stiffness = [
        axial_stiffness_N_per_m(link.young_modulus_Pa, link.cross_section_area_m2, length)
        for link, length in ((case.link_ab, first), (case.link_bc, second))
    ]

    def normal_force(depth: float) -> float:
        return float(_engine.normal_force(
            joint.normal_law, np.array([depth]), joint.journal_radius_m, case.bearing_radius_m,
            joint.contact_length_m, case.effective_young_modulus_Pa,
        )["force_N"][0])

    def angles(force: float) -> tuple[float, float]:
        """Return θ2 and θ4 under a joint force, which shortens the links and deepens the contact."""
        play = case.clearance_m(change_K)
        end = 0.5 * min(play, _engine.largest_depth_m(joint.normal_law, joint.journal_radius_m, case.bearing_radius_m))
        depth = brentq(lambda value: normal_force(value) - force, 0, end, xtol=1e-18)
        theta2, theta4 = case.theta2_rad, case.theta4_rad
        for _ in range(50):  # small strain: each iteration reduces the error by this factor
            ab = first - force * np.cos(theta2) / stiffness[0]
            bc = second + force * np.cos(theta4) / stiffness[1]
            theta2 = float(_theta2(case, (ab, bc), (-(play + depth), 0.0)))
            tip = ab * np.array([np.cos(theta2), np.sin(theta2)])
            theta4 = float(np.arctan2(tip[1], tip[0] - case.frame.length_m - (play + depth)))
        return theta2, theta4

    def unbalance(force: float) -> float:
        theta2, theta4 = angles(force)
        lever = (first - force * np.cos(theta2) / stiffness[0]) * np.sin(theta2)
        return force * lever + spring * (theta4 - theta2 - free)

    rigid = _engine.joint_point(model.linkage(case), change_K, -1, 0.0)
    largest = -2 * rigid["spring_moment_N_m"] / (first * np.sin(rigid["theta2_rad"]))
    try:
        return angles(brentq(unbalance, 0, largest, xtol=1e-15 * largest, rtol=1e-14))[0] - case.theta2_rad
    except ValueError:  # beyond the range of the normal law
        return None


def quasi_static(case: UmbrellaCase, change_K: np.ndarray) -> np.ndarray | None:
    """Return the frictionless quasi-static path in contact. It is NaN where the spring does not close the joint, and
    None without a spring."""
    spring = case.torsion_spring
    if spring.stiffness_N_m_per_rad == 0 or spring.bias_rad != 0:
        return None
    values = {change: static_deflection(case, change) for change in np.unique(change_K)}
    if all(value is None for value in values.values()):
        return None
    return np.array([np.nan if values[change] is None else values[change] for change in change_K])
