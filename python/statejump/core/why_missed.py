# SPDX-License-Identifier: GPL-3.0-or-later
"""Possible reasons why the difference of two models exceeds a tolerance: sentences that name the keys to set."""
from __future__ import annotations

from math import ceil, floor, inf, isinf, log10, pi, sqrt

import numpy as np

from statejump import _engine
from statejump.core.notes import Note
from statejump.core.run import Run
from statejump.core.thermal import LONGEST_PERIOD_S, Thermal, range_K
from statejump.core.units import text

LOOKED_AT = 4000  # number of points of a cycle at which dΔT/dt is evaluated
# Fraction of a tolerance above which an oscillation is reported as a cause.
SHARE_TOLD = 0.1


def kink(program: _engine.ThermalProgram) -> float:
    """Return the largest jump of dΔT/dt in a cycle, times the duration of the cycle, over the range of ΔT [-]: 4 for a
    triangle, π for half a sine. A part that follows ΔT changes its speed by this number of ranges per cycle."""
    times = np.linspace(-1.5 / LOOKED_AT, 1, LOOKED_AT) * program.period_s
    rates = program.temperature_rate(times) * (times >= 0)
    size = float(np.ptp(program.temperature_change(times)))
    return float(np.abs(np.diff(rates)).max()) * program.period_s / size if size else 0.0


def heated_too_fast(
    natural_period_s: float, thermal: Thermal, program: _engine.ThermalProgram, moved_m: float, allowed_m: float
) -> list[str]:
    """Return the sentence that corners of the temperature excite oscillations, if these may matter.

    A part that follows the temperature quasi-statically would change its speed at once. An oscillator of period T
    instead swings by (change of speed) · T/2π.

    :param moved_m: motion of the parts over the temperature range [m]
    :param allowed_m: largest allowed difference of the models [m]
    """
    if isinf(natural_period_s):
        return [Note("friction_without_period")]
    swing = moved_m * kink(program) / program.period_s * natural_period_s / (2 * pi)
    if swing <= SHARE_TOLD * allowed_m or not allowed_m > 0 or range_K(thermal)[0] == range_K(thermal)[1]:
        return []
    enough = program.period_s * max(swing / (SHARE_TOLD * allowed_m), 1.0)
    if not enough < LONGEST_PERIOD_S:
        enough = inf
        remedy = f"no thermal.period_s up to {LONGEST_PERIOD_S:g} s is long enough; raise the damping ratios in [dem]"
    else:
        enough = min(rounded_up(enough), LONGEST_PERIOD_S)
        which = f"a table that lasts {enough:g} s" if thermal.shape == "table" else f"thermal.period_s = {enough:g}"
        remedy = f"{which} is long enough even so; or raise the damping ratios in [dem]"
    return [Note("heated_too_fast", natural_period=text(natural_period_s, "s", 3), swing=text(swing, "m", 2),
                 share=natural_period_s / program.period_s, allowed=text(allowed_m, "m", 2), remedy=remedy,
                 natural_period_s=natural_period_s, swing_m=swing, enough_s=enough)]


def still_moving(dem: Run, mass_kg: float, natural_period_s: float, allowed_m: float) -> list[str]:
    """Return the sentence that a DEM run still has kinetic energy at its end, if this energy may matter."""
    kinetic = float(dem["kinetic_energy_J"][-1])
    swing = inf if isinf(natural_period_s) else sqrt(2 * max(kinetic, 0.0) / mass_kg) * natural_period_s / (2 * pi)
    if not kinetic > 0 or not swing > SHARE_TOLD * allowed_m:
        return []
    longer = ", or set a longer thermal.period_s" if float(dem.time_s[-1]) < LONGEST_PERIOD_S else ""
    return [Note("still_moving", energy=text(kinetic, "J", 2), longer=longer, energy_J=kinetic)]


def rounded_up(value: float) -> float:
    """Return the next larger number with one digit."""
    power = 10.0 ** floor(log10(value))
    return float(f"{ceil(value / power * (1 - 1e-9)) * power:.1g}")
