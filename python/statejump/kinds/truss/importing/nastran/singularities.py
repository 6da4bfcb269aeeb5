# SPDX-License-Identifier: GPL-3.0-or-later
"""AUTOSPC of Nastran: components of a node without stiffness are held automatically."""
from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from statejump.kinds.truss.importing.model import Deck
from statejump.kinds.truss.importing.nastran.reader import Reader
from statejump.kinds.truss.importing.supports import SAME, basis_of, held_directions

# EPZERO of Nastran: stiffness below this fraction of the largest one of the node counts as zero.
EPZERO = 1e-8


def hold_singular(reader: Reader) -> None:
    """Hold components without stiffness, in displacement systems, except at ends of beams, which are stiff in
    Nastran."""
    deck = reader.deck
    stiffness: dict[str, np.ndarray] = {}
    bent = {end for bar in deck.bars if bar.bends for end in bar.nodes}
    pairs = [bar.nodes for bar in deck.bars]
    pairs += [(spring.first, spring.second) for spring in deck.springs if spring.second]
    for first, second in pairs:
        way = np.subtract(deck.nodes[second], deck.nodes[first])
        length = float(np.linalg.norm(way))
        if length == 0:
            continue
        block = np.outer(way, way) / length**2  # only which directions are stiff matters
        for end in (first, second):
            stiffness[end] = stiffness.get(end, np.zeros((3, 3))) + block
    for spring in deck.springs:
        if spring.direction is not None:
            block = np.outer(spring.direction, spring.direction)
            stiffness[spring.first] = stiffness.get(spring.first, np.zeros((3, 3))) + block
    tied = deck.equation_directions()
    for node, block in stiffness.items():
        if node in bent:
            continue
        axes = reader.frames[reader.displacement_frame[node]].directions(deck.nodes[node])
        largest = np.einsum("ij,jk,ik->i", axes, block, axes).max()
        for free in _left_free(deck, node, axes, tied.get(node, [])):
            if free @ block @ free > EPZERO * largest:
                continue
            deck.hold(node, [float(part) for part in free])
            deck.take("AUTOSPC", "directions of nodes without stiffness, held as in Nastran")


def _left_free(deck: Deck, node: str, axes: np.ndarray, tied: list[np.ndarray]) -> Iterator[np.ndarray]:
    """Yield those axes that neither supports hold nor equations couple."""
    basis = basis_of(np.vstack([held_directions(deck, node), *tied]))
    for axis in axes:
        free = axis - basis.T @ (basis @ axis)
        size = np.linalg.norm(free)
        if size > SAME:
            yield axis if size > 1 - SAME else free / size
