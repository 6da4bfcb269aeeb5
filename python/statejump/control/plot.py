# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure of a control study: one panel per parameter."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from statejump.control.study import Study, Sweep
from statejump.core.figures import panels, save, style

OWN: dict[str, Any] = dict(color="0.45", linewidth=1.2, linestyle=":", label="value of the case")
WANTED: dict[str, Any] = dict(color="#D55E00", linewidth=1.4, linestyle=(0, (8, 2, 1, 2)), label="wanted")
RECOMMENDED: dict[str, Any] = dict(color="#009E73", linewidth=1.6, label="recommended")
FLOOR: dict[str, Any] = dict(color="0.3", linewidth=1.0, linestyle=(0, (1, 1)))
DEM: dict[str, Any] = dict(color="#000000", marker="D", markersize=6, markerfacecolor="white", linestyle="", zorder=6,
                           label="|jump| by DEM (YADE)")
NOTHING = 1e-4  # fraction of the jump that counts as zero; a joint without contact leaves 1e-12, which no axis can show


def figure(title: str, study: Study, folder: Path) -> list[Path]:
    """Write ``control.png`` and ``control.svg`` into the folder and return their paths."""
    count = len(study.sweeps)
    columns = 2 if count == 4 else min(count + 1, 3)
    rows = -(-count // columns)
    with style():
        size = (9.5 if columns == 2 else 12.0, 3.3 * rows + 0.6)
        drawing, grid = panels(rows, columns, size, sharey=True, squeeze=False)
        places = list(np.ravel(grid))
        handles: dict[str, Any] = {}
        for panel, sweep in zip(places, study.sweeps):
            _draw(panel, study, sweep)
            for line, label in zip(*panel.get_legend_handles_labels()):
                handles.setdefault(label, line)
        for panel in grid[:, 0]:
            panel.set_ylabel(study.quantity)
        for panel in places[count:]:
            panel.axis("off")
        if count < len(places):
            places[count].legend(handles.values(), handles.keys(), loc="center", framealpha=1, handlelength=3.4)
        else:
            # The legend is in the last panel: of four parameters, the clearance has the least effect.
            places[count - 1].legend(
                handles.values(), handles.keys(), loc="lower right" if count == 4 else "best", framealpha=1,
                handlelength=3.4, fontsize=8
            )
        drawing.suptitle(f"{title}: control of the state jump", fontsize=11)
        return save(drawing, folder, "control")


def _draw(panel: Axes, study: Study, sweep: Sweep) -> None:
    x = np.array([row.value for row in sweep.rows]) * sweep.display_scale
    logarithmic = study.logarithmic
    nothing = NOTHING * study.display_scale * max(study.jump, study.wanted or 0.0)
    for name, (label, line) in study.lines.items():
        if name not in study.results:
            continue
        y = sweep.column(name) * study.display_scale
        if logarithmic:
            y = np.where(y > nothing, y, np.nan)
        if np.isfinite(y).any():
            panel.plot(x, y, label=label, **line)
    if sweep.scale == "log":
        positive = np.abs(x[x != 0])
        if 0.0 in x:
            # Zero is at the left edge, one step before the first value.
            panel.set_xscale("symlog", linthresh=float(positive.min()), linscale=0.4)
            panel.set_xlim(left=-0.12 * float(positive.min()))
        else:
            panel.set_xscale("log")
    if logarithmic:
        panel.set_yscale("log")
    else:
        panel.set_ylim(bottom=0)
    panel.axvline(sweep.own * sweep.display_scale, **OWN)
    if study.floor is not None and study.floor[0] == sweep.parameter and study.floor[2]:
        panel.axhline(study.floor[2] * study.display_scale, label=study.floor[1], **FLOOR)
    if study.wanted is not None:
        panel.axhline(study.wanted * study.display_scale, **WANTED)
    if sweep.recommended is not None:
        panel.axvline(sweep.recommended * sweep.display_scale, **RECOMMENDED)
    points = [(row.value * sweep.display_scale, row.dem_jump * study.display_scale)
              for row in sweep.rows if row.dem_jump is not None]
    if points:
        panel.plot(*zip(*points), **DEM)
    unit = "" if sweep.display_unit == "-" else f" [{sweep.display_unit}]"
    panel.set_xlabel(f"{sweep.label}{unit}")
