# SPDX-License-Identifier: GPL-3.0-or-later
"""A condensed body at its place in a structure: its matrices in the axes of the structure."""
from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from statejump.bodies.body import CondensedBody, Points
from statejump.bodies.checks import scaled_rigid_motions, scales, without_rigid_forces
from statejump.core.errors import NotAllowed

Matrix = NDArray[np.float64]
# Sine of the smallest angle between axes x and y that determine the third: below, their digits do not suffice.
LEAST_SINE = 1e-6


@frozen(eq=False, slots=False)
class Placed:
    """A condensed body in the axes of a structure, without its modes: fixed-interface modes have no static answer.

    :param positions_m: of its interface nodes (n, 3) in the structure [m]
    :param freedoms: dofs (n) of each node: 3 or 6
    :param offset_m: position of the structure's node minus that of the interface node (n, 3) [m]
    :param origin_m: position (3,) of the body's origin [m]
    :param axes: rotation (3, 3) from the axes of the body to those of the structure
    :param stiffness: (N, N); rigid motions about the structure's nodes cause no force
    :param free_shapes: dofs (p, N) per kelvin of each pattern
    :param mass: (N, N); None: unknown
    """

    positions_m: Matrix
    freedoms: NDArray[np.int64]
    offset_m: Matrix
    origin_m: Matrix
    axes: Matrix
    stiffness: Matrix
    free_shapes: Matrix
    mass: Matrix | None

    @property
    def starts(self) -> NDArray[np.int64]:
        """First dof of each node."""
        return np.concatenate([[0], np.cumsum(self.freedoms)[:-1]]).astype(np.int64)

    @cached_property
    def largest_stiffness_N_per_m(self) -> float:
        """Largest stiffness of a displacement [N/m]."""
        at = (self.starts[:, None] + np.arange(3)).ravel()
        return float(np.diag(self.stiffness)[at].max())

    @property
    def mass_kg(self) -> float:
        """Mass [kg]. The file must contain one."""
        assert self.mass is not None
        along = self._translation(np.array([1.0, 0.0, 0.0]))
        return float(along @ self.mass @ along)

    def weight(self, gravity_m_per_s2: Matrix) -> Matrix:
        """Return forces [N], then moments [N m], of gravity on the nodes (n, 6). The file must contain a mass."""
        assert self.mass is not None
        loads = self.mass @ self._translation(gravity_m_per_s2)
        found = np.zeros((len(self.freedoms), 6))
        for index, (start, dofs) in enumerate(zip(self.starts, self.freedoms)):
            found[index, :dofs] = loads[start:start + dofs]
        return found

    def positions_of(self, points_m: Matrix) -> Matrix:
        """Return positions (k, 3) in the structure of points (k, 3) in the frame of the body [m]."""
        return np.asarray(self.origin_m + points_m @ self.axes.T)

    def moved_points(self, points: Points, displacement_m: Matrix, rotation_rad: Matrix, heat_K: Matrix) -> Matrix:
        """Return the displacements (states, k, 3) of points in the structure [m].

        :param displacement_m: of the interface nodes (states, n, 3) [m]
        :param rotation_rad: rotation vectors of the interface nodes (states, n, 3)
        :param heat_K: temperature (states, p) of every pattern of the file
        """
        nodes_m = self.positions_m + self.offset_m
        drawn = nodes_m - nodes_m.mean(axis=0)
        moved = displacement_m - displacement_m.mean(axis=1, keepdims=True)
        six = self.freedoms == 6
        turns = Rotation.from_rotvec(rotation_rad[:, six].reshape(-1, 3)).as_matrix().reshape(len(moved), -1, 3, 3)
        squared = float((drawn**2).sum(axis=1).mean())
        squared = squared if squared > (1e-12 * np.abs(nodes_m).max()) ** 2 else 1.0
        sums = np.einsum("sni,nj->sij", drawn + moved, drawn) + squared * turns.sum(axis=1)
        left, _, right = np.linalg.svd(sums)
        left[:, :, 2] *= np.linalg.det(left @ right)[:, None]
        frame = left @ right
        # Rotation minus identity times a vector, without a difference of two positions.
        change = frame - np.eye(3)
        q = np.zeros((len(moved), int(self.freedoms.sum())))
        shapes = np.einsum("sji,snj->sni", frame, moved) + np.einsum("sji,nj->sni", change, drawn)
        relative = np.einsum("sji,snjk->snik", frame, turns).reshape(-1, 3, 3)
        angles = Rotation.from_matrix(relative).as_rotvec().reshape(len(moved), -1, 3)
        for place, start in enumerate(self.starts):
            q[:, start:start + 3] = shapes[:, place]
        for place, start in enumerate(self.starts[six]):
            q[:, start + 3:start + 6] = angles[:, place]
        # Rows are in the axes of the body.
        own = q.reshape(len(moved), -1, 3) @ self.axes
        count = len(points.names)
        flexible = own.reshape(len(moved), -1) @ points.rows[:, :q.shape[1]].T + heat_K @ points.patterns
        inside = flexible.reshape(len(moved), count, 3) @ self.axes.T
        arms = self.positions_of(points.positions_m) - nodes_m.mean(axis=0)
        centre = displacement_m.mean(axis=1, keepdims=True)
        return np.asarray(centre + np.einsum("sij,skj->ski", frame, inside) + np.einsum("sij,kj->ski", change, arms))

    def _translation(self, direction: Matrix) -> Matrix:
        motion = np.zeros(int(self.freedoms.sum()))
        for start in self.starts:
            motion[start:start + 3] = direction
        return motion


