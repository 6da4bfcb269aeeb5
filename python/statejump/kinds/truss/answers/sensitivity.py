# SPDX-License-Identifier: GPL-3.0-or-later
"""Sensitivities of the jump of an output to friction, clearances, stiffnesses and preloads, by central differences."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.core.progress import OnProgress
from statejump.kinds.truss.answers.jumps import quick_path
from statejump.kinds.truss.answers.outputs import Output
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath

STEP = 1e-2  # relative change of a parameter; the second difference uses half of this change
AGREE = 0.02  # allowed relative difference between the results of both changes
NOISE = 1e-6  # fraction of the jump: error of a hundred events located to 1e-9 of a branch, with a margin


@dataclass(frozen=True)
class Sensitivity:
    """Derivative of the jump by the logarithm of a parameter: change of the jump per relative change of 1."""

    parameter: str  # "revolute.*.radial_clearance_m", "revolute.joint3.radial_clearance_m"
    items: int
    value: float | None  # None: the items differ
    per_relative_change: float  # in the output's unit
    half_step: float
    verdict: str  # "smooth", "no influence", "steps disagree", "not differentiable", "failed: ..."

    @property
    def per_unit(self) -> float | None:
        """Change of the jump per unit of the parameter; None if the items have different values."""
        return None if self.value is None else self.per_relative_change / self.value


def parameters(truss: ResolvedTruss) -> list[tuple[str, str, np.ndarray]]:
    """Return section, key and values (items,) of every parameter that may affect a jump."""
    found = [(joint.section, key, values) for joint in JOINTS
             for key, values in joint.parameters(truss.joints[joint.section])]
    found += [("link", key, getattr(truss.links, key)) for key in ("young_modulus_Pa", "cross_section_area_m2")]
    return found + [(element.section, key, getattr(truss.elements[element.section], key)) for element in ELEMENTS
                    for key in element.varied]


def _part(truss: ResolvedTruss, section: str) -> Any:
    """Return the arrays of a section."""
    return {**truss.joints, **truss.elements, "link": truss.links}[section]


def changed(truss: ResolvedTruss, section: str, key: str, factor: np.ndarray) -> ResolvedTruss:
    """Return the truss with one parameter of every item multiplied by a factor (items,)."""
    part = _part(truss, section)
    part = replace(part, **{key: getattr(part, key) * factor})
    for element in ELEMENTS:
        if element.section == section:
            return truss.with_elements(**{section: element.changed(truss, part)})
    return truss.with_joints(**{section: part}) if section in truss.joints else replace(truss, links=part)


def histories_of(found: TrussPath) -> dict[tuple[str, str], list[str]]:
    """Return the sequence of statuses of every joint. The order in which different joints change within one increment
    is not defined."""
    histories: dict[tuple[str, str], list[str]] = {}
    for event in found.events:
        histories.setdefault((event.joint_kind, event.name), [event.before]).append(event.after)
    return histories


def sensitivities(
    found: TrussPath, output: Output, *, each: bool = False, step: float = STEP,
    on_progress: OnProgress = lambda share: None,
) -> list[Sensitivity]:
    """Return the sensitivities of an output's jump to all parameters. Parameters that are 0 or missing are omitted.

    A parameter is changed by ±step and ±step/2 of its value, in all items of a section together or, with ``each``, one
    by one. Both steps disagree if their slopes differ by more than AGREE. The verdict is "not differentiable" in two
    cases: the one-sided slopes differ by more than AGREE at both steps, or both steps disagree and the sequence of
    statuses of a joint depends on the change. If they disagree for another reason, the verdict is "steps disagree".
    """
    truss, own_jump = found.truss, output.jump(found)
    asked: list[tuple[str, str, str, np.ndarray, np.ndarray]] = []
    for section, key, values in parameters(truss):
        there = np.isfinite(values) & (values != 0)
        if not there.any():
            continue
        if not each:
            asked.append((section, key, "*", there, values))
            continue
        for index in np.flatnonzero(there):
            asked.append((section, key, _part(truss, section).names[index], np.arange(len(values)) == index, values))
    rows = []
    for place, (section, key, name, which, values) in enumerate(asked):
        own = values[which]
        same = float(own[0]) if np.ptp(own) <= 1e-12 * abs(own[0]) else None
        label = f"{section}.{name}.{key}"
        try:
            found_of = differences(truss, section, key, which, output, own_jump, step)
            rows.append(Sensitivity(label, len(own), same, *found_of))
        except StatejumpError as problem:
            rows.append(Sensitivity(label, len(own), same, float("nan"), float("nan"), f"failed: {problem}"))
        on_progress((place + 1) / len(asked))
    return rows


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
