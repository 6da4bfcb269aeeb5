# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of numbers between two units."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Conversion:
    """Conversion of numbers to another unit: x · factor/divisor + offset. The divisor converts 12.5 mm to exactly the
    number 0.0125."""

    factor: float = 1.0
    divisor: float = 1.0
    offset: float = 0.0

    def __call__(self, values: np.ndarray) -> np.ndarray:
        if self.factor != 1:
            values = values * self.factor
        if self.divisor != 1:
            values = values / self.divisor
        return values + self.offset if self.offset else values


SAME = Conversion()
