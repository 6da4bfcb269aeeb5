# SPDX-License-Identifier: GPL-3.0-or-later
"""A truss as arrays for solver, DEM and drawing; :mod:`.resolve` makes it from a case.

Vectors have three components; the third is 0 in planar trusses. Items are numbered as in the file. Index -1 means the
ground.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any, ClassVar, Protocol

import numpy as np

from statejump.core.thermal import MemberProgram, Thermal, range_K
from statejump.kinds.truss.arrays import GROUND
from statejump.kinds.truss.constraints import Constraints
from statejump.kinds.truss.means import Means
from statejump.kinds.truss.mechanism import Bodies, Drives

# Ratio of Euler's load to that with pinned ends, by the supports of the link's ends; 4.493... solves tan x = x.
FIXITY = {
    "pinned_pinned": 1.0, "clamped_pinned": (4.493409457909064 / np.pi) ** 2, "clamped_clamped": 4.0, "guided": inf,
}

# Models of sticking contacts: rigid, elastic (springs), or partial slip that begins at the rim of the contact.
STICKING = ("rigid", "elastic", "partial_slip")


@dataclass(frozen=True)
class Nodes:
    """Nodes, n of them."""

    names: Sequence[str]
    position_m: np.ndarray  # (n, 3) reference configuration at ΔT = 0
    fixed: np.ndarray  # (n, 3) bool: no motion along x, y, z; planar trusses: z everywhere
    guide_normal: np.ndarray  # (n, 3) unit vector without motion along it; zero: none
    force_N: np.ndarray  # (n, 3) dead load, including weights
    mass_kg: np.ndarray  # (n,) lumped masses, in addition to those of links
    # Where beams end:
    fixed_rotations: np.ndarray  # (n, 3) bool: no rotation about x, y, z; planar trusses: x and y everywhere
    moment_N_m: np.ndarray  # (n, 3)
    rotates: np.ndarray  # (n,) bool: beams, rigid bodies, hinges or means rotate it


@dataclass(frozen=True)
class Links:
    """Bars, m of them."""

    names: Sequence[str]
    nodes: np.ndarray  # (m, 2) int
    young_modulus_Pa: np.ndarray
    cross_section_area_m2: np.ndarray
    thermal_expansion_per_K: np.ndarray  # with an [[expansion]], its largest |α|; `program` is then that of ε/α
    stress_free_length_m: np.ndarray  # at ΔT = 0
    mass_kg: np.ndarray  # density · area · stress-free length; NaN: no density
    poisson_ratio: np.ndarray
    temperature_fraction: np.ndarray  # fraction of the program's ΔT
    program: np.ndarray  # int, index into ResolvedTruss.programs
    shown_program: np.ndarray  # program of the temperature; for an [[expansion]], `program` is that of ε/α
    shown_fraction: np.ndarray
    second_moment_of_area_m4: np.ndarray  # smallest one of the section
    ends: Sequence[str]  # keys of FIXITY
    yield_strength_Pa: np.ndarray  # inf: missing

    @property
    def axial_stiffness_N(self) -> np.ndarray:
        """E A of each [N]."""
        found: np.ndarray = self.young_modulus_Pa * self.cross_section_area_m2
        return found

    @property
    def euler_load_N(self) -> np.ndarray:
        """Compression [N] at which each link buckles by itself, fixity · π² E I/l0²; infinite for a guided link."""
        fixity = np.array([FIXITY[ends] for ends in self.ends])
        return fixity * np.pi**2 * self.young_modulus_Pa * self.second_moment_of_area_m4 / self.stress_free_length_m**2


@dataclass(frozen=True)
class ReflectorSurface:
    """Nodes of the reflecting surface."""

    nodes: np.ndarray  # int; points of bodies come after all nodes
    axis: np.ndarray  # (3,) unit
    focal_length_m: float | None  # None: best fit


class PullsNodes(Protocol):
    """Functions of an element type that a truss uses."""

    section: ClassVar[str]
    bends: ClassVar[bool]

    def ends(self, elements: Any) -> np.ndarray:
        """Return the pairs of nodes (k, 2) that the elements connect."""

    def stiffness_N_per_m(self, elements: Any) -> np.ndarray:
        """Return the largest stiffness (k,) [N/m] between the two nodes of each element."""

    def tension_N(self, elements: Any, states: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return the tension (states, k) [N] between the ends."""


class JoinsNodes(Protocol):
    """Functions of a joint type that a truss uses."""

    section: ClassVar[str]
    bends: ClassVar[bool]

    def joined(self, joints: Any) -> np.ndarray:
        """Return the pairs of nodes (k, 2) that the joints couple."""


