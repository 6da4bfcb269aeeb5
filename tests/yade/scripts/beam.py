# SPDX-License-Identifier: GPL-3.0-or-later
"""Beams between bodies: true frequency against the stable step, momentum and energy of a free swing, saving in mid run,
messages."""
import sys
from pathlib import Path

import numpy as np
import statejump_yade as sj
from parts import O, body, finish, reset
from yade import wrapper
from yade.minieigenHP import Quaternion, Vector3

LENGTH, MASS = 0.7, 0.4
SECTION = {"axialStiffness": 3e6, "torsionalStiffness": 900.0, "bendingStiffnessY": 1500.0, "bendingStiffnessZ": 2500.0,
           "shearStiffnessY": 8e5, "shearStiffnessZ": 9e5}


def chain(count, clamped=True, program=None, **keywords):
    """Append a straight chain of beams along an oblique direction; return its bodies, and set the engines."""
    reset()
    along = Vector3(2, -1, 2) / 3
    across = Vector3(1, 2, 0) / 5**0.5
    shares = [0.5] + [1.0] * (count - 1) + [0.5]
    ids = [
        body(position=tuple(place * LENGTH * along), mass=share * MASS, inertia=share * MASS * LENGTH**2 / 12,
             blocked="xyzXYZ" if clamped and place == 0 else "")
        for place, share in enumerate(shares)
    ]
    program = program or sj.ThermalProgram(temperatureChangeMax=0.0)
    bonds = [
        sj.BeamBond(id1=one, id2=two, stressFreeLength=LENGTH, axisY=across, program=program, **SECTION, **keywords)
        for one, two in zip(ids, ids[1:])
    ]
    O.engines = [wrapper.ForceResetter(), sj.BeamBonds(bonds=bonds), wrapper.NewtonIntegrator(damping=0)]
    return ids, bonds


def forces(ids):
    """Evaluate the bonds; return forces and torques as one array."""
    O.forces.reset()
    O.engines[1]()
    return np.array([[*O.forces.f(one, True), *O.forces.t(one, True)] for one in ids]).ravel()


def frequency(count, **keywords):
    """Return the true highest frequency over that of the stable step."""
    ids, _ = chain(count, **keywords)
    O.dt = 1e-9
    forces(ids)
    free = [body for body in ids if O.bodies[body].state.blockedDOFs != "xyzXYZ"]
    columns, scales, rows = [], [], []
    for place, one in enumerate(ids):
        if one not in free:
            continue
        rows += range(6 * place, 6 * place + 6)
        state = O.bodies[one].state
        for dof in range(6):
            way = 1e-6
            sides = []
            for sign in (1, -1):
                kept = state.pos, state.ori
                step = Vector3(*(sign * way * (k == dof % 3) for k in range(3)))
                if dof < 3:
                    state.pos = state.pos + step
                else:
                    state.ori = Quaternion(step.normalized(), way) * state.ori
                sides.append(forces(ids))
                state.pos, state.ori = kept
            columns.append((sides[1] - sides[0]) / (2 * way))
            scales.append(state.mass if dof < 3 else state.inertia[0])
    stiffness = np.array(columns).T[rows]
    scale = np.sqrt(scales)
    values = np.linalg.eigvalsh(0.5 * (stiffness + stiffness.T) / np.outer(scale, scale))
    return {"ratio": float(np.sqrt(values[-1]) * sj.stable_time_step() / 2), "omega": float(np.sqrt(values[-1]))}


