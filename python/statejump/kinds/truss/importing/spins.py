# SPDX-License-Identifier: GPL-3.0-or-later
"""Beams that spin freely about their own axis.

A straight row of beams spins freely if only displacements of its nodes are held or shared. Neither stiffness nor load
acts on this motion, yet a run refuses it as a mechanism. The import therefore holds one rotation of one node of the
row. If the row is along no axis, it holds the rotation about the axis nearest to the row. The spin then makes this
rotation 0 without a moment, so displacements and forces are those of the free row.
"""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from statejump.kinds.truss.importing.model import Deck
from statejump.kinds.truss.importing.supports import ALONG, SAME


@dataclass
class _Row:
    """Nodes that rotate together, the positions of their beams and arms, and the direction of its first beam."""

    nodes: list[str] = field(default_factory=list)
    places: list[np.ndarray] = field(default_factory=list)
    axis: np.ndarray | None = None


def hold_spins(deck: Deck) -> None:
    """Hold the spin of all rows of beams on which neither stiffness nor load acts, after bodies are settled."""
    for row in _rows(deck):
        if row.axis is None or not _spins(deck, row, row.axis):
            continue
        at = int(np.argmax(np.abs(row.axis)))
        node = row.nodes[0]
        deck.hold_rotation(node, np.eye(3)[at])
        deck.take("free spin", "a held rotation, for a row of beams that spins about its own axis")
        deck.choices.append(f"node {node}: its rotation about {'xyz'[at]} is held; its row of beams spins freely about "
                            "its own axis, no stiffness and no load acts on that")


def _rows(deck: Deck) -> list[_Row]:
    """Return the groups of nodes that beams, rigid arms and hinges make rotate together."""
    row_of: dict[str, _Row] = {node: _Row([node], [np.array(deck.nodes[node])]) for node in sorted(deck.bent())}

    def unite(first: str, second: str) -> None:
        one, other = row_of[first], row_of[second]
        if one is not other:
            one.nodes += other.nodes
            one.places += other.places
            one.axis = other.axis if one.axis is None else one.axis
            row_of.update({node: one for node in other.nodes})

    for bar in deck.bars:
        if bar.bending is None:
            continue
        first, second = deck.ends_of(bar)
        turned = [end for end, turns in zip(bar.nodes, bar.bending.turned_ends) if turns]
        for end in turned:
            row = row_of[end]
            row.places += [first, second]
            row.axis = second - first if row.axis is None else row.axis
        if len(turned) == 2 and not any("Rx" in released for released in bar.bending.released):
            unite(*turned)
    for arm in deck.arms:
        row_of[arm.master].places.append(np.array(deck.nodes[arm.node]))
        if arm.rotations:
            unite(arm.master, arm.node)
    for hinge in deck.hinges:
        unite(*hinge.nodes)
    return list({id(row): row for row in row_of.values()}.values())


def _spins(deck: Deck, row: _Row, axis: np.ndarray) -> bool:
    """Return whether a row is straight, and neither a support nor a moment acts on its spin."""
    size = float(np.linalg.norm(axis))
    along = axis / size if size else axis
    ways = np.array(row.places) - row.places[0]
    aside = np.linalg.norm(np.cross(ways, along), axis=1)
    if not size or (aside > ALONG * np.linalg.norm(ways, axis=1).max(initial=0.0)).any():
        return False
    if any(abs(way @ along) > SAME for node in row.nodes for way in deck.held_rotations.get(node, ())):
        return False
    moments = [of[node] for of in (deck.moment, deck.weight_moment) for node in row.nodes if node in of]
    return not any(abs(moment @ along) > SAME * np.linalg.norm(moment) for moment in moments)
