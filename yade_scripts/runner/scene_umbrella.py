# SPDX-License-Identifier: GPL-3.0-or-later
"""YADE scene of ``umbrella`` cases: two links on pins of a frame, a clearance joint between them."""
from __future__ import annotations

from dataclasses import dataclass
from math import atan, atan2, ceil, hypot
from typing import Any

import numpy as np
import statejump_yade as sj
from failures import Names, pair
from scene import O, fixed_point, joint_engines, thermal_program
from states import States, Watched, dot, each, in_order, norm
from yade import wrapper

COLUMNS = (
    "time_s", "temperature_change_K", "theta2_rad", "theta4_rad", "length_ab_m", "length_bc_m",
    "centroid_ab_x_m", "centroid_ab_y_m", "centroid_bc_x_m", "centroid_bc_y_m",
    "bearing_x_m", "bearing_y_m", "journal_x_m", "journal_y_m",
    "eccentricity_x_m", "eccentricity_y_m", "penetration_depth_m", "normal_force_N",
    "tangential_force_N", "slipping", "kinetic_energy_J", "axial_energy_J", "contact_energy_J",
    "torsion_energy_J", "axial_dissipation_J", "pin_dissipation_J", "friction_dissipation_J",
    "impact_dissipation_J", "thermal_work_J",
)


@dataclass(frozen=True)
class UmbrellaScene:
    """Objects of the scene for scripts: body ids of the two link tips, links, law, program."""

    program: sj.ThermalProgram
    bearing: int  # tip of AB
    journal: int  # tip of BC
    link_ab: sj.ThermalLink
    link_bc: sj.ThermalLink
    law: sj.Law2_JointGeom_JointPhys_JointLaw
    springs: tuple[sj.TorsionSpring, ...]


def joint_law(joint: dict[str, Any]) -> sj.Law2_JointGeom_JointPhys_JointLaw:
    """Return the contact law of the [joint] section."""
    return sj.Law2_JointGeom_JointPhys_JointLaw(
        normalLaw=joint["normal_law"],
        dissipationLaw=joint["dissipation_law"],
        frictionLaw=joint["friction_law"],
        tangentialVelocity=joint["tangential_velocity"],
        restitution=joint["restitution"],
        smallestImpactSpeed=joint["smallest_impact_speed_m_per_s"],
        contactLength=joint["contact_length_m"],
        v0=joint["friction_v0_m_per_s"],
        v1=joint["friction_v1_m_per_s"],
    )


def tip(shape, link: dict[str, Any], joint: dict[str, Any], expansion: float, start, velocity) -> int:
    """Append the body at the tip of a link and return its id. A spring with a third of the rod's mass at its tip moves
    exactly like a uniform rod on a fixed pin; the tip rotates with its link."""
    body = wrapper.Body()
    body.shape = shape
    body.material = sj.ThermalFrictMat(
        young=link["young_modulus_Pa"],
        poisson=link["poisson_ratio"],
        frictionAngle=atan(joint["friction_coefficient"]),
        thermalExpansion=expansion,
    )
    body.bound = wrapper.Aabb()
    body.state.mass = link["mass_kg"] / 3
    body.state.pos = body.state.refPos = (*start, 0)
    body.state.vel = (*velocity, 0)
    body.state.blockedDOFs = "zXYZ"
    return O.bodies.append(body)


def build(case: dict[str, Any], recorders: list[wrapper.Engine]) -> UmbrellaScene:
    """Build the scene: pin A at the origin, pin C on the x axis, journal of link BC in the bearing of link AB.

    :param case: resolved case, sections and keys as in the case file; ``start`` also holds
        positions [m] and velocities [m/s] of both tips
    :param recorders: engines that read the state, run before the motion of each step
    """
    joint, start, damping = case["joint"], case["start"], case["damping"]
    program = thermal_program(case)
    bearing = tip(
        sj.Bearing(radius=joint["journal_radius_m"] + joint["radial_clearance_m"]),
        case["link_ab"], joint, joint["bearing_thermal_expansion_per_K"],
        start["bearing_m"], start["bearing_velocity_m_per_s"],
    )
    journal = tip(
        sj.Journal(radius=joint["journal_radius_m"]),
        case["link_bc"], joint, joint["journal_thermal_expansion_per_K"],
        start["journal_m"], start["journal_velocity_m_per_s"],
    )
    links = [
        sj.ThermalLink(
            id1=fixed_point((pin, 0, 0)),
            id2=end,
            youngModulus=link["young_modulus_Pa"],
            crossSectionArea=link["cross_section_area_m2"],
            stressFreeLength=link["stress_free_length_m"],
            thermalExpansion=link["thermal_expansion_per_K"],
            dampingRatio=damping["axial_damping_ratio"],
            pinDamping=damping["pin_damping_N_m_s_per_rad"],
            tipTurnsWithLink=True,
            program=program,
        )
        for pin, end, link in (
            (0.0, bearing, case["link_ab"]),
            (case["frame"]["length_m"], journal, case["link_bc"]),
        )
    ]
    springs = []
    if case["torsion_spring"]["stiffness_N_m_per_rad"] > 0:
        springs.append(
            sj.TorsionSpring(
                link1=links[0],
                link2=links[1],
                stiffness=case["torsion_spring"]["stiffness_N_m_per_rad"],
                freeAngle=case["torsion_spring"]["free_angle_rad"],
            )
        )
    law = joint_law(joint)
    O.engines = joint_engines(
        links, program, law, 0.0, verletDist=joint["journal_radius_m"], recorders=recorders,
        springs=springs,
    )
    O.trackEnergy = True
    O.dt = case["dem"]["time_step_s"]
    return UmbrellaScene(program, bearing, journal, *links, law, tuple(springs))


