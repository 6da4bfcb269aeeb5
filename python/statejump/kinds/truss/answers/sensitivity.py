# SPDX-License-Identifier: GPL-3.0-or-later
"""Sensitivities of the jump of an output to friction, clearances, stiffnesses and preloads: exact derivatives, compared
with central differences of paths, which show kinks nearby."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from statejump.core.engine_failures import EngineFailed
from statejump.core.errors import StatejumpError
from statejump.core.progress import OnProgress
from statejump.kinds.truss.answers.gradient import Gradient, RecordedPath
from statejump.kinds.truss.answers.jumps import quick_path
from statejump.kinds.truss.answers.outputs import Output
from statejump.kinds.truss.answers.parameters import changed, parameters, part_of
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath

STEP = 1e-2  # relative change of a parameter; the second difference uses half of this change
AGREE = 0.02  # allowed relative difference between the results of both changes
ROUNDING = 1e-10  # exact elasticity below which a parameter has no influence
NOISE = 1e-6  # fraction of the jump: error of a hundred events located to 1e-9 of a branch, with a margin


@dataclass(frozen=True)
class Sensitivity:
    """Derivative of the jump by the logarithm of a parameter: change of the jump per relative change of 1."""

    parameter: str  # "revolute.*.radial_clearance_m", "revolute.joint3.radial_clearance_m"
    items: int
    value: float | None  # None: the items differ
    per_relative_change: float  # in the output's unit
    half_step: float  # by differences; NaN: not computed
    verdict: str  # "smooth", "no influence", "one-sided", "steps disagree", "not differentiable", "failed: ..."

    @property
    def per_unit(self) -> float | None:
        """Change of the jump per unit of the parameter; None if the items have different values."""
        return None if self.value is None else self.per_relative_change / self.value


def histories_of(found: TrussPath) -> dict[tuple[str, str], list[str]]:
    """Return the sequence of statuses of every joint. The order in which different joints change within one increment
    is not defined."""
    histories: dict[tuple[str, str], list[str]] = {}
    for event in found.events:
        histories.setdefault((event.joint_kind, event.name), [event.before]).append(event.after)
    return histories


def sensitivities(
    found: TrussPath, output: Output, *, each: bool = False, step: float = STEP, increments: int = 50,
    on_progress: OnProgress = lambda share: None,
) -> list[Sensitivity]:
    """Return the sensitivities of an output's jump to all parameters. Parameters that are 0 or missing are omitted.

    The derivatives are exact where the engine can compute them, else central differences. With ``each`` they are those
    of single items, and differences are not computed beside exact derivatives. Otherwise a parameter is also changed by
    ±step and ±step/2 of its value, in all items of a section together. The verdict is "not differentiable" in two
    cases: the one-sided slopes differ by more than AGREE at both steps, or both steps disagree by more than AGREE and
    the sequence of statuses of a joint depends on the change. If they disagree for another reason, the verdict is
    "steps disagree". "one-sided": two joints change at once, so that the derivative holds for one sign of a change.
    """
    truss, own_jump = found.truss, output.jump(found)
    try:
        exact = Gradient(RecordedPath(truss, increments), output)
    except EngineFailed:
        exact = None
    rows: list[Sensitivity] = []
    asked = [(section, key, values, there) for section, key, values in parameters(truss)
             if (there := np.isfinite(values) & (values != 0)).any()]
    for place, (section, key, values, there) in enumerate(asked):
        by_items = None if exact is None else exact.by_parameter(section, key)
        groups = [("*", there)] if not each else [
            (part_of(truss, section).names[item], np.arange(len(values)) == item) for item in np.flatnonzero(there)]
        for name, which in groups:
            own = values[which]
            same = float(own[0]) if np.ptp(own) <= 1e-12 * abs(own[0]) else None
            label = f"{section}.{name}.{key}"
            if each and exact is not None and by_items is not None:
                slope = float(by_items.items[which][0])
                word = _word(slope, own_jump, exact.kinks)
                rows.append(Sensitivity(label, 1, same, slope, float("nan"), word))
                continue
            try:
                whole, half, word = differences(truss, section, key, which, output, own_jump, step)
            except StatejumpError as problem:
                whole, half, word = float("nan"), float("nan"), f"failed: {problem}"
            if by_items is not None:
                whole = by_items.total
                if word == "steps disagree":
                    word = _word(whole, own_jump, exact.kinks if exact else 0)
            rows.append(Sensitivity(label, len(own), same, whole, half, word))
        on_progress((place + 1) / len(asked))
    return rows


def _word(slope: float, jump: float, kinks: int) -> str:
    """Return the verdict on an exact derivative."""
    if abs(slope) <= ROUNDING * abs(jump):
        return "no influence"
    return "one-sided" if kinks else "smooth"


def differences(
    truss: ResolvedTruss, section: str, key: str, which: np.ndarray, output: Output, own_jump: float,
    step: float = STEP,
) -> tuple[float, float, str]:
    """Return the derivative of an output's jump by the logarithm of a parameter of some items, the same derivative with
    half the step, and the verdict, see :func:`sensitivities`.

    :raises StatejumpError: a changed truss has no quasi-static path
    """
    jumps: list[float] = []
    slopes, gaps, histories = [], [], []
    for size in (step, step / 2):
        pair = [quick_path(changed(truss, section, key, np.where(which, 1 + sign * size, 1.0)), cycle_ends_only=True)
                for sign in (1, -1)]
        values = [output.jump(one) for one in pair]
        jumps += values
        slopes.append((values[0] - values[1]) / (2 * size))
        gaps.append(abs(values[0] + values[1] - 2 * own_jump) / size)  # of the order of the step for a smooth function
        histories += [histories_of(one) for one in pair]
    whole, half = slopes
    largest = max(abs(whole), abs(half))
    noise = NOISE * max(abs(jump) for jump in jumps) / step
    # The slopes on both sides of a kink may cancel.
    if gaps[1] > max(AGREE * largest, 0.75 * gaps[0], noise):
        word = "not differentiable"
    elif largest <= noise:
        word = "no influence"
    elif abs(whole - half) <= AGREE * largest:
        word = "smooth"
    else:
        same = all(history == histories[0] for history in histories)
        word = "steps disagree" if same else "not differentiable"
    return whole, half, word
