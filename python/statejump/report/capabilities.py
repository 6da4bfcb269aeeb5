# SPDX-License-Identifier: GPL-3.0-or-later
"""Capabilities of kinds for their presentation: text, figures, page section; see :mod:`statejump.kinds.protocol`."""
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
    """Figure of one run, or of two in one figure."""

    def sheet(self, case: Any, runs: Sequence[Run]) -> Sheet: ...


@capability("summary")
class RunText(Protocol):
    """Printed tables and lines of runs."""

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
    """Reasons why only one of two models reports an event; "" if the reason is unknown."""

    def event_reason(self, case: Any, event: Event, model: str, runs: Mapping[str, Run]) -> str: ...


@capability("page")
class PagePart(Protocol):
    """The section of the page of ``statejump report`` that only this kind has; None: this result has none."""

    def page(self, result: Result, case: Any) -> Any: ...


@capability("truss draw")
class CaseDrawing(Protocol):
    """Drawing of a case that has not been solved."""

    def draw(self, case: Any, axes: Axes | None = None, names: bool = False) -> Figure: ...
