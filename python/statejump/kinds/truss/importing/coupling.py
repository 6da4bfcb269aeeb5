# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that follow a master in some displacements and rotations, as rigid bodies or equations of a deck."""
from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from statejump.kinds.truss.importing.model import Deck, Equation, RigidBody
from statejump.kinds.truss.importing.supports import SAME

ALL, MOVES, TURNS = frozenset("123456"), frozenset("123"), frozenset("456")


def couple(deck: Deck, line: int, card: str, master: str, others: Sequence[str], components: frozenset[str],
           axes_of: Callable[[str], np.ndarray], bends: bool) -> None:
    """Add rigid bodies whose other nodes follow a master in some components.

    :param components: digits 1 to 6
    :param axes_of: directions of the components of a node, as rows
    :param bends: whether beams of the deck bend
    """
    moves, turns = components & MOVES, components & TURNS
    if not moves and (turns and bends):
        deck.refuse(card, "partial_coupling", line)
    elif not moves:
        deck.leave(card, "it couples rotations only", line)
    elif moves == MOVES and (turns in (TURNS, frozenset()) or not bends):
        free = () if turns == TURNS or not bends else tuple(np.eye(3))
        deck.rigid.append(RigidBody(line, card, [master, *others], free=free))
    else:
        for other in others:
            _couple_one(deck, RigidBody(line, card, [master, other]), components, axes_of(other), bends)


def _couple_one(deck: Deck, body: RigidBody, components: frozenset[str], axes: np.ndarray, bends: bool) -> None:
    """Add a rigid body of two nodes that couples some components. At one position, displacements become equations."""
    moves, turns, (master, other) = components & MOVES, components & TURNS, body.nodes
    held = [axes[int(one) - 1] for one in sorted(moves)]
    if deck.nodes[other] == deck.nodes[master] and (not turns or not bends):
        deck.equations += [Equation(body.line, body.card, [(other, axis, 1.0), (master, axis, -1.0)]) for axis in held]
        return
    along = [[at for at in range(3) if abs(axis[at]) > 1 - SAME] for axis in held]
    if not bends or moves != MOVES and (not all(along) or turns not in (TURNS, frozenset())):
        deck.refuse(body.card, "partial_coupling", body.line)
        return
    body.directions = "xyz" if moves == MOVES else "".join(sorted("xyz"[one[0]] for one in along))
    body.free = tuple(axes[int(one) - 4] for one in sorted(TURNS - turns))
    deck.rigid.append(body)
