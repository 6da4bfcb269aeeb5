# SPDX-License-Identifier: GPL-3.0-or-later
"""Head-on impact of elastic spheres: Chung and Ooi, test 1."""
from __future__ import annotations

from manual import CLOSED_FORM, Entry, Row, show

import numpy as np
from impact import Sphere, normal_motion
from scipy.special import gamma

import statejump as sj

YOUNG_PA, POISSON, DENSITY, RADIUS_M, SPEED = 48e9, 0.2, 2800.0, 0.01, 10.0


def entry() -> Entry:
    # Two equal spheres at ±10 m/s: by symmetry each meets a rigid wall.
    sphere = Sphere(YOUNG_PA, POISSON, DENSITY, RADIUS_M, 0.35)
    times, depth = normal_motion(sphere, SPEED)
    driven = sj.laws.drive("hertz_internal", {"penetration_depth_m": depth, "slide_m": 0 * depth}, **sphere.pair)
    force = float(driven["normal_force_N"].max())
    impulse = float(np.trapz(driven["normal_force_N"], times))
    stiffness = 4 / 3 * sphere.pair["effective_young_modulus_Pa"] * RADIUS_M**0.5
    deepest = (1.25 * sphere.mass_kg * SPEED**2 / stiffness) ** 0.4
    duration = 2 * deepest / SPEED * np.sqrt(np.pi) * gamma(1.4) / gamma(0.9)
    return Entry(
        name="hertz_impact", part="Contact and laws", title="Head-on impact of glass spheres (Chung and Ooi, test 1)",
        kind=CLOSED_FORM, source="H. Hertz 1882 (K. L. Johnson, Contact Mechanics, 1985, section 11.4); Y. C. Chung "
        "and J. Y. Ooi, Granul. Matter 13 (2011) 643-656, test 1: 10.70 kN and 40.5 µs, read from a figure",
        uncertainty="closed form exact; "
        "readings 1 %",
        statement="Two glass spheres of 20 mm meet at 10 m/s each. Find the largest force and the duration of the "
        "contact.",
        tolerance=2e-4, reason="closed form", rows=[
            Row("largest force, closed form", "kN", stiffness * deepest**1.5 / 1e3, force / 1e3),
            Row("duration, closed form", "µs", 1e6 * float(duration), 1e6 * float(times[-1])),
            Row("impulse over 2 m v", "1", 1.0, impulse / (2 * sphere.mass_kg * SPEED)),
            Row("largest force, published", "kN", 10.70, force / 1e3, tolerance=0.01),
            Row("duration, published", "µs", 40.5, 1e6 * float(times[-1]), tolerance=0.01)],
        verdict="Force, duration and impulse are those of Hertz.")


if __name__ == "__main__":
    show(entry())
