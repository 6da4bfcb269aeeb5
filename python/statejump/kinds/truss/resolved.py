# SPDX-License-Identifier: GPL-3.0-or-later
"""A truss as arrays, the same for solver, DEM and drawing.

Vectors have three components; the third is 0 in planar trusses. Items are numbered as in the file.
Index -1 stands for ground.
"""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from statejump.core.temperature_files import MemberProgram
    from statejump.schema.items import Item
    from statejump.kinds.truss.case import TrussCase, TrussThermal

GROUND = -1


@dataclass(frozen=True)
class Nodes:
    """Nodes, n of them."""

    names: tuple[str, ...]
    position_m: np.ndarray  # (n, 3), assembled shape at ΔT = 0
    fixed: np.ndarray  # (n, 3) bool: no motion along x, y, z; planar trusses: z everywhere
    guide_normal: np.ndarray  # (n, 3) unit, no motion along it; zero: none
    force_N: np.ndarray  # (n, 3) dead load


@dataclass(frozen=True)
class Links:
    """Bars, m of them."""

    names: tuple[str, ...]
    nodes: np.ndarray  # (m, 2) int
    young_modulus_Pa: np.ndarray
    cross_section_area_m2: np.ndarray
    thermal_expansion_per_K: np.ndarray
    stress_free_length_m: np.ndarray  # at ΔT = 0
    mass_kg: np.ndarray  # from the density: density · area · stress-free length; NaN: neither is given
    poisson_ratio: np.ndarray
    temperature_fraction: np.ndarray  # of the program's ΔT
    program: np.ndarray  # int, index into ResolvedTruss.programs


@dataclass(frozen=True)
class Sliders:
    """Prismatic joints: axis · (motion of the first node - motion of the second) slides, against friction
    friction_coefficient · normal_force_N, from -clearance_minus_m to clearance_plus_m."""

    names: tuple[str, ...]
    nodes: np.ndarray  # (s, 2) int, the second GROUND or a node that is held to the first across the axis
    axis: np.ndarray  # (s, 3) unit
    friction_coefficient: np.ndarray
    normal_force_N: np.ndarray
    clearance_minus_m: np.ndarray  # inf: no stop
    clearance_plus_m: np.ndarray  # inf: no stop
    pad_radius_m: np.ndarray
    young_modulus_Pa: np.ndarray
    poisson_ratio: np.ndarray


@dataclass(frozen=True)
class Revolutes:
    """Clearance revolute joints."""

    names: tuple[str, ...]
    bearing_node: np.ndarray  # int
    journal_node: np.ndarray  # int
    bearing_link: np.ndarray  # int, GROUND: the bearing does not turn
    journal_link: np.ndarray  # int, GROUND: the journal does not turn
    axis: np.ndarray  # (r, 3) unit; z in planar trusses
    journal_radius_m: np.ndarray
    radial_clearance_m: np.ndarray  # at ΔT = 0
    friction_coefficient: np.ndarray
    journal_thermal_expansion_per_K: np.ndarray
    bearing_thermal_expansion_per_K: np.ndarray
    temperature_fraction: np.ndarray
    program: np.ndarray  # int, index into ResolvedTruss.programs
    young_modulus_Pa: np.ndarray
    poisson_ratio: np.ndarray
    rigid: np.ndarray  # bool: contact = "rigid" in the reduced model

    @property
    def bearing_radius_m(self) -> np.ndarray:
        """Radius of the bearing at ΔT = 0 [m]."""
        return self.journal_radius_m + self.radial_clearance_m

    def clearance_m(self, temperature_change_K: Any) -> np.ndarray:
        """Return the radial clearance [m] where the joints are at these ΔT [K] (fraction included)."""
        return self.radial_clearance_m + temperature_change_K * (
            self.bearing_thermal_expansion_per_K * self.bearing_radius_m
            - self.journal_thermal_expansion_per_K * self.journal_radius_m
        )


@dataclass(frozen=True)
class Springs:
    """Springs and cables: tension stiffness · (length - free length), of a cable never below 0."""

    names: tuple[str, ...]
    nodes: np.ndarray  # (k, 2) int
    stiffness_N_per_m: np.ndarray
    free_length_m: np.ndarray  # below 0 when the preload exceeds stiffness · drawn length
    preload_N: np.ndarray  # tension of the drawn truss, below 0 for a slack cable
    cable: np.ndarray  # bool


