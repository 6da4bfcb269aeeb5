# SPDX-License-Identifier: GPL-3.0-or-later
"""Torsion springs between links, viscous pins."""
from math import cos, pi, sin, sqrt

import statejump_yade as sj
from yade.minieigenHP import Vector3

from parts import *  # noqa: F403

L1, L2, MASS = 0.4, 0.5, 0.02


def one_by_one(steps):
    for _ in range(steps):
        O.step()


def link_of(root, tip, length, **keywords):
    return sj.ThermalLink(
        id1=root, id2=tip, youngModulus=70e9, crossSectionArea=keywords.pop("area", 1e-6),
        stressFreeLength=length, program=constant(), **keywords,
    )


def two_links(angle1, angle2, blocked="zXYZ", blocked1=None, area=1e-6, damping=0.0, pin=0.0, z=0.0):
    """Two links with fixed roots and free tips; angles give their directions."""
    reset()
    roots = [body((0, 0, 0)), body((0.7, 0.1, 0))]
    tips = [
        body((L1 * cos(angle1), L1 * sin(angle1), z), mass=MASS, blocked=blocked1 or blocked),
        body((0.7 + L2 * cos(angle2), 0.1 + L2 * sin(angle2), 0), mass=2 * MASS, blocked=blocked),
    ]
    links = [
        link_of(roots[0], tips[0], L1, area=area, dampingRatio=damping, pinDamping=pin),
        link_of(roots[1], tips[1], L2, area=area, dampingRatio=damping, pinDamping=pin),
    ]
    return roots, tips, links


def angles():
    """Angle, moment and forces for directions all round."""
    rows = []
    for angle1, angle2, free in (
        (0.3, 1.0, 0.2), (1.0, 0.3, 0.2), (2.9, -2.9, -1.0), (-2.9, 2.9, 0.0), (0.0, pi, 0.5),
        (-0.5, -0.5, 3.0),
    ):
        roots, tips, links = two_links(angle1, angle2, blocked="xyzXYZ")
        spring = sj.TorsionSpring(link1=links[0], link2=links[1], stiffness=3.0, freeAngle=free)
        engines(links=links, springs=[spring])
        O.dt = 1e-9
        O.step()
        forces = [O.forces.f(i, True) for i in (*roots, *tips)]
        places = [O.bodies[i].state.pos for i in (*roots, *tips)]
        rows.append(
            {
                "directions": [angle1, angle2], "free": free, "angle": spring.angle,
                "moment": spring.moment, "energy": O.energy["torsionElastic"],
                "force": list(forces[0] + forces[1] + forces[2] + forces[3]),
                "total": sum(p.cross(f)[2] for p, f in zip(places, forces)),
                "on_links": [
                    (places[2] - places[0]).cross(forces[2])[2],
                    (places[3] - places[1]).cross(forces[3])[2],
                ],
                "along": [(places[2] - places[0]).dot(forces[2]), (places[3] - places[1]).dot(forces[3])],
            }
        )
    return rows


def balance():
    """Rest positions of two links held only by a torsion spring, with a force on each tip."""
    roots, tips, links = two_links(0.3, 2.0, damping=0.5, pin=0.2)
    spring = sj.TorsionSpring(link1=links[0], link2=links[1], stiffness=2.0, freeAngle=1.2)
    # The couples are opposite, so only opposite moments can be held: the first link is held by a
    # second spring against a third, fixed one.
    base = body((-1, 0, 0))
    end = body((-0.5, 0, 0))
    third = link_of(base, end, 0.5)
    other = sj.TorsionSpring(link1=third, link2=links[0], stiffness=5.0, freeAngle=0.3)
    engines(links=[*links, third], springs=[spring, other])
    pulls = {tips[0]: (0.3, 0.8, 0), tips[1]: (0.5, -1.0, 0)}
    for i, force in pulls.items():
        O.forces.setPermF(i, force)
    O.dt = 4e-5
    O.run(120000, True)
    return {
        "angles": [spring.angle, other.angle], "moments": [spring.moment, other.moment],
        "arms": [list(O.bodies[t].state.pos - O.bodies[r].state.pos) for r, t in zip(roots, tips)],
        "pulls": [list(f) for f in pulls.values()],
        "speeds": [O.bodies[t].state.vel.norm() for t in tips],
        "energy": O.energy["torsionElastic"],
    }


