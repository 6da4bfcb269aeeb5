# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump figures``: Figures 13 to 16 of the paper with both models, and its claims tested."""
from __future__ import annotations

import csv
import json
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any, Callable, Iterator, Optional, Sequence

import click
import numpy as np
from rich.console import Console
from scipy.optimize import brentq

from .. import _engine
from ..case_umbrella import UmbrellaCase
from ..dem import DemRun
from ..errors import Interrupted, StatejumpError
from ..history import History
from ..output import results_folder, write_atomically
from ..plot import STYLE, plt, save
from ..terminal import QUIET, RESULTS, load_kind, make_console, progress
from . import claims, compare, dem, model

CLEARANCES = (0.5, 1.0, 1.5, 2.0, 3.0)  # over that of the case
FRICTIONS = (0.0, 0.1, 0.3, 0.5)
SPRINGS_N_m_per_rad = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)
SECTIONS = (0.25, 1.0, 4.0)  # over that of the case: stiffness of the links
TWIN_RAD = 1e-12  # turn of AB between two otherwise equal starts
ONSET = 0.01  # of c/|AB| at the smallest clearance: AB has begun to deflect
CURVE_POINTS = 1000  # of a single run in a figure
TABLE_POINTS = 201  # of a curve in curves.csv, of a band in a figure
CIRCLE = np.linspace(0, 2 * np.pi, 721)

# Okabe-Ito; each differs in lightness, width or dashes as well.
BAND = {"color": "#56B4E9", "alpha": 0.4, "linewidth": 0, "label": "reduced, ensemble: mean ± sd"}
MEAN = {"color": "#0072B2", "linewidth": 2.6, "label": "reduced, ensemble: mean"}
SINGLE = {"color": "#E69F00", "linewidth": 1.6, "label": "reduced, single run"}
DEM = {"color": "#000000", "linewidth": 0.9, "linestyle": (0, (5, 2)), "label": "DEM (YADE), single run"}
CONTACT = {"color": "#D55E00", "linewidth": 1.2, "linestyle": (0, (1, 1.5)),
           "label": "first contact, c/(α |AC|)"}
STATIC = {"color": "#009E73", "linewidth": 4.2, "alpha": 0.5, "label": "quasi-static, frictionless"}
LIMITS = {"color": "0.6", "linewidth": 0.9, "label": "all that the play allows"}