@dataclass(frozen=True)
class TorsionSprings:
    """Springs on the angle from the first link to the second, both from their first to their second node,
    anticlockwise about the axis; moment stiffness · (angle - drawn angle - bias)."""

    names: tuple[str, ...]
    links: np.ndarray  # (t, 2) int; (link, GROUND): the angle of one link, from ground to it
    stiffness_N_m_per_rad: np.ndarray
    bias_rad: np.ndarray
    axis: np.ndarray  # (t, 3) unit; z in planar trusses


@dataclass(frozen=True)
class LatchHinges:
    """Hinges with free play, stiffness beyond it and friction on the angle that torsion springs have."""

    names: tuple[str, ...]
    links: np.ndarray  # (h, 2) int; (link, GROUND): the angle of one link, from ground to it
    deadband_rad: np.ndarray
    stiffness_N_m_per_rad: np.ndarray
    friction_moment_N_m: np.ndarray
    preload_moment_N_m: np.ndarray
    axis: np.ndarray  # (h, 3) unit; z in planar trusses


@dataclass(frozen=True)
class ReflectorSurface:
    """Nodes of the reflecting surface."""

    nodes: np.ndarray  # int
    axis: np.ndarray  # (3,) unit
    focal_length_m: float | None  # None: best fit


@dataclass(frozen=True)
class ResolvedTruss:
    """A whole truss. ``programs[0]`` is the common [thermal], then those that have names, then the histories of
    members; all of them last equally long."""

    name: str
    dimension: int
    nodes: Nodes
    links: Links
    sliders: Sliders
    revolutes: Revolutes
    springs: Springs
    torsion_springs: TorsionSprings
    latch_hinges: LatchHinges
    programs: tuple[TrussThermal | MemberProgram, ...]
    program_names: tuple[str, ...]  # "thermal", those of the file, those of members
    reflector: ReflectorSurface | None
    sticking: str  # "rigid" or "elastic": contacts of the reduced model


def column(items: Sequence[Item], key: str) -> np.ndarray:
    """Return one number of every item; NaN where it is not given."""
    return np.array([getattr(item, key) for item in items], dtype=float)


def names(items: Sequence[Item]) -> tuple[str, ...]:
    """Return the names of the items."""
    return tuple(item.name for item in items)


def numbering(items: Iterable[Item]) -> dict[str | None, int]:
    """Return the index of every name; that of no name is GROUND."""
    return {None: GROUND, **{item.name: index for index, item in enumerate(items)}}


def vectors(values: Sequence[Sequence[float] | None], dimension: int) -> np.ndarray:
    """Return vectors (n, 3) of 2 or 3 numbers each, zero where there is none."""
    none = (0.0,) * dimension
    given = np.array([none if value is None else value for value in values], dtype=float).reshape(-1, dimension)
    found = np.zeros((len(given), 3))
    found[:, :dimension] = given
    return found


def unit(given: np.ndarray) -> np.ndarray:
    """Return vectors (n, 3) of length 1; a zero vector stays."""
    lengths = np.linalg.norm(given, axis=-1, keepdims=True)
    return given / np.where(lengths > 0, lengths, 1.0)


def _axes(items: Sequence[Any], dimension: int) -> np.ndarray:
    """Axes of rotation: z in the plane."""
    if dimension == 2:
        return np.tile([0.0, 0.0, 1.0], (len(items), 1))
    return unit(vectors([item.axis for item in items], dimension))


def _pairs(items: Sequence[Any], key: str, number: dict[str | None, int]) -> np.ndarray:
    pairs = [[number[name] for name in getattr(item, key)] for item in items]
    return np.array([(pair + [GROUND])[:2] for pair in pairs], dtype=int).reshape(-1, 2)


