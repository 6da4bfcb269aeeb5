# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes a truss with slipping sliders in CalculiX along its temperature program (small displacements).

Every bar and every slider is a separate brick along x. An equation sets the displacement of the brick's end to the
elongation of the bar, or to the slip of the slider. The brick of a slider is ideally plastic: it is stiff up to the
friction limit and then yields at this force. A stop is a spring that acts beyond the clearance. Bricks are STRETCH
times as long as their bars, with a modulus that keeps the stiffness. Their strains are thus STRETCH times smaller,
because CalculiX treats strains as large if plasticity is used.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from statejump.core.comparison import Quantity
from statejump.core.errors import FailedRun, NotAllowed
from statejump.core.thermal import range_K, rows as program_rows
from statejump.kinds.truss.arrays import GROUND
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.joints.slider import pads
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import engine_programs, whole_path
from studies.calculix import ccx
from studies.calculix.ccx import number

Numbers = NDArray[np.float64]

STRETCH = 1000.0
STICK = 1e5  # stiffness of sticking friction and of stops, over that of the stiffest bar
INCREMENTS = 20  # of a branch
# Corners of a brick in the order of its nodes in CalculiX.
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
MOST_BRANCHES = 40
STEP = 1e-3  # factor of the solver's temperatures, loads, friction and clearances, which makes its displacements small
# Displacements scaled by STEP are small to about STEP times strains of a few thousandths; sticking is rigid to 1/STICK.
TOLERANCE = 1e-4
LEAST_JUMP = 1e-2
LEAST_FRICTION = 1e-6  # of sliders without friction, over the largest one of others: bricks yield at a positive stress


def rows(case: TrussCase, truss: ResolvedTruss) -> tuple[list[str], tuple[Quantity, ...]]:
    """Run a truss of links and sliders in CalculiX; return the deck and the rows of the comparison.

    :param truss: a truss without revolutes and springs, stress-free in the reference configuration
    :raises NotAllowed: a program is not piecewise linear, or has too many pieces
    :raises StatejumpError: CalculiX is missing or failed
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
        # CalculiX prints seven digits, so the scale of a small jump is at least LEAST_JUMP of the displacement.
        least = LEAST_JUMP * float(np.linalg.norm(own, axis=-1).max())
        found_rows.append(row(f"largest_{what}_sliding", own[-1], other[-1], least))
    return lines, tuple(found_rows)


def _small(truss: ResolvedTruss) -> ResolvedTruss:
    """Return the truss with temperatures, loads, friction and clearances times STEP; its path then scales nearly alike.
    """
    sliders = truss.sliders
    return replace(
        truss, nodes=replace(truss.nodes, force_N=STEP * truss.nodes.force_N),
        links=replace(truss.links, temperature_fraction=STEP * truss.links.temperature_fraction),
    ).with_joints(slider=replace(
        sliders, friction_coefficient=STEP * sliders.friction_coefficient,
        clearance_minus_m=STEP * sliders.clearance_minus_m, clearance_plus_m=STEP * sliders.clearance_plus_m))


def corners(case: TrussCase, truss: ResolvedTruss) -> list[float]:
    """Return the corner times [s] of all cycles; between two corners all temperature programs are linear."""
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


@dataclass
class Bricks:
    """Brick elements with a cross-section of 1 m², and equations for their ends.

    :param truss: the truss; its nodes have the first numbers
    """

    truss: ResolvedTruss
    nodes: list[str] = field(default_factory=list)
    sections: list[str] = field(default_factory=list)  # elements, materials and sections
    equations: list[str] = field(default_factory=list)
    held: list[str] = field(default_factory=list)
    element: int = 0

    def __post_init__(self) -> None:
        self.first = len(self.truss.nodes.names) + 1
        self.held += [f"{node + 1}, {axis + 1}" for node, axis in zip(*np.nonzero(self.truss.nodes.fixed))]

    def brick(self, length: float, modulus: float, expansion: float, bound: float | None) -> int:
        """Add a brick; return the node at its end that moves along x.

        :param bound: force [N] at which the brick yields; None: it stays elastic
        """
        self.element += 1
        corner, element = self.first, self.element
        self.first += 8
        self.nodes += [f"{corner + place}, {number(x * length)}, {y}, {z}" for place, (x, y, z) in enumerate(CORNERS)]
        self.sections += [f"*ELEMENT, TYPE=C3D8, ELSET=E{element}",
                          ", ".join(str(node) for node in (element, *range(corner, corner + 8))),
                          f"*MATERIAL, NAME=M{element}", "*ELASTIC", f"{number(modulus)}, 0.", "*EXPANSION, ZERO=0.",
                          f"{expansion:.12E}"]
        if bound is not None:  # flows sideways as well
            self.sections += ["*PLASTIC", f"{number(bound)}, 0.", f"{number(bound)}, 1."]
        self.sections.append(f"*SOLID SECTION, ELSET=E{element}, MATERIAL=M{element}")
        sides = {1: (0, 3, 4, 7), 2: (0, 1, 4, 5), 3: (0, 1, 2, 3)}
        for axis, places in sides.items():
            self.held += [f"{corner + place}, {axis}" for place in (range(8) if bound is None and axis > 1 else places)]
        for place in (2, 5, 6):
            self.equations += ["*EQUATION", "2", f"{corner + place}, 1, 1., {corner + 1}, 1, -1."]
        return corner + 1

    def tie(self, end: int | None, ends: Sequence[tuple[int, float]], along: Numbers) -> None:
        """Add the equation "displacement of a brick's end (0 without a brick) = signed sum of node displacements along
        a direction"."""
        terms = [(int(node) + 1, axis + 1, -sign * float(along[axis])) for node, sign in ends for axis in range(3)
                 if along[axis] and not self.truss.nodes.fixed[node, axis]]
        if end is None:
            terms.sort(key=lambda term: -abs(term[2]))
        else:
            terms.insert(0, (end, 1, 1.0))
        if terms:
            self.equations += ["*EQUATION", str(len(terms)),
                               *(f"{node}, {axis}, {number(factor)}" for node, axis, factor in terms)]