@dataclass(frozen=True)
class Variant:
    """Both models of the case with one value changed."""

    value: float
    case: UmbrellaCase
    reduced: model.ReducedRun
    ensemble: model.EnsembleOfRuns
    dem: DemRun

    @property
    def runs(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Temperatures and θ2 (runs, samples) by kind of run."""
        single = self.reduced.history, self.dem.history
        return {
            "reduced, ensemble": (self.ensemble.temperature_change_K, self.ensemble.theta2_rad),
            **{
                f"{name}, single": (run["temperature_change_K"], run["theta2_rad"][None, :])
                for name, run in zip(("reduced", "DEM"), single)
            },
        }


@dataclass(frozen=True)
class Study:
    """One figure: what is varied, and how it is called."""

    figure: str
    key: str
    values: tuple[float, ...]
    title: str
    label: str  # of the parameter, with unit
    panel: str  # heading of a panel, to be formatted with the value
    scale: float = 1.0  # from SI to the label's unit
    summaries: tuple[str, ...] = ("largest",)  # of SUMMARIES, a panel each


def studies(case: UmbrellaCase) -> tuple[Study, ...]:
    """Figures 14 to 16 for a case."""
    clearance = case.joint.radial_clearance_m
    return (
        Study("fig14", "joint.radial_clearance_m", tuple(clearance * factor for factor in CLEARANCES),
              "Fig. 14: deflection of AB, clearance", "Clearance c [mm]", "c = {:g} mm", 1e3),
        Study("fig15", "joint.friction_coefficient",
              tuple(sorted({*FRICTIONS, case.joint.friction_coefficient})),
              "Fig. 15: deflection of AB, friction", "Friction coefficient μ", "μ = {:g}",
              summaries=("largest", "range")),
        Study("fig16", "torsion_spring.stiffness_N_m_per_rad", SPRINGS_N_m_per_rad,
              "Fig. 16: deflection of AB, torsion spring", "Stiffness $K_M$ [N m/rad]",
              "$K_M$ = {:g} N m/rad"),
    )


# --- what statics and geometry say -------------------------------------------------------------


def _theta2(case: UmbrellaCase, lengths: tuple[Any, Any], eccentricity: tuple[Any, Any]) -> Any:
    """θ2 of links of given lengths whose tips are d apart (numbers or arrays that broadcast)."""
    first, second = lengths
    x, y = case.frame.length_m - eccentricity[0], -np.asarray(eccentricity[1])
    between = np.hypot(x, y)
    foot = (between**2 + (first - second) * (first + second)) / (2 * between)
    return np.arctan2(y, x) + np.arctan2(np.sqrt((first - foot) * (first + foot)), foot)


def _lengths(case: UmbrellaCase, change_K: Any) -> tuple[Any, Any]:
    ab, bc = (
        link.stress_free_length_m * (1 + link.thermal_expansion_per_K * change_K)
        for link in (case.link_ab, case.link_bc)
    )
    return ab, bc


def envelope(case: UmbrellaCase, change_K: np.ndarray, margin_m: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Extremes of θ2 [rad] over all places in the play, rigid links, by temperature.

    θ2 has no stationary point inside the play, so its extremes are on the rim.
    """
    change = np.linspace(np.min(change_K), np.max(change_K), 201)[:, None]
    radius = np.array([case.clearance_m(value) for value in change[:, 0]])[:, None] + margin_m
    angles = _theta2(case, _lengths(case, change), (radius * np.cos(CIRCLE), radius * np.sin(CIRCLE)))
    low, high = (np.interp(change_K, change[:, 0], side) for side in (angles.min(axis=1), angles.max(axis=1)))
    return low, high


def closed_form_first_contact(case: UmbrellaCase) -> Optional[float]:
    """ΔT_c [K] of a start without ringing; None without a closed form, infinity without contact."""
    return compare.closed_form_first_contact(model.changed(case, {"start.mode": "matched"}))


def static_deflection(case: UmbrellaCase, change_K: float) -> Optional[float]:
    """θ2 − θ2(0) [rad] of rigid links in contact without friction; None before the first contact."""
    contact = closed_form_first_contact(case)
    if contact is None or change_K < contact:
        return None
    return _engine.joint_point(model.linkage(case), change_K, -1, 0.0)["theta2_rad"] - case.theta2_rad


def static_deflection_elastic(case: UmbrellaCase, change_K: float) -> Optional[float]:
    """The same of elastic links, contact and spring: root of the spring's moment in the joint force
    F, which lies along AC."""
    spring = case.torsion_spring.stiffness_N_m_per_rad
    if spring == 0 or static_deflection(case, change_K) is None:
        return None
    joint, free = case.joint, case.free_flare_angle_rad
    first, second = _lengths(case, change_K)
    stiffness = [
        link.young_modulus_Pa * link.cross_section_area_m2 / length
        for link, length in ((case.link_ab, first), (case.link_bc, second))
    ]

    def normal_force(depth: float) -> float:
        return float(_engine.normal_force(
            joint.normal_law, np.array([depth]), joint.journal_radius_m, case.bearing_radius_m,
            joint.contact_length_m, case.effective_young_modulus_Pa,
        )["force_N"][0])

    def angles(force: float) -> tuple[float, float]:
        """θ2 and θ4 under a force; pressed links get shorter, the play deeper."""
        play = case.clearance_m(change_K)
        end = 0.5 * min(play, _engine.largest_depth_m(joint.normal_law, joint.journal_radius_m, case.bearing_radius_m))
        depth = brentq(lambda value: normal_force(value) - force, 0, end, xtol=1e-18)
        theta2, theta4 = case.theta2_rad, case.theta4_rad
        for _ in range(50):  # the strain is small: each round gains its size
            ab = first - force * np.cos(theta2) / stiffness[0]
            bc = second + force * np.cos(theta4) / stiffness[1]
            theta2 = float(_theta2(case, (ab, bc), (-(play + depth), 0.0)))
            tip = ab * np.array([np.cos(theta2), np.sin(theta2)])
            theta4 = float(np.arctan2(tip[1], tip[0] - case.frame.length_m - (play + depth)))
        return theta2, theta4

    def unbalance(force: float) -> float:
        theta2, theta4 = angles(force)
        lever = (first - force * np.cos(theta2) / stiffness[0]) * np.sin(theta2)
        return force * lever + spring * (theta4 - theta2 - free)

    rigid = _engine.joint_point(model.linkage(case), change_K, -1, 0.0)
    largest = -2 * rigid["spring_moment_N_m"] / (first * np.sin(rigid["theta2_rad"]))
    try:
        return angles(brentq(unbalance, 0, largest, xtol=1e-15 * largest, rtol=1e-14))[0] - case.theta2_rad
    except ValueError:  # beyond the range of the normal law
        return None


# --- runs --------------------------------------------------------------------------------------


def _variant_case(case: UmbrellaCase, key: str, value: float) -> UmbrellaCase:
    variant = model.changed(case, {key: value})
    problem = variant.problem()
    if problem is not None:
        raise StatejumpError(f"case {case.name}: cannot vary {key}: {problem}")
    return variant


Part = Callable[[str, int], Any]


@contextmanager
def _part(console: Console, text: str, runs: int) -> Iterator[Callable[[], None]]:
    """Yield what to call after each run: moves a bar on a terminal; elsewhere one line per part."""
    if not console.is_terminal:
        console.print(f"{text}: {runs} runs")
        yield lambda: None
        return
    with progress(console, f"{text}, {runs} runs") as tell:
        finished = count(1)
        yield lambda: tell(next(finished) / runs)


def run_variants(case: UmbrellaCase, study: Study, known: dict[str, Variant], part: Part) -> list[Variant]:
    """Run both models at every value of a study; the case itself is run once for all studies."""
    cases = [_variant_case(case, study.key, value) for value in study.values]
    new = [variant for variant in cases if _key(variant) not in known]
    with part(f"{study.figure}, reduced", len(new) * (case.ensemble.reduced_runs + 1)) as step:
        ensembles = [model.ensemble(variant, progress=step) for variant in new]
        singles = []
        for variant in new:
            singles.append(model.run(variant))
            step()
    with part(f"{study.figure}, DEM", len(new)) as step:
        dem_runs = dem.execute_all(new, step)
    for variant, ensemble, single, dem_run in zip(new, ensembles, singles, dem_runs):
        known[_key(variant)] = Variant(0.0, variant, single, ensemble, dem_run)
    return [
        Variant(value, variant, *(getattr(known[_key(variant)], name) for name in ("reduced", "ensemble", "dem")))
        for value, variant in zip(study.values, cases)
    ]


def _key(case: UmbrellaCase) -> str:
    return json.dumps(case.dict(), sort_keys=True, default=str)


def first_contacts(case: UmbrellaCase, values: Sequence[float], part: Part) -> tuple[claims.FirstContact, ...]:
    """First contact of both models at every clearance, links that do not ring."""
    start = {"start.mode": "matched", "start.eccentricity_m": 0.0}
    cases = [model.changed(_variant_case(case, "joint.radial_clearance_m", value), start) for value in values]
    with part("first contact, both models", 2 * len(cases)) as step:
        dem_runs = dem.execute_all(cases, step)
        result = []
        for value, variant, dem_run in zip(values, cases, dem_runs):
            exact = closed_form_first_contact(variant)
            if exact is not None and exact > variant.temperature_range_K[1]:
                exact = None
            result.append(claims.FirstContact(
                value, exact, model.run(variant).first_contact_temperature_change_K,
                dem_run.summary["first_contact_temperature_change_K"],
            ))
            step()
    return tuple(result)


def _amplification(case: UmbrellaCase, reduced: History) -> claims.Amplification:
    """Run the case once more, AB turned by TWIN_RAD."""
    across = np.array([np.sin(case.theta2_rad), -np.cos(case.theta2_rad)])  # d = journal − bearing
    twin = model.run(case, TWIN_RAD * case.link_ab.stress_free_length_m * across).history
    apart = np.abs(twin["theta2_rad"] - reduced["theta2_rad"])
    warmest = compare.largest_temperature(reduced)
    return claims.Amplification(TWIN_RAD, float(apart[warmest]), float(apart[-1]))


def _slack(case: UmbrellaCase, history: History) -> float:
    """Largest depth plus stretch of both links [m]: by so much rigid links may seem out of the play."""
    first, second = _lengths(case, history["temperature_change_K"])
    return float(np.max(
        np.maximum(history["penetration_depth_m"], 0)
        + np.abs(history["length_ab_m"] - first) + np.abs(history["length_bc_m"] - second)
    ))


def _check_envelopes(
    groups: Sequence[tuple[str, Sequence[Variant]]], dem_ensemble: model.EnsembleOfRuns, base: Variant
) -> tuple[claims.Envelope, ...]:
    def check(case: UmbrellaCase, margin: float, change: np.ndarray, theta2: np.ndarray) -> tuple[float, int]:
        low, high = envelope(case, change)
        low_margin, high_margin = envelope(case, change, margin)
        excess = np.maximum(low - theta2, theta2 - high)
        return float(np.max(excess)), int(np.sum((theta2 < low_margin) | (theta2 > high_margin)))

    def margin(variant: Variant) -> float:
        histories = variant.reduced.history, variant.dem.history
        return 2 * max(_slack(variant.case, history) for history in histories)

    rows = []
    for name, variants in groups:
        for kind in variants[0].runs:
            checked = [check(v.case, margin(v), *v.runs[kind]) for v in variants]
            rows.append(claims.Envelope(
                f"{name}, {kind}", sum(len(v.runs[kind][1]) for v in variants),
                max(excess for excess, _ in checked), max(margin(v) for v in variants),
                sum(beyond for _, beyond in checked),
            ))
    excess, beyond = check(base.case, margin(base), dem_ensemble.temperature_change_K, dem_ensemble.theta2_rad)
    rows.append(claims.Envelope(
        "case, DEM ensemble", len(dem_ensemble.theta2_rad), excess, margin(base), beyond
    ))
    return tuple(rows)


def _onset(change_K: np.ndarray, deflection: np.ndarray, threshold: float) -> np.ndarray:
    """ΔT at which each run first deflects by the threshold; infinity if it never does."""
    moved = np.abs(deflection) > threshold
    return np.where(moved.any(axis=1), change_K[np.argmax(moved, axis=1)], np.inf)


def _largest(variant: Variant) -> np.ndarray:
    return np.abs(variant.ensemble.deflection_rad).max(axis=1)


def _single_deflection(history: History) -> np.ndarray:
    return history["theta2_rad"] - history["theta2_rad"][0]


# --- drawing -----------------------------------------------------------------------------------


def _thin(length: int, points: int) -> np.ndarray:
    """Indices of at most so many samples, first and last among them."""
    return np.unique(np.linspace(0, length - 1, min(points, length)).round().astype(int))


def _draw_curves(panel: plt.Axes, variant: Variant) -> None:
    ensemble = variant.ensemble
    coarse = _thin(len(ensemble.time_s), TABLE_POINTS)
    time, change = ensemble.time_s[coarse], ensemble.temperature_change_K[coarse]
    theta2 = variant.case.theta2_rad
    for side, limit in enumerate(envelope(variant.case, change)):
        panel.plot(time, (limit - theta2) * 1e3, **{**LIMITS, **({"label": "_"} if side else {})})
    deflection = ensemble.deflection_rad[:, coarse] * 1e3
    mean, spread = deflection.mean(axis=0), deflection.std(axis=0)
    panel.fill_between(time, mean - spread, mean + spread, **BAND)
    path = _quasi_static(variant, change)
    if path is not None:
        panel.plot(time, path * 1e3, **STATIC)
    panel.plot(time, mean, **MEAN)
    for history, style in ((variant.reduced.history, SINGLE), (variant.dem.history, DEM)):
        fine = _thin(len(history), CURVE_POINTS)
        panel.plot(history["time_s"][fine], _single_deflection(history)[fine] * 1e3, **style)
    contact = closed_form_first_contact(variant.case)
    if contact is not None and contact <= np.max(change):
        reached = np.argmax(ensemble.temperature_change_K >= contact)
        panel.axvline(ensemble.time_s[reached], **CONTACT)
        panel.annotate(f"{contact:.1f} K", (ensemble.time_s[reached], 0.03), xycoords=("data", "axes fraction"),
                       xytext=(4, 0), textcoords="offset points", fontsize=8, color="#A04000",
                       bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8})


