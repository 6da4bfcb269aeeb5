# SPDX-License-Identifier: GPL-3.0-or-later
"""A ball that rotates freely and rubs in a socket, with every rotation scheme of YADE."""
from parts import *  # noqa: F403

STEPS = 400


def turned(**integrator):
    """Return rows of numbers after the steps, and whether YADE treats any body as aspherical."""
    reset()
    metal = material()
    ball = body(
        (0.99e-4, 0.2e-4, 0), sj.Ball(radius=R1), metal, mass=0.02, inertia=3e-7, blocked="",
        velocity=(0.05, -0.03, 0.02), spin=(20, -10, 35),
    )
    body((0, 0, 0), sj.Socket(radius=R2), metal)
    engines()
    for name, value in integrator.items():
        setattr(O.engines[-1], name, value)
    O.dt = 2e-7
    O.run(STEPS, True)
    state = O.bodies[ball].state
    rows = [list(state.pos), list(state.vel), list(state.angVel), [state.ori[i] for i in range(4)]]
    return {
        "rows": [[value.hex() for value in row] for row in rows],
        "angle": state.ori.toAxisAngle()[1],
        "friction": O.energy["jointFriction"],
        "aspherical": [one.aspherical for one in O.bodies],
    }


def ways():
    """Settings of the integrator that choose the rotation scheme; newer versions of YADE have more of them."""
    found = [{}, {"exactAsphericalRot": False}]
    if hasattr(wrapper.NewtonIntegrator, "rotAlgorithm"):
        found += [{"rotAlgorithm": name} for name in ("delValle2023", "Omelyan1998", "Fincham1992")]
        found += [{"normalizeEvery": 7}]
    return found


finish({"ways": [{"way": str(way), **turned(**way)} for way in ways()]})
