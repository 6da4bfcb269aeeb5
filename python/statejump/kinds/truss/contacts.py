# SPDX-License-Identifier: GPL-3.0-or-later
"""Stiffness of a truss' joints by Hertz's and Mindlin's formulas, not by the DEM's contact law.

Both parts of a joint are of one material: E* = E/(2 (1 - ν²)), and k_t/k_n = 4 G*/E* = 2 (1 - ν)/(2 - ν).
Journal and bearing touch as a sphere of R = R1 R2/(R2 - R1) on a plane, as bodies of the DEM do.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from statejump.kinds.truss.resolved import ResolvedTruss, Revolutes, Sliders


@dataclass(frozen=True)
class Pad:
    """Contacts of sliders with their floors: pads of a sphere on a plane."""

    depth_m: np.ndarray  # at which the floor carries the normal force
    normal_N_per_m: np.ndarray  # tangent stiffnesses at that depth
    tangential_N_per_m: np.ndarray


def _effective_modulus(parts: Sliders | Revolutes) -> np.ndarray:
    """E* [Pa]."""
    return parts.young_modulus_Pa / (2 * (1 - parts.poisson_ratio**2))


def _hertz(parts: Sliders | Revolutes, radius_m: np.ndarray) -> np.ndarray:
    """K of F = K δ^1.5 [N/m^1.5], 4/3 E* sqrt(R)."""
    return 4 / 3 * _effective_modulus(parts) * np.sqrt(radius_m)


def _shear_over_normal(parts: Sliders | Revolutes) -> np.ndarray:
    """k_t/k_n."""
    return 2 * (1 - parts.poisson_ratio) / (2 - parts.poisson_ratio)


def tangent_stiffness(hertz: np.ndarray, force_N: np.ndarray) -> np.ndarray:
    """Return dF/dδ [N/m] of contacts with F = K δ^1.5 at these forces [N]."""
    return 1.5 * hertz ** (2 / 3) * np.cbrt(force_N)


def pad_hertz_stiffness(truss: ResolvedTruss) -> np.ndarray:
    """Return K of F = K δ^1.5 [N/m^1.5] of every slider's pad on a plane, its floor or a stop."""
    return _hertz(truss.sliders, truss.sliders.pad_radius_m)


def pads(truss: ResolvedTruss) -> Pad:
    """Return the contacts of the sliders' pads with their floors."""
    sliders = truss.sliders
    depth = (sliders.normal_force_N / pad_hertz_stiffness(truss)) ** (2 / 3)
    normal = 2 * _effective_modulus(sliders) * np.sqrt(sliders.pad_radius_m * depth)
    return Pad(depth, normal, normal * _shear_over_normal(sliders))


def hertz_stiffness(truss: ResolvedTruss) -> np.ndarray:
    """Return K of F = K δ^1.5 [N/m^1.5] of every revolute."""
    joints = truss.revolutes
    return _hertz(joints, joints.journal_radius_m * joints.bearing_radius_m / joints.radial_clearance_m)


def mindlin_stiffness(truss: ResolvedTruss) -> np.ndarray:
    """Return k_t over the root of the depth [N/m^1.5] of every revolute, 8 G* sqrt(R)."""
    return 1.5 * hertz_stiffness(truss) * _shear_over_normal(truss.revolutes)


def revolute_stiffness(truss: ResolvedTruss, force_N: np.ndarray) -> np.ndarray:
    """Return the sum of both tangent stiffnesses [N/m] of revolutes at these normal forces [N]."""
    return tangent_stiffness(hertz_stiffness(truss), force_N) * (1 + _shear_over_normal(truss.revolutes))


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
