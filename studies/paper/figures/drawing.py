# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 13 to 16, drawn."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from statejump.core.figures import panels as new_panels, save, style
from statejump.core.run import Run
from studies.paper import ensembles
from studies.paper.figures.closed_forms import (
    CIRCLE, closed_form_first_contact, envelope, quasi_static, static_deflection, static_deflection_elastic,
)
from studies.paper.figures.files import TABLE_POINTS, thin
from studies.paper.figures.runs import Study, Variant, single_deflection

CURVE_POINTS = 1000  # of a single run in a figure

Line = dict[str, Any]
# Okabe-Ito colours that also differ in lightness, width or dashes.
BAND: Line = {"color": "#56B4E9", "alpha": 0.4, "linewidth": 0, "label": "reduced, ensemble: mean ± sd"}
MEAN: Line = {"color": "#0072B2", "linewidth": 2.6, "label": "reduced, ensemble: mean"}
SINGLE: Line = {"color": "#E69F00", "linewidth": 1.6, "label": "reduced, single run"}
DEM: Line = {"color": "#000000", "linewidth": 0.9, "linestyle": (0, (5, 2)), "label": "DEM (YADE), single run"}
CONTACT: Line = {"color": "#D55E00", "linewidth": 1.2, "linestyle": (0, (1, 1.5)),
                 "label": "first contact, c/(α |AC|)"}
STATIC: Line = {"color": "#009E73", "linewidth": 4.2, "alpha": 0.5, "label": "quasi-static, frictionless"}
LIMITS: Line = {"color": "0.6", "linewidth": 0.9, "label": "all that the play allows"}

SUMMARIES: dict[str, tuple[str, str, Callable[[np.ndarray], np.ndarray]]] = {
    "largest": ("largest deflection of the cycle", "Largest |θ2 − θ2(0)| [mrad]",
                lambda deflection: np.abs(deflection).max(axis=1)),
    "range": ("range of the cycle", "Largest less smallest θ2 [mrad]", lambda deflection: np.ptp(deflection, axis=1)),
}


