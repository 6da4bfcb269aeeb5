# SPDX-License-Identifier: GPL-3.0-or-later
"""Oblique impact of a sphere on a rigid wall by waveform relaxation: a slide gives the force, the force the slide."""
from __future__ import annotations

import attrs
import numpy as np
from scipy.integrate import cumulative_trapezoid

import statejump as sj

STEPS = 1500
SWEEPS = 40


@attrs.frozen
class Sphere:
    """A sphere against a rigid wall."""

    young_Pa: float
    poisson: float
    density_kg_per_m3: float
    radius_m: float
    friction: float
    restitution: float = 1.0

    @property
    def mass_kg(self) -> float:
        """Mass of the sphere."""
        return 4 / 3 * np.pi * self.radius_m**3 * self.density_kg_per_m3

    @property
    def pair(self) -> dict[str, float]:
        """Elastic constants of the contact, for :func:`statejump.laws.drive`."""
        return {"effective_young_modulus_Pa": self.young_Pa / (1 - self.poisson**2),
                "effective_shear_modulus_Pa": self.young_Pa / (2 * (1 + self.poisson) * (2 - self.poisson)),
                "effective_radius_m": self.radius_m, "friction_coefficient": self.friction}


@attrs.frozen
class Rebound:
    """Velocities after an impact."""

    normal: float
    tangential: float  # of the centre [m/s]
    contact_point: float  # of the contact point along the wall [m/s]
    spin: float  # [rad/s], negative as the wall slows the contact point
    largest_force_N: float
    duration_s: float


def normal_motion(sphere: Sphere, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Return times and depths of the elastic impact: equal steps of an angle, dense where the contact opens.

    The energy gives the depth's rate; the closed integral of Hertz gives the time.
    """
    stiffness = 4 / 3 * sphere.pair["effective_young_modulus_Pa"] * np.sqrt(sphere.radius_m)
    deepest = (1.25 * sphere.mass_kg * speed**2 / stiffness) ** 0.4
    angle = np.linspace(0, np.pi / 2, STEPS // 2 + 1)
    # depth = deepest sin(angle)^0.8 makes the rate v cos(angle), so time follows from d depth/rate.
    fine = np.linspace(0, np.pi / 2, 40 * (STEPS // 2) + 1)
    rate = 0.8 * np.maximum(np.sin(fine), 1e-30) ** -0.2
    rate[0] = rate[1]
    clock = cumulative_trapezoid(rate, fine, initial=0.0) * deepest / speed
    half = np.interp(angle, fine, clock)
    depth = deepest * np.sin(angle) ** 0.8
    return np.concatenate((half, 2 * half[-1] - half[-2::-1])), np.concatenate((depth, depth[-2::-1]))


def rebound(sphere: Sphere, law: str, normal: float, tangential: float) -> Rebound:
    """Return the velocities after an impact with a friction law; restitution scales the normal velocity only."""
    times, depth = normal_motion(sphere, normal)
    slide = tangential * times
    light = 2 / 7 * sphere.mass_kg  # mass of the contact point of a sphere
    friction = force = np.zeros_like(times)
    for _ in range(SWEEPS):
        answer = sj.laws.drive(law, {"penetration_depth_m": depth, "slide_m": slide}, **sphere.pair)
        friction, force = answer["tangential_force_N"], answer["normal_force_N"]
        speed = tangential - cumulative_trapezoid(friction, times, initial=0.0) / light
        moved = cumulative_trapezoid(speed, times, initial=0.0)
        done = np.abs(moved - slide).max() <= 1e-9 * np.abs(moved).max()
        slide = moved
        if done:
            break
    # A contact that loses energy keeps its impulse in proportion to (1 + e)/2, to first order in 1 - e.
    impulse = np.trapz(friction, times) * (1 + sphere.restitution) / 2
    spin = -impulse * sphere.radius_m / (0.4 * sphere.mass_kg * sphere.radius_m**2)
    along = tangential - impulse / sphere.mass_kg
    return Rebound(sphere.restitution * normal, along, along + spin * sphere.radius_m, spin, float(force.max()),
                   float(times[-1]))
