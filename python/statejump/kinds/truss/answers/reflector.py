# SPDX-License-Identifier: GPL-3.0-or-later
"""Error of a reflecting surface relative to its best-fit paraboloid (a parabola for planar trusses).

The origin of the frame is the mean of the nodes in the reference configuration; its last axis is given by the case. The
paraboloid has its vertex at (shift, depth), focal length F and a tilted axis. Residuals are distances along the normal,
to first order in the error. SciPy solves the least-squares problem.
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import least_squares

from statejump.kinds.truss.body_points import positions_m
from statejump.kinds.truss.resolved import ResolvedTruss

# Parameters of a fit with columns scaled to length 1 are undetermined if their singular value is below this.
LEAST_SINGULAR_VALUE = 1e-6
# Square of an angle [rad²] below which two terms of the series are exact, because the third is below 1e-16.
SMALL_SQUARE = 1e-7


@dataclass(frozen=True)
class Fit:
    """Best fit of one state."""

    residual_m: np.ndarray  # (nodes,) along the normal
    rms_error_m: float
    tilt_rad: np.ndarray  # (1 or 2,) rotation of the axis towards the lateral axes of the frame
    focal_length_m: float | None  # None: flat, or not determined
    depth_m: float  # of the vertex, along the axis


@dataclass(frozen=True)
class Surface:
    """A reflecting surface, and the parameters that its nodes determine; ``notes`` name the other parameters."""

    nodes: np.ndarray
    frame: np.ndarray  # (2 or 3, 3) rows: lateral axes, then the axis of the paraboloid
    origin_m: np.ndarray
    drawn_m: np.ndarray  # (nodes, 2 or 3) in the frame
    free: tuple[str, ...]
    held: dict[str, float]
    notes: tuple[str, ...]

    def fit(self, displacement_m: np.ndarray) -> Fit:
        """Return the best-fit paraboloid for displacements (n, 3) of all nodes, and points of bodies."""
        points = self.drawn_m + displacement_m[self.nodes] @ self.frame.T
        found = _fit(points, self.free, self.held)
        values = {**self.held, **dict(zip(self.free, found.x))}
        residual, _ = _residual(points, values)
        curvature = values["curvature"]
        return Fit(
            residual, float(np.sqrt(np.mean(residual**2))),
            np.array([values[name] for name in _names("tilt", self.drawn_m.shape[1] - 1)]),
            None if curvature == 0 else float(1 / (4 * curvature)), float(values["depth"]),
        )


def _names(kind: str, lateral: int) -> list[str]:
    return [f"{kind}{axis}" for axis in range(lateral)]


def _residual(
    points: np.ndarray, values: dict[str, float], with_slopes: bool = False
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return distances [m] (n,) of points, rotated by -tilt, along the normal and, on request, their derivatives by
    every parameter."""
    lateral = points.shape[1] - 1
    across, along = points[:, :lateral], points[:, lateral]
    tilt = np.array([values[name] for name in _names("tilt", lateral)])
    # Functions of the squared angle: its cosine, sin(angle)/angle, (cos(angle) - 1)/angle², derivatives of the last
    # two.
    square = float(tilt @ tilt)
    angle = np.sqrt(square)
    if square > SMALL_SQUARE:
        sine, fall = np.sin(angle) / angle, (np.cos(angle) - 1) / square
        sine_slope, fall_slope = (np.cos(angle) - sine) / (2 * square), (-sine / 2 - fall) / square
    else:
        sine, fall, sine_slope, fall_slope = 1 - square / 6, square / 24 - 0.5, square / 60 - 1 / 6, 1 / 24
    cosine = 1 + square * fall
    forward = across @ tilt
    pushed = forward * fall - along * sine
    turned_along = forward * sine + along * cosine
    away = across + np.outer(pushed, tilt) - np.array([values[name] for name in _names("shift", lateral)])
    squared = np.sum(away**2, axis=1)
    curvature = values["curvature"]
    below = 1 + 4 * curvature**2 * squared
    root = np.sqrt(below)
    found = (turned_along - values["depth"] - curvature * squared) / root
    if not with_slopes:
        return found, {}

    def slope(height: np.ndarray | float, by_squared: np.ndarray | float, by_curvature: float = 0.0) -> np.ndarray:
        """Return the derivative of the residual by a parameter, from those of height, squared distance, curvature."""
        lower = 4 * curvature * (2 * squared * by_curvature + curvature * by_squared)
        return np.asarray((height - by_curvature * squared - curvature * by_squared) / root
                          - found * lower / (2 * below))

    slopes = {"depth": slope(-1.0, 0.0), "curvature": slope(0.0, 0.0, 1.0)}
    for axis in range(lateral):
        height = across[:, axis] * sine + tilt[axis] * (2 * forward * sine_slope - along * sine)
        push = across[:, axis] * fall + 2 * tilt[axis] * (forward * fall_slope - along * sine_slope)
        slopes[f"tilt{axis}"] = slope(height, 2 * (push * (away @ tilt) + pushed * away[:, axis]))
        slopes[f"shift{axis}"] = slope(0.0, -2 * away[:, axis])
    return found, slopes


