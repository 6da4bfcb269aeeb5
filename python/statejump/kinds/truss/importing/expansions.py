# SPDX-License-Identifier: GPL-3.0-or-later
"""Coefficients of thermal expansion that depend on temperature.

CalculiX and Abaqus use secants: from a temperature T0 to T the strain is α(T) (T - Tz) - α(T0) (T0 - Tz). α is linear
between its rows, and Tz is the value of ZERO=. Cases use the tangent, which is also linear between rows and jumps at
each row of the deck.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

# Beyond its table a coefficient is constant. Tables of cases extend this far [K].
BEYOND_K = 1e3
# Half the width of a jump, as a fraction of the range of the table. Beyond the jump, the strain error is the square of
# this fraction. Narrower jumps need more solver steps.
JUMP = 1e-3


def item(name: str, table: Sequence[tuple[float, float]], zero: float, start: float) -> dict[str, Any]:
    """Return the ``[[expansion]]`` of a table.

    :param table: increasing temperatures with secant coefficients
    :param zero: temperature at which the secants begin
    :param start: stress-free temperature
    """
    temperatures, secants = (np.array(column) for column in zip(*table))
    width = JUMP * max(float(np.ptp(temperatures)), 1.0)
    low, high = min(temperatures[0], start) - BEYOND_K, max(temperatures[-1], start) + BEYOND_K
    rows = [(low, secants[0]), (temperatures[0] - width, secants[0])]
    for left, right, first, last in zip(temperatures, temperatures[1:], secants, secants[1:]):
        if right - left <= 2 * width:  # a jump of the deck itself
            continue
        slope = (last - first) / (right - left)
        # The derivative of the strain: α(T) + α'(T) (T - Tz).
        rows += [(at, first + slope * (2 * at - left - zero)) for at in (left + width, right - width)]
    rows += [(temperatures[-1] + width, secants[-1]), (high, secants[-1])]
    return {"name": name, "temperature_change_K": [float(at - start) for at, _ in rows],
            "thermal_expansion_per_K": [float(value) for _, value in rows]}
