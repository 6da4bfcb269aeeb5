# SPDX-License-Identifier: GPL-3.0-or-later
"""A frame of three members between three nodes of six dofs: its exact stiffness, for tests of condensed bodies."""
from __future__ import annotations

import numpy as np

EXPANSION = 23e-6
NAMES = ("A", "B", "C")
POSITIONS_M = np.array([[0.2, 0.02, 0.005], [0.005, 0.02, 0.12], [0.01, 0.03, 0.0]])


def member(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Stiffness (12, 12) of a Bernoulli beam of aluminium, 20 x 10 mm, in global axes."""
    length = float(np.linalg.norm(second - first))
    along = (second - first) / length
    aside = np.cross([0.3, 0.5, 0.8], along)
    aside /= np.linalg.norm(aside)
    turn = np.array([along, aside, np.cross(along, aside)])
    young, area, bent_y, bent_z, twist = 70e9, 2e-4, 20 * 10**3 / 12e12, 10 * 20**3 / 12e12, 26.9e9 * 4.6e-9
    own = np.zeros((12, 12))
    own[np.ix_([0, 6], [0, 6])] = young * area / length * np.array([[1, -1], [-1, 1]])
    own[np.ix_([3, 9], [3, 9])] = twist / length * np.array([[1, -1], [-1, 1]])
    for dofs, inertia, sign in (((1, 5, 7, 11), bent_z, 1), ((2, 4, 8, 10), bent_y, -1)):
        a, b = 6 * sign / length**2, 12 / length**3
        own[np.ix_(dofs, dofs)] = young * inertia * np.array([
            [b, a, -b, a], [a, 4 / length, -a, 2 / length], [-b, -a, b, -a], [a, 2 / length, -a, 4 / length]])
    axes = np.kron(np.eye(4), turn)
    return np.asarray(axes.T @ own @ axes)


def stiffness(positions_m: np.ndarray = POSITIONS_M) -> np.ndarray:
    """Stiffness (18, 18) of the triangle of three members."""
    found = np.zeros((18, 18))
    for first, second in ((0, 1), (1, 2), (2, 0)):
        dofs = [*range(6 * first, 6 * first + 6), *range(6 * second, 6 * second + 6)]
        found[np.ix_(dofs, dofs)] += member(positions_m[first], positions_m[second])
    return found


def expanded(positions_m: np.ndarray = POSITIONS_M) -> np.ndarray:
    """Free shape (18) of a uniform temperature, per kelvin."""
    return np.hstack([EXPANSION * positions_m, np.zeros((3, 3))]).ravel()


def mass() -> np.ndarray:
    """A lumped mass (18, 18): 1 kg and a small inertia at each node."""
    return np.diag(np.tile([1.0] * 3 + [1e-4] * 3, 3))
