"""YADE scenes of case files. Imported by scripts that run under ``yade``."""
from __future__ import annotations

from dataclasses import dataclass
from math import atan, sqrt
from typing import Any

import statejump_yade as sj
from yade import wrapper
from yade.wrapper import Omega

O = Omega()


@dataclass(frozen=True)
class SpringSliderScene:
    """What a script reads from the scene of a ``spring_slider`` case: body ids, links, program."""

    program: sj.ThermalProgram
    slider: int
    floor: int
    stop_minus: int
    stop_plus: int
    link: sj.ThermalLink
    preload_link: sj.ThermalLink | None
    start_height_m: float  # y of the slider at the start, where the floor carries the normal force


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
        shape=thermal["shape"], period=case["dem"]["period_s"], cycles=thermal["cycles"], **table
    )


def fixed_point(position: tuple[float, float, float]) -> int:
    """Append a body without shape that nothing moves, and return its id."""
    body = wrapper.Body()
    body.state.pos = body.state.refPos = position
    body.state.blockedDOFs = "xyzXYZ"
    return O.bodies.append(body)


def joint_engines(
    links: list[sj.ThermalLink],
    program: sj.ThermalProgram,
    dampingRatio: float,
    verletDist: float,
    recorders: list[wrapper.Engine],
) -> list[wrapper.Engine]:
    """Return the engines of any scene of joints and links. Recorders see a state of one time:
    positions, temperature and forces of the current step."""
    bounds = [
        sj.Bo1_Journal_Aabb(),
        sj.Bo1_Bearing_Aabb(),
        sj.Bo1_Slider_Aabb(),
        sj.Bo1_SlotFace_Aabb(),
    ]
    return [
        wrapper.ForceResetter(),
        sj.ThermalExpansionEngine(program=program),
        wrapper.InsertionSortCollider(bounds, verletDist=verletDist),
        wrapper.InteractionLoop(
            [sj.Ig2_Journal_Bearing_JointGeom(), sj.Ig2_Slider_SlotFace_JointGeom()],
            [
                sj.Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(
                    normalDampingRatio=dampingRatio, tangentialDampingRatio=dampingRatio
                )
            ],
            [sj.Law2_JointGeom_JointPhys_HertzMindlin()],
        ),
        sj.ThermalLinks(links=links),
        *recorders,
        wrapper.NewtonIntegrator(damping=0),
    ]


def spring_slider(case: dict[str, Any], recorders: list[wrapper.Engine]) -> SpringSliderScene:
    """Build the scene of a bar with a slider at its tip, in a slot (1-D clearance joint).

    The bar lies along x with its root at -l0, the slider starts at the slot's centre, pressed on
    the floor by the normal force at the depth at which the floor carries it.

    :param case: resolved case, sections and keys as in the case file
    :param recorders: engines that read the state, run before the motion of each step
    """
    link, joint, dem = case["link"], case["joint"], case["dem"]
    program = thermal_program(case)
    radius = joint["pad_radius_m"]
    expansions = {"pad": joint["pad_thermal_expansion_per_K"], "slot": joint["slot_thermal_expansion_per_K"]}
    materials = {
        part: sj.ThermalFrictMat(
            young=joint["young_modulus_Pa"],
            poisson=joint["poisson_ratio"],
            frictionAngle=atan(joint["friction_coefficient"]),
            thermalExpansion=expansion,
            label=part,
        )
        for part, expansion in expansions.items()
    }
    for material in materials.values():
        O.materials.append(material)

    root = fixed_point((-link["stress_free_length_m"], 0, 0))
    effective_modulus = joint["young_modulus_Pa"] / (2 * (1 - joint["poisson_ratio"] ** 2))
    depth = (joint["normal_force_N"] / (4 / 3 * effective_modulus * sqrt(radius))) ** (2 / 3)
    body = wrapper.Body()
    body.shape = sj.Slider(radius=radius)
    body.material = materials["pad"]
    body.bound = wrapper.Aabb()
    body.state.mass = dem["tip_mass_kg"]
    body.state.pos = body.state.refPos = (0, -depth, 0)
    body.state.blockedDOFs = "zXYZ"
    slider = O.bodies.append(body)
    O.forces.setPermF(slider, (0, -joint["normal_force_N"], 0))
    floor, stop_minus, stop_plus = O.bodies.append(
        sj.slot(
            (0, 0, 0),
            stopMinus=radius + joint["clearance_minus_m"],
            stopPlus=radius + joint["clearance_plus_m"],
            halfHeight=radius,
            material=materials["slot"],
        )
    )
    bar = sj.ThermalLink(
        id1=root,
        id2=slider,
        youngModulus=link["young_modulus_Pa"],
        crossSectionArea=link["cross_section_area_m2"],
        stressFreeLength=link["stress_free_length_m"],
        thermalExpansion=link["thermal_expansion_per_K"],
        dampingRatio=dem["link_damping_ratio"],
        program=program,
    )
    links, preload = [bar], None
    if joint["preload_stiffness_N_per_m"] > 0:
        # A spring to ground that does not expand, with its far end as far away as the root.
        far = link["stress_free_length_m"]
        preload = sj.ThermalLink(
            id1=fixed_point((far, 0, 0)),
            id2=slider,
            youngModulus=joint["preload_stiffness_N_per_m"],
            crossSectionArea=far,
            stressFreeLength=far,
            program=program,
        )
        links.append(preload)
    O.engines = joint_engines(
        links, program, dem["contact_damping_ratio"], verletDist=0.1 * radius, recorders=recorders
    )
    O.trackEnergy = True
    O.dt = dem["time_step_s"]
    return SpringSliderScene(
        program, slider, floor, stop_minus, stop_plus, bar, preload, start_height_m=-depth
    )
