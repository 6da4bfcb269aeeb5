# SPDX-License-Identifier: GPL-3.0-or-later
"""Stiffness of a truss' joints by Hertz's and Mindlin's formulas, not by the DEM's contact law.

Both parts of a joint are of one material: E* = E/(2 (1 - ν²)), and k_t/k_n = 4 G*/E* = 2 (1 - ν)/(2 - ν).
Journal and bearing touch as a sphere of R = R1 R2/(R2 - R1) on a plane, as bodies of the DEM do.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from .resolved import ResolvedTruss


@dataclass(frozen=True)
class Pad:
    """Contacts of sliders with their floors: pads of a sphere on a plane."""

    depth_m: np.ndarray  # at which the floor carries the normal force
    normal_N_per_m: np.ndarray  # tangent stiffnesses at that depth
    tangential_N_per_m: np.ndarray


def _shear_over_young(poisson_ratio: np.ndarray) -> np.ndarray:
    """k_t/k_n."""
    return 2 * (1 - poisson_ratio) / (2 - poisson_ratio)


def pads(truss: ResolvedTruss) -> Pad:
    """Return the contacts of the sliders' pads with their floors."""
    sliders = truss.sliders
    modulus = sliders.young_modulus_Pa / (2 * (1 - sliders.poisson_ratio**2))
    depth = (sliders.normal_force_N / (4 / 3 * modulus * np.sqrt(sliders.pad_radius_m))) ** (2 / 3)
    normal = 2 * modulus * np.sqrt(sliders.pad_radius_m * depth)
    return Pad(depth, normal, normal * _shear_over_young(sliders.poisson_ratio))


def hertz_stiffness(truss: ResolvedTruss) -> np.ndarray:
    """Return K of F = K δ^1.5 [N/m^1.5] of every revolute, 4/3 E* sqrt(R)."""
    joints = truss.revolutes
    modulus = joints.young_modulus_Pa / (2 * (1 - joints.poisson_ratio**2))
    radius = joints.journal_radius_m * joints.bearing_radius_m / joints.radial_clearance_m
    return 4 / 3 * modulus * np.sqrt(radius)


def mindlin_stiffness(truss: ResolvedTruss) -> np.ndarray:
    """Return k_t over the root of the depth [N/m^1.5] of every revolute, 8 G* sqrt(R)."""
    return 1.5 * hertz_stiffness(truss) * _shear_over_young(truss.revolutes.poisson_ratio)


def revolute_stiffness(truss: ResolvedTruss, force_N: np.ndarray) -> np.ndarray:
    """Return the sum of both tangent stiffnesses [N/m] of revolutes at these normal forces [N]."""
    normal = 1.5 * hertz_stiffness(truss) ** (2 / 3) * np.cbrt(force_N)
    return normal * (1 + _shear_over_young(truss.revolutes.poisson_ratio))


def solver_stiffness(truss: ResolvedTruss) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return what the quasi-static solver takes, infinity where a contact is rigid: Hertz's and Mindlin's
    stiffness of revolutes [N/m^1.5], tangential stiffness of sliders [N/m]."""
    rigid = truss.revolutes.rigid
    elastic = truss.sticking == "elastic"
    loaded = elastic & (truss.sliders.normal_force_N > 0)
    return (
        np.where(rigid, inf, hertz_stiffness(truss)),
        np.where(rigid | (not elastic), inf, mindlin_stiffness(truss)),
        np.where(loaded, pads(truss).tangential_N_per_m, inf),
    )
