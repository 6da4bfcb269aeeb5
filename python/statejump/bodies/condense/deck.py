# SPDX-License-Identifier: GPL-3.0-or-later
"""The deck of a body: what CalculiX gets of it, its nodes, sets, elements and surface."""
from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import attrs
import numpy as np
from numpy.typing import NDArray

from statejump.core.errors import StatejumpError, Unreadable
from statejump.kinds.truss.importing.abaqus.keywords import Block, blocks, included
from statejump.kinds.truss.importing.abaqus.nodes import read_nodes
from statejump.kinds.truss.importing.lines import Source
from statejump.kinds.truss.importing.model import Deck

# Keywords that are omitted: a body is free, and its temperatures are the patterns.
OMITTED = ("BOUNDARY", "INITIAL CONDITIONS", "TRANSFORM", "AMPLITUDE", "HEADING", "NODE PRINT", "NODE FILE", "EL FILE",
           "EL PRINT", "TEMPERATURE", "CLOAD", "DLOAD", "RESTART")
# Keywords that make a structure nonlinear, or whose matrices CalculiX stores wrongly, with the reason.
REFUSED = {
    "CONTACT PAIR": "contact is not linear", "PLASTIC": "plasticity is not linear", "CREEP": "creep is not linear",
    "HYPERELASTIC": "hyperelasticity is not linear", "HYPERFOAM": "hyperelasticity is not linear",
    "GAP": "gaps are not linear", "CYCLIC SYMMETRY MODEL": "the sector is no whole body",
    "RIGID BODY": "a rigid body does not expand; name its nodes with --interface NSET=expanding",
    "PART": "parts and instances are not read by CalculiX",
}
BEAMS = ("B31", "B31R", "B32", "B32R")
SHELLS = ("S3", "S6", "S4", "S4R", "S8", "S8R")
SOLIDS = {  # faces as corners of an element, from 0
    "C3D4": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    "C3D6": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
    "C3D8": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
}
# Edges of solids with middle nodes, in the order of these nodes behind the corners.
EDGES = {
    "C3D4": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "C3D6": ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    "C3D8": ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
}
CORNERS = {"C3D10": "C3D4", "C3D10T": "C3D4", "C3D20": "C3D8", "C3D20R": "C3D8", "C3D8R": "C3D8", "C3D8I": "C3D8",
           "C3D15": "C3D6"}
COUNTS = {"C3D4": 4, "C3D6": 6, "C3D8": 8, "C3D8R": 8, "C3D8I": 8, "C3D10": 10, "C3D10T": 10, "C3D15": 15,
          "C3D20": 20, "C3D20R": 20, "S3": 3, "S6": 6, "S4": 4, "S4R": 4, "S8": 8, "S8R": 8,
          "B31": 2, "B31R": 2, "B32": 3, "B32R": 3}


@attrs.frozen
class BodyDeck:
    """A deck.

    :param lines: its model, without supports, temperatures and steps
    :param positions: positions by node, in the units of the deck
    :param elements: types and nodes of the elements
    :param temperatures: of each step, temperatures by node that the deck prescribes
    :param reference: uniform initial temperature of the deck; None: it has none
    """

    path: Path
    lines: tuple[str, ...]
    positions: dict[int, NDArray[np.float64]]
    sets: dict[str, list[int]]
    elements: tuple[tuple[str, tuple[int, ...]], ...]
    temperatures: tuple[dict[int, float], ...]
    reference: float | None
    has_density: bool

    @property
    def shells(self) -> bool:
        """Whether the body has shells, whose nodes CalculiX expands."""
        return any(kind in SHELLS for kind, _ in self.elements)

    @property
    def beam_nodes(self) -> frozenset[int]:
        """Nodes of beams, whose sections CalculiX expands."""
        return frozenset(node for kind, nodes in self.elements if kind in BEAMS for node in nodes)

    def nodes_of(self, name: str) -> list[int]:
        """Return the nodes of a set. :raises StatejumpError: there is no such set"""
        found = self.sets.get(name.upper())
        if not found:
            raise StatejumpError(code="condense_no_set", file=self.path, name=name,
                                 known=", ".join(sorted(self.sets)) or "none")
        return found

    def faces(self) -> list[tuple[int, ...]]:
        """Return the nodes of the faces on the surface: corners, then the middle nodes of edges."""
        seen: dict[tuple[int, ...], tuple[int, ...] | None] = {}
        for kind, nodes in self.elements:
            if kind in BEAMS:
                continue
            if kind in SHELLS:
                seen[tuple(sorted(nodes))] = nodes
                continue
            shape = CORNERS.get(kind, kind)
            middle = {} if len(nodes) == COUNTS[shape] else {
                frozenset(edge): place for place, edge in enumerate(EDGES[shape], COUNTS[shape])}
            for face in SOLIDS[shape]:
                between = [middle[frozenset(edge)] for edge in zip(face, face[1:] + face[:1])] if middle else []
                found = tuple(nodes[k] for k in (*face, *between))
                key = tuple(sorted(found))
                seen[key] = None if key in seen else found
        return [face for face in seen.values() if face is not None]


