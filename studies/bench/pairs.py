# SPDX-License-Identifier: GPL-3.0-or-later
"""Input shared by all programs in these benchmarks: n contacts of the same bodies under the same load.

YADE scripts import this module too. Joint radius, clearance and material are those of Table 2 of Chen et al. (2021).
"""
from __future__ import annotations

from collections.abc import Iterator
from math import ceil, sqrt

YOUNG, POISSON, FRICTION = 70e9, 0.3, 0.3  # Pa, -, -
EXPANSION_JOURNAL, EXPANSION_BEARING = 23.75e-6, 22e-6  # 1/K; different, so the clearance changes
RADIUS, CLEARANCE, MASS = 5e-3, 1e-4, 0.01  # m, m, kg
BEARING_RADIUS = RADIUS + CLEARANCE
JOINT_RADIUS = RADIUS * BEARING_RADIUS / CLEARANCE  # effective radius of a journal in its bearing [m]
LOAD, INCLINATION = 10.0, 0.5 * FRICTION  # normal force [N]; tangential over normal force [-]
SPACING, SEARCHED = 0.03, 0.5e-3  # distance of pairs, and margin of the contact search beyond the bodies [m]
TIME_STEP = 1e-6  # s
EFFECTIVE_MODULUS = YOUNG / (2 * (1 - POISSON**2))  # Pa


def depth(effective_radius: float) -> float:
    """Return the depth [m] at which a Hertz contact carries the load of the benchmark."""
    return (LOAD / (4 / 3 * EFFECTIVE_MODULUS * sqrt(effective_radius))) ** (2 / 3)


def places(size: int) -> Iterator[tuple[float, float, float]]:
    """Yield the positions of the fixed bodies on a cubic grid."""
    edge = ceil(size ** (1 / 3))
    for i in range(size):
        x, rest = i % edge, i // edge
        yield x * SPACING, rest % edge * SPACING, rest // edge * SPACING
