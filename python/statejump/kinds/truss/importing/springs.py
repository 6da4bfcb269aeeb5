# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of springs between components of nodes to springs along a line."""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from statejump.kinds.truss.importing.model import Deck, Spring
from statejump.kinds.truss.importing.supports import is_held

# Sine of the angle below which a spring is parallel to the line of its nodes; decks have at least four digits.
ALONG = 1e-4


def add_spring(deck: Deck, line: int, card: str, name: str, stiffness: float,
               ends: Sequence[tuple[str, np.ndarray]]) -> None:
    """Add a spring between nodes, each with its direction, or between one node and the ground.

    A truss cannot represent a spring across the line between its nodes. Such a spring is refused unless one end is held
    in its direction, which makes it a spring to the ground. Call this function after supports are read.
    """
    if not ends or not stiffness:
        deck.leave(card, "it has no stiffness or no node", line)
        return
    if stiffness < 0:
        deck.refuse(card, "negative_stiffness", line)
        return
    if len(ends) == 2 and (len(free := [end for end in ends if not is_held(deck, *end)]) < 2) and _across(deck, ends):
        if not free:
            deck.leave(card, "both ends are held", line)
            return
        ends = free
    first, direction = ends[0]
    if len(ends) == 1:
        x, y, z = (float(part) for part in direction)
        deck.springs.append(Spring(name, first, None, stiffness, card, line, (x, y, z)))
    else:
        second, other = ends[1]
        if first == second:
            deck.refuse(card, "same_node", line)
            return
        way = np.subtract(deck.nodes[second], deck.nodes[first])
        length = np.linalg.norm(way)
        if length == 0:
            deck.refuse(card, "coincident_nodes", line)
            return
        if _across(deck, ends):
            deck.refuse(card, "lateral_stiffness", line)
            return
        deck.springs.append(Spring(name, first, second, stiffness, card, line))
    deck.take(card, "spring")


def _across(deck: Deck, ends: Sequence[tuple[str, np.ndarray]]) -> bool:
    """Return whether a spring between two nodes acts across the line between them."""
    (first, direction), (second, other) = ends
    way = np.subtract(deck.nodes[second], deck.nodes[first])
    length = np.linalg.norm(way)
    return bool(length == 0 or (direction @ way) * (other @ way) < 0
                or any(np.linalg.norm(np.cross(one, way)) > ALONG * length for one in (direction, other)))
