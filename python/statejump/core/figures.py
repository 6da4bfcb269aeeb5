# SPDX-License-Identifier: GPL-3.0-or-later
"""How figures look, how they are laid out, and how they are written; what is drawn is each kind's own.

Figures are made without pyplot, so that a caller's backend and its open figures are left alone.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from statejump.core.output import write_bytes
from statejump.kinds import require
from statejump.report.capabilities import RunSheet

if TYPE_CHECKING:
    from statejump.core.case import Case
    from statejump.core.run import Run

# Okabe-Ito colours, far apart in lightness as well: thick light line under a thin dark dashed one.
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
    """matplotlib's constrained layout, of which nothing is left in memory.

    Its grids refer to their children through arrays of objects, into which the garbage collector does not look, and the
    children refer back: two grids of each drawing would stay for ever.
    """

    def execute(self, fig: Figure) -> None:
        """Place the axes of a figure; the grids are taken apart."""
        for grid in (super().execute(fig) or {}).values():
            if isinstance(grid, _Grid):
                grid.children.fill(None)


class Drawing(Figure):
    """A figure that shows itself in a notebook."""

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
    """What a kind draws of its runs.

    :param panels: what draws each panel, row by row; None: left empty
    :param columns: panels in a row
    :param size: of the figure [inch]
    :param title: above all panels
    """

    panels: Sequence[Panel | None]
    columns: int
    size: tuple[float, float]
    title: str = ""


@contextmanager
def style() -> Iterator[None]:
    """Draw in the project's style inside of this."""
    with rc_context(STYLE):
        yield


def panels(rows: int, columns: int, size: tuple[float, float], **settings: Any) -> tuple[Figure, Any]:
    """Return a new figure and its axes; as ``pyplot.subplots``, without pyplot."""
    figure = Drawing(figsize=size, layout=Constrained())
    return figure, figure.subplots(rows, columns, **settings)


def drawn(case: Case, runs: Sequence[Run], axes: Axes | Sequence[Axes] | None = None) -> Figure:
    """Draw runs of a case on top of each other.

    :param axes: axes to draw into: they get the panels in their order; None: a new figure
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


def save(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write ``<name>.png`` and ``<name>.svg``, the same bytes every time, and return their paths."""
    written = []
    with style():
        for suffix, extra in ((".png", {"dpi": 160}), (".svg", {"metadata": {"Date": None}})):
            target = folder / f"{name}{suffix}"
            stream = BytesIO()
            figure.savefig(stream, format=suffix[1:], **extra)
            written.append(write_bytes(target, stream.getvalue()))
    return written
