# SPDX-License-Identifier: GPL-3.0-or-later
"""A loaded joint at constant temperature with two friction laws: ``statejump hold``."""
from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.lines import Line2D

from statejump import _engine, laws
from statejump.core.engine_failures import engine
from statejump.core.figures import DEM, REDUCED, panels, save, style
from statejump.core.results_folder import Results
from statejump.core.progress import OnProgress, counted
from statejump.core.run import Run
from statejump.core.tables import markdown, write_csv, write_markdown
from statejump.kinds.umbrella import reduced as model
from statejump.kinds.umbrella.case import UmbrellaCase
from studies.paper.common import made_by, refused
from statejump.schema.paths import with_values
from studies.paper import ensembles

PERIOD_s = 10.0
STEPS_PER_SECOND = (50_000, 100_000, 200_000)
SHOWN = 100_000  # number of steps per second in the figure and in hold.csv
SAMPLES_PER_SECOND = 2000
LAWS = ("mindlin", "ambrosio")
# Interval for the creep rate [s]: after the initial acceleration, before the contact angle has changed much.
RATE_FROM_s, RATE_TO_s = 2e-3, 12e-3
SETTLED_s = 0.1  # time after which the fresh contact of the DEM has reached its friction [s]
ROWS = 160  # of hold.csv, logarithmic in time

EXPLANATION = """\
The torsion spring presses the joint; its contact sits aside of the line of the force by the angle
`phi`, so it needs the friction T = F_N tan(phi) to stay. Nothing else happens: constant temperature.

- `mindlin`: stays. The reduced model starts with the friction force in its spring and moves by rounding
  only. The DEM's contact is fresh and holds no friction force yet, so it first slides until its spring
  carries T: by T/k_t, `expected` below, and a little more, for it overshoots and each swing of F_N takes
  some of the spring's force. Within 0.1 s that is over; then it stays too.
- `ambrosio`: creeps, at v0 + (v1 - v0) T/(mu F_N), until phi = 0 where no friction is needed. `predicted`
  is the slide of massless links at that rate, phi and with it T following the slide.

`slide` is that of the journal's surface on the bearing's, c phi + R1 theta4 - R2 theta2 from the start.
"""


@dataclass(frozen=True)
class Hold:
    """One run, reduced to the quantities of this study."""

    law: str
    model: str
    steps_per_second: int
    time_s: np.ndarray
    contact_angle_rad: np.ndarray
    slide_m: np.ndarray

    @property
    def drift_m(self) -> float:
        """Largest slide from the start."""
        return float(np.max(np.abs(self.slide_m)))

    @property
    def settled_drift_m(self) -> float:
        """Largest slide from the place at ``SETTLED_s``."""
        late = self.slide_m[self.time_s >= SETTLED_s * (1 - 1e-9)]
        return float(np.max(np.abs(late - late[0])))

    @property
    def creep_rate_m_per_s(self) -> float:
        """Mean absolute rate of slide at the start."""
        first, last = np.searchsorted(self.time_s, np.array([RATE_FROM_s, RATE_TO_s]) - 1e-9)
        return float(abs(self.slide_m[last] - self.slide_m[first]) / (self.time_s[last] - self.time_s[first]))


def held(case: UmbrellaCase, period_s: float = PERIOD_s) -> UmbrellaCase:
    """Return the case at constant temperature. The contact starts at half the friction angle unless the case sets its
    position. :raises NotAllowed: the joint is unloaded"""
    if case.start.mode != "loaded":
        raise refused(case, "start.mode", case.start.mode,
                      "'statejump hold' needs 'loaded', with a biased torsion spring")
    friction = case.joint.friction_coefficient
    if not friction > 0:
        raise refused(case, "joint.friction_coefficient", friction, "nothing holds the joint")
    return with_values(
        case,
        {
            "thermal.shape": "triangle",
            "thermal.temperature_change_max_K": 0.0,
            "thermal.cycles": 1,
            "thermal.period_s": period_s,
            "start.contact_angle_rad": case.start.contact_angle_rad or math.atan(friction) / 2,
            "output.samples_per_cycle": round(SAMPLES_PER_SECOND * period_s),
        },
    )


