# SPDX-License-Identifier: GPL-3.0-or-later
"""Prediction of another test of an identified joint: force and energy loss, with intervals of the measured misfit.

The misfit of the formula is known from the identified loop only. Cycles of this loop have relative errors of their
energy loss, with mean ē and standard deviation s over C cycles. The loss of another test has the error
sqrt(ē² + s² (1 + 1/C)), times the quantile of Student's distribution with C - 1 degrees of freedom: cycles of the other
test may change together. The error of a row is the quantile of the residuals, widened from the spread of C known cycles
to that of another cycle.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm
from scipy.stats import t as student

from statejump.core.tables import Shown, write_columns
from statejump.identification.hysteresis import remembered
from statejump.identification.loop import Loop
from statejump.identification.noise import FEWEST_CYCLES, cycles_of

if TYPE_CHECKING:
    from statejump.identification.result import Identification


@dataclass(frozen=True)
class Prediction:
    """Prediction of the force along another path, and of the energy loss.

    :param force: force in every row [N or N m]
    :param force_error: half of the width of the interval of a single row
    :param loss_J: work along the path [J]
    :param loss_error_J: half of the width of its interval [J]
    """

    force: np.ndarray
    force_error: float
    loss_J: float
    loss_error_J: float

    def contains(self, force: np.ndarray) -> float:
        """Return the fraction of the rows of a measured force that are within their intervals."""
        return float(np.mean(np.abs(force - self.force) <= self.force_error))


def compared(found: Identification, other: Loop) -> Shown:
    """Return the table that compares the prediction of an identified joint with another test of it."""
    prediction = predicted(found, other.displacement)
    loss, low, high = prediction.loss_J, prediction.loss_J - prediction.loss_error_J, (
        prediction.loss_J + prediction.loss_error_J)
    measured = work(other.force, other.displacement)
    level, unit = f"{100 * found.confidence:g} %", other.unit("force")
    rms = float(np.sqrt(np.mean((other.force - prediction.force)**2)))
    rows = [("energy loss", "J", f"{measured:.4g}", f"{loss:.4g}", f"{low:.4g}", f"{high:.4g}",
             "inside" if low <= measured <= high else "outside"),
            (f"rows within ±{prediction.force_error:.3g} {unit}", "%",
             f"{100 * prediction.contains(other.force):.1f}", f"{100 * found.confidence:g}", "-", "-", "-"),
            ("rms difference of the force", unit, f"{rms:.4g}", "-", "-", "-", "-")]
    return Shown(f"prediction of {other.name}", ("quantity", "unit", "measured", "predicted", f"{level} from", "to",
                                                 "measured is"), rows, left=("quantity", "unit", "measured is"))


def write_prediction(found: Identification, other: Loop, path: Path) -> Path:
    """Write measured and predicted force of another test, with the interval of every row; return the path."""
    made = predicted(found, other.displacement)
    names = ("rotation_rad", "moment_N_m", "predicted_moment_N_m", "low_N_m", "high_N_m") if other.angular else (
        "displacement_m", "force_N", "predicted_force_N", "low_N", "high_N")
    write_columns(dict(zip(names, (other.displacement, other.force, made.force, made.force - made.force_error,
                                   made.force + made.force_error))), path)
    return path


def work(force: np.ndarray, displacement: np.ndarray) -> float:
    """Return the work along a path."""
    return float(np.sum((force[1:] + force[:-1]) * np.diff(displacement)) / 2)


def predicted(found: Identification, displacement: np.ndarray) -> Prediction:
    """Return the prediction of an identified joint along another path, with intervals at its level of confidence."""
    path = np.asarray(displacement, dtype=float)
    model, fresh = found.fit.model, found.loop.start == "fresh"
    force = np.asarray(model.answer(found.values, path, remembered(path, fresh)))
    fitted = found.answer()
    error = float(np.quantile(np.abs(found.loop.force - fitted), found.confidence))
    loss, cycles = work(force, path), _cycles(found)
    if cycles is None:
        return Prediction(force, error, loss, abs(loss) * _friction_error(found))
    # The quantile contains the spread of the identified cycles; a further cycle has a wider one.
    normal = float(norm.ppf((1 + found.confidence) / 2))
    more = max(0.0, (cycles.level**2 * (1 + 1 / cycles.count) - normal**2)) * cycles.spread**2
    error = sqrt(error**2 + more * float(np.mean(fitted**2)))
    return Prediction(force, error, loss, abs(loss) * cycles.level * sqrt(
        cycles.mean**2 + cycles.spread**2 * (1 + 1 / cycles.count)))


@dataclass(frozen=True)
class _Cycles:
    """Relative errors of the energy loss of the identified cycles.

    :param level: quantile of Student's distribution
    """

    mean: float
    spread: float
    count: int
    level: float


def _cycles(found: Identification) -> _Cycles | None:
    """Return the errors of the identified cycles; None if there are too few."""
    path, measured, fitted = found.loop.displacement, found.loop.force, found.answer()
    cycles = cycles_of(path)
    losses = []
    for cycle in range(int(cycles[-1]) + 1):
        rows = np.flatnonzero(cycles == cycle)
        rows = np.append(rows, rows[-1] + 1) if rows[-1] + 1 < len(path) else rows
        losses.append((work(measured[rows], path[rows]), work(fitted[rows], path[rows])))
    both = np.array(losses)
    whole = both[both[:, 1] > 0.5 * np.median(both[:, 1])]  # the path may begin and end within a cycle
    if len(whole) < FEWEST_CYCLES:
        return None
    relative = whole[:, 0] / whole[:, 1] - 1
    return _Cycles(float(np.mean(relative)), float(np.std(relative, ddof=1)), len(relative),
                   float(student.ppf((1 + found.confidence) / 2, len(relative) - 1)))


def _friction_error(found: Identification) -> float:
    """Return the relative error of the loss of a loop with too few cycles: misfit of its own loss, and friction."""
    path, measured, fitted = found.loop.displacement, found.loop.force, found.answer()
    own = abs(work(measured, path) / work(fitted, path) - 1) if work(fitted, path) else 0.0
    friction = found.intervals.get("friction")
    if friction is None or not friction.bounded:
        return own
    return sqrt(own**2 + ((friction.high - friction.low) / 2 / found.values["friction"])**2)
