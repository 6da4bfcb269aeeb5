# SPDX-License-Identifier: GPL-3.0-or-later
"""Thermal expansion that depends on temperature: a table of the coefficient α.

α is linear between the rows of the table, so the strain ε(ΔT) = ∫ α dΔT from 0 is a parabola between two rows. All
models use one constant coefficient and a piecewise linear temperature program. They get the coefficient α₀, the largest
|α| of the table, and the program ε/α₀, the temperature change that causes the strain ε with α₀.
"""
from __future__ import annotations

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.core.thermal import LARGEST_CHANGE_K, MemberProgram, Numbers, Thermal, rows
from statejump.schema.fields import Section, definition, numbers

# A linear piece has at most this error of the strain, as a fraction of its range: a tenth of the smallest default
# tolerance of `compare` (that of the energy balance).
CHORD = 1e-4


@definition
class Expansion(Section):
    """A coefficient of thermal expansion that depends on temperature, linear between its rows."""

    temperature_change_K: list[float] = numbers(
        ..., "K", -LARGEST_CHANGE_K, LARGEST_CHANGE_K, "from the stress-free temperature; rising, 0 within"
    )
    thermal_expansion_per_K: list[float] = numbers(..., "1/K", -1e-3, 1e-3, "one for every temperature change")

    @property
    def largest_per_K(self) -> float:
        """The largest |α| [1/K] of the table."""
        return max(abs(alpha) for alpha in self.thermal_expansion_per_K)

    @property
    def zeros_K(self) -> list[float]:
        """Temperature changes [K] at which α is 0, where the strain may have an extremum."""
        rows, alpha = self.temperature_change_K, self.thermal_expansion_per_K
        between = [one + (other - one) * first / (first - last)
                   for one, other, first, last in zip(rows, rows[1:], alpha, alpha[1:]) if first * last < 0]
        return [*(row for row, value in zip(rows, alpha) if value == 0), *between]

    def strain(self, temperature_change_K: Numbers) -> Numbers:
        """Return the free strain [-], ∫ α dΔT from 0 to each temperature change [K], all within the table."""
        rows, alpha = np.array(self.temperature_change_K), np.array(self.thermal_expansion_per_K)
        steps = np.diff(rows)
        at_rows = np.concatenate(([0.0], np.cumsum(0.5 * (alpha[1:] + alpha[:-1]) * steps)))

        def from_first_row(change: Numbers) -> Numbers:
            piece = np.clip(np.searchsorted(rows, change, side="right") - 1, 0, len(steps) - 1)
            way = change - rows[piece]
            slope = (alpha[piece + 1] - alpha[piece]) / steps[piece]
            return np.asarray(at_rows[piece] + (alpha[piece] + 0.5 * slope * way) * way)

        return from_first_row(np.asarray(temperature_change_K, dtype=float)) - from_first_row(np.zeros(1))


def check(expansion: Expansion, section: str) -> None:
    """Raise NotAllowed for an invalid table of expansion coefficients.

    :param section: prefix of the keys; "" for keys in a table of their own
    """
    rows, alpha = expansion.temperature_change_K, expansion.thermal_expansion_per_K
    if len(rows) < 2 or any(b <= a for a, b in zip(rows, rows[1:])) or not rows[0] <= 0 <= rows[-1]:
        raise NotAllowed(f"{section}temperature_change_K", rows, code="expansion_temperatures")
    if len(alpha) != len(rows) or not any(alpha):
        raise NotAllowed(f"{section}thermal_expansion_per_K", alpha, code="expansion_coefficients", rows=len(rows))


def followed(
    expansion: Expansion, program: Thermal | MemberProgram, period_s: float, fraction: float = 1.0
) -> MemberProgram:
    """Return the program ε/α₀ of an item, from its temperature program.

    The strain is exact at the rows of the program. For triangles and tables it is also exact where ΔT crosses a row of
    the expansion table. Further rows keep the error of the strain below the fraction CHORD of its range. For the
    history of a member the strain is linear between the rows.

    :param program: temperature program ΔT
    :param fraction: fraction of ΔT that the item undergoes
    :raises NotAllowed: the program leaves the table, or is not piecewise linear
    """
    times, changes = _rows(program, period_s)
    changes = fraction * changes
    rows = np.array(expansion.temperature_change_K)
    for change in (changes.min(), changes.max()):
        if not rows[0] <= change <= rows[-1]:
            raise NotAllowed("temperature_change_K", rows.tolist(), code="expansion_too_narrow", reached_K=change)
    if isinstance(program, Thermal):
        times, changes = _divided(expansion, times, changes)
    return MemberProgram(times, expansion.strain(changes) / expansion.largest_per_K, program.cycles)


def _rows(program: Thermal | MemberProgram, period_s: float) -> tuple[Numbers, Numbers]:
    """Return times and temperature changes between which a cycle is linear."""
    if program.shape == "table":
        return rows(program, period_s)
    assert isinstance(program, Thermal) and program.temperature_change_max_K is not None
    if program.shape != "triangle":
        raise NotAllowed("thermal.shape", program.shape, code="expansion_shape")
    return np.array([0.0, 0.5, 1.0]) * period_s, np.array([0.0, program.temperature_change_max_K, 0.0])


def _divided(expansion: Expansion, times: Numbers, changes: Numbers) -> tuple[Numbers, Numbers]:
    """Return the rows of a program with further rows between which the strain is nearly linear."""
    rows = np.array(expansion.temperature_change_K)
    strains = expansion.strain(np.concatenate((changes, rows[(rows > changes.min()) & (rows < changes.max())])))
    allowed = CHORD * (np.ptp(strains) or 1.0)
    found_times, found = [times[:1]], [changes[:1]]
    for start, end, first, last in zip(times, times[1:], changes, changes[1:]):
        between = rows[(rows > min(first, last)) & (rows < max(first, last))]
        marks = np.concatenate(([first], between if last > first else between[::-1], [last]))
        for one, other in zip(marks, marks[1:]):
            alpha = np.interp([one, other], rows, expansion.thermal_expansion_per_K)
            left_out = abs((alpha[1] - alpha[0]) * (other - one)) / 8  # error of a chord of a parabola
            pieces = max(1, int(np.ceil(np.sqrt(left_out / allowed))))
            passed = np.linspace(one, other, pieces + 1)[1:]
            found.append(passed)
            share = (passed - first) / (last - first) if last != first else np.ones(1)
            found_times.append(np.where(share < 1, start + share * (end - start), end))
    return np.concatenate(found_times), np.concatenate(found)
