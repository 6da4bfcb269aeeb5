# SPDX-License-Identifier: GPL-3.0-or-later
"""GRID, coordinate systems and supports."""
from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from statejump.kinds.truss.importing.beams import node_stiffness
from statejump.kinds.truss.importing.coordinates import BASIC, by_points
from statejump.kinds.truss.importing.model import Deck, quoted
from statejump.kinds.truss.importing.nastran.cards import Card
from statejump.kinds.truss.importing.nastran.reader import Reader
from statejump.kinds.truss.importing.supports import SAME, basis_of, held_directions

# EPZERO of Nastran: stiffness below this fraction of the largest one of the node counts as zero.
EPZERO = 1e-8


def read_nodes(reader: Reader) -> None:
    """Read GRID cards. Their coordinate systems may refer to other GRID cards, in any order."""
    defaults = (reader.cards.get("GRDSET") or [Card(0, "GRDSET")])[0]
    reader.frames["0"] = BASIC
    grids: dict[str, Card] = {}
    for card in reader.cards.get("GRID", []):
        name = reader.whole(card, 0)
        if name in grids and grids[name].fields != card.fields:
            raise reader.deck.fail(card.line, "deck_duplicate", what_it_is="node", name=quoted(name))
        grids[name] = card
    _Places(reader, grids, defaults).place_all()
    for name, card in grids.items():
        reader.displacement_frame[name] = reader.whole(card, 5, reader.whole(defaults, 5, "0"))
        if held := card[6] or defaults[6]:
            fix(reader, card, held, [name])
        reader.deck.take("GRID", "node")
    reader.sorted_nodes = sorted(map(int, grids))


class _Places:
    """Computes the positions of nodes and coordinate systems, which may refer to each other without a loop."""

    def __init__(self, reader: Reader, grids: dict[str, Card], defaults: Card) -> None:
        self.reader, self.grids = reader, grids
        self.default = reader.whole(defaults, 1, "0")
        self.systems: dict[str, tuple[Card, int]] = {}
        for kind in "RCS":
            for card in reader.cards.get(f"CORD1{kind}", []):
                for place in (0, 4):
                    if card[place]:
                        self._add(card, place)
            for card in reader.cards.get(f"CORD2{kind}", []):
                self._add(card, 0)

    def _add(self, card: Card, place: int) -> None:
        name = self.reader.whole(card, place)
        if name == "0" or name in self.systems and self.systems[name][0].fields != card.fields:
            raise self.reader.fail(card, "deck_duplicate", what_it_is="coordinate system", name=name)
        self.systems[name] = (card, place)
        self.reader.deck.take(card.name, "coordinate system")

    def place_all(self) -> None:
        """Compute the positions of all nodes and coordinate systems, each after those to which it refers."""
        for kind, names in (("system", list(self.systems)), ("node", list(self.grids))):
            for name in names:
                waiting = [(kind, name)]
                on_way = set(waiting)
                while waiting:
                    needed = self._needed(*waiting[-1])
                    if not needed:
                        self._place(*waiting[-1])
                        on_way.discard(waiting.pop())
                    elif needed[0] in on_way:
                        card = self.grids[name] if kind == "node" else self.systems[name][0]
                        raise self.reader.fail(card, "deck_circular_reference")
                    else:
                        waiting.append(needed[0])
                        on_way.add(needed[0])

    def _needed(self, kind: str, name: str) -> list[tuple[str, str]]:
        """Return the nodes and systems whose positions must be known first."""
        reader = self.reader
        if kind == "node":
            card = self.grids[name]
            needed = [("system", reader.whole(card, 1, self.default))]
        else:
            card, place = self.systems[name]
            needed = [("system", reader.whole(card, 1, "0"))] if card.name.startswith("CORD2") else [
                ("node", reader.whole(card, place + further)) for further in (1, 2, 3)]
        missing = []
        for of, other in needed:
            placed = other in reader.frames if of == "system" else other in reader.deck.nodes
            if not placed:
                if not (other in self.systems if of == "system" else other in self.grids):
                    what = "coordinate system" if of == "system" else "GRID"
                    raise reader.fail(card, "deck_undefined", what_it_is=what, name=other)
                missing.append((of, other))
        return missing

    def _place(self, kind: str, name: str) -> None:
        reader = self.reader
        if kind == "node":
            if name in reader.deck.nodes:
                return
            card = self.grids[name]
            frame = reader.frames[reader.whole(card, 1, self.default)]
            x, y, z = frame.point([reader.number(card, at, 0.0) for at in (2, 3, 4)])
            reader.deck.add_node(card.line, name, (float(x), float(y), float(z)))
            return
        card, place = self.systems[name]
        if card.name.startswith("CORD2"):
            base = reader.frames[reader.whole(card, 1, "0")]
            points = [base.point([reader.number(card, at + axis, 0.0) for axis in range(3)]) for at in (2, 5, 8)]
        else:
            points = [np.array(reader.deck.nodes[reader.whole(card, place + further)]) for further in (1, 2, 3)]
        frame_found = by_points(card.name[-1], *points)
        if frame_found is None:
            raise reader.fail(card, "deck_bad_geometry",
                              problem=f"the points of coordinate system {name} span no plane")
        reader.frames[name] = frame_found


