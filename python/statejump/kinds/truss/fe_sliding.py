# SPDX-License-Identifier: GPL-3.0-or-later
"""A truss whose sliders slip in CalculiX, along its temperature program; small displacements.

Bars and sliders are bricks along x that lie by themselves; an equation makes the end of each move as far as the ends
of its bar come apart along it, or as the slider slides. Friction is a brick of an ideally plastic metal: stiff until
its bound, then it flows at that force and keeps how far it went. A stop is a spring that begins at the clearance.
Bricks are STRETCH times as long as what they stand for, of a modulus that gives the same stiffness: so are their own
strains, which CalculiX takes as large with plasticity, STRETCH times smaller.
"""
from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from statejump.core.comparison import Quantity
from statejump.core.errors import FailedRun, NotAllowed
from statejump.core.thermal import range_K, rows as program_rows
from statejump.fe import ccx
from statejump.fe.ccx import number
from statejump.kinds.truss.arrays import GROUND
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.joints.slider import pads
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import engine_programs, whole_path

Numbers = NDArray[np.float64]

STRETCH = 1000.0
STICK = 1e5  # stiffness of friction that sticks and of stops, over that of the stiffest bar
INCREMENTS = 20  # of a branch
MOST_BRANCHES = 40
STEP = 1e-3  # of the solver's temperatures, loads, friction and play, so that its displacements are small as well
# Displacements that are small are so to STEP of strains of a few thousandths, friction sticks to 1/STICK.
TOLERANCE = 1e-4
LEAST_JUMP = 1e-2


def rows(case: TrussCase, truss: ResolvedTruss) -> tuple[list[str], tuple[Quantity, ...]]:
    """Run a truss of links and sliders in CalculiX; return the deck and what both say of its path.

    :param truss: without revolutes, springs and stress as drawn
    :raises NotAllowed: a program without straight pieces, or too long
    :raises StatejumpError: there is no CalculiX, or it failed
    """
    times = corners(case, truss)
    lines = deck(truss, times)
    found = ccx.displacements(lines, "JOINTS")
    if len(found) != len(times) - 1:
        raise FailedRun(code="calculix_increments")
    other = np.array([[step[node + 1] for node in range(len(truss.nodes.names))] for step in found])
    path = whole_path(_small(truss), increments_per_branch=case.reduced_settings.increments_per_branch)
    at = np.array([int(np.argmin(np.abs(path.states["time_s"] - time))) for time in times])
    states = path.states["displacement_m"][at] / STEP
    own, start = states[1:], states[0]

    def row(name: str, ours: Numbers, theirs: Numbers, least: float = 0.0) -> Quantity:
        own_size = float(np.linalg.norm(ours, axis=-1).max())
        size, apart = max(own_size, least), float(np.linalg.norm(theirs - ours, axis=-1).max())
        values = {"reduced": own_size, "fe": float(np.linalg.norm(theirs, axis=-1).max())}
        share = apart / size if size else apart
        return Quantity(name, "m", values, share, TOLERANCE, share <= TOLERANCE)

    found_rows = [row("largest_displacement_sliding", own, other)]
    if not np.any(start):
        what = "jump" if case.has_jump else "displacement_at_program_end"
        # CalculiX prints seven digits: of the largest displacement, TOLERANCE · LEAST_JUMP are left.
        least = LEAST_JUMP * float(np.linalg.norm(own, axis=-1).max())
        found_rows.append(row(f"largest_{what}_sliding", own[-1], other[-1], least))
    return lines, tuple(found_rows)


def _small(truss: ResolvedTruss) -> ResolvedTruss:
    """Return the truss with STEP of what moves it and holds it: its path is STEP times that of small displacements."""
    sliders = truss.sliders
    return replace(
        truss, nodes=replace(truss.nodes, force_N=STEP * truss.nodes.force_N),
        links=replace(truss.links, temperature_fraction=STEP * truss.links.temperature_fraction),
    ).with_joints(slider=replace(
        sliders, friction_coefficient=STEP * sliders.friction_coefficient,
        clearance_minus_m=STEP * sliders.clearance_minus_m, clearance_plus_m=STEP * sliders.clearance_plus_m))


