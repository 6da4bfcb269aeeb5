# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the CalculiX deck of a structure with beams, hinges, rigid bodies, bars, springs and sliders, for small
displacements.

A beam is a row of bricks C3D20R over a rectangular section. CalculiX makes the same bricks from elements B32R. The deck
has the bricks themselves for two reasons. Rotations of nodes are then displacements of nodes without elements, which
linear equations can use. Each beam has its own temperature gradients.

The sides of the rectangle, h = sqrt(12 Iz/A) and b = sqrt(12 Iy/A), and the modulus E A/(h b) give a beam its E A, E Iy
and E Iz. The material is orthotropic: Poisson's ratio and the expansion across the beam are zero, and the shear modulus
gives k G A, because shear strains of one brick are uniform over the section. Only torsion differs.

The end faces are rigid: u = N + R × r, with the displacements N and the rotations R of the node.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studies.calculix.ccx import number
from studies.calculix.truss_sliding import STRETCH, Bricks

Numbers = NDArray[np.float64]
Term = tuple[int, int, float]  # node of the deck, direction 1 to 3, coefficient
Place = tuple[int, int]  # node of the deck, direction 1 to 3

LEAST_SHEAR = 1e-7  # Φ = 12 E I/(k G A l²) of beams that are rigid in shear
ROUNDING = 1e-12  # of coefficients
WEAK = 1e-12  # stiffness of hinges without spring, over that of sticking friction
# Nodes of a C3D20R in the order of CalculiX: their positions along the beam, y and z, in halves of the sides.
PLACES = ((-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1),
          (0, -1, -1), (1, 0, -1), (0, 1, -1), (-1, 0, -1), (0, -1, 1), (1, 0, 1), (0, 1, 1), (-1, 0, 1),
          (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))


@dataclass
class Frame(Bricks):
    """Parts of a deck. Node i of the structure has the number i + 1; its rotations are the displacements of the node
    n + i + 1.

    :param parts: bricks along a beam
    :param even_shear: the beams have the shear modulus E/2 of an isotropic material in place of their k G A
    """

    parts: int = 2
    even_shear: bool = False
    eliminated: dict[Place, dict[Place, float]] = field(default_factory=dict)
    order: dict[Place, int] = field(default_factory=dict)
    bending: list[list[int]] = field(default_factory=list)  # the bricks of each beam
    heated: list[tuple[int, int, float, float]] = field(default_factory=list)  # beam, node of the deck, its y and z [m]
    sides: list[tuple[float, float]] = field(default_factory=list)  # of the beams, along y and z
    loads: list[str] = field(default_factory=list)
    springs: list[tuple[int, float, float]] = field(default_factory=list)  # node of a brick, play, stiffness beyond

    def __post_init__(self) -> None:
        super().__post_init__()
        nodes = self.truss.nodes
        self.count = len(nodes.names)
        self.first = 2 * self.count + 1
        self.turns = nodes.rotates[:, None] & ~nodes.fixed_rotations
        self.held += [f"{self.count + node + 1}, {axis + 1}" for node, axis in zip(*np.nonzero(~self.turns))]

    def moves(self, node: int, axis: int) -> bool:
        """Whether no support holds a node of the deck in a direction, 1 to 3."""
        if node <= self.count:
            return not self.truss.nodes.fixed[node - 1, axis - 1]
        return node > 2 * self.count or bool(self.turns[node - self.count - 1, axis - 1])

    def equate(self, terms: Sequence[Term], first: bool = False) -> None:
        """Add an equation: the sum of coefficients times displacements is zero.

        CalculiX eliminates one term of each equation. This method replaces terms that earlier equations eliminate, so
        that no equations eliminate each other's terms.

        :param first: eliminate the first term; otherwise the one with the largest coefficient
        """
        sums: dict[Place, float] = {}

        def add(place: Place, factor: float) -> None:
            if self.moves(*place):
                sums[place] = sums.get(place, 0.0) + factor

        for node, axis, factor in terms:
            add((node, axis), factor)
        largest = max(map(abs, sums.values()), default=0.0)
        while replaced := [place for place in sums if place in self.order]:
            place = min(replaced, key=self.order.__getitem__)
            times = sums.pop(place)
            for other, factor in self.eliminated[place].items():
                add(other, times * factor)
        kept = {place: factor for place, factor in sums.items() if abs(factor) > ROUNDING * largest}
        if not kept:
            return
        head = next(iter(kept)) if first else max(kept, key=lambda place: round(abs(kept[place]) / largest, 6))
        self.order[head] = len(self.order)
        self.eliminated[head] = {place: -factor / kept[head] for place, factor in kept.items() if place != head}

    def written_equations(self) -> list[str]:
        """Return all equations as lines of the deck."""
        lines = list(self.equations)
        for (node, axis), others in self.eliminated.items():
            lines += ["*EQUATION", str(len(others) + 1), f"{node}, {axis}, 1.",
                      *(f"{other}, {along}, {number(-factor)}" for (other, along), factor in others.items())]
        return lines

    def tie(self, end: int | None, ends: Sequence[tuple[int, float]], along: Numbers, turned: bool = False) -> None:
        """As of :class:`Bricks`.

        :param turned: rotations of the nodes in place of their displacements
        """
        before = self.count if turned else 0
        terms = [(before + int(node) + 1, axis + 1, -sign * float(along[axis])) for node, sign in ends
                 for axis in range(3)]
        self.equate(terms if end is None else [(end, 1, 1.0), *terms], first=end is not None)

    def carried(self, node: int, turned: int, arm: Numbers, axis: int) -> list[Term]:
        """Return minus the displacement, along an axis 0 to 2, of a point on an arm of a node of the deck."""
        one, two = (axis + 1) % 3, (axis + 2) % 3
        return [(node, axis + 1, -1.0), (turned, one + 1, -float(arm[two])), (turned, two + 1, float(arm[one]))]

    def add_node(self, where: Numbers) -> int:
        """Add a node; return its number."""
        self.nodes.append(f"{self.first}, " + ", ".join(map(number, where)))
        self.first += 1
        return self.first - 1