def fix(reader: Reader, card: Card, components: str, nodes: list[str]) -> None:
    """Hold components of nodes in their displacement systems. Blanks may separate the components."""
    components = "".join(components.split())
    if not set(components) <= set("0123456"):
        raise reader.fail(card, "deck_bad_value",
                          problem=f"components {quoted(components)} are not of the digits 1 to 6")
    moves = [int(one) - 1 for one in dict.fromkeys(components) if one in "123"]
    turns = [int(one) - 4 for one in dict.fromkeys(components) if one in "456"]
    if turns and not reader.bends():
        reader.deck.leave(card.name, "components 4 to 6: ends of bars turn freely", card.line)
        turns = []
    for node in nodes if moves or turns else ():
        frame = reader.frames.get(reader.displacement_frame[node])
        if frame is None:
            raise reader.fail(card, "deck_undefined", what_it_is="coordinate system",
                              name=reader.displacement_frame[node])
        directions = frame.directions(reader.deck.nodes[node])
        for one in moves:
            reader.deck.hold(node, directions[one])
        for one in turns:
            reader.deck.hold_rotation(node, directions[one])
    if moves:
        reader.deck.take(card.name, "directions without motion", len(nodes))
    if turns:
        reader.deck.take(card.name, "directions without rotation, where beams end", len(nodes))


def spc1(reader: Reader, card: Card) -> None:
    """Hold the nodes of a list."""
    fix(reader, card, card[1], reader.several(card, [text for text in card.fields[2:] if text]))


def spc(reader: Reader, card: Card) -> None:
    """Hold one or two nodes."""
    for place in (1, 4):
        if not card[place]:
            continue
        if card[place + 2] and reader.number(card, place + 2) != 0:
            reader.deck.refuse(card.name, "prescribed_displacement", card.line)
            continue
        fix(reader, card, card[place + 1], [reader.node(card, place)])


def hold_singular(reader: Reader) -> None:
    """Hold components without stiffness, in displacement systems. Ends of beams that become pin-jointed bars are
    excepted: in Nastran they are stiff."""
    deck = reader.deck
    stiffness, rotational = _node_stiffness(reader)
    tied = deck.equation_directions()
    _pass_to_masters(deck, stiffness, rotational, tied)
    bent = {end for bar in deck.bars if bar.bends and not bar.bending for end in bar.nodes}
    for node, block in rotational.items():
        axes = _axes(reader, node)
        largest = np.einsum("ij,jk,ik->i", axes, block, axes).max()
        for free in _left_free(np.array(deck.held_rotations.get(node, [])).reshape(-1, 3), axes):
            if free @ block @ free <= EPZERO * largest:
                deck.hold_rotation(node, free)
                deck.take("AUTOSPC", "rotations of nodes without stiffness, held as in Nastran")
    for node, block in stiffness.items():
        if node in bent:
            continue
        axes = _axes(reader, node)
        largest = np.einsum("ij,jk,ik->i", axes, block, axes).max()
        for free in _left_free(np.vstack([held_directions(deck, node), *tied.get(node, [])]), axes):
            if free @ block @ free > EPZERO * largest:
                continue
            deck.hold(node, [float(part) for part in free])
            deck.take("AUTOSPC", "directions of nodes without stiffness, held as in Nastran")


