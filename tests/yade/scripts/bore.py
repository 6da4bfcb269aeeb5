# SPDX-License-Identifier: GPL-3.0-or-later
"""Journals and balls in bores of triangles. Usage: `bore.py checks`, `bore.py save FOLDER` or `bore.py many`."""
import inspect
import sys
import tempfile
from math import cos, pi, sin
from pathlib import Path

import statejump_yade as sj
from yade.minieigenHP import Quaternion, Vector3

from parts import *  # noqa: F403

Law = sj.Law2_BoreGeom_BorePhys_JointLaw


def cup():
    return sj.MeshBore(**sj.socket_triangles(R2, 2.2, 120, 60))


def curve(kind, change):
    """Force over depth, for the analytic part and its mesh, at some angles between the vertices."""
    rows = []
    inner, plain, mesh = {
        "journal": (sj.Journal, sj.Bearing, tube), "ball": (sj.Ball, sj.Socket, cup)
    }[kind]
    for outer in (plain(radius=R2), mesh()):
        reset()
        turned = Quaternion((0.36, 0.48, 0.8), 0.7) if kind == "ball" else Quaternion((0, 0, 1), 0.3)
        pin = body(shape=inner(radius=R1), made_of=material(expansion=23.4e-6))
        hole = body(shape=outer, made_of=material(expansion=12e-6), orientation=turned)
        bore_engines(constant(change))
        O.dt = 1e-9
        O.step()
        c = R2 * (1 + 12e-6 * change) - R1 * (1 + 23.4e-6 * change)
        found_rows = []
        for depth in (3e-7, 1e-6, 5e-6):
            for a in (0.1, 2.234, 4.9):
                out = Vector3(cos(a), sin(a), 0) if kind == "journal" else turned * Vector3(
                    0.5 * cos(a), 0.5 * sin(a), -0.75**0.5)
                O.bodies[pin].state.pos = out * (c + depth)
                O.step()
                found = contact(pin, hole)
                found_rows.append([*O.forces.f(pin), *O.forces.t(hole), found.phys.kn, found.phys.ks])
        O.bodies[pin].state.pos = (0, 0, 0)
        O.step()
        rows.append({"rows": found_rows, "gone": contact(pin, hole) is None})
    return rows


def swing(outer, angle=2e-4):
    """A journal that slides, sticks and heats in its bore, under a constant external force."""
    reset()
    program = sj.ThermalProgram(shape="sine", temperatureChangeMax=60, period=2e-3)
    pin = body(
        (1.0e-4, 0.1e-4, 0), sj.Journal(radius=R1), material(expansion=23e-6), mass=0.02,
        inertia=3e-7, blocked=PLANAR, spin=(0, 0, 40),
    )
    body((0, 0, 0), outer, material(expansion=10e-6))
    bore_engines(program, damping=0.1, angle=angle)
    O.dt = 2.5e-7
    O.forces.setPermF(pin, (60.0, 20.0, 0))
    rows = []
    for _ in range(20):
        O.run(100, True)
        state = O.bodies[pin].state
        rows.append({"pos": list(state.pos), "vel": list(state.vel), "spin": state.angVel[2], "energies": energies()})
    return rows


