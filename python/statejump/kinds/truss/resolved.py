# SPDX-License-Identifier: GPL-3.0-or-later
"""A truss as arrays, the same for solver, DEM and drawing.

Vectors have three components; the third is 0 in planar trusses. Items are numbered as in the file.
Index -1 stands for ground.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump.core.thermal import range_K
from statejump.kinds.truss.arrays import (
    GROUND, References, column, columns, distances, given_or, having, in_space, names, pairs, texts, unit, values,
    vectors,
)
from statejump.kinds.truss.expansions import link_temperatures
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.protocol import listed_joints
from statejump.kinds.truss.joints.revolute import Revolutes
from statejump.kinds.truss.joints.slider import Sliders
from statejump.kinds.truss.mechanism import Bodies, Drives, resolve_bodies, resolve_drives, weights_N
from statejump.schema.item_tables import Places, once

if TYPE_CHECKING:
    from statejump.core.temperature_files import MemberProgram
    from statejump.kinds.truss.case import TrussCase, TrussThermal

# Euler's load over that of pinned ends, by how the ends of a link are held: 4.493... is the first root of tan x = x.
FIXITY = {
    "pinned_pinned": 1.0, "clamped_pinned": (4.493409457909064 / np.pi) ** 2, "clamped_clamped": 4.0, "guided": inf,
}

# How contacts stick: not at all giving way, as springs, as springs that slide at their rim first.
STICKING = ("rigid", "elastic", "partial_slip")


@dataclass(frozen=True)
class Nodes:
    """Nodes, n of them."""

    names: Sequence[str]
    position_m: np.ndarray  # (n, 3), assembled shape at ΔT = 0
    fixed: np.ndarray  # (n, 3) bool: no motion along x, y, z; planar trusses: z everywhere
    guide_normal: np.ndarray  # (n, 3) unit, no motion along it; zero: none
    force_N: np.ndarray  # (n, 3) dead load, weights included
    mass_kg: np.ndarray  # (n,) of bodies at nodes, beside those of links


@dataclass(frozen=True)
class Links:
    """Bars, m of them."""

    names: Sequence[str]
    nodes: np.ndarray  # (m, 2) int
    young_modulus_Pa: np.ndarray
    cross_section_area_m2: np.ndarray
    thermal_expansion_per_K: np.ndarray  # with an [[expansion]] its largest |α|, the program then has ε/α
    stress_free_length_m: np.ndarray  # at ΔT = 0
    mass_kg: np.ndarray  # from the density: density · area · stress-free length; NaN: neither is given
    poisson_ratio: np.ndarray
    temperature_fraction: np.ndarray  # of the program's ΔT
    program: np.ndarray  # int, index into ResolvedTruss.programs
    shown_program: np.ndarray  # of the temperature itself, where that of an [[expansion]] has the strain
    shown_fraction: np.ndarray
    second_moment_of_area_m4: np.ndarray  # smallest one of the section
    ends: Sequence[str]  # keys of FIXITY
    yield_strength_Pa: np.ndarray  # inf: none is given

    @property
    def rigidity_N(self) -> np.ndarray:
        """E A of each [N]."""
        found: np.ndarray = self.young_modulus_Pa * self.cross_section_area_m2
        return found

    @property
    def euler_load_N(self) -> np.ndarray:
        """Compression [N] at which each buckles by itself, inf of a guided one: fixity · π² E I/l0²."""
        fixity = np.array([FIXITY[ends] for ends in self.ends])
        return fixity * np.pi**2 * self.young_modulus_Pa * self.second_moment_of_area_m4 / self.stress_free_length_m**2


@dataclass(frozen=True)
class Springs:
    """Springs and cables: tension stiffness · (length - free length), of a cable never below 0."""

    names: Sequence[str]
    nodes: np.ndarray  # (k, 2) int
    stiffness_N_per_m: np.ndarray
    free_length_m: np.ndarray  # below 0 when the preload exceeds stiffness · drawn length
    preload_N: np.ndarray  # tension of the drawn truss, below 0 for a slack cable
    cable: np.ndarray  # bool


@dataclass(frozen=True)
class TorsionSprings:
    """Springs on the angle from the first link to the second, both from their first to their second node,
    anticlockwise about the axis; moment stiffness · (angle - drawn angle - bias)."""

    names: Sequence[str]
    links: np.ndarray  # (t, 2) int; (link, GROUND): the angle of one link, from ground to it
    stiffness_N_m_per_rad: np.ndarray
    bias_rad: np.ndarray
    axis: np.ndarray  # (t, 3) unit; z in planar trusses


@dataclass(frozen=True)
class ReflectorSurface:
    """Nodes of the reflecting surface."""

    nodes: np.ndarray  # int
    axis: np.ndarray  # (3,) unit
    focal_length_m: float | None  # None: best fit


@dataclass(frozen=True)
class ResolvedTruss:
    """A whole truss. ``programs[0]`` is the common [thermal], then those that have names, then the histories of
    members, then those of links with an [[expansion]]; all of them last equally long."""

    name: str
    dimension: int
    nodes: Nodes
    links: Links
    bodies: Bodies  # shapes of the links
    joints: Mapping[str, Any]  # by section: the arrays of every type of joint
    springs: Springs
    torsion_springs: TorsionSprings
    drives: Drives
    programs: tuple[TrussThermal | MemberProgram, ...]
    program_names: tuple[str, ...]  # "thermal", those of the file, those of members, "EXPANSION of PROGRAM"
    reflector: ReflectorSurface | None
    sticking: str  # one of STICKING: contacts of the reduced model
    start_friction: str  # how it gets to its first equilibrium

    @property
    def temperature_ranges_K(self) -> np.ndarray:
        """Smallest and largest ΔT [K] (programs, 2) of every program."""
        return np.array([range_K(program) for program in self.programs])

    @property
    def sliders(self) -> Sliders:
        """Its sliders."""
        found: Sliders = self.joints["slider"]
        return found

    @property
    def revolutes(self) -> Revolutes:
        """Its clearance revolutes."""
        found: Revolutes = self.joints["revolute"]
        return found

    def with_joints(self, **changed: Any) -> ResolvedTruss:
        """Return the truss with other joints of the sections that are named."""
        return replace(self, joints={**self.joints, **changed})

    def joined(self) -> np.ndarray:
        """Return the pairs of nodes (k, 2) that joints hold together."""
        return np.concatenate([joint.joined(self.joints[joint.section]) for joint in JOINTS])

    def number_of_joints(self) -> int:
        """How many joints it has, of all types."""
        return sum(len(joints.names) for joints in self.joints.values())

    def turning_places(self, links: np.ndarray) -> np.ndarray:
        """Return where what turns links (k, 2) against each other is (k, 3)."""
        return self.nodes.position_m[self.turning_nodes(links)]

    def turning_nodes(self, links: np.ndarray) -> np.ndarray:
        """Return at which node what turns links (k, 2) against each other is (k,): the nearest end of both, else the
        first node of the one."""
        positions, nodes = self.nodes.position_m, []
        for one, two in links:
            first = self.links.nodes[one]
            if two == GROUND:
                nodes.append(first[0])
                continue
            apart = [(np.linalg.norm(positions[a] - positions[b]), a) for a in first for b in self.links.nodes[two]]
            nodes.append(min(apart)[1])
        return np.array(nodes, dtype=int)


def resolve(case: TrussCase) -> ResolvedTruss:
    """Return the arrays of a case. References must be right: ``checks`` sees to it when a case is read."""
    dimension = case.truss.dimension
    node_places, link_places = Places(case.node), Places(case.link)
    positions = vectors(case.node, "position_m", dimension)

    members = case.thermal.members
    member_number = {} if members is None else {
        name: index for index, name in enumerate(members.names, start=1 + len(case.program))
    }

    known = References(dimension, node_places, link_places, Places(case.program), member_number)

    fixed = np.stack([having(case.node, "fixed", axis) for axis in "xyz"], axis=1)
    fixed[:, dimension:] = True
    nodes = Nodes(
        names=names(case.node),
        position_m=positions,
        fixed=fixed,
        guide_normal=unit(vectors(case.node, "guide_normal", dimension)),
        force_N=vectors(case.node, "force_N", dimension),
        mass_kg=column(case.node, "mass_kg"),
    )

    link_nodes = pairs(case.link, "nodes", node_places)
    length = column(case.link, "stress_free_length_m")
    length = given_or(length, distances(positions, link_nodes))
    link = columns(
        case.link, "young_modulus_Pa", "cross_section_area_m2", "thermal_expansion_per_K", "poisson_ratio",
    )
    program_names = ("thermal", *names(case.program), *(() if members is None else members.names))
    warmed = link_temperatures(case, known.programs_of(case.link), program_names)
    if warmed.expanding.any():
        link["thermal_expansion_per_K"] = np.where(
            warmed.expanding, warmed.largest_per_K, link["thermal_expansion_per_K"])
    moment, strength = column(case.link, "second_moment_of_area_m4"), column(case.link, "yield_strength_Pa")
    mass = column(case.link, "mass_kg")
    mass = given_or(mass, column(case.link, "density_kg_per_m3") * link["cross_section_area_m2"] * length)
    bodies = resolve_bodies(case.link, length, mass)
    gravity = in_space(case.truss.gravity_m_per_s2, dimension)
    if gravity.any():
        nodes = replace(nodes, force_N=nodes.force_N + weights_N(gravity, link_nodes, mass, bodies, nodes.mass_kg))
    links = Links(
        names=names(case.link), nodes=link_nodes, stress_free_length_m=length, mass_kg=mass, program=warmed.program,
        temperature_fraction=warmed.temperature_fraction, shown_program=warmed.shown_program,
        shown_fraction=warmed.shown_fraction, **link,
        second_moment_of_area_m4=once(given_or(moment, link["cross_section_area_m2"] ** 2 / 12)),
        ends=texts(case.link, "ends"), yield_strength_Pa=given_or(strength, inf),
    )

    spring_nodes = pairs(case.spring, "nodes", node_places)
    drawn = distances(positions, spring_nodes)
    stiffness = column(case.spring, "stiffness_N_per_m")
    free, preload = column(case.spring, "free_length_m"), column(case.spring, "preload_N")
    preload = once(np.where(np.isnan(free), np.nan_to_num(preload), stiffness * (drawn - free)))
    with np.errstate(over="ignore"):  # refused by the checks
        stretch = preload / stiffness
    springs = Springs(
        names=names(case.spring), nodes=spring_nodes, stiffness_N_per_m=stiffness,
        free_length_m=given_or(free, drawn - stretch), preload_N=preload,
        cable=np.array(list(values(case.spring, "cable")), dtype=bool),
    )
    torsion_springs = TorsionSprings(
        names=names(case.torsion_spring), links=pairs(case.torsion_spring, "links", link_places),
        axis=known.axes(case.torsion_spring),
        **columns(case.torsion_spring, "stiffness_N_m_per_rad", "bias_rad"),
    )
    reflector = None
    if case.reflector is not None:
        reflector = ReflectorSurface(
            nodes=node_places.called(case.reflector.nodes),
            axis=unit(in_space(case.reflector.axis, dimension)),
            focal_length_m=case.reflector.focal_length_m,
        )
    return ResolvedTruss(
        name=case.name, dimension=dimension, nodes=nodes, links=links, bodies=bodies,
        joints={joint.section: joint.resolve(listed_joints(case, joint), known) for joint in JOINTS},
        springs=springs, torsion_springs=torsion_springs, drives=resolve_drives(case.drive, known),
        programs=warmed.programs,
        program_names=warmed.program_names,
        reflector=reflector,
        sticking=case.reduced.sticking,
        start_friction=case.start.friction,
    )