def axes_of(axis_x: Sequence[float] | None, axis_y: Sequence[float] | None, **where: Any) -> Matrix:
    """Return the rotation (3, 3) from the axes of a body to those of the structure.

    :param axis_x: direction of the body's axis x in the structure
    :param axis_y: direction of its axis y, of which the part across x counts
    :raises NotAllowed: an axis is zero, or both are parallel
    """
    first = np.array([1.0, 0.0, 0.0] if axis_x is None else axis_x, dtype=float)
    second = np.array([0.0, 1.0, 0.0] if axis_y is None else axis_y, dtype=float)
    for key, axis in (("axis_x", first), ("axis_y", second)):
        if not axis.any():
            raise NotAllowed(key, axis.tolist(), code="zero_vector", **where)
    first, second = first / np.linalg.norm(first), second / np.linalg.norm(second)
    third = np.cross(first, second)
    if np.linalg.norm(third) < LEAST_SINE:
        raise NotAllowed("axis_y" if axis_y is not None else "axis_x", (axis_y or axis_x), code="body_axes_parallel",
                         **where)
    third /= np.linalg.norm(third)
    return np.column_stack((first, np.cross(third, first), third))


def placed(body: CondensedBody, nodes_m: Matrix, origin_m: Matrix, axes: Matrix) -> Placed:
    """Return a body at its place.

    :param nodes_m: positions (n, 3) of the structure's nodes [m]
    :param origin_m: position (3,) of the body's origin [m]
    :param axes: see :func:`axes_of`
    """
    freedoms, count = body.node_freedoms, body.interface_dofs
    turn = np.zeros((count, count))
    for start in range(0, count, 3):
        turn[start:start + 3, start:start + 3] = axes
    own = _condensed(body.stiffness, count)
    turned = turn @ own @ turn.T
    scale = scales(nodes_m, freedoms, turned)
    basis = scaled_rigid_motions(nodes_m, freedoms, scale)
    scaled = turned * np.outer(scale, scale)
    for _ in range(2):  # the second time against the rounding of the first
        scaled = without_rigid_forces(scaled, basis)
    positions = origin_m + body.node_positions_m @ axes.T
    return Placed(
        positions_m=positions, freedoms=freedoms, offset_m=nodes_m - positions, origin_m=origin_m, axes=axes,
        stiffness=scaled / np.outer(scale, scale), free_shapes=body.free_shapes[:, :count] @ turn.T,
        mass=None if body.mass is None else turn @ body.mass[:count, :count] @ turn.T)


def _condensed(matrix: Matrix, count: int) -> Matrix:
    """Return the stiffness of the interface with modes that follow it. Fixed-interface modes have no coupling."""
    coupling = matrix[:count, count:]
    if not coupling.any():
        return matrix[:count, :count]
    return np.asarray(matrix[:count, :count] - coupling @ np.linalg.solve(matrix[count:, count:], coupling.T))
