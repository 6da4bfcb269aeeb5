# SPDX-License-Identifier: GPL-3.0-or-later
"""The same scenes with and without the JointStepper. Usage: `stepper.py PART`; the end of this file lists the parts."""
import struct
import sys

import mixed
import statejump_yade as sj

from both import *  # noqa: F403

MAIN = __import__("__main__")
Law = sj.Law2_JointGeom_JointPhys_JointLaw


def joint(law=None, inertia=3e-7, blocked=PLANAR, newton=None, energy=True, load=(3.0, -20.0, 0), hot=60, **keywords):
    """A journal that rattles in its bearing under a cyclic temperature, until friction and damping stop it."""
    reset()
    O.trackEnergy = energy
    program = sj.ThermalProgram(shape="sine", temperatureChangeMax=hot, period=1e-3, cycles=3)
    pin = body(
        (0.4e-4, 0.1e-4, 0), sj.Journal(radius=R1), material(expansion=23e-6), mass=0.02, inertia=inertia,
        blocked=blocked, velocity=(0.2, -0.1, 0), spin=(0, 0, 40),
    )
    body((0, 0, 0), sj.Bearing(radius=R2), material(expansion=10e-6))
    engines(program, law=law, **{"normal_damping": 0.02, "tangential_damping": 0.02, **keywords})
    if newton:
        O.engines = [*O.engines[:-1], wrapper.NewtonIntegrator(**newton)]
    O.dt = 2.5e-7
    O.forces.setPermF(pin, load)
    O.forces.setPermT(pin, (0, 0, 1e-4))


def ball():
    """A ball that rolls in its socket and rotates freely about all axes."""
    reset()
    metal = material(expansion=2e-5)
    free = body(
        (0.3e-4, 0.9e-4, 0.1e-4), sj.Ball(radius=R1), metal, mass=0.02, inertia=3e-7, blocked="",
        velocity=(0.1, 0.05, -0.2), spin=(10, 20, -30),
    )
    body((0, 0, 0), sj.Socket(radius=R2), metal)
    engines(sj.ThermalProgram(shape="triangle", temperatureChangeMax=40, period=1e-3), normal_damping=0.05)
    O.dt = 2e-7
    O.forces.setPermF(free, (0, -30.0, 5.0))


def balls(law=None):
    """A ball that hits two others; all are hot and rotate freely about all axes, and the last one reaches a wall."""
    reset()
    metal = material(expansion=2e-5)
    for x, y, radius, velocity in ((-2.1, 0.3, 1, (2, 0.3, -0.1)), (0, 0, 1, (0, 0, 0)), (1.4, 0, 0.4, (0, 0, 0.2))):
        body(
            (x * R1, y * R1, 0), sj.Ball(radius=radius * R1), metal, mass=0.004 * radius**3,
            inertia=4e-8 * radius**5, blocked="", velocity=velocity, spin=(100, -200, 300),
        )
    body((-0.45 * R1, 0, 0), sj.Socket(radius=2.75 * R1), metal)
    engines(sj.ThermalProgram(shape="triangle", temperatureChangeMax=40, period=1e-3), law=law, normal_damping=0.05)
    O.dt = 2e-7


def guided():
    """Two sliders on a hot link, one of them in a plane inclined to the axes."""
    reset()
    metal = material(friction=0.1, expansion=1e-5)
    ids = []
    for x in (0.0, 0.3):
        ids.append(body((x, -1e-6, 0), sj.Slider(radius=0.02), metal, mass=0.01, blocked="XYZ"))
        O.bodies.append(sj.slot((x, 0, 0), 0.0201, 0.0201, 0.02, metal, ceiling=True))
        O.forces.setPermF(ids[-1], (0, -50.0, 0))
    program = sj.ThermalProgram(shape="half_sine", temperatureChangeMax=80, period=4e-4, cycles=3)
    link = sj.ThermalLink(
        id1=ids[0], id2=ids[1], youngModulus=70e9, crossSectionArea=1e-6, stressFreeLength=0.3,
        thermalExpansion=2.3e-5, dampingRatio=0.05, program=program,
    )
    engines(program, links=[link], normal_damping=0.05, tangential_damping=0.05)
    guides = sj.GuidePlanes(ids=ids, normals=[(0, 0, 1), (0.6, 0, 0.8)])
    O.engines = [*O.engines[:-1], guides, O.engines[-1]]
    O.dt = 2e-7


