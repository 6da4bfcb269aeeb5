"""Stable time step of the spring-slider scene.

Leapfrog with a damping force from the lagged velocity is stable for omega dt <= 2 (sqrt(1 + zeta^2)
- zeta) with omega^2 = k/m and zeta = c / (2 sqrt(k m)) of a mode. The slider moves along two axes:

- across the floor (y): the floor's normal stiffness k_n, and k_t of a stop that it touches;
- along the bar (x): the link, k_t of the floor and k_n of a stop.

Contacts are Hertz-Mindlin, k_n = 2 E* a, k_t = 8 G* a, a = sqrt(R delta), delta =
(F / (4/3 E* sqrt(R)))^(2/3), at the largest force they can see: the floor at twice the normal force
(a load applied at once overshoots to twice its value), a stop at the force that would hold the whole
thermal overlap rigidly, doubled for impact. Dashpots of all contacts of an axis are added.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import sqrt


@dataclass(frozen=True)
class SpringSliderContact:
    """What decides the stable time step; SI units."""

    tip_mass_kg: float
    link_stiffness_N_per_m: float
    pad_radius_m: float
    young_modulus_Pa: float
    poisson_ratio: float
    floor_force_N: float
    largest_stop_force_N: float
    link_damping_ratio: float
    contact_damping_ratio: float


def contact_stiffness(contact: SpringSliderContact, force_N: float) -> tuple[float, float]:
    """Tangent stiffnesses k_n, k_t [N/m] of one pad under a force [N]."""
    nu = contact.poisson_ratio
    effective_modulus = contact.young_modulus_Pa / (2 * (1 - nu**2))
    shear_modulus = contact.young_modulus_Pa / (2 * (1 + nu))
    effective_shear = shear_modulus / (2 * (2 - nu))
    hertz = 4 / 3 * effective_modulus * sqrt(contact.pad_radius_m)
    contact_radius = sqrt(contact.pad_radius_m * (force_N / hertz) ** (2 / 3))
    return 2 * effective_modulus * contact_radius, 8 * effective_shear * contact_radius


def stable_time_step(contact: SpringSliderContact) -> float:
    """Largest stable time step [s]."""
    floor_normal, floor_tangential = contact_stiffness(contact, 2 * contact.floor_force_N)
    stop_normal, stop_tangential = contact_stiffness(contact, 2 * contact.largest_stop_force_N)
    link = contact.link_stiffness_N_per_m
    axes = (
        (0.0, (floor_normal, stop_tangential)),
        (link, (floor_tangential, stop_normal)),
    )
    steps = []
    for spring, contacts in axes:
        mass = contact.tip_mass_kg
        stiffness = spring + sum(contacts)
        # c / m of all dashpots, each 2 zeta sqrt(k m)
        damping = 2 * sqrt(1 / mass) * (
            contact.link_damping_ratio * sqrt(spring)
            + contact.contact_damping_ratio * sum(sqrt(k) for k in contacts)
        )
        omega = sqrt(stiffness / mass)
        ratio = damping / (2 * omega)
        steps.append(2 / omega * (sqrt(1 + ratio**2) - ratio))
    return min(steps)