def by_law(case: UmbrellaCase, law: str, steps_per_second: int) -> UmbrellaCase:
    """Return the case at constant temperature with a friction law and a number of time steps."""
    samples = case.output.samples_per_cycle
    steps = samples * math.ceil(case.period_s * steps_per_second / samples)
    return with_values(
        case,
        {
            "joint.friction_law": law,
            "reduced.method": "rk4",
            "reduced.steps_per_cycle": steps,
            "dem.steps_per_cycle": steps,
        },
    )


def _measure(case: UmbrellaCase, name: str, steps_per_second: int, history: Run) -> Hold:
    side = -1 if history["eccentricity_x_m"][0] < 0 else 1
    angle = np.arctan2(side * history["eccentricity_y_m"], side * history["eccentricity_x_m"])
    slide = _arc(case, angle, history["theta2_rad"], history["theta4_rad"])
    return Hold(case.joint.friction_law, name, steps_per_second, history["time_s"], angle, slide)


def _arc(case: UmbrellaCase, angle: np.ndarray, theta2: np.ndarray, theta4: np.ndarray) -> np.ndarray:
    """Return the slide of a run since its first sample [m]. Differences are formed before the sum, against rounding."""
    joint = case.joint
    return (
        joint.radial_clearance_m * (angle - angle[0])
        + joint.journal_radius_m * (theta4 - theta4[0])
        - case.bearing_radius_m * (theta2 - theta2[0])
    )


def run_reduced(case: UmbrellaCase, law: str, steps_per_second: int) -> Hold:
    """Run the held case in the reduced model."""
    wanted = by_law(case, law, steps_per_second)
    return _measure(wanted, "reduced", steps_per_second, model.run(wanted))


def run_dem(cases: Sequence[tuple[str, int]], case: UmbrellaCase, finished: Callable[[], None]) -> list[Hold]:
    """Run the case at constant temperature in the DEM, with a friction law and steps per second."""
    wanted = [by_law(case, law, rate) for law, rate in cases]
    runs = ensembles.execute_all(wanted, finished)
    return [
        _measure(one, "DEM", rate, run) for one, (_, rate), run in zip(wanted, cases, runs)
    ]


@dataclass(frozen=True)
class Prediction:
    """Predictions: creep with friction law ``ambrosio``, and first slide of a fresh contact with ``mindlin``."""

    time_s: np.ndarray
    contact_angle_rad: np.ndarray
    slide_m: np.ndarray
    first_slide_m: float  # T/k_t

    @property
    def creep_rate_m_per_s(self) -> float:
        """Absolute predicted creep rate, over the interval in which that of the runs is measured."""
        first, last = np.interp([RATE_FROM_s, RATE_TO_s], self.time_s, np.abs(self.slide_m))
        return float((last - first) / (RATE_TO_s - RATE_FROM_s))


def predict(case: UmbrellaCase) -> Prediction:
    """Predict the creep of massless rigid links. The angle is the independent variable; the time results by quadrature.
    """
    linkage, joint = model.linkage(case), case.joint
    start = case.start.contact_angle_rad
    state = _engine.loaded_state(linkage, start)
    side = -1 if (state.journal_centre_m - state.bearing_centre_m)[0] < 0 else 1
    angle = np.linspace(start, 0.0, 2001)
    points = [_engine.joint_point(linkage, 0.0, side, value) for value in angle]
    theta2, theta4 = (np.array([p[f"{name}_rad"] for p in points]) for name in ("theta2", "theta4"))
    slide = _arc(case, angle, theta2, theta4)
    ramp = joint.friction_v1_m_per_s - joint.friction_v0_m_per_s
    rate = joint.friction_v0_m_per_s + ramp * np.abs(np.tan(angle)) / joint.friction_coefficient
    middle = np.maximum((rate[1:] + rate[:-1]) / 2, 1e-300)
    time = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(slide)) / middle)))
    return Prediction(time, angle, slide, abs(state.tangential_force_N) / state.tangential_stiffness_N_per_m)