def oscillation(time_step, steps):
    """Energy and sum of moments of two links that swing against each other without damping."""
    roots, tips, links = two_links(0.3, 1.8)
    spring = sj.TorsionSpring(link1=links[0], link2=links[1], stiffness=2.0, freeAngle=1.2)
    engines(links=links, springs=[spring], reader="read()")
    account = Balance(tips)
    largest = [0.0]

    def read():
        account.read()
        largest[0] = max(largest[0], O.energy["torsionElastic"])

    __import__("__main__").read = read
    O.dt = time_step
    O.run(steps, True)
    momentum = [
        O.bodies[t].state.mass * (O.bodies[t].state.pos - O.bodies[r].state.pos).cross(O.bodies[t].state.vel)[2]
        for r, t in zip(roots, tips)
    ]
    return {
        "worst": max(abs(v - account.values[0]) for v in account.values), "first": account.values[0],
        "largest": largest[0], "momentum": momentum, "steps": steps,
        "promised": sj.stable_time_step(),
    }


LATCH = dict(stiffness=2.0, freeAngle=1.2, deadband=0.05, preload=0.3, frictionLimit=0.08, frictionStiffness=4.0)


def latch_loop(steps, amplitude=0.2):
    """Return moment over angle of a torsion spring with play and friction, driven to the amplitude, its opposite and
    back."""
    roots, tips, links = two_links(0.3, 1.5, blocked="xyzXYZ")
    spring = sj.TorsionSpring(link1=links[0], link2=links[1], **LATCH)
    engines(links=[], springs=[spring])
    O.dt = 1e-9
    rows = []
    way = [k * amplitude / steps for k in [*range(steps + 1), *range(steps - 1, -steps, -1), *range(-steps, steps + 1)]]
    for stretch in way:
        angle = 0.3 + 1.2 + stretch
        O.bodies[tips[1]].state.pos = (0.7 + L2 * cos(angle), 0.1 + L2 * sin(angle), 0)
        O.step()
        rows.append([stretch, spring.moment, spring.frictionMoment, O.energy["torsionElastic"], O.energy["torsionFriction"]])
    return {"rows": rows, "amplitude": amplitude, **LATCH}


def latch_swing(time_step, steps):
    """Two links that swing against each other through the play of a latch until friction stops them."""
    roots, tips, links = two_links(0.3, 1.8)
    spring = sj.TorsionSpring(link1=links[0], link2=links[1], **LATCH)
    engines(links=links, springs=[spring], reader="read()")
    account, pieces = Balance(tips), []

    def read():
        account.read()
        stretch, slips = spring.angle - spring.freeAngle, abs(spring.frictionMoment) == spring.frictionLimit
        pieces.append((stretch > spring.deadband, stretch < -spring.deadband, slips))

    __import__("__main__").read = read
    O.dt = time_step
    O.run(steps, True)
    return {"worst": max(abs(v - account.values[0]) for v in account.values), "first": account.values[0],
            "friction": O.energy["torsionFriction"], "dt": time_step,
            "corners": sum(one != other for one, other in zip(pieces, pieces[1:]))}


def latch_limit(factor):
    """As limit(), of a spring in its play whose friction sticks."""
    roots, tips, links = two_links(0.3, 1.5, blocked1="xyzXYZ", area=1e-12)
    spring = sj.TorsionSpring(link1=links[0], link2=links[1], stiffness=20.0, freeAngle=1.2, deadband=0.1,
                              frictionLimit=1.0, frictionStiffness=30.0)
    engines(links=links, springs=[spring])
    true = 2 * sqrt(2 * MASS * L2**2 / 50.0)
    O.dt = factor * true
    return {"error": fault_of(lambda: one_by_one(3)), "true": true, "promised": sj.stable_time_step()}


