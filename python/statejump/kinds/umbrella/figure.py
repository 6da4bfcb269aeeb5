# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure of a comparison of an ``umbrella`` case: the two models on top of each other."""
from __future__ import annotations

from pathlib import Path

import numpy as np

from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.core.history import History
from statejump.kinds.spring_slider.figure import DEM, REDUCED, STYLE, plt, save
from statejump.kinds.umbrella import reduced as model

REDUCED_RUN = {**REDUCED, "label": "reduced model", "linewidth": 3.2}
DEM_RUN = {**DEM, "linewidth": 1.0}


def figure(case: UmbrellaCase, reduced: History, dem: History, folder: Path) -> list[Path]:
    """Write ``<case>.png`` and ``<case>.svg`` into the folder and return their paths."""
    with plt.rc_context(STYLE):
        drawing, panels = plt.subplots(2, 2, figsize=(9.5, 7.4), constrained_layout=True)
        for history, style in ((reduced, REDUCED_RUN), (dem, DEM_RUN)):
            deflection = (history["theta2_rad"] - history["theta2_rad"][0]) * 1e3
            panels[0, 0].plot(history["time_s"], deflection, **style)
            panels[0, 1].plot(history["temperature_change_K"], deflection, **style)
            panels[1, 0].plot(
                history["eccentricity_x_m"] * 1e6, history["eccentricity_y_m"] * 1e6, **style
            )
            panels[1, 1].plot(history["time_s"], history["normal_force_N"], **style)
        for panel, abscissa in ((panels[0, 0], "Time [s]"), (panels[0, 1], "Temperature change [K]")):
            panel.set_xlabel(abscissa)
            panel.set_ylabel("Deflection of AB, θ2 − θ2(0) [mrad]")
        if not model.is_reproducible(case):
            _mark_chaos(panels[0, 0], reduced)
        _mark_quasi_static(panels[0, 1], case)
        _mark_play(panels[1, 0], case)
        panels[1, 1].set_xlabel("Time [s]")
        panels[1, 1].set_ylabel("Normal force at the samples [N]")
        panels[0, 0].legend(loc="best", framealpha=1)
        drawing.suptitle(case.title, fontsize=11)
        return save(drawing, folder, case.name)


def _mark_chaos(panel: plt.Axes, reduced: History) -> None:
    peak = int(np.argmax(np.abs(reduced["temperature_change_K"])))
    panel.axvspan(reduced["time_s"][peak], reduced["time_s"][-1], color="0.93", zorder=0, linewidth=0)
    panel.annotate("chaotic: no two codes\nagree point by point", (0.74, 0.02), xycoords="axes fraction",
                   ha="center", va="bottom", fontsize=8, color="0.25")


def _mark_quasi_static(panel: plt.Axes, case: UmbrellaCase) -> None:
    loop = model.quasi_static(case)
    if loop is None:
        return
    path = loop.columns()
    panel.plot(path["temperature_change_K"], (path["theta2_rad"] - path["theta2_rad"][0]) * 1e3,
               color="#0072B2", linewidth=1.4, linestyle=(0, (1, 1.5)), label="quasi-static, rigid links")
    panel.legend(loc="best", framealpha=1)


def _mark_play(panel: plt.Axes, case: UmbrellaCase) -> None:
    around = np.linspace(0, 2 * np.pi, 361)
    for change in {0.0, *case.temperature_range_K} if case.clearance_m(1.0) != case.clearance_m(0.0) else {0.0}:
        play = case.clearance_m(change) * 1e6
        panel.plot(play * np.cos(around), play * np.sin(around), color="0.55", linewidth=0.8)
    panel.set_aspect("equal")
    panel.set_xlabel("Journal − bearing centre, along AC [µm]")
    panel.set_ylabel("across AC [µm]")
