# SPDX-License-Identifier: GPL-3.0-or-later
"""Formatting of numbers of many items for sentences and legends."""
from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from statejump.core.units import text

USER = "no default: the truss decides"
ALUMINIUM = "choice, the paper is silent: aluminium"


def count(items: Sequence[object], one: str) -> str:
    """Return how many there are of something."""
    return f"{len(items)} {one}{'' if len(items) == 1 else 's'}"


def spread(values: Iterable[float], unit: str = "-", digits: int = 4) -> str:
    """Return the common value of many items or, if they differ, their range."""
    known = [float(value) for value in values]
    low, high = min(known), max(known)
    return text(low, unit, digits) if low == high else f"{text(low, unit, digits)} to {text(high, unit, digits)}"


def scaled(values: np.ndarray, scale: float, unit: str) -> str:
    """Return the common value or the range of several values times ``scale``, in a readable unit."""
    low, high = values.min() * scale, values.max() * scale
    return f"{low:.4g} {unit}" if high - low <= 1e-9 * abs(high) else f"{low:.3g} to {high:.3g} {unit}"
