# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature programs, expansion of bodies, thermal links."""
from math import cos, pi, sin, sqrt

import statejump_yade as sj
from yade.minieigenHP import Quaternion, Vector3

from parts import *  # noqa: F403

E, A, L0, ALPHA = 70e9, 9e-6, 0.5, 23.4e-6


def programs():
    times = [0.0, 0.1, 0.25, 0.3, 0.5, 0.6, 0.75, 0.9, 1.0, 1.5, 2.0, 2.3, 3.0]
    table = dict(tableTimes=[0, 0.2, 0.7, 1.0], tableTemperatureChanges=[0, 60, -30, 0])
    made = {
        "triangle": sj.ThermalProgram(shape="triangle", temperatureChangeMax=80, period=1, cycles=2),
        "half_sine": sj.ThermalProgram(shape="half_sine", temperatureChangeMax=80, period=1, cycles=2),
        "sine": sj.ThermalProgram(shape="sine", temperatureChangeMax=80, period=1, cycles=2),
        "table": sj.ThermalProgram(shape="table", period=1, cycles=2, **table),
    }
    return {
        "times": times,
        "values": {name: [p.temperatureChange(t) for t in times] for name, p in made.items()},
    }


def expansion():
    """Temperature changes of ±200 K in many steps and back, with different programs for the bodies."""
    reset()
    steel, brass, plain = material(expansion=2.3e-5), material(expansion=1.9e-5), FrictMat()
    O.materials.append(plain)
    bodies = [
        body((0, 0, 0), sj.Journal(radius=R1), steel),
        body((1, 0, 0), sj.Bearing(radius=R2), brass),
        body((2, 0, 0), sj.Slider(radius=R1), steel),
    ]
    other = body((5, 0, 0), Sphere(radius=0.1), plain)
    first = sj.ThermalProgram(shape="sine", temperatureChangeMax=200, period=1, cycles=3)
    second = sj.ThermalProgram(shape="triangle", temperatureChangeMax=-150, period=1.5, cycles=2)
    engines(
        thermal=[
            sj.ThermalExpansionEngine(program=first, ids=[bodies[0], bodies[1]], label="one"),
            sj.ThermalExpansionEngine(program=second, ids=[bodies[2]], label="two"),
        ]
    )
    O.dt = 1 / 1024  # a power of two: the time is exact
    rows = []
    for i in range(3 * 1024 + 1):
        now = O.time
        O.step()
        if i % 128 == 0 or i == 3 * 1024:
            rows.append([now, *(O.bodies[b].shape.thermalStrain for b in bodies)])
    return {
        "rows": rows,
        "max": [200, -150],
        "alpha": [2.3e-5, 1.9e-5, 2.3e-5],
        "temperature": [one.temperatureChange, two.temperatureChange],  # noqa: F405
        "radius": O.bodies[bodies[0]].shape.radius,
        "others_untouched": isinstance(O.bodies[other].shape, Sphere),
    }


def changes_after_start():
    """Other bodies, another shape, other ids after the first step."""
    reset()
    metal = material(expansion=2e-5)
    a = body((0, 0, 0), sj.Journal(radius=R1), metal)
    b = body((1, 0, 0), sj.Journal(radius=R1), metal)
    program = constant(50)
    heater = sj.ThermalExpansionEngine(program=program)
    engines(thermal=[heater])
    O.dt = 1e-3
    O.step()
    O.step()
    O.bodies[a].shape = sj.Journal(radius=R1)
    O.step()
    swapped = O.bodies[a].shape.thermalStrain
    O.bodies.erase(b)
    O.step()
    c = body((2, 0, 0), sj.Journal(radius=R1), metal)
    O.step()
    added = O.bodies[c].shape.thermalStrain
    d = body((3, 0, 0), sj.Journal(radius=R1), metal)
    heater.ids = [d]
    O.bodies[c].shape.thermalStrain = 0
    O.step()
    only = [O.bodies[c].shape.thermalStrain, O.bodies[d].shape.thermalStrain]
    metal.thermalExpansion = 3e-5
    O.step()
    return {
        "swapped": swapped,
        "added": added,
        "only": only,
        "other_alpha": O.bodies[d].shape.thermalStrain,
    }


def link_of(root, tip, **keywords):
    common = dict(
        id1=root, id2=tip, youngModulus=E, crossSectionArea=A, stressFreeLength=L0,
        thermalExpansion=ALPHA, program=constant(),
    )
    common.update(keywords)
    return sj.ThermalLink(**common)


