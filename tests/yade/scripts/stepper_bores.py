# SPDX-License-Identifier: GPL-3.0-or-later
"""Bores of triangles with and without the JointStepper. Usage: `stepper_bores.py PART`, with the parts listed at the
end."""
import sys
import tempfile
from math import cos, pi, sin
from pathlib import Path

import statejump_yade as sj
from yade.minieigenHP import Quaternion

from both import *  # noqa: F403

MAIN = __import__("__main__")
Law = sj.Law2_BoreGeom_BorePhys_JointLaw
THREE_LOBES = [(3, 40e-6, 0.2)]


def hot(**keywords):
    return sj.ThermalProgram(**{"shape": "sine", "temperatureChangeMax": 60, "period": 1e-3, "cycles": 3, **keywords})


def lobed(law=None, angle=2e-4, energy=True, load=(3.0, -60.0, 0), around=60, lobes=THREE_LOBES, heat=60, damping=0.05):
    """A journal that rattles in a warm lobed bore, across the edges of its facets, under a cyclic temperature."""
    reset()
    O.trackEnergy = energy
    pin = body(
        (0.4e-4, 0.1e-4, 0), sj.Journal(radius=R1), material(expansion=23e-6), mass=0.02, inertia=3e-7, blocked=PLANAR,
        velocity=(0.2, -0.1, 0), spin=(0, 0, 40),
    )
    body((0, 0, 0), tube(around, 6, lobes=lobes), material(expansion=10e-6), orientation=Quaternion((0, 0, 1), 0.3))
    bore_engines(hot(temperatureChangeMax=heat), damping=damping, law=law, angle=angle)
    O.dt = 2.5e-7
    O.forces.setPermF(pin, load)
    O.forces.setPermT(pin, (0, 0, 1e-4))


def wedged():
    """A journal pressed into a lobe and in contact on both sides, with a friction law that has a load history."""
    lobed(Law(frictionLaw="mindlin_deresiewicz"), load=(50, 3, 0), damping=0.3, heat=10)
    O.bodies[1].state.ori = Quaternion((0, 0, 1), 0)
    O.bodies[1].shape = tube(120, 6, lobes=[(3, 40e-6, 0)])
    O.bodies[0].state.pos, O.bodies[0].state.vel, O.bodies[0].state.angVel = (1.0e-4, 1e-7, 0), (0, 0, 0), (0, 0, 0)


def sliding():
    """A journal that slides along its bore, over edges of facets."""
    lobed(Law(frictionLaw="mindlin"), load=(100, 0, 0), lobes=[(2, 5e-6, 0)], heat=10, damping=0.2)
    O.bodies[0].state.pos, O.bodies[0].state.vel = (1.02e-4, 0, 0), (0, 0.15, 0)


