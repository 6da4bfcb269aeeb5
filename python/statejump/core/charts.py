# SPDX-License-Identifier: GPL-3.0-or-later
"""What a kind of case adds to the page of ``statejump report``: its charts, and a section of its own."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

THIN = 0.05  # largest distance from a straight line, over the range, of a loop that looks like a line
ROUNDING = 1e-9  # fraction of its range below which a loop counts as zero


@dataclass(frozen=True)
class Axis:
    """An axis of a chart.

    :param column: name of the column, in the history or in the columns of the page section
    :param label: label of the axis; "": the kind's name for the column
    :param from_start: whether to show the change of the values since the first sample
    """

    column: str
    label: str = ""
    from_start: bool = False


@dataclass(frozen=True)
class Chart:
    """Curves of all models in one chart.

    :param equal: whether both axes have the same scale
    :param rings_m: radii of circles about the origin [m]
    :param stages: whether to shade the stages of the run along the time axis
    :param marks: whether to mark events and the state jump
    """

    x: Axis
    y: Axis
    title: str
    equal: bool = False
    rings_m: tuple[float, ...] = ()
    stages: bool = False
    marks: bool = False


TEMPERATURE = Axis("temperature_change_K", "Temperature change")
TIME = Axis("time_s", "Time")


class PageSection(Protocol):
    """The section of a run's page that only one kind of case has: the result of its capability ``page``.

    :param template: HTML template, in which the variable ``part`` is this object
    :param columns: data of the charts, by model and column name
    :param units: units of these data, by column name
    """

    template: Path
    columns: Mapping[str, Mapping[str, np.ndarray]]
    units: Mapping[str, str]

    @property
    def verdict(self) -> str:
        """The finding of the part, as a sentence; "": none."""

    def cards(self) -> list[dict[str, Any]]:
        """Return numbers for the top of the page: ``label`` and ``values``, which are pairs of a name and a text."""

    def charts(self) -> list[Chart]:
        """Return the charts of the page."""

    def payload(self, encoded: Callable[[np.ndarray], Any]) -> dict[str, Any]:
        """Return the data for the drawing of nodes and joints, ``Truss`` of web/src/payload.ts. ``encoded`` converts an
        array to the page's encoding."""


@dataclass(frozen=True)
class StraightPart:
    """The straight line that a loop follows."""

    slope: float
    offset: float

    def taken_off(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the remainder of values at x."""
        return np.asarray(y - (self.offset + self.slope * x))


def straight_part(x: np.ndarray, y: np.ndarray) -> StraightPart | None:
    """Return the least-squares straight line of a thin loop, its reversible part; None: no loop or a wide one."""
    size = float(np.ptp(y))
    if not 0 < size < np.inf or not 0 < np.ptp(x) < np.inf:
        return None
    try:
        slope, offset = np.polyfit(x, y, 1)
    except np.linalg.LinAlgError:  # squares of the numbers overflow
        return None
    line = StraightPart(float(slope), float(offset))
    largest = float(np.abs(line.taken_off(x, y)).max())
    return line if ROUNDING * size < largest < THIN * size else None
