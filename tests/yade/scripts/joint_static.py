# SPDX-License-Identifier: GPL-3.0-or-later
"""Revolute joint at prescribed positions: force curve, friction, moments, static load."""
import statejump_yade as sj
from yade.minieigenHP import Quaternion, Vector3

from parts import *  # noqa: F403

ALPHA_JOURNAL, ALPHA_BEARING = 23.4e-6, 12e-6


def force_curve(change):
    """Push a journal into a fixed bearing; return rows of depth, force, kn, ks, R1, R2."""
    reset()
    pin = body(shape=sj.Journal(radius=R1), made_of=material(expansion=ALPHA_JOURNAL))
    hole = body(shape=sj.Bearing(radius=R2), made_of=material(expansion=ALPHA_BEARING))
    engines(constant(change))
    O.dt = 1e-9
    O.step()
    rows = []
    clearance = R2 * (1 + ALPHA_BEARING * change) - R1 * (1 + ALPHA_JOURNAL * change)
    for depth in (1e-7, 3e-7, 1e-6, 3e-6, 1e-5):
        O.bodies[pin].state.pos = (0.6 * (clearance + depth), 0.8 * (clearance + depth), 0)
        O.step()
        found = contact(pin, hole)
        force = O.forces.f(pin)
        rows.append(
            {
                "depth": depth,
                "force": list(force),
                "seen_depth": found.geom.penetrationDepth,
                "kn": found.phys.kn,
                "ks": found.phys.ks,
                "R": found.geom.effectiveRadius,
                "refR": [found.geom.refR1, found.geom.refR2],
                "reaction": list(O.forces.f(hole)),
            }
        )
    # Back into the gap: the contact ends.
    O.bodies[pin].state.pos = (0.5 * clearance, 0, 0)
    O.step()
    gone = contact(pin, hole) is None and O.forces.f(pin).norm() == 0
    return {"rows": rows, "clearance": clearance, "gone": gone}


def spinning(first_bearing):
    """Rotate a pressed journal about its axis and back; return friction force over slide."""
    reset()
    depth, spin = 1e-5, 10.0
    metal = material()

    def pin():
        return body(
            (CLEARANCE + depth, 0, 0), sj.Journal(radius=R1), metal, spin=(0, 0, spin)
        )

    def hole():
        return body(shape=sj.Bearing(radius=R2), made_of=metal)

    if first_bearing:
        b = hole()
        a = pin()
    else:
        a = pin()
        b = hole()
    engines()
    O.dt = 1e-6
    rows = []
    for i in range(120):
        if i == 80:
            O.bodies[a].state.angVel = (0, 0, -spin)
        O.step()
        found = contact(a, b)
        rows.append(
            [O.forces.f(a)[1], -O.forces.f(a)[0], O.forces.t(a)[2], O.forces.t(b)[2], found.phys.slipping]
        )
    return {
        "rows": rows,
        "arm": R1 - 0.5 * depth,
        "slide_per_step": spin * (R1 - 0.5 * depth) * O.dt,
        "depth": depth,
        "ids": [contact(a, b).id1, contact(a, b).id2, a, b],
    }


def sliding_pad():
    """Pull a loaded pad along the floor of its slot."""
    reset()
    radius, depth, speed = 0.05, 2e-6, 0.1
    metal = material()
    pad = body((0, -depth, 0), sj.Slider(radius=radius), metal, velocity=(speed, 0, 0))
    body(
        shape=sj.SlotFace(normal=(0, -1, 0), distance=radius, halfSize=radius), made_of=metal
    )
    engines()
    O.dt = 1e-7
    rows = []
    for _ in range(150):
        O.step()
        rows.append([O.forces.f(pad)[0], O.forces.f(pad)[1]])
    return {"rows": rows, "slide_per_step": speed * O.dt, "depth": depth, "radius": radius}


def static_load():
    """A journal under a constant load inside the friction cone, for many steps."""
    reset()
    metal = material()
    load = (5.0, -50.0, 0.0)
    pin = body(
        (0, -CLEARANCE - 1.5e-6, 0), sj.Journal(radius=R1), metal, mass=0.01, inertia=1e-7,
        blocked="zXYZ",
    )
    body(shape=sj.Bearing(radius=R2), made_of=metal)
    engines(normal_damping=0.2, tangential_damping=0.2)
    O.forces.setPermF(pin, load)
    O.dt = 1e-10
    O.step()
    O.dt = 0.2 * sj.stable_time_step()
    O.run(10000, True)
    before = list(O.bodies[pin].state.pos)
    found = contact(pin, pin + 1)
    forces = [list(found.phys.normalForce), list(found.phys.shearForce)]
    O.run(20000, True)
    after = list(O.bodies[pin].state.pos)
    return {
        "before": before,
        "after": after,
        "time": 20000 * O.dt,
        "forces": forces,
        "load": load,
        "velocity": list(O.bodies[pin].state.vel),
    }


def balance(rotation, offset):
    """Off-centre, turned, moving bodies: resultant and moment of all contact forces."""
    reset()
    metal = material()
    turned = rotation * Quaternion((0, 0, 1), 0.7)
    depth = 4e-6
    across = rotation * Vector3(0.6, -0.8, 0)
    axis = rotation * Vector3(0, 0, 1)
    centre = Vector3(*offset)
    pin = body(
        centre + (CLEARANCE + depth) * across + 3e-3 * axis, sj.Journal(radius=R1), metal,
        mass=0.01, inertia=1e-6, blocked="", orientation=turned,
        velocity=rotation * Vector3(0.02, 0.03, 0.05), spin=40 * axis,
    )
    hole = body(
        centre, sj.Bearing(radius=R2), metal, mass=0.05, inertia=1e-5, blocked="",
        orientation=rotation * Quaternion((0, 0, 1), -0.3),
        velocity=rotation * Vector3(-0.01, 0, 0.01), spin=-15 * axis,
    )
    engines(normal_damping=0.1, tangential_damping=0.1, reader="read()")
    O.dt = 1e-7
    point = Vector3(0.7, -1.1, 0.4)
    rows = []

    def read():
        force, moment, scale, largest = Vector3.Zero, Vector3.Zero, 0.0, 0.0
        for i in (pin, hole):
            f, t = O.forces.f(i, True), O.forces.t(i, True)
            arm = O.bodies[i].state.pos - point
            force += f
            moment += t + arm.cross(f)
            scale += arm.norm() * f.norm()
            largest = max(largest, t.norm())
        rows.append([force.norm(), moment.norm(), scale, largest])

    __import__("__main__").read = read
    O.run(30, True)
    return rows


finish(
    {
        "curves": {str(change): force_curve(change) for change in (0.0, 50.0)},
        "alphas": [ALPHA_JOURNAL, ALPHA_BEARING],
        "spinning": spinning(False),
        "spinning_swapped": spinning(True),
        "sliding_pad": sliding_pad(),
        "static": static_load(),
        "balance": balance(
            Quaternion((0.36, 0.48, 0.8), 1.1), (0.3, -0.2, 0.1)
        ),
    }
)
