# SPDX-License-Identifier: GPL-3.0-or-later
"""Time steps: GlobalStiffnessTimeStepper, stable_time_step(), and wrong use."""
from math import inf, sqrt

import statejump_yade as sj
from yade.minieigenHP import Quaternion, Vector3

from parts import *  # noqa: F403


def run(steps):
    """Run step by step: O.run(steps, True) may miss an error of the first steps, because YADE only reports errors that
    occur after it has begun to wait."""
    for _ in range(steps):
        O.step()


def global_stepper():
    """One contact between two free bodies, with the time step of YADE's own stepper."""
    reset()
    metal = material()
    depth, masses = 3e-6, (0.02, 0.07)
    direction = Vector3(0.6, 0.8, 0)
    pin = body((CLEARANCE + depth) * direction, sj.Journal(radius=R1), metal, mass=masses[0],
               inertia=3e-5, blocked="")
    hole = body((0, 0, 0), sj.Bearing(radius=R2), metal, mass=masses[1], inertia=9e-5, blocked="")
    engines()
    O.engines = O.engines + [
        GlobalStiffnessTimeStepper(timestepSafetyCoefficient=0.8, timeStepUpdateInterval=1, defaultDt=1e-9, label="stepper")
    ]
    O.dt = 1e-12
    O.dynDt = True
    O.step()
    found = contact(pin, hole)
    return {"kn": found.phys.kn, "ks": found.phys.ks, "dt": O.dt, "masses": masses,
            "depth": found.geom.penetrationDepth}


def spring(factor, both_free):
    """An axial spring-mass system released off its rest length; dt is ``factor`` times the stability limit."""
    reset()
    mass, other = 0.01, 0.03
    root = body((0, 0, 0), mass=other, blocked="yzXYZ" if both_free else "xyzXYZ")
    tip = body((0.5 + 1e-6, 0, 0), mass=mass, blocked="yzXYZ")
    link = sj.ThermalLink(
        id1=root, id2=tip, youngModulus=70e9, crossSectionArea=9e-6, stressFreeLength=0.5,
        program=constant(),
    )
    engines(links=[link])
    reduced = mass * other / (mass + other) if both_free else mass
    limit = 2 * sqrt(reduced / (70e9 * 9e-6 / 0.5))
    O.dt = factor * limit
    stretches = [0.0]

    def run_all():
        for _ in range(400):
            O.step()
            stretches.append(abs(O.bodies[tip].state.pos[0] - O.bodies[root].state.pos[0] - 0.5))

    text = fault_of(run_all)
    return {"largest": max(stretches), "error": text, "limit": limit, "promised": sj.stable_time_step()}


def unguarded(factor):
    """Stability limit of two springs on one mass, neither of which is too stiff alone."""
    reset()
    mass = 0.01
    roots = [body((-0.5, 0, 0)), body((0.5, 0, 0))]
    tip = body((1e-6, 0, 0), mass=mass, blocked="yzXYZ")
    links = [
        sj.ThermalLink(id1=r, id2=tip, youngModulus=70e9, crossSectionArea=9e-6,
                       stressFreeLength=0.5, program=constant())
        for r in roots
    ]
    engines(links=links)
    limit = 2 * sqrt(mass / (2 * 70e9 * 9e-6 / 0.5))
    O.dt = factor * limit
    largest = 0.0
    for _ in range(400):
        O.step()
        largest = max(largest, abs(O.bodies[tip].state.pos[0]))
    return {"largest": largest, "limit": limit, "promised": sj.stable_time_step()}


def cold():
    """The stable step of a spring that cooling shortens to 0.7 of its length, and that of a warm one."""
    found = []
    for change in (-300.0, 0.0, 300.0):
        reset()
        root, tip = body((0, 0, 0)), body((0.5, 0, 0), mass=0.01, blocked="yzXYZ")
        engines(links=[sj.ThermalLink(id1=root, id2=tip, youngModulus=70e9, crossSectionArea=9e-6, stressFreeLength=0.5,
                                      thermalExpansion=1e-3, program=constant(change))])
        O.dt = 1e-9
        O.step()  # the temperature changes behind time 0
        found.append(sj.stable_time_step())
    return found


def damped(factor):
    """One spring and damper, dt = factor times stable_time_step()."""
    reset()
    root = body((0, 0, 0))
    tip = body((0.5 + 1e-6, 0, 0), mass=0.01, blocked="yzXYZ")
    link = sj.ThermalLink(id1=root, id2=tip, youngModulus=70e9, crossSectionArea=9e-6,
                          stressFreeLength=0.5, program=constant(), dampingRatio=0.4)
    engines(links=[link])
    O.dt = factor * sj.stable_time_step()
    for _ in range(400):
        O.step()
    return abs(O.bodies[tip].state.pos[0] - 0.5)


def joint(factor, inertia_factor):
    """A journal that may rotate, pressed into a fixed bearing; dt is ``factor`` times stable_time_step(). Inertia is
    small, so rotation against the tangential spring is the fastest vibration."""
    reset()
    metal = material(1.0)
    mass = 0.02
    depth = 3e-6
    pin = body((CLEARANCE + depth, 0, 0), sj.Journal(radius=R1), metal, mass=mass,
               inertia=inertia_factor * mass * R1**2, blocked=PLANAR, spin=(0, 0, 1e-3))
    body((0, 0, 0), sj.Bearing(radius=R2), metal)
    engines()
    O.dt = 1e-12
    O.step()
    # The load that holds this depth.
    O.forces.setPermF(pin, contact(pin, pin + 1).phys.normalForce)
    promised = sj.stable_time_step()
    O.dt = factor * promised
    spin = 0.0
    for _ in range(2000):
        O.step()
        spin = max(spin, abs(O.bodies[pin].state.angVel[2]))
    return {"spin": spin, "promised": promised}


