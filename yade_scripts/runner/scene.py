# SPDX-License-Identifier: GPL-3.0-or-later
"""Code shared by the scenes of all kinds; imported by scripts that run under ``yade``."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import statejump_yade as sj
from yade import wrapper
from yade.wrapper import Omega

O = Omega()


def thermal_program(case: dict[str, Any]) -> sj.ThermalProgram:
    """Return the temperature program of a resolved case."""
    thermal = case["thermal"]
    table = {}
    if thermal["shape"] == "table":
        table = dict(
            tableTimes=thermal["table_time_s"],
            tableTemperatureChanges=thermal["table_temperature_change_K"],
        )
    else:
        table = dict(temperatureChangeMax=thermal["temperature_change_max_K"])
    return sj.ThermalProgram(
        shape=thermal["shape"], period=case["period_s"], cycles=thermal["cycles"], **table
    )


def fixed_point(position: tuple[float, float, float]) -> int:
    """Append a fixed body without shape, and return its id."""
    body = wrapper.Body()
    body.state.pos = body.state.refPos = position
    body.state.blockedDOFs = "xyzXYZ"
    return O.bodies.append(body)


def start_sticking(slides: Mapping[int, tuple[float, float, float]]) -> None:
    """Load the contacts of pads by their initial friction: each contact gets a slide, but its pad does not move.
    ``O.engines`` and ``O.dt`` must be those of the run. Without slides the function has no effect.

    :param slides: slide of each pad [m], by body
    """
    if not slides:
        return
    tracked, O.trackEnergy = O.trackEnergy, False
    for share in (0, 1):  # normal load first, then shear, because partial slip depends on the order
        for body, slide in slides.items():
            O.bodies[body].state.vel = tuple(share * way / O.dt for way in slide)
        for engine in O.engines:
            if isinstance(engine, (wrapper.InsertionSortCollider, wrapper.InteractionLoop)):
                engine()
    for body in slides:
        O.bodies[body].state.vel = (0, 0, 0)
        O.forces.f(body, True)  # sums forces: others are not reset
    O.forces.reset(resetAll=False)  # a ForceResetter does not reset in the first step
    O.trackEnergy = tracked


def joint_engines(
    links: list[sj.ThermalLink],
    program: sj.ThermalProgram | None,
    law: wrapper.LawFunctor,
    dampingRatio: float,
    verletDist: float,
    recorders: list[wrapper.Engine],
    springs: tuple[sj.TorsionSpring, ...] = (),
    expansions: list[wrapper.Engine] | None = None,
    guides: dict[int, tuple[float, float, float]] | None = None,
    prismatic_joints: tuple[sj.PrismaticJoint, ...] = (),
    beams: Sequence[sj.BeamBond] = (),
) -> list[wrapper.Engine]:
    """Return the engines of a scene of joints, links and torsion springs. Recorders read positions, temperature and
    forces that belong to the same time.

    :param expansions: ThermalExpansionEngines of the bodies; None: all of them follow ``program``
    :param guides: normals of the planes in which bodies stay, by id
    """
    if expansions is None:
        expansions = [sj.ThermalExpansionEngine(program=program)]
    bounds = [
        sj.Bo1_Journal_Aabb(),
        sj.Bo1_Bearing_Aabb(),
        sj.Bo1_Slider_Aabb(),
        sj.Bo1_SlotFace_Aabb(),
        sj.Bo1_Ball_Aabb(),
        sj.Bo1_Socket_Aabb(),
    ]
    return [
        wrapper.ForceResetter(),
        *expansions,
        wrapper.InsertionSortCollider(bounds, verletDist=verletDist),
        wrapper.InteractionLoop(
            [sj.Ig2_Journal_Bearing_JointGeom(), sj.Ig2_Slider_SlotFace_JointGeom(), sj.Ig2_Ball_Socket_JointGeom()],
            [
                sj.Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(
                    normalDampingRatio=dampingRatio, tangentialDampingRatio=dampingRatio
                )
            ],
            [law],
        ),
        sj.ThermalLinks(links=links),
        sj.TorsionSprings(springs=list(springs)),
        *([sj.PrismaticJoints(joints=list(prismatic_joints))] if prismatic_joints else []),
        *([sj.BeamBonds(bonds=list(beams))] if beams else []),
        *([sj.GuidePlanes(ids=list(guides), normals=list(guides.values()))] if guides else []),
        *recorders,
        wrapper.NewtonIntegrator(damping=0),
    ]
