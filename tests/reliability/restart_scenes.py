# SPDX-License-Identifier: GPL-3.0-or-later
"""Saves and continues scenes, or loads and continues them; restarts.py runs ``restart_scenes.py write|read PLAN`` in
YADE.

PLAN is a JSON file: ``steps`` to run after saving or loading, and ``saves``, each with case, law, ``first`` (steps
before saving) and file.
"""
import hashlib
import json
import sys
from pathlib import Path

import mixed
import statejump_yade as sj

from parts import PLANAR, R1, R2, O, body, bore_engines, engines, finish, material, reset, tube, with_stepper

TOUCHING_WITHIN = 3000  # steps


def rattling(law, stepper):
    """A journal that rattles in its bearing under a cyclic temperature."""
    reset()
    program = sj.ThermalProgram(shape="sine", temperatureChangeMax=60, period=1e-3, cycles=5)
    body(
        (0.4e-4, 0.1e-4, 0), sj.Journal(radius=R1), material(expansion=23e-6), mass=0.02, inertia=3e-7, blocked=PLANAR,
        velocity=(0.2, -0.1, 0), spin=(0, 0, 40),
    )
    body((0, 0, 0), sj.Bearing(radius=R2), material(expansion=10e-6))
    engines(program, law=law, normal_damping=0.02, tangential_damping=0.02)
    O.dt = 2.5e-7
    put(stepper)


def rolling(law, stepper):
    """A ball in its socket, free to turn about all axes."""
    reset()
    metal = material(expansion=2e-5)
    body(
        (0.3e-4, 0.9e-4, 0.1e-4), sj.Ball(radius=R1), metal, mass=0.02, inertia=3e-7, blocked="",
        velocity=(0.1, 0.05, -0.2), spin=(10, 20, -30),
    )
    body((0, 0, 0), sj.Socket(radius=R2), metal)
    engines(sj.ThermalProgram(shape="triangle", temperatureChangeMax=40, period=1e-3), law=law, normal_damping=0.05)
    O.dt = 2e-7
    put(stepper)


def bored(friction):
    """A journal that rattles in a lobed bore of triangles, with fixed laws."""
    def build(_law, stepper):
        reset()
        body(
            (0.4e-4, 0.1e-4, 0), sj.Journal(radius=R1), material(expansion=23e-6), mass=0.02, inertia=3e-7,
            blocked=PLANAR, velocity=(0.2, -0.1, 0), spin=(0, 0, 40),
        )
        body((0, 0, 0), tube(60, 6, lobes=[(3, 40e-6, 0.2)]), material(expansion=10e-6))
        program = sj.ThermalProgram(shape="sine", temperatureChangeMax=60, period=1e-3, cycles=5)
        bore_engines(program, damping=0.05, law=sj.Law2_BoreGeom_BorePhys_JointLaw(frictionLaw=friction))
        O.dt = 2.5e-7
        put(stepper)
    return build


def mixed_scene(*kind):
    """A scene of links, torsion springs, a journal, and a slider with two contacts, with fixed laws."""
    def build(_law, stepper):
        mixed.scene(*kind)
        put(stepper)
    return build


def put(stepper):
    if stepper:
        with_stepper(250)


SCENES = {
    "rattling": rattling, "rolling": rolling, "mixed": mixed_scene(False), "mixed_by_name": mixed_scene(True),
    "mixed_partial_slip": mixed_scene(False, True), "bored": bored("mindlin"),
    "bored_partial_slip": bored("mindlin_deresiewicz"),
}


# On the first body. YADE saves no permanent forces: a script sets them again after O.load.
LOADS = {"rattling": (3.0, -20.0, 0), "rolling": (0, -30.0, 5.0), "bored": (3.0, -60.0, 0),
         "bored_partial_slip": (3.0, -60.0, 0)}


def load(case):
    if case in LOADS:
        O.forces.setPermF(0, LOADS[case])


def touching():
    return any(i.isReal and i.phys.normalForce.norm() > 0 for i in O.interactions)


def digest():
    """Return the digest of all numbers of the scene. Energy sums are left out: they depend on the order of contacts,
    which loading may change."""
    found = mixed.state()
    del found["energy"]
    return hashlib.sha256(json.dumps(found, sort_keys=True, default=list).encode()).hexdigest()


plan = json.loads(Path(sys.argv[2]).read_text())
digests = []
for one in plan["saves"]:
    if sys.argv[1] == "write":
        law = sj.Law2_JointGeom_JointPhys_JointLaw(**one["law"]) if one["law"] else None
        SCENES[one["case"]](law, one["stepper"])
        load(one["case"])
        O.run(one["first"], True)
        while not touching():
            O.run(50, True)  # a run takes as long as it takes YADE to notice its end, whatever its length
            if O.iter > one["first"] + TOUCHING_WITHIN:
                raise SystemExit(f"{one} does not touch")
        O.save(one["file"], quiet=True)
    else:
        O.load(one["file"], quiet=True)
        load(one["case"])
    O.run(plan["steps"], True)
    digests.append([O.iter, digest()])
finish({"digests": digests})
