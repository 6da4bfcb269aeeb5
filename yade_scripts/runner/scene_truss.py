# SPDX-License-Identifier: GPL-3.0-or-later
"""YADE scene of ``truss`` cases: nodes are bodies, bars are links, joints are contacts (``truss_joints``).

``statejump/kinds/truss/dem.py`` rejects cases that the DEM cannot represent, and documents how masses are lumped.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import statejump_yade as sj
from failures import Names, SceneFailure, rounded_down
from scene import O, joint_engines, start_sticking
from states import Pair, States, Watched, dot, each, in_order
from truss_joints import JOINTS
from truss_joints.parts import Joints, Row, rows
from truss_joints.torsion import torsion_spring
from yade import wrapper
from yade.minieigenHP import Quaternion, Vector3

PLAIN = (
    "time_s", "temperature_change_K", "elastic_energy_J", "kinetic_energy_J", "friction_dissipation_J",
    "damping_dissipation_J", "thermal_work_J", "external_work_J",
)


# Columns of beams, by attribute of BeamBond.
BEAM_COLUMNS = {
    "beam_force_first_N": "force1", "beam_moment_first_N_m": "moment1",
    "beam_force_second_N": "force2", "beam_moment_second_N_m": "moment2",
}


@dataclass
class TrussScene:
    """Objects of the scene for scripts: bodies by node, links, springs, joints."""

    program: sj.ThermalProgram
    nodes: list[int]
    links: list[sj.ThermalLink]
    springs: list[sj.ThermalLink]
    joints: list[Joints] = field(default_factory=list)  # of every type
    free: list[int] = field(default_factory=list)  # nodes that move
    loaded: list[int] = field(default_factory=list)  # nodes with a dead load
    twisted: list[int] = field(default_factory=list)  # nodes with a moment
    start: list[Vector3] = field(default_factory=list)
    pairs: list[Pair] = field(default_factory=list)  # bodies that may touch
    torsion_springs: list[sj.TorsionSpring] = field(default_factory=list)
    beams: list[sj.BeamBond] = field(default_factory=list)
    rotating: list[int] = field(default_factory=list)  # nodes whose bodies rotate


def columns(case: dict[str, Any]) -> list[str]:
    """Return the names of the columns of a case."""

    def of(section: str, name: str, vector: bool = False) -> list[str]:
        ends = (".x", ".y", ".z") if vector else ("",)
        return [f"{name}[{item}]{end}" for item in case[section]["names"] for end in ends]

    return [
        *PLAIN, *of("node", "displacement_m", True), *(of("node", "rotation_rad", True) if _rotate(case) else ()),
        *of("link", "axial_force_N"), *of("spring", "tension_N"),
        *(name for column in BEAM_COLUMNS for name in of("beam", column, True)),
        *(name for joints in JOINTS for column, vector in joints.columns
          for name in of(joints.section, column, vector)),
    ]


def _rotate(case: dict[str, Any]) -> bool:
    """Return whether nodes rotate."""
    return any(case["node"]["rotates"])


class Programs:
    """Temperature programs in YADE, one for each program and each fraction of its temperatures."""

    def __init__(self, case: dict[str, Any]) -> None:
        self._case = case["programs"]
        self._made: dict[tuple[int, float], sj.ThermalProgram] = {}

    def of(self, number: int, fraction: float) -> sj.ThermalProgram:
        """Return a program with its temperatures multiplied by a fraction."""
        if (number, fraction) not in self._made:
            given = self._case[number]
            if given["shape"] == "table":
                shape = dict(
                    tableTimes=given["table_time_s"],
                    tableTemperatureChanges=[fraction * change for change in given["table_temperature_change_K"]],
                )
            else:
                shape = dict(temperatureChangeMax=fraction * given["temperature_change_max_K"])
            self._made[number, fraction] = sj.ThermalProgram(
                shape=given["shape"], period=given["period_s"], cycles=given["cycles"], **shape
            )
        return self._made[number, fraction]


def build(case: dict[str, Any], recorders: list[wrapper.Engine]) -> TrussScene:
    """Build the scene in the initial equilibrium of the quasi-static path.

    :param case: result of ``statejump.kinds.truss.dem.resolved``
    :param recorders: engines that read the state, run before the motion of each step
    """
    dem = case["dem"]
    programs = Programs(case)
    nodes, links = rows(case["node"]), rows(case["link"])
    bodies = []
    for node in nodes:
        body = wrapper.Body()
        body.state.mass = node["mass_kg"]
        body.state.pos = body.state.refPos = node["start_m"]
        blocked = "".join(axis for axis, held in zip("xyz", node["blocked"]) if held)
        turns = node["free_rotation"]
        body.state.blockedDOFs = blocked + "".join(axis for axis, free in zip("XYZ", turns) if not free)
        if node["rotates"]:
            body.state.inertia = (node["rotary_inertia_kg_m2"],) * 3
            body.state.ori = rotated(Vector3(node["start_rad"]))
        bodies.append(body)

    turning: dict[int, set[int]] = {}  # nodes whose bodies rotate with a link, by link
    parts_of: dict[tuple[int, float], list[int]] = {}

    def turn(link: int, node: int) -> None:
        turning.setdefault(link, set()).add(node)

    def expand(node: int, joint: Row) -> None:
        parts_of.setdefault((joint["program"], joint["temperature_fraction"]), []).append(node)

    made = [joints(case) for joints in JOINTS if case[joints.section]["names"]]
    for joints in made:
        joints.furnish(bodies, turn, expand)
    ids = [O.bodies.append(body) for body in bodies]
    common = programs.of(0, 1.0)
    scene = TrussScene(common, ids, [], [], joints=made)
    for joints in made:
        scene.pairs.extend(joints.append(ids))
    for place, node in enumerate(nodes):
        scene.start.append(Vector3(node["start_m"]))
        if not all(node["blocked"]):
            scene.free.append(place)
        if any(node["force_N"]):
            O.forces.setPermF(ids[place], Vector3(node["force_N"]))
            scene.loaded.append(place)
        if any(node["free_rotation"]):
            scene.rotating.append(place)
        if any(node["moment_N_m"]):
            O.forces.setPermT(ids[place], Vector3(node["moment_N_m"]))
            scene.twisted.append(place)

    carriers = []  # links without stiffness that rotate the root of a link, for links whose tip another link rotates
    for place, link in enumerate(links):
        ends = [int(node) for node in link["nodes"]]
        turned = turning.get(place, set())
        if ends[0] in turned and ends[1] not in turned:
            ends.reverse()  # a ThermalLink rotates its tip
        program = programs.of(link["program"], link["temperature_fraction"])
        scene.links.append(sj.ThermalLink(
            id1=ids[ends[0]], id2=ids[ends[1]], youngModulus=link["young_modulus_Pa"],
            crossSectionArea=link["cross_section_area_m2"], stressFreeLength=link["stress_free_length_m"],
            thermalExpansion=link["thermal_expansion_per_K"], dampingRatio=dem["link_damping_ratio"],
            pinDamping=dem["pin_damping_N_m_s_per_rad"], tipTurnsWithLink=ends[1] in turned, program=program,
        ))
        if ends[0] in turned:
            carriers.append(sj.ThermalLink(
                id1=ids[ends[1]], id2=ids[ends[0]], stressFreeLength=link["stress_free_length_m"],
                tipTurnsWithLink=True, program=program,
            ))
    for spring in rows(case["spring"]):
        scene.springs.append(sj.spring(
            ids[spring["nodes"][0]], ids[spring["nodes"][1]], spring["stiffness_N_per_m"], spring["free_length_m"],
            dampingRatio=dem["link_damping_ratio"], program=common, tensionOnly=spring["cable"],
        ))
    scene.beams = [beam_bond(beam, ids, programs, dem["link_damping_ratio"]) for beam in rows(case["beam"])]
    for spring in rows(case["torsion_spring"]):
        scene.torsion_springs.append(torsion_spring(spring, spring["bias_rad"], nodes, links, ids))
    expansions = [
        sj.ThermalExpansionEngine(program=programs.of(*key), ids=sorted({ids[node] for node in parts}))
        for key, parts in parts_of.items()
    ]
    radii = [radius for joints in made for radius in joints.radii()]
    named = dem["friction_law"] != "mindlin"  # the default law is a compiled combination
    law = (sj.Law2_JointGeom_JointPhys_JointLaw(frictionLaw=dem["friction_law"]) if named
           else sj.Law2_JointGeom_JointPhys_HertzMindlin())
    O.engines = joint_engines(
        scene.links + carriers + scene.springs, None, law,
        dem["contact_damping_ratio"], verletDist=0.1 * min(radii, default=1.0), recorders=recorders,
        springs=(*scene.torsion_springs, *(spring for joints in made for spring in joints.torsion_springs())),
        expansions=expansions,
        prismatic_joints=tuple(one for joints in made for one in joints.prismatic_joints()), beams=scene.beams,
        guides={
            ids[place]: node["guide_normal"] for place, node in enumerate(nodes)
            if any(node["guide_normal"]) and not all(node["blocked"])
        },
    )
    O.trackEnergy = True
    O.dt = dem["time_step_s"]
    start_sticking({body: slide for joints in made for body, slide in joints.start_slides().items()})
    return scene


def rotated(vector: Vector3) -> Quaternion:
    """Return the orientation of a rotation vector [rad]."""
    angle = vector.norm()
    return Quaternion(vector / angle, angle) if angle else Quaternion.Identity


def beam_bond(beam: Row, ids: list[int], programs: Programs, damping_ratio: float) -> sj.BeamBond:
    """Return the bond of a beam of the case."""
    young, shear = beam["young_modulus_Pa"], beam["shear_modulus_Pa"] * beam["cross_section_area_m2"]
    about_y, about_z = beam["second_moments_of_area_m4"]
    along_y, along_z = beam["shear_factors"]
    released = ["".join(letter for letter, is_free in zip("xXYZ", beam[f"released_{end}"]) if is_free)
                for end in ("first", "second")]
    bends = any(beam["gradient_per_m"])
    return sj.BeamBond(
        id1=ids[beam["nodes"][0]], id2=ids[beam["nodes"][1]], axisX=Vector3(beam["axis_x"]),
        axisY=Vector3(beam["axis_y"]), axialStiffness=young * beam["cross_section_area_m2"],
        torsionalStiffness=beam["shear_modulus_Pa"] * beam["torsion_constant_m4"], bendingStiffnessY=young * about_y,
        bendingStiffnessZ=young * about_z, shearStiffnessY=along_y * shear, shearStiffnessZ=along_z * shear,
        stressFreeLength=beam["stress_free_length_m"], thermalExpansion=beam["thermal_expansion_per_K"],
        gradientY=beam["gradient_per_m"][0], gradientZ=beam["gradient_per_m"][1], dampingRatio=damping_ratio,
        offset1=Vector3(beam["offset_first_m"]), offset2=Vector3(beam["offset_second_m"]), released1=released[0],
        released2=released[1], program=programs.of(beam["program"], beam["temperature_fraction"]),
        gradientProgram=programs.of(beam["gradient_program"], 1.0) if bends else None,
    )


def watched(built: TrussScene) -> Watched:
    """Return the objects to record."""
    return Watched(
        built.nodes, built.pairs, built.links + built.springs,
        [spring for joints in built.joints for spring in joints.torsion_springs()],
        [joint for joints in built.joints for joint in joints.prismatic_joints()],
        built.beams, [built.nodes[node] for node in built.rotating],
    )


def sample(case: dict[str, Any], built: TrussScene, states: States) -> list[np.ndarray]:
    """Return the columns of all samples, see :func:`columns`; groups of columns are arrays (sample, item)."""
    faults = [*_strangers(case, built, states), *(fault for joints in built.joints for fault in joints.faults(states))]
    if faults:
        raise min(faults, key=lambda fault: fault.time_s)
    positions = states.bodies(built.nodes)["position"]
    loads = np.array([case["node"]["force_N"][node] for node in built.loaded]).reshape(-1, 3)
    turning = [built.nodes[node] for node in built.rotating]
    moments = np.array([case["node"]["moment_N_m"][node] for node in built.twisted]).reshape(-1, 3)
    rotation = np.zeros_like(positions)
    rotation[:] = case["node"]["start_rad"]
    rotation[:, built.rotating] = states.rotations(turning)["rotation"]
    starts = np.array([built.start[node] for node in built.loaded]).reshape(-1, 3)
    found = [
        states.times, each(built.program.temperatureChange, states.times),
        states.energy("linkElastic", "torsionElastic", "jointElastic", "prismaticElastic", "beamElastic"),
        in_order(np.concatenate((states.kinetic_energies([built.nodes[node] for node in built.free]),
                                 states.rotary_energies(turning)), axis=1)),
        states.energy("jointFriction", "torsionFriction", "prismaticFriction"),
        states.energy("linkDamping", "pinDamping", "jointDamping", "prismaticDamping", "beamDamping"),
        states.energy("linkThermalWork", "jointThermalWork", "beamThermalWork"),
        in_order(np.concatenate((dot(loads, positions[:, built.loaded] - starts), dot(
            moments, rotation[:, built.twisted] - np.array(case["node"]["start_rad"])[built.twisted])), axis=1)),
        (positions - np.array(case["node"]["position_m"])).reshape(len(states), -1),
        *([rotation.reshape(len(states), -1)] if _rotate(case) else []),
        states.links(built.links)["axialForce"], -states.links(built.springs)["axialForce"],
        *(states.beams(built.beams)[key].reshape(len(states), -1) for key in BEAM_COLUMNS.values() if built.beams),
    ]
    for joints in built.joints:
        found += [values.reshape(len(states), -1) for values in joints.states(states)]
    return found


def _bodies(case: dict[str, Any], built: TrussScene) -> dict[int, str]:
    """Return texts for all bodies that may touch."""
    found = {body: f"node {name!r}" for body, name in zip(built.nodes, case["node"]["names"])}
    found.update({face: words for joints in built.joints for face, (_, words) in joints.faces().items()})
    return found


def _strangers(case: dict[str, Any], built: TrussScene, states: States) -> Iterator[SceneFailure]:
    """Yield a failure for the first two bodies in contact that the case does not pair."""
    strangers = states.strangers()
    touching = strangers[:, 0] >= 0
    if not touching.any():
        return
    words = _bodies(case, built)
    owner = {face: name for joints in built.joints for face, (name, _) in joints.faces().items()}
    first = touching.argmax()
    one, other = strangers[first].tolist()
    yield SceneFailure(
        f"{words[one]} and {words[other]} touch and are of different joints: the model has no such contact",
        owner.get(one, owner.get(other, "")), time_s=states.times[first], code="foreign_contact",
    )


def names(case: dict[str, Any], built: TrussScene) -> Names:
    """Return the names of joints, links, springs and bodies of the case."""
    words = _bodies(case, built)
    found = Names(bodies=words)
    for joints in built.joints:
        joints.name(found)
    for section, made in (("link", built.links), ("spring", built.springs)):
        for name, link in zip(case[section]["names"], made):
            found.add_link(link, f"{section} {name!r}")
    for name, beam in zip(case["beam"]["names"], built.beams):
        found.add_beam(beam, f"beam {name!r}")
    for name, spring in zip(case["torsion_spring"]["names"], built.torsion_springs):
        found.add_torsion_spring(spring, f"torsion_spring {name!r}")
    return found


def step_remedy(case: dict[str, Any], stable_s: float) -> str:
    """Return a remedy: the key of the case file that sets a time step of at most ``stable_s`` [s]."""
    fraction = case["dem"]["time_step_fraction"] * stable_s / case["dem"]["time_step_s"]
    return f"set dem.time_step_fraction to {rounded_down(fraction):g} or less, stable in this state"


def summary(case: dict[str, Any], built: TrussScene) -> dict[str, Any]:
    """Return further results of the run, as plain values."""
    return {"joints": sum(len(joints.rows) for joints in built.joints), "nodes": len(built.nodes)}
