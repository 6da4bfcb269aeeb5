# SPDX-License-Identifier: GPL-3.0-or-later
"""Condensed bodies: linear structures of a finite-element program between nodes of the truss."""
from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from statejump.bodies.body import CondensedBody
from statejump.bodies.checks import radius
from statejump.bodies.placing import Placed, axes_of, placed
from statejump.core.errors import MissingKey, NotAllowed
from statejump.core.notes import Note
from statejump.kinds.truss.arrays import References
from statejump.kinds.truss.elements.protocol import ElementType, Lines
from statejump.kinds.truss.joints.protocol import ItemColumn
from statejump.kinds.truss.references import known_name
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import attached, definition, numbers, parameter, text, texts
from statejump.schema.items import Item

BROWN = "#A6761D"
# Nodes may be beside the interface nodes by this fraction of the size of a body: deck positions have few digits.
BESIDE = 1e-5
# The neglected shortening of a bent body is noted above this fraction of its thermal strain, and above the strain that
# jumps of 1e-9 of the size resolve.
NEGLECTED, LEAST_STRAIN = 0.01, 1e-9


@definition
class Body(Item):
    """A body whose linear stiffness, thermal shapes and mass a file contains, see ``statejump body``."""

    body_file: str | None = text(None, "HDF5 file of the body, beside the case file")
    content: CondensedBody | None = attached("it is read from body_file")
    nodes: list[str] = texts(..., "the nodes at its interface nodes")
    interface: list[str] | None = texts(None, "of its interface nodes, one for each of the nodes; as in the file")
    position_m: list[float] | None = numbers(None, "m", -1e6, 1e6, "of the body's origin; 0", length=3)
    axis_x: list[float] | None = numbers(None, "-", -1e9, 1e9, "direction of the body's axis x; x", length=3)
    axis_y: list[float] | None = numbers(None, "-", -1e9, 1e9, "direction of the body's axis y; y", length=3)
    patterns: list[str] | None = texts(None, "names of its thermal patterns that act; the only one of the file")
    temperature_fractions: list[float] | None = numbers(
        None, "-", -1e6, 1e6, "of each pattern: its temperature over the ΔT of its program; 1")
    programs: list[str] | None = texts(None, "name of a [[program]] for each pattern; the common [thermal]")
    stiffness_factor: float = parameter(1.0, "-", 0, 1e6, "choice: as in the file", above=True)
    expansion_factor: float = parameter(1.0, "-", -1e6, 1e6, "choice: as in the file")


@dataclass(frozen=True)
class Bodies:
    """Condensed bodies, k of them; their tuples have one entry for each body."""

    names: Sequence[str]
    contents: tuple[CondensedBody, ...]
    nodes: tuple[np.ndarray, ...]  # (n,) int, in the order of the file
    placed: tuple[Placed, ...]  # in the axes of the truss
    patterns: tuple[np.ndarray, ...]  # (p,) int: of the file
    programs: tuple[np.ndarray, ...]  # (p,) int
    temperature_fractions: tuple[np.ndarray, ...]  # (p,)
    stiffness_factor: np.ndarray  # (k,)
    expansion_factor: np.ndarray  # (k,)

    @cached_property
    def ends(self) -> np.ndarray:
        """Pairs of nodes (m, 2): the first node of each body with its others."""
        pairs = [(nodes[0], node) for nodes in self.nodes for node in nodes[1:]]
        return np.array(pairs, dtype=np.int32).reshape(-1, 2)

    def thermal_strain(self, index: int, ranges_K: np.ndarray) -> float:
        """Return the largest free thermal displacement of a body over its size.

        :param ranges_K: largest temperature changes of the programs
        """
        content, own = self.contents[index], self.placed[index]
        at = (own.starts[:, None] + np.arange(3)).ravel()
        shapes = np.abs(own.free_shapes[self.patterns[index]][:, at]).max(axis=1, initial=0.0)
        changes = ranges_K[self.programs[index]] * np.abs(self.temperature_fractions[index])
        return float(abs(self.expansion_factor[index]) * (shapes * changes).sum() / radius(content.node_positions_m))

    @property
    def weighed(self) -> tuple[Placed, ...]:
        """The bodies in the axes of the truss. :raises MissingKey: the file of a body has no mass"""
        for name, content in zip(self.names, self.contents):
            if content.mass is None:
                raise MissingKey("mass", code="mass_of_condensed_body_missing", item=f"body {name!r}")
        return self.placed

    @property
    def mass_kg(self) -> np.ndarray:
        """Mass of each body (k,) [kg]. :raises MissingKey: the file of a body has no mass"""
        return np.array([body.mass_kg for body in self.weighed])