def corners(case: TrussCase, truss: ResolvedTruss) -> list[float]:
    """Return the times [s] between which all programs are straight, over all cycles."""
    for program in truss.programs:
        if program.shape not in ("triangle", "table") and np.any(range_K(program)):
            raise NotAllowed("thermal.shape", program.shape, code="fe_slider_shape")
    cycle: set[float] = set()
    for program in truss.programs:
        table = (program_rows(program, case.period_s)[0] if program.shape == "table"
                 else [0.0, case.period_s / 2, case.period_s])
        cycle.update(np.asarray(table, dtype=float).tolist())
    every = sorted({0.0, *(cycle_s + number_of * case.period_s for number_of in range(case.thermal.cycles)
                           for cycle_s in cycle)})
    near = 1e-9 * case.duration_s
    times = [every[0], *(after for before, after in zip(every, every[1:]) if after - before > near)]
    if len(times) > MOST_BRANCHES + 1:
        raise NotAllowed("thermal.cycles", case.thermal.cycles, code="fe_slider_branches", most=MOST_BRANCHES)
    return times


def deck(truss: ResolvedTruss, times: list[float]) -> list[str]:
    """Return the deck of a truss with sliders, heated along its programs."""
    nodes, links, sliders = truss.nodes, truss.links, truss.sliders
    stiffness = links.young_modulus_Pa * links.cross_section_area_m2 / links.stress_free_length_m
    rigid = STICK * float(stiffness.max())
    friction = sliders.friction_coefficient * sliders.normal_force_N
    sticks = np.full(len(friction), rigid)
    if truss.sticking != "rigid":
        sticks = np.where(sliders.normal_force_N > 0, pads(sliders).tangential_N_per_m, rigid)
    count = len(nodes.names)
    lines = ["*HEADING", f"statejump fe {truss.name}, sliders slip", "*NODE, NSET=JOINTS",
             *(f"{place}, " + ", ".join(map(number, where)) for place, where in enumerate(nodes.position_m, start=1))]
    after: list[str] = []  # materials and sections
    bricks: list[str] = []
    ties: list[str] = []
    held: list[str] = [f"{node + 1}, {axis + 1}" for node, axis in zip(*np.nonzero(nodes.fixed))]
    first, element = count + 1, 0

    def brick(length: float, modulus: float, expansion: float, bound: float | None) -> int:
        """Add one of section 1 m²; return the node at its end that is moved along x."""
        nonlocal first, element
        element += 1
        corner = first
        first += 8
        for place, (x, y, z) in enumerate(((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1),
                                           (0, 1, 1))):
            bricks.append(f"{corner + place}, {number(x * length)}, {y}, {z}")
        after.extend([f"*ELEMENT, TYPE=C3D8, ELSET=E{element}",
                      ", ".join(str(node) for node in (element, *range(corner, corner + 8))),
                      f"*MATERIAL, NAME=M{element}", "*ELASTIC", f"{number(modulus)}, 0.", "*EXPANSION, ZERO=0.",
                      f"{expansion:.12E}"])
        if bound is not None:  # flows sideways as well
            after.extend(["*PLASTIC", f"{number(bound)}, 0.", f"{number(bound)}, 1."])
        after.append(f"*SOLID SECTION, ELSET=E{element}, MATERIAL=M{element}")
        held.extend(f"{corner + place}, 1" for place in (0, 3, 4, 7))
        held.extend(f"{corner + place}, 2" for place in ((0, 1, 4, 5) if bound is not None else range(8)))
        held.extend(f"{corner + place}, 3" for place in ((0, 1, 2, 3) if bound is not None else range(8)))
        for place in (2, 5, 6):
            ties.extend(["*EQUATION", "2", f"{corner + place}, 1, 1., {corner + 1}, 1, -1."])
        return corner + 1

    def tie(end: int | None, ends: list[tuple[int, float]], along: Numbers) -> None:
        """Let the end of a brick (None: nothing) move as nodes with their signs do along a direction."""
        terms = [(node + 1, axis + 1, -sign * float(along[axis])) for node, sign in ends for axis in range(3)
                 if along[axis] and not nodes.fixed[node, axis]]
        if end is None:
            terms.sort(key=lambda term: -abs(term[2]))
        else:
            terms.insert(0, (end, 1, 1.0))
        if terms:
            ties.extend(["*EQUATION", str(len(terms)), *(f"{node}, {axis}, {number(factor)}"
                                                         for node, axis, factor in terms)])

    heated = []
    for place, (one, two) in enumerate(links.nodes):
        along = nodes.position_m[two] - nodes.position_m[one]
        length = float(links.stress_free_length_m[place])
        end = brick(STRETCH * length, float(stiffness[place]) * STRETCH * length,
                    float(links.thermal_expansion_per_K[place]) / STRETCH, None)
        heated.append(end - 1)
        tie(end, [(int(two), 1.0), (int(one), -1.0)], along / np.linalg.norm(along))
    springs: list[tuple[int, float, float]] = []
    longest = float(links.stress_free_length_m.max())
    for place, (one, two) in enumerate(sliders.nodes):
        axis = sliders.axis[place]
        ends = [(int(one), 1.0), *([(int(two), -1.0)] if two != GROUND else [])]
        end = brick(STRETCH * longest, float(sticks[place]) * STRETCH * longest, 0.0,
                    max(float(friction[place]), 1e-12 * rigid * longest))
        tie(end, ends, axis)
        if two != GROUND:
            for across in np.linalg.svd(axis[None])[2][1:]:
                tie(None, ends, across)
        minus, plus = float(sliders.clearance_minus_m[place]), float(sliders.clearance_plus_m[place])
        if np.isfinite((minus, plus)).any():
            springs.append((end, min(minus, longest), min(plus, longest)))
    for place, normal in enumerate(nodes.guide_normal):
        if normal.any():
            tie(None, [(place, 1.0)], normal)
    stops: list[str] = []
    for end, minus, plus in springs:  # from the held end of the brick to the other
        element += 1
        stops.extend([f"*ELEMENT, TYPE=SPRINGA, ELSET=E{element}", f"{element}, {end - 1}, {end}",
                      f"*SPRING, ELSET=E{element}, NONLINEAR",
                      f"{number(-rigid * longest)}, {number(-minus - longest)}", f"0., {number(-minus)}",
                      f"0., {number(plus)}", f"{number(rigid * longest)}, {number(plus + longest)}"])
    lines += ["*NODE, NSET=BRICKS", *bricks, *after, *stops, *ties, "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
              "BRICKS, 0.", "*BOUNDARY", *held]
    loads = [f"{node + 1}, {axis + 1}, {number(nodes.force_N[node, axis])}"
             for node, axis in zip(*np.nonzero(nodes.force_N)) if not nodes.fixed[node, axis]]
    changes = np.array([[program.temperature_change(time) for program in engine_programs(truss)] for time in times])
    fraction = links.temperature_fraction
    for step in range(1, len(times)):
        lines += [f"*STEP, INC={2 * INCREMENTS}", "*STATIC, DIRECT", f"{1 / INCREMENTS}, 1."]
        lines += ["*CLOAD", *loads] if loads and step == 1 else []
        lines.append("*TEMPERATURE")
        for place, corner in enumerate(heated):
            change = float(changes[step, links.program[place]]) * float(fraction[place])
            lines += [f"{node}, {number(change)}" for node in range(corner, corner + 8)]
        lines += [f"*NODE PRINT, NSET=JOINTS, FREQUENCY={INCREMENTS}", "U", "*END STEP"]
    return lines