def distances(position_m: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Return the distances [m] between the nodes of each pair."""
    return np.linalg.norm(position_m[pairs[:, 1]] - position_m[pairs[:, 0]], axis=1)


def resolve(case: TrussCase) -> ResolvedTruss:
    """Return the arrays of a case. References must be right: ``checks`` sees to it when a case is read."""
    dimension = case.truss.dimension
    node_number, link_number = numbering(case.node), numbering(case.link)
    program_number = {name: index + 1 for name, index in numbering(case.program).items()}
    positions = vectors([node.position_m for node in case.node], dimension)

    members = case.thermal.members
    member_number = {} if members is None else {
        name: index for index, name in enumerate(members.names, start=1 + len(case.program))
    }

    def indices(items: Sequence[Any], key: str, number: dict[str | None, int]) -> np.ndarray:
        return np.array([number[getattr(item, key)] for item in items], dtype=int)

    def programs_of(items: Sequence[Any]) -> np.ndarray:
        return np.array([member_number.get(item.name, 0) if item.program is None else program_number[item.program]
                         for item in items], dtype=int)

    fixed = np.array([[axis in node.fixed for axis in "xyz"] for node in case.node], dtype=bool)
    fixed[:, dimension:] = True
    nodes = Nodes(
        names=names(case.node),
        position_m=positions,
        fixed=fixed,
        guide_normal=unit(vectors([node.guide_normal for node in case.node], dimension)),
        force_N=vectors([node.force_N for node in case.node], dimension),
    )

    def columns(items: Sequence[Any], *keys: str) -> dict[str, np.ndarray]:
        return {key: column(items, key) for key in keys}

    link_nodes = _pairs(case.link, "nodes", node_number)
    length = column(case.link, "stress_free_length_m")
    length = np.where(np.isnan(length), distances(positions, link_nodes), length)
    link = columns(
        case.link, "young_modulus_Pa", "cross_section_area_m2", "thermal_expansion_per_K", "poisson_ratio",
        "temperature_fraction",
    )
    mass = column(case.link, "mass_kg")
    weighed = column(case.link, "density_kg_per_m3") * link["cross_section_area_m2"] * length
    links = Links(
        names=names(case.link), nodes=link_nodes, stress_free_length_m=length,
        mass_kg=np.where(np.isnan(mass), weighed, mass), program=programs_of(case.link), **link,
    )

    stops = columns(case.slider, "clearance_minus_m", "clearance_plus_m")
    sliders = Sliders(
        names=names(case.slider), nodes=_pairs(case.slider, "nodes", node_number),
        axis=unit(vectors([slider.axis for slider in case.slider], dimension)),
        **columns(case.slider, "friction_coefficient", "normal_force_N", "pad_radius_m", "young_modulus_Pa",
                  "poisson_ratio"),
        **{key: np.where(np.isnan(values), inf, values) for key, values in stops.items()},
    )
    revolutes = Revolutes(
        names=names(case.revolute),
        **{key: indices(case.revolute, key, node_number) for key in ("bearing_node", "journal_node")},
        **{key: indices(case.revolute, key, link_number) for key in ("bearing_link", "journal_link")},
        axis=_axes(case.revolute, dimension),
        program=programs_of(case.revolute),
        rigid=np.array([revolute.contact == "rigid" for revolute in case.revolute], dtype=bool),
        **columns(
            case.revolute, "journal_radius_m", "radial_clearance_m", "friction_coefficient",
            "journal_thermal_expansion_per_K", "bearing_thermal_expansion_per_K", "temperature_fraction",
            "young_modulus_Pa", "poisson_ratio",
        ),
    )

    spring_nodes = _pairs(case.spring, "nodes", node_number)
    drawn = distances(positions, spring_nodes)
    stiffness = column(case.spring, "stiffness_N_per_m")
    free, preload = column(case.spring, "free_length_m"), column(case.spring, "preload_N")
    preload = np.where(np.isnan(free), np.nan_to_num(preload), stiffness * (drawn - free))
    springs = Springs(
        names=names(case.spring), nodes=spring_nodes, stiffness_N_per_m=stiffness,
        free_length_m=np.where(np.isnan(free), drawn - preload / stiffness, free), preload_N=preload,
        cable=np.array([spring.cable for spring in case.spring], dtype=bool),
    )
    torsion_springs = TorsionSprings(
        names=names(case.torsion_spring), links=_pairs(case.torsion_spring, "links", link_number),
        axis=_axes(case.torsion_spring, dimension),
        **columns(case.torsion_spring, "stiffness_N_m_per_rad", "bias_rad"),
    )
    latch_hinges = LatchHinges(
        names=names(case.latch_hinge), links=_pairs(case.latch_hinge, "links", link_number),
        axis=_axes(case.latch_hinge, dimension),
        **columns(case.latch_hinge, "deadband_rad", "stiffness_N_m_per_rad", "friction_moment_N_m",
                  "preload_moment_N_m"),
    )
    reflector = None
    if case.reflector is not None:
        reflector = ReflectorSurface(
            nodes=np.array([node_number[name] for name in case.reflector.nodes], dtype=int),
            axis=unit(vectors([case.reflector.axis], dimension))[0],
            focal_length_m=case.reflector.focal_length_m,
        )
    return ResolvedTruss(
        name=case.name, dimension=dimension, nodes=nodes, links=links, sliders=sliders, revolutes=revolutes,
        springs=springs, torsion_springs=torsion_springs, latch_hinges=latch_hinges, programs=tuple(case.programs),
        program_names=("thermal", *names(case.program), *(() if members is None else members.names)),
        reflector=reflector,
        sticking=case.reduced.sticking,
    )