def _shown(runs: Sequence[Hold]) -> list[Hold]:
    return [run for run in runs if run.steps_per_second == SHOWN]


def figure(case: UmbrellaCase, runs: Sequence[Hold], creep: Prediction, folder: Path) -> list[Path]:
    """Write ``hold.png`` and ``hold.svg``: contact angle and slide over time."""
    with style():
        drawing, (left, right) = panels(1, 2, (9.5, 4.4))
        for run in _shown(runs):
            line = dict({"reduced": {**REDUCED, "label": "reduced model"}, "DEM": DEM}[run.model])
            if run.law != LAWS[0]:
                del line["label"]
            left.plot(run.time_s[1:], np.degrees(run.contact_angle_rad[1:]), **line)
            slide = np.abs(run.slide_m[1:])
            if np.max(slide) > 1e-11:  # what only rounding moves is not drawn
                right.plot(run.time_s[1:], np.maximum(slide, 1e-11), **line)
        blue: dict[str, Any] = dict(color="#0072B2", linewidth=1.6, linestyle=(0, (1, 1.5)), zorder=4)
        inside = creep.time_s > 0
        left.plot(creep.time_s[inside], np.degrees(creep.contact_angle_rad[inside]), **blue)
        first = np.geomspace(5e-4, 0.1, 50)
        right.plot(first, creep_rate_at_start(case) * first, **{**blue, "color": "#D55E00"})
        right.plot(creep.time_s[inside], np.abs(creep.slide_m[inside]), **blue)
        left.set_ylabel("Contact angle \u03c6 [\u00b0]")
        right.set_ylabel("Slide in the joint [m]")
        right.set_yscale("log")
        for panel in (left, right):
            panel.set_xscale("log")
            panel.set_xlim(5e-4, PERIOD_s)
            panel.set_xlabel("Time [s]")
        angle = math.degrees(case.start.contact_angle_rad)
        left.set_ylim(-0.08 * angle, 1.2 * angle)
        left.annotate("mindlin: holds", (0.03, angle), xytext=(0, 6), textcoords="offset points", fontsize=8)
        left.annotate("ambrosio: creeps to 0", (0.4, 0.02 * angle), xytext=(0, 8), textcoords="offset points",
                      fontsize=8)
        right.set_ylim(2e-9, 1e-4)
        right.annotate("mindlin, DEM: T/k_t until its fresh\ncontact carries the load, then nothing",
                       (0.03, creep.first_slide_m), xytext=(0, 14), textcoords="offset points", fontsize=8)
        right.annotate("mindlin, reduced model: below 1e-11 m", (0.03, creep.first_slide_m), xytext=(0, -16),
                       textcoords="offset points", fontsize=8)
        lines, labels = left.get_legend_handles_labels()
        lines += [Line2D([], [], **blue), Line2D([], [], **{**blue, "color": "#D55E00"})]
        labels += ["ambrosio, predicted", "v0 + (v1 \u2212 v0) T/(\u03bc F_N) of the start"]
        right.legend(lines, labels, loc="upper left", framealpha=1, fontsize=8, handlelength=3.2)
        drawing.suptitle(f"{case.title}: {PERIOD_s:g} s at constant temperature", fontsize=11)
        return save(drawing, folder, "hold")


def creep_rate_at_start(case: UmbrellaCase) -> float:
    """Return the creep rate v0 + (v1 - v0) T/(mu F_N) [m/s] at the initial angle, T the tangential force."""
    joint = case.joint
    load = math.tan(abs(case.start.contact_angle_rad)) / joint.friction_coefficient
    return joint.friction_v0_m_per_s + (joint.friction_v1_m_per_s - joint.friction_v0_m_per_s) * load