def free_bore():
    """A bore and its journal, both moving and rotating freely on a hot link, beside a bearing with the other law."""
    reset()
    metal = material(expansion=2e-5)
    pin = body((0.9e-4, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, inertia=3e-7, blocked=PLANAR, velocity=(0.1, 0, 0),
               spin=(0, 0, -100))
    hole = body((0, 0, 0), tube(60, 6, lobes=[(2, 30e-6, 0)]), material(expansion=1e-5), mass=0.05, inertia=2e-6,
                blocked=PLANAR, velocity=(0, 0.05, 0), spin=(0, 0, 30))
    root = body((-0.05, 0.01, 0))
    place = Vector3(0.05, 0, 0)
    body(place + Vector3(0.9e-4, 0, 0), sj.Journal(radius=R1), metal, mass=0.01, blocked="zXYZ", velocity=(0.05, 0.1, 0))
    body(place, sj.Bearing(radius=R2), metal)
    bore_engines(hot(), damping=0.05, law=Law(dissipationLaw="flores", restitution=0.8))
    link = sj.ThermalLink(id1=root, id2=hole, youngModulus=70e9, crossSectionArea=1e-7, stressFreeLength=0.051,
                          thermalExpansion=2.3e-5, dampingRatio=0.03, program=hot())
    O.engines = [*O.engines[:4], sj.ThermalLinks(links=[link]), O.engines[-1]]
    O.dt = 2.5e-7
    O.forces.setPermF(pin, (4, 6, 0))


def leaving():
    """The journal leaves its bore along the axis; then nothing holds it."""
    sliding()
    O.bodies[0].state.blockedDOFs, O.bodies[0].state.vel = "XY", (0, 0.15, 10)


def ball(outer=None):
    """A ball that rolls in a cup of triangles and rotates freely about all axes."""
    reset()
    metal = material(expansion=2e-5)
    free = body(
        (0.3e-4, 0.2e-4, -0.8e-4), sj.Ball(radius=R1), metal, mass=0.02, inertia=3e-7, blocked="",
        velocity=(0.1, 0.05, -0.2), spin=(10, 20, -30),
    )
    body((0, 0, 0), outer or sj.MeshBore(**sj.socket_triangles(R2, 2.2, 40, 20)), metal)
    bore_engines(hot(shape="triangle", temperatureChangeMax=40), damping=0.05)
    O.dt = 2e-7
    O.forces.setPermF(free, (5.0, 0, -30.0))


def bumps():
    """A small journal that hits the convex bumps of a lobed wall."""
    reset()
    metal = material(expansion=2e-5)
    out = Vector3(0.5, 0.75**0.5, 0)
    pin = body(out * 2.55e-3, sj.Journal(radius=1e-3), metal, mass=0.01, inertia=1e-8, blocked=PLANAR, velocity=0.5 * out)
    body((0, 0, 0), tube(300, 10, lobes=[(3, 1.5e-3, 0)]), metal)
    bore_engines(hot(), damping=0.05)
    O.dt = 2e-7
    O.forces.setPermF(pin, 30 * out)


def crowd(energy=True, count=40):
    """Journals in one shared wall mesh, with different loads, more than one block of the JointStepper holds. Every
    fourth journal has no contact yet."""
    reset()
    O.trackEnergy = energy
    metal = material(expansion=1e-5)
    wall = tube(60, 6, lobes=[(3, 40e-6, 0.2), (2, 10e-6, 1)])
    for i in range(count):
        origin, a = Vector3(0.02 * (i % 8), 0.02 * (i // 8), 0), 2 * pi * i / count
        body(origin, wall, metal)
        pin = body(
            origin + Vector3(cos(a), sin(a), 0) * (1e-5 if i % 4 == 0 else 9e-5), sj.Journal(radius=R1), metal, mass=0.02,
            inertia=3e-7, blocked=PLANAR, velocity=(0.1 * cos(3 * a), 0.1 * sin(a), 0), spin=(0, 0, 20),
        )
        O.forces.setPermF(pin, (20 * cos(a), 20 * sin(a), 0))
    bore_engines(hot(period=2e-3), damping=0.05)
    O.dt = 2.5e-7


def over_edges(steps):
    """Looks at the facet of the contact on the way."""
    MAIN.facets = set()
    while O.iter < steps:
        O.run(min(250, steps - O.iter), True)
        known = O.interactions[0, 1].geom.known
        MAIN.facets |= {known[23]} if len(known) > 9 else set()


def saved_in_contact(steps):
    """Saved and loaded while it touches; YADE saves no permanent forces."""
    O.run(steps // 2, True)
    while not any(i.isReal and isinstance(i.geom, sj.BoreGeom) for i in O.interactions):
        O.run(40, True)
    force = O.forces.permF(0)
    with tempfile.TemporaryDirectory() as folder:
        name = str(Path(folder) / "scene.xml.bz2")
        O.save(name, quiet=True)
        O.load(name, quiet=True)
    O.forces.setPermF(0, force)
    O.run(steps - O.iter, True)


def pushed_on(steps):
    """Run a scene in pieces of irregular length and change the load between them."""
    for piece in (1, 2, 30, 101, 7, 400):
        O.run(piece, True)
        O.forces.setPermF(0, (5.0 - O.iter % 11, 10.0 - O.iter % 19, 0))
    O.run(steps - O.iter, True)


def scenes():
    cases = {
        "lobed": (lobed, 8000, 500),
        "lobed_without_energy": (lambda: lobed(energy=False), 4000, 1000),
        "lobed_round": (lambda: lobed(around=200, lobes=[]), 4000, 300),
        "lobed_searching": (lambda: lobed(angle=0.0), 1500, 300),
        "lobed_in_pieces": (lobed, 3000, 130, pushed_on),
        "lobed_every_step": (lobed, 600, 1),
        "lobed_saved": (lobed, 4000, 130, saved_in_contact),
        "sliding": (sliding, 8000, 1000, over_edges),
        "leaving": (leaving, 3000, 300),
        "wedged": (wedged, 8000, 250),
        "wedged_saved": (wedged, 5000, 250, saved_in_contact),
        "free_bore": (free_bore, 10000, 300),
        "free_bore_saved": (free_bore, 5000, 300, saved_in_contact),
        "ball_in_cup": (ball, 10000, 300),
        "ball_in_cup_saved": (ball, 5000, 300, saved_in_contact),
        "ball_in_bore": (lambda: ball(tube(60, 6)), 3000, 300),
        "bumps": (bumps, 10000, 300),
        "crowd": (crowd, 3000, 250),
        "crowd_in_parts": (lambda: crowd(False), 3000, 500),
        "crowd_erased": (crowd, 1200, 200, erased(3)),
    }
    found = {name: run_both(*case) for name, case in cases.items()}
    found["sliding"]["facets"] = len(MAIN.facets)
    found["free_bore_recorded"] = run_both(free_bore, 3000, 300, record=[3, 4])
    return found


def laws():
    """Every law of the catalogue, each with default laws for the other roles; a bore supports only one tangential
    velocity."""
    found = {}
    for attribute, names in sj.law_names().items():
        for name in names if attribute != "tangentialVelocity" else ():
            law = {attribute: name, "restitution": 0.7}
            found[f"{attribute} {name}"] = run_both(lambda law=law: lobed(Law(**law), heat=20), 2500, 250)
    return found


def parts():
    """Return the result of a scene whose blocks of joints two threads process."""
    crowd(False)
    with_stepper(1000)
    O.run(3000, True)
    return {"digest": digest(mixed.state()), "touching": O.interactions.countReal()}


def closing():
    """The journal becomes too large for the curvature of the wall."""
    lobed(heat=4000, lobes=[])


def too_deep():
    """An impact so hard that the contact makes the time step unstable."""
    lobed(energy=False, damping=0.0)
    O.dt = 3e-5


def parting():
    lobed(Law(normalLaw="johnson", restitution=0.7), load=(3e4, 0, 0), lobes=[])


def bulging():
    """A journal reaches a convex part of the wall, for which its law is not defined."""
    bumps()
    bore_engines(hot(), law=Law(normalLaw="johnson"))


def tilting():
    """The journal falls over."""
    lobed()
    O.bodies[0].state.blockedDOFs, O.bodies[0].state.angVel = "zY", (60, 0, 0)


def failures():
    return {each.__name__: error_of(each) for each in (closing, too_deep, parting, bulging, tilting)}


finish({each.__name__: each for each in (scenes, laws, parts, failures)}[sys.argv[1]]())
