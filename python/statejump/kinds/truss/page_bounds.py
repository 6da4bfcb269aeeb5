# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of the state jump on the report page of a truss."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.core.figures import embedded
from statejump.core.units import text
from statejump.kinds.truss.bounds.figure import bars, coloured
from statejump.kinds.truss.bounds.result import NUMBERS, Bounds
from statejump.kinds.truss.bounds.study import bounds
from statejump.kinds.truss.case import TrussCase

MOST_JOINTS = 30  # of a truss whose bounds the page shows
MOST_CLEARANCES = 8  # joints with clearance, whose bounds take longer


@dataclass(frozen=True)
class PageBounds:
    """Bounds as sentences, rows and pictures; or the reason why there are none."""

    sentences: Sequence[str]
    rows: Sequence[dict[str, str]]
    pictures: Sequence[tuple[str, str]]  # alternative text, data URI


def page_bounds(case: TrussCase, displacement_m: np.ndarray) -> PageBounds | None:
    """Return the bounds of a truss; None: it has no friction joint, or is too large.

    :param displacement_m: of its run (samples, nodes, 3)
    """
    truss = case.resolve()
    joints = sum(len(joints.names) for section, joints in truss.joints.items() if section != "rigid")
    clearances = len(truss.revolutes.names) + len(truss.joints["ball_joint"].names)
    if not 0 < joints <= MOST_JOINTS or clearances > MOST_CLEARANCES:
        return None
    try:
        found = bounds(case, simulate=False)
    except StatejumpError as refused:
        return PageBounds([f"No bounds: {refused}."], [], [])
    seen = [replace(bound, simulated=bound.output.change(displacement_m[0], displacement_m[-1]))
            for bound in found.bounds]
    shown = replace(found, bounds=seen)
    sentences = [f"{found.guarantee}.", *(f"{fact}." for fact in found.facts),
                 f"{found.temperatures.text}: {found.verdict.text}."]
    return PageBounds([one[:1].upper() + one[1:] for one in sentences], [_row(bound) for bound in seen],
                      _pictures(shown))


def _row(bound: Any) -> dict[str, str]:
    unit = bound.output.unit
    found = {name: "–" if not np.isfinite(getattr(bound, name)) else text(getattr(bound, name), unit, 4)
             for name in NUMBERS}
    return {"output": bound.output.name, **found}


def _pictures(found: Bounds) -> list[tuple[str, str]]:
    if not found.bounds or not all(np.isfinite(bound.spread) for bound in found.bounds):
        return []
    name = found.truss.name
    return [(f"Bounds and simulated jumps of {name}", embedded(bars(name, found.bounds))),
            (f"{name}, joints coloured by their contribution to {found.bounds[0].output.name}",
             embedded(coloured(found.truss, found.joints, found.bounds[0])))]
