# SPDX-License-Identifier: GPL-3.0-or-later
"""RBE3, a node that follows the mean motion of others, as equations between translations.

The node moves with the rigid-body motion that fits the others best, by weighted least squares: u = ū + θ × d, with θ =
I⁻¹ Σ w r × u about their weighted centre. This is linear in the translations of the others and needs no rotations.
"""
from __future__ import annotations

from dataclasses import replace

import numpy as np

from statejump.kinds.truss.importing.model import Equation
from statejump.kinds.truss.importing.nastran.cards import Card
from statejump.kinds.truss.importing.nastran.reader import Reader
from statejump.kinds.truss.importing.supports import SAME

MOVES = "123"


def equations(reader: Reader, card: Card) -> list[Equation]:
    """Return the equations of the translations in REFC; empty if the card needs rotations or has weights by components.

    :raises Unreadable: a field is no number, or a node does not exist
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
    """Return the weight of each node; None: the card has weights of some components only, UM or ALPHA."""
    found: dict[str, float] = {}
    texts = [text for text in card.fields[4:] if text]
    while texts:
        if "." not in texts[0] or len(texts) < 3 or set(texts[1]) != set(MOVES):
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
