# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of a joint chosen by name."""
import statejump_yade as sj

from parts import *  # noqa: F403

Law = sj.Law2_JointGeom_JointPhys_JointLaw


def main_module(name, function):
    """PyRunner commands run in __main__."""
    setattr(__import__("__main__"), name, function)


def one_by_one(steps):
    """Run step by step, because O.run(steps, True) may miss an error of the first steps."""
    for _ in range(steps):
        O.step()


def pressed(law):
    """A journal pressed into a fixed bearing under a cyclic temperature; friction stops its spin, then the load is
    removed. The motion is not chaotic, so rounding errors stay small."""
    reset()
    program = sj.ThermalProgram(shape="sine", temperatureChangeMax=60, period=1e-3)
    pin = body(
        (1.005e-4, 0.1e-4, 0), sj.Journal(radius=R1), material(expansion=23e-6), mass=0.02,
        inertia=3e-7, blocked=PLANAR, spin=(0, 0, 40),
    )
    hole = body((0, 0, 0), sj.Bearing(radius=R2), material(expansion=10e-6))
    engines(program, normal_damping=0.1, tangential_damping=0.1, law=law)
    O.dt = 2.5e-7
    O.forces.setPermF(pin, (60.0, 20.0, 0))
    rows = []
    for i in range(60):
        if i == 50:
            O.forces.setPermF(pin, (-60.0, 0, 0))
        O.run(100, True)
        state, found = O.bodies[pin].state, contact(pin, hole)
        rows.append(
            {
                "position": list(state.pos)[:2], "velocity": list(state.vel)[:2],
                "spin": state.angVel[2], "force": list(O.forces.f(pin, True))[:2],
                "torque": O.forces.t(pin, True)[2],
                "spring": list(found.phys.shearForce)[:2] if found else None,
                "slipping": found.phys.slipping if found else None,
                "stiffness": [found.phys.kn, found.phys.ks] if found else None,
                "energies": energies(),
            }
        )
    return rows


def force_at_depth(name, change=0.0):
    """Return normal force, stiffness and energy of the named normal law at a depth of 10 um."""
    reset()
    metal, hot = material(), material(expansion=20e-6)
    pin = body((CLEARANCE + 1e-5, 0, 0), sj.Journal(radius=R1), metal)
    hole = body((0, 0, 0), sj.Bearing(radius=R2), hot)
    engines(constant(change), law=Law(normalLaw=name, contactLength=0.01))
    O.dt = 1e-9
    O.run(2, True)
    found = contact(pin, hole)
    return {
        "force": found.phys.normalForce[0], "kn": found.phys.kn, "energy": O.energy["jointElastic"],
        "on_bearing": O.forces.f(hole, True)[0], "depth": found.geom.penetrationDepth,
        "radii": [found.geom.journalRadius, found.geom.bearingRadius],
    }


def on_the_floor(friction):
    """A block on the floor of a slot, pressed with 100 N; the tangential force of 20 N is far below mu F_N."""
    reset()
    metal = material()
    slider = body((0, -1e-6, 0), sj.Slider(radius=0.02), metal, mass=0.1, blocked="zXYZ")
    O.bodies.append(sj.slot((0, 0, 0), 0.03, 0.03, 0.02, metal))
    law = Law(frictionLaw=friction, v0=2e-4, v1=1e-3)
    engines(normal_damping=0.3, tangential_damping=0.3, law=law)
    O.forces.setPermF(slider, (20, -100, 0))
    O.dt = 1e-6
    O.run(20000, True)
    before, energy = O.bodies[slider].state.pos[0], energies()
    promised = sj.stable_time_step()
    O.run(20000, True)
    state = O.bodies[slider].state
    return {
        "speed": state.vel[0], "moved": state.pos[0] - before, "seconds": 20000 * O.dt,
        "dissipated": O.energy["jointFriction"] - energy["jointFriction"], "stable": promised,
        "mass": 0.1, "ks": contact(slider, slider + 1).phys.ks,
        "radii": [contact(slider, slider + 1).geom.journalRadius,
                  contact(slider, slider + 1).geom.bearingRadius],
    }


