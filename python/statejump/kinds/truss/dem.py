# SPDX-License-Identifier: GPL-3.0-or-later
"""Input of the YADE script for a truss: bodies, masses, contact groups, time step, loaded start.

Nodes are bodies with lumped masses, see :mod:`~statejump.kinds.truss.masses`. A slider is a pad on a floor; the
supports of its node hold the pad at the depth at which the floor carries the normal force. The friction limit therefore
equals that of the quasi-static model, whatever other loads the supports carry.
"""
from __future__ import annotations

from collections.abc import Callable
from math import ceil, inf, pi
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from statejump import _engine
from statejump.core import physics, thermal, yade_process
from statejump.core.engine_failures import EngineFailed
from statejump.core.errors import StatejumpError
from statejump.core.progress import OnProgress
from statejump.core.run import Run
from statejump.kinds.truss import dem_beams
from statejump.kinds.truss.arrays import GROUND, SAME_DIRECTION
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.check_mechanism import check_at_rest
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.protocol import Torsion
from statejump.kinds.truss.masses import blocked_directions, lumped_mass_kg
from statejump.kinds.truss.motion import simulate
from statejump.kinds.truss.resolved import Course, ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, solve
from statejump.schema.paths import with_values

CONTACT_GROUPS = 30  # bits of a body's mask in YADE that are free to use

PATH_SHARE = 0.1  # fraction of the progress of a DEM run that is reported for its path


REMEDY = "'statejump reduced' can run the case"


def refuse(case: TrussCase, code: str, why: str, **fields: Any) -> StatejumpError:
    """Return the error for an item that the DEM cannot represent."""
    return StatejumpError(code=code, cause=why, remedy=REMEDY, case=case.name, **fields)


def stable_time_step(case: TrussCase, path: Course) -> float:
    """Return a stable time step [s] for the largest forces of the quasi-static path.

    The squared elongation of a spring with m moving ends is at most m (u₁² + u₂²). For each body, let k be the sum of m
    times stiffness over all its springs, divided by the mass of the body, and c the same sum for dashpots. The largest
    eigenvalue is at most the largest k. The stable step of an oscillator with unit mass, k and c, the smallest of all
    bodies, is thus stable for the truss.
    """
    truss, mass = path.truss, lumped_mass_kg(path.truss)
    mass = np.append(mass, 0)  # of GROUND
    inverse = np.divide(1, mass, out=np.zeros_like(mass), where=mass > 0)
    stiffness, damping = np.zeros(len(mass)), np.zeros(len(mass))

    def touch(nodes: np.ndarray, k: np.ndarray, ratio: float, extra: Any = 0.0) -> None:
        pair, moving = inverse[nodes].sum(axis=1), (inverse[nodes] > 0).sum(axis=1)
        dashpot = 2 * ratio * np.sqrt(np.divide(k, pair, out=np.zeros_like(k), where=pair > 0)) + extra
        for side in range(nodes.shape[1]):
            np.add.at(stiffness, nodes[:, side], moving * k * inverse[nodes[:, side]])
            np.add.at(damping, nodes[:, side], moving * dashpot * inverse[nodes[:, side]])

    links, torsion = truss.links, _torsion(truss)
    ratio, contact = case.dem_settings.link_damping_ratio, case.dem_settings.contact_damping_ratio
    ranges = path.truss.temperature_ranges_K[links.program] * links.temperature_fraction[:, None]
    shortest = links.stress_free_length_m * (1 + links.thermal_expansion_per_K[:, None] * ranges).T.min(axis=0)
    axial = physics.axial_stiffness_N_per_m(links.young_modulus_Pa, links.cross_section_area_m2, shortest)
    touch(links.nodes, axial, ratio, case.dem_settings.pin_damping_N_m_s_per_rad / shortest**2)
    for element in ELEMENTS:
        elements = truss.elements[element.section]
        if not element.bends:
            touch(element.ends(elements), element.stiffness_N_per_m(elements), ratio)
    for ends, moment in zip(torsion.links, torsion.stiffness_N_m_per_rad):
        # The angle depends on all ends of both links, so m is their number of moving ends.
        turned = ends[ends != GROUND]
        moving = (inverse[links.nodes[turned]] > 0).sum()
        for link in turned:
            for node in links.nodes[link]:
                stiffness[node] += moving * moment / shortest[link] ** 2 * inverse[node]
    for joint in JOINTS:
        if len(truss.joints[joint.section].names):
            touch(*joint.contact_stiffness(path, truss.joints[joint.section]), contact)
    if truss.elements["beam"].names:
        return dem_beams.stable_time_step_s(stiffness, damping, dem_beams.rates(truss, path, ratio))
    return float(np.min(_engine.critical_time_step_s(1.0, stiffness, damping), initial=inf))


