# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured oblique impacts of aluminium oxide spheres: Kharaz, Gorham and Salman."""
from __future__ import annotations

from math import atan2, cos, degrees, radians, sin

from manual import MEASUREMENT, Curve, Entry, Picture, Row, show

import numpy as np
from impact import Rebound, Sphere, rebound

SPHERE = Sphere(380e9, 0.23, 4000.0, 2.5e-3, 0.092, 0.98)
SPEED = 3.9  # m/s
# Angle of incidence [degrees], reading; read from the figures of Chung and Ooi to about 0.5 % of the scales.
RESTITUTION = [(2.24, 0.797), (4.22, 0.746), (9.84, 0.675), (20.22, 0.599), (30.36, 0.690), (39.54, 0.774),
               (49.60, 0.848),
               (71.07, 0.937), (79.23, 0.970), (85.17, 0.979)]
SPIN = [(5.90, -134.9), (10.87, -261.2), (21.12, -573.7), (31.14, -612.2), (38.95, -595.1), (50.24, -449.5),
        (60.10, -375.7),
        (69.96, -243.0), (78.56, -142.4), (84.32, -70.6)]
REBOUND_ANGLE = [(2.10, 0.77), (3.94, 0.77), (9.72, -1.06), (20.31, -8.53), (30.16, -2.55), (39.12, 9.91),
                 (49.51, 30.02),
                 (59.90, 49.95), (70.46, 66.90), (78.86, 78.87), (84.78, 85.68)]


def after(angle: float, law: str = "mindlin_deresiewicz") -> Rebound:
    """Return the rebound at an angle of incidence [degrees]."""
    return rebound(SPHERE, law, SPEED * cos(radians(angle)), SPEED * sin(radians(angle)))


def restitution(angle: float, law: str = "mindlin_deresiewicz") -> float:
    """Return the tangential restitution of the centre."""
    return after(angle, law).tangential / (SPEED * sin(radians(angle)))


def contact_angle(angle: float) -> float:
    """Return the rebound angle of the contact point [degrees]."""
    found = after(angle)
    return degrees(atan2(found.contact_point, found.normal))


def root_mean_square(differences: list[float]) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(differences))))


def entry() -> Entry:
    of_restitution = root_mean_square([restitution(at) - value for at, value in RESTITUTION])
    of_spring = root_mean_square([restitution(at, "mindlin") - value for at, value in RESTITUTION])
    of_spin = root_mean_square([after(at).spin - value for at, value in SPIN])
    of_angle = root_mean_square([contact_angle(at) - value for at, value in REBOUND_ANGLE])
    grid = [2.0, 4.0, 7.0, 10.0, 14.0, 18.0, 22.0, 26.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 86.0]
    return Entry(
        name="kharaz", part="Contact and laws", title="Measured oblique impacts of a sphere (Kharaz, Gorham, Salman)",
        kind=MEASUREMENT, source="A. H. Kharaz, D. A. Gorham, A. D. Salman, Powder Technol. 120 (2001) 281-291, as "
        "quoted by Y. C. Chung and J. Y. Ooi, Granul. Matter 13 (2011) 643-656, test 4",
        uncertainty="readings of figures: 0.5 % of the scale; "
        "scatter of the tests about 0.01 of the restitution",
        statement="Spheres of aluminium oxide, 5 mm, hit a thick anvil at 3.9 m/s and 2° to 85°. Friction 0.092 and "
        "normal restitution 0.98 were measured in the same tests. Find tangential restitution, spin and rebound angle.",
        tolerance=0.04, reason="root mean square over the scale of the quantity: readings, scatter, anvil taken as "
        "rigid",
        rows=[Row("tangential restitution, rms difference", "1", 0.0, of_restitution, scale=1.0),
              Row("tangential restitution with a spring instead of partial slip, rms", "1", 0.0, of_spring, scale=1.0,
                  tolerance=0.06),
              Row("spin, rms difference", "rad/s", 0.0, of_spin, scale=612.2),
              Row("rebound angle of the contact point, rms difference", "°", 0.0, of_angle, scale=90.0)],
        picture=Picture("angle of incidence [°]", "tangential restitution", [
            Curve("partial slip", grid, [restitution(at) for at in grid]),
            Curve("measured", [at for at, _ in RESTITUTION], [value for _, value in RESTITUTION], ours=False)]),
        verdict="Partial slip predicts the measured restitution, spin and rebound angle within their scatter; a spring "
        "under Coulomb's limit misses the restitution by four times as much.")


if __name__ == "__main__":
    show(entry())