def rigid_bodies(frame: Frame) -> None:
    """Hold the nodes of rigid bodies on the arms of their masters."""
    bodies, at = frame.truss.joints["rigid"], frame.truss.nodes.position_m
    for master, node, holds in zip(bodies.master.tolist(), bodies.node.tolist(), bodies.holds):
        turned = frame.count + master + 1
        for axis in range(3):
            if holds[axis]:
                arm = at[node] - at[master]
                frame.equate([(node + 1, axis + 1, 1.0), *frame.carried(master + 1, turned, arm, axis)])
            if holds[3 + axis]:
                frame.equate([(frame.count + node + 1, axis + 1, 1.0), (turned, axis + 1, -1.0)])


def hinges(frame: Frame, rigid: float) -> None:
    """Add the hinges: equal displacements of their nodes, equal rotations across the axis, and bricks whose elongation
    is the rotation about it. One brick yields at the friction moment; another is the stiffness.

    :param rigid: stiffness of sticking friction [N m/rad]
    """
    joints, elastic = frame.truss.joints["hinge"], frame.truss.sticking != "rigid"
    for place, (one, two) in enumerate(joints.nodes.tolist()):
        axis = joints.axis[place]
        for along in np.eye(3):
            frame.tie(None, [(two, 1.0), (one, -1.0)], along)
        ends = [(two, 1.0), (one, -1.0)]
        for across in np.linalg.svd(axis[None])[2][1:]:
            frame.tie(None, ends, across, turned=True)
        friction, stiffness = float(joints.friction_moment_N_m[place]), float(joints.stiffness_N_m_per_rad[place])
        play, preload = float(joints.deadband_rad[place]), float(joints.preload_moment_N_m[place])
        sticks = float(joints.friction_stiffness_N_m_per_rad[place]) if elastic else rigid
        # CalculiX iterates only if a brick may yield, also for the spring beyond the play.
        bound = friction or stiffness * play or None
        parts = [(sticks if friction else WEAK * rigid, bound)]
        if stiffness and not play:
            parts.append((stiffness, None))
        for part, most in parts:
            end = frame.brick(STRETCH, part * STRETCH, 0.0, most)
            frame.tie(end, ends, axis, turned=True)
        if stiffness and play:
            frame.springs.append((end, play, stiffness))
        if preload:
            frame.loads += [f"{frame.count + node + 1}, {along + 1}, {number(-sign * preload * float(axis[along]))}"
                            for node, sign in ends for along in range(3) if frame.turns[node, along] and axis[along]]