def prismatic():
    """Two tubes, each held by a heated link, slide in each other from stop to stop and move transversely as well."""
    reset()
    program = sj.ThermalProgram(shape="sine", temperatureChangeMax=60, period=1e-3, cycles=5)
    walls = [body((0, 0, 0)), body((1, 0, 0))]
    tubes = [body((0.5, 0, 0), mass=0.01, blocked="zXYZ", velocity=(0.1, 0.02, 0)),
             body((0.4, 0.1, 0), mass=0.02, blocked="zXYZ", velocity=(0, -0.03, 0))]
    links = [
        sj.ThermalLink(id1=wall, id2=tube, youngModulus=70e9, crossSectionArea=1e-6, stressFreeLength=length,
                       thermalExpansion=2.3e-5, dampingRatio=0.02, program=program)
        for wall, tube, length in zip(walls, tubes, (0.5, (0.6**2 + 0.1**2) ** 0.5))
    ]
    joint = sj.PrismaticJoint(
        id1=tubes[0], id2=tubes[1], axis=(0.8, 0.6, 0), offset=(0.1, -0.1, 0), stiffnessAcross=4e6, frictionLimit=3.0,
        frictionStiffness=1e6, clearanceMinus=2e-5, clearancePlus=4e-5, stopStiffness=1e9, dampingRatio=0.02,
    )
    engines(program, links=links, prismatic_joints=[joint])
    O.dt = 1e-6


def approaching():
    """Two sliders move towards slots before any contact, so the collider has to find the pairs."""
    reset()
    metal = material()
    for x in (0.0, 1.0):
        body((x, 0.05, 0), sj.Slider(radius=0.02), metal, mass=0.01, blocked="zXYZ", velocity=(0, -20 - x, 0))
        O.bodies.append(sj.slot((x, 0, 0), 0.05, 0.05, 0.02, metal, halfSize=0.02))
    engines(normal_damping=0.05)
    O.dt = 1e-6


def crowd(energy=False):
    """Independent joints with different loads; there are more of them than one block of the JointStepper holds."""
    reset()
    O.trackEnergy = energy
    metal, other = material(expansion=2.3e-5), material(expansion=2.2e-5)
    for i in range(45):
        angle = 0.21 * i
        place = Vector3(0.03 * i, 0, 0)
        body(place, sj.Bearing(radius=R2), other)
        side = Vector3(1, 0.1 * i - 2.2, 0).normalized()
        pin = body(place + (CLEARANCE * 1.003) * side, sj.Journal(radius=R1), metal, mass=0.01, blocked="zXYZ")
        O.forces.setPermF(pin, 10 * side + 0.1 * angle * Vector3(-side[1], side[0], 0))
    engines(sj.ThermalProgram(shape="triangle", temperatureChangeMax=30, period=2e-3))
    O.engines = [*O.engines[:-1], wrapper.NewtonIntegrator(damping=0.2)]
    O.dt = 1e-6


def in_pieces(steps):
    """Runs that end anywhere, a load that changes meanwhile."""
    for piece in (1, 2, 30, 101, 7):
        O.run(piece, True)
    O.forces.setPermF(0, (1.0, 5.0, 0))
    O.run(steps - O.iter, True)


