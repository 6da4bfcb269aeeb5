# SPDX-License-Identifier: GPL-3.0-or-later
"""Adds condensed bodies to a CalculiX deck: the mesh that a body was condensed from, where its file contains the deck;
else springs with its reduced stiffness.

A mesh keeps the axes of its deck. Displacements are small, so its place has no effect: equations between the
interface nodes and their patches rotate displacements into the axes of the structure.
"""
from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from statejump.bodies.body import CondensedBody
from statejump.bodies.condense.deck import BodyDeck, read
from statejump.bodies.condense.patches import patch
from statejump.bodies.condense.reduce import rigid_columns
from statejump.bodies.mesh_deck import MeshDeck
from statejump.core.errors import NotAllowed
from statejump.core.scratch import scratch
from statejump.kinds.truss.elements.body import Bodies
from studies.calculix.ccx import number
from studies.calculix.frame import Frame
from studies.calculix.truss_sliding import STRETCH

Numbers = NDArray[np.float64]
# Keywords whose data lines are numbers of nodes and elements, or no numbers of such.
NUMBERED = ("NODE", "ELEMENT", "NSET", "ELSET")
KEPT = ("MATERIAL", "ELASTIC", "EXPANSION", "DENSITY", "SOLID SECTION", "SHELL SECTION", "BEAM SECTION", "ORIENTATION",
        "CONDUCTIVITY", "SPECIFIC HEAT")
NAMES = ("NSET", "ELSET", "MATERIAL", "NAME", "ORIENTATION")
EXPANSION = 1e-5  # 1/K of the springs; their temperatures give them their free elongation
SOFTEST = 1e-11  # eigenvalue of a rigid motion over the largest eigenvalue


@dataclass(frozen=True)
class Heated:
    """Nodes of the deck whose temperatures follow the patterns of a body.

    :param body: number of the body
    :param nodes: numbers (k) of the nodes
    :param temperatures: temperature (p, k) per unit of each pattern of its file
    :param gradients: gradient (p) through the thickness of shells; None: the mesh has no shells
    """

    body: int
    nodes: NDArray[np.int64]
    temperatures: Numbers
    gradients: Numbers | None

    def lines(self, bodies: Bodies, changes: Numbers) -> Iterator[str]:
        """Yield data lines of ``*TEMPERATURE`` for the changes (programs,) of the programs [K]."""
        units = np.zeros(len(self.temperatures))
        share = bodies.expansion_factor[self.body] * bodies.temperature_fractions[self.body]
        np.add.at(units, bodies.patterns[self.body], share * changes[bodies.programs[self.body]])
        more = "" if self.gradients is None else f", {number(float(units @ self.gradients))}"
        for node, value in zip(self.nodes.tolist(), (units @ self.temperatures).tolist()):
            yield f"{node}, {number(value)}{more}"


def refuse(bodies: Bodies) -> None:
    """Raise NotAllowed for bodies that the deck does not support."""
    for index, content in enumerate(bodies.contents):
        deck, where = content.deck, {"item": f"body {bodies.names[index]!r}"}
        if deck is None:
            continue
        if "expanding" in deck.kinds:
            raise NotAllowed("body", code="fe_body_expanding", **where)
        if bodies.stiffness_factor[index] != 1.0:
            raise NotAllowed("stiffness_factor", float(bodies.stiffness_factor[index]), code="fe_body_factor", **where)
        if (deck.length_m, deck.force_N) != (1.0, 1.0):
            raise NotAllowed("body", code="fe_body_units", **where)


def add(frame: Frame, longest: float) -> list[Heated]:
    """Add all bodies.

    :param longest: length of springs [m]
    """
    found = []
    bodies = frame.truss.elements["body"]
    for index, content in enumerate(bodies.contents):
        if content.deck is None:
            found += _springs(frame, bodies, index, longest)
        else:
            found.append(_mesh(frame, bodies, index, content.deck))
    return found


def unmeshed(bodies: Bodies) -> list[str]:
    """Return the names of the bodies whose files contain no deck."""
    return [name for name, content in zip(bodies.names, bodies.contents) if content.deck is None]


