# SPDX-License-Identifier: GPL-3.0-or-later
"""A paraboloid through the nodes of a surface in the reference configuration, and the error of the surface after the
nodes have moved.

Results are of first order in the displacements, which are about a millionth of the size of the surface. If all nodes
and the axis lie in one plane, the surface is a profile: its paraboloid is a parabola, and rigid motion is planar.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.surface.zernike import fitted

# The error of a node is its displacement along the normal of the reference paraboloid, after the removal of
DEFINITIONS = {
    "design": "nothing is taken off: deviation from the design",
    "rigid": "the best rigid motion",
    "rigid_focal": "the best rigid motion and change of focal length: best-fit paraboloid",
}
# Exponent of the normal's component along the axis, by which the distance along the normal is multiplied before
# squaring and averaging.
MEASURES = {"normal": 0, "half_path": 1, "axial": -1}
# Nodes do not determine a parameter if its singular value, with columns scaled to length 1, is below this.
LEAST_SINGULAR_VALUE = 1e-6


@dataclass(frozen=True)
class Errors:
    """Errors of a surface whose nodes have moved.

    :param rms_m: RMS over the nodes by definition of the error [m]
    :param residual_m: residuals (nodes,) by definition of the error [m]
    :param tilt_rad: rotation of the axis of the best-fit paraboloid towards the lateral axes of the frame
    :param vertex_shift_m: displacement of the paraboloid's vertex along the lateral axes, then along the axis [m]; a
        lateral shift that the nodes do not distinguish from tilt is 0
    :param focal_change_m: change of its focal length [m]; None if the nodes do not determine it
    """

    rms_m: dict[str, float]
    residual_m: dict[str, np.ndarray]
    tilt_rad: np.ndarray
    vertex_shift_m: np.ndarray
    focal_change_m: float | None


@dataclass(frozen=True)
class _Fit:
    """Moves that the nodes determine: an orthonormal basis of their effect on the nodes, and the matrix from
    coefficients in this basis to moves."""

    moves: tuple[str, ...]
    basis: np.ndarray
    inverse: np.ndarray


@dataclass(frozen=True)
class Design:
    """Nodes in the reference configuration, and the best-fit paraboloid for them.

    :param position_m: positions (nodes, 3) [m]
    :param frame: rows (2 or 3, 3): one (profile) or two lateral axes, then the axis
    :param local_m: (nodes, 2 or 3) positions relative to the vertex, in the frame [m]
    :param vertex_m: vertex in space [m]
    :param curvature_per_m: 1/(4 F) [1/m] for the focal length F; 0: a plane
    :param design_rms_m: RMS distance of the reference nodes from the paraboloid, along the axis [m]
    """

    position_m: np.ndarray
    frame: np.ndarray
    local_m: np.ndarray
    vertex_m: np.ndarray
    curvature_per_m: float
    design_rms_m: float

    @classmethod
    def of(
        cls, position_m: Any, axis: Sequence[float] | np.ndarray = (0, 0, 1), focal_length_m: float | None = None
    ) -> Design:
        """Return the least-squares paraboloid with a given axis; it is a plane if the nodes determine no focal length.

        :param position_m: positions (nodes, 3) [m]
        :param axis: direction of the paraboloid's axis, a vector of any length
        :param focal_length_m: focal length [m]; None: it is fitted
        :raises StatejumpError: nodes or axis are invalid, or there are too few nodes
        """
        position, way = _points("position_m", position_m), np.asarray(axis, dtype=float)
        if way.shape != (3,) or not np.isfinite(way).all() or not np.linalg.norm(way) > 0:
            raise NotAllowed("axis", axis, code="no_direction")
        if focal_length_m is not None and not 0 < focal_length_m < np.inf:
            raise NotAllowed("focal_length_m", focal_length_m, code="not_positive", unit="m")
        frame = _frame(position, way / np.linalg.norm(way))
        middle = position.mean(axis=0)
        local = (position - middle) @ frame.T
        lateral, along = local[:, :-1], local[:, -1]
        squared = np.sum(lateral**2, axis=1)
        plane = np.column_stack((np.ones(len(local)), lateral))
        if not _determined(plane):
            raise StatejumpError(code="surface_undetermined", count=len(position))
        curvature = 0.0 if focal_length_m is None else 1 / (4 * focal_length_m)
        curved = np.column_stack((plane, squared))
        if focal_length_m is None and _determined(curved):
            curvature = float(np.linalg.lstsq(curved, along, rcond=None)[0][-1])
            if abs(curvature) * float(np.ptp(lateral)) <= LEAST_SINGULAR_VALUE:
                curvature = 0.0
        found = np.linalg.lstsq(plane, along - curvature * squared, rcond=None)[0]
        # A plane has no vertex; its origin is at the mean of the nodes across the axis.
        shift = -found[1:] / (2 * curvature) if curvature else 0 * found[1:]
        depth = found[0] - curvature * float(shift @ shift)
        vertex = np.append(shift, depth)
        local = local - vertex
        left = local[:, -1] - curvature * np.sum(local[:, :-1]**2, axis=1)
        return cls(position, frame, local, middle + vertex @ frame, curvature, float(np.sqrt(np.mean(left**2))))

    @property
    def focal_length_m(self) -> float | None:
        """Focal length [m]; None: a plane."""
        return 1 / (4 * self.curvature_per_m) if self.curvature_per_m else None

    @property
    def profile(self) -> bool:
        """Whether the nodes and the axis lie in one plane."""
        return len(self.frame) == 2

    @property
    def aperture_m(self) -> tuple[np.ndarray, float]:
        """Aperture: a circle that contains all nodes. Return its centre, the mean of the nodes, as lateral coordinates
        from the vertex [m], and its radius [m]."""
        lateral = self.local_m[:, :-1]
        middle = lateral.mean(axis=0)
        return middle, float(np.max(np.linalg.norm(lateral - middle, axis=1)))

    @property
    def normals(self) -> np.ndarray:
        """Unit normals (nodes, 2 or 3) of the paraboloid at the nodes, in the frame; the axial component is
        positive."""
        slopes = 2 * self.curvature_per_m * self.local_m[:, :-1]
        found = np.column_stack((-slopes, np.ones(len(slopes))))
        unit: np.ndarray = found / np.linalg.norm(found, axis=1)[:, None]
        return unit

    def _moves(self) -> dict[str, np.ndarray]:
        """Return the shift along the normals at the nodes by unit moves of the paraboloid: 1 m, 1 rad, 1/m
        curvature."""
        normals, size = self.normals, len(self.frame)
        moves = {"depth": normals[:, -1]}
        for place in range(size - 1):
            # A tilt towards a lateral axis moves points above the vertex in this direction, and points outwards in this
            # direction downwards.
            moves[f"tilt{place}"] = normals[:, place] * self.local_m[:, -1] - normals[:, -1] * self.local_m[:, place]
        moves["curvature"] = normals[:, -1] * np.sum(self.local_m[:, :-1]**2, axis=1)
        return moves | {f"shift{place}": normals[:, place] for place in range(size - 1)}

    @cached_property
    def _fits(self) -> dict[str, dict[str, _Fit]]:
        """Best fits by measure and definition of the error. They are the same for all displacements of the nodes."""
        moves = self._moves()
        return {measure: {definition: self._fit(self.normals[:, -1] ** power, {
            name: move for name, move in moves.items() if name != "curvature" or definition == "rigid_focal"
        }) for definition in ("rigid", "rigid_focal")} for measure, power in MEASURES.items()}

    def _fit(self, weight: np.ndarray, moves: dict[str, np.ndarray]) -> _Fit:
        names = list(moves)
        for kept in (names, [name for name in names if not name.startswith("shift")],
                     [name for name in names if not name.startswith("shift") and name != "curvature"]):
            matrix = np.stack([weight * moves[name] for name in kept], axis=1)
            if _determined(matrix):
                lengths = np.linalg.norm(matrix, axis=0)
                basis, factor = np.linalg.qr(matrix / lengths)
                return _Fit(tuple(kept), basis, np.linalg.inv(factor) / lengths[:, None])
        raise StatejumpError(code="fit_undetermined", count=len(self.position_m))

    def errors(self, displacement_m: Any, measure: str = "normal") -> Errors:
        """Return the errors of the surface for given displacements of its nodes.

        :param displacement_m: displacements (nodes, 3) [m]
        :param measure: quantity that is squared and averaged: ``normal``, the distance along the normal; ``half_path``,
            half the change of the ray path, for Ruze's formula; ``axial``, the distance along the axis
        :raises StatejumpError: the measure is unknown, or the displacements do not match the nodes
        """
        check_measure(measure)
        displacement = _points("displacement_m", displacement_m, len(self.position_m))
        residual, moves = self.best_fits(displacement, measure)
        values = {name: float(value) for name, value in moves["rigid_focal"].items()}
        focal = float(self.focal_change_m(values))
        lateral = range(len(self.frame) - 1)
        return Errors(
            {name: float(rms(left)) for name, left in residual.items()}, residual,
            np.array([values[f"tilt{place}"] for place in lateral]),
            np.array([*(values.get(f"shift{place}", 0.0) for place in lateral), values["depth"]]),
            None if np.isnan(focal) else focal,
        )

    def focal_change_m(self, moves: Mapping[str, Any]) -> np.ndarray:
        """Return the change of the focal length [m] by the moves of a best fit; NaN if nodes do not determine it."""
        if not self.curvature_per_m or "curvature" not in moves:
            return np.full_like(moves["depth"], np.nan)
        return np.asarray(-moves["curvature"] / (4 * self.curvature_per_m**2))  # F = 1/(4 c)

    def best_fits(
        self, displacement_m: np.ndarray, measure: str
    ) -> tuple[dict[str, np.ndarray], dict[str, dict[str, np.ndarray]]]:
        """Return residuals (..., nodes) [m] by definition, and the moves (...) of each best fit: depth, tilts,
        curvature and shifts, as far as the nodes determine them.

        :param displacement_m: displacements (..., nodes, 3) [m]
        """
        weighted = self.normals[:, -1] ** MEASURES[measure] * np.sum(
            self.normals * (displacement_m @ self.frame.T), axis=-1)
        residual, moves = {"design": weighted}, {}
        for definition, fit in self._fits[measure].items():
            share = weighted @ fit.basis
            residual[definition] = weighted - share @ fit.basis.T
            moves[definition] = dict(zip(fit.moves, np.moveaxis(share @ fit.inverse.T, -1, 0)))
        return residual, moves

    def zernike_m(self, displacement_m: Any, terms: int | None = None) -> np.ndarray:
        """Return the coefficients [m] of Noll's Zernike terms 1 to ``terms`` for the error along the axis, by least
        squares over the nodes, in the aperture. The root of the sum of their squares is the RMS over the full circle,
        not over the nodes.

        :param terms: 1 to 36; None: the largest of 1, 3, 6, ... 36 (whole orders) that the nodes determine
        :raises StatejumpError: the nodes form a profile, or determine fewer terms
        """
        if self.profile:
            raise StatejumpError(code="profile_without_zernike")
        displacement = _points("displacement_m", displacement_m, len(self.position_m))
        normals = self.normals
        sag = np.sum(normals * (displacement @ self.frame.T), axis=1) / normals[:, -1]
        middle, radius = self.aperture_m
        return fitted((self.local_m[:, :-1] - middle) / radius, sag, terms)


def check_measure(measure: str) -> None:
    """Raise NotAllowed for an unknown measure."""
    if measure not in MEASURES:
        raise NotAllowed("measure", measure, code="not_one_of", allowed=tuple(MEASURES), known=", ".join(MEASURES))


def rms(residual_m: np.ndarray) -> Any:
    """Return the root mean square over the last axis, the nodes."""
    return np.sqrt(np.mean(residual_m**2, axis=-1))


def _points(key: str, given: Any, rows: int | None = None) -> np.ndarray:
    points = np.asarray(given, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3 or (rows is not None and len(points) != rows):
        raise NotAllowed(key, code="array_of_other_shape", count="the" if rows is None else rows)
    if not np.isfinite(points).all():
        row = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise NotAllowed(key, code="array_not_finite", item=f"row {row + 1}")
    return points


def _frame(position: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Return lateral axes and axis as rows. Lateral axes follow the axes of space as far as possible. If nodes and axis
    lie in one plane, there is only one lateral axis."""
    across = position - position.mean(axis=0)
    across = across - np.outer(across @ axis, axis)
    spread, directions = np.linalg.svd(across, full_matrices=False)[1:]
    if not spread[0] > 0:
        raise StatejumpError(code="nodes_along_axis")
    if spread[1] <= LEAST_SINGULAR_VALUE * spread[0]:
        way = directions[0] * (1 if directions[0][np.argmax(np.abs(directions[0]))] > 0 else -1)
        return np.stack((way, axis))
    start = np.eye(3)[0 if abs(axis[0]) < 0.9 else 1]
    first = start - (start @ axis) * axis
    first /= np.linalg.norm(first)
    return np.stack((first, np.cross(axis, first), axis))


def _determined(matrix: np.ndarray) -> bool:
    lengths = np.linalg.norm(matrix, axis=0)
    if matrix.shape[0] < matrix.shape[1] or not (lengths > 0).all():
        return False
    return float(np.linalg.svd(matrix / lengths, compute_uv=False)[-1]) > LEAST_SINGULAR_VALUE