def number_of_steps(case: TrussCase, path: Course) -> int:
    """Return the number of time steps, a multiple of the number of samples, so that the last sample is at the end."""
    wanted = case.dem_settings.time_step_fraction * stable_time_step(case, path)
    return ceil(case.period_s / wanted / case.samples_per_cycle) * case.samples_per_cycle * case.thermal.cycles


def _contact_groups(truss: ResolvedTruss, case: TrussCase, reach_m: np.ndarray) -> np.ndarray:
    """Return a group number for each contact, type by type; -1 if its bodies do not touch. Nearby joints have different
    ones.

    YADE searches for contacts between all near bodies, but only bodies of the same joint may touch.
    """
    own = np.concatenate([joint.bodies_touch(truss.joints[joint.section]) for joint in JOINTS])
    touching = [nodes for joint in JOINTS for nodes in joint.contact_nodes(truss.joints[joint.section]).tolist()]
    touching = [touching[place] for place in np.flatnonzero(own)]
    reach_m = reach_m[own]
    where = truss.nodes.position_m[[nodes[0] for nodes in touching]]
    owner = np.arange(len(where))
    # Journals in one bearing form one group, as do bearings around one journal.
    seen: dict[int, int] = {}
    for place, nodes in enumerate(touching):
        known = {owner[seen[node]] for node in nodes if node in seen}
        for other in known:
            owner[owner == other] = place
        owner[place] = place
        seen.update(dict.fromkeys(nodes, place))
    found = np.full(len(own), -1)
    if not len(where):
        return found
    group = found[own]
    tree = cKDTree(where)
    # Boxes of YADE's collider are cubes. On each side they exceed the parts by a tenth of the smallest radius.
    near = tree.query_ball_point(where, 2.3 * reach_m.max(), p=inf)
    for place, others in enumerate(near):
        if group[place] >= 0:
            continue
        members = np.flatnonzero(owner == owner[place])
        taken = {group[other] for member in members for other in near[member] if other not in members}
        free = next((number for number in range(CONTACT_GROUPS) if number not in taken), None)
        if free is None:
            name = [name for joint in JOINTS if len(joint.contact_nodes(truss.joints[joint.section]))
                    for name in truss.joints[joint.section].names][np.flatnonzero(own)[place]]
            raise refuse(case, "dem_joints_too_close", f"joint {name!r} is within reach of more than {CONTACT_GROUPS} "
                               "other joints, the DEM cannot keep their contacts apart", joint=name)
        group[members] = free
    found[own] = group
    return found


