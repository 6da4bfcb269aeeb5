# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a scene with every type of part, and returns its complete state. Imported by scripts that run under ``yade``.
"""
import statejump_yade as sj

from parts import *  # noqa: F403


def scene(by_name, partial_slip=False):
    """A journal on a hot link, its bearing on another link, and a slider with two contacts."""
    reset()
    program = sj.ThermalProgram(shape="half_sine", temperatureChangeMax=70, period=2e-3, cycles=2)
    table = sj.ThermalProgram(
        shape="table", period=1e-3, tableTimes=[0, 3e-4, 1e-3], tableTemperatureChanges=[0, 9, 4]
    )
    metal = material(expansion=2.3e-5, label="metal")
    pin = body(
        (1.05e-4, 0.2e-4, 0), sj.Journal(radius=R1), metal, mass=0.02, inertia=3e-7,
        blocked="zXYZ", velocity=(0.05, -0.03, 0),
    )
    hole = body(
        (0, 0, 0), sj.Bearing(radius=R2), metal, mass=0.03, inertia=9e-7, blocked=PLANAR,
        velocity=(-0.02, 0.01, 0), spin=(0, 0, -10),
    )
    roots = [body((-0.05, 0.01, 0)), body((0.03, 0.04, 0))]
    slider = body(
        (1.0 + 0.9e-6, -1e-6, 0), sj.Slider(radius=0.02), metal, mass=0.01, blocked="zXYZ",
        velocity=(0.01, 0, 0),
    )
    O.bodies.append(sj.slot((1, 0, 0), 0.02, 0.02, 0.02, metal))
    # Another one that slides all the time, away from its stops.
    gliding = body(
        (2, -2e-6, 0), sj.Slider(radius=0.02), metal, mass=0.01, blocked="zXYZ", velocity=(0.5, 0, 0)
    )
    O.bodies.append(sj.slot((2, 0, 0), 0.03, 0.03, 0.02, metal))
    O.bodies[gliding].state.blockedDOFs = "yzXYZ"
    common = dict(youngModulus=70e9, crossSectionArea=1e-7, thermalExpansion=23.4e-6)
    links = [
        sj.ThermalLink(
            id1=roots[0], id2=pin, stressFreeLength=0.05, program=program, tipTurnsWithLink=True,
            dampingRatio=0.03, **common,
        ),
        sj.ThermalLink(id1=roots[1], id2=hole, stressFreeLength=0.05, program=table, **common),
    ]
    more = {}
    if partial_slip:
        more["law"] = sj.Law2_JointGeom_JointPhys_JointLaw(frictionLaw="mindlin_deresiewicz")
    if by_name:
        links[0].pinDamping = 1e-4
        # Slack until the one has moved away from the other.
        links.append(sj.ThermalLink(id1=slider, id2=gliding, stressFreeLength=1.00003, program=program, tensionOnly=True,
                                    dampingRatio=0.1, **common))
        more["law"] = sj.Law2_JointGeom_JointPhys_JointLaw(
            normalLaw="hertz_paper", dissipationLaw="hunt_crossley", restitution=0.95,
            smallestImpactSpeed=1e-4, label="law",
        )
        more["springs"] = [
            sj.TorsionSpring(link1=links[1], link2=links[0], stiffness=0.05, freeAngle=-2.0),
            # Through its play and back, slipping both ways.
            sj.TorsionSpring(link1=links[1], link2=links[0], stiffness=0.4, freeAngle=-1.2, deadband=1e-5,
                             preload=-1e-4, frictionLimit=1e-5, frictionStiffness=2.0),
        ]
    engines(
        **more,
        links=links, normal_damping=0.02, tangential_damping=0.02,
        thermal=[
            sj.ThermalExpansionEngine(program=program, ids=[pin, slider]),
            sj.ThermalExpansionEngine(program=table, ids=[hole]),
        ],
    )
    O.dt = 3e-7


def contacts_of(interaction):
    """Return geometry and physics of each contact of a pair; in a bore of triangles there may be several."""
    if not interaction.isReal:
        return []
    geom, phys = interaction.geom, interaction.phys
    return list(zip(geom.contacts, phys.contacts)) if isinstance(geom, sj.BoreGeom) else [(geom, phys)]


def state():
    """Return every number of the scene that may differ between runs, as text that represents floats exactly."""
    out = {"iter": O.iter, "time": O.time, "energy": energies(), "bodies": [], "contacts": [], "memory": []}
    for b in O.bodies:
        s = b.state
        out["bodies"].append(
            [list(s.pos), list(s.vel), list(s.ori), list(s.angVel), list(O.forces.f(b.id, True)),
             list(O.forces.t(b.id, True)), getattr(b.shape, "thermalStrain", None)]
        )
    for i in sorted(O.interactions, key=lambda i: (i.id1, i.id2)):
        for geom, phys in contacts_of(i):
            # normal is kept as Hertz left it; the rest of the geometry follows.
            out["contacts"].append(
                [i.id1, i.id2, list(phys.normalForce), list(phys.shearForce), phys.kn,
                 phys.ks, phys.slipping, geom.penetrationDepth, list(geom.normal)]
            )
            out["memory"].append([list(point) for point in phys.slipMemory])
    for engine in O.engines:
        for spring in getattr(engine, "springs", []):
            out["contacts"].append([spring.angle, spring.moment, spring.frictionMoment, spring.slipAngle])
            # One and the same object as in ThermalLinks, not a copy.
            out["contacts"].append([spring.link2.axialForce, spring.link2.pinDamping])
        for joint in getattr(engine, "joints", []):
            out["contacts"].append([joint.slide, joint.slipPosition, joint.frictionForce, joint.stopForce])
        for functor in getattr(getattr(engine, "lawDispatcher", None), "functors", []):
            found = functor.dict()
            numbers = [found[k] for k in sorted(found) if k not in ("label", "timingDeltas")]
            out["law of bores" if isinstance(functor, sj.Law2_BoreGeom_BorePhys_JointLaw) else "law"] = numbers
        for link in getattr(engine, "links", []):
            out["contacts"].append(
                [link.axialForce, link.previousTension, list(link.tipDirection), link.temperatureChange]
            )
    return out