def figure_of(study: Study, variants: Sequence[Variant], title: str, folder: Path) -> list[Path]:
    """Write a figure of small multiples and its summary; return the paths of the files."""
    used = len(variants) + len(study.summaries)
    columns = max(3, -(-used // 2))
    with style():
        drawing, grid = new_panels(2, columns, (3.6 * columns + 0.6, 7.6))
        panels = list(grid.flat)
        for panel, variant in zip(panels, variants):
            _draw_curves(panel, variant)
            panel.set_title(study.panel.format(variant.value * study.scale), fontsize=9)
        low, high = _common_range(variants)
        for place, (panel, variant) in enumerate(zip(panels, variants)):
            panel.set_ylim(low * 1e3, high * 1e3)
            panel.set_xlim(variant.ensemble.time_s[0], variant.ensemble.time_s[-1])
            panel.set_xlabel("Time [s]")
            if place % columns == 0:
                panel.set_ylabel("Deflection of AB, θ2 − θ2(0) [mrad]")
            _temperature_scale(panel, variant.ensemble, labelled=place < columns)
        for panel, name in zip(panels[len(variants):], study.summaries):
            _draw_summary(panel, name, study, variants)
        entries: dict[str, Any] = {}
        for panel in panels[:used]:
            entries.update({label: line for line, label in zip(*panel.get_legend_handles_labels())
                            if label not in entries})
        empty = panels[used:]
        for panel in empty:
            panel.axis("off")
        if empty:
            empty[0].legend(entries.values(), entries.keys(), loc="center", frameon=False)
        else:
            _legend_below(drawing, entries)
        drawing.suptitle(f"{title}: {study.title}", fontsize=11)
        return save(drawing, folder, study.figure)


def _draw_curves(panel: Axes, variant: Variant) -> None:
    ensemble = variant.ensemble
    coarse = thin(len(ensemble.time_s), TABLE_POINTS)
    time, change = ensemble.time_s[coarse], ensemble.temperature_change_K[coarse]
    theta2 = variant.case.theta2_rad
    for side, limit in enumerate(envelope(variant.case, change)):
        panel.plot(time, (limit - theta2) * 1e3, **{**LIMITS, **({"label": "_"} if side else {})})
    deflection = ensemble.deflection_rad[:, coarse] * 1e3
    mean, spread = deflection.mean(axis=0), deflection.std(axis=0)
    panel.fill_between(time, mean - spread, mean + spread, **BAND)
    path = quasi_static(variant.case, change)
    if path is not None:
        panel.plot(time, path * 1e3, **STATIC)
    panel.plot(time, mean, **MEAN)
    for run, line in ((variant.reduced, SINGLE), (variant.dem, DEM)):
        fine = thin(len(run), CURVE_POINTS)
        panel.plot(run["time_s"][fine], single_deflection(run)[fine] * 1e3, **line)
    contact = closed_form_first_contact(variant.case)
    if contact is not None and contact <= np.max(change):
        reached = np.argmax(ensemble.temperature_change_K >= contact)
        panel.axvline(ensemble.time_s[reached], **CONTACT)
        panel.annotate(f"{contact:.1f} K", (ensemble.time_s[reached], 0.03), xycoords=("data", "axes fraction"),
                       xytext=(4, 0), textcoords="offset points", fontsize=8, color="#A04000",
                       bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8})


def _temperature_scale(panel: Axes, ensemble: ensembles.EnsembleOfRuns, labelled: bool) -> None:
    above = panel.twiny()
    above.set_xlim(panel.get_xlim())
    ticks = np.linspace(ensemble.time_s[0], ensemble.time_s[-1], 5)
    above.set_xticks(ticks)
    above.set_xticklabels([f"{np.interp(t, ensemble.time_s, ensemble.temperature_change_K):.0f}" for t in ticks],
                          fontsize=8)
    above.tick_params(length=2, pad=1)
    above.grid(False)
    if labelled:
        above.set_xlabel("Temperature change [K]", fontsize=8)


def _draw_summary(panel: Axes, name: str, study: Study, variants: Sequence[Variant]) -> None:
    title, label, quantity = SUMMARIES[name]
    places = np.arange(len(variants))
    values = [quantity(variant.ensemble.deflection_rad) * 1e3 for variant in variants]
    panel.errorbar(places, [np.mean(v) for v in values], [np.std(v) for v in values], fmt="o", color="#0072B2",
                   capsize=4, markersize=5, label="reduced, ensemble: mean ± sd")
    for kind, marker, line in (("reduced", "D", SINGLE), ("dem", "x", DEM)):
        runs = [quantity(single_deflection(getattr(v, kind))[None, :])[0] * 1e3 for v in variants]
        panel.plot(places + (0.16 if kind == "dem" else -0.16), runs, marker, color=line["color"], markersize=5,
                   label=line["label"])
    if name == "largest":
        _mark_static(panel, places, variants)
    panel.set_xticks(places)
    panel.set_xticklabels([f"{v.value * study.scale:g}" for v in variants])
    panel.set_xlim(-0.5, len(variants) - 0.5)
    if panel.get_ylim()[0] < 0.5 * panel.get_ylim()[1]:
        panel.set_ylim(bottom=0)
    panel.grid(axis="x", visible=False)
    panel.set_xlabel(study.label)
    panel.set_ylabel(label)
    panel.set_title(title, fontsize=9)


def _mark_static(panel: Axes, places: np.ndarray, variants: Sequence[Variant]) -> None:
    warmest = [v.ensemble.temperature_change_K.max() for v in variants]
    static = [
        static_deflection_elastic(v.case, change) if v.case.torsion_spring.bias_rad == 0 else None
        for v, change in zip(variants, warmest)
    ]
    if any(value is not None for value in static):
        rigid = static_deflection(variants[0].case, warmest[0]) or 0.0  # a rigid solution exists if an elastic one does
        panel.axhline(abs(rigid) * 1e3, color=STATIC["color"], linewidth=1.4,
                      label="static at ΔTmax, rigid links")
        panel.plot(places, [np.nan if value is None else abs(value) * 1e3 for value in static], "s",
                   color=STATIC["color"], markersize=4, markerfacecolor="white",
                   label="static at ΔTmax, elastic links")


def _common_range(variants: Sequence[Variant]) -> tuple[float, float]:
    """Return the common axis range of deflections [rad] with a margin; lines of the envelope may exceed it."""
    extremes = [
        (pick(v.ensemble.deflection_rad), *(pick(single_deflection(run)) for run in (v.reduced, v.dem)))
        for pick in (np.min, np.max) for v in variants
    ]
    low, high = np.min(extremes), np.max(extremes)
    room = 0.06 * (high - low)
    return low - room, high + room


def _legend_below(drawing: Figure, entries: dict[str, Any]) -> None:
    """Add one legend for all panels, in a strip that the layout reserves below them."""
    strip = 0.28 * -(-len(entries) // 4) / drawing.get_figheight()
    drawing.get_layout_engine().set(rect=(0, strip, 1, 1 - strip))
    drawing.legend(entries.values(), entries.keys(), loc="lower center", ncol=4, fontsize=8, frameon=False)


def figure_13(base: Variant, dem_ensemble: ensembles.EnsembleOfRuns, title: str, folder: Path) -> list[Path]:
    """Write Figure 13: paths of the centres of bearing and journal, and their relative path."""
    with style():
        drawing, panels = new_panels(1, 3, (12.6, 4.9))
        for panel, part in zip(panels, ("journal", "bearing")):
            for run, line, end in _singles(base):
                _path(panel, run[f"{part}_x_m"] * 1e3, run[f"{part}_y_m"] * 1e3, line, end)
            panel.set_title(f"({'a' if part == 'journal' else 'b'}) centre of the {part}", fontsize=9)
            panel.set_xlabel("x [mm]")
            panel.set_ylabel("y [mm]")
            panel.ticklabel_format(useOffset=False)
        play = panels[2]
        radii = {round(base.case.clearance_m(change), 12) for change in (0.0, *base.case.temperature_range_K)}
        for radius in radii:
            play.plot(radius * 1e6 * np.cos(CIRCLE), radius * 1e6 * np.sin(CIRCLE), color="0.45", linewidth=1.2)
        for ensemble, colour, marker, label in (
            (base.ensemble, "#56B4E9", "o", "reduced"), (dem_ensemble, "#009E73", "^", "DEM"),
        ):
            play.plot(*(-ensemble.end_eccentricity_m.T * 1e6), marker, color=colour, markersize=4, alpha=0.75,
                      markeredgewidth=0, label=f"ends of {len(ensemble.theta2_rad)} {label} runs", zorder=3)
        for run, line, end in _singles(base):
            _path(play, -run["eccentricity_x_m"] * 1e6, -run["eccentricity_y_m"] * 1e6, line, end)
        play.set_title("(c) bearing's centre seen from the journal's, |d| = c", fontsize=9)
        play.set_xlabel("x [µm]")
        play.set_ylabel("y [µm]")
        for panel in panels:
            panel.set_aspect("equal", adjustable="datalim")
        lines, labels = play.get_legend_handles_labels()
        entries = dict(zip(labels, lines))
        places = [label for label in entries if label.startswith("ends") or label == "start"]
        first = [label for label in entries if label not in places]
        _legend_below(drawing, {label: entries[label] for label in (*first, *places)})
        drawing.suptitle(f"{title}: Fig. 13, paths of the centres in one cycle", fontsize=11)
        return save(drawing, folder, "fig13")


def _singles(base: Variant) -> tuple[tuple[Run, Line, Line], ...]:
    return (
        (base.reduced, {**SINGLE, "linewidth": 1.6},
         {"marker": "s", "color": "#D55E00", "label": "its end"}),
        (base.dem, {**DEM, "linewidth": 0.7}, {"marker": "X", "color": "#000000", "label": "its end "}),
    )


def _path(panel: Axes, x: np.ndarray, y: np.ndarray, line: Line, end: Line) -> None:
    fine = thin(len(x), 2 * CURVE_POINTS)
    panel.plot(x[fine], y[fine], **line)
    panel.plot(x[-1], y[-1], linestyle="", markersize=8, zorder=6, markeredgecolor="white", **end)
    panel.plot(x[0], y[0], "o", markersize=7, markerfacecolor="white", markeredgecolor="black", zorder=5,
               label="start")
