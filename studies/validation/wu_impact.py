# SPDX-License-Identifier: GPL-3.0-or-later
"""Oblique impact of a steel sphere, beside finite elements of Wu."""
from __future__ import annotations

from manual import OTHER_CODE, Curve, Entry, Picture, Row, show

import numpy as np
from impact import Sphere, rebound

SPHERE = Sphere(208e9, 0.3, 7850.0, 0.1, 0.3)
SPEED = 5.0
SCALE = SPHERE.friction * SPEED
# Tangential velocity of the contact point before and after, over friction times normal speed.
CONTACT_POINT = [(0.272, -0.027), (0.586, -0.027), (0.876, -0.080), (1.190, -0.213), (1.553, -0.373), (1.915, -0.627),
                 (2.314, -0.947), (2.785, -1.253), (3.317, -1.520), (3.970, -1.720), (4.755, -1.707), (5.758, -1.200),
                 (7.124, 0.133), (9.118, 2.147), (12.356, 5.427)]
SPIN = [(0.318, -0.187), (0.595, -0.406), (0.890, -0.665), (1.185, -0.982), (1.532, -1.355), (1.896, -1.793),
        (2.277, -2.321),
        (2.763, -2.856), (3.301, -3.441), (3.890, -4.041), (4.688, -4.569), (5.659, -4.941), (7.029, -4.941),
        (9.040, -4.972),
        (12.335, -4.970)]


def leaves(before: float, law: str = "mindlin_deresiewicz") -> tuple[float, float]:
    """Return velocity of the contact point and R times spin after the impact, both over friction times normal speed."""
    found = rebound(SPHERE, law, SPEED, before * SCALE)
    return found.contact_point / SCALE, found.spin * SPHERE.radius_m / SCALE


def off(readings: list[tuple[float, float]], which: int, law: str = "mindlin_deresiewicz") -> float:
    """Return the root mean square difference."""
    return float(np.sqrt(np.mean([(leaves(before, law)[which] - value) ** 2 for before, value in readings])))


def entry() -> Entry:
    grid = np.linspace(0.2, 12.0, 25)
    return Entry(
        name="wu_impact", part="Contact and laws", title="Oblique impact of a steel sphere (finite elements of Wu)",
        kind=OTHER_CODE, source="C. Y. Wu, finite elements, as quoted by Y. C. Chung and J. Y. Ooi, Granul. Matter 13 "
        "(2011) 643-656, test 5", uncertainty="readings of figures: 0.5 % of the scale, 0.06; mesh",
        statement="A steel sphere hits a rigid wall at 5 m/s across it and at many speeds along it; friction 0.3, no "
        "loss in the normal direction. Find the velocity of the contact point and the spin after the impact.",
        tolerance=0.08, reason="mesh and readings, over friction times normal speed",
        rows=[Row("velocity of the contact point, rms difference", "μ v", 0.0, off(CONTACT_POINT, 0), scale=1.0),
              Row("spin, rms difference", "μ v/R", 0.0, off(SPIN, 1), scale=1.0)],
        picture=Picture("contact point before [μ v]", "contact point after [μ v]", [
            Curve("partial slip", grid, [leaves(float(at))[0] for at in grid]),
            Curve("finite elements", [at for at, _ in CONTACT_POINT], [value for _, value in CONTACT_POINT],
                  ours=False)]),
        verdict="Partial slip follows the finite elements through sticking, partial slip and sliding.")


if __name__ == "__main__":
    show(entry())