def _quasi_static(variant: Variant, change_K: np.ndarray) -> Optional[np.ndarray]:
    """Frictionless path in contact, NaN where the spring leaves the joint open; None without spring."""
    spring = variant.case.torsion_spring
    if spring.stiffness_N_m_per_rad == 0 or spring.bias_rad != 0:
        return None
    values = {change: static_deflection(variant.case, change) for change in np.unique(change_K)}
    if all(value is None for value in values.values()):
        return None
    return np.array([np.nan if values[change] is None else values[change] for change in change_K])


def _temperature_scale(panel: plt.Axes, ensemble: model.EnsembleOfRuns, labelled: bool) -> None:
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


SUMMARIES: dict[str, tuple[str, str, Callable[[np.ndarray], np.ndarray]]] = {
    "largest": ("largest deflection of the cycle", "Largest |θ2 − θ2(0)| [mrad]",
                lambda deflection: np.abs(deflection).max(axis=1)),
    "range": ("range of the cycle", "Largest less smallest θ2 [mrad]", lambda deflection: np.ptp(deflection, axis=1)),
}


def _draw_summary(panel: plt.Axes, name: str, study: Study, variants: Sequence[Variant]) -> None:
    title, label, quantity = SUMMARIES[name]
    places = np.arange(len(variants))
    values = [quantity(variant.ensemble.deflection_rad) * 1e3 for variant in variants]
    panel.errorbar(places, [np.mean(v) for v in values], [np.std(v) for v in values], fmt="o", color="#0072B2",
                   capsize=4, markersize=5, label="reduced, ensemble: mean ± sd")
    for kind, marker, style in (("reduced", "D", SINGLE), ("dem", "x", DEM)):
        runs = [quantity(_single_deflection(getattr(v, kind).history)[None, :])[0] * 1e3 for v in variants]
        panel.plot(places + (0.16 if kind == "dem" else -0.16), runs, marker, color=style["color"], markersize=5,
                   label=style["label"])
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


