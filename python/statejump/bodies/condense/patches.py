# SPDX-License-Identifier: GPL-3.0-or-later
"""Mean motion of a patch: the rigid motion that fits the displacements of its surface best, integrated over its faces.

A patch without a complete face has the mean motion of its nodes, each with equal weight.
"""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from statejump.bodies.condense.reduce import mean_rows, rigid_arm

Matrix = NDArray[np.float64]

_G = float(np.sqrt(0.6))
# Points and weights: 3 x 3 in the square of side 2; degree 4 in the triangle (Strang and Fix, 6 points).
SQUARE = [(x, y, u * v / 81) for x, u in ((-_G, 5), (0.0, 8), (_G, 5)) for y, v in ((-_G, 5), (0.0, 8), (_G, 5))]
_A, _B = 0.44594849091596489, 0.09157621350977073
TRIANGLE = [(*place, weight / 2) for edge, weight in ((_A, 0.22338158967801147), (_B, 0.10995174365532187))
            for place in ((edge, edge), (1 - 2 * edge, edge), (edge, 1 - 2 * edge))]


def shapes(count: int, x: float, y: float) -> tuple[Matrix, Matrix]:
    """Return the shape functions (n) of a face of 3, 4, 6 or 8 nodes, and their derivatives (2, n)."""
    if count in (3, 6):
        return _triangle(count, x, y)
    a, b = np.array([-1.0, 1, 1, -1]), np.array([-1.0, -1, 1, 1])
    if count == 4:
        return (1 + a * x) * (1 + b * y) / 4, np.array([a * (1 + b * y) / 4, b * (1 + a * x) / 4])
    corner = (1 + a * x) * (1 + b * y) * (a * x + b * y - 1) / 4
    by_x = a * (1 + b * y) * (2 * a * x + b * y) / 4
    by_y = b * (1 + a * x) * (a * x + 2 * b * y) / 4
    middle = [(1 - x * x) * (1 - y) / 2, (1 + x) * (1 - y * y) / 2,
              (1 - x * x) * (1 + y) / 2, (1 - x) * (1 - y * y) / 2]
    middle_x = [-x * (1 - y), (1 - y * y) / 2, -x * (1 + y), -(1 - y * y) / 2]
    middle_y = [-(1 - x * x) / 2, -y * (1 + x), (1 - x * x) / 2, -y * (1 - x)]
    return np.concatenate([corner, middle]), np.array([[*by_x, *middle_x], [*by_y, *middle_y]])


def _triangle(count: int, x: float, y: float) -> tuple[Matrix, Matrix]:
    z = 1 - x - y
    if count == 3:
        return np.array([z, x, y]), np.array([[-1.0, 1, 0], [-1, 0, 1]])
    values = np.array([z * (2 * z - 1), x * (2 * x - 1), y * (2 * y - 1), 4 * z * x, 4 * x * y, 4 * y * z])
    return values, np.array([[1 - 4 * z, 4 * x - 1, 0, 4 * (z - x), 4 * y, -4 * y],
                             [1 - 4 * z, 0, 4 * y - 1, -4 * x, 4 * x, 4 * (z - y)]])


def patch(nodes: Sequence[int], positions: dict[int, Matrix], faces: Sequence[tuple[int, ...]],
          about: Matrix | None) -> tuple[Matrix, Matrix]:
    """Return the position of the interface node of a patch, and the rows (6, 3k) of its mean motion.

    :param faces: all nodes of each face on the surface of the body
    :param about: the position; None: the centre of the patch
    """
    places = {node: place for place, node in enumerate(nodes)}
    own = [face for face in faces if all(node in places for node in face)]
    if not own:
        given = np.array([positions[node] for node in nodes])
        centre = given.mean(axis=0) if about is None else about
        return centre, mean_rows(given, centre)
    points = []  # position, weight, nodes, shape functions
    for face in own:
        corners = np.array([positions[node] for node in face])
        at = [places[node] for node in face]
        for x, y, weight in TRIANGLE if len(face) in (3, 6) else SQUARE:
            values, slopes = shapes(len(face), x, y)
            area = float(np.linalg.norm(np.cross(*(slopes @ corners))))
            points.append((values @ corners, weight * area, at, values))
    whole = sum(weight for _, weight, _, _ in points)
    middle = np.asarray(sum(weight * place for place, weight, _, _ in points) / whole)
    inertia, sums = np.zeros((6, 6)), np.zeros((6, 3 * len(nodes)))
    for place, weight, at, values in points:
        motion = rigid_arm(place - middle)
        inertia += weight * motion.T @ motion
        for node, value in zip(at, values):
            sums[:, 3 * node:3 * node + 3] += weight * value * motion.T
    rows = np.linalg.solve(inertia, sums)
    centre = middle if about is None else about
    moved = np.eye(6)
    moved[:3, 3:] = rigid_arm(centre - middle)[:, 3:]
    return centre, moved @ rows
