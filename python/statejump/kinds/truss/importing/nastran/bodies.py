# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid elements and equations between displacements."""
from __future__ import annotations

from dataclasses import replace

import numpy as np

from statejump.kinds.truss.importing.coupling import ALL, MOVES, couple
from statejump.kinds.truss.importing.model import Equation, Follower, RigidBody
from statejump.kinds.truss.importing.nastran.cards import Card
from statejump.kinds.truss.importing.nastran.reader import Reader


def rbar(reader: Reader, card: Card) -> None:
    """Read a rigid bar between two nodes (RBAR, RBAR1)."""
    first, second = (reader.node(card, place) for place in (1, 2))
    if card.name == "RBAR1":
        _couple(reader, card, first, [second], frozenset(card[3] or "123456"))
        return
    free = [frozenset(card[place]) for place in (3, 4)]
    coupled = [frozenset(card[place]) for place in (5, 6)]
    if not any(free):
        free[0] = ALL
    if not any(coupled):
        coupled = [ALL - one for one in free]
    # Accepted: all components of one end are independent, or the dependent components are those that are not free.
    if free in ([ALL, frozenset()], [frozenset(), ALL]) and not coupled[free.index(ALL)]:
        at = free.index(ALL)
        if MOVES <= coupled[1 - at] and not reader.bends():
            reader.deck.rigid.append(RigidBody(card.line, card.name, [first, second]))
            return
        _couple(reader, card, (first, second)[at], [(second, first)[at]], coupled[1 - at])
    elif len(free[0]) + len(free[1]) == 6 and coupled == [ALL - one for one in free]:
        reader.deck.rigid.append(RigidBody(card.line, card.name, [first, second]))
    else:
        reader.deck.refuse(card.name, "partial_coupling", card.line)


def rbe2(reader: Reader, card: Card) -> None:
    """Read a rigid body (RBE2)."""
    first, components = reader.node(card, 1), frozenset(card[2])
    texts = [text for text in card.fields[3:] if text]
    if texts and not texts[-1].isdecimal():  # its coefficient of thermal expansion
        if reader.number(Card(card.line, card.name, [texts.pop()]), 0) != 0:
            reader.deck.refuse("RBE2.ALPHA", "rigid_body_expansion", card.line)
    _couple(reader, card, first, reader.several(card, texts), components)


def _couple(reader: Reader, card: Card, master: str, others: list[str], components: frozenset[str]) -> None:
    """Add rigid bodies whose other nodes follow a master in some components, each in its displacement system."""
    if not components <= ALL:
        raise reader.fail(card, "deck_bad_value",
                          problem=f"components {''.join(sorted(components))} are not of the digits 1 to 6")

    def axes(node: str) -> np.ndarray:
        frame = reader.frames[reader.displacement_frame[node]]
        return np.asarray(frame.directions(reader.deck.nodes[node]))

    couple(reader.deck, card.line, card.name, master, others, components, axes, reader.bends())


def rbe3(reader: Reader, card: Card) -> None:
    """Read a node that follows the mean motion of others (RBE3)."""
    node = reader.node(card, 2)
    if not set(card[3]) <= ALL:
        raise reader.fail(card, "deck_bad_value", problem=f"components {card[3]} are not of the digits 1 to 6")
    others, unsupported = _others(reader, card)
    follows = _ways(reader, node, card[3])
    reader.deck.followers.append(Follower(card.line, card.name, node, follows, others, unsupported))


def _ways(reader: Reader, node: str, components: str) -> np.ndarray:
    """Return the directions (k, 6) of components of a node in its displacement system."""
    axes = reader.frames[reader.displacement_frame[node]].directions(reader.deck.nodes[node])
    return np.kron(np.eye(2), axes)[[int(one) - 1 for one in sorted(set(components))]].reshape(-1, 6)


def _others(reader: Reader, card: Card) -> tuple[list[tuple[str, float, np.ndarray]], list[str]]:
    """Return nodes, weights and components of an RBE3, and its fields that are not supported."""
    found: list[tuple[str, float, np.ndarray]] = []
    unsupported: list[str] = []
    texts = [text for text in card.fields[4:] if text]
    while texts:
        if texts[0].upper() == "UM":  # chooses which displacements are dependent, not how they are related
            texts = texts[next((at for at, text in enumerate(texts) if text.upper() == "ALPHA"), len(texts)):]
            continue
        if texts[0].upper() == "ALPHA":
            if reader.number(replace(card, fields=texts), 1) != 0:
                unsupported.append("ALPHA")
            texts = texts[2:]
            continue
        weight = reader.number(replace(card, fields=texts), 0)
        if len(texts) < 3 or not set(texts[1]) <= ALL or not weight > 0:
            raise reader.fail(card, "deck_bad_value", problem=f"{' '.join(texts[:2])} is no weight with its components")
        components, texts = texts[1], texts[2:]
        count = next((at for at, text in enumerate(texts) if not text.isdecimal() and text.upper() != "THRU"),
                     len(texts))
        found += [(name, weight, _ways(reader, name, components)) for name in reader.several(card, texts[:count])]
        texts = texts[count:]
    if not found:
        raise reader.fail(card, "deck_incomplete", needed="nodes")
    return found, unsupported


def rrod(reader: Reader, card: Card) -> None:
    """Read a rod of constant length (RROD). It becomes one equation for the displacements of its ends along the rod."""
    first, second = (reader.node(card, place) for place in (1, 2))
    way = np.subtract(reader.deck.nodes[second], reader.deck.nodes[first])
    length = float(np.linalg.norm(way))
    if not length:
        raise reader.fail(card, "deck_bad_geometry", problem=f"nodes {first} and {second} are at one position")
    reader.deck.equations.append(
        Equation(card.line, card.name, [(second, way / length, 1.0), (first, way / length, -1.0)]))


def mpc(reader: Reader, card: Card) -> None:
    """An equation between displacements and rotations."""
    # Each line of the card has two terms: node, component, factor.
    places = [place for start in range(0, len(card.fields), 8) for place in (start + 1, start + 4) if card[place]]
    if {card[place + 1] for place in places} <= set("456") and not reader.bends():
        reader.deck.leave(card.name, "an equation of rotations: ends of bars turn freely", card.line)
        return
    made = Equation(card.line, card.name, [])
    for place in places:
        factor = reader.number(card, place + 2, 0.0)
        component = card[place + 1] or "0"
        if component not in ALL:
            reader.deck.refuse(card.name, "scalar_point", card.line)
            return
        node = reader.node(card, place)
        axes = reader.frames[reader.displacement_frame[node]].directions(reader.deck.nodes[node])
        if factor:
            terms = made.terms if component in MOVES else made.turns
            terms.append((node, axes[(int(component) - 1) % 3], factor))
    reader.deck.equations.append(made)