def two_points():
    """A bore with three lobes so deep that a journal pushed into one touches it on both sides."""
    reset()
    metal = material()
    pin = body((1.0e-4, 1e-7, 0), sj.Journal(radius=R1), metal, mass=0.02, inertia=3e-7, blocked="zXYZ")
    hole = body((0, 0, 0), tube(lobes=[(3, 40e-6, 0)]), metal)
    law = Law()
    bore_engines(damping=0.3, law=law)
    O.dt = 2.5e-7
    O.forces.setPermF(pin, (50, 3, 0))
    firsts = []
    for _ in range(200):
        O.run(100, True)
        found = contact(pin, hole)
        if found and len(found.geom.contacts) == 2:
            firsts.append(found.geom.contacts[0].normal[1] > 0)
    found = contact(pin, hole)
    geom, phys = found.geom, found.phys
    before = [[*g.normal, p.shearForce.norm(), p.ks] for g, p in zip(geom.contacts, phys.contacts)]
    at_rest = {
        "number": geom.numberOfContacts, "depths": list(geom.penetrationDepths),
        "points": [list(p) for p in geom.contactPoints], "forces": [list(f) for f in phys.normalForces],
        "sum": list(phys.normalForce + phys.shearForce), "on_bore": list(O.forces.f(hole)),
        "speed": O.bodies[pin].state.vel.norm(), "contacts": law.contacts, "stable": sj.stable_time_step(),
        "kn": [p.kn for p in phys.contacts], "keys": sorted(set(geom.dict()) | set(phys.dict())),
        "moment": (O.forces.t(pin) + O.forces.t(hole) - O.bodies[pin].state.pos.cross(O.forces.f(hole))).norm(),
        "shears": [p.shearForce.norm() for p in phys.contacts],
    }
    # Push to the other side until the deeper contact is the other one; the histories stay theirs.
    # The order is that of the last search: from here on search in every step.
    rows = []
    for functor in O.engines[3].geomDispatcher.functors:
        if hasattr(functor, "patchAngle"):
            functor.patchAngle = 0
    O.forces.setPermF(pin, (50, -12, 0))
    for _ in range(300):
        O.run(20, True)
        if not found.isReal or len(found.geom.contacts) != 2:
            break
        rows.append([
            [g.normal[1], *p.shearForce, p.impactSpeed] for g, p in zip(found.geom.contacts, found.phys.contacts)
        ])
    return {"rest": at_rest, "before": before, "rows": rows, "firsts": firsts}


def too_close():
    reset()
    metal = material()
    # Radius of curvature 5.1 mm - 63 * 1.6667 um = 4.995 mm where eight waves are outermost; the
    # journal, 10 um deep, is still nearest to the wall there.
    body((1.0e-4 + 1.6667e-6 + 1e-5, 0, 0), sj.Journal(radius=R1), metal, mass=0.1)
    body((0, 0, 0), tube(lobes=[(8, 1.6667e-6, 0)]), metal)
    bore_engines()
    O.dt = 1e-9
    return fault_of(lambda: [O.step() for _ in range(3)])


def bulge():
    """A small journal on the bump between lobes, and the errors of laws that do not support this geometry."""
    def pressed(law):
        reset()
        metal = material()
        # The bump at 60 degrees, 3.6 mm from the axis, bulges with a radius of 1.3091 mm.
        out = Vector3(0.5, 0.75**0.5, 0)
        pin = body(out * (3.6e-3 - 1e-3 + 1e-6), sj.Journal(radius=1e-3), metal, mass=0.1)
        hole = body((0, 0, 0), tube(300, 10, lobes=[(3, 1.5e-3, 0)]), metal)
        bore_engines(law=law)
        O.dt = 1e-9
        O.step()
        return contact(pin, hole)

    found = pressed(Law())
    return {
        "force": found.phys.normalForce.norm(), "modulus": found.phys.effectiveYoungModulus,
        "radius": found.geom.contacts[0].bearingRadius, "number": found.geom.numberOfContacts,
        "johnson": fault_of(lambda: (pressed(Law(normalLaw="johnson")), O.step())),
    }


def recorded():
    """The ParaView recorder's output for a journal and a warm bore beside it."""
    sys.path.insert(0, str(Path(inspect.getfile(body)).resolve().parents[3] / "yade_scripts" / "examples"))
    from paraview import ParaViewRecorder
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reset()
    metal = material(expansion=1e-4)
    body((0, 0, 0), sj.Journal(radius=R1), metal)
    wall = tube(60, 6, lobes=[(2, 1e-3, 0)])
    body((0.02, 0, 0), wall, metal, orientation=Quaternion((0, 1, 0), pi / 2))
    bore_engines(constant(100))
    O.dt = 1e-9
    O.run(2, True)  # the program begins at 0
    with tempfile.TemporaryDirectory() as folder:
        ParaViewRecorder(folder + "/a-").write()
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(f"{folder}/a-joints.{O.iter}.vtp")
        reader.Update()
    found = reader.GetOutput()
    kinds = found.GetCellData().GetArray("kind")
    return {
        "cells": [found.GetNumberOfLines(), found.GetNumberOfPolys(), len(wall.triangles)],
        "kinds": [kinds.GetValue(0), kinds.GetValue(1), kinds.GetNumberOfTuples()],
        "bounds": found.GetBounds(),
    }


