# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid elements and equations between displacements."""
from __future__ import annotations

from dataclasses import replace

import numpy as np

from statejump.kinds.truss.importing.model import Equation, Follower, RigidBody
from statejump.kinds.truss.importing.nastran.cards import Card
from statejump.kinds.truss.importing.nastran.reader import Reader
from statejump.kinds.truss.importing.supports import SAME

ALL, MOVES = frozenset("123456"), frozenset("123")


def rbar(reader: Reader, card: Card) -> None:
    """Read a rigid bar between two nodes (RBAR, RBAR1). It must couple all translations."""
    first, second = (reader.node(card, place) for place in (1, 2))
    if card.name == "RBAR1":
        coupled_ones = set(card[3] or "123456")
        pinned = coupled_ones != ALL
        if not MOVES <= coupled_ones:
            reader.deck.refuse(card.name, "partial_coupling", card.line)
            return
    else:
        free = [frozenset(card[place]) for place in (3, 4)]
        coupled = [frozenset(card[place]) for place in (5, 6)]
        if not any(free):
            free[0] = ALL
        if not any(coupled):
            coupled = [ALL - one for one in free]
        # Accepted: one end with all components and the other end following in translation (a hinge), or all components
        # that are not free follow.
        hinge = free in ([ALL, frozenset()], [frozenset(), ALL]) and MOVES <= coupled[free.index(frozenset())] and \
            not coupled[free.index(ALL)]
        if not hinge and (len(free[0]) + len(free[1]) != 6 or coupled != [ALL - one for one in free]):
            reader.deck.refuse(card.name, "partial_coupling", card.line)
            return
        pinned = hinge and coupled[free.index(frozenset())] != ALL
    reader.deck.rigid.append(RigidBody(card.line, card.name, [first, second], pinned))


def rbe2(reader: Reader, card: Card) -> None:
    """Read a rigid body (RBE2). If it couples only some components, at one position, it becomes equations."""
    first, components = reader.node(card, 1), set(card[2])
    texts = [text for text in card.fields[3:] if text]
    if texts and not texts[-1].isdecimal():  # its coefficient of thermal expansion
        if reader.number(Card(card.line, card.name, [texts.pop()]), 0) != 0:
            reader.deck.refuse("RBE2.ALPHA", "rigid_body_expansion", card.line)
    others = reader.several(card, texts)
    if not components <= ALL:
        raise reader.fail(card, "deck_bad_value", problem=f"components {card[2]} are not of the digits 1 to 6")
    if not components & MOVES and reader.bends():
        reader.deck.refuse(card.name, "partial_coupling", card.line)
    elif not components & MOVES:
        reader.deck.leave(card.name, "it couples rotations only", card.line)
    elif MOVES <= components:
        reader.deck.rigid.append(RigidBody(card.line, card.name, [first, *others], components != ALL))
    elif any(reader.deck.nodes[other] != reader.deck.nodes[first] for other in others):
        reader.deck.refuse(card.name, "partial_coupling", card.line)
    else:
        for other in others:
            axes = reader.frames[reader.displacement_frame[other]].directions(reader.deck.nodes[other])
            reader.deck.equations += [
                Equation(card.line, card.name, [(other, axes[int(one) - 1], 1.0), (first, axes[int(one) - 1], -1.0)])
                for one in sorted(components & MOVES)]


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
