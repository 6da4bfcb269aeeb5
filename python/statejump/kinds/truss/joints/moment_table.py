# SPDX-License-Identifier: GPL-3.0-or-later
"""Moment curves of hinges: a table with monotone cubics between its points."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from statejump.core import libraries
from statejump.core.errors import MissingKey, NotAllowed
from statejump.kinds.truss.arrays import values
from statejump.schema.item_tables import ItemColumns

KEYS = ("table_angle_rad", "table_moment_N_m")


def check(angle_rad: Sequence[float] | None, moment_N_m: Sequence[float] | None, where: Mapping[str, Any]) -> None:
    """Check a moment curve: as many moments as rotations, two or more, which increase and enclose 0.

    :param where: fields that name the hinge
    """
    if angle_rad is None and moment_N_m is None:
        return
    if angle_rad is None or moment_N_m is None:
        raise MissingKey(KEYS[0 if angle_rad is None else 1], code="moment_table_incomplete", **where)
    if len(moment_N_m) != len(angle_rad) or len(angle_rad) < 2:
        raise NotAllowed(KEYS[1], list(moment_N_m), code="moment_table_length", angles=len(angle_rad), **where)
    for before, after in zip(angle_rad, angle_rad[1:]):
        if not after > before:
            raise NotAllowed(KEYS[0], list(angle_rad), code="moment_table_not_increasing", after=after, before=before,
                             **where)
    if not angle_rad[0] <= 0 <= angle_rad[-1]:
        raise NotAllowed(KEYS[0], list(angle_rad), code="moment_table_without_zero", **where)


def given(items: ItemColumns[Any]) -> np.ndarray:
    """Return for every hinge (n,) whether it has a key of a moment curve."""
    return np.array([any(value is not None for value in row) for row in zip(*(values(items, key) for key in KEYS))],
                    dtype=bool)


def derived(items: Sequence[Any]) -> dict[str, tuple[np.ndarray, ...]]:
    """Return the points of every hinge's moment curve; empty arrays: none."""
    return {key: tuple(np.array(() if value is None else value, dtype=float) for value in values(items, key))
            for key in KEYS}


def slopes(angle_rad: np.ndarray, moment_N_m: np.ndarray) -> np.ndarray:
    """Return the slopes [N m/rad] of the monotone cubics (Fritsch and Carlson) at the points of a table. Two points
    have a straight line."""
    if not len(angle_rad):
        return np.zeros(0)
    cubics = libraries.scipy("interpolate").PchipInterpolator(angle_rad, moment_N_m)
    return np.asarray(cubics.derivative()(angle_rad))


def moment_N_m(angle_rad: np.ndarray, moments: np.ndarray, rotation_rad: np.ndarray) -> np.ndarray:
    """Return the moments [N m] at rotations; beyond the table it continues as a straight line, as in the engine."""
    slope = slopes(angle_rad, moments)
    cubics = libraries.scipy("interpolate").CubicHermiteSpline(angle_rad, moments, slope)
    inside = np.clip(rotation_rad, angle_rad[0], angle_rad[-1])
    ends = np.where(rotation_rad < angle_rad[0], slope[0], slope[-1])
    return np.asarray(cubics(inside) + ends * (rotation_rad - inside))