def _fit(points: np.ndarray, free: tuple[str, ...], held: dict[str, float]):  # type: ignore[no-untyped-def]
    # Lengths are divided by the size of the surface, so that all parameters are of order one.
    size = float(np.ptp(points, axis=0).max())
    scale = np.array([{"d": size, "s": size, "c": 1 / size, "t": 1.0}[name[0]] for name in free])

    def values(x: np.ndarray) -> dict[str, float]:
        return {**held, **dict(zip(free, x * scale))}

    def residual(x: np.ndarray) -> np.ndarray:
        return _residual(points, values(x))[0] / size

    def jacobian(x: np.ndarray) -> np.ndarray:
        slopes = _residual(points, values(x), with_slopes=True)[1]
        return np.stack([slopes[name] for name in free], axis=1) * scale / size

    found = least_squares(residual, np.zeros(len(free)), method="lm", jac=jacobian, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    # Least squares stops when the sum of squares is flat to rounding. A further Newton step makes its gradient zero.
    found.x = found.x - np.linalg.lstsq(jacobian(found.x), residual(found.x), rcond=None)[0]
    found.jac = jacobian(found.x)
    found.x = found.x * scale
    return found


def surface(truss: ResolvedTruss) -> Surface | None:
    """Return the reflecting surface of a truss; None if the truss has none, or if its nodes are too few for a plane.

    Parameters that the nodes do not determine are held constant: first the lateral shift of the vertex (not the tilt),
    then the curvature.
    """
    if truss.reflector is None:
        return None
    reflector, dimension = truss.reflector, truss.dimension
    lateral = dimension - 1
    start = np.eye(3)[np.argsort(np.abs(reflector.axis[:dimension]), kind="stable")[:lateral]]
    basis = np.linalg.qr(np.vstack((reflector.axis, start)).T)[0].T
    frame = np.vstack((basis[1:dimension], reflector.axis))
    positions = positions_m(truss)[reflector.nodes]
    origin = positions.mean(axis=0)
    drawn = (positions - origin) @ frame.T
    parameters = _parameters(drawn.tobytes(), dimension, reflector.focal_length_m)
    return None if parameters is None else Surface(reflector.nodes, frame, origin, drawn, *parameters)


@lru_cache(maxsize=8)
def _parameters(
    drawn: bytes, dimension: int, focal_length_m: float | None
) -> tuple[tuple[str, ...], dict[str, float], tuple[str, ...]] | None:
    """Return the parameters that nodes determine, the held ones, and the reasons; None if no plane is determined.

    Fits are cached, because samples of a campaign mostly share their reference configuration.

    :param drawn: positions of the nodes [m], (nodes, dimension) numbers as bytes
    """
    points = np.frombuffer(drawn).reshape(-1, dimension)
    lateral = dimension - 1
    tilts, shifts = _names("tilt", lateral), _names("shift", lateral)
    zero = {name: 0.0 for name in ("depth", "curvature", *tilts, *shifts)}
    known = {**zero, **({} if focal_length_m is None else {"curvature": 1 / (4 * focal_length_m)})}
    curvature = () if focal_length_m is not None else ("curvature",)
    notes: list[str] = []
    flat = f"the nodes do not determine the focal length: the fit is a {'line' if lateral == 1 else 'plane'}"
    for free, note in (
        (("depth", *tilts, *curvature, *shifts), ""),
        (("depth", *tilts, *curvature),
         "the nodes do not determine the lateral shift of the vertex beside the tilt: it is held"),
        (("depth", *tilts), flat if curvature else ""),  # a given focal length is not fitted
    ):
        if note:
            notes.append(note)
        held = {name: value for name, value in known.items() if name not in free}
        if len(points) <= len(free):
            continue
        jacobian = _fit(points, free, held).jac
        lengths = np.linalg.norm(jacobian, axis=0)
        if (lengths > 0).all() and np.linalg.svd(jacobian / lengths, compute_uv=False)[-1] > LEAST_SINGULAR_VALUE:
            return free, held, tuple(notes)
    return None