def too_large_contact():
    reset()
    metal = material()
    body((CLEARANCE + 5e-6, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, blocked="zXYZ")
    body((0, 0, 0), sj.Bearing(radius=R2), metal)
    engines()
    O.dt = 1e-3
    found = fault_of(lambda: run(10))
    return [*found, O.iter]


def contact_without_our_engines():
    """The same in a scene that has neither ThermalExpansionEngine nor ThermalLinks."""
    reset()
    metal = material()
    body((CLEARANCE + 5e-6, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, blocked="zXYZ")
    body((0, 0, 0), sj.Bearing(radius=R2), metal)
    engines()
    O.engines = [e for e in O.engines if e.__class__.__name__ not in ("ThermalExpansionEngine", "ThermalLinks")]
    O.dt = 1e-3
    found = fault_of(lambda: O.run(10, True))
    return [*found, O.iter]


def wrong_scene(change):
    """Return the error of a run with one mistake in a joint on a link; YADE must not crash."""
    reset()
    metal = material(expansion=change.get("expansion", 2.3e-5), young=change.get("young", YOUNG), poisson=change.get("poisson", POISSON))
    if "friction_angle" in change:
        metal.frictionAngle = change["friction_angle"]
    program = constant(change.get("temperature", 10.0))
    root = body((-0.5, 0, 0))
    pin = body((CLEARANCE + 1e-6, 0, 0), sj.Journal(radius=change.get("R1", R1)), metal, mass=0.02,
               inertia=1e-6, blocked=change.get("blocked", "zXYZ"),
               orientation=Quaternion((1, 0, 0), change.get("tilt", 0.0)))
    fixed = material(expansion=0.0) if "expansion" in change else metal
    body((0, 0, 0), sj.Bearing(radius=R2), fixed)
    keywords = dict(id1=root, id2=pin, youngModulus=70e9, crossSectionArea=9e-6, stressFreeLength=0.5,
                    program=program)
    keywords.update(change.get("link", {}))
    link = sj.ThermalLink(**keywords)
    engines(program, links=[link], thermal=change.get("thermal"))
    O.dt = 1e-8
    found = fault_of(lambda: run(20))
    return [*found, O.iter]


def after_failure():
    """A failure of one scene is not reported in the next."""
    reset()
    metal = material()
    body((0, 0, 0), sj.Journal(radius=R2), metal)
    body((0, 0, 0), sj.Bearing(radius=R1), metal)
    engines()
    O.engines = [e for e in O.engines if e.__class__.__name__ != "ThermalLinks"]
    O.dt = 1e-7
    O.step()  # recorded here, to be raised in the next step
    reset()
    metal = material()
    body((CLEARANCE + 1e-6, 0, 0), sj.Journal(radius=R1), metal, mass=0.02)
    body((0, 0, 0), sj.Bearing(radius=R2), metal)
    engines()
    O.dt = 1e-7
    return [*fault_of(lambda: run(10)), O.iter]


def nothing_acts():
    reset()
    body((0, 0, 0), mass=1.0, blocked="")
    return sj.stable_time_step() == inf


wrong = {
    "missing_program_of_engine": dict(thermal=[sj.ThermalExpansionEngine()]),
    "missing_program_of_link": dict(link=dict(program=None)),
    "missing_id1": dict(link=dict(id1=-1)),
    "missing_id2": dict(link=dict(id2=99)),
    "missing_body_of_engine": dict(thermal=[sj.ThermalExpansionEngine(program=constant(), ids=[77])]),
    "body_without_thermal_shape": dict(thermal=[sj.ThermalExpansionEngine(program=constant(), ids=[0])]),
    "tilt": dict(tilt=2e-3),
    "closed_by_expansion": dict(expansion=2.3e-5, temperature=900.0),
    "closed_from_start": dict(R1=6e-3),
    "rotations_free": dict(blocked="z", link=dict(tipTurnsWithLink=True)),
    "no_length": dict(link=dict(stressFreeLength=0.0)),
    "same_body": dict(link=dict(id1=1)),
    "poisson": dict(poisson=0.7),
    "young": dict(young=-1.0),
    "friction_angle": dict(friction_angle=-0.1),
    "nothing_wrong": dict(),
    "tilt_within": dict(tilt=5e-4),
}
O.reset()
results = {}
for name, change in wrong.items():
    results[name] = wrong_scene(change)
finish(
    {
        "global": global_stepper(),
        "spring": {f"{f} {b}": spring(f, b) for f in (0.95, 1.05) for b in (False, True)},
        "unguarded": {str(f): unguarded(f) for f in (0.95, 1.05)},
        "cold": cold(),
        "damped": damped(0.95),
        "joint": {str(i): joint(0.95, i) for i in (0.5, 0.4, 0.02)},
        "too_large_contact": too_large_contact(),
        "without_our_engines": contact_without_our_engines(),
        "wrong": results,
        "after_failure": after_failure(),
        "nothing_acts": nothing_acts(),
    }
)