def link_force(change):
    """Force of a stretched link, in any direction, both ends."""
    reset()
    direction = Vector3(2, -3, 6) / 7
    root, tip = body((0.1, 0.2, 0.3)), body((1, 1, 1))
    link = link_of(root, tip, program=constant(change))
    engines(links=[link])
    O.dt = 1e-9
    O.step()
    rows = []
    free = L0 * (1 + ALPHA * change)
    for stretch in (-1e-3, -1e-6, 0.0, 1e-6, 1e-3):
        O.bodies[tip].state.pos = Vector3(0.1, 0.2, 0.3) + (free + stretch) * direction
        O.step()
        rows.append(
            {
                "stretch": stretch,
                "axial": link.axialForce,
                "tip": list(O.forces.f(tip, True)),
                "root": list(O.forces.f(root, True)),
                "elastic": O.energy["linkElastic"],
            }
        )
    return {"rows": rows, "free": free, "direction": list(direction)}


def free_expansion():
    """A slowly heated link with a free tip elongates by alpha dT l0 without force."""
    reset()
    root, tip = body((0, 0, 0)), body((L0, 0, 0), mass=0.01, blocked="yzXYZ")
    program = sj.ThermalProgram(shape="half_sine", temperatureChangeMax=100, period=0.2)
    link = link_of(root, tip, program=program, dampingRatio=0.5)
    engines(links=[link], program=program)
    # Released with the velocity of the free expansion, so nothing rings.
    O.dt = 2e-6
    O.bodies[tip].state.vel = (L0 * ALPHA * 100 * pi / 0.2, 0, 0)
    O.run(50000, True)
    # The last forces belong to one step before the present positions.
    half = [link.axialForce, O.bodies[tip].state.pos[0] - L0, link.temperatureChange, O.time]
    O.run(50001, True)
    return {"half": half, "end": [link.axialForce, O.bodies[tip].state.pos[0] - L0], "k": E * A / L0,
            "m": 0.01, "expansion": L0 * ALPHA * 100, "omega": pi / 0.2}


def between_cables(time_step, damping=0.0, heat=0.0):
    """A body that moves back and forth between two cables; each is slack while the other is taut."""
    reset()
    ends, tip = [body((-1, 0, 0)), body((1, 0, 0))], body((1e-4, 0, 0), mass=0.01, blocked="yzXYZ", velocity=(-5, 0, 0))
    program = sj.ThermalProgram(shape="half_sine", temperatureChangeMax=heat, period=4e-3) if heat else constant()
    cables = [link_of(end, tip, stressFreeLength=1.002, tensionOnly=True, dampingRatio=damping, program=program)
              for end in ends]
    engines(links=cables, program=program, reader="read()")
    account, pulls = Balance([tip]), []

    def read():
        account.read()
        pulls.append([-cable.axialForce for cable in cables])

    __import__("__main__").read = read
    O.dt = time_step
    O.run(round(6e-3 / time_step), True)
    taut = [tuple(force > 0 for force in row) for row in pulls]
    return {
        "least": min(min(row) for row in pulls), "most": [max(row[i] for row in pulls) for i in (0, 1)],
        "both": any(all(row) for row in taut), "neither": sum(not any(row) for row in taut) / len(taut),
        "corners": sum(one != other for one, other in zip(taut, taut[1:])), "dt": time_step,
        "stiffness": E * A / 1.002, "worst": max(abs(v - account.values[0]) for v in account.values),
        "first": 0.5 * 0.01 * 25, "damped": O.energy["linkDamping"],
    }


def hanging():
    """A load on the tip, damped: static elongation."""
    reset()
    root, tip = body((0, 0, 0)), body((L0, 0, 0), mass=0.01, blocked="yzXYZ")
    link = link_of(root, tip, dampingRatio=0.3, program=constant(40))
    engines(links=[link])
    O.forces.setPermF(tip, (70.0, 0, 0))
    O.dt = 1e-5
    O.run(5000, True)
    return {"length": O.bodies[tip].state.pos[0], "free": L0 * (1 + ALPHA * 40), "axial": link.axialForce}


def oscillation(both_free):
    """Undamped axial oscillation: angular frequency from zero crossings."""
    reset()
    mass = 0.01
    root = body((0, 0, 0), mass=0.03, blocked="yzXYZ" if both_free else "xyzXYZ")
    tip = body((L0 * 1.0001, 0, 0), mass=mass, blocked="yzXYZ")
    link = link_of(root, tip)
    engines(links=[link], reader="read()")
    reduced = mass * 0.03 / (mass + 0.03) if both_free else mass
    omega = sqrt(E * A / L0 / reduced)
    O.dt = 0.2 / omega
    crossings, last = [], [None]

    def read():
        stretch = O.bodies[tip].state.pos[0] - O.bodies[root].state.pos[0] - L0
        if last[0] is not None and last[0] < 0 <= stretch:
            crossings.append(O.time - O.dt * stretch / (stretch - last[0]))
        last[0] = stretch

    __import__("__main__").read = read
    O.run(3300, True)
    periods = len(crossings) - 1
    return {
        "omega": 2 * pi * periods / (crossings[-1] - crossings[0]),
        "continuous": omega,
        "omega_dt": 0.2,
        "periods": periods,
    }


