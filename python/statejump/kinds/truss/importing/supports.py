# SPDX-License-Identifier: GPL-3.0-or-later
"""Supports of a node in the form of a case: held axes, and one held direction of any orientation."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from statejump.kinds.truss.importing.model import Deck, Spring

# Sine of the angle below which directions are equal: coordinates have at least four digits. A support with this error
# changes the direction of the displacement by the same angle.
SAME = 1e-6
# Sine of the angle below which a spring is parallel to the line of its nodes; decks have at least four digits.
ALONG = 1e-4


def supports(deck: Deck, node: str, dimension: int) -> dict[str, Any]:
    """Return ``fixed`` and ``guide_normal`` of a node. :raises Unreadable: a case cannot represent its support"""
    if node not in deck.held:
        fixed = [axis for axis in "xyz"[:dimension] if axis in deck.fixed.get(node, ())]
        return {"fixed": fixed} if fixed else {}
    axes = np.eye(3)
    held = held_directions(deck, node)
    if dimension == 2:  # the plane holds the third direction
        held = np.vstack([held, axes[2]])
    basis = basis_of(held)
    along = [axis for axis in range(3) if np.linalg.norm(axes[axis] - basis.T @ (basis @ axes[axis])) <= SAME]
    rest = basis - basis[:, along] @ axes[along] if along else basis
    _, sizes, spanned = np.linalg.svd(rest)
    oblique = spanned[:int(np.sum(sizes > SAME))]
    if len(oblique) > 1:
        raise deck.fail(0, "deck_two_oblique_supports", node=node)
    made: dict[str, Any] = {}
    if along_axes := [axis for axis in "xyz"[:dimension] if "xyz".index(axis) in along]:
        made["fixed"] = along_axes
    if len(oblique):
        normal = oblique[0] * np.sign(oblique[0][np.argmax(np.abs(oblique[0]))])
        made["guide_normal"] = [float(f"{part:.15g}") for part in normal[:dimension]]
    return made


def held_directions(deck: Deck, node: str) -> np.ndarray:
    """Return the directions in which a node is held, as rows. The rows may be linearly dependent."""
    axes = np.eye(3)
    rows = [axes["xyz".index(axis)] for axis in sorted(deck.fixed.get(node, ()))]
    return np.array(rows + [np.array(direction) for direction in deck.held.get(node, ())]).reshape(-1, 3)


def is_held(deck: Deck, node: str, direction: np.ndarray) -> bool:
    """Whether the supports of a node hold it in a direction."""
    held = held_directions(deck, node)
    if not len(held):
        return False
    basis = basis_of(held)
    rest = direction - basis.T @ (basis @ direction)
    return bool(np.linalg.norm(rest) <= SAME * np.linalg.norm(direction))


def is_rotation_held(deck: Deck, node: str, direction: np.ndarray) -> bool:
    """Whether the supports of a node hold its rotation about a direction."""
    held = deck.held_rotations.get(node)
    if not held:
        return False
    basis = basis_of(np.array(held))
    rest = direction - basis.T @ (basis @ direction)
    return bool(np.linalg.norm(rest) <= SAME * np.linalg.norm(direction))


def basis_of(directions: np.ndarray) -> np.ndarray:
    """Return orthogonal directions that span the given rows."""
    _, sizes, spanned = np.linalg.svd(directions)
    return np.asarray(spanned[:int(np.sum(sizes > SAME))])


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
    """Return whether a spring between two nodes acts across the line between the nodes."""
    (first, direction), (second, other) = ends
    way = np.subtract(deck.nodes[second], deck.nodes[first])
    length = np.linalg.norm(way)
    return bool(length == 0 or (direction @ way) * (other @ way) < 0
                or any(np.linalg.norm(np.cross(one, way)) > ALONG * length for one in (direction, other)))
