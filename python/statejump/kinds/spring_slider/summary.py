# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of a ``spring_slider`` case, and the output of commands about its runs."""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from statejump.core.charts import TEMPERATURE, TIME, Axis, Chart
from statejump.core.notes import Note
from statejump.core.run import AT_STOP, Event, Run
from statejump.core.start import FRICTIONLESS
from statejump.core.tables import Shown
from statejump.core.units import text
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.kinds.spring_slider.result import AT_END

LABELS = {
    "floor": "Floor", "stop_plus": "Stop +", "stop_minus": "Stop −", "bar": "Bar", "at_stop_plus": "stop +",
    "at_stop_minus": "stop −", "in_play": "play", "displacement_m": "Displacement of the slider",
    "axial_force_N": "Axial force, compression positive", AT_END: "Displacement at the end of the program",
    # Meaning of the stages of the reduced model.
    "stage S1": "stick, never slid yet", "stage S2": "slip in the sense of the first slide",
    "stage S3": "stick, the link unloads", "stage S4": "stick, the link loads the other way",
    "stage S5": "slip against the first slide", "stage at_stop_plus": "at the stop, + side",
    "stage at_stop_minus": "at the stop, − side", "stage in_play": "in the play, without friction",
}


def describe(case: SpringSliderCase) -> list[str]:
    """Describe the case in sentences. Code common to all kinds describes the temperature program."""
    link, joint = case.link, case.joint
    minus, plus = joint.clearance_minus_m, joint.clearance_plus_m
    both = f"{text(minus, 'm')} and {text(plus, 'm')} away"
    stops = f"{text(plus, 'm')} away on either side" if minus == plus else both
    if joint.stop_stiffness_N_per_m is not None:
        stops += f" and give way by {text(joint.stop_stiffness_N_per_m, 'N/m')}"
    sentences = [
        f"A bar, {text(link.stress_free_length_m, 'm')} long and {text(link.cross_section_area_m2, 'm2')} in "
        f"section, is held at one end and pushes a block at the other.",
        f"The block is pressed on its floor with {text(joint.normal_force_N, 'N')}; friction with "
        f"μ = {joint.friction_coefficient:g} holds it up to {text(case.friction_force_N, 'N')}. Two stops are {stops}.",
    ]
    if joint.play_m:
        sentences.append(f"Friction has a play of {text(joint.play_m, 'm')} in series: lost motion at each reversal.")
    if case.expansion is not None:
        low, high = (end(case.expansion.thermal_expansion_per_K) for end in (min, max))
        sentences.append(f"The bar's coefficient of expansion follows the temperature, from {text(low, '1/K')} to "
                         f"{text(high, '1/K')}.")
    if joint.preload_stiffness_N_per_m:
        sentences.append(f"A spring of {text(joint.preload_stiffness_N_per_m, 'N/m')} ties the block to the ground.")
    if joint.preload_force_N:
        way = "towards" if joint.preload_force_N > 0 else "away from"
        sentences.append(f"A preload of {text(abs(joint.preload_force_N), 'N')} pulls the block {way} the root of the "
                         f"bar; {_start(case)}.")
    return sentences


def _start(case: SpringSliderCase) -> str:
    if case.start.friction == FRICTIONLESS:
        return "friction begins where the block rests without it"
    if abs(case.joint.preload_force_N) <= case.friction_force_N:
        return "friction holds the block where it was assembled"
    return "the block slides at the start until friction holds it"


def summary_lines(case: SpringSliderCase, runs: Mapping[str, Run]) -> list[Shown | str]:
    """Return the lines that a command prints: exact events of the first cycle and, for one model alone, the jump."""
    if len(runs) > 1:
        return []
    found: list[Shown | str] = []
    for run in runs.values():
        if run.native is not None:
            rows = [
                (event.kind, f"{event.stage_before} → {event.stage_after}", f"{event.temperature_change_K:.6f}",
                 f"{event.time_s:.6f}", f"{event.displacement_m:.6e}", f"{event.axial_force_N:.4f}")
                for event in run.native.events if event.time_s <= case.period_s
            ]
            headings = ("event", "stage", "ΔT [K]", "time [s]", "displacement [m]", "axial force [N]")
            found.append(Shown(f"{case.title}: events of the first cycle", headings, rows, left=("event", "stage")))
        if case.ending is not None:
            found.append(f"displacement at the program's end, {case.ending.temperature_change_K:.6g} K: "
                         f"{run.summary[AT_END]:.6e} m")
        if case.has_jump:
            returned = " and the return" if case.ending is not None else ""
            found.append(f"state jump: {run.summary['state_jump_m']:.6e} m after {case.thermal.cycles} cycle(s)"
                         f"{returned}")
    return found


def event_reason(case: SpringSliderCase, event: Event, model: str, runs: Mapping[str, Run]) -> str:
    """Return the reason why only one of the models reports an event; "" if the reason is unknown."""
    if event.kind in ("stop_unloaded", "force_sign_change", "cycle_end", "play_opened", "play_closed") and (
            model == "reduced"):
        return Note("stage_of_reduced_model")
    if model != "dem" or event.kind not in ("stick", "slip") or event.joint != "floor":
        return ""
    run = runs[model]
    nearest = int(np.argmin(np.abs(run.time_s - event.time_s)))
    if AT_STOP not in run.contacts["state"].values[nearest]:
        return ""
    return Note("stop_carries")


def charts(case: SpringSliderCase) -> list[Chart]:
    """Return displacement and axial force over temperature and over time."""
    displacement, force = Axis("displacement_m"), Axis("axial_force_N")
    return [
        Chart(TEMPERATURE, displacement, "Displacement-temperature loop", marks=True),
        Chart(TEMPERATURE, force, "Force-temperature loop", marks=True),
        Chart(TIME, displacement, "Displacement over time", stages=True),
        Chart(TIME, force, "Axial force over time", stages=True),
    ]
