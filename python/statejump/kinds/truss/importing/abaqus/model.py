# SPDX-License-Identifier: GPL-3.0-or-later
"""Code that the keyword readers share: numbers, names, sets of nodes and elements, scopes of instances."""
from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field

import numpy as np

from statejump.core.reading import finite_number
from statejump.kinds.truss.importing.abaqus.keywords import Block
from statejump.kinds.truss.importing.abaqus.table import BEAM
from statejump.kinds.truss.importing.bending import Section as BeamSection
from statejump.kinds.truss.importing.contract import Card
from statejump.kinds.truss.importing.coordinates import BASIC, Frame
from statejump.kinds.truss.importing.model import Deck, quoted


@dataclass(frozen=True)
class Scope:
    """Scope of a block of a deck: the model, or an instance of a part.

    :param prefix: prefix for the names of nodes, elements and sets, with a final full stop
    :param move: function that converts a position in the part to a position in the assembly
    """

    prefix: str = ""
    move: Callable[[np.ndarray], np.ndarray] | None = None


Reading = Callable[["Model", Block, Scope], None]


@dataclass
class Element:
    """An element with its family and all its nodes."""

    name: str
    family: str
    kind: str
    nodes: list[str]
    line: int


@dataclass
class Material:
    """Properties of a material; None: missing in the deck."""

    young_modulus: float | None = None
    shear_modulus: float | None = None
    poisson_ratio: float | None = None
    expansion: float | None = None
    density: float | None = None
    expansion_table: tuple[tuple[float, float], ...] = ()
    expansion_zero: float = 0.0


@dataclass
class Section:
    """Area and material of a bar.

    :param bending: its bending, for beams
    :param axis_1: direction n1 of a beam
    :param widths: of the sides on which the pressures P1 and P2 act; 0: unknown
    :param shape: shape of a section whose sizes are given at nodes; empty: the area is given directly
    """

    area: float | None
    material: Material
    why: str = ""
    shape: str = ""
    bending: BeamSection | None = None
    axis_1: tuple[float, float, float] = (0.0, 0.0, -1.0)
    widths: tuple[float, float] = (0.0, 0.0)