def limit(factor):
    """One link tip on a torsion spring stiffer than the links; dt is ``factor`` times the stability limit."""
    roots, tips, links = two_links(0.3, 1.5 + 1e-6, blocked1="xyzXYZ", area=1e-12)
    spring = sj.TorsionSpring(link1=links[0], link2=links[1], stiffness=50.0, freeAngle=1.2)
    engines(links=links, springs=[spring])
    true = 2 * sqrt(2 * MASS * L2**2 / 50.0)
    O.dt = factor * true
    angles = [0.0]

    def run():
        for _ in range(300):
            O.step()
            angles.append(abs(spring.angle - 1.2))

    text = fault_of(run)
    return {"largest": max(angles), "error": text, "true": true, "promised": sj.stable_time_step()}


def decay(both_free, time_step):
    """A link that turns in its viscous pin."""
    reset()
    spin = 3.0
    root = body((0, 0, 0), mass=0.03, blocked="zXYZ" if both_free else "xyzXYZ")
    tip = body((0.3, 0.4, 0), mass=MASS, blocked="zXYZ")
    mass = 0.03 * MASS / (0.03 + MASS) if both_free else MASS
    share = 0.03 / (0.03 + MASS) if both_free else 1.0
    O.bodies[tip].state.vel = share * spin * Vector3(-0.4, 0.3, 0)
    O.bodies[root].state.vel = (share - 1) * spin * Vector3(-0.4, 0.3, 0)
    link = link_of(root, tip, 0.5, area=1e-5, pinDamping=0.01)
    engines(links=[link], reader="read()")
    account = Balance([tip, *([root] if both_free else [])])
    __import__("__main__").read = account.read
    O.dt = time_step
    rows = []
    for _ in range(20):
        O.run(round(0.05 / time_step), True)
        a, b = O.bodies[root].state, O.bodies[tip].state
        between, rate = b.pos - a.pos, b.vel - a.vel
        rows.append([O.iter, between.cross(rate)[2] / between.norm() ** 2])
    total = 0.03 * O.bodies[root].state.vel * both_free + MASS * O.bodies[tip].state.vel
    return {
        "rows": rows, "spin": spin, "rate": 0.01 / (mass * 0.25), "dt": time_step,
        "energy": O.energy["pinDamping"], "kinetic": 0.5 * mass * 0.25 * spin**2,
        "worst": max(abs(v - account.values[0]) for v in account.values),
        "momentum": total.norm() if both_free else 0.0,
    }


def pin_limit(factor):
    """A pin so viscous that it decides the time step."""
    reset()
    root, tip = body((0, 0, 0)), body((0.5, 0, 0), mass=MASS, blocked="zXYZ", velocity=(0, 1e-6, 0))
    link = link_of(root, tip, 0.5, area=1e-12, pinDamping=5.0)
    engines(links=[link])
    true = 2 * MASS * 0.25 / 5.0
    O.dt = factor * true
    text = fault_of(lambda: one_by_one(300))
    return {"error": text, "speed": O.bodies[tip].state.vel.norm(), "true": true,
            "promised": sj.stable_time_step()}


def wrong(change):
    roots, tips, links = two_links(0.3, 1.0, z=change.get("z", 0.0))
    keywords = dict(link1=links[0], link2=links[1], stiffness=1.0)
    keywords.update(change.get("spring", {}))
    if change.get("erase"):
        O.bodies.erase(tips[1])
    engines(links=[], springs=[None] if change.get("none") else [sj.TorsionSpring(**keywords)])
    O.dt = 1e-7
    return fault_of(lambda: one_by_one(3))


finish(
    {
        "angles": angles(),
        "balance": balance(),
        "oscillation": [oscillation(4e-5 / 2**k, 5000 * 2**k) for k in range(3)],
        "limit": {str(f): limit(f) for f in (0.95, 1.05)},
        "latch": latch_loop(50),
        "latch_swing": [latch_swing(4e-5 / 2**k, 5000 * 2**k) for k in range(3)],
        "latch_limit": {str(f): latch_limit(f) for f in (0.95, 1.05)},
        "decay": [[decay(both, 2e-5 / 2**k) for k in range(2)] for both in (False, True)],
        "pin_limit": {str(f): pin_limit(f) for f in (0.95, 1.05)},
        "wrong": {
            "link1": wrong(dict(spring=dict(link1=None))),
            "link2": wrong(dict(spring=dict(link2=None))),
            "None": wrong(dict(none=True)),
            "plane": wrong(dict(z=0.01)),
            "body": wrong(dict(erase=True)),
            "nothing": wrong(dict()),
        },
    }
)