def corners_of(face: tuple[int, ...]) -> tuple[int, ...]:
    """Return the corners of a face."""
    return face[:3 if len(face) in (3, 6) else 4]


def read(path: Path) -> BodyDeck:
    """Return a deck. :raises StatejumpError: a keyword is unsupported; or one sentence with file and line"""
    deck = Deck(path)
    elements: list[tuple[str, tuple[int, ...]]] = []
    temperatures: list[dict[int, float]] = []
    initial: list[tuple[str, float]] = []
    positions, _, sets = read_nodes(path)
    in_step = density = False
    for block in blocks(deck, path):
        if block.name in REFUSED:
            raise Unreadable(code="condense_keyword", file=path, line=block.line, keyword=block.name,
                             why=REFUSED[block.name])
        if block.name == "STEP":
            in_step = True
            temperatures.append({})
        elif block.name == "ELEMENT":
            elements += _elements(deck, block)
        elif block.name == "DENSITY":
            density = True
        elif block.name in ("ELASTIC", "EXPANSION"):
            _check_constant(path, block)
        elif block.name == "INITIAL CONDITIONS" and block.parameters.get("TYPE", "").upper() == "TEMPERATURE":
            initial += [(words[0], float(words[1])) for _, words in block.data]
        elif block.name == "TEMPERATURE" and in_step:
            for _, words in block.data:
                nodes = sets.get(words[0].upper(), [words[0]])
                temperatures[-1].update({int(node): float(words[1]) for node in nodes})
    values = {value for _, value in initial}
    if len(values) > 1:
        raise Unreadable(code="condense_initial", file=path)
    return BodyDeck(
        path, tuple(_model(path)), {int(name): place for name, place in positions.items()},
        {name: [int(node) for node in nodes] for name, nodes in sets.items()}, tuple(elements), tuple(temperatures),
        next(iter(values), None), density)


def _elements(deck: Deck, block: Block) -> list[tuple[str, tuple[int, ...]]]:
    kind = block.parameters.get("TYPE", "").upper()
    if kind not in COUNTS:
        raise Unreadable(code="condense_element", file=deck.path, line=block.line, kind=kind,
                         known=", ".join(COUNTS))
    words = [word for _, row in block.data for word in row if word]
    step = COUNTS[kind] + 1
    if len(words) % step:
        raise deck.fail(block.line, "deck_bad_syntax", "*ELEMENT", problem=f"an element of {kind} has {step - 1} nodes")
    return [(kind, tuple(int(word) for word in words[at + 1:at + step])) for at in range(0, len(words), step)]


def _check_constant(path: Path, block: Block) -> None:
    """Refuse properties that depend on temperature."""
    kind = block.parameters.get("TYPE", "ISO").upper()
    if len(block.data) > 1 and kind in ("ISO", "ISOTROPIC"):
        raise Unreadable(code="condense_not_constant", file=path, line=block.line, keyword=block.name)


def _model(path: Path) -> list[str]:
    """Return the lines of the model, includes resolved, without omitted keywords and steps."""
    kept: list[str] = []
    skip = False
    joined = False
    for _, line in Source(path, included):
        text = line.strip()
        if not text or text.startswith("**"):
            continue
        if text.startswith("*") and not joined:
            name = " ".join(text[1:].split(",")[0].upper().split())
            if name == "STEP":
                break
            skip = name in OMITTED
        joined = text.startswith("*") and text.endswith(",") or joined and text.endswith(",")
        if not skip:
            kept.append(text)
    return kept


def with_density(deck: BodyDeck) -> Sequence[str]:
    """Return the model with a density, which CalculiX needs to store matrices."""
    if deck.has_density:
        return deck.lines
    lines: list[str] = []
    for line in deck.lines:
        lines.append(line)
        if line.upper().replace(" ", "").startswith("*MATERIAL"):
            lines += ["*DENSITY", "1."]
    return lines