def scenes():
    by_name = dict(normalLaw="hertz_paper", dissipationLaw="flores", restitution=0.8)
    cases = {
        "joint": (joint, 3000, 500),
        "joint_without_energy": (lambda: joint(energy=False), 3000, 1000),
        "joint_by_name": (lambda: joint(Law(**by_name)), 3000, 500),
        "joint_damped": (lambda: joint(newton=dict(damping=0.3)), 3000, 250),
        "joint_in_gravity": (lambda: joint(newton=dict(damping=0, gravity=(0, -9.81, 0))), 3000, 250),
        "joint_in_undamped_gravity": (
            lambda: joint(newton=dict(damping=0.2, gravity=(0, -900, 0), dampGravity=False), energy=False), 3000, 250),
        "joint_in_damped_gravity": (
            lambda: joint(newton=dict(damping=0.2, gravity=(0, -900, 0)), energy=False), 3000, 250),
        "ball": (ball, 3000, 300),
        "balls": (balls, 8000, 300),
        "balls_by_name": (
            lambda: balls(Law(frictionLaw="mindlin_deresiewicz", dissipationLaw="exact_restitution", restitution=0.6)),
            8000, 300),
        "guided": (guided, 3000, 300),
        "prismatic": (prismatic, 5000, 300),
        "approaching": (approaching, 4000, 500),
        "mixed": (lambda: mixed.scene(False), 2000, 100),
        "mixed_by_name": (lambda: mixed.scene(True), 2000, 100),
        "mixed_partial_slip": (lambda: mixed.scene(False, True), 2000, 100),
        "mixed_every_step": (lambda: mixed.scene(True), 300, 1),
        "crowd": (crowd, 2000, 1000),
        "crowd_with_energy": (lambda: crowd(True), 1000, 250),
    }
    found = {name: run_both(*case) for name, case in cases.items()}
    cases = {
        "joint": (joint, 3000, 500),
        "prismatic": (prismatic, 5000, 300),
        "approaching": (approaching, 4000, 500),
        "mixed_by_name": (lambda: mixed.scene(True), 2000, 100),
        "crowd": (crowd, 2000, 1000),
        "mixed_saved": (lambda: mixed.scene(True), 1500, 130, saved),
    }
    found |= {f"{name}_recorded": run_both(*case, record=(1, 0)) for name, case in cases.items()}
    found["in_pieces"] = run_both(joint, 2000, 130, in_pieces)
    found["saved"] = run_both(lambda: mixed.scene(True), 1500, 130, saved)
    found["balls_saved"] = run_both(lambda: balls(Law(frictionLaw="mindlin_deresiewicz")), 8000, 300, saved)
    found["prismatic_saved"] = run_both(prismatic, 3000, 130, saved)
    found["erased"] = run_both(crowd, 1500, 250, erased(2))
    return found


def laws():
    """Every law of the catalogue, each with default laws for the other roles."""
    found = {}
    for attribute, names in sj.law_names().items():
        for name in names:
            law = {attribute: name, "restitution": 0.7}
            found[f"{attribute} {name}"] = run_both(lambda law=law: joint(Law(**law), hot=20), 2500, 250)
    return found


