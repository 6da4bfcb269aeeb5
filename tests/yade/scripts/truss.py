# SPDX-License-Identifier: GPL-3.0-or-later
"""Guide planes and torsion springs in planes of any direction."""
import statejump_yade as sj
from yade.minieigenHP import Quaternion, Vector3

from parts import *  # noqa: F403


def link_of(root, tip):
    return sj.ThermalLink(id1=root, id2=tip, stressFreeLength=0.4, program=constant())


def guide():
    """A body held in an inclined plane by a guide, under a constant force, with initial velocity along the normal."""
    reset()
    normal = Vector3(1, 2, -2) / 3
    free = body((0.1, 0.2, 0.3), mass=0.5, blocked="XYZ")
    O.bodies[free].state.vel = Vector3(1, 0, 0)
    force = Vector3(0.3, -0.7, 0.2)
    O.forces.setPermF(free, force)
    O.engines = [ForceResetter(), sj.GuidePlanes(ids=[free], normals=[normal]), NewtonIntegrator(damping=0)]
    O.dt = 1e-4
    O.run(1000, True)
    state = O.bodies[free].state
    return {"position": list(state.pos), "velocity": list(state.vel), "normal": list(normal),
            "force": list(force), "time": O.time, "dt": O.dt}


def turned_spring():
    """Forces of one step of a torsion spring, in the x-y plane and with the whole scene rotated."""
    rows = []
    for turn in (Quaternion((0, 0, 1), 0), Quaternion(Vector3(1, 2, 3).normalized(), 0.8)):
        reset()
        places = [(0, 0, 0), (0.3, 0, 0), (0.1, 0.3, 0), (0.2, 0.4, 0)]
        ids = [body(tuple(turn * Vector3(place)), mass=0.1, blocked="XYZ") for place in places]
        links = [link_of(ids[0], ids[2]), link_of(ids[1], ids[3])]
        spring = sj.TorsionSpring(
            link1=links[0], link2=links[1], stiffness=2.0, freeAngle=0.1, axis=turn * Vector3(0, 0, 1)
        )
        O.engines = [ForceResetter(), sj.TorsionSprings(springs=[spring]), NewtonIntegrator(damping=0)]
        O.dt = 1e-9
        O.step()
        back = turn.conjugate()
        rows.append({"angle": spring.angle, "moment": spring.moment,
                     "forces": [list(back * O.forces.f(i, True)) for i in ids]})
    return rows


def wrong():
    reset()
    one = body((0, 0, 0), mass=1.0, blocked="XYZ")
    engine = [
        ("count", lambda: sj.GuidePlanes(ids=[one], normals=[])),
        ("body", lambda: sj.GuidePlanes(ids=[7], normals=[Vector3(0, 0, 1)])),
    ]

    def run(make):
        O.engines = [ForceResetter(), make(), NewtonIntegrator(damping=0)]
        O.dt = 1e-6
        O.step()

    return {
        "length": fault_of(lambda: sj.GuidePlanes(ids=[one], normals=[Vector3(0, 0, 2)])),
        "axis": fault_of(lambda: sj.TorsionSpring(axis=Vector3(0, 0, 0.5))),
        **{name: fault_of(lambda: run(make)) for name, make in engine},
    }


finish({"guide": guide(), "spring": turned_spring(), "wrong": wrong()})
