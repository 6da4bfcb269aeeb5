# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure of a comparison of a ``truss`` case: loops of the nodes that move and jump most, joint forces."""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from statejump.kinds.truss.case import TrussCase
from statejump.kinds.spring_slider.figure import DEM, REDUCED, STYLE, plt, save
from statejump.kinds.truss.compare import jumps_m

if TYPE_CHECKING:
    from statejump.results.contents import Column, ModelRun

QUASI_STATIC = {**REDUCED, "label": "quasi-static solver", "linewidth": 3.6}
DEM_RUN = {**DEM, "linewidth": 1.1}


def _shown(case: TrussCase, run: "ModelRun") -> list[tuple[int, int]]:
    """Return node and axis of two components: the largest jump, then the largest motion of another node."""
    motion = np.ptp(run.history["displacement_m"].values, axis=0)
    jump = np.abs(jumps_m(run))
    first = np.unravel_index(np.argmax(jump if jump.max() > 1e-9 * motion.max() else motion), motion.shape)
    others = motion.copy()
    others[first[0]] = -1
    if others.max() < 0:
        return [(int(first[0]), int(first[1]))]
    # Of a row of nodes the neighbour would show the same: one that moves about half as much shows more.
    half = np.abs(others - 0.5 * motion.max())
    half[others <= 0.01 * motion.max()] = np.inf
    second = np.unravel_index(np.argmin(half), motion.shape)
    return [(int(first[0]), int(first[1])), (int(second[0]), int(second[1]))]


def figure(case: TrussCase, reduced: "ModelRun", dem: "ModelRun", folder: Path) -> list[Path]:
    """Write ``<case>.png`` and ``<case>.svg`` into the folder and return their paths."""
    shown = _shown(case, reduced)
    scale, unit = (1e3, "mm") if np.abs(reduced.history["displacement_m"].values).max() > 2e-3 else (1e6, "µm")
    link = int(np.argmax(np.ptp(reduced.links["axial_force_N"].values, axis=0)))
    with plt.rc_context(STYLE):
        drawing, panels = plt.subplots(2, 2, figsize=(9.5, 7.0), constrained_layout=True)
        for run, style in ((reduced, QUASI_STATIC), (dem, DEM_RUN)):
            change, time = run.history["temperature_change_K"].values, run.time_s
            for panel, (node, axis) in zip(panels[0], shown):
                panel.plot(change, run.history["displacement_m"].values[:, node, axis] * scale, **style)
            panels[1, 0].plot(change, run.links["axial_force_N"].values[:, link], **style)
            heat = run.energy["friction_dissipation_J"].values
            panels[1, 1].plot(time, (heat - heat[0]) * 1e3, **style)
        for panel, (node, axis) in zip(panels[0], shown):
            panel.set_xlabel("Temperature change [K]")
            panel.set_ylabel(f"Displacement of node {case.node[node].name} along {'xyz'[axis]} [{unit}]")
            _mark_jump(panel, reduced.history, node, axis, scale, unit)
        if len(shown) == 1:
            panels[0, 1].set_axis_off()
        panels[1, 0].set_xlabel("Temperature change [K]")
        panels[1, 0].set_ylabel(f"Axial force of {case.link[link].name}, compression positive [N]")
        panels[1, 1].set_xlabel("Time [s]")
        panels[1, 1].set_ylabel("Work of friction [mJ]")
        panels[0, 0].legend(loc="best", framealpha=1)
        drawing.suptitle(case.title, fontsize=11)
        return save(drawing, folder, case.name)


def _mark_jump(
    panel: plt.Axes, history: "dict[str, Column]", node: int, axis: int, scale: float, unit: str
) -> None:
    values = history["displacement_m"].values[:, node, axis] * scale
    panel.plot(history["temperature_change_K"].values[-1], values[-1], "s", color="#D55E00", markersize=5, zorder=6,
               label=f"state jump {values[-1] - values[0]:.4g} {unit}")
    panel.legend(loc="best", framealpha=1)