class BodyType(ElementType[Body, Bodies]):
    """Condensed bodies, supported by the reduced models."""

    section = "body"
    Item = Body
    Arrays = Bodies
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("body_bending_rad", "largest rotation of an interface node relative to the body's frame"),
        ItemColumn("body_force_N", "largest force on an interface node"),
    )
    not_in_dem = "is a condensed body, the DEM has none yet"
    bends = True
    varied = ("stiffness_factor", "expansion_factor")

    @property
    def items(self) -> str:
        return "bodies"

    def may_be_wrong_keys(self, items: Any) -> np.ndarray:
        return np.full(len(items), True)

    def check_vectors(self, item: Body, dimension: int) -> None:
        where = self.where(item.name)
        if dimension != 3:
            raise NotAllowed("truss.dimension", dimension, code="planar_body", **where)
        axes_of(item.axis_x, item.axis_y, **where)

    def check_keys(self, item: Body) -> None:
        where = self.where(item.name)
        content = item.content
        if content is None:
            raise MissingKey("body_file", code="body_file_missing", **where)
        interface = list(content.node_names) if item.interface is None else item.interface
        for name in interface:
            known_name("interface", interface, name, dict.fromkeys(content.node_names), "interface node", **where)
        if sorted(interface) != sorted(content.node_names) or len(item.nodes) != len(interface):
            raise NotAllowed("nodes", item.nodes, code="body_nodes", interface_=", ".join(content.node_names),
                             count_=len(content.node_names), **where)
        for name in item.patterns or ():
            known_name("patterns", item.patterns, name, dict.fromkeys(content.pattern_names), "pattern", **where)
        count = len(_patterns(item, content))
        if item.patterns is None and count > 1:
            raise MissingKey("patterns", code="body_patterns_missing", patterns_=", ".join(content.pattern_names),
                             **where)
        for key in ("temperature_fractions", "programs"):
            given = getattr(item, key)
            if given is not None and len(given) != count:
                raise NotAllowed(key, given, code="body_one_each", count_=count, **where)

    def check_references(self, item: Body, nodes: Mapping[str, Any], links: Mapping[str, Any],
                         rotating: Container[str]) -> None:
        where = self.where(item.name)
        for name in item.nodes:
            known_name("nodes", item.nodes, name, nodes, "node", **where)
        if len(set(item.nodes)) < len(item.nodes):
            raise NotAllowed("nodes", item.nodes, code="body_node_repeated", **where)

    def resolve(self, items: Sequence[Body], known: References) -> Bodies:
        contents, nodes, bodies, patterns, programs, fractions = [], [], [], [], [], []
        for item in items:
            content = item.content
            assert content is not None
            interface = list(content.node_names) if item.interface is None else item.interface
            by_name = dict(zip(interface, known.node.called(item.nodes)))
            at = np.array([by_name[name] for name in content.node_names], dtype=np.int32)
            which = _patterns(item, content)
            contents.append(content)
            nodes.append(at)
            bodies.append(placed(content, known.position_m[at], np.array(item.position_m or (0.0, 0.0, 0.0)),
                                 axes_of(item.axis_x, item.axis_y)))
            patterns.append(which)
            named = known.program.called(item.programs) + 1 if item.programs else np.zeros(len(which), dtype=int)
            own = [next((known.member[name] for name in of if name in known.member), 0) for of in columns_of(item)]
            programs.append(np.where(named == 0, own, named) if own else named)
            fractions.append(np.ones(len(which)) if item.temperature_fractions is None
                             else np.array(item.temperature_fractions))
        return Bodies(
            tuple(item.name for item in items), tuple(contents), tuple(nodes), tuple(bodies), tuple(patterns),
            tuple(programs), tuple(fractions), np.array([item.stiffness_factor for item in items], dtype=float),
            np.array([item.expansion_factor for item in items], dtype=float))

    def engine_arrays(self, elements: Bodies) -> dict[str, Any]:
        """Return the bodies as lists for the engine."""
        bodies = elements.placed
        return {
            "nodes": [nodes.tolist() for nodes in elements.nodes],
            "rotating": [(content.node_freedoms == 6).tolist() for content in elements.contents],
            "stiffness": [factor * body.stiffness for factor, body in zip(elements.stiffness_factor, bodies)],
            "mass": [np.zeros((0, 0)) if body.mass is None else body.mass for body in bodies],
            "programs": [programs.tolist() for programs in elements.programs],
            "temperature_fractions": [
                (factor * fractions).tolist()
                for factor, fractions in zip(elements.expansion_factor, elements.temperature_fractions)],
            "free_shapes": [list(body.free_shapes[which]) for body, which in zip(bodies, elements.patterns)],
        }

    def check_geometry(self, truss: ResolvedTruss, elements: Bodies) -> None:
        for name, content, nodes, body in zip(elements.names, elements.contents, elements.nodes, elements.placed):
            size = radius(content.node_positions_m)
            beside = np.linalg.norm(body.offset_m, axis=1)
            worst = int(np.argmax(beside))
            if beside[worst] > BESIDE * size:
                raise NotAllowed("nodes", truss.nodes.names[nodes[worst]], code="body_node_beside",
                                 interface_=content.node_names[worst], beside_m=float(beside[worst]),
                                 allowed_m=BESIDE * size, **self.where(name))

    def ends(self, elements: Bodies) -> np.ndarray:
        return elements.ends

    def names_of_ends(self, elements: Bodies) -> Sequence[str]:
        return [name for name, nodes in zip(elements.names, elements.nodes) for _ in nodes[1:]]

    def stiffness_N_per_m(self, elements: Bodies) -> np.ndarray:
        largest = [factor * body.largest_stiffness_N_per_m
                   for factor, body in zip(elements.stiffness_factor, elements.placed)]
        return np.repeat(largest, [len(nodes) - 1 for nodes in elements.nodes])

    def preload_N(self, elements: Bodies) -> np.ndarray:
        return np.zeros(len(elements.ends))

    def weights(self, elements: Bodies, gravity_m_per_s2: np.ndarray, nodes: int) -> np.ndarray:
        found = np.zeros((nodes, 6))
        for at, body in zip(elements.nodes, elements.weighed):
            np.add.at(found, at, body.weight(gravity_m_per_s2))
        return found

    def run_notes(self, truss: ResolvedTruss, elements: Bodies, columns: Mapping[str, np.ndarray]) -> tuple[str, ...]:
        found, ranges_K = [], np.abs(truss.temperature_ranges_K).max(axis=1)
        for index, angle in enumerate(columns["body_bending_rad"].max(axis=0, initial=0.0)):
            neglected = float(angle) ** 2 / 24
            thermal = elements.thermal_strain(index, ranges_K)
            if neglected > NEGLECTED * thermal and neglected > LEAST_STRAIN:
                found.append(Note("body_bends", body=elements.names[index], angle_rad=float(angle), strain=neglected,
                                  share=neglected / thermal if thermal else np.inf))
        return tuple(found)

    def lines(self, elements: Bodies) -> list[Lines]:
        return [Lines(np.full(len(elements.ends), True), BROWN, "condensed body", width=2.0)]

    def counted(self, items: Sequence[Body]) -> list[tuple[Sequence[Body], str]]:
        return [(items, "condensed body")]


