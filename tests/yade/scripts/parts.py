# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies, engines and evaluations shared by the scripts of these tests. Runs under ``yade``."""
from __future__ import annotations

import json
from math import atan

import statejump_yade as sj
from yade import wrapper
from yade.minieigenHP import Quaternion, Vector3

O = wrapper.Omega()

# Table 2 of the paper.
YOUNG, POISSON, FRICTION = 70e9, 0.3, 0.3
R1, CLEARANCE = 5e-3, 1e-4
R2 = R1 + CLEARANCE
PLANAR = "zXY"
LENGTH = 10e-3  # of bores of triangles


def finish(result: dict) -> None:
    """Print the result in one line."""
    print("\nRESULT " + json.dumps(result), flush=True)


def reset() -> None:
    """Start an empty scene that tracks energy."""
    O.reset()
    O.trackEnergy = True


def material(friction: float = FRICTION, expansion: float = 0.0, **keywords) -> wrapper.Material:
    """Append an aluminium that expands."""
    made = sj.ThermalFrictMat(
        young=keywords.pop("young", YOUNG),
        poisson=keywords.pop("poisson", POISSON),
        frictionAngle=atan(friction),
        thermalExpansion=expansion,
        **keywords,
    )
    O.materials.append(made)
    return made


def body(
    position=(0, 0, 0),
    shape=None,
    made_of=None,
    mass: float = 0.0,
    inertia: float = 0.0,
    blocked: str = "xyzXYZ",
    orientation=Quaternion((0, 0, 1), 0),
    velocity=(0, 0, 0),
    spin=(0, 0, 0),
) -> int:
    """Append a body and return its id."""
    new = wrapper.Body()
    if shape is not None:
        new.shape, new.material, new.bound = shape, made_of, wrapper.Aabb()
    new.state.pos = new.state.refPos = position
    new.state.ori = orientation
    new.state.mass = mass
    new.state.inertia = (inertia, inertia, inertia)
    new.state.blockedDOFs = blocked
    new.state.vel, new.state.angVel = velocity, spin
    return O.bodies.append(new)


def constant(change: float = 0.0) -> sj.ThermalProgram:
    """Constant temperature change from the second step on (at the first step, time 0, it is zero)."""
    return sj.ThermalProgram(
        shape="table", period=1e-15, tableTimes=[0, 1e-15], tableTemperatureChanges=[0, change]
    )


def engines(
    program=None, links=(), normal_damping=0.0, tangential_damping=0.0, reader=None, thermal=None,
    law=None, springs=(), prismatic_joints=(),
) -> None:
    """Set the engines of a scene of joints and links; the evaluation reads values of one consistent time."""
    O.engines = [
        wrapper.ForceResetter(),
        *(thermal or [sj.ThermalExpansionEngine(program=program or constant())]),
        wrapper.InsertionSortCollider(
            [
                sj.Bo1_Journal_Aabb(), sj.Bo1_Bearing_Aabb(), sj.Bo1_Ball_Aabb(), sj.Bo1_Socket_Aabb(),
                sj.Bo1_Slider_Aabb(), sj.Bo1_SlotFace_Aabb(),
            ],
            verletDist=1e-4,
        ),
        wrapper.InteractionLoop(
            [
                sj.Ig2_Journal_Bearing_JointGeom(), sj.Ig2_Ball_Socket_JointGeom(),
                sj.Ig2_Slider_SlotFace_JointGeom(), sj.Ig2_Ball_Ball_JointGeom(),
            ],
            [
                sj.Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(
                    normalDampingRatio=normal_damping, tangentialDampingRatio=tangential_damping
                )
            ],
            [law or sj.Law2_JointGeom_JointPhys_HertzMindlin()],
        ),
        sj.ThermalLinks(links=list(links)),
        *([sj.TorsionSprings(springs=list(springs))] if springs else []),
        *([sj.PrismaticJoints(joints=list(prismatic_joints))] if prismatic_joints else []),
        *([wrapper.PyRunner(command=reader, iterPeriod=1, initRun=True)] if reader else []),
        wrapper.NewtonIntegrator(damping=0),
    ]


def bore_engines(program=None, damping=0.0, law=None, angle=2e-4) -> None:
    """Set the engines of a scene with bores of triangles."""
    O.engines = [
        wrapper.ForceResetter(),
        sj.ThermalExpansionEngine(program=program or constant()),
        wrapper.InsertionSortCollider(
            [sj.Bo1_Journal_Aabb(), sj.Bo1_Bearing_Aabb(), sj.Bo1_Ball_Aabb(), sj.Bo1_Socket_Aabb(),
             sj.Bo1_MeshBore_Aabb()],
            verletDist=1e-4,
        ),
        wrapper.InteractionLoop(
            [sj.Ig2_Journal_Bearing_JointGeom(), sj.Ig2_Ball_Socket_JointGeom(),
             sj.Ig2_Journal_MeshBore_BoreGeom(patchAngle=angle), sj.Ig2_Ball_MeshBore_BoreGeom(patchAngle=angle)],
            [sj.Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(
                normalDampingRatio=damping, tangentialDampingRatio=damping)],
            [sj.Law2_JointGeom_JointPhys_JointLaw(), law or sj.Law2_BoreGeom_BorePhys_JointLaw()],
        ),
        sj.ThermalLinks(),
        wrapper.NewtonIntegrator(damping=0),
    ]


