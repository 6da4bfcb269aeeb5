# SPDX-License-Identifier: GPL-3.0-or-later
"""Code that the card readers share: numbers, nodes, sets, and the part of the deck that has been read."""
from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from statejump.kinds.truss.importing.bending import Load, Section
from statejump.kinds.truss.importing.coordinates import Frame
from statejump.kinds.truss.importing.model import Bar, Deck, quoted
from statejump.kinds.truss.importing.nastran.cards import Card, number_of


# Of a beam: what each end does not transmit to its node, and the vectors (2, 3) from the nodes to the ends.
Ends = tuple[tuple[frozenset[str], frozenset[str]], np.ndarray]


@dataclass
class Material:
    """MAT1; None: the card does not say."""

    young_modulus: float | None
    shear_modulus: float | None
    poisson_ratio: float | None
    density: float | None
    expansion: float | None
    reference: float | None


@dataclass
class Property:
    """Section of a bar or a beam.

    :param area: area; None: unknown, with the reason in ``why``
    :param stations: sections of a beam by fraction of its length, from 0 to 1; a uniform beam has one
    :param mass_area: mean area, which determines the mass; it differs from ``area`` in a taper
    :param more: non-structural mass per length
    """

    material: str
    area: float | None
    why: str = ""
    mass_area: float | None = None
    more: float = 0.0
    stations: tuple[tuple[float, Section], ...] = ()


@dataclass
class Reader:
    """State of the reader of a deck while it reads the cards.

    :param sets: active sets by kind, with the factor of each
    """

    deck: Deck
    cards: dict[str, list[Card]]
    sets: dict[str, dict[str, float]] = field(default_factory=dict)
    frames: dict[str, Frame] = field(default_factory=dict)
    displacement_frame: dict[str, str] = field(default_factory=dict)  # CD of nodes
    materials: dict[str, Material] = field(default_factory=dict)
    properties: dict[str, dict[str, Property]] = field(default_factory=dict)  # by number and element
    springs: dict[str, float] = field(default_factory=dict)  # PELAS
    masses: dict[str, float] = field(default_factory=dict)  # PMASS
    component_masses: dict[str, list[float]] = field(default_factory=dict)  # CMASS1, CMASS2 by node: directions 1 to 3
    component_cards: dict[str, Card] = field(default_factory=dict)  # the first of each node
    bars: dict[str, tuple[int, Bar, str]] = field(default_factory=dict)  # line, bar, property
    axes_y: dict[str, np.ndarray] = field(default_factory=dict)  # direction of axis y of the section, by beam
    ends: dict[str, Ends] = field(default_factory=dict)  # of beams
    beam_temperature: dict[str, tuple[Card, float, tuple[float, float]]] = field(default_factory=dict)  # TEMPRB
    mass_arms: list[tuple[Card, str, float, np.ndarray]] = field(default_factory=list)  # CONM2: card, node, mass, arm
    torsion: dict[str, float] = field(default_factory=dict)  # torsion constants of CONROD
    beam_loads: list[tuple[Card, str, Load]] = field(default_factory=list)  # with the name of their beam
    conrods: dict[str, tuple[int, Bar, str]] = field(default_factory=dict)  # line, bar, material
    elements: set[str] = field(default_factory=set)
    sorted_nodes: list[int] = field(default_factory=list)

    def bends(self) -> bool:
        """Return whether beams of the deck bend."""
        return not self.deck.options.beams_as_bars and bool(self.cards.get("CBAR") or self.cards.get("CBEAM"))

    def number(self, card: Card, place: int, default: float | None = None) -> float:
        """Return a real number of a field."""
        text = card[place]
        if not text and default is not None:
            return default
        if not text:
            raise self.fail(card, "deck_incomplete", needed=f"field {place + 2}")
        value = number_of(text)
        if value is None:
            raise self.deck.fail(card.line, "deck_bad_number", text=quoted(text), wanted="a finite number")
        return value

    def optional(self, card: Card, place: int) -> float | None:
        """Return a real number of a field that may be empty."""
        return self.number(card, place) if card[place] else None

    def whole(self, card: Card, place: int, default: str | None = None) -> str:
        """Return the whole number of a field as a name."""
        text = card[place]
        if not text and default is not None:
            return default
        if not text:
            raise self.fail(card, "deck_incomplete", needed=f"field {place + 2}")
        return self.name(card.line, text)

    def name(self, line: int, text: str) -> str:
        """Return a whole number as a name."""
        if not text.isdecimal() or not text.isascii() or len(text) > 12:
            raise self.deck.fail(line, "deck_bad_number", text=quoted(text), wanted="a whole number above 0")
        return str(int(text))

    def node(self, card: Card, place: int) -> str:
        """Return a node that is there."""
        name = self.whole(card, place)
        if name not in self.deck.nodes:
            raise self.deck.fail(card.line, "deck_undefined", what_it_is="GRID", name=name)
        return name

    def several(self, card: Card, items: list[str]) -> list[str]:
        """Return the nodes of a list. A range with ``THRU`` may contain numbers that are not nodes."""
        nodes: list[str] = []
        place = 0
        while place < len(items):
            if place + 2 < len(items) and items[place + 1].upper() == "THRU":
                first, last = (int(self.name(card.line, items[at])) for at in (place, place + 2))
                start, end = bisect_left(self.sorted_nodes, first), bisect_right(self.sorted_nodes, last)
                nodes += map(str, self.sorted_nodes[start:end])
                place += 3
            else:
                name = self.name(card.line, items[place])
                if name not in self.deck.nodes:
                    raise self.fail(card, "deck_undefined", what_it_is="GRID", name=name)
                nodes.append(name)
                place += 1
        return nodes

    def factor(self, card: Card, kind: str) -> float | None:
        """Return the factor of the set to which a card belongs; None if the set is inactive."""
        return self.sets.get(kind, {}).get(self.whole(card, 0))

    def frame(self, card: Card, place: int) -> Frame:
        """Return a coordinate system that is there."""
        name = self.whole(card, place, "0")
        if name not in self.frames:
            raise self.fail(card, "deck_undefined", what_it_is="coordinate system", name=name)
        return self.frames[name]

    def fail(self, card: Card, code: str, **details: Any) -> Exception:
        """Return why a card cannot be read."""
        return self.deck.fail(card.line, code, card.name, **details)
