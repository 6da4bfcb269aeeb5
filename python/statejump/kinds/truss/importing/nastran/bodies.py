# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid elements and equations between displacements."""
from __future__ import annotations

from dataclasses import replace

import numpy as np

from statejump.kinds.truss.importing.coupling import ALL, MOVES, couple
from statejump.kinds.truss.importing.model import Equation, Follower, RigidBody
from statejump.kinds.truss.importing.nastran.cards import Card
from statejump.kinds.truss.importing.nastran.reader import Reader
from statejump.kinds.truss.importing.supports import SAME


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
    reader.deck.followers.append(Follower(card.line, card.name, reader.node(card, 2), equations(reader, card)))


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
    """An equation between displacements."""
    # Each line of the card has two terms: node, component, factor.
    places = [place for start in range(0, len(card.fields), 8) for place in (start + 1, start + 4) if card[place]]
    if {card[place + 1] for place in places} <= set("456") and not reader.bends():
        reader.deck.leave(card.name, "an equation of rotations: ends of bars turn freely", card.line)
        return
    terms = []
    for place in places:
        factor = reader.number(card, place + 2, 0.0)
        component = card[place + 1] or "0"
        if component not in MOVES:
            reader.deck.refuse(card.name, "scalar_point" if component == "0" else "rotation", card.line)
            return
        node = reader.node(card, place)
        axes = reader.frames[reader.displacement_frame[node]].directions(reader.deck.nodes[node])
        if factor:
            terms.append((node, axes[int(component) - 1], factor))
    reader.deck.equations.append(Equation(card.line, card.name, terms))


def equations(reader: Reader, card: Card) -> list[Equation]:
    """Return the equations for the translations in REFC; empty if the card needs rotations or weights by component.

    :raises Unreadable: a field is not a number, or a node does not exist
    """
    node, components = reader.node(card, 2), [one for one in card[3] if one in MOVES]
    weighted = _weights(reader, card)
    if weighted is None or not components or node in weighted:
        return []
    places = np.array([reader.deck.nodes[one] for one in weighted])
    weights = np.array(list(weighted.values()))
    centre = weights @ places / weights.sum()
    arms, lever = places - centre, np.subtract(reader.deck.nodes[node], centre)
    squares = np.einsum("i,ij,ij->", weights, arms, arms)
    inertia = squares * np.eye(3) - np.einsum("i,ij,ik->jk", weights, arms, arms)
    turns = np.linalg.pinv(inertia, rcond=SAME**2, hermitian=True)
    size = np.linalg.norm(lever)
    found = []
    for component in components:
        axis = reader.frames[reader.displacement_frame[node]].directions(reader.deck.nodes[node])[int(component) - 1]
        moment = np.cross(lever, axis)
        if np.linalg.norm(moment - inertia @ turns @ moment) > SAME * size:
            return []  # collinear nodes do not determine the rotation about their line
        shares = weights[:, None] * (axis / weights.sum() + np.cross(turns @ moment, arms))
        terms = [(node, axis, 1.0)]
        for name, share in zip(weighted, shares):
            if (length := float(np.linalg.norm(share))) > 0:
                terms.append((name, share / length, -length))
        found.append(Equation(card.line, card.name, terms))
    return found


def _weights(reader: Reader, card: Card) -> dict[str, float] | None:
    """Return the weight of each node; None if weights hold only for some components, or if the card has UM or ALPHA."""
    found: dict[str, float] = {}
    texts = [text for text in card.fields[4:] if text]
    while texts:
        if "." not in texts[0] or len(texts) < 3 or set(texts[1]) != MOVES:
            return None
        weight = reader.number(replace(card, fields=texts[:1]), 0)
        texts = texts[2:]
        count = next((at for at, text in enumerate(texts) if not text.isdecimal() and text.upper() != "THRU"),
                     len(texts))
        if not weight > 0:
            return None
        for name in reader.several(card, texts[:count]):
            found[name] = found.get(name, 0.0) + weight
        texts = texts[count:]
    return found or None
