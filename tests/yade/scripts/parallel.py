# SPDX-License-Identifier: GPL-3.0-or-later
"""200 joints with friction, damping and expansion, run with -j1 and -j2; then a scene with a failure."""

import statejump_yade as sj

from parts import *  # noqa: F403


def many(count):
    reset()
    program = sj.ThermalProgram(shape="triangle", temperatureChangeMax=60, period=1e-4)
    metal = material(expansion=2.3e-5)
    other = material(expansion=1.1e-5)
    pins, links = [], []
    for i in range(count):
        x, y = 0.05 * (i % 20), 0.05 * (i // 20)
        body((x, y, 0), sj.Bearing(radius=R2), other)
        pin = body(
            (x + 1.0e-4, y + 0.3e-4 + 1e-7 * i, 0), sj.Journal(radius=R1), metal, mass=0.02,
            inertia=3e-7, blocked=PLANAR, velocity=(0.02, 0.03, 0), spin=(0, 0, 10 + 0.1 * i),
        )
        pins.append(pin)
        root = body((x + 0.05, y, 0))
        links.append(
            sj.ThermalLink(
                id1=root, id2=pin, youngModulus=70e9, crossSectionArea=1e-7, stressFreeLength=0.05,
                thermalExpansion=2.3e-5, dampingRatio=0.05, program=program,
            )
        )
    engines(program, links, 0.05, 0.05)
    for pin in pins:
        O.forces.setPermF(pin, (200, 60, 0))
    O.dt = 3e-7
    O.run(400, True)
    states = [
        [*O.bodies[i].state.pos, *O.bodies[i].state.vel, O.bodies[i].state.angVel[2]] for i in pins
    ]
    return {"states": states, "energies": energies(), "touching": sum(1 for i in O.interactions if i.isReal)}


def failing():
    """All contacts fail at once, in both threads."""
    reset()
    metal = material()
    for i in range(100):
        body((0.05 * i, 0, 0), sj.Bearing(radius=R1), metal)
        body((0.05 * i, 0, 0), sj.Journal(radius=R2), metal)
    engines()
    O.dt = 1e-7
    return fault_of(lambda: [O.step() for _ in range(10)])


finish({"many": [many(200) for _ in range(2)], "failing": failing(), "threads": O.numThreads})