def _springs(frame: Frame, bodies: Bodies, index: int, longest: float) -> list[Heated]:
    """Add a brick for each elastic eigenvector of the reduced stiffness."""
    placed, nodes, content = bodies.placed[index], bodies.nodes[index], bodies.contents[index]
    places = [(int(node), axis, turned) for node, dofs in zip(nodes, content.node_freedoms)
              for turned in range(int(dofs) // 3) for axis in range(3)]
    values, vectors = np.linalg.eigh(bodies.stiffness_factor[index] * placed.stiffness)
    found = []
    for value, vector in zip(values, vectors.T):
        if value <= SOFTEST * values[-1]:
            continue
        end = frame.brick(STRETCH * longest, float(value) * STRETCH * longest, EXPANSION / STRETCH, None)
        frame.equate([(end, 1, 1.0), *(
            ((frame.count if turned else 0) + node + 1, axis + 1, -float(part))
            for (node, axis, turned), part in zip(places, vector))], first=True)
        corners = np.arange(end - 1, end + 7)
        free = placed.free_shapes @ vector / (EXPANSION * longest)
        found.append(Heated(index, corners, np.repeat(free[:, None], 8, axis=1), None))
    return found


def _mesh(frame: Frame, bodies: Bodies, index: int, stored: MeshDeck) -> Heated:
    """Add the mesh of a body and the equations of its patches."""
    with scratch() as folder:
        (Path(folder) / "body.inp").write_text(stored.text, encoding="utf-8")
        deck = read(Path(folder) / "body.inp")
    offset = frame.first
    lines = list(_renumbered(deck.lines, offset, f"S{index + 1}_", bodies.names[index]))
    frame.sections += lines
    largest = max([*deck.positions, *_elements(deck.lines)])
    frame.first += largest + 1
    frame.element = frame.first
    faces = deck.faces()
    content = bodies.contents[index]
    for place in range(len(content.node_names)):
        _interface(frame, bodies, index, place, deck, faces, offset)
    return Heated(index, stored.nodes + offset, stored.temperatures, stored.gradients if deck.shells else None)


def _interface(frame: Frame, bodies: Bodies, index: int, place: int, deck: BodyDeck,
               faces: Sequence[tuple[int, ...]], offset: int) -> None:
    """Add the equations between an interface node and its patch."""
    content: CondensedBody = bodies.contents[index]
    assert content.deck is not None
    placed, kind = bodies.placed[index], content.deck.kinds[place]
    node = int(bodies.nodes[index][place])
    nodes = deck.nodes_of(content.node_names[place])
    about = content.node_positions_m[place] + placed.offset_m[place] @ placed.axes  # of the node of the structure

    def structure(turned: int, axis: int) -> list[tuple[int, int, float]]:
        """Return minus the displacement or rotation of the node along an axis of the body."""
        return [((frame.count if turned else 0) + node + 1, along + 1, -float(placed.axes[along, axis]))
                for along in range(3)]

    if kind == "node":
        for axis in range(3):
            frame.equate([(nodes[0] + offset, axis + 1, 1.0), *structure(0, axis)], first=True)
        return
    if kind == "rigid":
        arms = rigid_columns(np.array([deck.positions[one] for one in nodes]), about).reshape(len(nodes), 3, 6)
        for one, rows in zip(nodes, arms):
            for axis in range(3):
                terms = [(to, way, float(rows[axis, 3 * turned + k]) * part) for turned in range(2) for k in range(3)
                         for to, way, part in structure(turned, k)]
                frame.equate([(one + offset, axis + 1, 1.0), *terms], first=True)
        return
    _, mean = patch(nodes, deck.positions, faces, about)
    for row in range(6):
        terms = [(one + offset, axis + 1, float(mean[row, 3 * at + axis])) for at, one in enumerate(nodes)
                 for axis in range(3)]
        frame.equate([*structure(row // 3, row % 3), *terms])


def _elements(lines: Sequence[str]) -> Iterator[int]:
    """Yield the numbers of the elements of a deck, and of some nodes."""
    inside = False
    for line in lines:
        if line.startswith("*"):
            inside = re.match(r"\*ELEMENT\s*(,|$)", line, re.IGNORECASE) is not None
        elif inside:
            yield from (int(word) for word in line.split(",")[:1] if word.strip())


def _renumbered(lines: Sequence[str], offset: int, prefix: str, name: str) -> Iterator[str]:
    """Yield the lines of a deck with an offset of all nodes and elements, and with a prefix of all names."""
    keyword, head, generated, layers = "", "", False, False
    for line in lines:
        if line.startswith("*") or head:
            head += line
            if line.rstrip().endswith(","):
                continue
            keyword, parts = _head(head, prefix)
            if keyword not in NUMBERED + KEPT:
                raise NotAllowed("body", code="fe_body_deck_keyword", item=f"body {name!r}", keyword=keyword)
            generated, layers = "GENERATE" in parts[1:], "COMPOSITE" in parts[1:]
            yield ", ".join([f"*{keyword}", *parts[1:]])
            head = ""
            continue
        words = [word.strip() for word in line.split(",")]
        if keyword == "NODE":
            words[0] = str(int(words[0]) + offset)
        elif keyword in NUMBERED:
            words = [_moved(word, offset, prefix, step=generated and place == 2) for place, word in enumerate(words)]
        elif layers:
            words = [prefix + word if place in (2, 3) and word else word for place, word in enumerate(words)]
        yield ", ".join(words)


def _head(text: str, prefix: str) -> tuple[str, list[str]]:
    """Return a keyword, and all parts of its line with new names."""
    parts = [part.strip() for part in text[1:].split(",")]
    keyword = " ".join(parts[0].upper().split())
    made = [keyword]
    for part in parts[1:]:
        key, equal, value = (one.strip() for one in part.partition("="))
        made.append(f"{key.upper()}={prefix + value if key.upper() in NAMES else value}" if equal else key.upper())
    return keyword, [part for part in made if part]


def _moved(word: str, offset: int, prefix: str, step: bool) -> str:
    if not word or step:
        return word
    return str(int(word) + offset) if word.isdecimal() else prefix + word