def impact(dissipation, restitution, time_step, normal="hertz_internal"):
    """Return the rebound speed of a free journal that hits a fixed bearing at 0.1 m/s without friction."""
    reset()
    metal = material(0.0)
    pin = body(
        (0.99e-4, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, inertia=3e-7, blocked="zXYZ",
        velocity=(0.1, 0, 0),
    )
    hole = body((0, 0, 0), sj.Bearing(radius=R2), metal)
    law = Law(normalLaw=normal, dissipationLaw=dissipation, restitution=restitution)
    engines(law=law)
    O.dt = time_step
    # At 0.1 m/s through 1 um, in and out again within 0.15 ms.
    O.run(round(2e-4 / time_step), True)
    speed = O.bodies[pin].state.vel[0]
    O.bodies[pin].state.pos, O.bodies[pin].state.vel = (0.99e-4, 0, 0), (0.1, 0, 0)
    in_contact = None
    while in_contact is None:
        O.step()
        in_contact = contact(pin, hole)
    return {
        "speed": speed, "impact_speed": in_contact.phys.impactSpeed, "contacts": law.contacts,
        "damping": O.energy["jointDamping"], "energy": 0.5 * 0.02 * 0.01,
    }


def cycle(time_step, steps, friction_coefficient, damping, **names):
    """Energy balance of a free journal and a free bearing on thermal links, through a thermal cycle."""
    reset()
    program = sj.ThermalProgram(shape="sine", temperatureChangeMax=80, period=time_step * steps)
    pin = body(
        (1.1e-4, 0.2e-4, 0), sj.Journal(radius=R1), material(friction_coefficient, 23.4e-6),
        mass=0.02, inertia=3e-7, blocked=PLANAR, velocity=(0.05, -0.03, 0), spin=(0, 0, 30),
    )
    hole = body(
        (0, 0, 0), sj.Bearing(radius=R2), material(friction_coefficient, 10e-6), mass=0.03,
        inertia=9e-7, blocked=PLANAR, velocity=(-0.02, 0.01, 0), spin=(0, 0, -10),
    )
    roots = [body((-0.05, 0, 0)), body((0.03, 0.04, 0))]
    common = dict(
        youngModulus=70e9, crossSectionArea=1e-7, thermalExpansion=23.4e-6, program=program,
        stressFreeLength=0.05,
    )
    links = [
        sj.ThermalLink(id1=roots[0], id2=pin, **common),
        sj.ThermalLink(id1=roots[1], id2=hole, **common),
    ]
    engines(program, links, damping, damping, reader="read()", law=Law(**names))
    account = Balance([pin, hole])
    main_module("read", account.read)
    O.dt = time_step
    O.run(steps, True)
    return {
        "worst": max(abs(v - account.values[0]) for v in account.values), "energies": energies(),
        "start": account.kinetic[0],
    }


def drifting(time_step, force=0.0):
    """Return the time of first contact of a journal that drifts to the wall of its bearing, under a force."""
    reset()
    metal = material(0.0)
    pin = body(
        (0.2e-4, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, inertia=3e-7, blocked="zXYZ",
        # Leapfrog takes this for the velocity half a step before the start.
        velocity=(0.05 - 0.5 * time_step * force / 0.02, 0, 0),
    )
    body((0, 0, 0), sj.Bearing(radius=R2), metal)
    law = Law()
    engines(law=law)
    O.forces.setPermF(pin, (force, 0, 0))
    O.dt = time_step
    before = [law.firstContactTime, law.contacts]
    while law.contacts == 0:
        O.step()
    seen = O.time - O.dt
    O.run(round(4e-3 / time_step), True)
    return {"before": before, "time": law.firstContactTime, "seen": seen, "contacts": law.contacts}


def closing(time_step):
    """Only the clearance changes: a journal that heats up touches its bearing."""
    reset()
    program = sj.ThermalProgram(
        shape="table", period=1.0, tableTimes=[0, 1], tableTemperatureChanges=[0, 1000]
    )
    body((0.9e-4, 0, 0), sj.Journal(radius=R1), material(expansion=20e-6), mass=0.02)
    body((0, 0, 0), sj.Bearing(radius=R2), material(expansion=10e-6))
    law = Law()
    engines(program, law=law)
    O.dt = time_step
    while law.contacts == 0:
        O.step()
    return law.firstContactTime


def touching_from_the_start():
    reset()
    metal = material()
    body((CLEARANCE + 1e-6, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, velocity=(1, 0, 0))
    body((0, 0, 0), sj.Bearing(radius=R2), metal)
    law = Law()
    engines(law=law)
    O.dt = 1e-7
    one_by_one(5)
    return [law.firstContactTime, law.contacts]


def many(count):
    """Journals that start to touch at known times."""
    reset()
    metal = material(0.0)
    for i in range(count):
        where = (0.05 * i, 0, 0)
        body(where, sj.Bearing(radius=R2), metal)
        body((0.05 * i + 0.2e-4 + 1e-7 * i, 0, 0), sj.Journal(radius=R1), metal, mass=0.02,
             blocked="zXYZ", velocity=(0.05, 0, 0))
    law = Law()
    engines(law=law)
    O.dt = 1e-6
    O.run(1650, True)
    return {"contacts": law.contacts, "time": law.firstContactTime, "threads": O.numThreads}


def failing(names, slider=False, position=CLEARANCE + 6e-5):
    """Return fault and step of a run whose contact is outside the range of its law; YADE must not crash."""
    reset()
    metal = material(expansion=1e-6)
    if slider:
        body((0, -1e-6, 0), sj.Slider(radius=0.02), metal, mass=0.1, blocked="zXYZ")
        O.bodies.append(sj.slot((0, 0, 0), 0.03, 0.03, 0.02, metal))
    else:
        body((position, 0, 0), sj.Journal(radius=R1), metal, mass=0.02)
        body((0, 0, 0), sj.Bearing(radius=R2), metal)
    engines(constant(10.0), law=Law(**names))
    O.dt = 1e-8
    return [*fault_of(lambda: one_by_one(10)), O.iter]


def steps_to_the_end():
    """A journal pressed beyond the range of the law johnson: the run must end with an error."""
    reset()
    metal = material()
    pin = body((CLEARANCE + 5.4e-5, 0, 0), sj.Journal(radius=R1), metal, mass=1e6, blocked="yzXYZ",
               velocity=(0.05, 0, 0))
    body((0, 0, 0), sj.Bearing(radius=R2), metal)
    engines(law=Law(normalLaw="johnson"))
    O.dt = 1e-6
    found = fault_of(lambda: one_by_one(1000))
    return [*found, O.iter, O.bodies[pin].state.pos[0] - CLEARANCE]


laws = {
    "normalLaw": ["hertz_paper", "hertz_internal", "johnson", "esdu_78035", "persson"],
    "dissipationLaw": ["none", "lankarani_nikravesh", "hunt_crossley", "flores", "exact_restitution"],
    "frictionLaw": ["none", "ambrosio", "mindlin", "mindlin_deresiewicz"],
    "tangentialVelocity": ["material", "paper"],
}
fresh = Law()
defaults = {name: getattr(fresh, name) for name in fresh.dict() if name != "timingDeltas"}


def assign(name, value):
    setattr(fresh, name, value)


wrong = {
    **{name: "jonson" for name in laws},
    "restitution": 0.0, "smallestImpactSpeed": 0.0, "contactLength": float("nan"), "v0": -1e-9,
    "v1": 0.0,
}
refused = {
    name: [fault_of(lambda: Law(**{name: value})), fault_of(lambda: assign(name, value))]
    for name, value in wrong.items()
}
refused["restitution above 1"] = [fault_of(lambda: Law(restitution=1.0001))] * 2
kept = {name: getattr(fresh, name) for name in wrong}
accepted = [
    [kind, name, getattr(Law(**{kind: name}), kind)] for kind, names in laws.items() for name in names
]
both = Law(v0=0.5, v1=2.0)  # each alone against the defaults would be refused

finish(
    {
        "defaults": {k: v for k, v in defaults.items() if isinstance(v, (str, float, int))},
        "refused": refused,
        "kept": kept,
        "accepted": accepted,
        "both": [both.v0, both.v1],
        "same": [pressed(None), pressed(Law())],
        "force": {name: force_at_depth(name) for name in laws["normalLaw"]},
        "hot": {name: force_at_depth(name, 60.0) for name in laws["normalLaw"]},
        "floor": {name: on_the_floor(name) for name in ("ambrosio", "mindlin", "mindlin_deresiewicz")},
        "impact": {
            f"{name} {e}": [impact(name, e, dt) for dt in (4e-8, 2e-8)]
            for name in laws["dissipationLaw"] for e in (0.3, 0.9)
        },
        "persson_impact": [impact("flores", 0.7, dt, "persson") for dt in (4e-8, 2e-8)],
        "cycle": [
            cycle(2e-7 / 2**k, 10000 * 2**k, FRICTION, 0.03, normalLaw="johnson",
                  dissipationLaw="hunt_crossley", restitution=0.9, tangentialVelocity="paper")
            for k in range(3)
        ],
        "lossless": [
            cycle(2e-7 / 2**k, 10000 * 2**k, 0.0, 0.0, normalLaw="persson", frictionLaw="none")
            for k in range(2)
        ],
        "drifting": [drifting(1.1e-5 / 2**k) for k in range(2)],
        "pulled": [drifting(1.1e-5 / 2**k, 1.0) for k in range(4)],
        "closing": closing(7e-5),
        "touching": touching_from_the_start(),
        "many": many(40),
        "failing": {
            "johnson": failing(dict(normalLaw="johnson")),
            "esdu_78035": failing(dict(normalLaw="esdu_78035"), position=CLEARANCE + 4.1e-4),
            "persson": failing(dict(normalLaw="persson"), position=CLEARANCE + 5.1e-3),
            "slider johnson": failing(dict(normalLaw="johnson"), slider=True),
            "slider paper": failing(dict(tangentialVelocity="paper"), slider=True),
            "slider hertz_paper": failing(dict(normalLaw="hertz_paper"), slider=True),
            "inside": failing(dict(normalLaw="johnson"), position=CLEARANCE + 1e-6),
        },
        "to_the_end": steps_to_the_end(),
    }
)
