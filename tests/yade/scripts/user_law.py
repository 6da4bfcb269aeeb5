# SPDX-License-Identifier: GPL-3.0-or-later
"""A law from a shared library: force at one depth, impacts, documentation; or the error of an invalid library."""
from __future__ import annotations

import sys

import statejump_yade as sj

from parts import *  # noqa: F403

Law = sj.Law2_JointGeom_JointPhys_JointLaw
MODULUS = 70e9 / (2 * (1 - 0.3**2))


def pair(law, depth: float, speed: float = 0.0) -> tuple[int, int]:
    reset()
    metal = material(0.0)
    pin = body((CLEARANCE + depth, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, blocked="yzXYZ",
               velocity=(speed, 0, 0))
    hole = body((0, 0, 0), sj.Bearing(radius=R2), metal)
    engines(law=law)
    return pin, hole


def at_depth(name: str) -> dict:
    pin, hole = pair(Law(normalLaw=name), 5e-6)
    O.dt = 1e-12
    O.step()
    found = O.interactions[pin, hole]
    return {"force": found.phys.normalForce[0], "kn": found.phys.kn, "depth": found.geom.penetrationDepth,
            "radii": [found.geom.journalRadius, found.geom.bearingRadius], "length": 0.01,
            "modulus": found.phys.effectiveYoungModulus}


def impact(name: str) -> float:
    pin, _ = pair(Law(dissipationLaw=name, restitution=0.7), -1e-7, 0.1)
    O.dt = 1e-7
    O.run(3000, True)
    return O.bodies[pin].state.vel[0]


if len(sys.argv) > 1 and not sys.argv[-1].endswith(".py"):
    pair(Law(normalLaw=sys.argv[-1]), 5e-6)
    O.dt = 1e-9
    print(sentence_of(lambda: [O.step() for _ in range(3)])[1], flush=True)
else:
    finish({**at_depth("cubic"), "impact": {name: impact(name) for name in ("twin", "hunt_crossley", "flores")},
            "doc": Law.normalLaw.__doc__})
