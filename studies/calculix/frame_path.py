# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes a structure with beams or condensed bodies in CalculiX along its temperature program, and compares it with
the solver.

Both compute the structure with STEP of its temperatures, loads, friction, preload, play and clearances, and results are
divided by STEP. CalculiX then has small displacements, and so does the solver.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from statejump.bodies.checks import radius
from statejump.core.comparison import Quantity
from statejump.core.errors import FailedRun, NotAllowed
from statejump.core.start import FRICTIONLESS
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.elements.body import BODY
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import engine_programs, whole_path
from studies.calculix import bodies, ccx, frame
from studies.calculix.ccx import number
from studies.calculix.truss_sliding import (
    INCREMENTS, LEAST_JUMP, STEP, STICK, bars, corners, refuse_sliders, sliders, stop,
)

Numbers = NDArray[np.float64]

TOLERANCE = 1e-3  # as the shear stiffness of slender beams, 12 E I/(k G A l²)
# The default, 0.5 % of the mean force in the deck, ignores moments of hinges.
CONVERGED = ["*CONTROLS, PARAMETERS=FIELD", "1.E-7, 1.E-4, , , 1.E-7"]
INCREMENTS_OF_MESHES = 5  # of a branch, if bodies have meshes, whose equations take long
JOINTS = ("slider", "hinge", "rigid")
ELEMENTS = ("beam", "body", "spring")


def answer(case: TrussCase, truss: ResolvedTruss, parts: int = 2, even_shear: bool = False) -> ccx.Answer:
    """Run a structure with beams or condensed bodies in CalculiX along its program and compare it with the solver.

    :param parts: see :class:`.frame.Frame`, also for ``even_shear``
    :raises NotAllowed: the deck does not support the case
    :raises StatejumpError: CalculiX is missing or failed
    """
    _refuse(truss)
    times = corners(case, truss)
    small = _small(truss)
    made = frame.Frame(small, parts=parts, even_shear=even_shear)
    lines = deck(made, times)
    text = ccx.printed(lines, ccx.LONGEST_OF_MESHES_S if truss.elements["body"].names else ccx.LONGEST_S)
    moved = ccx.tables(text, "displacements", "JOINTS")
    if len(moved) != len(times):
        raise FailedRun(code="calculix_increments")
    count = len(truss.nodes.names)
    other = np.array([[step[node + 1,] for node in range(count)] for step in moved]) / STEP
    moments = np.array([frame.section_moments(made.sides, made.bending, step)
                        for step in ccx.tables(text, "stresses", "BENDING")]) / STEP
    path = whole_path(small, increments_per_branch=case.reduced_settings.increments_per_branch)
    at = [int(np.argmin(np.abs(path.states["time_s"] - time))) for time in times]
    own = path.states["displacement_m"][at] / STEP
    rows = [_row("largest_displacement", "m", own, other)]
    if made.bending:
        rows.append(_row("largest_bending_moment", "N m", _own_moments(path.states, at), moments))
    if case.has_jump:
        least = LEAST_JUMP * float(np.linalg.norm(own, axis=-1).max())
        rows.append(_row("largest_jump", "m", own[-1] - own[0], other[-1] - other[0], least))
    notes = [f"displacements are small: both have {STEP:g} of temperatures, loads, friction and play; results are "
             "divided by this factor"]
    notes += _notes(truss, bool(made.bending))
    return ccx.Answer("\n".join(lines) + "\n", tuple(rows), tuple(notes))


def _notes(truss: ResolvedTruss, bending: bool) -> list[str]:
    notes = [f"sticking friction and stops give way by 1/{STICK:g} of the stiffest bar, beam or body"]
    if bending:
        notes.append("moments about y and z of the sections, at the ends of the beams; torsion is not compared")
    if bending and truss.dimension == 3:
        notes.append("in space: beams of CalculiX have the torsional stiffness of bricks with rigid ends, not G J")
    meshes = truss.elements["body"]
    for name in bodies.unmeshed(meshes):
        notes.append(f"body {name!r}: its file contains no deck, the deck has its reduced stiffness")
    return notes


def _own_moments(states: Mapping[str, Numbers], at: list[int]) -> Numbers:
    ends = [states[f"beam_moment_{end}_N_m"][at][:, :, 1:] / STEP for end in ("first", "second")]
    return np.stack(ends, axis=2)


def _row(name: str, unit: str, own: Numbers, other: Numbers, least: float = 0.0) -> Quantity:
    own_size = float(np.linalg.norm(own, axis=-1).max())
    size, apart = max(own_size, least), float(np.linalg.norm(other - own, axis=-1).max())
    share = apart / size if size else apart
    values = {"reduced": own_size, "fe": float(np.linalg.norm(other, axis=-1).max())}
    return Quantity(name, unit, values, share, TOLERANCE, share <= TOLERANCE)


