# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure of runs of an ``umbrella`` case: all models in one figure."""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from statejump.core.figures import DEM, REDUCED, Panel, Sheet
from statejump.core.run import Run
from statejump.kinds.umbrella import reduced
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.compare import largest_temperature
from statejump.laws.curves import Joint, reduced_mass_kg

LINES = {"reduced": {**REDUCED, "label": "reduced model", "linewidth": 3.2}, "dem": {**DEM, "linewidth": 1.0}}
ALONG = {"time_s": "Time [s]", "temperature_change_K": "Temperature change [K]"}


def sheet(case: UmbrellaCase, runs: Sequence[Run]) -> Sheet:
    """Return the deflection over time and over temperature, the trajectory in the clearance, and the normal force."""

    def deflection(along: str) -> Panel:
        def draw(axes: Axes) -> None:
            for run in runs:
                axes.plot(run[along], (run["theta2_rad"] - run["theta2_rad"][0]) * 1e3, **LINES[run.model])
            axes.set_xlabel(ALONG[along])
            axes.set_ylabel("Deflection of AB, θ2 − θ2(0) [mrad]")
            if along == "time_s":
                if not case.is_reproducible:
                    _mark_chaos(axes, runs[0])
                axes.legend(loc="best", framealpha=1)
            else:
                _mark_quasi_static(axes, case)

        return draw

    def way(axes: Axes) -> None:
        for run in runs:
            axes.plot(run["eccentricity_x_m"] * 1e6, run["eccentricity_y_m"] * 1e6, **LINES[run.model])
        _mark_play(axes, case)

    def force(axes: Axes) -> None:
        for run in runs:
            axes.plot(run["time_s"], run["normal_force_N"], **LINES[run.model])
        axes.set_xlabel("Time [s]")
        axes.set_ylabel("Normal force at the samples [N]")

    return Sheet([deflection("time_s"), deflection("temperature_change_K"), way, force], 2, (9.5, 7.4), case.title)


def _mark_chaos(panel: Axes, run: Run) -> None:
    panel.axvspan(run["time_s"][largest_temperature(run)], run["time_s"][-1], color="0.93", zorder=0, linewidth=0)
    panel.annotate("chaotic: no two codes\nagree point by point", (0.74, 0.02), xycoords="axes fraction",
                   ha="center", va="bottom", fontsize=8, color="0.25")


def _mark_quasi_static(panel: Axes, case: UmbrellaCase) -> None:
    loop = reduced.quasi_static(case)
    if loop is None:
        return
    path = loop.columns()
    panel.plot(path["temperature_change_K"], (path["theta2_rad"] - path["theta2_rad"][0]) * 1e3,
               color="#0072B2", linewidth=1.4, linestyle=(0, (1, 1.5)), label="quasi-static, rigid links")
    panel.legend(loc="best", framealpha=1)


def _mark_play(panel: Axes, case: UmbrellaCase) -> None:
    around = np.linspace(0, 2 * np.pi, 361)
    for change in {0.0, *case.temperature_range_K} if case.clearance_m(1.0) != case.clearance_m(0.0) else {0.0}:
        play = case.clearance_m(change) * 1e6
        panel.plot(play * np.cos(around), play * np.sin(around), color="0.55", linewidth=0.8)
    panel.set_aspect("equal")
    panel.set_xlabel("Journal − bearing centre, along AC [µm]")
    panel.set_ylabel("across AC [µm]")


def joint(case: UmbrellaCase) -> Joint:
    """Return the joint of a case."""
    return Joint(
        case.title, case.joint.journal_radius_m, case.bearing_radius_m, case.joint.contact_length_m,
        case.effective_young_modulus_Pa, reduced_mass_kg(case.link_ab.mass_kg, case.link_bc.mass_kg),
    )