def tube(around=200, along=20, **keywords) -> sj.MeshBore:
    """Return a round bore of triangles."""
    return sj.MeshBore(**sj.bore_triangles(R2, LENGTH, around, along, **keywords))


def energies() -> dict[str, float]:
    """Return O.energy as a dict."""
    return {name: O.energy[name] for name in O.energy.keys()}


def stored_minus_supplied() -> float:
    """Return elastic energy plus losses minus thermal work at the current step [J]."""
    e = energies()
    return (
        sum(e.get(name, 0.0) for name in ("jointElastic", "jointFriction", "jointDamping"))
        + sum(e.get(name, 0.0) for name in ("linkElastic", "linkDamping", "pinDamping"))
        + e.get("torsionElastic", 0.0)
        + e.get("torsionFriction", 0.0)
        + sum(e.get(name, 0.0) for name in ("prismaticElastic", "prismaticFriction", "prismaticDamping"))
        - e.get("jointThermalWork", 0.0)
        - e.get("linkThermalWork", 0.0)
    )


def sentence_of(call) -> list[str]:
    """Return class and text of the error that a call raises; 'none' and '' without an error."""
    try:
        call()
    except BaseException as error:
        return [type(error).__name__, str(error)]
    return ["none", ""]


def fault_of(call) -> list[str]:
    """Return class and fault of the error that a call raises; an error without a code gives its text; 'none' and ''
    without an error."""
    sj.take_failure(), sj.take_refusal()  # earlier ones
    kind, text = sentence_of(call)
    return [kind, fault(sj.take_failure() or sj.take_refusal()) or text]


def allowed_of(call) -> str:
    """Return the allowed values that the refusal of a call states."""
    sj.take_failure(), sj.take_refusal()  # earlier ones
    sentence_of(call)
    return (sj.take_refusal() or {"allowed": ""})["allowed"]


def fault(taken) -> str:
    """Return a failure or refusal as 'CODE KEY = VALUE (PART BODIES)', without missing fields; '' for None."""
    if not taken:
        return ""
    key, value = taken.get("quantity") or taken.get("key"), taken["value"]
    part = " ".join(map(str, (taken["part"], *taken["bodies"]))) if "part" in taken else ""
    return taken["code"] + (f" {key}" if key else "") + (f" = {value}" if value else "") + (f" ({part})" if part else "")


def pressed(one: int, two: int, mover: int, distance) -> list[dict]:
    """Return the contact of two bodies at three depths in three directions. One body is at the origin, ``mover`` moves;
    ``distance`` converts depth [m] to distance of the centres [m]."""
    rows = []
    for depth in (1e-7, 3e-6, 1e-5):
        for direction in ((0, 0, 1), (0.6, 0, -0.8), (2 / 7, 3 / 7, 6 / 7)):
            O.bodies[mover].state.pos = Vector3(*direction) * distance(depth)
            O.step()
            found = contact(one, two)
            rows.append({
                "depth": depth, "direction": direction, "force": list(O.forces.f(one)),
                "reaction": list(O.forces.f(two)), "R": found.geom.effectiveRadius, "kn": found.phys.kn,
                "ks": found.phys.ks, "radii": [found.geom.journalRadius, found.geom.bearingRadius],
            })
    return rows


def refusal(first, second, offset, law) -> list[str]:
    """Return class and fault of the error if a law acts between two shapes of one material, the second at an offset."""
    reset()
    metal = material()
    body(shape=first, made_of=metal)
    body(offset, second, metal)
    engines(law=law)
    O.dt = 1e-9

    def run():
        for _ in range(3):
            O.step()

    return fault_of(run)


class Balance:
    """Energy balance of the scene, evaluated before the motion of each step.

    The kinetic energy m v(n-1/2).v(n+1/2)/2 changes in leapfrog integration by exactly the trapezoidal work of the
    forces. v(n+1/2) follows from the forces of this step.
    """

    def __init__(self, ids, permanent=None) -> None:
        self.ids, self.permanent = list(ids), permanent or {}
        self.values: list[float] = []
        self.kinetic: list[float] = []

    def read(self) -> None:
        kinetic, potential = 0.0, 0.0
        for i in self.ids:
            state = O.bodies[i].state
            free = [0.0 if axis in state.blockedDOFs else 1.0 for axis in "xyz"]
            turns = 0.0 if "Z" in state.blockedDOFs else 1.0
            force = O.forces.f(i, True)
            after = [state.vel[k] + O.dt * free[k] * force[k] / state.mass for k in range(3)]
            kinetic += 0.5 * state.mass * sum(state.vel[k] * after[k] for k in range(3))
            if turns:
                spin = state.angVel[2] + O.dt * O.forces.t(i, True)[2] / state.inertia[2]
                kinetic += 0.5 * state.inertia[2] * state.angVel[2] * spin
            if i in self.permanent:
                potential -= Vector3(*self.permanent[i]).dot(state.pos)
        self.kinetic.append(kinetic)
        self.values.append(kinetic + potential + stored_minus_supplied())


def contact(first: int, second: int):
    """Return the contact of two bodies or None."""
    if not O.interactions.has(first, second):
        return None
    found = O.interactions[first, second]
    return found if found.isReal else None


def with_stepper(substeps: int) -> None:
    """Put the stepper where it belongs, before what steps the scene."""
    O.engines = [*O.engines[:1], sj.JointStepper(substeps=substeps), *O.engines[1:]]
