# SPDX-License-Identifier: GPL-3.0-or-later
"""Capabilities of kinds to be shown: text, figures, parts of the page; see :mod:`statejump.kinds.protocol`."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from statejump.core.charts import Chart
from statejump.core.run import Event, Run
from statejump.core.tables import Shown
from statejump.kinds.protocol import capability

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from statejump.core.figures import Sheet
    from statejump.results.contents import Result


@capability("plot")
class RunSheet(Protocol):
    """Figure of one run, or of two on top of each other."""

    def sheet(self, case: Any, runs: Sequence[Run]) -> Sheet: ...


@capability("summary")
class RunText(Protocol):
    """What a command prints of runs, tables and lines."""

    def summary_lines(self, case: Any, runs: Mapping[str, Run]) -> list[Shown | str]: ...


@capability("describe")
class CaseText(Protocol):
    """The case in sentences."""

    def describe(self, case: Any) -> list[str]: ...


@capability("charts")
class PageCharts(Protocol):
    """Curves on the page of ``statejump report``."""

    def charts(self, case: Any) -> list[Chart]: ...


@capability("event reason")
class EventReasons(Protocol):
    """Why only one model has an event; "": it is not known."""

    def event_reason(self, case: Any, event: Event, model: str, runs: Mapping[str, Run]) -> str: ...


@capability("page")
class PagePart(Protocol):
    """A part of the page of ``statejump report`` that only this kind has; None: this result has none."""

    def page(self, result: Result, case: Any) -> Any: ...


@capability("truss draw")
class CaseDrawing(Protocol):
    """What the case says, drawn before anything is solved."""

    def draw(self, case: Any, axes: Axes | None = None, names: bool = False) -> Figure: ...