def recording():
    """Compare the recorder's rows with what a script reads in the same steps."""
    mixed.scene(True)
    recorded()
    recorder, read = O.engines[-2], []

    def vectors(*of):
        return [value for vector in of for value in vector]

    def look():
        row = [O.time, *(dict(O.energy.items()).get(name, 0.0) for name in recorder.scalars()[1:-3])]
        others = [(i.id1, i.id2) for i in O.interactions if i.isReal and {i.id1, i.id2} != {0, 1}]
        row += [O.interactions.countReal(), *(others[0] if others else (-1, -1))]
        for number in recorder.bodies:
            state, force = O.bodies[number].state, O.forces.f(number, sync=True)
            free = [0.0 if axis in state.blockedDOFs else force[k] for k, axis in enumerate("xyz")]
            row += vectors(state.pos, state.vel, free)
        pair = contact(0, 1)
        row += [0.0] * 12 if pair is None else [
            1.0, pair.geom.penetrationDepth, float(pair.phys.slipping),
            *vectors(pair.geom.normal, pair.phys.normalForce, pair.phys.shearForce)]
        for link in recorder.links:
            row += [link.axialForce, link.temperatureChange, link.previousExtension, link.previousStressFreeLength]
        for spring in recorder.springs:
            row += [spring.angle, spring.moment, spring.frictionMoment]
        read.append(row)

    MAIN.look = look
    O.engines = [*O.engines[:-1], wrapper.PyRunner(command="look()", iterPeriod=7, initRun=True), O.engines[-1]]
    O.run(500, True)
    count, width = recorder.rows(), recorder.width()
    kept = list(struct.unpack(f"{count * width}d", recorder.take()))
    return {"kept": [kept[i * width:(i + 1) * width] for i in range(count)], "read": read, "after": recorder.rows()}


def closing():
    joint(hot=4000)


def too_deep():
    """An impact so hard that the contact makes the time step unstable."""
    joint(energy=False, normal_damping=0.0)
    O.dt = 3e-5


def parting():
    joint(Law(normalLaw="johnson", restitution=0.7), load=(3e7, 0, 0))


def failures():
    return {each.__name__: error_of(each) for each in (closing, too_deep, parting)}


def refused(change):
    crowd()
    with_stepper(100)

    def run():
        change()
        for _ in range(300):
            O.step()

    return fault_of(run)[1]


def engines_are(*engines):
    O.engines = list(engines)


def add_sphere():
    sphere = wrapper.Body()
    sphere.shape, sphere.material, sphere.bound = wrapper.Sphere(radius=0.01), O.materials[0], wrapper.Aabb()
    O.bodies.append(sphere)


def wrong():
    """One sentence for each way to use it wrongly."""
    found = {}
    for name, value in (("zero", 0), ("negative", -3), ("fraction", 1.5), ("text", "many")):
        found["substeps " + name] = fault_of(lambda value=value: sj.JointStepper(substeps=value))
    link = sj.ThermalLink(id1=0, id2=1, stressFreeLength=1)
    for name, wrong_value in (("iterPeriod", 0), ("contacts", [1, 2, 3]), ("contacts", [1, 2, 2, 1]), ("links", [link, None])):
        found[f"{name} {len(found)}"] = fault_of(lambda: sj.StateRecorder(**{name: wrong_value}))[1]
    found["substeps set"] = fault_of(lambda: setattr(sj.JointStepper(), "substeps", 2.5))
    e = lambda: O.engines  # noqa: E731
    changes = {
        "sphere": add_sphere,
        "two": lambda: with_stepper(10),
        "before_resetter": lambda: engines_are(e()[1], e()[0], *e()[2:]),
        "last": lambda: engines_are(e()[0], *e()[2:], e()[1]),
        "loop_first": lambda: engines_are(e()[0], e()[1], e()[4], e()[2], e()[3], *e()[5:]),
        "recorder_first": lambda: engines_are(e()[0], e()[1], sj.StateRecorder(), *e()[2:]),
        "recorded_body": lambda: engines_are(*e()[:-1], sj.StateRecorder(bodies=[400]), e()[-1]),
        "no_newton": lambda: engines_are(*e()[:-1]),
        "unknown": lambda: engines_are(*e()[:-1], wrapper.ForceEngine(), e()[-1]),
        "no_verlet": lambda: setattr(e()[3], "verletDist", 0),
        "periodic": lambda: setattr(O, "periodic", True),
        "mask": lambda: setattr(e()[-1], "mask", 2),
        "attribute": lambda: setattr(e()[1], "substeps", 0),
    }
    for name, change in changes.items():
        found[name] = refused(change)
    return found


finish({"scenes": scenes, "laws": laws, "recording": recording, "failures": failures, "wrong": wrong}[sys.argv[1]]())