def write(case: UmbrellaCase, runs: Sequence[Hold], creep: Prediction, command: str, folder: Path) -> list[Path]:
    """Write ``hold.csv`` and ``hold.md``.

    :param command: command that writes these files
    """
    shown = _shown(runs)
    times = shown[0].time_s
    wanted = np.unique(np.searchsorted(times, np.geomspace(times[1], times[-1], ROWS) * (1 - 1e-12)))
    columns = {"time_s": times[wanted]}
    for run in shown:
        columns[f"contact_angle_{run.law}_{run.model.lower()}_rad"] = run.contact_angle_rad[wanted]
        columns[f"slide_{run.law}_{run.model.lower()}_m"] = run.slide_m[wanted]
    columns["slide_ambrosio_predicted_m"] = np.interp(times[wanted], creep.time_s, creep.slide_m)
    table = write_csv(folder / "hold.csv", list(columns),
                      ([f"{value:.9e}" for value in row] for row in zip(*columns.values())))
    predicted = creep.creep_rate_m_per_s

    def cells(run: Hold) -> list[str]:
        rate = run.creep_rate_m_per_s
        creep_cells = ["", ""] if laws.law("friction", run.law).holds_static_load else [
            f"{rate:.4e}", f"{rate / predicted:.4f}"
        ]
        return [run.law, run.model, str(run.steps_per_second), f"{math.degrees(run.contact_angle_rad[-1]):.9f}",
                f"{run.drift_m:.3e}", f"{run.settled_drift_m:.3e}", *creep_cells]

    header = ("law", "model", "steps/s", "angle at the end [\u00b0]", "largest slide [m]", f"after {SETTLED_s:g} s [m]",
              "creep rate [m/s]", "over predicted")
    return [write_markdown(folder / "hold.md", [
        f"# A loaded joint left alone: {case.title}", "",
        f"Made by `{command}`: {case.period_s:g} s, contact angle "
        f"{math.degrees(case.start.contact_angle_rad):.4f}\u00b0 at the start, \u03bc = "
        f"{case.joint.friction_coefficient:g}, v0 = {case.joint.friction_v0_m_per_s:g} m/s, v1 = "
        f"{case.joint.friction_v1_m_per_s:g} m/s.", "",
        EXPLANATION,
        f"Expected first slide of a fresh contact T/k_t: {creep.first_slide_m:.3e} m. Predicted creep rate: "
        f"{creep_rate_at_start(case):.4e} m/s at the start, {predicted:.4e} m/s from {RATE_FROM_s * 1e3:g} to "
        f"{RATE_TO_s * 1e3:g} ms, where it is measured.", "",
        *markdown(header, map(cells, runs)),
    ]), table]


@dataclass(frozen=True)
class Held:
    """Runs of a joint held at constant temperature, and the files written from them."""

    case: UmbrellaCase
    runs: Sequence[Hold]
    creep: Prediction
    written: list[Path]

    def summary_lines(self) -> list[str]:
        """Return the lines that a command prints."""
        return [
            f"{run.law}, {run.model}: slide {run.drift_m:.3e} m in {self.case.period_s:g} s, contact angle "
            f"{math.degrees(run.contact_angle_rad[-1]):.6f}\u00b0" for run in _shown(self.runs)
        ]


def make(case: UmbrellaCase, results: Results, on_progress: OnProgress) -> Held:
    """Run a case at constant temperature in both models with both laws; write figure and tables.

    :param results: root of the results; gets a folder named after the case
    :param on_progress: receives the finished fraction, 0 to 1
    :raises NotAllowed: the joint of the case is unloaded
    :raises FailedRun: the initial load of the case is impossible
    """
    command, original, case = made_by("hold", case), case, held(case)
    with engine("the joint cannot be loaded", case=case.name):
        creep = predict(case)
    with results.folder(case.name, original) as folder:
        wanted = [(law, rate) for law in LAWS for rate in STEPS_PER_SECOND]
        finished = counted(on_progress, 2 * len(wanted))
        runs = []
        for law, rate in wanted:
            runs.append(run_reduced(case, law, rate))
            finished()
        runs += run_dem(wanted, case, finished)
        written = write(case, runs, creep, command, folder.staged) + figure(case, runs, creep, folder.staged)
        return Held(case, runs, creep, folder.publish(written))