@dataclass
class Model:
    """A deck while it is read."""

    deck: Deck
    node_sets: dict[str, dict[str, None]] = field(default_factory=dict)
    element_sets: dict[str, dict[str, None]] = field(default_factory=dict)
    elements: dict[str, Element] = field(default_factory=dict)
    materials: dict[str, Material] = field(default_factory=dict)
    material: Material | None = None
    sections: dict[str, Section] = field(default_factory=dict)
    pressures: dict[tuple[str, str], tuple[float, int]] = field(default_factory=dict)  # by element and P1 or P2; line
    normals: dict[str, np.ndarray] = field(default_factory=dict)  # direction n2 of beams, *NORMAL
    thickness: dict[str, tuple[float, float]] = field(default_factory=dict)  # of *NODAL THICKNESS
    frames: dict[str, Frame] = field(default_factory=dict)  # directions of supports and loads of nodes
    system: Frame = BASIC  # of positions
    surfaces: dict[str, dict[str, float]] = field(default_factory=dict)  # nodes of *SURFACE, TYPE=NODE, with areas
    coupling: tuple[str, dict[str, float]] | None = None  # master, nodes and areas of the last *COUPLING
    set_items: int = 0
    sorted_numbers: dict[tuple[bool, str], tuple[int, list[int]]] = field(default_factory=dict)

    def bends(self) -> bool:
        """Return whether beams of the deck bend."""
        return not self.deck.options.beams_as_bars and any(one.family == BEAM for one in self.elements.values())

    def number(self, line: int, text: str) -> float:
        """Return a number of a data line."""
        value = finite_number(text.lower().replace("d", "e"))
        if value is None:
            raise self.deck.fail(line, "deck_bad_number", text=quoted(text), wanted="a finite number")
        return value

    def numbers(self, line: int, texts: Iterable[str]) -> list[float]:
        """Return numbers of a data line, 0 for an empty one."""
        return [self.number(line, text) if text else 0.0 for text in texts]

    def whole(self, line: int, text: str) -> int:
        """Return a whole number that is not negative."""
        if not text.isdecimal() or not text.isascii() or len(text) > 12:
            raise self.deck.fail(line, "deck_bad_number", text=quoted(text), wanted="a whole number")
        return int(text)

    def name(self, line: int, text: str, scope: Scope) -> str:
        """Return the name of a node or element: its number, after the name of its instance and a full stop."""
        instance, stop, number = text.rpartition(".")
        prefix = f"{instance.upper()}." if stop else scope.prefix
        if not number.isdecimal() or not number.isascii() or len(number) > 12:
            raise self.deck.fail(line, "deck_bad_number", text=quoted(text), wanted="a number of a node or element")
        return f"{prefix}{int(number)}"

    def needed(self, block: Block, key: str) -> str:
        """Return a parameter that must be there."""
        if not block.parameters.get(key):
            raise self.deck.fail(block.line, "deck_incomplete", f"*{block.name}", needed=f"{key}=")
        return block.parameters[key]

    def add(self, line: int, sets: dict[str, dict[str, None]], name: str, items: Iterable[str]) -> None:
        """Add items to a set, each once."""
        have = sets.setdefault(name, {})
        before = len(have)
        have.update(dict.fromkeys(items))
        self.set_items += len(have) - before
        self.deck.room(line, self.set_items)

    def group(self, nodes: bool, word: str, scope: Scope) -> list[str] | None:
        """Return the nodes or elements of a set; None if the set does not exist."""
        sets = self.node_sets if nodes else self.element_sets
        upper = word.upper()
        for name in (scope.prefix + upper, upper, upper.removeprefix("ASSEMBLY.")):
            if name in sets:
                return list(sets[name])
        if upper == ("NALL" if nodes else "EALL"):
            return list(self.deck.nodes) if nodes else list(self.elements)
        return None

    def nodes_of(self, line: int, word: str, scope: Scope) -> list[str]:
        """Return the nodes that a number or a set names."""
        found = self.group(True, word, scope)
        if found is not None:
            return found
        if not word.rpartition(".")[2].isdecimal():
            raise self.deck.fail(line, "deck_undefined", what_it_is="set of nodes", name=quoted(word))
        name = self.name(line, word, scope)
        if name not in self.deck.nodes:
            raise self.deck.fail(line, "deck_undefined", what_it_is="node", name=name)
        return [name]

    def elements_of(self, line: int, word: str, scope: Scope) -> list[Element]:
        """Return the elements that a set or a number names."""
        found = self.group(False, word, scope)
        if found is None:
            name = self.name(line, word, scope) if word.rpartition(".")[2].isdecimal() else ""
            if name not in self.elements:
                raise self.deck.fail(line, "deck_undefined", what_it_is="set of elements", name=quoted(word))
            found = [name]
        return [self.elements[name] for name in found if name in self.elements]

    def range(self, nodes: bool, prefix: str, first: int, last: int, step: int) -> list[str]:
        """Return the existing nodes or elements with the numbers first, first + step, … up to last."""
        known: Collection[str] = self.deck.nodes.keys() if nodes else self.elements.keys()
        if (last - first) // step <= 2 * len(known):
            return [name for number in range(first, last + 1, step) if (name := f"{prefix}{number}") in known]
        count, numbers = self.sorted_numbers.get((nodes, prefix), (-1, []))
        if count != len(known):
            numbers = sorted(int(name[len(prefix):]) for name in known
                             if name.startswith(prefix) and name[len(prefix):].isdecimal())
            self.sorted_numbers[nodes, prefix] = (len(known), numbers)
        within = numbers[bisect_left(numbers, first):bisect_right(numbers, last)]
        return [f"{prefix}{number}" for number in within if (number - first) % step == 0]

    def frame(self, node: str) -> Frame:
        """Return the directions of the supports and loads of a node."""
        return self.frames.get(node, BASIC)

    def refuse(self, block: Block, known: Card, parameter: str) -> None:
        """Refuse a parameter of a keyword."""
        found = known.parameter(parameter)
        why = found.why if found else "unknown_parameter"
        self.deck.refuse(f"*{block.name}, {parameter}", why, block.line, f"{block.name}.{parameter}")
