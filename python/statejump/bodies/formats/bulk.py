# SPDX-License-Identifier: GPL-3.0-or-later
"""Bulk data beside reduced matrices of Nastran: DMIG, GRID, coordinate systems, and the list of dofs (EXTRN, ASET)."""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

import attrs
import numpy as np
from numpy.typing import NDArray

from statejump.bodies.formats.labelled import MODE, Label, Labelled, by_labels
from statejump.core.errors import StatejumpError, Unreadable
from statejump.kinds.truss.importing.model import Deck, text_of
from statejump.kinds.truss.importing.nastran.cards import Card, cards_of, number_of
from statejump.kinds.truss.importing.nastran.nodes import read_nodes
from statejump.kinds.truss.importing.nastran.reader import Reader

SYSTEMS = ("CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S")
READ = ("DMIG", "GRID", "GRDSET", "EXTRN", "ASET", "ASET1", "QSET", "QSET1", "SPOINT", *SYSTEMS)
SYMMETRIC, RECTANGULAR = 6, (2, 9)


@attrs.frozen
class Bulk:
    """Content of the files, in their units.

    :param positions: positions of nodes, in the basic system
    :param axes: displacement coordinate system of each node: its axes as rows, in the basic system
    :param labels: labels of the dofs of matrices without labels, in the order of their rows
    """

    matrices: dict[str, Labelled]
    positions: dict[int, NDArray[np.float64]]
    axes: dict[int, NDArray[np.float64]]
    labels: tuple[Label, ...]


def read(paths: Sequence[Path], systems: Mapping[int, int] = MappingProxyType({})) -> Bulk:
    """Return the content of punch, assembly and bulk data files together.

    :param systems: displacement coordinate systems of nodes, in place of those of the GRID cards
    :raises StatejumpError: one sentence with file and line
    """
    cards: dict[str, list[Card]] = {}
    seen: set[tuple[str, tuple[str, ...]]] = set()
    matrices: dict[str, Labelled] = {}
    deck = Deck(paths[0]) if paths else Deck(Path())
    for path in paths:
        deck = Deck(path)
        found: dict[str, list[Card]] = {}
        for card in cards_of(deck, _lines(path)):
            found.setdefault(card.name, []).append(card)
        reader = Reader(deck, found)
        matrices.update(_matrices(reader, found.pop("DMIG", [])))
        for name, several in found.items():
            for card in several:
                while card.fields and not card.fields[-1]:
                    card.fields.pop()
                key = (name, tuple(card.fields))
                if key not in seen:  # an assembly file has the same cards once more
                    seen.add(key)
                    cards.setdefault(name, []).append(card)
    reader = Reader(deck, cards)
    for name in ("GRID", *SYSTEMS):
        for card in cards.get(name, []):
            card.fields = card.fields[:6] if name == "GRID" else card.fields  # supports belong to the assembly
    read_nodes(reader)
    positions = {int(name): np.array(place) for name, place in deck.nodes.items()}
    axes = {}
    reader.displacement_frame.update({str(node): str(system) for node, system in systems.items()})
    for name, frame in reader.displacement_frame.items():
        if frame not in reader.frames:
            raise Unreadable(code="deck_undefined", file=deck.path, what_it_is="coordinate system", name=frame)
        if name not in deck.nodes:
            raise StatejumpError(code="matrix_node_missing", node=int(name))
        axes[int(name)] = reader.frames[frame].directions(deck.nodes[name])
    labels = sorted(_labels(reader, cards))
    if not labels:  # assembly file: its nodes have six dofs each, and scalar points are modes
        points = {number for card in cards.get("SPOINT", []) for number in _several(reader, card, card.fields)}
        labels = sorted([(node, k) for node in positions for k in range(1, 7)] + [(one, MODE) for one in points])
    return Bulk(matrices, positions, axes, tuple(labels))


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the lines of cards that are read, with their continuations."""
    wanted = False
    for number, line in enumerate(text_of(path, 1 << 30), start=1):
        text = line.split("$")[0]
        if not text.strip():
            continue
        if text[0] not in " +*,":
            name = text.replace(",", " ").split()[0].rstrip("*").upper()
            if name == "ENDDATA":
                return
            wanted = name in READ
        if wanted:
            yield number, text[:72] if "," not in text[:10] else text  # columns 73 to 80 may hold sequence numbers


def _labels(reader: Reader, cards: dict[str, list[Card]]) -> Iterator[Label]:
    """Yield the labels of the dofs: those of EXTRN, else those of ASET and QSET."""
    pairs: list[tuple[Card, str, str]] = []
    for name in ("EXTRN",) if "EXTRN" in cards else ("ASET", "QSET"):
        for card in cards.get(name, []):
            pairs += [(card, card[at], card[at + 1]) for at in range(0, len(card.fields), 2) if card[at]]
    if "EXTRN" not in cards:
        for card in cards.get("ASET1", []) + cards.get("QSET1", []):
            pairs += [(card, str(number), card[0]) for number in _several(reader, card, card.fields[1:])]
    found = set()
    for card, number, components in pairs:
        if not set(components) <= set("0123456"):
            raise reader.fail(card, "deck_bad_syntax", problem=f"{components!r} are no components")
        for component in components or "0":
            found.add((int(reader.name(card.line, number)), int(component)))
    yield from found


def _several(reader: Reader, card: Card, words: Sequence[str]) -> Iterator[int]:
    place = 0
    while place < len(words):
        if place + 2 < len(words) and words[place + 1].upper() == "THRU":
            yield from range(int(reader.name(card.line, words[place])),
                             int(reader.name(card.line, words[place + 2])) + 1)
            place += 3
        else:
            if words[place]:
                yield int(reader.name(card.line, words[place]))
            place += 1


def _matrices(reader: Reader, cards: Sequence[Card]) -> dict[str, Labelled]:
    """Return the real matrices of DMIG cards; complex ones are omitted."""
    heads: dict[str, Card] = {}
    entries: dict[str, list[tuple[Label, Label, float]]] = {}
    for card in cards:
        name = card[0].upper()
        if card[1] == "0":
            heads[name] = card
            entries.setdefault(name, [])
            continue
        if name not in heads:
            raise reader.fail(card, "deck_undefined", what_it_is="head of DMIG", name=name)
        rectangular = _whole(reader, heads[name], 2) in RECTANGULAR and card[2] in ("", "0")
        column = (_whole(reader, card, 1), 0 if rectangular else _whole(reader, card, 2))
        for at in range(4, len(card.fields), 4):
            if not card[at]:
                continue
            value = number_of(card[at + 2])
            if value is None:
                raise reader.fail(card, "deck_bad_syntax", problem=f"{card[at + 2]!r} is not a number")
            entries[name].append(((_whole(reader, card, at), _whole(reader, card, at + 1)), column, value))
    found = {}
    for name, head in heads.items():
        form, kind = _whole(reader, head, 2), _whole(reader, head, 3)
        if kind not in (3, 4):
            found[name] = by_labels(name, entries[name], form not in RECTANGULAR, form == SYMMETRIC)
    return found


def _whole(reader: Reader, card: Card, place: int) -> int:
    text = card[place]
    if not text:
        return MODE
    if not text.isdecimal():
        raise reader.fail(card, "deck_bad_syntax", problem=f"{text!r} is not a whole number")
    return int(text)
