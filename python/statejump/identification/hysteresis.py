# SPDX-License-Identifier: GPL-3.0-or-later
"""Friction with memory along a path of displacements: Masing's rule with return points.

Whatever the backbone B (force of a first loading), the force of friction is a sum of B at half distances between
turning points that are still remembered. Which ones those are depends on the path alone: they are found once, and every
set of parameters is then one matrix product. (G. Masing, Proc. 2nd Int. Congr. Applied Mechanics, 1926.)
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

Backbone = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Memory:
    """What friction remembers in every row of a path.

    :param half_distance: at which the backbone is needed [m or rad]
    :param weights: rows of the path × half distances
    """

    half_distance: np.ndarray
    weights: csr_matrix

    def force(self, backbone: Backbone) -> np.ndarray:
        """Return the force of friction in every row.

        :param backbone: force of a first loading from rest, of displacements from 0
        """
        found: np.ndarray = self.weights @ backbone(self.half_distance)
        return found


# Terms of the sum: half distance and weight of each.
Terms = tuple[tuple[float, float], ...]


def remembered(path: np.ndarray, fresh: bool) -> Memory:
    """Return what friction remembers along a path.

    :param path: displacements, one a row
    :param fresh: friction carries nothing in the first row and remembers nothing; otherwise the same path was gone
        before, and friction carries as much at one end of it as at the other
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
            # A branch that comes back to where an older one was left goes on as that one.
            while len(stack) > 1 and _closes(stack, new, fresh):
                del stack[-2 if len(stack) > 2 else -1:]
            now = new
        rows.append(_terms(stack, now, fresh))
    return _memory(rows[-len(path):])


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
