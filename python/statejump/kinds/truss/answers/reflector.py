# SPDX-License-Identifier: GPL-3.0-or-later
"""Error of a reflecting surface against its best-fit paraboloid, in the plane against a parabola.

In a frame whose last axis is that of the case and whose origin is the mean of the drawn nodes, the
paraboloid has its vertex at (shift, depth), focal length F and an axis that is tilted. Residuals are
distances along the normal, to first order in the error. Least squares by scipy.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from statejump.kinds.truss.resolved import ResolvedTruss

# Singular value of the fit, its columns of length 1, below which a parameter is not determined.
LEAST_SINGULAR_VALUE = 1e-6


@dataclass(frozen=True)
class Fit:
    """Best fit of one state."""

    residual_m: np.ndarray  # (nodes,) along the normal
    rms_error_m: float
    tilt_rad: np.ndarray  # (1 or 2,) of the axis towards the frame's lateral axes
    focal_length_m: float | None  # None: flat, or not determined
    depth_m: float  # of the vertex, along the axis


@dataclass(frozen=True)
class Surface:
    """A surface and which parameters its nodes determine; ``notes`` say which they do not."""

    nodes: np.ndarray
    frame: np.ndarray  # (2 or 3, 3) lateral axes, then the axis
    origin_m: np.ndarray
    drawn_m: np.ndarray  # (nodes, 2 or 3) in the frame
    free: tuple[str, ...]
    held: dict[str, float]
    notes: tuple[str, ...]

    def fit(self, displacement_m: np.ndarray) -> Fit:
        """Return the best fit when the nodes of the truss (n, 3) have moved by that much."""
        points = self.drawn_m + displacement_m[self.nodes] @ self.frame.T
        found = _fit(points, self.free, self.held)
        values = {**self.held, **dict(zip(self.free, found.x))}
        residual = _residual(points, values)
        curvature = values["curvature"]
        return Fit(
            residual, float(np.sqrt(np.mean(residual**2))),
            np.array([values[name] for name in _names("tilt", self.drawn_m.shape[1] - 1)]),
            None if curvature == 0 else float(1 / (4 * curvature)), float(values["depth"]),
        )


def _names(kind: str, lateral: int) -> list[str]:
    return [f"{kind}{axis}" for axis in range(lateral)]


def _residual(points: np.ndarray, values: dict[str, float]) -> np.ndarray:
    """Distances [m] (n,) along the normal: points are turned by -tilt, then compared."""
    lateral = points.shape[1] - 1
    across, along = points[:, :lateral], points[:, lateral]
    tilt = np.array([values[name] for name in _names("tilt", lateral)])
    size = float(np.linalg.norm(tilt))
    if size > 0:
        way = tilt / size
        forward = across @ way
        turned = forward * np.cos(size) - along * np.sin(size)
        along = forward * np.sin(size) + along * np.cos(size)
        across = across + np.outer(turned - forward, way)
    away = across - np.array([values[name] for name in _names("shift", lateral)])
    squared = np.sum(away**2, axis=1)
    curvature = values["curvature"]
    return (along - values["depth"] - curvature * squared) / np.sqrt(1 + 4 * curvature**2 * squared)


def _fit(points: np.ndarray, free: tuple[str, ...], held: dict[str, float]):  # type: ignore[no-untyped-def]
    # Lengths over that of the surface: parameters are of order one.
    size = float(np.ptp(points, axis=0).max())
    scale = np.array([{"d": size, "s": size, "c": 1 / size, "t": 1.0}[name[0]] for name in free])

    def residual(x: np.ndarray) -> np.ndarray:
        return _residual(points, {**held, **dict(zip(free, x * scale))}) / size

    found = least_squares(residual, np.zeros(len(free)), method="lm", jac="2-point", xtol=1e-15, ftol=1e-15, gtol=1e-15)
    # From there with better derivatives: displacements are a millionth of the surface.
    for _ in range(3):
        found = least_squares(residual, found.x, method="lm", jac=lambda x: _central(residual, x), xtol=1e-15,
                              ftol=1e-15, gtol=1e-15)
    found.jac = _central(residual, found.x)
    found.x = found.x * scale
    return found


def _central(function, x: np.ndarray, step: float = 1e-5) -> np.ndarray:  # type: ignore[no-untyped-def]
    return np.stack([(function(x + step * way) - function(x - step * way)) / (2 * step) for way in np.eye(len(x))],
                    axis=1)


def surface(truss: ResolvedTruss) -> Surface | None:
    """Return the reflecting surface of a truss, None if it has none or too few nodes for a plane.

    Parameters that the drawn nodes do not determine are held, in this order: the vertex' lateral shift
    (against tilt), the curvature.
    """
    if truss.reflector is None:
        return None
    reflector, dimension = truss.reflector, truss.dimension
    lateral = dimension - 1
    start = np.eye(3)[np.argsort(np.abs(reflector.axis[:dimension]), kind="stable")[:lateral]]
    basis = np.linalg.qr(np.vstack((reflector.axis, start)).T)[0].T
    frame = np.vstack((basis[1:dimension], reflector.axis))
    positions = truss.nodes.position_m[reflector.nodes]
    origin = positions.mean(axis=0)
    drawn = (positions - origin) @ frame.T
    tilts, shifts = _names("tilt", lateral), _names("shift", lateral)
    given = reflector.focal_length_m
    zero = {name: 0.0 for name in ("depth", "curvature", *tilts, *shifts)}
    known = {**zero, **({} if given is None else {"curvature": 1 / (4 * given)})}
    curvature = () if given is not None else ("curvature",)
    notes: list[str] = []
    flat = f"the nodes do not determine the focal length: the fit is a {'line' if lateral == 1 else 'plane'}"
    for free, note in (
        (("depth", *tilts, *curvature, *shifts), ""),
        (("depth", *tilts, *curvature),
         "the nodes do not determine the lateral shift of the vertex beside the tilt: it is held"),
        (("depth", *tilts), flat if curvature else ""),  # a focal length that is given is none to be determined
    ):
        if note:
            notes.append(note)
        held = {name: value for name, value in known.items() if name not in free}
        if len(drawn) <= len(free):
            continue
        jacobian = _fit(drawn, free, held).jac
        lengths = np.linalg.norm(jacobian, axis=0)
        if (lengths > 0).all() and np.linalg.svd(jacobian / lengths, compute_uv=False)[-1] > LEAST_SINGULAR_VALUE:
            return Surface(reflector.nodes, frame, origin, drawn, free, held, tuple(notes))
    return None