def _mark_static(panel: plt.Axes, places: np.ndarray, variants: Sequence[Variant]) -> None:
    warmest = [v.ensemble.temperature_change_K.max() for v in variants]
    static = [
        static_deflection_elastic(v.case, change) if v.case.torsion_spring.bias_rad == 0 else None
        for v, change in zip(variants, warmest)
    ]
    if any(value is not None for value in static):
        rigid = static_deflection(variants[0].case, warmest[0])
        panel.axhline(abs(rigid) * 1e3, color=STATIC["color"], linewidth=1.4,
                      label="static at ΔTmax, rigid links")
        panel.plot(places, [np.nan if value is None else abs(value) * 1e3 for value in static], "s",
                   color=STATIC["color"], markersize=4, markerfacecolor="white",
                   label="static at ΔTmax, elastic links")


def _common_range(variants: Sequence[Variant]) -> tuple[float, float]:
    """Range of every deflection [rad] with some room; the lines of the envelope may leave it."""
    extremes = [
        (pick(v.ensemble.deflection_rad), *(pick(_single_deflection(run.history)) for run in (v.reduced, v.dem)))
        for pick in (np.min, np.max) for v in variants
    ]
    low, high = np.min(extremes), np.max(extremes)
    room = 0.06 * (high - low)
    return low - room, high + room


