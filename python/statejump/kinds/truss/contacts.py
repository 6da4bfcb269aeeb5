# SPDX-License-Identifier: GPL-3.0-or-later
"""Stiffness of a truss' joints by Hertz's and Mindlin's formulas, not by the DEM's contact law.

Both parts of a joint are of one material. Journal and bearing touch as a sphere of R = R1 R2/(R2 - R1) on a plane,
as bodies of the DEM do.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from statejump.core import physics
from statejump.kinds.truss.resolved import ResolvedTruss, Revolutes, Sliders


@dataclass(frozen=True)
class Pad:
    """Contacts of sliders with their floors: pads of a sphere on a plane."""

    depth_m: np.ndarray  # at which the floor carries the normal force
    normal_N_per_m: np.ndarray  # tangent stiffnesses at that depth
    tangential_N_per_m: np.ndarray


def _effective_modulus(parts: Sliders | Revolutes) -> np.ndarray:
    return physics.effective_young_modulus_Pa(parts.young_modulus_Pa, parts.poisson_ratio)


def pad_hertz_stiffness(truss: ResolvedTruss) -> np.ndarray:
    """Return K of F = K δ^1.5 [N/m^1.5] of every slider's pad on a plane, its floor or a stop."""
    return physics.hertz_stiffness_N_per_m15(_effective_modulus(truss.sliders), truss.sliders.pad_radius_m)


def pads(truss: ResolvedTruss) -> Pad:
    """Return the contacts of the sliders' pads with their floors."""
    sliders = truss.sliders
    depth = physics.hertz_depth_m(sliders.normal_force_N, pad_hertz_stiffness(truss))
    normal = physics.hertz_tangent_at_depth_N_per_m(_effective_modulus(sliders), sliders.pad_radius_m, depth)
    return Pad(depth, normal, normal * physics.shear_over_normal_stiffness(sliders.poisson_ratio))


def hertz_stiffness(truss: ResolvedTruss) -> np.ndarray:
    """Return K of F = K δ^1.5 [N/m^1.5] of every revolute."""
    joints = truss.revolutes
    radius = physics.conforming_radius_m(joints.journal_radius_m, joints.bearing_radius_m, joints.radial_clearance_m)
    return physics.hertz_stiffness_N_per_m15(_effective_modulus(joints), radius)


def mindlin_stiffness(truss: ResolvedTruss) -> np.ndarray:
    """Return k_t over the root of the depth [N/m^1.5] of every revolute, 8 G* sqrt(R)."""
    return 1.5 * hertz_stiffness(truss) * physics.shear_over_normal_stiffness(truss.revolutes.poisson_ratio)


def revolute_stiffness(truss: ResolvedTruss, force_N: np.ndarray) -> np.ndarray:
    """Return the sum of both tangent stiffnesses [N/m] of revolutes at these normal forces [N]."""
    normal = physics.hertz_tangent_N_per_m(force_N, hertz_stiffness(truss))
    return normal * (1 + physics.shear_over_normal_stiffness(truss.revolutes.poisson_ratio))


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
