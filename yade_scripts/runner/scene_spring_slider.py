# SPDX-License-Identifier: GPL-3.0-or-later
"""YADE scene of ``spring_slider`` cases: a bar with a slider at its tip, in a slot."""
from __future__ import annotations

from dataclasses import dataclass
from math import atan
from typing import Any

import numpy as np
import statejump_yade as sj
from failures import Names, SceneFailure, pair, rounded_down
from scene import O, fixed_point, joint_engines, start_sticking, thermal_program
from states import Pair, States, Watched, each, norm
from yade import wrapper

COLUMNS = (
    "time_s", "temperature_change_K", "displacement_m", "axial_force_N", "friction_force_N",
    "stop_force_N", "elastic_energy_J", "friction_dissipation_J", "damping_dissipation_J",
    "kinetic_energy_J", "thermal_work_J", "external_work_J", "contact_energy_J",
    "preload_energy_J", "slipping", "stop_contact", "floor_normal_force_N",
)


@dataclass(frozen=True)
class SpringSliderScene:
    """Objects of the scene for scripts: body ids, links, program."""

    program: sj.ThermalProgram
    slider: int
    floor: int
    stop_minus: int | None
    stop_plus: int | None
    link: sj.ThermalLink
    preload_link: sj.ThermalLink | None
    prismatic: sj.PrismaticJoint | None  # soft stops instead of faces, and friction of a joint with play
    start_height_m: float  # y of the slider at the start, where the floor carries the normal force
    start_energy_J: float  # of bar and preload at the start

    @property
    def pairs(self) -> list[Pair]:
        """Return the pairs of the slider with its floor and its rigid stops."""
        return [(self.slider, face) for face in (self.floor, self.stop_minus, self.stop_plus) if face is not None]

    @property
    def prismatic_joints(self) -> list[sj.PrismaticJoint]:
        """Return the joint for soft stops and friction with play."""
        return [self.prismatic] if self.prismatic is not None else []

    @property
    def has_play(self) -> bool:
        """Whether friction acts in a prismatic joint (with play) instead of on the floor."""
        return self.prismatic is not None and bool(self.prismatic.play > 0)

    @property
    def has_soft_stops(self) -> bool:
        """Whether the prismatic joint has the stops."""
        return self.stop_plus is None


