# SPDX-License-Identifier: GPL-3.0-or-later
"""Units: the unit at the end of a name, and numbers with SI prefixes (23.8095 µm, not 2.38095e-05 m)."""
from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

# Units by the ending of a name, the longest first, because _N_m is not _m.
ENDINGS = {
    "_N_m_s_per_rad": "N m s/rad", "_N_m_per_rad": "N m/rad", "_kg_per_m3": "kg/m3", "_rad_per_s": "rad/s",
    "_kg_m2": "kg m2", "_m_per_s2": "m/s2", "_N_per_m": "N/m", "_m_per_s": "m/s", "_N_per_K": "N/K", "_per_K": "1/K",
    "_per_m": "1/m", "_N_m": "N m", "_rad": "rad", "_kg": "kg", "_Pa": "Pa", "_m2": "m2", "_m4": "m4", "_m": "m",
    "_K": "K", "_N": "N", "_J": "J", "_s": "s", "_W": "W",
}


@lru_cache(maxsize=None)
def split_unit(name: str) -> tuple[str, str]:
    """Return a name without its unit, and the unit (``-`` for none)."""
    ending = next((ending for ending in ENDINGS if name.endswith(ending)), "")
    return name.removesuffix(ending), ENDINGS.get(ending, "-")


def unit_of(name: str) -> str:
    """Return the unit that a name ends in; ``-`` for none."""
    return split_unit(name)[1]


PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
# Units that take a prefix, with their usual powers of ten.
PREFIXED = {
    "m": (-9, 0), "N": (-6, 6), "J": (-9, 6), "s": (-9, 0), "rad": (-9, 0), "Pa": (0, 9), "N/m": (0, 9), "W": (-9, 6),
    "N m": (-6, 6),
}
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
WRITTEN = {"m2": "m²", "kg/m3": "kg/m³", "kg m2": "kg·m²", "m/s2": "m/s²", "N m": "N·m",
           "N m/rad": "N·m/rad", "N m s/rad": "N·m·s/rad"}


def scale_of(unit: str, size: float) -> tuple[float, str]:
    """Return a readable unit for values of the given size, and the factor that converts values to this unit."""
    written = WRITTEN.get(unit, unit)
    if unit == "m2" and 0 < abs(size) < 1e-2:
        return 1e6, "mm²"
    if unit not in PREFIXED or not math.isfinite(size) or size == 0:
        return 1.0, "" if unit == "-" else written
    low, high = PREFIXED[unit]
    power = min(high, max(low, 3 * math.floor(math.log10(abs(size)) / 3 + 1e-12)))
    return 10.0**-power, PREFIXES[power] + written


def text(value: float | None, unit: str = "-", digits: int = 6) -> str:
    """Return a number with its unit; ``none`` for None and NaN."""
    if value is None or math.isnan(value):
        return "none"
    scale, written = scale_of(unit, value)
    before_point = len(str(int(abs(value * scale)))) if abs(value * scale) < 1000 else 0
    shown = f"{value * scale:.{max(digits, before_point)}g}"
    if "e" in shown:  # beyond the prefixes: a power of ten of the unit itself
        written = "" if unit == "-" else WRITTEN.get(unit, unit)
        shown = f"{value:.{digits - 1}e}"
        mantissa, power = shown.split("e")
        shown = f"{mantissa}·10{str(int(power)).translate(RAISED)}"
    shown = shown.replace("-", "−")
    return f"{shown}\u202f{written}" if written else shown


def plain(value: float | None, unit: str = "-", digits: int = 6) -> str:
    """Return the number as text with common blank and minus sign, so that a text search finds it."""
    return text(value, unit, digits).replace("\u202f", " ").replace("−", "-")


@dataclass(frozen=True)
class Conversion:
    """Conversion of numbers to another unit: x · factor/divisor + offset. The divisor makes 12.5 mm exactly 0.0125
    m."""

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
