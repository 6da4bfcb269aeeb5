# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes a truss with locked joints in CalculiX: bars of type T3D2, small displacements. If all joints are sliders,
they slip in a second deck, see :mod:`studies.calculix.truss_sliding`.

CalculiX is linear, this project's solver is not. Its displacement u is therefore linearised at ΔT = 0 and zero load:
r(h) = (u(h) - u(-h))/(2 h) with temperatures and loads scaled by h, extrapolated as (4 r(h/2) - r(h))/3 with h = STEP.
The error is of order (h u/height)⁴, largest for shallow trusses. CalculiX prints seven digits. A second run gives seven
more: equations with two auxiliary nodes make CalculiX print differences from the displacements of the first run.
"""
from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from statejump.core.comparison import Quantity
from statejump.core.errors import NotAllowed, StatejumpError
from statejump.core.start import FRICTIONLESS
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.arrays import GROUND, none_of
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.along_axis import AlongAxis
from statejump.kinds.truss.joints.round_parts import RoundParts
from statejump.kinds.truss.joints.slider import SLIDER, with_sliders
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.sections import TrussThermal
from statejump.kinds.truss.solve import whole_path
from studies.calculix import ccx, frame_path, truss_sliding
from studies.calculix.ccx import number

Numbers = NDArray[np.float64]

STEP = 1e-3
TOLERANCE = 1e-8  # relative to the largest displacement, or to the largest force
UNSTRESSED = 1e-12  # relative difference below which the length in the reference configuration is stress-free
LARGEST_HELD = 1e12  # N: what holds a locked slider


def answer(case: TrussCase) -> ccx.Answer:
    """Run the truss with locked joints in CalculiX and compare it with the solver.

    :raises NotAllowed: the deck does not support the case
    :raises StatejumpError: CalculiX is missing or failed
    """
    truss = case.resolve()
    if truss.elements["beam"].names or truss.elements["body"].names:
        return frame_path.answer(case, truss)
    _refuse(truss)
    locked = pinned(truss)
    changes = _hottest(case, truss)
    lines = deck(locked, changes)
    rough = _displacements(ccx.displacements(lines, "JOINTS")[-1], len(locked.nodes.names))
    told = ccx.displacements(deck(locked, changes, rough), "TOLD")[-1]
    fine = rough + _displacements(told, len(locked.nodes.names), offset=len(locked.nodes.names))
    own = _rate(locked, changes)
    carried, other = (_forces(locked, changes, moved) for moved in (own, fine))
    held = np.abs(_forces(locked, changes, np.zeros_like(own))).max()
    expansion = np.abs(locked.links.thermal_expansion_per_K * changes * locked.links.stress_free_length_m).max()
    rows = [_row("largest_displacement", "m", own, fine, float(expansion)),
            _row("largest_axial_force", "N", carried, other, float(held))]
    notes = ["every joint is locked, displacements are small: the solver's rate at ΔT = 0 times the largest ΔT of each "
             "link",
             "differences are the largest of all nodes and links, over the largest value, or over the largest "
             "expansion of a free link and the force that holds it, where they are larger"]
    if truss.sliders.names:
        try:
            lines, sliding = _sliding(case, truss)
            rows += sliding
            notes.append(
                "rows that end in sliding: the sliders slip along the program, displacements are small (the "
                f"solver's at {truss_sliding.STEP:g} of temperatures, loads, friction and play, over that); what "
                f"is rigid gives way by 1/{truss_sliding.STICK:g} of the stiffest bar")
        except StatejumpError as refused:
            notes.append(f"sliders that slip are not followed: {refused}")
    return ccx.Answer("\n".join(lines) + "\n", tuple(rows), tuple(notes))


def _sliding(case: TrussCase, truss: ResolvedTruss) -> tuple[list[str], tuple[Quantity, ...]]:
    """Return the deck with slipping sliders, and the rows of the comparison.

    :raises NotAllowed: the truss has other joints or features that this deck does not support
    """
    if truss.number_of_joints() > len(truss.sliders.names):
        raise NotAllowed("joints", code="fe_other_joints")
    truss_sliding.refuse_sliders(truss)
    if truss.start_friction == FRICTIONLESS:
        raise NotAllowed("start.friction", truss.start_friction, code="fe_start_friction")
    return truss_sliding.rows(case, truss)


def _refuse(truss: ResolvedTruss) -> None:
    """Raise NotAllowed for items that the deck does not support."""
    if not truss.links.names:
        raise NotAllowed("link", code="fe_no_links")
    of_angles = [(joint.section, truss.joints[joint.section].names) for joint in JOINTS
                 if not isinstance(joint, (AlongAxis, RoundParts))]
    of_elements = [(element.section, truss.elements[element.section].names) for element in ELEMENTS]
    for section, names in [("constraint", truss.constraints.names), *of_elements, *of_angles]:
        if names:
            raise NotAllowed(section, code="fe_other_parts")
    ends = truss.nodes.position_m[truss.links.nodes]
    drawn = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    free = truss.links.stress_free_length_m
    for index in np.flatnonzero(np.abs(drawn - free) > UNSTRESSED * drawn)[:1]:
        raise NotAllowed("stress_free_length_m", float(free[index]), code="fe_link_not_as_drawn",
                         item=f"link {truss.links.names[index]!r}", drawn_m=drawn[index])


def _hottest(case: TrussCase, truss: ResolvedTruss) -> Numbers:
    """Return, for every link, the temperature change ΔT [K] of largest absolute value in its program."""
    ranges = truss.temperature_ranges_K[truss.links.program]
    largest = np.where(np.abs(ranges[:, 0]) > np.abs(ranges[:, 1]), ranges[:, 0], ranges[:, 1])
    return np.asarray(largest * truss.links.temperature_fraction)


def pinned(truss: ResolvedTruss) -> ResolvedTruss:
    """Return the truss with simpler joints: a pin for each joint with clearance (its two nodes become one), and a
    slider for each joint along an axis."""
    place, none = np.arange(len(truss.nodes.names)), {}
    for joint in JOINTS:
        if not isinstance(joint, AlongAxis) or joint is SLIDER:
            continue
        truss, joints = with_sliders(truss, truss.joints[joint.section]), truss.joints[joint.section]
        none[joint.section] = none_of(joints)
    for joint in JOINTS:
        if not isinstance(joint, RoundParts):
            continue
        joints = truss.joints[joint.section]
        none[joint.section] = none_of(joints)
        for outer, inner in joint.joined(joints):
            place[place == place[inner]] = place[outer]
    kept = np.unique(place)
    number_of = {int(node): index for index, node in enumerate(kept)}
    at = np.array([number_of[int(node)] for node in place])
    nodes, links = truss.nodes, truss.links
    # A locked joint has no play.
    sliders = replace(truss.sliders, play_m=0 * truss.sliders.play_m)
    fixed, force = np.zeros((len(kept), 3), dtype=bool), np.zeros((len(kept), 3))
    np.logical_or.at(fixed, at, nodes.fixed)
    np.add.at(force, at, nodes.force_N)
    ends = np.where(sliders.nodes == GROUND, GROUND, at[sliders.nodes])
    return replace(
        truss, nodes=replace(nodes, names=tuple(nodes.names[node] for node in kept), fixed=fixed, force_N=force,
                             position_m=nodes.position_m[kept], guide_normal=nodes.guide_normal[kept]),
        links=replace(links, nodes=at[links.nodes]),
    ).with_joints(slider=replace(sliders, nodes=ends), **none)


def _rate(truss: ResolvedTruss, changes: Numbers) -> Numbers:
    """Return the derivative of the solver's displacements (n, 3) [m] by a common factor of temperatures and loads, at
    zero load."""
    def moved(step: float) -> Numbers:
        count = len(truss.links.names)
        program = TrussThermal(shape="triangle", temperature_change_max_K=1.0, period_s=1.0)
        scaled = replace(
            truss, programs=(program,), program_names=("thermal",),
            nodes=replace(truss.nodes, force_N=step * truss.nodes.force_N),
            links=replace(truss.links, program=np.zeros(count, dtype=int), temperature_fraction=step * changes),
            sticking="rigid",
        ).with_joints(slider=replace(
            truss.sliders, friction_coefficient=np.ones(len(truss.sliders.names)),
            normal_force_N=np.full(len(truss.sliders.names), LARGEST_HELD)))
        path = whole_path(scaled, increments_per_branch=1)
        peak = int(np.argmin(np.abs(path.states["time_s"] - 0.5)))
        return np.asarray(path.states["displacement_m"][peak])

    coarse, fine = ((moved(step) - moved(-step)) / (2 * step) for step in (STEP, STEP / 2))
    return np.asarray((4 * fine - coarse) / 3)


def _forces(truss: ResolvedTruss, changes: Numbers, moved: Numbers) -> Numbers:
    """Return the axial forces [N] for small displacements, compression positive."""
    links = truss.links
    ends = truss.nodes.position_m[links.nodes]
    along = (ends[:, 1] - ends[:, 0]) / links.stress_free_length_m[:, None]
    stretch = ((moved[links.nodes[:, 1]] - moved[links.nodes[:, 0]]) * along).sum(axis=1) / links.stress_free_length_m
    rigidity = links.young_modulus_Pa * links.cross_section_area_m2
    return np.asarray(rigidity * (links.thermal_expansion_per_K * changes - stretch))


def _row(name: str, unit: str, own: Numbers, other: Numbers, least: float = 0.0) -> Quantity:
    size = max(float(np.abs(own).max()), least)
    difference = float(np.abs(other - own).max()) / size if size else float(np.abs(other).max())
    values = {"reduced": float(np.abs(own).max()), "fe": float(np.abs(other).max())}
    return Quantity(name, unit, values, difference, TOLERANCE,
                    difference <= TOLERANCE)


def _displacements(found: dict[int, Numbers], count: int, offset: int = 0) -> Numbers:
    return np.array([found[offset + node + 1] for node in range(count)])


def deck(truss: ResolvedTruss, changes: Numbers, reference: Numbers | None = None) -> list[str]:
    """Return the deck of a truss with locked joints.

    :param changes: temperature change of every link [K]
    :param reference: displacements (n, 3) [m] to subtract from those of node set TOLD; None: the deck has no such set
    """
    nodes, links, count = truss.nodes, truss.links, len(truss.nodes.names)
    lines = ["*HEADING", f"statejump fe {truss.name}, joints locked", "*NODE, NSET=JOINTS"]
    lines += _points(nodes.position_m, 0)
    if reference is not None:
        lines += ["*NODE, NSET=TOLD", *_points(nodes.position_m, count), "*NODE, NSET=ZERO",
                  *_points(nodes.position_m, 2 * count)]
    for index, (first, second) in enumerate(links.nodes, start=1):
        lines += [f"*ELEMENT, TYPE=T3D2, ELSET=E{index}", f"{index}, {first + 1}, {second + 1}"]
    poisson = links.poisson_ratio
    # A node has one temperature, but bars have different ones. All nodes get the ΔT of the hottest bar, and the
    # expansion of cooler bars is scaled down.
    hot = max(changes, key=abs, default=0.0) or 1.0
    for index in range(len(links.names)):
        lines += [f"*MATERIAL, NAME=M{index + 1}", "*ELASTIC",
                  f"{number(links.young_modulus_Pa[index])}, {number(poisson[index])}", "*EXPANSION, ZERO=0.",
                  number(links.thermal_expansion_per_K[index] * (changes[index] / hot)),
                  f"*SOLID SECTION, ELSET=E{index + 1}, MATERIAL=M{index + 1}",
                  number(links.cross_section_area_m2[index])]
    lines += _locks(truss)
    if reference is not None:
        for node in range(1, count + 1):
            for axis in (1, 2, 3):
                lines += ["*EQUATION", "3", f"{count + node}, {axis}, 1., {node}, {axis}, -1., "
                                            f"{2 * count + node}, {axis}, 1."]
    lines += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "JOINTS, 0.", "*BOUNDARY"]
    lines += [f"{node + 1}, {axis + 1}" for node, axis in zip(*np.nonzero(nodes.fixed))]
    if reference is not None:
        lines += [f"{2 * count + node + 1}, {axis + 1}, {axis + 1}, {number(reference[node, axis])}"
                  for node in range(count) for axis in range(3)]
    lines += ["*STEP", "*STATIC", "*TEMPERATURE", f"JOINTS, {number(hot)}"]
    loads = [f"{node + 1}, {axis + 1}, {number(nodes.force_N[node, axis])}"
             for node, axis in zip(*np.nonzero(nodes.force_N))]
    lines += ["*CLOAD", *loads] if loads else []
    return lines + [f"*NODE PRINT, NSET={'JOINTS' if reference is None else 'TOLD'}", "U", "*END STEP"]


def _points(position_m: Numbers, offset: int) -> list[str]:
    return [f"{offset + index}, " + ", ".join(map(number, where)) for index, where in enumerate(position_m, start=1)]


def _locks(truss: ResolvedTruss) -> list[str]:
    """Return the CalculiX equations of guides and locked sliders. Their first term is eliminated, so it must be free.
    """
    lines: list[str] = []
    fixed, axes = truss.nodes.fixed, np.eye(3)

    def tie(terms: list[tuple[int, int, float]]) -> None:
        moving = sorted((term for term in terms if term[2] and not fixed[term[0], term[1]]), key=lambda t: -abs(t[2]))
        if moving:
            lines.extend(["*EQUATION", str(len(moving)), *(
                f"{node + 1}, {axis + 1}, {number(factor)}" for node, axis, factor in moving)])

    for node in np.flatnonzero(truss.nodes.guide_normal.any(axis=1)):
        tie([(int(node), axis, float(truss.nodes.guide_normal[node, axis])) for axis in range(3)])
    for (first, second), along in zip(truss.sliders.nodes, truss.sliders.axis):
        if second == GROUND:
            tie([(int(first), axis, float(along[axis])) for axis in range(3)])
        else:  # between two nodes, all components are equal
            for one in axes:
                tie([(int(node), axis, sign * float(one[axis])) for node, sign in ((first, 1.0), (second, -1.0))
                     for axis in range(3)])
    return lines
