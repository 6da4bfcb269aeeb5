# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python part of an element type: one object per type, in its own file.

Elements have a conservative law between nodes or links. Links are part of the truss itself, because joints and
temperatures refer to them. Case, checks, arrays, solver, result, drawing, sensitivities and input of the DEM use the
registry (:data:`statejump.kinds.truss.elements.ELEMENTS`) and know no single type. Only the scene of the DEM, ``build``
in ``yade_scripts/runner/scene_truss.py``, has a loop for each supported type.
"""
from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, TypeVar, cast

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.kinds.truss.arrays import distances
from statejump.kinds.truss.joints.protocol import PartType
from statejump.kinds.truss.references import Around, known_nodes, wrong_ends
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.item_tables import ItemColumns
from statejump.schema.items import Item

ItemType = TypeVar("ItemType", bound=Item)
ArraysType = TypeVar("ArraysType")


@dataclass(frozen=True)
class Lines:
    """Elements that drawings show as lines of one style."""

    which: np.ndarray  # (elements,) bool
    colour: str
    legend: str
    dashed: bool = False  # False: drawn as a zigzag if the drawing has room for it
    width: float = 0.0  # of a solid line; 0: not a solid line


@dataclass(frozen=True)
class Switch:
    """Marks when the stiffness of an element is on or off during a run, for example of a cable that becomes slack."""

    element: int
    is_on: np.ndarray  # (samples,) bool
    on: str  # kind of the event
    off: str


class ElementType(PartType[ItemType, ArraysType]):
    """An element type. ``section`` is the name of its list in a case file and its name in messages."""

    listed_if_none: ClassVar[bool] = False  # results list its items even if a truss has none
    bends: ClassVar[bool] = False  # it rotates its nodes; models without rotations refuse it
    has_section: ClassVar[bool] = False  # drawings show its items with a cross section
    has_temperature: ClassVar[bool] = False  # its items have a program and a temperature_fraction

    # ---------------------------------------------------------------- case

    def check_keys(self, item: ItemType) -> None:
        """Raise an error for keys that contradict each other."""

    def may_be_wrong_keys(self, items: ItemColumns[ItemType]) -> np.ndarray:
        """Return the items (n,) that :meth:`check_keys` must check. The result must include all invalid items."""
        return np.full(len(items), False)

    def expands(self, item: ItemType) -> bool:
        """Return whether an element with a temperature expands with it."""
        return False

    def check_geometry(self, truss: ResolvedTruss, elements: ArraysType) -> None:
        """Raise an error for invalid positions, directions and lengths."""

    # ---------------------------------------------------------------- mechanics

    def ends(self, elements: ArraysType) -> np.ndarray:
        """Return the pairs of nodes (k, 2) that the elements connect; empty (0, 2) for elements that act on angles."""
        return np.zeros((0, 2), dtype=int)

    def names_of_ends(self, elements: ArraysType) -> Sequence[str]:
        """Return the name of the element of each pair of :meth:`ends`."""
        found: Sequence[str] = cast(Any, elements).names
        return found if len(self.ends(elements)) else ()

    def stiffness_N_per_m(self, elements: ArraysType) -> np.ndarray:
        """Return the largest stiffness (k,) [N/m] between the two nodes of each pair of :meth:`ends`."""
        return np.zeros(0)

    def engine_arrays(self, elements: ArraysType) -> dict[str, Any]:
        """Return the arrays for the engine that are not fields of the type's arrays."""
        return {}

    def weights(self, elements: ArraysType, gravity_m_per_s2: np.ndarray, nodes: int) -> np.ndarray:
        """Return the weights of the elements as loads on the nodes (nodes, 6): forces [N], then moments [N m]."""
        return np.zeros((nodes, 6))

    def preload_N(self, elements: ArraysType) -> np.ndarray:
        """Return the forces (k,) [N] in the reference configuration."""
        return np.zeros(0)

    def tension_N(self, elements: ArraysType, states: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return the tension (states, k) [N] of each pair of :meth:`ends`, from the columns of the type."""
        return np.zeros((len(states["time_s"]), len(self.ends(elements))))

    def switches(self, elements: ArraysType, columns: Mapping[str, np.ndarray]) -> list[Switch]:
        """Return the elements whose switching on or off is an event, from the columns of the type."""
        return []

    def run_notes(self, truss: ResolvedTruss, elements: ArraysType, columns: Mapping[str, np.ndarray]
                  ) -> tuple[str, ...]:
        """Return sentences about the limits of the type that a run approaches."""
        return ()

    def changed(self, truss: ResolvedTruss, elements: ArraysType) -> ArraysType:
        """Return the elements with updated dependent arrays, after a change of one of the ``varied`` numbers."""
        return elements

    # ---------------------------------------------------------------- drawing and sentences

    def lines(self, elements: ArraysType) -> list[Lines]:
        """Return the lines of the elements for drawings."""
        return []

    def counted(self, items: Sequence[ItemType]) -> list[tuple[Sequence[ItemType], str]]:
        """Return groups of items, each with the noun by which summaries call it."""
        return [(items, self.section.replace("_", " "))]

    # ---------------------------------------------------------------- DEM

    def scene(self, truss: ResolvedTruss, elements: ArraysType) -> dict[str, Any]:
        """Return values for the scene of the DEM that are not fields of the type's arrays."""
        return {}

    def dem_refuses(self, elements: ArraysType) -> tuple[str, str, str] | None:
        """Return name, error code and reason for one element that the DEM cannot represent; None if there is none."""
        return None


class Ended(Protocol):
    """Items of elements between two nodes."""

    nodes: list[str]


class EndsArrays:
    """Arrays of elements between two nodes."""

    names: Sequence[str]
    nodes: np.ndarray  # (k, 2) int
    stiffness_N_per_m: np.ndarray


EndsType = TypeVar("EndsType", bound=EndsArrays)


class BetweenNodes(ElementType[ItemType, EndsType]):
    """An element type between two nodes. Items have the key ``nodes``, arrays the fields of :class:`EndsArrays`."""

    def check_references(self, item: ItemType, nodes: Mapping[str, Any], links: Mapping[str, Any],
                         rotating: Container[str]) -> None:
        known_nodes(cast(Ended, item).nodes, 2, nodes, self.where(item.name))

    def may_be_wrong_references(self, items: ItemColumns[ItemType], around: Around) -> np.ndarray:
        return wrong_ends(around.nodes.of(items, "nodes"), 2)

    def check_geometry(self, truss: ResolvedTruss, elements: EndsType) -> None:
        check_lengths(truss, self.section, elements.names, elements.nodes)

    def ends(self, elements: EndsType) -> np.ndarray:
        return elements.nodes

    def stiffness_N_per_m(self, elements: EndsType) -> np.ndarray:
        return elements.stiffness_N_per_m


def check_lengths(truss: ResolvedTruss, section: str, names: Sequence[str], ends: np.ndarray) -> None:
    """Raise StatejumpError for the first item of a section whose two end nodes (k, 2) are at one position."""
    for index in np.flatnonzero(distances(truss.nodes.position_m, ends) == 0)[:1]:
        nodes = [truss.nodes.names[node] for node in ends[index]]
        place = truss.nodes.position_m[ends[index, 0]][: truss.dimension].tolist()
        raise StatejumpError(code="coincident_nodes", item=f"{section} {names[index]!r}", key="nodes", value=nodes,
                             nodes=nodes, ends=" and ".join(map(repr, nodes)), place_m=place, part=section)
