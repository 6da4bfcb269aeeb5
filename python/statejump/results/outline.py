# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines of the parts of a scene, in their own frames, for viewers that can only draw lines."""
from __future__ import annotations

from typing import Any

import numpy as np

from statejump.results.contents import Result
from statejump.results.scene import resolve

SIDES = 96  # number of sides of a circle; the sagitta is 5e-4 of the radius


def _circle(radius: float) -> np.ndarray:
    angle = 2 * np.pi * np.arange(SIDES + 1) / SIDES
    return radius * np.stack([np.cos(angle), np.sin(angle), np.zeros(SIDES + 1)], axis=1)


def _polyline(points: list[tuple[float, float]]) -> np.ndarray:
    return np.array([(x, y, 0.0) for x, y in points])


def _frame(axis: list[float]) -> np.ndarray:
    """Return a rotation (3, 3) whose third column is the axis."""
    third = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    first = np.cross(np.eye(3)[np.argmin(np.abs(third))], third)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(third, first), third], axis=1)


def outlines(part: dict[str, Any]) -> list[np.ndarray]:
    """Return polylines (points, 3) [m] of a part at ΔT = 0, relative to its centre and across its axis (default z). The
    list is empty for links, springs, frames and meshes, because their points are in the scene or in the file."""
    flat = _flat_outlines(part)
    return [line @ _frame(part["axis"]).T for line in flat] if "axis" in part else flat


def _flat_outlines(part: dict[str, Any]) -> list[np.ndarray]:
    kind = part["type"]
    if kind == "journal":  # the spoke shows the rotation
        return [_circle(part["radius_m"]), _polyline([(0, 0), (part["radius_m"], 0)])]
    if kind == "bearing":
        return [_circle(part["radius_m"])]
    if kind == "block":
        x, y = part["half_width_m"], part["half_height_m"]
        return [_polyline([(-x, -y), (x, -y), (x, y), (-x, y), (-x, -y)])]
    if kind == "slot":
        minus, plus, y = part["stop_minus_m"], part["stop_plus_m"], part["half_height_m"]
        return [_polyline([(-minus, y), (-minus, -y), (plus, -y), (plus, y)])]
    return []


def placed(points: np.ndarray, centre: np.ndarray, angle_rad: float, growth: float) -> np.ndarray:
    """Return the positions in space of points in a part's frame: scaled by ``growth``, rotated about z, and moved."""
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return centre + growth * points @ turn.T


def growth(part: dict[str, Any], result: Result, model: str) -> np.ndarray:
    """Return 1 + thermal strain of a part at every sample, the factor of its radii and other dimensions."""
    run = result.models[model]
    change = resolve(part.get("temperature_change_K", result.scene["temperature_change_K"]), run, result.names)
    return 1 + part.get("thermal_expansion_per_K", 0.0) * change
