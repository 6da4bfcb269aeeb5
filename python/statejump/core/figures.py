# SPDX-License-Identifier: GPL-3.0-or-later
"""Style, layout and output of figures. Each kind draws its own content.

Figures are made without pyplot, so the caller's backend and open figures do not change.
"""
from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from statejump.core.case import Case
from statejump.core.output import write_bytes
from statejump.core.run import Run
from statejump.kinds import require
from statejump.report.capabilities import RunSheet

# Okabe-Ito colours that also differ in lightness: a thick light line under a thin dark dashed one.
REDUCED: dict[str, Any] = dict(color="#E69F00", linewidth=4.0, solid_capstyle="round", label="reduced model (exact)")
DEM: dict[str, Any] = dict(color="#000000", linewidth=1.2, linestyle=(0, (5, 2)), label="DEM (YADE)")
STYLE: dict[str, Any] = {
    "svg.hashsalt": "statejump", "font.size": 9, "axes.grid": True, "grid.color": "0.88", "axes.axisbelow": True,
    "svg.fonttype": "none",
}
# Draws one panel.
Panel = Callable[[Axes], None]


@runtime_checkable
class _Grid(Protocol):
    """A grid of matplotlib's layout, whose class is private."""

    children: np.ndarray


class Constrained(ConstrainedLayoutEngine):
    """matplotlib's constrained layout without its memory leak.

    matplotlib's layout grids refer to their children through object arrays, which the garbage collector does not
    follow, and the children refer back. Without this class two grids of each drawing would stay in memory.
    """

    def execute(self, fig: Figure) -> None:
        """Arrange the axes of a figure, and break the references between layout grids."""
        for grid in (super().execute(fig) or {}).values():
            if isinstance(grid, _Grid):
                grid.children.fill(None)


class Drawing(Figure):
    """A figure that a notebook displays."""

    def __init__(self, *arguments: Any, **settings: Any) -> None:
        super().__init__(*arguments, **settings)
        FigureCanvasAgg(self)

    def _repr_png_(self) -> bytes:
        stream = BytesIO()
        with style():
            self.savefig(stream, format="png", dpi=100)
        return stream.getvalue()


@dataclass(frozen=True)
class Sheet:
    """The drawing of runs by a kind.

    :param panels: functions that draw the panels, row by row; None: an empty panel
    :param columns: number of panels in a row
    :param size: width and height [inch]
    :param title: title of the figure
    """

    panels: Sequence[Panel | None]
    columns: int
    size: tuple[float, float]
    title: str = ""


@contextmanager
def style() -> Iterator[None]:
    """Use the project's style within this context."""
    with rc_context(STYLE):
        yield


def panels(rows: int, columns: int, size: tuple[float, float], **settings: Any) -> tuple[Figure, Any]:
    """Return a new figure and its axes, as ``pyplot.subplots``, without pyplot."""
    figure = Drawing(figsize=size, layout=Constrained())
    return figure, figure.subplots(rows, columns, **settings)


def drawn(case: Case, runs: Sequence[Run], axes: Axes | Sequence[Axes] | None = None) -> Figure:
    """Draw several runs of a case in one figure.

    :param axes: axes to draw into, one for each panel in order; None: a new figure
    :return: the figure
    """
    sheet: Sheet = require(case, RunSheet).sheet(case, runs)
    if axes is not None:
        given = [axes] if isinstance(axes, Axes) else list(np.ravel(np.asarray(axes, dtype=object)))
        for panel, place in zip((panel for panel in sheet.panels if panel is not None), given):
            panel(place)
        figure = given[0].figure
        assert isinstance(figure, Figure)
        return figure
    with style():
        rows = -(-len(sheet.panels) // sheet.columns)
        figure, places = panels(rows, sheet.columns, sheet.size, squeeze=False)
        for draw, place in zip(sheet.panels, places.flat):
            if draw is None:
                place.set_axis_off()
            else:
                draw(place)
        figure.suptitle(sheet.title, fontsize=11)
    return figure


def embedded(figure: Figure) -> str:
    """Return a figure as a data address of a picture."""
    stream = BytesIO()
    with style():
        figure.savefig(stream, format="png", dpi=160)
    return "data:image/png;base64," + b64encode(stream.getvalue()).decode("ascii")


def save(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write ``<name>.png`` and ``<name>.svg``, and return their paths. The same figure always gives the same bytes."""
    written = []
    with style():
        for suffix, extra in ((".png", {"dpi": 160}), (".svg", {"metadata": {"Date": None}})):
            target = folder / f"{name}{suffix}"
            stream = BytesIO()
            figure.savefig(stream, format=suffix[1:], **extra)
            written.append(write_bytes(target, stream.getvalue()))
    return written