def bars(bricks: Bricks, stiffness: Numbers) -> list[int]:
    """Add the bricks of the links; return the first corner node of each brick."""
    links, positions = bricks.truss.links, bricks.truss.nodes.position_m
    corners_of = []
    for place, (one, two) in enumerate(links.nodes):
        along = positions[two] - positions[one]
        length = float(links.stress_free_length_m[place])
        end = bricks.brick(STRETCH * length, float(stiffness[place]) * STRETCH * length,
                           float(links.thermal_expansion_per_K[place]) / STRETCH, None)
        corners_of.append(end - 1)
        bricks.tie(end, [(two, 1.0), (one, -1.0)], along / np.linalg.norm(along))
    return corners_of


def sliders(bricks: Bricks, rigid: float, longest: float) -> list[tuple[int, float, float]]:
    """Add the bricks of the sliders; for each slider with stops, return the end node of its brick and both clearances
    [m].

    :param rigid: stiffness of sticking friction [N/m]
    :param longest: length of the longest bar or beam [m]
    """
    truss, joints = bricks.truss, bricks.truss.sliders
    friction = joints.friction_coefficient * joints.normal_force_N
    least = LEAST_FRICTION * float(friction.max(initial=0.0)) or 1e-12 * rigid * longest
    sticks = np.full(len(friction), rigid)
    if truss.sticking != "rigid":
        sticks = np.where(joints.normal_force_N > 0, pads(joints).tangential_N_per_m, rigid)
    stopped: list[tuple[int, float, float]] = []
    for place, (one, two) in enumerate(joints.nodes):
        axis = joints.axis[place]
        ends = [(one, 1.0), *([(two, -1.0)] if two != GROUND else [])]
        end = bricks.brick(STRETCH * longest, float(sticks[place]) * STRETCH * longest, 0.0,
                           float(friction[place]) or least)
        bricks.tie(end, ends, axis)
        if two != GROUND:
            for across in np.linalg.svd(axis[None])[2][1:]:
                bricks.tie(None, ends, across)
        minus, plus = float(joints.clearance_minus_m[place]), float(joints.clearance_plus_m[place])
        if np.isfinite((minus, plus)).any():
            stopped.append((end, min(minus, longest), min(plus, longest)))
    return stopped