def build(case: dict[str, Any], recorders: list[wrapper.Engine]) -> SpringSliderScene:
    """Build the scene of a bar with a slider at its tip, in a slot (1-D clearance joint).

    The bar lies along x with its root at -l0. The slider starts in equilibrium, at the centre of the slot or displaced
    by a preload force. Penetration depths carry the loads of floor and stop; the initial friction acts.

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
            frictionAngle=0 if joint["play_m"] else atan(joint["friction_coefficient"]),
            thermalExpansion=expansion,
            label=part,
        )
        for part, expansion in expansions.items()
    }
    for material in materials.values():
        O.materials.append(material)

    root = fixed_point((-link["stress_free_length_m"], 0, 0))
    depth = sj.hertz_depth(joint["normal_force_N"], radius, joint["young_modulus_Pa"], joint["poisson_ratio"])
    body = wrapper.Body()
    body.shape = sj.Slider(radius=radius)
    body.material = materials["pad"]
    body.bound = wrapper.Aabb()
    body.state.mass = dem["tip_mass_kg"]
    start = dem["start_displacement_m"]
    body.state.pos = body.state.refPos = (start, -depth, 0)
    body.state.blockedDOFs = "zXYZ"
    slider = O.bodies.append(body)
    O.forces.setPermF(slider, (-joint["preload_force_N"], -joint["normal_force_N"], 0))
    soft = joint["stop_stiffness_N_per_m"]
    floor, *stops = O.bodies.append(
        sj.slot(
            (0, 0, 0),
            stopMinus=radius + joint["clearance_minus_m"] if soft is None else None,
            stopPlus=radius + joint["clearance_plus_m"] if soft is None else None,
            halfHeight=radius,
            material=materials["slot"],
            # The same length as with stops.
            halfSize=max(radius, radius + joint["clearance_minus_m"], radius + joint["clearance_plus_m"]),
        )
    )
    stop_minus, stop_plus = stops or (None, None)
    prismatic = prismatic_joint(case, slider, depth)
    bar = sj.ThermalLink(
        id1=root,
        id2=slider,
        youngModulus=link["young_modulus_Pa"],
        crossSectionArea=link["cross_section_area_m2"],
        stressFreeLength=link["stress_free_length_m"],
        thermalExpansion=link["thermal_expansion_per_K"],
        dampingRatio=dem["link_damping_ratio"],
        program=thermal_program({**case, "thermal": case["bar_program"]}),
    )
    links, preload = [bar], None
    if joint["preload_stiffness_N_per_m"] > 0:
        # A spring to ground without expansion, with its fixed end as far away as the root.
        far = link["stress_free_length_m"]
        preload = sj.spring(
            fixed_point((far, 0, 0)), slider, joint["preload_stiffness_N_per_m"], far, program=program,
        )
        links.append(preload)
    O.engines = joint_engines(
        links,
        program,
        sj.Law2_JointGeom_JointPhys_HertzMindlin(),
        dem["contact_damping_ratio"],
        verletDist=0.1 * radius,
        recorders=recorders,
        prismatic_joints=() if prismatic is None else (prismatic,),
    )
    O.trackEnergy = True
    O.dt = dem["time_step_s"]
    start_sticking({slider: (dem["start_slide_m"], 0, 0)} if dem["start_slide_m"] else {})
    stiffness = link["young_modulus_Pa"] * link["cross_section_area_m2"] / link["stress_free_length_m"]
    return SpringSliderScene(
        program, slider, floor, stop_minus, stop_plus, bar, preload, prismatic, start_height_m=-depth,
        start_energy_J=0.5 * stiffness * start**2 + stored_by_preload(joint, start),
    )


def prismatic_joint(case: dict[str, Any], slider: int, depth_m: float) -> sj.PrismaticJoint | None:
    """Return the prismatic joint that models soft stops and friction with play; None if the case has neither."""
    joint, dem = case["joint"], case["dem"]
    stops: dict[str, float] = {}
    friction: dict[str, float] = {}
    if joint["stop_stiffness_N_per_m"] is not None:
        stops = dict(clearanceMinus=joint["clearance_minus_m"], clearancePlus=joint["clearance_plus_m"],
                     stopSpring=joint["stop_stiffness_N_per_m"])
    if joint["play_m"]:
        friction = dict(play=joint["play_m"], frictionLimit=dem["friction_limit_N"],
                        frictionStiffness=dem["friction_stiffness_N_per_m"], frictionForce=dem["start_friction_N"],
                        slipPosition=dem["start_slip_m"])
    if not stops and not friction:
        return None
    return sj.PrismaticJoint(
        id1=slider, id2=fixed_point((0, 0, 0)), axis=(1, 0, 0), offset=(0, -depth_m, 0), **stops, **friction,
        dampingRatio=dem["contact_damping_ratio"],
    )


def stored_by_preload(joint: dict[str, Any], displacement: Any) -> Any:
    """Return the energy of the preload spring [J], k_p x²/2 + P x."""
    return (0.5 * joint["preload_stiffness_N_per_m"] * displacement + joint["preload_force_N"]) * displacement


def watched(built: SpringSliderScene) -> Watched:
    """Return the objects to record."""
    return Watched([built.slider], built.pairs, [built.link], [], built.prismatic_joints)


def sample(case: dict[str, Any], built: SpringSliderScene, states: States) -> list[np.ndarray]:
    """Return the columns of the samples. Forces are those on the block (YADE stores those on the face); the axial force
    is positive in compression."""
    (slider,), (link,) = states.bodies([built.slider]).T, states.links([built.link]).T
    floor, *stops = states.contacts(built.pairs).T
    lost = floor["real"] == 0
    if lost.any():
        raise SceneFailure("the slider has left the floor of its slot: the contact is lost", "floor",
                           time_s=states.times[lost.argmax()], code="contact_lost")
    at_stop = sum(stop["real"] for stop in stops) > 0
    pushed = -sum(stop["normalForce"][:, 0] for stop in stops)
    friction, slipping = -floor["shearForce"][:, 0], floor["slipping"]
    if built.prismatic is not None:
        between = states.joints(built.prismatic_joints)
        if built.has_soft_stops:
            pushed = -between["stopForce"][:, 0]
            at_stop = pushed != 0
        if built.has_play:
            friction = -between["frictionForce"][:, 0]
            # The start is at rest, even if friction is at its limit.
            slips = (np.abs(friction) >= built.prismatic.frictionLimit) & (states.times > 0)
            slipping = np.where(slips, 1.0, 0.0)
    x, velocity = slider["position"][:, 0], slider["velocity"]
    bar = built.link
    stiffness = bar.youngModulus * bar.crossSectionArea / link["stressFreeLength"]
    return [
        states.times,
        each(built.program.temperatureChange, states.times),
        x,
        link["axialForce"],
        friction,
        np.where(at_stop, pushed, 0.0),
        0.5 * stiffness * link["extension"] ** 2,
        states.energy("jointFriction", "prismaticFriction"),
        states.energy("jointDamping", "linkDamping", "prismaticDamping"),
        0.5 * case["dem"]["tip_mass_kg"] * (velocity[:, 0] ** 2 + velocity[:, 1] ** 2),
        states.energy("linkThermalWork", "jointThermalWork"),
        -case["joint"]["normal_force_N"] * (slider["position"][:, 1] - built.start_height_m),
        states.energy("jointElastic", "prismaticElastic"),
        stored_by_preload(case["joint"], x) - built.start_energy_J,
        slipping,
        at_stop,
        norm(floor["normalForce"]),
    ]


def names(case: dict[str, Any], built: SpringSliderScene) -> Names:
    """Return the names of contacts and links; names of contacts are those in result files."""
    found = Names()
    faces = ("floor",) if built.has_soft_stops else ("floor", "stop_minus", "stop_plus")
    for contact in faces:
        found.joints[pair(built.slider, getattr(built, contact))] = (contact, contact)
        found.bodies[getattr(built, contact)] = contact
    for joint in built.prismatic_joints:
        what = ("the stops", "stop_plus") if built.has_soft_stops else ("the play", "floor")
        found.add_prismatic_joint(joint, *what)
    found.bodies[built.slider] = "the slider"
    found.add_link(built.link, "the bar")
    if built.preload_link is not None:
        found.add_link(built.preload_link, "the preload spring")
    return found


def step_remedy(case: dict[str, Any], stable_s: float) -> str:
    """Return a remedy: the key of the case file that sets a time step of at most ``stable_s`` [s]."""
    return f"set dem.time_step_s to {rounded_down(stable_s):g} or less, stable in this state"


def summary(case: dict[str, Any], built: SpringSliderScene) -> dict[str, Any]:
    """Return further results of the run, as plain values."""
    return {}