def _axes(reader: Reader, node: str) -> np.ndarray:
    """Return the displacement directions of a node as rows; a node that the import added has those of the basic
    system."""
    frame = reader.frames[reader.displacement_frame.get(node, "0")]
    return np.asarray(frame.directions(reader.deck.nodes[node]))


def _node_stiffness(reader: Reader) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return the stiffness of displacements and of rotations of nodes, to which bars, beams, springs and hinges
    contribute."""
    deck = reader.deck
    stiffness: dict[str, np.ndarray] = {}
    rotational: dict[str, np.ndarray] = {}

    def add(of: dict[str, np.ndarray], node: str, block: np.ndarray) -> None:
        of[node] = of.get(node, np.zeros((3, 3))) + block

    for bar in deck.bars:
        first, second = deck.ends_of(bar)
        way = second - first
        length = float(np.linalg.norm(way))
        if length == 0:
            continue
        over_length = (bar.young_modulus or 1.0) / length
        if bar.bending:
            moves, turns = node_stiffness(bar, first, second)
            for end, turned in zip(bar.nodes, bar.bending.turned_ends):
                add(stiffness, end, over_length * (bar.area or 1.0) * moves)
                if turned:
                    add(rotational, end, over_length * turns)
        else:
            for end in bar.nodes:
                add(stiffness, end, over_length * (bar.area or 1.0) * np.outer(way, way) / length**2)
    for spring in deck.springs:
        way = np.array(spring.direction) if spring.second is None else np.subtract(
            deck.nodes[spring.second], deck.nodes[spring.first])
        ends = [spring.first] if spring.second is None else [spring.first, spring.second]
        for node in ends if np.any(way) else ():
            add(stiffness, node, spring.stiffness * np.outer(way, way) / (way @ way))
    for hinge in deck.hinges:
        across = np.eye(3) - np.outer(hinge.axis, hinge.axis)
        blocks = [rotational.get(end, np.zeros((3, 3))) for end in hinge.nodes]
        for end, other in zip(hinge.nodes, blocks[::-1]):
            add(rotational, end, across @ other @ across + hinge.stiffness * np.outer(hinge.axis, hinge.axis))
    return stiffness, rotational


def _pass_to_masters(deck: Deck, stiffness: dict[str, np.ndarray], rotational: dict[str, np.ndarray],
                     tied: dict[str, list[np.ndarray]]) -> None:
    """Pass the stiffness of nodes on rigid arms to their masters, from the outermost arm inwards."""
    waiting, outer = list(deck.arms), list(deck.arms)
    while outer:  # the case refuses a ring of arms
        masters = {arm.master for arm in waiting}
        outer = [arm for arm in waiting if arm.node not in masters]
        for arm in outer:
            waiting.remove(arm)
            held = np.diag([float(axis in arm.directions) for axis in "xyz"])
            block = held @ stiffness.get(arm.node, np.zeros((3, 3))) @ held
            x, y, z = np.subtract(deck.nodes[arm.node], deck.nodes[arm.master])
            lever = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])  # displacement by a rotation
            turns = lever.T @ block @ lever
            if arm.rotations:
                turns = turns + rotational.pop(arm.node, np.zeros((3, 3)))
            stiffness[arm.master] = stiffness.get(arm.master, np.zeros((3, 3))) + block
            rotational[arm.master] = rotational.get(arm.master, np.zeros((3, 3))) + turns
            tied.setdefault(arm.node, []).extend(np.eye(3)["xyz".index(axis)] for axis in arm.directions)
    for hinge in deck.hinges:
        for end in hinge.nodes:
            tied.setdefault(end, []).extend(np.eye(3))


def _left_free(held: np.ndarray, axes: np.ndarray) -> Iterator[np.ndarray]:
    """Yield the directions along the axes that neither supports hold nor equations couple."""
    basis = basis_of(held)
    for axis in axes:
        free = axis - basis.T @ (basis @ axis)
        size = np.linalg.norm(free)
        if size > SAME:
            yield axis if size > 1 - SAME else free / size
