# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduction of a free mesh to mean or rigid motions of patches, by sparse linear algebra.

With rows W, the motion of a patch is q = W u. The body of least energy for given q solves [K W^T; W 0] [u; λ] = [0; q].
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import attrs
import numpy as np
from numpy.typing import NDArray

from statejump.core import libraries
from statejump.core.errors import FailedRun

Matrix = NDArray[np.float64]


UNBALANCED = 1e-9  # relative force of translations that is no rounding: the rows are not all translations


def balanced(stiffness: Any, rows: Sequence[NDArray[np.int64]]) -> Any:
    """Return a stiffness whose translations cause no force: the block of each node is minus the sum of the others.

    Thin solids have entries that are 1e9 times those of the reduced stiffness. The 14 digits of CalculiX then leave
    forces of translations that exceed those of bending.

    :param rows: of each node, rows (3, levels)
    """
    sparse = libraries.sparse()

    points = np.concatenate([levels.T for levels in rows])  # (points, 3)
    size = stiffness.shape[0]
    if points.size != size:
        return stiffness
    motions = sparse.csr_matrix((np.ones(size), (points.ravel(), np.tile([0, 1, 2], len(points)))), (size, 3))
    left = (stiffness @ motions).toarray()
    if np.abs(left).max() > UNBALANCED * np.abs(stiffness.diagonal()).max():
        return stiffness
    first, second = np.repeat(points, 3, axis=1).ravel(), np.tile(points, (1, 3)).ravel()
    values = left[first, np.tile([0, 1, 2], 3 * len(points))]
    return (stiffness - sparse.csc_matrix((values, (first, second)), (size, size))).tocsc()


LOOSE = 1e-8  # squared frequency of a mode without stiffness, over that of the highest mode


@attrs.frozen
class Reduced:
    """Reduced matrices.

    :param shapes: displacements (rows of the mesh, q and modes) per unit of each reduced dof
    :param stiffness: reduced stiffness
    :param mass: reduced mass; None: the mesh has none
    """

    shapes: Matrix
    stiffness: Matrix
    mass: Matrix | None


class Saddle:
    """Factors of [K W^T; W 0]."""

    def __init__(self, stiffness: Any, rows: Any) -> None:
        sparse = libraries.sparse()
        self.size, self.count = stiffness.shape[0], rows.shape[0]
        self.scale = float(np.abs(stiffness.diagonal()).mean())
        scaled = rows * self.scale
        self.matrix = sparse.bmat([[stiffness, scaled.T], [scaled, None]], format="csc")
        try:
            self.factors = libraries.scipy("sparse.linalg").splu(self.matrix)
        except RuntimeError:
            raise FailedRun(code="condense_singular") from None

    def solve(self, forces: Matrix | None, motions: Matrix | None) -> Matrix:
        """Return the displacements under forces with given motions; None: zero."""
        given = forces if forces is not None else motions
        assert given is not None
        right = np.zeros((self.size + self.count, given.shape[1]))
        if forces is not None:
            right[:self.size] = forces
        if motions is not None:
            right[self.size:] = self.scale * motions
        found = self.factors.solve(right)
        found += self.factors.solve(right - self.matrix @ found)
        return np.asarray(found[:self.size])


def reduce(stiffness: Any, mass: Any, rows: Any, modes: int) -> Reduced:
    """Return the body reduced to the motions of its patches and a number of fixed-interface modes."""
    saddle = Saddle(stiffness, rows)
    shapes = saddle.solve(None, np.eye(rows.shape[0]))
    inner = stiffness @ shapes
    reduced = shapes.T @ inner
    if not modes:
        return Reduced(shapes, (reduced + reduced.T) / 2, None if mass is None else shapes.T @ (mass @ shapes))
    values, vectors = _modes(stiffness, mass, saddle, modes)
    count = rows.shape[0]
    whole = np.zeros((count + modes, count + modes))
    whole[:count, :count] = (reduced + reduced.T) / 2
    whole[range(count, count + modes), range(count, count + modes)] = values
    both = np.hstack([shapes, vectors])
    masses = both.T @ (mass @ both)
    return Reduced(both, whole, (masses + masses.T) / 2)


def _modes(stiffness: Any, mass: Any, saddle: Saddle, count: int) -> tuple[Matrix, Matrix]:
    """Return the squared angular frequencies and the shapes of the lowest modes with held patches, of unit mass."""
    solvers = libraries.scipy("sparse.linalg")
    size = saddle.size
    if count >= size - saddle.count - 1:
        raise FailedRun(code="condense_modes", count=count, most=size - saddle.count - 2)
    inverse = solvers.LinearOperator((size, size), dtype=float,
                                     matvec=lambda x: saddle.solve(x.reshape(-1, 1), None).ravel())
    start = saddle.solve(np.random.default_rng(1).normal(size=(size, 1)), None).ravel()
    values, vectors = solvers.eigsh(stiffness, count, mass, sigma=0.0, OPinv=inverse, v0=start, tol=1e-12)
    if values.min() <= LOOSE * values.max():
        raise FailedRun(code="condense_loose")
    order = np.argsort(values)
    return np.asarray(values[order]), np.asarray(vectors[:, order])


def mean_rows(positions: Matrix, about: Matrix) -> Matrix:
    """Return the rows (6, 3k) that give the mean motion of points, at a position: the rigid motion of least squares."""
    centre = positions.mean(axis=0)
    motions = np.vstack([rigid_arm(place - centre) for place in positions])
    found = np.linalg.solve(motions.T @ motions, motions.T)
    moved = np.eye(6)
    moved[:3, 3:] = rigid_arm(about - centre)[:, 3:]
    return np.asarray(moved @ found)


def rigid_columns(positions: Matrix, about: Matrix) -> Matrix:
    """Return the displacements (3k, 6) of points that move rigidly, per unit motion at a position."""
    return np.vstack([rigid_arm(place - about) for place in positions])


def rigid_arm(arm: Matrix) -> Matrix:
    """Return the displacement (3, 6) of a point at an arm, per unit of a rigid motion."""
    x, y, z = arm
    return np.array([[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]], dtype=float)