def check(case: TrussCase) -> None:
    """Raise StatejumpError, before anything is solved, if the DEM cannot represent an item of the case."""
    truss = case.resolve()
    check_at_rest(truss)
    for index in np.flatnonzero(truss.bodies.own)[:1]:
        raise refuse(case, "dem_body", f"link {truss.links.names[index]!r} is a body of its own, the DEM has rods")
    for name in truss.means.names[:1]:
        raise refuse(case, "dem_constraint", f"mean {name!r} constrains displacements, the DEM has no such item")
    for name in truss.constraints.names[:1]:
        raise refuse(case, "dem_constraint", f"constraint {name!r} constrains displacements, the DEM has no such item")
    mass = lumped_mass_kg(truss)
    nodes = truss.nodes
    for joint in JOINTS:
        joints = truss.joints[joint.section]
        unable = joint.dem_refuses(joints)
        if joint.not_in_dem and joints.names:
            unable = joints.names[0], joint.not_in_dem
        if joint.has_contacts and case.dem_settings.friction_law != "mindlin":
            for index in np.flatnonzero(~joint.bodies_touch(joints))[:1]:
                unable = joints.names[index], ("touches no body in the DEM, its friction is a spring that slips, not "
                                               f"dem.friction_law = {case.dem_settings.friction_law!r}")
        if unable is not None:
            name, why = unable
            raise refuse(case, "dem_joint", f"{joint.section} {name!r} {why}", joint=name)
    for element in ELEMENTS:
        elements = truss.elements[element.section]
        unable_element = element.dem_refuses(elements)
        if element.not_in_dem and elements.names:
            unable_element = elements.names[0], "dem_element", element.not_in_dem
        if unable_element is not None:
            name, code, why = unable_element
            raise refuse(case, code, f"{element.section} {name!r} {why}")
    free = ~blocked_directions(truss).all(axis=1)
    for index in np.flatnonzero(free & (mass <= 0))[:1]:
        raise refuse(case, "dem_node_without_mass", f"node {nodes.names[index]!r} has no mass because no link ends "
                     "there, the DEM needs one", nodes=(nodes.names[index],))
    roles: dict[int, tuple[Any, ...]] = {}
    for joint in JOINTS:
        names = truss.joints[joint.section].names
        for part in joint.contact_parts(truss.joints[joint.section]):
            for name, node, role in zip(names, map(int, part.nodes), part.roles):
                if node == GROUND:
                    continue
                if node in roles and (roles[node] != role or not part.shared):
                    raise refuse(case, "dem_second_contact", f"{joint.section} {name!r} gives node "
                                       f"{nodes.names[node]!r} a second contact part, in the DEM a node has one",
                                 joint=name, nodes=(nodes.names[node],))
                roles[node] = role
    _refuse_rotation(case, dem_beams.refused(truss, set(roles)))
    if truss.dimension == 3:
        _refuse_tilted_torsion(case, truss)


def _refuse_rotation(case: TrussCase, found: tuple[str, str] | None) -> None:
    if found is not None:
        node, why = found
        raise refuse(case, "dem_rotation", f"node {node!r} {why}", nodes=(node,))


def _torsion(truss: ResolvedTruss) -> Torsion:
    """Return the torsional stiffnesses of all elements and joints between links. Their names contain their sections."""
    parts = [(element.section, element.torsion(truss.elements[element.section])) for element in ELEMENTS]
    parts += [(joint.section, joint.torsion(truss.joints[joint.section])) for joint in JOINTS]
    return Torsion(
        tuple(f"{section} {name!r}" for section, part in parts for name in part.names),
        *(np.concatenate([getattr(part, key) for _, part in parts])
          for key in ("links", "axis", "stiffness_N_m_per_rad")),
    )


def _refuse_tilted_torsion(case: TrussCase, truss: ResolvedTruss) -> None:
    """Refuse a torsion spring with a link that is not normal to its axis, because DEM and solver then differ in the
    angle."""
    torsion, links, position = _torsion(truss), truss.links, truss.nodes.position_m
    for name, ends, axis in zip(torsion.names, torsion.links, torsion.axis):
        for link in ends[ends != GROUND]:
            start, end = position[links.nodes[link]]
            if abs((end - start) @ axis) > SAME_DIRECTION * np.linalg.norm(end - start):
                raise refuse(case, "dem_torsion_out_of_plane", f"{name} has link {links.names[link]!r} that is "
                                   "not across its axis, the DEM has torsion springs in a plane only")


