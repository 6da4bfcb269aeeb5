# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin loops: a loop with a large reversible part, drawn without this part."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

THIN = 0.05  # largest distance from a straight line, over the range, of a loop that looks like a line
ROUNDING = 1e-9  # fraction of its range below which a loop counts as zero


@dataclass(frozen=True)
class StraightPart:
    """The straight line that a loop follows."""

    slope: float
    offset: float

    def taken_off(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the remainder of values at x."""
        return np.asarray(y - (self.offset + self.slope * x))


def straight_part(x: np.ndarray, y: np.ndarray) -> StraightPart | None:
    """Return the reversible part of a loop, a straight line (least squares); None: the loop is wide, or there is no
    loop."""
    size = float(np.ptp(y))
    if not 0 < size < np.inf or not 0 < np.ptp(x) < np.inf:
        return None
    try:
        slope, offset = np.polyfit(x, y, 1)
    except np.linalg.LinAlgError:  # squares of the numbers overflow
        return None
    line = StraightPart(float(slope), float(offset))
    largest = float(np.abs(line.taken_off(x, y)).max())
    return line if ROUNDING * size < largest < THIN * size else None