def refused():
    triangles = sj.bore_triangles(R2, LENGTH, 40, 4)
    broken = {**triangles, "triangles": [t for i, t in enumerate(triangles["triangles"]) if i != 100]}
    return {
        "file": fault_of(lambda: sj.MeshBore(file="/nowhere/bore.stl")),
        "hole": fault_of(lambda: sj.MeshBore(**broken)),
        "unit": fault_of(lambda: sj.MeshBore(**triangles, scale=1e3)),
        "flip": fault_of(lambda: sj.MeshBore(**triangles, flip=True)),
        "scale": fault_of(lambda: sj.MeshBore(scale=0)),
        "paper": fault_of(lambda: Law(tangentialVelocity="paper")),
        "angle": fault_of(lambda: sj.Ig2_Journal_MeshBore_BoreGeom(patchAngle=-1)),
        "set": fault_of(lambda: setattr(tube(40, 4), "scale", 2.0)),
    }


def many(count=40):
    """Free and pressed journals in a shared lobed bore: final states."""
    reset()
    metal = material(expansion=1e-5)
    wall = tube(lobes=[(3, 40e-6, 0.2), (2, 10e-6, 1)])
    ids = []
    for i in range(count):
        origin = Vector3(0.02 * (i % 8), 0.02 * (i // 8), 0)
        a = 2 * pi * i / count
        body(origin, wall, metal)
        ids.append(body(
            origin + Vector3(cos(a), sin(a), 0) * 2e-5, sj.Journal(radius=R1), metal, mass=0.02,
            inertia=3e-7, blocked=PLANAR, velocity=(0.1 * cos(3 * a), 0.1 * sin(a), 0), spin=(0, 0, 20),
        ))
    bore_engines(sj.ThermalProgram(shape="sine", temperatureChangeMax=60, period=2e-3), 0.05)
    O.dt = 2.5e-7
    return pushed(ids)


def pushed(ids):
    """Permanent forces, which YADE does not save."""
    for i, number in enumerate(ids):
        a = 2 * pi * i / len(ids)
        O.forces.setPermF(number, (20 * cos(a), 20 * sin(a), 0))
    return ids


def state_of(ids):
    return {
        "bodies": [[*O.bodies[i].state.pos, *O.bodies[i].state.vel, *O.bodies[i].state.angVel] for i in ids],
        "contacts": sorted(
            [c.id1, c.id2, *map(list, c.phys.normalForces), *(list(p.shearForce) for p in c.phys.contacts)]
            for c in O.interactions if c.isReal
        ),
        "energies": energies(),
    }


mode = sys.argv[1]
if mode == "checks":
    finish({
        "curves": {f"{kind} {change}": curve(kind, change) for kind in ("journal", "ball") for change in (0, 80)},
        "swing": {
            "bearing": swing(sj.Bearing(radius=R2)), "mesh": swing(tube()), "searching": swing(tube(), 0.0),
        },
        "two": two_points(), "too_close": too_close(), "refused": refused(), "bulge": bulge(), "recorded": recorded(),
        "radii": [tube().meanRadius(), *tube().sectionRadii(0.0, 7)],
    })
elif mode == "many":
    ids = many()
    O.run(3000, True)
    finish({"state": state_of(ids), "two": sum(len(c.geom.contacts) == 2 for c in O.interactions if c.isReal),
            "real": O.interactions.countReal()})
else:
    ids = many(12)
    O.run(1500, True)
    names = [sys.argv[2] + "/bore.yade.gz", sys.argv[2] + "/bore.xml"]
    for name in names:
        O.save(name)
    saved = state_of(ids)
    O.run(1500, True)
    straight = state_of(ids)
    resumed = []
    for name in names:
        O.load(name)
        pushed(ids)
        O.run(1500, True)
        resumed.append(state_of(ids))
    finish({"saved": saved, "straight": straight, "resumed": resumed})