def springs(frame: Frame) -> None:
    """Add the springs: bricks whose elongation is that of the spring. A preload acts on the nodes."""
    items, at = frame.truss.elements["spring"], frame.truss.nodes.position_m
    for (one, two), stiffness, preload in zip(items.nodes.tolist(), items.stiffness_N_per_m, items.preload_N):
        length = float(np.linalg.norm(at[two] - at[one]))
        along = (at[two] - at[one]) / length
        end = frame.brick(STRETCH * length, float(stiffness) * STRETCH * length, 0.0, None)
        frame.tie(end, [(two, 1.0), (one, -1.0)], along)
        if preload:
            frame.loads += [f"{node + 1}, {axis + 1}, {number(sign * float(preload) * float(along[axis]))}"
                            for node, sign in ((one, 1.0), (two, -1.0)) for axis in range(3)
                            if along[axis] and not frame.truss.nodes.fixed[node, axis]]


def beams(frame: Frame) -> None:
    """Add the bricks of the beams and the equations of their end faces."""
    items, at = frame.truss.elements["beam"], frame.truss.nodes.position_m
    for index, nodes in enumerate(items.nodes.tolist()):
        offsets = items.offset_first_m[index], items.offset_second_m[index]
        first, second = (at[node] + offset for node, offset in zip(nodes, offsets))
        length = float(np.linalg.norm(second - first))
        along = (second - first) / length
        triad = np.array([along, items.axis_y[index], np.cross(along, items.axis_y[index])])
        area, (about_y, about_z) = items.cross_section_area_m2[index], items.second_moments_of_area_m4[index]
        frame.sides.append((float(np.sqrt(12 * about_z / area)), float(np.sqrt(12 * about_y / area))))
        holders = [_holder(frame, index, end, offsets[end], triad) for end in range(2)]
        made = _bricks(frame, index, first, length, triad)
        _material(frame, index, triad, length)
        for (x, y, z), node in made.items():
            if x not in (0, 2 * frame.parts):
                continue
            (carrier, turned), offset = holders[x > 0]
            arm = offset + y / 2 * frame.sides[-1][0] * triad[1] + z / 2 * frame.sides[-1][1] * triad[2]
            for axis in range(3):
                frame.equate([(node, axis + 1, 1.0), *frame.carried(carrier, turned, arm, axis)], first=True)


def _holder(frame: Frame, index: int, end: int, offset: Numbers, triad: Numbers) -> tuple[tuple[int, int], Numbers]:
    """Return the nodes of the deck whose displacements and rotations move an end face, and the arm from there to its
    centre. An end with releases has its own nodes, tied to the node of the structure except for what it releases."""
    items = frame.truss.elements["beam"]
    node = int(items.nodes[index, end])
    outer = node + 1, frame.count + node + 1
    released = (items.released_first, items.released_second)[end][index]
    if not released.any():
        return outer, offset
    own = frame.add_node(np.zeros(3)), frame.add_node(np.zeros(3))
    for local, along in enumerate(triad):
        if local or not released[0]:
            terms = [(own[0], axis + 1, float(along[axis])) for axis in range(3)]
            for axis in range(3):
                terms += [(to, way, float(along[axis]) * factor)
                          for to, way, factor in frame.carried(*outer, offset, axis)]
            frame.equate(terms)
        if not released[1 + local]:
            frame.equate([(to, axis + 1, sign * float(along[axis])) for to, sign in ((own[1], 1.0), (outer[1], -1.0))
                          for axis in range(3)])
    return own, np.zeros(3)


