# SPDX-License-Identifier: GPL-3.0-or-later
"""Invalid numbers in YADE's loop and the JointStepper. Usage: `silence.py PART`, with the parts listed at the end.

A change is made before the first step, between two runs, or by a PyRunner during a run, at its step 60.
"""
import contextlib
import sys

import statejump_yade as sj

from parts import *  # noqa: F403

MAIN = __import__("__main__")
NAN, INF = float("nan"), float("inf")
SUBSTEPS, STEPS, WITHIN = 20, 200, 60
Law = sj.Law2_JointGeom_JointPhys_JointLaw


def joint(law=None, expansion=2e-5, link_expansion=2e-5, heat=30.0, blocked="zXY"):
    """A journal (1) on a link from body 0, pressed into its bearing (2); a torsion spring couples another link (3 to
    4)."""
    reset()
    program = sj.ThermalProgram(shape="half_sine", temperatureChangeMax=heat, period=2e-5)
    metal = material(expansion=expansion)
    root = body((CLEARANCE + 1e-6 - 0.5, 0, 0))
    pin = body((CLEARANCE + 1e-6, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, inertia=1e-6, blocked=blocked)
    body((0, 0, 0), sj.Bearing(radius=R2), material(expansion=2e-5))
    ends = [body((0.5, 0.5, 0)), body((1.0, 0.5, 0), mass=0.02, blocked="zXYZ")]
    common = dict(youngModulus=70e9, crossSectionArea=9e-6, stressFreeLength=0.5, program=program)
    links = [
        sj.ThermalLink(id1=root, id2=pin, thermalExpansion=link_expansion, dampingRatio=0.01, **common),
        sj.ThermalLink(id1=ends[0], id2=ends[1], pinDamping=1e-4, **common),
    ]
    spring = sj.TorsionSpring(link1=links[0], link2=links[1], stiffness=0.1)
    engines(program, links=links, springs=[spring], law=law, normal_damping=0.02, tangential_damping=0.02)
    O.dt = 1e-7
    O.forces.setPermF(pin, (20, 3, 0))
    MAIN.links, MAIN.spring, MAIN.metal = links, spring, metal


def bored():
    """A journal (1) pressed into a bore of triangles (2)."""
    reset()
    MAIN.metal = material(expansion=2e-5)
    body((-0.5, 0, 0))
    pin = body((CLEARANCE + 2e-6, 0, 0), sj.Journal(radius=R1), MAIN.metal, mass=0.02, inertia=1e-6, blocked="zXY")
    body((0, 0, 0), tube(120, 12), material(expansion=2e-5))
    bore_engines(sj.ThermalProgram(shape="half_sine", temperatureChangeMax=30.0, period=2e-5), damping=0.02)
    O.dt = 1e-7
    O.forces.setPermF(pin, (20, 3, 0))


def state(number):
    return O.bodies[number].state


def physics():
    found = O.interactions[1, 2].phys
    return found.contacts[0] if isinstance(found, sj.BorePhys) else found


def go(steps):
    """Return class and text of what ends a run; if YADE misses an error of its first step, one more step raises it."""
    last = O.iter + steps
    found = sentence_of(lambda: O.run(steps, True))
    return sentence_of(O.step) if found[0] == "none" and O.iter < last else found


def both(change, when="start", build=joint):
    """Return what ends the scene, for YADE's loop and for the JointStepper: class, text, step, and the plugin's fault
    with its bodies and time."""
    found = []
    for stepper in (False, True):
        build()
        if stepper:
            with_stepper(SUBSTEPS)
        MAIN.change = change
        if when == "start":
            change()
            ended = go(STEPS)
        elif when == "between":
            go(50)
            change()
            ended = go(STEPS - 50)
        else:
            O.engines = [*O.engines, wrapper.PyRunner(command="change()", iterPeriod=WITHIN, initRun=False, nDo=2)]
            ended = go(STEPS)
        taken = sj.take_failure()
        found.append([*ended, O.iter, fault(taken), taken and taken["time"]])
    return found


def put_past(setter):
    """Make a change that the setter refuses but that remains nevertheless, as with updateAttrs()."""
    def change():
        with contextlib.suppress(ValueError):
            setter()
    return change


# Between two steps, through YADE's own attributes or past ours. A negative O.dt is refused by YADE itself.
CHANGES = {
    "dt nan": lambda: setattr(O, "dt", NAN),
    "dt inf": lambda: setattr(O, "dt", INF),
    "dt zero": lambda: setattr(O, "dt", 0.0),
    "permanent force": lambda: O.forces.setPermF(1, (NAN, 0, 0)),
    "permanent torque": lambda: O.forces.setPermT(1, (0, 0, INF)),
    "position": lambda: setattr(state(1), "pos", (NAN, 0, 0)),
    "position of the bearing": lambda: setattr(state(2), "pos", (0, INF, 0)),
    "position of a link's root": lambda: setattr(state(0), "pos", (0, NAN, 0)),
    "velocity": lambda: setattr(state(1), "vel", (0, NAN, 0)),
    "angular velocity": lambda: setattr(state(1), "angVel", (0, 0, NAN)),
    "orientation": lambda: setattr(state(1), "ori", Quaternion(NAN, 0, 0, 0)),
    "mass zero": lambda: setattr(state(1), "mass", 0.0),
    "mass nan": lambda: setattr(state(1), "mass", NAN),
    "mass negative": lambda: setattr(state(1), "mass", -0.02),
    "mass of a link's tip": lambda: setattr(state(4), "mass", NAN),
    "inertia zero": lambda: setattr(state(1), "inertia", (1e-6, 1e-6, 0)),
    "inertia nan": lambda: setattr(state(1), "inertia", (1e-6, 1e-6, NAN)),
    "expansion of a material": put_past(lambda: MAIN.metal.updateAttrs({"thermalExpansion": NAN})),
    "link": put_past(lambda: MAIN.links[0].updateAttrs({"thermalExpansion": NAN})),
    "link's damping": put_past(lambda: MAIN.links[1].updateAttrs({"pinDamping": NAN})),
    "link's stiffness": put_past(lambda: MAIN.links[0].updateAttrs({"youngModulus": NAN})),
    "spring": put_past(lambda: MAIN.spring.updateAttrs({"stiffness": NAN})),
    "spring's angle": put_past(lambda: MAIN.spring.updateAttrs({"freeAngle": NAN})),
    "spring's friction": put_past(lambda: MAIN.spring.updateAttrs({"frictionLimit": 1.0, "frictionStiffness": NAN})),
    "spring's friction without stiffness": lambda: setattr(MAIN.spring, "frictionLimit", 1.0),
    "spring's slip": put_past(lambda: MAIN.spring.updateAttrs(
        {"frictionLimit": 1.0, "frictionStiffness": 0.01, "slipAngle": NAN})),
}
# Of a material when the contact is made, of a contact once it is there.
MATERIALS = {
    "young": lambda: setattr(MAIN.metal, "young", NAN),
    "poisson": lambda: setattr(MAIN.metal, "poisson", NAN),
    "friction angle": lambda: setattr(MAIN.metal, "frictionAngle", NAN),
}
CONTACTS = {
    "friction nan": lambda: setattr(physics(), "tangensOfFrictionAngle", NAN),
    "friction negative": lambda: setattr(physics(), "tangensOfFrictionAngle", -0.1),
    "modulus nan": put_past(lambda: physics().updateAttrs({"effectiveYoungModulus": NAN})),
    "modulus negative": put_past(lambda: physics().updateAttrs({"effectiveYoungModulus": -1e10})),
    "shear modulus": put_past(lambda: physics().updateAttrs({"effectiveShearModulus": NAN})),
    "mass": put_past(lambda: physics().updateAttrs({"effectiveMass": NAN})),
    "normal damping": put_past(lambda: physics().updateAttrs({"normalDampingRatio": NAN})),
    "tangential damping": put_past(lambda: physics().updateAttrs({"tangentialDampingRatio": NAN})),
}
# What a script changes within a run is seen where it is used: in the same step or the next.
SEEN_WITHIN = [name for name in CHANGES if name != "mass negative"]


def at_start():
    return {name: both(change) for name, change in {**CHANGES, **MATERIALS}.items()}


def between():
    return {name: both(change, "between") for name, change in {**CHANGES, **CONTACTS, **MATERIALS}.items()}


def within():
    changes = {**{name: CHANGES[name] for name in SEEN_WITHIN}, **CONTACTS}
    del changes["shear modulus"], changes["normal damping"], changes["tangential damping"]
    return {name: both(change, "within") for name, change in changes.items()}


def kept():
    """A NaN in the stored force of a contact; the joint stays cold and in contact."""
    def change():
        physics().shearForce = (0, NAN, 0)
    return {when: both(change, when, lambda: joint(heat=0.0)) for when in ("between", "within")}


def by_name():
    """A law by name has the same questions put to it."""
    laws = {"johnson": dict(normalLaw="johnson"), "hertz_paper": dict(normalLaw="hertz_paper", dissipationLaw="flores")}
    return {
        f"{name} {what}": both(change, when, lambda law=law: joint(Law(restitution=0.8, **law)))
        for name, law in laws.items()
        for what, change, when in (
            ("position", CHANGES["position"], "within"), ("modulus nan", CONTACTS["modulus nan"], "within"),
            ("modulus negative", CONTACTS["modulus negative"], "between"), ("friction nan", CONTACTS["friction nan"], "within"),
        )
    }


def bore():
    """The same changes in a scene with a bore of triangles, without link, spring and third body."""
    changes = {**CHANGES, **MATERIALS, **CONTACTS}
    named = [name for name in changes if "link" not in name and "spring" not in name]
    return {
        when: {name: both(changes[name], when, bored) for name in named if when != "start" or name not in CONTACTS}
        for when in ("start", "between", "within")
    } | {"good": both(nothing, build=bored)}


def nothing():
    pass


def lengths():
    """Expansion coefficients that reduce a length to zero: -0.1/K does so within the half_sine of 30 K."""
    return {
        "body": both(nothing, build=lambda: joint(expansion=-0.1)),
        "link": both(nothing, build=lambda: joint(link_expansion=-0.1, blocked="xyzXYZ")),
        "link that falls": both(nothing, build=lambda: joint(link_expansion=-1.0, blocked="xyzXYZ")),
    }


def good():
    """Valid scenes run to their end, among them one with fixed bodies without mass."""
    return {
        "joint": both(nothing), "fixed": both(nothing, build=lambda: joint(blocked="xyzXYZ")),
        "by name": both(nothing, build=lambda: joint(Law())),
        "hot": both(nothing, build=lambda: joint(expansion=2.5e-5, heat=-40.0)),
    }


def setters():
    """Attributes of the plugin's classes refuse invalid values and keep their former ones."""
    joint()
    go(5)
    found = {}
    targets = {
        "JointPhys": (physics(), ("effectiveYoungModulus", "effectiveShearModulus", "effectiveMass", "normalDampingRatio",
                                  "tangentialDampingRatio"), (NAN, INF, -1.0)),
        "ThermalFrictMat": (MAIN.metal, ("thermalExpansion",), (NAN, INF)),
        "Journal": (O.bodies[1].shape, ("thermalStrain",), (NAN, INF, -1.0)),
        "ThermalLink": (MAIN.links[0], ("thermalExpansion",), (NAN, INF)),
        "Ig2_Journal_Bearing_JointGeom": (sj.Ig2_Journal_Bearing_JointGeom(), ("maxTilt",), (NAN, INF, -1.0)),
        "Ig2_Journal_MeshBore_BoreGeom": (sj.Ig2_Journal_MeshBore_BoreGeom(), ("maxTilt",), (NAN, -1.0)),
    }
    for name, (target, attributes, values) in targets.items():
        for attribute in attributes:
            before = getattr(target, attribute)
            for value in values:
                said = fault_of(lambda a=attribute, v=value: setattr(target, a, v))
                found[f"{name}.{attribute} = {value}"] = [*said, getattr(target, attribute) == before]
    return found


def without_our_engines():
    """Without engines of the plugin, a contact reports the failure on standard error, and the run ends."""
    found = {}
    for name, change in {**CHANGES, **CONTACTS}.items():
        if name not in ("position", "dt zero", "modulus nan", "friction nan"):
            continue
        joint()
        O.engines = [e for e in O.engines if not e.__class__.__name__.startswith(("Thermal", "Torsion"))]
        go(20)
        change()
        found[name] = [*go(STEPS), O.iter]
    return found


PARTS = {each.__name__: each for each in (
    at_start, between, within, kept, by_name, bore, lengths, good, setters, without_our_engines)}
finish(PARTS[sys.argv[1]]())
