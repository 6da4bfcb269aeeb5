# SPDX-License-Identifier: GPL-3.0-or-later
"""Units of decks. A deck does not state its units."""
from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Units:
    """The units of a deck.

    :param length_m: one unit of length of the deck [m]
    :param force_N: one unit of force [N]
    :param mass_kg: one unit of mass [kg]; None: force · s² / length
    """

    length_m: float = 1.0
    force_N: float = 1.0
    mass_kg: float | None = None

    @property
    def mass(self) -> float:
        """Unit of mass [kg]."""
        return self.force_N / self.length_m if self.mass_kg is None else self.mass_kg

    @property
    def stress(self) -> float:
        """Unit of stress [Pa]."""
        return self.force_N / self.length_m**2


POUND_FORCE_N = 4.4482216152605  # exact
INCH_M = 0.0254  # exact
# Common systems first: the first of several equally plausible ones is chosen.
SYSTEMS = {
    "SI": Units(), "mm-N": Units(1e-3), "in-lbf": Units(INCH_M, POUND_FORCE_N), "mm-kg-s": Units(1e-3, 1e-3),
    "mm-kN-t": Units(1e-3, 1e3, 1e3),
}


def in_units(value: float, unit: float) -> float:
    """Return a number of a deck in the units of cases, rounded to the digits of a deck: 50 mm2 is 5e-05 m2."""
    return value if unit == 1 else float(f"{value * unit:.15g}")