def _legend_below(drawing: plt.Figure, entries: dict[str, Any]) -> None:
    """One legend for all panels, in a strip that the layout leaves free."""
    strip = 0.28 * -(-len(entries) // 4) / drawing.get_figheight()
    drawing.get_layout_engine().set(rect=(0, strip, 1, 1 - strip))
    drawing.legend(entries.values(), entries.keys(), loc="lower center", ncol=4, fontsize=8, frameon=False)


def figure_of(study: Study, variants: Sequence[Variant], title: str, folder: Path) -> list[Path]:
    """Write a figure of small multiples with its summary; return the paths."""
    used = len(variants) + len(study.summaries)
    columns = max(3, -(-used // 2))
    with plt.rc_context(STYLE):
        drawing, grid = plt.subplots(2, columns, figsize=(3.6 * columns + 0.6, 7.6), constrained_layout=True)
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


def figure_13(base: Variant, dem_ensemble: model.EnsembleOfRuns, title: str, folder: Path) -> list[Path]:
    """Write the paths of both centres and of the bearing's relative to the journal's."""
    with plt.rc_context(STYLE):
        drawing, panels = plt.subplots(1, 3, figsize=(12.6, 4.9), constrained_layout=True)
        for panel, part in zip(panels, ("journal", "bearing")):
            for history, style, end in _singles(base):
                _path(panel, history[f"{part}_x_m"] * 1e3, history[f"{part}_y_m"] * 1e3, style, end)
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
        for history, style, end in _singles(base):
            _path(play, -history["eccentricity_x_m"] * 1e6, -history["eccentricity_y_m"] * 1e6, style, end)
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


def _singles(base: Variant) -> tuple[tuple[History, dict, dict], ...]:
    return (
        (base.reduced.history, {**SINGLE, "linewidth": 1.6},
         {"marker": "s", "color": "#D55E00", "label": "its end"}),
        (base.dem.history, {**DEM, "linewidth": 0.7}, {"marker": "X", "color": "#000000", "label": "its end "}),
    )


def _path(panel: plt.Axes, x: np.ndarray, y: np.ndarray, style: dict, end: dict) -> None:
    fine = _thin(len(x), 2 * CURVE_POINTS)
    panel.plot(x[fine], y[fine], **style)
    panel.plot(x[-1], y[-1], linestyle="", markersize=8, zorder=6, markeredgecolor="white", **end)
    panel.plot(x[0], y[0], "o", markersize=7, markerfacecolor="white", markeredgecolor="black", zorder=5,
               label="start")


# --- files -------------------------------------------------------------------------------------


def _write_csv(path: Path, heads: Sequence[str], rows: Iterator[Sequence[Any]]) -> None:
    with write_atomically(path) as stream:
        writer = csv.writer(stream)
        writer.writerow(heads)
        for row in rows:
            writer.writerow([f"{cell:.9g}" if isinstance(cell, float) else cell for cell in row])


def write_ensembles(
    done: Sequence[tuple[Study, Sequence[Variant]]], dem_ensemble: model.EnsembleOfRuns, base: Variant, folder: Path
) -> None:
    """Write ``ensembles.csv``: one row per run."""

    def of(figure: str, key: str, value: float, name: str, runs: model.EnsembleOfRuns) -> Iterator[Sequence[Any]]:
        largest = np.abs(runs.deflection_rad).max(axis=1)
        for i, end in enumerate(runs.end_eccentricity_m):
            yield (figure, key, float(value), name, i, float(largest[i]), float(runs.range_rad[i]),
                   float(runs.jump_rad[i]), float(end[0]), float(end[1]))

    def rows() -> Iterator[Sequence[Any]]:
        yield from of("fig13", "", 0.0, "reduced ensemble", base.ensemble)
        yield from of("fig13", "", 0.0, "dem ensemble", dem_ensemble)
        for study, variants in done:
            for v in variants:
                yield from of(study.figure, study.key, v.value, "reduced ensemble", v.ensemble)
                for name in ("reduced", "dem"):
                    single = model.gather([getattr(v, name).history])
                    yield from of(study.figure, study.key, v.value, f"{name} single", single)

    _write_csv(
        folder / "ensembles.csv",
        ("figure", "parameter", "value", "model", "run", "largest_deflection_rad", "range_rad", "jump_rad",
         "end_eccentricity_x_m", "end_eccentricity_y_m"),
        rows(),
    )


def write_curves(done: Sequence[tuple[Study, Sequence[Variant]]], folder: Path) -> None:
    """Write ``curves.csv``: what Figures 14 to 16 draw, at fewer times."""

    def rows() -> Iterator[Sequence[Any]]:
        for study, variants in done:
            for v in variants:
                runs = v.ensemble
                take = _thin(len(runs.time_s), TABLE_POINTS)
                change = runs.temperature_change_K[take]
                deflection = runs.deflection_rad[:, take]
                low, high = envelope(v.case, change)
                path = _quasi_static(v, change)
                columns = (
                    runs.time_s[take], change, deflection.mean(axis=0), deflection.std(axis=0),
                    _single_deflection(v.reduced.history)[take], _single_deflection(v.dem.history)[take],
                    low - v.case.theta2_rad, high - v.case.theta2_rad,
                )
                for i, row in enumerate(np.array(columns).T):
                    static = "" if path is None or np.isnan(path[i]) else float(path[i])
                    yield (study.figure, study.key, float(v.value), *(float(cell) for cell in row), static)

    _write_csv(
        folder / "curves.csv",
        ("figure", "parameter", "value", "time_s", "temperature_change_K", "ensemble_mean_deflection_rad",
         "ensemble_sd_deflection_rad", "reduced_deflection_rad", "dem_deflection_rad", "envelope_low_rad",
         "envelope_high_rad", "quasi_static_deflection_rad"),
        rows(),
    )


def _plain(value: Any) -> Any:
    """What JSON knows: lists for arrays, null for what is not finite."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (float, np.floating)):
        return float(f"{value:.9g}") if np.isfinite(value) else None
    return value


def write_claims(case: UmbrellaCase, case_file: Path, findings: claims.Findings, folder: Path) -> None:
    """Write ``ensembles.json`` and ``README.md``."""
    content = {
        "case": case.name,
        "claims": [asdict(claim) for claim in claims.all_claims(findings)],
        "two_sample_tests": [{**asdict(test), "agree": test.agree} for test in findings.tests],
        "findings": {key: value for key, value in asdict(findings).items() if key != "tests"},
    }
    with write_atomically(folder / "ensembles.json") as stream:
        stream.write(json.dumps(_plain(content), indent=1, ensure_ascii=False) + "\n")
    with write_atomically(folder / "README.md") as stream:
        stream.write(claims.readme(case.title, f"statejump figures {case_file}", findings))


# --- all of it ---------------------------------------------------------------------------------


def _groups(variants: Sequence[Variant], quantity: Callable[[Variant], np.ndarray]) -> claims.Groups:
    return claims.Groups(tuple(v.value for v in variants), tuple(quantity(v) for v in variants))


def _end_shift(case: UmbrellaCase, runs: model.EnsembleOfRuns) -> np.ndarray:
    """Way of the journal in the play from the start of each run to its end [m]."""
    angle = case.start.eccentricity_angle_rad
    centre = case.start.eccentricity_m * np.array([np.cos(angle), np.sin(angle)])
    starts = centre + np.array(list(model.start_offsets(case, len(runs.theta2_rad))))
    return np.hypot(*(runs.end_eccentricity_m - starts).T)


def _stiffness_jumps(case: UmbrellaCase, base: Variant, part: Part) -> claims.Groups:
    """Jumps with links of other sections, as many runs as for the figures."""
    others = [factor for factor in SECTIONS if factor != 1]
    jumps = {1.0: base.ensemble.jump_rad}
    with part("stiffness of the links, reduced", len(others) * case.ensemble.reduced_runs) as step:
        for factor in others:
            areas = {
                f"{name}.cross_section_area_m2": factor * getattr(case, name).cross_section_area_m2
                for name in ("link_ab", "link_bc")
            }
            jumps[factor] = model.ensemble(model.changed(case, areas), progress=step).jump_rad
    return claims.Groups(SECTIONS, tuple(jumps[factor] for factor in SECTIONS))


def _findings(
    case: UmbrellaCase, done: Sequence[tuple[Study, Sequence[Variant]]], base: Variant,
    dem_ensemble: model.EnsembleOfRuns, contacts: tuple[claims.FirstContact, ...], stiffness: claims.Groups,
) -> claims.Findings:
    clearances, frictions, springs = (variants for _, variants in done)
    threshold = ONSET * min(v.value for v in clearances) / case.link_ab.stress_free_length_m
    warmest = case.temperature_range_K[1]
    first = closed_form_first_contact(case)
    onset = _groups(
        clearances, lambda v: _onset(v.ensemble.temperature_change_K, v.ensemble.deflection_rad, threshold)
    )
    onset_dem = tuple(
        float(_onset(v.dem.history["temperature_change_K"], _single_deflection(v.dem.history)[None, :], threshold)[0])
        for v in clearances
    )
    unbiased = case.torsion_spring.bias_rad == 0
    return claims.Findings(
        start_spread_m=case.ensemble.start_spread_m,
        end_shift_reduced_m=_end_shift(case, base.ensemble),
        end_shift_dem_m=_end_shift(case, dem_ensemble),
        first_contacts=tuple(
            replace(
                contact,
                reduced_ringing_K=v.reduced.first_contact_temperature_change_K,
                dem_ringing_K=v.dem.summary["first_contact_temperature_change_K"],
            )
            for contact, v in zip(contacts, clearances)
        ),
        tolerance_reduced_K=case.tolerance.first_contact_reduced_K,
        tolerance_dem_K=case.tolerance.first_contact_dem_K,
        onset_K=onset,
        onset_dem_K=onset_dem,
        clearance_limit_m=(
            float("nan") if first is None
            else case.link_ab.thermal_expansion_per_K * warmest * case.frame.length_m
        ),
        range_by_friction=_groups(frictions, lambda v: v.ensemble.range_rad),
        jump_by_friction=_groups(frictions, lambda v: v.ensemble.jump_rad),
        friction_coefficient=case.joint.friction_coefficient,
        largest_by_spring=_groups(springs, _largest),
        jump_by_spring=_groups(springs, lambda v: v.ensemble.jump_rad),
        static_rigid_rad=static_deflection(case, warmest) if unbiased else None,
        static_elastic_rad=tuple(
            static_deflection_elastic(v.case, warmest) if unbiased else None for v in springs
        ),
        jump_by_stiffness=stiffness,
        free_turn_rad=case.joint.radial_clearance_m / case.frame.length_m,
        spring_bias_rad=case.torsion_spring.bias_rad,
        tests=(
            claims.two_sample_test("range of θ2", base.ensemble.range_rad, dem_ensemble.range_rad),
            claims.two_sample_test("jump of θ2", base.ensemble.jump_rad, dem_ensemble.jump_rad),
        ),
        envelopes=_check_envelopes(
            [(study.figure, variants) for study, variants in done], dem_ensemble, base
        ),
        amplification=_amplification(base.case, base.reduced.history),
    )


def make(case: UmbrellaCase, case_file: Path, folder: Path, part: Part) -> tuple[claims.Findings, list[Path]]:
    """Run everything; write each file as soon as its runs are there.

    :param case_file: named in the text
    :param part: gets the name and the number of runs of a part, see :func:`_part`
    :raises Interrupted: Ctrl-C; names the files that are finished
    """
    if case.start.mode == "loaded":
        raise StatejumpError(
            f"case {case.name}: start.mode = 'loaded' is not allowed: the figures vary what would load the joint"
        )
    case = model.for_ensemble(case)
    written: list[Path] = []
    try:
        known: dict[str, Variant] = {}
        itself = Study("fig13", "joint.radial_clearance_m", (case.joint.radial_clearance_m,), "", "", "")
        (base,) = run_variants(case, itself, known, part)
        with part("fig13, DEM ensemble", case.ensemble.dem_runs) as step:
            dem_ensemble = dem.ensemble(case, progress=step)
        written += figure_13(base, dem_ensemble, case.title, folder)
        done = []
        for study in studies(case):
            variants = run_variants(case, study, known, part)
            written += figure_of(study, variants, case.title, folder)
            done.append((study, variants))
            write_curves(done, folder)
            write_ensembles(done, dem_ensemble, base, folder)
        contacts = first_contacts(case, [variant.value for variant in done[0][1]], part)
        stiffness = _stiffness_jumps(case, base, part)
        findings = _findings(case, done, base, dem_ensemble, contacts, stiffness)
        write_claims(case, case_file, findings, folder)
    except (KeyboardInterrupt, Interrupted):
        finished = ", ".join(path.name for path in written if path.suffix == ".png") or "nothing"
        raise Interrupted(f"interrupted; finished in {folder}: {finished}") from None
    written += [folder / name for name in ("curves.csv", "ensembles.csv", "ensembles.json", "README.md")]
    return findings, written


@click.command("figures")
@click.argument("case_file", metavar="[CASE]", default="cases/umbrella.toml", type=click.Path(path_type=Path))
@RESULTS
@QUIET
def figures_command(case_file: Path, results: Path, quiet: bool) -> None:
    """Figures 13 to 16 of the paper for CASE, both models, and a test of each of its claims.

    \b
    Example:
      statejump figures cases/umbrella.toml
    """
    console = make_console(quiet)
    case = load_kind(case_file, UmbrellaCase)
    folder = results_folder(results, case.name)
    findings, written = make(case, case_file, folder, partial(_part, console))
    for claim in claims.all_claims(findings):
        console.print(f"{claim.verdict}: {claim.statement}")
    console.print(f"results: {', '.join(str(path) for path in written)}")