def couple():
    """A moment on the tip body acts as a couple of forces on both ends of the link."""
    reset()
    where = (Vector3(0.1, 0.2, 0.3), Vector3(0.1, 0.2, 0.3) + L0 * Vector3(2, -3, 6) / 7)
    root, tip = body(where[0]), body(where[1])
    link = link_of(root, tip, tipTurnsWithLink=True)
    engines(links=[link], reader="read()")
    moment = Vector3(0.5, -1.5, 2.0)
    O.forces.setPermT(tip, moment)
    out = {}

    def read():
        out["root"], out["tip"] = list(O.forces.f(root, True)), list(O.forces.f(tip, True))

    __import__("__main__").read = read
    O.dt = 1e-9
    O.step()
    direction = (where[1] - where[0]) / L0
    across = moment - moment.dot(direction) * direction
    carried = (L0 * direction).cross(Vector3(*out["tip"]))
    return {**out, "carried": list(carried), "across": list(across)}


def joint_on_link():
    """Moment about the root of a link, whose tip is a journal in frictional contact with a fixed bearing."""
    reset()
    metal = material()
    root = body((0, 0, 0))
    pin = body(
        (L0, 0, 0), sj.Journal(radius=R1), metal, mass=0.05, inertia=1e-6, blocked="zXYZ",
        velocity=(0, 0.2, 0),
    )
    hole = body((L0 - 0.9e-4, -0.5e-4, 0), sj.Bearing(radius=R2), metal)
    link = link_of(root, pin, tipTurnsWithLink=True)
    engines(links=[link], reader="read()")
    rows = []

    def read():
        found = contact(pin, hole)
        if not found:
            return
        moment, scale = Vector3.Zero, 0.0
        total = Vector3.Zero
        # The tip's own torque is not counted: it acts through the couple.
        for i in (root, pin, hole):
            f = O.forces.f(i, True)
            moment += O.bodies[i].state.pos.cross(f)
            total += f
            scale += O.bodies[i].state.pos.norm() * f.norm()
        moment += O.forces.t(hole, True)
        rows.append([total.norm(), moment.norm(), scale, O.forces.t(pin, True).norm()])

    __import__("__main__").read = read
    O.dt = 1e-6
    O.run(60, True)
    return rows


def pendulum(moment):
    """A link that swings in the plane about a fixed root, with or without a moment on its tip."""
    reset()
    mass = 0.02
    root = body((0, 0, 0))
    tip = body(
        (L0 * 0.6, L0 * 0.8, 0), mass=mass, blocked="zXYZ", velocity=(-0.8 * 3, 0.6 * 3, 0),
        orientation=Quaternion((0, 0, 1), 0.25), inertia=1e-6,
    )
    link = link_of(root, tip, tipTurnsWithLink=True)
    engines(links=[link])
    O.forces.setPermT(tip, (0, 0, moment))
    O.dt = 1e-5
    rows = []
    for _ in range(40):
        O.run(500, True)
        state = O.bodies[tip].state
        axis, angle = state.ori.toAxisAngle()
        rows.append(
            [
                O.iter,
                mass * state.pos.cross(state.vel)[2],
                state.pos[0] / state.pos.norm(),
                state.pos[1] / state.pos.norm(),
                cos(angle * axis[2]),
                sin(angle * axis[2]),
                state.angVel[2],
                state.pos.cross(state.vel)[2] / state.pos.norm() ** 2,
            ]
        )
    return {"rows": rows, "start": mass * 3 * L0, "moment": moment, "dt": O.dt, "turn": 0.25,
            "start_angle": [0.6, 0.8]}


finish(
    {
        "programs": programs(),
        "expansion": expansion(),
        "changes": changes_after_start(),
        "force": {str(c): link_force(c) for c in (0.0, 80.0, -80.0)},
        "free": free_expansion(),
        "hanging": hanging(),
        "cables": [between_cables(2e-6 / 2**k) for k in range(2)],
        "damped cables": [between_cables(2e-6 / 2**k, 0.1, 60.0) for k in range(2)],
        "oscillation": [oscillation(False), oscillation(True)],
        "couple": couple(),
        "joint_on_link": joint_on_link(),
        "pendulum": [pendulum(0.0), pendulum(2e-3)],
    }
)
