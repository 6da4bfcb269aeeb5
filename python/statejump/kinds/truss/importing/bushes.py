# SPDX-License-Identifier: GPL-3.0-or-later
"""Springs of displacements and rotations between two nodes, or between a node and the ground.

Cases have springs along a line only. The two nodes carry rigid arms to further nodes around the elastic centre, and
springs of the case connect the ends of these arms. Two springs of half the stiffness K of a direction, at distances ±a
from the centre, have the stiffness K of displacements and K a² of rotations. A stiffness of rotations therefore needs
one of displacements in a direction across its axis, or a support in this direction.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from statejump.kinds.truss.importing.model import Arm, Deck, Spring
from statejump.kinds.truss.importing.supports import is_held


@dataclass(frozen=True)
class Bush:
    """A spring with up to six stiffnesses.

    :param second: the second node; None: the ground
    :param axes: directions of the stiffnesses, as rows
    :param moves: stiffness of displacements along the axes
    :param turns: stiffness of rotations about the axes
    """

    line: int
    card: str
    name: str
    first: str
    second: str | None
    centre: np.ndarray
    axes: np.ndarray
    moves: tuple[float, ...]
    turns: tuple[float, ...]


def add_bush(deck: Deck, bush: Bush) -> None:
    """Add the arms and springs of a bush, after supports are read. Refuse a stiffness of rotations without one of
    displacements across its axis."""
    size = float(np.ptp(np.array(list(deck.nodes.values())), axis=0).max()) or 1.0
    moves, levers = list(bush.moves), np.zeros((3, 3))  # lever of the springs along a direction, along another one
    for about in (at for at in range(3) if bush.turns[at]):
        across = [at for at in range(3) if at != about]
        along = next((at for at in across if bush.moves[at]), None)
        if along is None:
            along = next((at for at in across if _holds(deck, bush, at)), None)
            if along is None:
                deck.refuse(bush.card, "rotation_spring", bush.line)
                return
            moves[along] = moves[along] or bush.turns[about] / size**2
        levers[along, 3 - about - along] = (bush.turns[about] / moves[along]) ** 0.5
    for along in (at for at in range(3) if moves[at]):
        places = _around(bush, levers[along])
        for number, place in enumerate(places, start=1):
            name = f"{bush.name}_{along + 1}_{number}"
            first = _end(deck, bush, bush.first, place, name)
            x, y, z = (float(part) for part in bush.axes[along])
            second = None
            if bush.second is not None:
                second = _end(deck, bush, bush.second, place + size * bush.axes[along], name)
            deck.springs.append(Spring(name, first, second, moves[along] / len(places), bush.card, bush.line,
                                       None if second else (x, y, z)))
    deck.take(bush.card, "springs between rigid arms")


def _holds(deck: Deck, bush: Bush, along: int) -> bool:
    """Return whether supports hold both nodes along an axis, so that a spring along it acts on rotations only."""
    return all(is_held(deck, node, bush.axes[along]) and not np.any(np.subtract(deck.nodes[node], bush.centre))
               for node in (bush.first, bush.second) if node is not None)


def _around(bush: Bush, levers: np.ndarray) -> list[np.ndarray]:
    """Return the positions of the springs along one axis."""
    places = [bush.centre]
    for axis, lever in zip(bush.axes, levers):
        if lever:
            places = [place + sign * lever * axis for place in places for sign in (1, -1)]
    return places


def _end(deck: Deck, bush: Bush, master: str, place: np.ndarray, name: str) -> str:
    """Return the node at the end of an arm, a new one beside its master."""
    if np.array_equal(place, deck.nodes[master]):
        return master
    x, y, z = (float(part) for part in place)
    end = f"{name}_{'a' if master == bush.first else 'b'}"
    deck.add_node(bush.line, end, (x, y, z))
    deck.arms.append(Arm(bush.card, master, end, rotations=False))
    return end
