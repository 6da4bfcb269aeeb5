# SPDX-License-Identifier: GPL-3.0-or-later
"""The deck that a body was condensed from. The file of the body contains it, so that ``statejump fe`` can compute the
mesh in place of the reduced stiffness."""
from __future__ import annotations

import attrs
import numpy as np
from numpy.typing import NDArray

from statejump.core.errors import NotAllowed

MOST_TEXT = 50_000_000  # characters of a deck that is stored


@attrs.frozen(eq=False)
class MeshDeck:
    """A deck without supports, temperatures and steps.

    :param text: its lines
    :param kinds: of each interface node: ``mean``, ``rigid``, ``expanding`` or ``node``; its name is that of the set
    :param nodes: numbers of the k nodes with temperatures
    :param temperatures: temperature (p, k) of the nodes per unit of each pattern
    :param gradients: gradient (p) through the thickness of shells per unit of each pattern [1/unit of length]
    :param length_m: unit of length of the deck [m]
    :param force_N: unit of force of the deck [N]
    """

    text: str
    kinds: tuple[str, ...]
    nodes: NDArray[np.int64]
    temperatures: NDArray[np.float64]
    gradients: NDArray[np.float64]
    length_m: float = 1.0
    force_N: float = 1.0


def checked(deck: MeshDeck | None, nodes: int, patterns: int) -> MeshDeck | None:
    """Return a deck whose arrays fit the body. :raises NotAllowed: they do not"""
    if deck is None:
        return None
    numbers = np.atleast_1d(np.asarray(deck.nodes, dtype=np.int64))
    temperatures, gradients = (np.asarray(one, dtype=float) for one in (deck.temperatures, deck.gradients))
    if len(deck.kinds) != nodes or temperatures.shape != (patterns, len(numbers)) or gradients.shape != (patterns,) \
            or not (np.isfinite(temperatures).all() and np.isfinite(gradients).all()):
        raise NotAllowed("deck", code="body_deck")
    return attrs.evolve(deck, nodes=numbers, temperatures=temperatures, gradients=gradients)
