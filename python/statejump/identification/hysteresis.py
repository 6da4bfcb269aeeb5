# SPDX-License-Identifier: GPL-3.0-or-later
"""Friction with memory along a path of displacements: Masing's rule with return points.

Let the backbone B be the force of a first loading. The friction force is a sum of values of B at half distances between
the reversal points in memory. These distances depend only on the path and are computed once; the force for any
parameters is then one matrix product. (G. Masing, Proc. 2nd Int. Congr. Applied Mechanics, 1926.)
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

Backbone = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Memory:
    """Friction memory in every row of a path of displacements.

    :param half_distance: distances at which the backbone is needed [m or rad]
    :param weights: sparse matrix (rows, half distances); the force is its product with the backbone
    :param loaded: memories of the same path after full slip backwards and forwards; None: the initial state is known
    :param path: displacements; only if ``loaded`` is given
    """

    half_distance: np.ndarray
    weights: csr_matrix
    loaded: tuple[Memory, Memory] | None = None
    path: np.ndarray | None = None

    def force(self, backbone: Backbone, start: float = 0.0) -> np.ndarray:
        """Return the friction force in every row.

        :param backbone: function that returns the force of a first loading from rest at a displacement
        :param start: friction in the first row as a fraction of its limit, if the initial state is unknown. Sliders
            with different limits have more than one such state; the force is interpolated between rest and full slip
        """
        found: np.ndarray = self.weights @ backbone(self.half_distance)
        if self.loaded is None or start == 0:
            return found
        return (1 - abs(start)) * found + abs(start) * self.loaded[start > 0].force(backbone)

    def stretch(self, width: float, start: float = 0.0) -> np.ndarray:
        """Return the deflection of a spring in series with a slider that slips when the deflection is ±width.

        :param start: as for :meth:`force`. A slider whose start lies between the two paths in ``loaded`` rests until
            one of them moves it: exactly x = min(max(x0, x_low), x_high)
        """
        def clipped(half: np.ndarray) -> np.ndarray:
            return np.minimum(half, width)

        if self.loaded is None or self.path is None:
            return self.force(clipped)
        low, high = (memory.force(clipped) for memory in self.loaded)
        first = start * min(width, float(np.ptp(self.path)))
        return np.asarray(np.minimum(np.maximum(self.path - self.path[0] + first, low), high))


# Distance, as a multiple of the range of the path, after which every slider has slipped.
FAR_AWAY = 10.0
# Terms of the sum: half distance and weight.
Terms = tuple[tuple[float, float], ...]


def remembered(path: np.ndarray, fresh: bool) -> Memory:
    """Return the memory of friction along a path.

    :param path: displacements, one per row
    :param fresh: True: friction is zero in the first row and has no memory. False: the path was traversed before, and
        friction is equal at both of its ends
    """
    if fresh:
        order = np.arange(len(path))
        stack: list[tuple[float, Terms]] = [(float(path[0]), ())]
    else:
        order = np.concatenate((np.arange(int(np.argmax(path)), len(path)), np.arange(len(path))))
        stack = [(float(np.max(path)), ((float(np.ptp(path)) / 2, 1.0),))]
    now, direction = stack[0][0], 0.0
    rows: list[Terms] = []
    for place in order:
        new = float(path[place])
        if new != now:
            heading = 1.0 if new > now else -1.0
            if direction and heading != direction:
                stack.append((now, _terms(stack, now, fresh)))
            direction = heading
            # A branch that reaches the end of an older branch continues the older one.
            while len(stack) > 1 and _closes(stack, new, fresh):
                del stack[-2 if len(stack) > 2 else -1:]
            now = new
        rows.append(_terms(stack, now, fresh))
    return _memory(rows[-len(path):])


def from_any_start(path: np.ndarray) -> Memory:
    """Return the memory of friction along a path for an unknown friction force in the first row."""
    away = FAR_AWAY * float(np.ptp(path))
    rest = remembered(path, fresh=True)
    down, up = (_without_first(remembered(np.append(path[0] - sign * away, path), fresh=True)) for sign in (-1, 1))
    return Memory(rest.half_distance, rest.weights, (down, up), path)


def _without_first(memory: Memory) -> Memory:
    return Memory(memory.half_distance, csr_matrix(memory.weights[1:]))


def _closes(stack: list[tuple[float, Terms]], new: float, fresh: bool) -> bool:
    gone = abs(new - stack[-1][0])
    before = abs(stack[-1][0] - stack[-2][0])
    return gone >= (2 * before if fresh and len(stack) == 2 else before)


def _terms(stack: list[tuple[float, Terms]], now: float, fresh: bool) -> Terms:
    left, terms = stack[-1]
    change = now - left
    if change == 0:
        return terms
    sign = 1.0 if change > 0 else -1.0
    if fresh and len(stack) == 1:
        return ((abs(change), sign),)
    return (*terms, (abs(change) / 2, 2 * sign))


def _memory(rows: list[Terms]) -> Memory:
    half, weights = (np.array([term[part] for terms in rows for term in terms], dtype=float) for part in (0, 1))
    distinct, places = np.unique(half, return_inverse=True)
    starts = np.append(0, np.cumsum([len(terms) for terms in rows]))
    return Memory(distinct, csr_matrix((weights, places, starts), shape=(len(rows), len(distinct))))