def swing(steps, fraction):
    """Return the drift of energy, momentum and moment of momentum of a free chain that bends, twists and turns."""
    ids, bonds = chain(3, clamped=False)
    O.dt = 1e-9
    O.step()  # sets the axes of the beams
    O.dt = fraction * sj.stable_time_step()
    spins = [(3, -2, 1), (-1, 4, 2), (2, 2, -3), (0, -1, 5)]
    for one, spin, speed in zip(ids, spins, ((0, 2, 0), (1, 0, -1), (0, 1, 2), (-1, 0, 3))):
        O.bodies[one].state.angVel, O.bodies[one].state.vel = spin, speed

    def totals():
        states = [O.bodies[one].state for one in ids]
        momentum = sum((state.mass * state.vel for state in states), Vector3.Zero)
        # The velocity is half a step old.
        about = sum((state.mass * (state.pos - 0.5 * O.dt * state.vel).cross(state.vel)
                     + state.inertia[0] * state.angVel for state in states), Vector3.Zero)
        return np.array([*momentum, *about])

    def energy(before):
        """Kinetic energy with the mean of the squares of both half steps, and elastic energy at the time between."""
        after = [(O.bodies[one].state.vel, O.bodies[one].state.angVel) for one in ids]
        kinetic = sum(
            0.25 * O.bodies[one].state.mass * (vel.dot(vel) + v.dot(v))
            + 0.25 * O.bodies[one].state.inertia[0] * (spin.dot(spin) + w.dot(w))
            for one, (vel, spin), (v, w) in zip(ids, before, after))
        return kinetic + dict(O.energy.items())["beamElastic"]

    first, found, moments = totals(), [], []
    for _ in range(steps):
        # Copies: YADE returns references.
        before = [(Vector3(O.bodies[one].state.vel), Vector3(O.bodies[one].state.angVel)) for one in ids]
        O.step()
        found.append(energy(before))
        moments.append(totals())
    return {"energy": float(np.ptp(found) / np.mean(found)),
            "momentum": float(np.abs(np.array(moments) - first)[:, :3].max()),
            "moment": float(np.abs(np.array(moments) - first)[:, 3:].max()),
            "elastic": float(dict(O.energy.items())["beamElastic"] / np.mean(found))}


def heated():
    """Set up a damped clamped chain that is heated, with a gradient, an offset and a release."""
    program = sj.ThermalProgram(temperatureChangeMax=60, period=2e-2)
    ids, bonds = chain(2, program=program, thermalExpansion=1.2e-5, gradientProgram=program, gradientY=4.0,
                       dampingRatio=0.3)
    for one in bonds:
        one.axisX = Vector3(2, -1, 2) / 3
    bonds[1].offset2, bonds[0].released2 = (0.0, 0.05, 0.01), "Z"
    O.dt = 1e-5
    return ids


def state():
    """Return positions, orientations, velocities and energies."""
    found = [[*b.state.pos, *b.state.ori, *b.state.vel, *b.state.angVel] for b in O.bodies]
    bonds = [[*b.force1, *b.moment1, *b.force2, *b.moment2] for b in O.engines[1].bonds]
    return {"bodies": found, "bonds": bonds, "energy": dict(O.energy.items())}


def saved(folder):
    """Return states of a run, and of the same run saved and loaded in between."""
    heated()
    O.run(400, True)
    for name in ("beam.yade", "beam.xml"):
        O.save(str(Path(folder) / name))
    O.run(600, True)
    found = {"straight": state()}
    for name in ("beam.yade", "beam.xml"):
        O.load(str(Path(folder) / name))
        O.run(600, True)
        found[name] = state()
    return found


def message(change):
    """Return the sentence and the code of the failure of a run after a change of the scene."""
    ids, bonds = chain(1)
    O.dt = 1e-6
    try:
        change(ids, bonds)
        O.run(3, True)
    except Exception as error:
        taken, refused = sj.take_failure(), sj.take_refusal()
        return {"said": str(error), "code": (taken or refused or {}).get("code")}
    return {"said": "", "code": None}


def far(ids, bonds):
    O.bodies[ids[1]].state.ori = Quaternion((0, 0, 1), 1.6)


def messages():
    """Return the messages of invalid scenes."""
    changes = {
        "step": lambda ids, bonds: setattr(O, "dt", 0.02),
        "program": lambda ids, bonds: setattr(bonds[0], "program", None),
        "axis": lambda ids, bonds: setattr(bonds[0], "axisY", (1, 0, 0)),
        "release": lambda ids, bonds: setattr(bonds[0], "released1", "yZ"),
        "rotation": far,
        "mass": lambda ids, bonds: setattr(O.bodies[ids[1]].state, "mass", -1),
        "inertia": lambda ids, bonds: setattr(O.bodies[ids[1]].state, "inertia", (0, 1, 1)),
        "stepper": lambda ids, bonds: setattr(O, "engines", [O.engines[0], sj.JointStepper(), *O.engines[1:]]),
    }
    return {name: message(change) for name, change in changes.items()}


finish({
    "frequency": {"one": frequency(1), "four": frequency(4), "free": frequency(3, clamped=False)},
    "swing": [swing(400, 0.1), swing(800, 0.05)],
    "saved": saved(sys.argv[1]),
    "messages": messages(),
})