def _patterns(item: Body, content: CondensedBody) -> np.ndarray:
    """Return the numbers of the thermal patterns that act."""
    names = content.pattern_names if item.patterns is None else item.patterns
    return np.array([content.pattern_names.index(name) for name in names], dtype=int)


def columns_of(item: Body) -> list[tuple[str, ...]]:
    """Return, for each acting pattern, the names that its column in a file of members may have: BODY/PATTERN, and BODY
    if one pattern acts."""
    if item.content is None:
        return []
    names = item.content.pattern_names if item.patterns is None else item.patterns
    return [(f"{item.name}/{name}", *((item.name,) if len(names) == 1 else ())) for name in names]


def names_of_points(item: Body) -> list[str]:
    """Return what names the points of a body in a case: the body for all of them, then BODY/POINT of each."""
    points = item.content.points if item.content is not None else None
    return [] if points is None else [item.name, *(f"{item.name}/{point}" for point in points.names)]


def points_called(items: Sequence[Body], called: Sequence[str]) -> list[int]:
    """Return the indices of named points among the points of all bodies; :func:`names_of_points` has the names."""
    places: dict[str, list[int]] = {}
    count = 0
    for item in items:
        names = names_of_points(item)
        if names:
            places[names[0]] = list(range(count, count + len(names) - 1))
            places |= {name: [count + place] for place, name in enumerate(names[1:])}
            count += len(names) - 1
    return [place for name in called for place in places[name]]


def rotated_by_bodies(items: Sequence[Body]) -> set[str]:
    """Return the names of the nodes that condensed bodies rotate."""
    found = set()
    for item in items:
        if item.content is None:
            continue
        interface = item.content.node_names if item.interface is None else item.interface
        freedoms = dict(zip(item.content.node_names, item.content.node_freedoms))
        found |= {node for node, name in zip(item.nodes, interface) if freedoms.get(name) == 6}
    return found


BODY = BodyType()
