# SPDX-License-Identifier: GPL-3.0-or-later
"""Formulas that checks, drawings and time steps need in Python. Each formula is implemented once, in SI units, for
numbers and arrays. The models themselves are in the engine and the plugin."""
from __future__ import annotations

from typing import TypeVar

import numpy as np

Value = TypeVar("Value", float, np.ndarray)


def effective_young_modulus_Pa(young_modulus_Pa: Value, poisson_ratio: Value) -> Value:
    """Return E* [Pa] of a contact of two parts of one material, E/(2 (1 - ν²))."""
    modulus_Pa: Value = young_modulus_Pa / (2 * (1 - poisson_ratio**2))
    return modulus_Pa


def shear_over_normal_stiffness(poisson_ratio: Value) -> Value:
    """Return k_t/k_n = 4 G*/E* = 2 (1 - ν)/(2 - ν) of a contact of two parts of the same material (Mindlin)."""
    ratio: Value = 2 * (1 - poisson_ratio) / (2 - poisson_ratio)
    return ratio


def hertz_stiffness_N_per_m15(effective_young_modulus_Pa: Value, effective_radius_m: Value) -> Value:
    """Return K of F = K δ^1.5 [N/m^1.5], 4/3 E* sqrt(R)."""
    stiffness: Value = 4 / 3 * effective_young_modulus_Pa * np.sqrt(effective_radius_m)
    return stiffness


def conforming_radius_m(journal_radius_m: Value, bearing_radius_m: Value, radial_clearance_m: Value) -> Value:
    """Return R1 R2/(R2 - R1) [m], the effective radius of a journal of radius R1 in a bearing of radius R2."""
    radius_m: Value = journal_radius_m * bearing_radius_m / radial_clearance_m
    return radius_m


def hertz_depth_m(force_N: Value, hertz_stiffness: Value) -> Value:
    """Return the penetration depth [m] at a normal force, (F/K)^(2/3)."""
    depth_m: Value = (force_N / hertz_stiffness) ** (2 / 3)
    return depth_m


def hertz_tangent_N_per_m(force_N: Value, hertz_stiffness: Value) -> Value:
    """Return dF/dδ [N/m] of F = K δ^1.5 at a force."""
    stiffness_N_per_m: Value = 1.5 * hertz_stiffness ** (2 / 3) * np.cbrt(force_N)
    return stiffness_N_per_m


def hertz_tangent_at_depth_N_per_m(effective_young_modulus_Pa: Value, effective_radius_m: Value,
                                   depth_m: Value) -> Value:
    """Return the stiffness dF/dδ = 2 E* sqrt(R δ) [N/m] of the Hertz law F = K δ^1.5 at a depth δ."""
    stiffness_N_per_m: Value = 2 * effective_young_modulus_Pa * np.sqrt(effective_radius_m * depth_m)
    return stiffness_N_per_m


def axial_stiffness_N_per_m(young_modulus_Pa: Value, cross_section_area_m2: Value, length_m: Value) -> Value:
    """Return E A / l [N/m], the paper's equation (4)."""
    stiffness_N_per_m: Value = young_modulus_Pa * cross_section_area_m2 / length_m
    return stiffness_N_per_m


def apex_m(left_m: Value, right_m: Value, base_m: Value) -> tuple[Value, Value]:
    """Return x and y [m] of the point at which two links meet above a base from (0, 0) to (base, 0); y is 0 if both
    links are too short.

    :param left_m: length of the link from (0, 0)
    :param right_m: length of the link from (base, 0)
    """
    x = (base_m + (left_m - right_m) * (left_m + right_m) / base_m) / 2
    # Heron's product: no difference of squares.
    product = ((left_m + right_m + base_m) * (left_m + right_m - base_m)
               * (base_m + left_m - right_m) * (base_m - left_m + right_m))
    return x, np.sqrt(np.maximum(product, 0.0)) / (2 * base_m)
