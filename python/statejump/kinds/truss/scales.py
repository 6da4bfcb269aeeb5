# SPDX-License-Identifier: GPL-3.0-or-later
"""Scales of the motion of a truss, and the fractions of the scales below which a number counts as rounding.

A scale depends on the truss and its whole program, so it does not vanish when a truss returns to its initial position.
"""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.resolved import ResolvedTruss

# Fraction of the motion that is rounding. Changes of status are located within 1e-9 of a branch. A slender truss
# amplifies the rounding of coordinates by its squared slenderness: 40 bays reach 1e-9 of the motion.
ROUNDING = 1e-9
# Rounding relative to coordinates: a length is a difference of coordinates, and a state results from some hundred
# solutions with such lengths.
COORDINATES = 1e3 * float(np.finfo(float).eps)
# Smallest reference of a comparison, relative to the scales. With damping ratio 0.1, and a natural period of 1e-3 of
# the thermal cycle, the DEM lags and oscillates by about 1e-5 of the motion. The usual tolerance, 1 % of this
# reference, is ten times as large.
COMPARED = 1e-2
# A jump below this fraction of the allowed difference of displacements counts as zero in a comparison with the DEM.
NO_JUMP = 1e-4
# Smallest motion as a multiple of the rounding of coordinates: COMPARED/100 of this motion still exceeds that rounding.
LEAST_MOTION = 1e4


@dataclass(frozen=True)
class Scales:
    """Reference values for differences.

    :param motion_m: largest displacement, free expansion, or deflection of the stiffest element under the largest load
        [m]; at least LEAST_MOTION times the rounding of coordinates
    :param rounding_m: largest displacement that counts as rounding [m]
    :param force_N: largest force of a link with prevented expansion, or largest load [N]
    :param energy_J: elastic energy of all links with prevented expansion, or of the deflection in ``motion_m`` [J]
    """

    motion_m: float
    rounding_m: float
    force_N: float
    energy_J: float


def scales(truss: ResolvedTruss, displacement_m: np.ndarray) -> Scales:
    """Return the scales of a truss.

    :param displacement_m: displacements of the nodes over the program (states, nodes, 3)
    """
    kept = vars(truss)
    if "_scales" not in kept:  # cached, because a truss may have a program for every link
        kept["_scales"] = _at_rest(truss)
    still: Scales = kept["_scales"]
    motion = max(still.motion_m, float(np.linalg.norm(displacement_m, axis=-1).max(initial=0.0)))
    return replace(still, motion_m=motion, rounding_m=max(still.rounding_m, ROUNDING * motion))


def _at_rest(truss: ResolvedTruss) -> Scales:
    """Return the scales that do not depend on displacements."""
    links, position = truss.links, truss.nodes.position_m
    coordinates = COORDINATES * float(np.abs(position).max(initial=0.0))
    size = float(np.ptp(position, axis=0).max()) if len(position) else 0.0
    ranges_K = np.abs(truss.temperature_ranges_K).max(axis=1)
    expansion = np.abs(links.thermal_expansion_per_K * links.temperature_fraction * ranges_K[links.program])
    strain = np.maximum(expansion, coordinates / links.stress_free_length_m)
    rigidity = links.young_modulus_Pa * links.cross_section_area_m2
    stiffness = np.concatenate((rigidity / links.stress_free_length_m, *truss.element_stiffnesses_N_per_m()))
    preload = np.concatenate([element.preload_N(truss.elements[element.section]) for element in ELEMENTS])
    load = max(float(np.linalg.norm(truss.nodes.force_N, axis=1).max(initial=0.0)),
               float(np.abs(preload).max(initial=0.0)))
    deflection = load / float(stiffness.max()) if len(stiffness) else 0.0
    motion = max(size * float(expansion.max(initial=0.0)), deflection, LEAST_MOTION * coordinates)
    force = max(float((rigidity * strain).max(initial=0.0)), load, coordinates * float(stiffness.max(initial=0.0)))
    held = float((rigidity * strain**2 * links.stress_free_length_m).sum())
    energy = 0.5 * max(held, load * deflection, coordinates**2 * float(stiffness.sum()))
    return Scales(motion, max(ROUNDING * motion, coordinates), force, energy)
