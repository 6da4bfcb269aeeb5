# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies that tests make by hand: bars, beams and frames of beams, condensed to some of their nodes."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from statejump.bodies.body import CondensedBody, from_arrays

YOUNG_PA, SHEAR_PA, EXPANSION_PER_K, DENSITY = 70e9, 26e9, 2e-5, 2700.0
WIDTH_M, HEIGHT_M = 0.02, 0.03  # of the rectangular section, along y and z
AREA_M2 = WIDTH_M * HEIGHT_M
MOMENTS_M4 = (WIDTH_M * HEIGHT_M**3 / 12, HEIGHT_M * WIDTH_M**3 / 12)
TORSION_M4 = 6e-8


def beam_keys(axis_y: Sequence[float], **more: Any) -> dict[str, Any]:
    """Return the keys of a [[beam]] with the section of this module, rigid in shear."""
    return {"young_modulus_Pa": YOUNG_PA, "shear_modulus_Pa": SHEAR_PA, "cross_section_area_m2": AREA_M2,
            "second_moments_of_area_m4": list(MOMENTS_M4), "torsion_constant_m4": TORSION_M4,
            "thermal_expansion_per_K": EXPANSION_PER_K, "axis_y": list(axis_y), **more}


def beam_stiffness(ends_m: np.ndarray, axis_y: Sequence[float]) -> np.ndarray:
    """Return the linear stiffness (12, 12) of a beam in space without shear deformation."""
    along = ends_m[1] - ends_m[0]
    length = float(np.linalg.norm(along))
    x = along / length
    z = np.cross(x, axis_y) / np.linalg.norm(np.cross(x, axis_y))
    axes = np.vstack((x, np.cross(z, x), z))
    own = np.zeros((12, 12))
    for first, second, stiffness in ((0, 6, YOUNG_PA * AREA_M2 / length), (3, 9, SHEAR_PA * TORSION_M4 / length)):
        own[np.ix_((first, second), (first, second))] += stiffness * np.array([[1, -1], [-1, 1]])
    for moment, places, sign in ((MOMENTS_M4[1], (1, 5, 7, 11), 1.0), (MOMENTS_M4[0], (2, 4, 8, 10), -1.0)):
        bending = YOUNG_PA * moment / length**3
        a, b = 6 * length * sign, 2 * length**2
        own[np.ix_(places, places)] += bending * np.array(
            [[12, a, -12, a], [a, 2 * b, -a, b], [-12, -a, 12, -a], [a, b, -a, 2 * b]])
    turn = np.kron(np.eye(4), axes)
    return np.asarray(turn.T @ own @ turn)


def frame_body(positions_m: np.ndarray, beams: Sequence[tuple[int, int, Sequence[float]]], kept: Sequence[int],
               names: Sequence[str], axes: np.ndarray | None = None) -> CondensedBody:
    """Return a frame of beams condensed to some of its nodes, with one uniform thermal pattern.

    :param beams: first node, second node, axis y of each
    :param axes: rotation from the axes of the file to those of the positions; None: the same axes
    """
    stiffness = np.zeros((6 * len(positions_m),) * 2)
    for first, second, axis_y in beams:
        at = np.concatenate((6 * first + np.arange(6), 6 * second + np.arange(6)))
        stiffness[np.ix_(at, at)] += beam_stiffness(positions_m[[first, second]], axis_y)
    own = np.concatenate([6 * node + np.arange(6) for node in kept])
    rest = np.setdiff1d(np.arange(len(stiffness)), own)
    condensed = stiffness[np.ix_(own, own)]
    if len(rest):
        condensed = condensed - stiffness[np.ix_(own, rest)] @ np.linalg.solve(
            stiffness[np.ix_(rest, rest)], stiffness[np.ix_(rest, own)])
    placed = positions_m[list(kept)]
    back = np.eye(3) if axes is None else axes.T
    turn = np.kron(np.eye(2 * len(kept)), back)
    shape = np.hstack((EXPANSION_PER_K * placed, np.zeros_like(placed))).ravel()
    return from_arrays(names, placed @ back.T, turn @ condensed @ turn.T, pattern_names=["uniform"],
                       free_shapes=(turn @ shape)[None])


def bar_body(length_m: float) -> CondensedBody:
    """Return a bar along x between two nodes of three dofs."""
    row = np.array([-1.0, 0, 0, 1.0, 0, 0])
    return from_arrays(["a", "b"], [[0, 0, 0], [length_m, 0, 0]], YOUNG_PA * AREA_M2 / length_m * np.outer(row, row),
                       node_freedoms=[3, 3], pattern_names=["uniform"],
                       free_shapes=[EXPANSION_PER_K * length_m * np.array([0.0, 0, 0, 1.0, 0, 0])])
