# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion of a truss case: the reduced model with inertia. Masses and dashpots are those of the DEM."""
from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np

from statejump import _engine
from statejump.core import physics
from statejump.core.engine_failures import EngineFailed
from statejump.core.errors import Interrupted, NotAllowed, StatejumpError
from statejump.core.notes import Note
from statejump.core.start import FRICTIONLESS
from statejump.core.progress import OnProgress
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.check_mechanism import refuse_beams
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.masses import (
    beam_mass_kg, beam_moment_kg_m2, condensed_mass_kg, lumped_mass_kg, require_masses,
)
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussEvents, check_states, engine_items


@dataclass(frozen=True)
class TrussMotion:
    """Motion that the engine returns. ``states`` has the arrays of :class:`TrussPath`, and velocities and energies."""

    truss: ResolvedTruss
    states: dict[str, np.ndarray]
    events: TrussEvents
    event_heat_J: np.ndarray  # frictional heat of all joints in the step of each event
    watched_velocity_m_per_s: np.ndarray  # (steps + 1, 3)
    complete: bool
    time_step_s: float  # the shortest one
    steps: int
    rejected_steps: int
    inexact_steps: int
    iterations: int
    factorizations: int
    unknowns: int
    largest_contact_merit: float
    negative_dissipation_J: float
    undetermined: tuple[float, list[str]] | None  # first time [s] at which reactions are not unique, and the joints
    # First time [s] at which a slide ends without a continuation (Painlevé), and the joint.
    jammed: tuple[float, list[str]] | None
    regularised: bool = False
    equal: bool = False  # equal steps, instead of steps by tolerance

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences about times at which reactions are not unique."""
        found: list[str] = []
        inexact = {"inexact": self.inexact_steps, "steps": self.steps, "time_step_s": self.time_step_s}
        if self.inexact_steps and self.regularised:
            found.append(Note("contacts_too_stiff", **inexact))
        elif self.inexact_steps and self.equal:
            found.append(Note("steps_damped", **inexact))
        elif self.inexact_steps:
            found.append(Note("steps_inexact", **inexact))
        if self.jammed is not None:
            time_s, (joint,) = self.jammed
            found.append(Note("joint_jammed", time_s=time_s, joint=joint))
        if self.undetermined is None:
            return tuple(found)
        time_s, joints = self.undetermined
        named = ", ".join(repr(name) for name in joints)
        found.append(Note("reactions_not_unique", time_s=time_s, named=named, joints=tuple(joints)))
        return tuple(found)


def dashpots_N_s_per_m(nodes: np.ndarray, stiffness_N_per_m: np.ndarray, ratio: float, mass_kg: np.ndarray
                       ) -> np.ndarray:
    """Return the dashpot c = 2 ζ sqrt(k m) of elements between two nodes. As in the DEM, m is their reduced mass.

    :param mass_kg: mass of every node; 0 for a fixed node
    """
    inverse = np.divide(1, mass_kg, out=np.zeros_like(mass_kg), where=mass_kg > 0)
    pair = inverse[nodes].sum(axis=1)
    made: np.ndarray = 2 * ratio * np.sqrt(np.divide(stiffness_N_per_m, pair, out=np.zeros_like(pair), where=pair > 0))
    return made


def joint_dashpots_sqrt_kg(truss: ResolvedTruss, ratio: float, mass_kg: np.ndarray) -> np.ndarray:
    """Return 2 ζ sqrt(m) of the contacts of all joints, type by type. As in the DEM, m is the reduced mass of both
    bodies. The value is 0 if neither body moves.

    :param mass_kg: mass of every node; 0 for a fixed node
    """
    mass_kg = np.append(mass_kg, 0.0)  # of GROUND
    inverse = np.divide(1, mass_kg, out=np.zeros_like(mass_kg), where=mass_kg > 0)
    found = []
    for kind in _engine.truss_joints():
        joint = next(one for one in JOINTS if one.section == kind)
        joints = truss.joints[kind]
        nodes = joint.pushed_nodes(joints) if joint.has_contacts else np.zeros((len(joints.names), 0), dtype=int)
        pair = inverse[nodes].sum(axis=1)
        found.append(2 * ratio * np.sqrt(np.divide(1, pair, out=np.zeros_like(pair), where=pair > 0)))
    return np.concatenate(found)


def inertia(case: TrussCase) -> dict[str, Any]:
    """Return masses and dashpots of a case for the engine."""
    truss, links, springs = case.resolve(), case.resolve().links, case.resolve().springs
    require_masses(truss)
    lumped = lumped_mass_kg(truss)
    axial = physics.axial_stiffness_N_per_m(
        links.young_modulus_Pa, links.cross_section_area_m2, links.stress_free_length_m)
    ratio, is_lumped = case.dem_settings.link_damping_ratio, case.motion.masses == "lumped"
    return {
        "link_mass_kg": np.zeros(len(links.names)) if is_lumped else links.mass_kg,
        "node_mass_kg": lumped - condensed_mass_kg(truss) if is_lumped else truss.nodes.mass_kg,
        "link_centre": truss.bodies.centre,
        "link_moment_kg_m2": np.zeros(len(links.names)) if is_lumped else truss.bodies.moment_kg_m2,
        "link_damping_N_s_per_m": dashpots_N_s_per_m(links.nodes, axial, ratio, lumped),
        "pin_damping_N_m_s_per_rad": np.full(len(links.names), case.dem_settings.pin_damping_N_m_s_per_rad),
        "beam_mass_kg": np.zeros(len(truss.elements["beam"].names)) if is_lumped else beam_mass_kg(truss),
        "beam_moment_kg_m2": beam_moment_kg_m2(truss),
        "joint_damping_sqrt_kg": joint_dashpots_sqrt_kg(truss, case.dem_settings.contact_damping_ratio, lumped),
        "spring_damping_N_s_per_m": dashpots_N_s_per_m(springs.nodes, springs.stiffness_N_per_m, ratio, lumped),
    }


def simulate(case: TrussCase, on_progress: OnProgress = lambda share: None, watched_node: int = -1) -> TrussMotion:
    """Compute the motion of a truss through its temperature program.

    :param on_progress: called with the finished fraction, 0 to 1
    :param watched_node: index of a node whose velocity is recorded at every step
    :raises FailedRun: the start or a step has no solution; the message names joint and temperature
    :raises Interrupted: Ctrl-C was pressed; ``run`` of the error is the motion so far, or None
    """
    def going_on(share: float) -> bool:
        on_progress(share)
        return True

    truss, samples = case.resolve(), case.samples_per_cycle
    if truss.nodes.fixed[:, :truss.dimension].all():
        raise StatejumpError(code="no_free_dof", case=case.name)
    for joint in JOINTS:
        if not joint.in_motion and truss.joints[joint.section].names:
            raise StatejumpError(code="joint_not_in_motion", case=case.name,
                                 part=f"{joint.section} {truss.joints[joint.section].names[0]!r}")
    for joint in JOINTS if case.motion.start != "drawn" else ():
        unable = joint.path_refuses(truss.joints[joint.section])
        if unable is not None:
            raise NotAllowed("motion.start", case.motion.start, code="start_not_drawn", case=case.name, joint=unable[0],
                             part=f"{joint.section} {unable[0]!r}")
    if case.motion.start == "drawn" and case.start.friction == FRICTIONLESS:
        raise NotAllowed("start.friction", case.start.friction, code="start_not_stuck", case=case.name)
    regularised = case.motion.scheme == "regularised"
    if regularised:
        refuse_beams(truss, "motion.scheme = 'regularised'")
        # stable_steps uses the stable step of dem, which imports this module.
        from statejump.kinds.truss import stable_steps

        stable_steps.check(case)
    steps_per_sample = ceil(case.motion.steps_per_cycle / samples)
    try:
        found = _engine.truss_motion(
            **engine_items(truss), inertia=inertia(case), steps=steps_per_sample * samples * case.thermal.cycles,
            sample_every=steps_per_sample, theta=case.motion.theta,
            displacement_tolerance_m=case.motion.displacement_tolerance_m or 0.0, restitution=case.motion.restitution,
            watched_node=watched_node, drives=_drives(truss), start_drawn=case.motion.start == "drawn",
            start_friction=truss.start_friction,
            friction_law=case.dem_settings.friction_law if regularised else "", progress=going_on,
        )
    except _engine.EngineFailure as failure:
        if failure.item and failure.allowed:
            raise NotAllowed(str(failure.key), failure.value, code="rejected_by_engine", item=failure.item,
                             case=truss.name, needed=failure.allowed) from None
        raise EngineFailed(failure, remedy=_remedy(case, failure), case=truss.name, place=truss.name) from None
    events = TrussEvents(truss, **found.pop("events"))
    if not found["complete"] and len(found["states"].get("time_s", ())) < 2:
        raise Interrupted(code="interrupted_before_sample")
    check_states(truss, found["states"])
    made = TrussMotion(truss=truss, events=events, regularised=regularised,
                       equal=case.motion.displacement_tolerance_m is None, **found)
    if not made.complete:
        raise Interrupted(run=made)
    return made


def _drives(truss: ResolvedTruss) -> list[dict[str, Any]]:
    drives = truss.drives
    return [{"name": name, "link": int(link), "time_s": time, "angular_velocity_rad_per_s": speed}
            for name, link, time, speed in zip(drives.names, drives.link, drives.time_s,
                                               drives.angular_velocity_rad_per_s)]


def _remedy(case: TrussCase, failure: _engine.EngineFailure) -> str | None:
    if str(failure.kind).endswith("mechanism"):
        return "a mechanism moves from where it is drawn with motion.start = 'drawn'"
    equal = case.motion.displacement_tolerance_m is None  # with a tolerance, steps are already limited by it
    unfound = failure.kind in ("not_converged", "singular", "too_many_steps")
    stepped = equal and unfound and "no step" in str(failure.message)
    return "set motion.steps_per_cycle to more" if stepped else None