def _refuse(truss: ResolvedTruss) -> None:
    """Raise NotAllowed for items that the deck does not support."""
    parts = [(section, arrays.names) for section, arrays in truss.joints.items() if section not in JOINTS]
    parts += [(section, arrays.names) for section, arrays in truss.elements.items() if section not in ELEMENTS]
    for section, names in [("constraint", truss.constraints.names), *parts]:
        if names:
            raise NotAllowed(section, code="fe_other_parts_with_beams")
    for index in np.flatnonzero(truss.elements["spring"].cable)[:1]:
        raise NotAllowed("cable", True, code="fe_cable", item=f"spring {truss.elements['spring'].names[index]!r}")
    bodies.refuse(truss.elements["body"])
    ends = truss.nodes.position_m[truss.links.nodes]
    beams = truss.elements["beam"]
    between = (truss.nodes.position_m[beams.nodes[:, 1]] + beams.offset_second_m
               - truss.nodes.position_m[beams.nodes[:, 0]] - beams.offset_first_m)
    for key, arrays, drawn in (("link", truss.links, np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)),
                               ("beam", beams, np.linalg.norm(between, axis=1))):
        free = arrays.stress_free_length_m
        for index in np.flatnonzero(np.abs(drawn - free) > 1e-12 * drawn)[:1]:
            raise NotAllowed("stress_free_length_m", float(free[index]), code="fe_link_not_as_drawn",
                             item=f"{key} {arrays.names[index]!r}", drawn_m=drawn[index])
    refuse_sliders(truss)
    if truss.start_friction == FRICTIONLESS:
        raise NotAllowed("start.friction", truss.start_friction, code="fe_start_friction")


def _small(truss: ResolvedTruss) -> ResolvedTruss:
    """Return the structure with temperatures, loads, friction, preload, play and clearances times STEP."""
    beams, joints, nodes, links = truss.elements["beam"], truss.sliders, truss.nodes, truss.links
    hinges, springs, meshes = truss.joints["hinge"], truss.elements["spring"], truss.elements["body"]
    preload = STEP * springs.preload_N
    return replace(
        truss, nodes=replace(nodes, force_N=STEP * nodes.force_N, moment_N_m=STEP * nodes.moment_N_m),
        links=replace(links, temperature_fraction=STEP * links.temperature_fraction),
    ).with_elements(beam=replace(
        beams, temperature_fraction=STEP * beams.temperature_fraction, gradient_per_m=STEP * beams.gradient_per_m,
    ), spring=replace(
        springs, preload_N=preload,
        free_length_m=springs.free_length_m + (springs.preload_N - preload) / springs.stiffness_N_per_m,
    ), body=replace(
        meshes, temperature_fractions=tuple(STEP * fractions for fractions in meshes.temperature_fractions),
    )).with_joints(
        slider=replace(joints, friction_coefficient=STEP * joints.friction_coefficient,
                       clearance_minus_m=STEP * joints.clearance_minus_m,
                       clearance_plus_m=STEP * joints.clearance_plus_m),
        hinge=replace(hinges, friction_moment_N_m=STEP * hinges.friction_moment_N_m,
                      preload_moment_N_m=STEP * hinges.preload_moment_N_m, deadband_rad=STEP * hinges.deadband_rad))