def _refuse_far_turns(case: TrussCase, path: Course) -> None:
    """Refuse a joint that rotates by more than π/2; the DEM cannot distinguish such an angle from its opposite."""
    for joint in JOINTS:
        joints = path.truss.joints[joint.section]
        turned = joint.largest_turn_rad(path, joints) if joints.names else np.zeros(0)
        for index in np.flatnonzero(turned > pi / 2)[:1]:
            raise refuse(case, "dem_large_rotation", f"{joint.section} {joints.names[index]!r} rotates by "
                               f"{turned[index]:.3g} rad, the DEM cannot distinguish more than π/2 from its opposite",
                               joint=joints.names[index])


def _programs(truss: ResolvedTruss) -> list[dict[str, Any]]:
    return [{**thermal.parameters(program, program.period_s), "period_s": program.period_s}
            for program in truss.programs]


def _lists(part: Any, **more: Any) -> dict[str, Any]:
    values = {**vars(part), **more}
    return {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in values.items()}


def resolved(case: TrussCase, path: Course) -> dict[str, Any]:
    """Return the input of the YADE script as plain values.

    :param path: the quasi-static path of the case, or its motion. The DEM starts from its first state; its forces
        determine the time step, and its slip displacements the size of the floors
    :raises StatejumpError: the DEM cannot represent an item; the message names it
    """
    check(case)
    truss, mass = path.truss, lumped_mass_kg(path.truss)
    ends = path.cycle_ends if isinstance(path, TrussPath) else {}
    if ends and len(path.states["time_s"]) <= len(ends["time_s"]):
        raise refuse(case, "dem_path_too_large", "the path is too large to be kept as a whole")
    reach = [joint.reach_m(path, truss.joints[joint.section]) for joint in JOINTS]
    groups = np.split(_contact_groups(truss, case, np.concatenate(reach)), np.cumsum([len(own) for own in reach]))
    _refuse_far_turns(case, path)
    _refuse_rotation(case, dem_beams.refused_on_path(path))
    start = path.states["displacement_m"][0]
    values = yade_process.common_values(case, number_of_steps(case, path))
    if truss.elements["beam"].names:
        values["dem"]["stepper"] = "yade"  # the JointStepper has no beams
    return {
        **{key: values[key] for key in ("case", "dem", "number_of_samples")},
        "dimension": truss.dimension,
        "programs": _programs(truss),
        "node": _lists(truss.nodes, blocked=blocked_directions(truss), mass_kg=mass,
                       start_m=truss.nodes.position_m + start, start_rad=dem_beams.start_rotation_rad(path),
                       free_rotation=dem_beams.free_rotations(truss),
                       rotary_inertia_kg_m2=dem_beams.rotary_inertia_kg_m2(truss)),
        "link": _lists(truss.links),
        **{joint.section: _lists(truss.joints[joint.section], **joint.scene(path, truss.joints[joint.section]),
                                 group=group) for joint, group in zip(JOINTS, groups)},
        **{element.section: _lists(truss.elements[element.section],
                                   **element.scene(truss, truss.elements[element.section]))
           for element in ELEMENTS if not element.not_in_dem},
    }


def dem_input(case: TrussCase, on_progress: OnProgress = lambda share: None) -> dict[str, Any]:
    """Compute the quasi-static path or the motion, and return the input of the YADE script, see :func:`resolved`.

    :param on_progress: called with the finished fraction of the path
    """
    check(case)
    return resolved(case, course(case, on_progress))


def course(case: TrussCase, on_progress: OnProgress) -> Course:
    """Return the quasi-static path of a case or, if the path ends at a limit point (snap-through), the motion."""
    try:
        return solve(case, on_progress)
    except EngineFailed as failure:
        if failure.reason != "no_continuation":
            raise
    return simulate(with_values(case, {"motion.scheme": "set_valued"}), on_progress)


def run(case: TrussCase, scene: str, make_run: Callable[..., Run], on_progress: OnProgress) -> Run:
    """Compute the path, and run the case in YADE from its first state; see :func:`statejump.core.yade_process.run`.

    :param scene: Python module that builds the scene in YADE
    """
    values = {"scene": scene, **dem_input(case, lambda share: on_progress(PATH_SHARE * share))}
    return yade_process.run(case, values, make_run, lambda share: on_progress(PATH_SHARE + (1 - PATH_SHARE) * share))
