# SPDX-License-Identifier: GPL-3.0-or-later
"""Revolute joint in motion: energy, momentum, rotation invariance."""

import statejump_yade as sj
from yade.minieigenHP import Quaternion, Vector3

from parts import *  # noqa: F403


def main_module(name, function):
    """PyRunner commands run in __main__."""
    setattr(__import__("__main__"), name, function)


def loop(time_step, steps, friction=FRICTION, damping=0.05):
    """A thermal cycle of a free journal and a free bearing on thermal links; clearance and link lengths change, and the
    bodies collide, slip and rotate."""
    reset()
    program = sj.ThermalProgram(shape="sine", temperatureChangeMax=80, period=time_step * steps)
    pin_metal = material(friction, 23.4e-6)
    hole_metal = material(friction, 10e-6)
    pin = body(
        (1.1e-4, 0.2e-4, 0), sj.Journal(radius=R1), pin_metal, mass=0.02, inertia=3e-7,
        blocked=PLANAR, velocity=(0.05, -0.03, 0), spin=(0, 0, 30),
    )
    hole = body(
        (0, 0, 0), sj.Bearing(radius=R2), hole_metal, mass=0.03, inertia=9e-7, blocked=PLANAR,
        velocity=(-0.02, 0.01, 0), spin=(0, 0, -10),
    )
    roots = [body((-0.05, 0, 0)), body((0.03, 0.04, 0))]
    common = dict(
        youngModulus=70e9, crossSectionArea=1e-7, dampingRatio=damping, thermalExpansion=23.4e-6,
        program=program,
    )
    links = [
        sj.ThermalLink(id1=roots[0], id2=pin, stressFreeLength=0.05, **common),
        sj.ThermalLink(id1=roots[1], id2=hole, stressFreeLength=0.05, **common),
    ]
    permanent = {pin: (3.0, -20.0, 0), hole: (0.0, 5.0, 0)}
    engines(program, links, damping, damping, reader="read()")
    for i, force in permanent.items():
        O.forces.setPermF(i, force)
    account = Balance([pin, hole], permanent)
    touched = [0]

    def read():
        account.read()
        touched[0] += contact(pin, hole) is not None

    main_module("read", read)
    O.dt = time_step
    O.run(steps, True)
    last = energies()
    return {
        "first": account.values[0],
        "worst": max(abs(v - account.values[0]) for v in account.values),
        "energies": last,
        "kinetic": account.kinetic[-1],
        "touched": touched[0] / steps,
        "final_strain": O.bodies[pin].shape.thermalStrain,
    }


def bounce(time_step, steps):
    """A journal hits the wall of a fixed bearing, without friction."""
    reset()
    metal = material(0.0)
    pin = body(
        (0.8e-4, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, inertia=3e-7, blocked="zXYZ",
        velocity=(0.1, 0, 0),
    )
    body((0, 0, 0), sj.Bearing(radius=R2), metal)
    engines(reader="read()")
    account = Balance([pin])
    depths = [0.0]

    def read():
        account.read()
        found = contact(pin, pin + 1)
        if found:
            depths[0] = max(depths[0], found.geom.penetrationDepth)

    main_module("read", read)
    O.dt = time_step
    O.run(steps, True)
    return {
        "speed": O.bodies[pin].state.vel[0],
        "worst": max(abs(v - account.values[0]) for v in account.values),
        "energy": account.values[0],
        "depth": depths[0],
    }


def momentum():
    """Journal and bearing, both free: momentum and angular momentum."""
    reset()
    metal = material()
    pin = body(
        (0.4e-4, 0.2e-4, 0), sj.Journal(radius=R1), metal, mass=0.02, inertia=3e-7, blocked=PLANAR,
        velocity=(0.3, 0.1, 0), spin=(0, 0, 50),
    )
    hole = body(
        (0, 0, 0), sj.Bearing(radius=R2), metal, mass=0.03, inertia=9e-7, blocked=PLANAR,
        velocity=(-0.1, 0, 0), spin=(0, 0, -20),
    )
    engines(normal_damping=0.05, tangential_damping=0.05)

    def total():
        linear, angular, scale = Vector3.Zero, 0.0, 0.0
        for i in (pin, hole):
            state = O.bodies[i].state
            linear += state.mass * state.vel
            angular += (state.mass * state.pos.cross(state.vel))[2] + state.inertia[2] * state.angVel[2]
            scale += state.inertia[2] * abs(state.angVel[2])
        return [linear[0], linear[1], angular, scale]

    before = total()
    spin = O.bodies[pin].state.angVel[2]
    O.dt = 2e-7
    O.run(20000, True)
    return {
        "before": before,
        "after": total(),
        "spin_change": O.bodies[pin].state.angVel[2] - spin,
        "steps": 20000,
        "friction": O.energy["jointFriction"],
    }


def trajectory(rotation, steps):
    """Return the motion of a journal that rolls and slips in a fixed bearing. The whole scene is rotated, and the
    motion is rotated back."""
    reset()
    metal = material(0.2)
    here = rotation * Vector3(0.03, -0.02, 0.01)
    pin = body(
        here + rotation * Vector3(1.01e-4, 0, 0), sj.Journal(radius=R1), metal, mass=0.02,
        inertia=3e-7, blocked="", orientation=rotation,
        velocity=rotation * Vector3(0, -0.01, 0), spin=rotation * Vector3(0, 0, 20),
    )
    body(here, sj.Bearing(radius=R2), metal, orientation=rotation)
    engines(normal_damping=0.1, tangential_damping=0.1)
    O.forces.setPermF(pin, rotation * Vector3(60, -10, 0))
    O.dt = 3e-7
    rows = []
    back = rotation.conjugate()
    for _ in range(10):
        O.run(steps // 10, True)
        state = O.bodies[pin].state
        found = contact(pin, pin + 1)
        shear = list(back * found.phys.shearForce) if found else [0, 0, 0]
        rows.append([list(back * state.pos), list(back * state.vel), list(back * state.angVel), shear])
    return rows


finish(
    {
        "loop": [loop(4e-7 / 2**k, 10000 * 2**k) for k in range(3)],
        "loop_lossless": [loop(4e-7 / 2**k, 10000 * 2**k, 0.0, 0.0) for k in range(2)],
        "bounce": [bounce(2e-6 / 2**k, 400 * 2**k) for k in range(4)],
        "momentum": momentum(),
        "straight": trajectory(Quaternion((0, 0, 1), 0), 4000),
        "turned": trajectory(Quaternion((0.36, 0.48, 0.8), 2.1), 4000),
    }
)
