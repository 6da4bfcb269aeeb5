# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliders between two bodies."""
from math import inf, sqrt

import statejump_yade as sj
from yade.minieigenHP import Vector3

from parts import *  # noqa: F403

AXIS = Vector3(2, 3, 6) / 7
ACROSS = AXIS.cross(Vector3(0, 0, 1)).normalized()
OFFSET = Vector3(0.1, -0.2, 0.05)
MASSES = 0.02, 0.03
LAW = dict(stiffnessAcross=3e5, frictionLimit=2.0, frictionStiffness=1e5, clearanceMinus=3e-4, clearancePlus=2e-4,
           stopStiffness=1e8)
BOLT = dict(stopStiffness=0.0, stopSpring=2e6, play=1.5e-4)


def pair(blocked="XYZ", dt=1e-9, reader=None, **keywords):
    """Two bodies whose slide is 0."""
    reset()
    ids = [body(OFFSET, mass=MASSES[0], blocked=blocked), body((0, 0, 0), mass=MASSES[1], blocked=blocked)]
    joint = sj.PrismaticJoint(id1=ids[0], id2=ids[1], axis=AXIS, offset=OFFSET, **{**LAW, **keywords})
    engines(prismatic_joints=[joint], reader=reader)
    O.dt = dt
    return ids, joint


def loop(steps, amplitude, **keywords):
    """Forces of a prismatic joint moved along its axis to the amplitude, its opposite and back, at a constant lateral
    offset."""
    aside = 1e-6
    ids, joint = pair(blocked="xyzXYZ", **keywords)
    rows = []
    for k in [*range(steps + 1), *range(steps - 1, -steps, -1), *range(-steps, steps + 1)]:
        slide = k * amplitude / steps
        O.bodies[ids[0]].state.pos = OFFSET + slide * AXIS + aside * ACROSS
        O.step()
        force = O.forces.f(ids[0], True)
        rows.append([slide, joint.slide, joint.frictionForce, joint.stopForce, -force.dot(AXIS), -force.dot(ACROSS),
                     (force + O.forces.f(ids[1], True)).norm(), O.energy["prismaticElastic"],
                     O.energy["prismaticFriction"]])
    return {"rows": rows, "amplitude": amplitude, "aside": aside, **LAW, **keywords}


def swing(dt, time, ratio, **keywords):
    """Two free bodies, which move against each other along and across the axis until friction stops them."""
    ids, joint = pair(dt=dt, reader="read()", dampingRatio=ratio, **keywords)
    start = O.bodies[ids[0]].state
    start.vel = 0.3 * AXIS + 0.02 * ACROSS
    account, seen = Balance(ids), {"stops": 0, "slips": 0}

    def read():
        account.read()
        seen["stops"] += joint.stopForce != 0
        seen["slips"] += abs(joint.frictionForce) == joint.frictionLimit

    __import__("__main__").read = read
    before = MASSES[0] * start.vel
    O.run(round(time / dt), True)
    momentum = sum((mass * O.bodies[i].state.vel for i, mass in zip(ids, MASSES)), Vector3(0, 0, 0)) - before
    return {"worst": max(abs(v - account.values[0]) for v in account.values), "first": account.values[0],
            "momentum": momentum.norm(), "steps": O.iter, "friction": O.energy["prismaticFriction"],
            "damping": O.energy["prismaticDamping"], **seen}


def limit(factor):
    """One body on the stiffest spring; dt is ``factor`` times the exact stability limit."""
    reset()
    ids = [body(OFFSET, mass=MASSES[0], blocked="XYZ"), body((0, 0, 0))]
    joint = sj.PrismaticJoint(id1=ids[0], id2=ids[1], axis=AXIS, offset=OFFSET, **LAW)
    engines(prismatic_joints=[joint])
    true = 2 * sqrt(MASSES[0] / LAW["stiffnessAcross"])
    O.dt = factor * true
    return {"error": fault_of(O.step), "true": true, "promised": sj.stable_time_step()}


def wrong():
    found = {}
    for name, value in (("axis", (0, 0, 0.5)), ("stiffnessAcross", -1.0), ("frictionLimit", float("nan")),
                        ("clearancePlus", -1e-3), ("dampingRatio", -0.1), ("offset", (inf, 0, 0))):
        found[name] = fault_of(lambda name=name, value=value: sj.PrismaticJoint(**{name: value}))
    for name, changed in {"body": dict(id2=7), "same": dict(id2=0), "friction": dict(frictionStiffness=0.0),
                          "stop": dict(stopStiffness=0.0)}.items():
        def run(changed=changed):
            _, joint = pair()
            joint.updateAttrs(changed)
            O.step()

        found[name] = fault_of(run)

    def none():
        pair()
        O.engines[-2].joints = [None]
        O.step()

    found["none"] = fault_of(none)
    return found


finish({
    "loop": loop(200, 4e-4), "swing": [swing(dt, 0.02, 0.0) for dt in (4e-6, 2e-6)], "damped": swing(2e-6, 0.02, 0.1),
    "bolt": loop(200, 4e-4, **BOLT), "bolt_swing": [swing(dt, 0.02, 0.0, **BOLT) for dt in (4e-6, 2e-6)],
    "limit": {str(factor): limit(factor) for factor in (0.95, 1.05)}, "wrong": wrong(),
})