def stop(end: int, minus: float, plus: float, stiffness: float, reach: float) -> list[str]:
    """Return the nodes and the points of a spring that acts beyond two clearances of a brick's end."""
    # spring from the held end of the brick to its other end
    return [f"{end - 1}, {end}", f"{number(-stiffness * reach)}, {number(-minus - reach)}", f"0., {number(-minus)}",
            f"0., {number(plus)}", f"{number(stiffness * reach)}, {number(plus + reach)}"]


def refuse_sliders(truss: ResolvedTruss) -> None:
    """Raise NotAllowed for sliders that the decks do not support."""
    if truss.sticking == "partial_slip" and truss.sliders.names:
        raise NotAllowed("joints", code="fe_other_joints")
    for index in np.flatnonzero(truss.sliders.have_springs)[:1]:
        raise NotAllowed("slider", code="fe_soft_sliders", item=f"slider {truss.sliders.names[index]!r}")


def deck(truss: ResolvedTruss, times: list[float]) -> list[str]:
    """Return the deck of a truss with sliders, heated along its temperature programs."""
    nodes, links = truss.nodes, truss.links
    stiffness = links.young_modulus_Pa * links.cross_section_area_m2 / links.stress_free_length_m
    rigid, longest = STICK * float(stiffness.max()), float(links.stress_free_length_m.max())
    bricks = Bricks(truss)
    heated = bars(bricks, stiffness)
    stopped = sliders(bricks, rigid, longest)
    for place, normal in enumerate(nodes.guide_normal):
        if normal.any():
            bricks.tie(None, [(place, 1.0)], normal)
    stops: list[str] = []
    for element, (end, minus, plus) in enumerate(stopped, start=bricks.element + 1):
        ends, *points = stop(end, minus, plus, rigid, longest)
        stops += [f"*ELEMENT, TYPE=SPRINGA, ELSET=E{element}", f"{element}, {ends}",
                  f"*SPRING, ELSET=E{element}, NONLINEAR", *points]
    lines = ["*HEADING", f"statejump fe {truss.name}, sliders slip", "*NODE, NSET=JOINTS",
             *(f"{place}, " + ", ".join(map(number, where)) for place, where in enumerate(nodes.position_m, start=1)),
             "*NODE, NSET=BRICKS", *bricks.nodes, *bricks.sections, *stops, *bricks.equations,
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BRICKS, 0.", "*BOUNDARY", *bricks.held]
    loads = [f"{node + 1}, {axis + 1}, {number(nodes.force_N[node, axis])}"
             for node, axis in zip(*np.nonzero(nodes.force_N)) if not nodes.fixed[node, axis]]
    changes = np.array([[program.temperature_change(time) for program in engine_programs(truss)] for time in times])
    for step in range(1, len(times)):
        lines += [f"*STEP, INC={2 * INCREMENTS}", "*STATIC, DIRECT", f"{1 / INCREMENTS}, 1."]
        lines += ["*CLOAD", *loads] if loads and step == 1 else []
        lines.append("*TEMPERATURE")
        for place, corner in enumerate(heated):
            change = float(changes[step, links.program[place]]) * float(links.temperature_fraction[place])
            lines += [f"{node}, {number(change)}" for node in range(corner, corner + 8)]
        lines += [f"*NODE PRINT, NSET=JOINTS, FREQUENCY={INCREMENTS}", "U", "*END STEP"]
    return lines
