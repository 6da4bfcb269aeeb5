# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure of runs of a ``spring_slider`` case: models in one figure, with marked stages and events."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from statejump import _engine
from statejump.core.figures import DEM, REDUCED, Sheet, panels, style
from statejump.core.run import Run
from statejump.kinds.spring_slider import reduced
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.kinds.spring_slider.statics import RestSets, rest_sets

STAGE_NAMES = {"at_stop_plus": "stop", "at_stop_minus": "stop", "in_play": "play"}
STAGE_SHADES = {"S1": "0.94", "S2": "1.0", "S3": "0.94", "S4": "0.90", "S5": "1.0", "play": "0.97"}
STOP_SHADE = "0.82"
MOST_NAMED_CYCLES = 3  # with more cycles the names of stages would overlap


DENSE = 4001  # points of the exact path, in addition to its events
TEMPERATURES = 401  # of the picture of rest sets
QUANTITIES = (("displacement_m", 1e3, "Displacement of the slider [mm]"),
              ("axial_force_N", 1.0, "Axial force, compression positive [N]"))
ABSCISSAE = (("temperature_change_K", "Temperature change [K]"), ("time_s", "Time [s]"))


def sheet(case: SpringSliderCase, runs: Sequence[Run]) -> Sheet:
    """Return displacement and axial force over temperature and over time."""
    path = reduced.solve(case, reduced.sample_times(case))
    shown: list[tuple[Run | dict[str, np.ndarray], dict[str, Any]]] = []
    for run in runs:
        if run.model == "reduced":
            shown.append((_dense(path, run) if reduced.is_whole(case) else run, REDUCED))
        else:
            shown.append((run, DEM))
    exact = any(run.model == "reduced" for run in runs)

    def panel(quantity: int, abscissa: int) -> Any:
        column, scale, label = QUANTITIES[quantity]
        along, along_label = ABSCISSAE[abscissa]

        def draw(axes: Axes) -> None:
            for columns, line in shown:
                axes.plot(columns[along], columns[column] * scale, **line)
            axes.set_xlabel(along_label)
            axes.set_ylabel(label)
            if abscissa == 1:
                _mark_stages(axes, path)
            elif quantity == 0:
                if exact:
                    _mark_events(axes, path)
                    _mark_jump(axes, case, path)
                axes.legend(loc="upper left", framealpha=1)

        return draw

    return Sheet([panel(row, side) for row in (0, 1) for side in (0, 1)], 2, (9.5, 6.8), case.title)


def _dense(path: _engine.SpringSliderPath, run: Run) -> dict[str, np.ndarray]:
    """Return columns of the exact path, dense and with its corners."""
    times = np.linspace(0, run.time_s[-1], DENSE)
    return path.sample(np.unique(np.concatenate((times, [event.time_s for event in path.events]))))


def _mark_stages(panel: Axes, path: _engine.SpringSliderPath) -> None:
    """Shade the stages over time, and name those stages of the first cycle that are wide enough."""
    end = path.segments[-1].end_time_s
    spans: list[list[Any]] = []
    for segment in path.segments:
        name = STAGE_NAMES.get(segment.stage, segment.stage)
        if spans and spans[-1][0] == name and segment.start_time_s <= spans[-1][2]:
            spans[-1][2] = segment.end_time_s
        else:
            spans.append([name, segment.start_time_s, segment.end_time_s])
    for name, start, stop in spans:
        shade = STOP_SHADE if name == "stop" else STAGE_SHADES[name]
        panel.axvspan(start, stop, color=shade, zorder=0, linewidth=0)
    crowded = -1.0
    for name, start, stop in spans:
        if start >= path.program.period_s or path.program.cycles > MOST_NAMED_CYCLES:
            break
        middle = (start + stop) / 2
        raised = middle - crowded < 0.04 * end  # names above the axes, in two rows when close
        crowded = -1.0 if raised else middle
        panel.annotate(name, (middle, 1.06 if raised else 1.015),
                       xycoords=("data", "axes fraction"), ha="center", fontsize=8)
    panel.set_xlim(0, end)


def _mark_events(panel: Axes, path: _engine.SpringSliderPath) -> None:
    """Mark the events of the first cycle on the loop, with their temperatures."""
    labels = {"first_slip": ("first slip", (14, 0), "left"),
              "stop_reached": ("stop reached", (38, -34), "right"),
              "stop_left": ("stop left", (-12, 2), "right")}
    seen = set()
    for event in path.events:
        if event.kind in labels and event.kind not in seen:
            seen.add(event.kind)
            text, offset, side = labels[event.kind]
            point = (event.temperature_change_K, event.displacement_m * 1e3)
            panel.plot(*point, "o", color="#0072B2", markersize=5, zorder=5)
            panel.annotate(f"{text}\n{event.temperature_change_K:.2f} K", point, xytext=offset,
                           textcoords="offset points", fontsize=8,
                           ha=side, va="center")


def _mark_jump(panel: Axes, case: SpringSliderCase, path: _engine.SpringSliderPath) -> None:
    jump = path.state_jump_m if case.has_jump else 0.0
    if jump:
        last = path.segments[-1].end_displacement_m * 1e3
        panel.plot(0, last, "s", color="#D55E00", markersize=5, zorder=6)
        panel.annotate(f"state jump {jump * 1e6:.2f} µm", (0, last), xytext=(0.42, 0.3),
                       textcoords="axes fraction", fontsize=8, color="#A04000",
                       arrowprops={"arrowstyle": "->", "color": "#A04000", "shrinkB": 4,
                                   "connectionstyle": "arc3,rad=0.15"})


def drawn(found: RestSets, axes: Axes | None = None) -> Figure:
    """Draw the positions of the block over the temperature, into given axes or into a new figure."""
    with style():
        if axes is None:
            _, axes = panels(1, 1, (5.5, 4.2))
        dense = rest_sets(found.case, found.friction_force_N, TEMPERATURES).segments
        change = [part.temperature_change_K for part in dense]
        axes.fill_between(change, [part.from_m * 1e3 for part in dense], [part.to_m * 1e3 for part in dense],
                          color="#E69F00", alpha=0.6, linewidth=0, label="held by friction or a stop")
        for ends in ("from_m", "to_m"):  # at a stop the band shrinks to a line
            axes.plot(change, [getattr(part, ends) * 1e3 for part in dense], color="#E69F00", linewidth=2)
        axes.plot(change, [part.zero_force_m * 1e3 for part in dense], color="#000000", linewidth=1,
                  linestyle=(0, (5, 2)), label="no force")
        axes.set_xlabel("Temperature change [K]")
        axes.set_ylabel("Place of the slider [mm]")
        axes.legend(loc="best", framealpha=1)
    figure: Figure = axes.figure
    return figure