def watched(built: UmbrellaScene) -> Watched:
    """Return the objects to record."""
    return Watched([built.bearing, built.journal], [(built.journal, built.bearing)], [built.link_ab])


def sample(case: dict[str, Any], built: UmbrellaScene, states: States) -> list[np.ndarray]:
    """Return the columns: forces on the journal, with the tangential force positive along (-n_y, n_x)."""
    tips = (built.bearing, built.journal)
    bearing, journal = states.bodies(tips).T
    (contact,), (link,) = states.contacts([(built.journal, built.bearing)]).T, states.links([built.link_ab]).T
    joint, frame = case["joint"], case["frame"]["length_m"]
    ab, bc = bearing["position"], journal["position"] - (frame, 0, 0)
    eccentricity = journal["position"] - bearing["position"]
    change = link["temperatureChange"]
    clearance = (joint["journal_radius_m"] + joint["radial_clearance_m"]) * (
        1 + joint["bearing_thermal_expansion_per_K"] * change
    ) - joint["journal_radius_m"] * (1 + joint["journal_thermal_expansion_per_K"] * change)
    distance = each(hypot, eccentricity[:, 0], eccentricity[:, 1])
    normal = contact["normal"]
    along = np.stack([-normal[:, 1], normal[:, 0], np.zeros(len(states))], axis=1)
    return [
        states.times, change, each(atan2, ab[:, 1], ab[:, 0]), each(atan2, bc[:, 1], bc[:, 0]), norm(ab), norm(bc),
        0.5 * ab[:, 0], 0.5 * ab[:, 1], frame + 0.5 * bc[:, 0], 0.5 * bc[:, 1],
        *bearing["position"][:, :2].T, *journal["position"][:, :2].T, *eccentricity[:, :2].T,
        distance - clearance, dot(contact["normalForce"], normal),
        np.where(contact["real"] > 0, -dot(contact["shearForce"], along), 0.0), contact["slipping"],
        in_order(states.kinetic_energies(tips)),
        states.energy("linkElastic"), states.energy("jointElastic"), states.energy("torsionElastic"),
        states.energy("linkDamping"), states.energy("pinDamping"), states.energy("jointFriction"),
        states.energy("jointDamping"), states.energy("linkThermalWork", "jointThermalWork"),
    ]


def names(case: dict[str, Any], built: UmbrellaScene) -> Names:
    """Return the names of joint, links and spring; the name of the joint is that in result files."""
    found = Names({pair(built.bearing, built.journal): ("joint_b", "joint_b")})
    found.bodies.update({built.bearing: "the bearing of joint_b", built.journal: "the journal of joint_b"})
    found.add_link(built.link_ab, "link_ab")
    found.add_link(built.link_bc, "link_bc")
    for spring in built.springs:
        found.add_torsion_spring(spring, "torsion_spring")
    return found


def step_remedy(case: dict[str, Any], stable_s: float) -> str:
    """Return a remedy: the key of the case file that sets a time step of at most ``stable_s`` [s]."""
    samples = case["output"]["samples_per_cycle"]
    steps = ceil(case["period_s"] / stable_s / samples) * samples
    return f"set dem.steps_per_cycle to {steps} or more, stable in this state"


def summary(case: dict[str, Any], built: UmbrellaScene) -> dict[str, Any]:
    """Return further results of the run, as plain values."""
    contacts = built.law.contacts
    first = built.law.firstContactTime if contacts > 0 else None
    return {
        "contacts": contacts,
        "first_contact_time_s": first,
        "first_contact_temperature_change_K": None if first is None else built.program.temperatureChange(first),
    }
