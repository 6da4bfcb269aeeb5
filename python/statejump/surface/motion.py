# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid motion of a set of nodes, and rotation of a direction that moves with the nodes."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError

# Fraction of the extent of the nodes below which they are collinear: the rotation about their line is undetermined.
ON_A_LINE = 1e-6


def rotation_rad(position_m: Any, displacement_m: Any) -> np.ndarray:
    """Return the rotation (..., 3) [rad] of the rigid motion that fits the displacements of nodes best (least squares,
    first order).

    :param position_m: positions (nodes, 3) [m]
    :param displacement_m: displacements (..., nodes, 3) [m]
    :raises StatejumpError: the nodes lie on one line
    """
    position, displacement = (np.asarray(each, dtype=float) for each in (position_m, displacement_m))
    if position.ndim != 2 or position.shape[1] != 3 or position.shape != displacement.shape[-2:]:
        raise NotAllowed("displacement_m", code="displacement_of_other_shape")
    arm, moved = position - position.mean(axis=0), displacement - displacement.mean(axis=-2, keepdims=True)
    spread = np.linalg.svd(arm, compute_uv=False)
    if len(arm) < 3 or spread[1] <= ON_A_LINE * spread[0]:
        raise StatejumpError(code="nodes_on_one_line")
    inertia = np.sum(arm**2) * np.eye(3) - arm.T @ arm
    turn: np.ndarray = np.cross(arm, moved).sum(axis=-2) @ np.linalg.inv(inertia)
    return turn


def pointing_rad(position_m: Any, displacement_m: Any, direction: Sequence[float]) -> Any:
    """Return the pointing error (...) [rad] of a direction that moves rigidly with nodes: the angle by which it
    rotates.

    :param position_m: positions (nodes, 3) [m]
    :param displacement_m: displacements (..., nodes, 3) [m]
    :param direction: the direction, a vector of any length
    :raises StatejumpError: the nodes lie on one line, or the direction is zero
    """
    way = np.asarray(direction, dtype=float)
    if way.shape != (3,) or not np.isfinite(way).all() or not np.linalg.norm(way) > 0:
        raise NotAllowed("direction", direction, code="no_direction")
    turned = np.cross(rotation_rad(position_m, displacement_m), way / np.linalg.norm(way))
    found = np.linalg.norm(turned, axis=-1)
    return found if found.ndim else float(found)