def _bricks(frame: Frame, index: int, first: Numbers, length: float, triad: Numbers) -> dict[tuple[int, ...], int]:
    """Add the bricks of a beam; return its nodes by position."""
    made: dict[tuple[int, ...], int] = {}
    sides = frame.sides[-1]

    def at(place: tuple[int, int, int]) -> int:
        if place not in made:
            x, y, z = place[0] / (2 * frame.parts) * length, place[1] / 2 * sides[0], place[2] / 2 * sides[1]
            made[place] = frame.add_node(first + x * triad[0] + y * triad[1] + z * triad[2])
            frame.heated.append((index, made[place], y, z))
        return made[place]

    numbers = range(frame.element + 1, frame.element + frame.parts + 1)
    frame.sections.append(f"*ELEMENT, TYPE=C3D20R, ELSET=B{index + 1}")
    for part, brick in enumerate(numbers):
        words = [str(at((2 * part + 1 + x, y, z))) for x, y, z in PLACES]
        frame.sections += [", ".join([str(brick), *words[:10]]) + ",", ", ".join(words[10:])]
    frame.element += frame.parts
    frame.bending.append(list(numbers))
    return made


def _material(frame: Frame, index: int, triad: Numbers, length: float) -> None:
    items, (height, width) = frame.truss.elements["beam"], frame.sides[index]
    area, young = height * width, float(items.axial_stiffness_N[index]) / (height * width)
    least = 12 * items.bending_stiffness_N_m2[index, ::-1] / (LEAST_SHEAR * length**2)  # for forces along y and z
    shear = [young / 2] * 2 if frame.even_shear else [
        float(min(stiff, most)) / area for stiff, most in zip(items.shear_stiffness_N[index], least)]
    name = index + 1
    frame.sections += [
        f"*ORIENTATION, NAME=O{name}", ", ".join(number(value) for value in (*triad[0], *triad[1])),
        f"*MATERIAL, NAME=B{name}", "*ELASTIC, TYPE=ENGINEERING CONSTANTS",
        ", ".join([*[number(young)] * 3, "0., 0., 0.", *map(number, shear)]) + ",", f"{number(young / 2)}, 0.",
        "*EXPANSION, TYPE=ORTHO, ZERO=0.", f"{float(items.thermal_expansion_per_K[index]):.12E}, 0., 0.",
        f"*SOLID SECTION, ELSET=B{name}, MATERIAL=B{name}, ORIENTATION=O{name}"]


def section_moments(sides: Sequence[tuple[float, float]], bricks: Sequence[Sequence[int]],
                    stresses: dict[tuple[int, int], Numbers]) -> Numbers:
    """Return the bending moments (beams, 2 ends, 2) [N m] about y and z of the sections.

    The moment is linear along a beam. The four points of integration at each of two positions along a brick integrate
    it exactly, because stresses are linear over the section.

    :param stresses: σx and others by brick and point of integration, 1 to 8, in axes of the section
    """
    found = np.zeros((len(bricks), 2, 2))
    points = np.array(PLACES[:8])[[0, 1, 3, 2, 4, 5, 7, 6]]  # of integration, along the beam fastest
    for index, (numbers, (height, width)) in enumerate(zip(bricks, sides)):
        for end, brick in enumerate((numbers[0], numbers[-1])):
            along = np.array([stresses[brick, point + 1][0] for point in range(8)])
            at = []
            for side in (-1, 1):
                here = points[:, 0] == side
                lever = points[here, 1:] * (height, width) / np.sqrt(12.0)
                force = along[here] * height * width / 4
                at.append(np.array([(force * lever[:, 1]).sum(), -(force * lever[:, 0]).sum()]))
            far, near = (at[1], at[0]) if end == 0 else (at[0], at[1])
            found[index, end] = near + (near - far) * (np.sqrt(3.0) - 1) / 2
    return found
