# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure of a comparison: the two models on top of each other, stages marked."""
from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from statejump import _engine  # noqa: E402
from statejump.kinds.spring_slider import reduced  # noqa: E402
from statejump.kinds.spring_slider.case import SpringSliderCase  # noqa: E402
from statejump.core.history import History  # noqa: E402
from statejump.core.output import replacing  # noqa: E402

# Okabe-Ito colours, far apart in lightness as well: thick light line under a thin dark dashed one.
REDUCED = dict(color="#E69F00", linewidth=4.0, solid_capstyle="round", label="reduced model (exact)")
DEM = dict(color="#000000", linewidth=1.2, linestyle=(0, (5, 2)), label="DEM (YADE)")
STAGE_NAMES = {"at_stop_plus": "stop", "at_stop_minus": "stop"}
STAGE_SHADES = {"S1": "0.94", "S2": "1.0", "S3": "0.94", "S4": "0.90", "S5": "1.0"}
STOP_SHADE = "0.82"
STYLE = {"svg.hashsalt": "statejump", "font.size": 9, "axes.grid": True, "grid.color": "0.88",
         "axes.axisbelow": True, "svg.fonttype": "none"}
MOST_NAMED_CYCLES = 3  # beyond it names of stages would cover each other


def figure(case: SpringSliderCase, path: _engine.SpringSliderPath, dem: History, folder: Path) -> list[Path]:
    """Write ``<case>.png`` and ``<case>.svg`` into the folder and return their paths."""
    dense = np.linspace(0, dem["time_s"][-1], 4001)
    event_times = [event.time_s for event in path.events]
    exact = reduced.sample(path, np.unique(np.concatenate((dense, event_times))))
    quantities = (("displacement_m", 1e3, "Displacement of the slider [mm]"),
                  ("axial_force_N", 1.0, "Axial force, compression positive [N]"))
    axes_of = (("temperature_change_K", "Temperature change [K]"), ("time_s", "Time [s]"))
    with plt.rc_context(STYLE):
        drawing, panels = plt.subplots(2, 2, figsize=(9.5, 6.8), constrained_layout=True)
        for row, (column, scale, label) in enumerate(quantities):
            for side, (abscissa, abscissa_label) in enumerate(axes_of):
                panel = panels[row, side]
                panel.plot(exact[abscissa], exact[column] * scale, **REDUCED)
                panel.plot(dem[abscissa], dem[column] * scale, **DEM)
                panel.set_xlabel(abscissa_label)
                panel.set_ylabel(label)
        _mark_stages(panels[:, 1], path)
        _mark_events(panels[0, 0], path)
        _mark_jump(panels[0, 0], path)
        panels[0, 0].legend(loc="upper left", framealpha=1)
        drawing.suptitle(case.title, fontsize=11)
        return save(drawing, folder, case.name)


def save(drawing: plt.Figure, folder: Path, name: str) -> list[Path]:
    """Write ``<name>.png`` and ``<name>.svg``, the same bytes every time; close the drawing."""
    written = []
    for suffix, extra in ((".png", {"dpi": 160}), (".svg", {"metadata": {"Date": None}})):
        target = folder / f"{name}{suffix}"
        with replacing(target) as aside:
            drawing.savefig(aside, **extra)
        written.append(target)
    plt.close(drawing)
    return written


def _mark_stages(panels: np.ndarray, path: _engine.SpringSliderPath) -> None:
    """Shade the stages over time; name them in the first cycle when they are wide enough."""
    end = path.segments[-1].end_time_s
    spans: list[list] = []
    for segment in path.segments:
        name = STAGE_NAMES.get(segment.stage, segment.stage)
        if spans and spans[-1][0] == name and segment.start_time_s <= spans[-1][2]:
            spans[-1][2] = segment.end_time_s
        else:
            spans.append([name, segment.start_time_s, segment.end_time_s])
    for panel in panels:
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


def _mark_events(panel: plt.Axes, path: _engine.SpringSliderPath) -> None:
    """Points at the first cycle's events on the loop, with their temperatures."""
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


def _mark_jump(panel: plt.Axes, path: _engine.SpringSliderPath) -> None:
    jump = path.state_jump_m
    if jump:
        last = path.segments[-1].end_displacement_m * 1e3
        panel.plot(0, last, "s", color="#D55E00", markersize=5, zorder=6)
        panel.annotate(f"state jump {jump * 1e6:.2f} µm", (0, last), xytext=(0.42, 0.3),
                       textcoords="axes fraction", fontsize=8, color="#A04000",
                       arrowprops={"arrowstyle": "->", "color": "#A04000", "shrinkB": 4,
                                   "connectionstyle": "arc3,rad=0.15"})