@dataclass(frozen=True)
class ResolvedTruss:
    """A truss as arrays. ``programs[0]`` is the common program [thermal]. Named programs, histories of members, and
    programs of links with an [[expansion]] follow. All programs have the same duration."""

    name: str
    dimension: int
    nodes: Nodes
    links: Links
    bodies: Bodies  # shapes of the links
    joints: Mapping[str, Any]  # arrays of every joint type, by section
    elements: Mapping[str, Any]  # arrays of every element type except links, by section
    constraints: Constraints  # including those of the means
    means: Means
    drives: Drives
    programs: tuple[Thermal | MemberProgram, ...]
    program_names: tuple[str, ...]  # "thermal", names of the file, names of members, "EXPANSION of PROGRAM"
    reflector: ReflectorSurface | None
    sticking: str  # one of STICKING: model of sticking contacts
    start_friction: str  # stuck or frictionless
    free: bool  # whether supports may be missing
    types: Sequence[JoinsNodes]  # joint types in the order of results
    element_types: Sequence[PullsNodes]  # likewise

    @property
    def temperature_ranges_K(self) -> np.ndarray:
        """Smallest and largest ΔT [K] (programs, 2) of every program."""
        return np.array([range_K(program) for program in self.programs])

    @property
    def sliders(self) -> Any:
        """Its sliders, as :class:`.joints.slider.Sliders`."""
        return self.joints["slider"]

    @property
    def revolutes(self) -> Any:
        """Its clearance revolutes, as :class:`.joints.revolute.Revolutes`."""
        return self.joints["revolute"]

    @property
    def springs(self) -> Any:
        """Its springs and cables, as :class:`.elements.spring.Springs`."""
        return self.elements["spring"]

    def bending(self) -> tuple[str, str] | None:
        """Return the section and the name of the first element, joint or mean that rotates nodes; None if none does."""
        parts = [(one, self.elements) for one in self.element_types] + [(one, self.joints) for one in self.types]
        for part, arrays in parts:
            for name in arrays[part.section].names if part.bends else ():
                return part.section, name
        for name in self.means.turning:
            return "mean", name
        return None

    def with_elements(self, **changed: Any) -> ResolvedTruss:
        """Return the truss with other elements in the named sections."""
        return replace(self, elements={**self.elements, **changed})

    def ends(self) -> list[np.ndarray]:
        """Return the pairs of nodes (k, 2) of links and of the elements of each type."""
        return [self.links.nodes, *(element.ends(self.elements[element.section]) for element in self.element_types)]

    def element_stiffnesses_N_per_m(self) -> list[np.ndarray]:
        """Return the largest stiffness (k,) [N/m] between the ends of the elements of each type."""
        return [element.stiffness_N_per_m(self.elements[element.section]) for element in self.element_types]

    def tensions_N(self, states: Mapping[str, np.ndarray]) -> list[np.ndarray]:
        """Return the tensions (states, k) [N] of links and of the elements of each type, ordered as :meth:`ends`."""
        of_elements = (element.tension_N(self.elements[element.section], states) for element in self.element_types)
        return [-states["axial_force_N"], *of_elements]

    def with_joints(self, **changed: Any) -> ResolvedTruss:
        """Return the truss with other joints in the named sections."""
        return replace(self, joints={**self.joints, **changed})

    def joined(self) -> np.ndarray:
        """Return the pairs of nodes (k, 2) that joints couple."""
        return np.concatenate([joint.joined(self.joints[joint.section]) for joint in self.types])

    def number_of_joints(self) -> int:
        """Number of its joints, of all types."""
        return sum(len(joints.names) for joints in self.joints.values())

    def turning_places(self, links: np.ndarray) -> np.ndarray:
        """Return the positions (k, 3) of items that rotate two links (k, 2) relative to each other."""
        return self.nodes.position_m[self.turning_nodes(links)]

    def turning_nodes(self, links: np.ndarray) -> np.ndarray:
        """Return the nodes (k,) of items that rotate two links (k, 2) relative to each other. The node is the common
        end of both links, or the first node of a single link."""
        positions, nodes = self.nodes.position_m, []
        for one, two in links:
            first = self.links.nodes[one]
            if two == GROUND:
                nodes.append(first[0])
                continue
            apart = [(np.linalg.norm(positions[a] - positions[b]), a) for a in first for b in self.links.nodes[two]]
            nodes.append(min(apart)[1])
        return np.array(nodes, dtype=int)


class Course(Protocol):
    """A quasi-static path or a motion."""

    @property
    def truss(self) -> ResolvedTruss:
        """The truss."""

    @property
    def states(self) -> dict[str, np.ndarray]:
        """As of :class:`.solve.TrussPath`."""