def deck(made: frame.Frame, times: list[float]) -> list[str]:
    """Return the deck of a structure: a step with its loads, and one for each branch of its program."""
    truss = made.truss
    nodes, links, beams, meshes = truss.nodes, truss.links, truss.elements["beam"], truss.elements["body"]
    stiffness = links.axial_stiffness_N / links.stress_free_length_m
    springs = truss.elements["spring"]
    along = np.concatenate((stiffness, beams.stiffness_N_per_m, springs.stiffness_N_per_m,
                            BODY.stiffness_N_per_m(meshes)))
    longest = _longest(truss)
    rigid = STICK * float(along.max())
    frame.rigid_bodies(made)
    for place, normal in enumerate(nodes.guide_normal):
        if normal.any():
            made.tie(None, [(place, 1.0)], normal)
    if truss.joints["hinge"].names:
        frame.hinges(made, STICK * _turning_stiffness(truss))
    heated = bars(made, stiffness)
    frame.springs(made)
    stopped = sliders(made, rigid, longest)
    frame.beams(made)
    hot = bodies.add(made, longest)
    stops = [stop(end, minus, plus, rigid, longest) for end, minus, plus in stopped]
    stops += [stop(end, play, play, beyond, 1.0) for end, play, beyond in made.springs]
    extra = [line for element, lines in enumerate(stops, start=made.element + 1)
             for line in (f"*ELEMENT, TYPE=SPRINGA, ELSET=E{element}", f"{element}, {lines[0]}",
                          f"*SPRING, ELSET=E{element}, NONLINEAR", *lines[1:])]
    cold = ["BRICKS, 0."] if made.nodes else []
    found = ["*HEADING", f"statejump fe {truss.name}", "*NODE, NSET=JOINTS", *_points(nodes.position_m, 1),
             "*NODE, NSET=TURNS", *_points(nodes.position_m, made.count + 1),
             *(["*NODE, NSET=BRICKS", *made.nodes] if made.nodes else []), *made.sections, *extra, *_bending(made),
             *made.written_equations(), "*INITIAL CONDITIONS, TYPE=TEMPERATURE", *cold,
             *(f"{node}, 0." for one in hot for node in one.nodes.tolist()), "*BOUNDARY", *made.held]
    changes = np.array([[program.temperature_change(time) for program in engine_programs(truss)] for time in times])
    slips = bool(extra) or any("*PLASTIC" in line for line in made.sections)
    increments = (INCREMENTS_OF_MESHES if meshes.names else INCREMENTS) if slips else 1
    for step in range(len(times)):
        found += [f"*STEP, INC={2 * increments}", "*STATIC, DIRECT" if slips else "*STATIC", f"{1 / increments}, 1."]
        found += CONVERGED if slips else []
        found += ["*CLOAD", *_loads(made)] if step == 0 and _loads(made) else []
        found += ["*TEMPERATURE", *_temperatures(made, heated, changes[step]),
                  *(line for one in hot for line in one.lines(meshes, changes[step]))]
        found += [f"*NODE PRINT, NSET=JOINTS, FREQUENCY={increments}", "U"]
        found += [f"*EL PRINT, ELSET=BENDING, FREQUENCY={increments}", "S"] if made.bending else []
        found.append("*END STEP")
    return found


def _bending(made: frame.Frame) -> list[str]:
    bricks = [f"{brick}," for of in made.bending for brick in of]
    return ["*ELSET, ELSET=BENDING", *bricks] if bricks else []


def _turning_stiffness(truss: ResolvedTruss) -> float:
    """Return the largest stiffness of a rotation [N m/rad]."""
    beams = truss.elements["beam"]
    found = [*(beams.bending_stiffness_N_m2.max(axis=1, initial=0.0) / beams.stress_free_length_m)]
    for content, placed in zip(truss.elements["body"].contents, truss.elements["body"].placed):
        found += [float(np.diag(placed.stiffness)[start + 3:start + 6].max())
                  for start, dofs in zip(placed.starts, content.node_freedoms) if dofs == 6]
    return float(max(found))


def _longest(truss: ResolvedTruss) -> float:
    """Return the largest length of a part [m]."""
    return float(max([*truss.links.stress_free_length_m, *truss.elements["beam"].stress_free_length_m,
                      *(radius(content.node_positions_m) for content in truss.elements["body"].contents)]))


def _points(position_m: Numbers, first: int) -> list[str]:
    return [f"{index}, " + ", ".join(map(number, where)) for index, where in enumerate(position_m, start=first)]


def _loads(made: frame.Frame) -> list[str]:
    nodes = made.truss.nodes
    moment = np.where(made.turns, nodes.moment_N_m, 0.0)
    force = np.where(nodes.fixed, 0.0, nodes.force_N)
    return [f"{before + node + 1}, {axis + 1}, {number(values[node, axis])}"
            for before, values in ((0, force), (made.count, moment))
            for node, axis in zip(*np.nonzero(values))] + made.loads


def _temperatures(made: frame.Frame, heated: list[int], changes: Numbers) -> list[str]:
    """Return the temperatures of all nodes of bricks, for the changes (programs,) of the programs."""
    links, beams = made.truss.links, made.truss.elements["beam"]
    lines = []
    for place, corner in enumerate(heated):
        change = float(changes[links.program[place]]) * float(links.temperature_fraction[place])
        lines += [f"{node}, {number(change)}" for node in range(corner, corner + 8)]
    mean = changes[beams.program] * beams.temperature_fraction
    gradient = changes[beams.gradient_program][:, None] * beams.gradient_per_m
    for beam, node, y, z in made.heated:
        change = float(mean[beam] + gradient[beam] @ (y, z))
        lines.append(f"{node}, {number(change)}")
    return lines
