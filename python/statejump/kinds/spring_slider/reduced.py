# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduced model of a ``spring_slider`` case: the exact quasi-static path."""
from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from statejump import _engine
from statejump.kinds.limits import WHOLE_HISTORY
from statejump.core.notes import Note
from statejump.core.progress import OnProgress
from statejump.core.run import Events, Run
from statejump.core.thermal import program
from statejump.kinds.spring_slider import result
from statejump.kinds.spring_slider.case import SpringSliderCase


def spring_slider(case: SpringSliderCase) -> _engine.SpringSlider:
    """Return the engine's model of a case."""
    return _engine.SpringSlider(
        young_modulus_Pa=case.link.young_modulus_Pa,
        cross_section_area_m2=case.link.cross_section_area_m2,
        stress_free_length_m=case.link.stress_free_length_m,
        thermal_expansion_per_K=case.thermal_expansion_per_K,
        friction_force_N=case.friction_force_N,
        clearance_minus_m=case.joint.clearance_minus_m,
        clearance_plus_m=case.joint.clearance_plus_m,
        preload_stiffness_N_per_m=case.joint.preload_stiffness_N_per_m,
        preload_force_N=case.joint.preload_force_N,
        start_friction=case.start.friction,
        stop_stiffness_N_per_m=inf if case.joint.stop_stiffness_N_per_m is None else case.joint.stop_stiffness_N_per_m,
        play_m=case.joint.play_m,
    )


def warnings(case: SpringSliderCase) -> list[str]:
    """Return warnings about settings of the case that the reduced model ignores."""
    said: list[str] = []
    start = spring_slider(case).start_displacement_m
    if start in (-case.joint.clearance_minus_m, case.joint.clearance_plus_m):
        said.append(Note("starts_at_stop"))
    changes = [
        abs(case.clearance_m(side, change) - case.clearance_m(side, 0.0))
        for side in (-1, 1)
        for change in case.temperature_range_K
    ]
    if max(changes) > 0:
        said.append(Note("clearances_kept", change_m=float(max(changes))))
    return said


def buckling(path: _engine.SpringSliderPath) -> list[Note]:
    """Return the warning that the bar would buckle if nothing guided it."""
    found = path.exceeded_euler_load
    if found is None:
        return []
    ends = "clamped-clamped" if found["axial_force_N"] > found["clamped_N"] else "pinned-pinned"
    return [Note("euler_load_exceeded", ends=ends, **found)]


def solve(case: SpringSliderCase, times_s: np.ndarray | None = None) -> _engine.SpringSliderPath:
    """Return the exact path of a case: segments, events, state jump.

    :param times_s: times that the caller needs. The path keeps only the cycles of these times, and the first two and
        the last cycle; None: all cycles
    """
    wanted = None if is_whole(case) else times_s
    if case.expansion is None:
        return _engine.solve_spring_slider(spring_slider(case), case.thermal_program(), wanted)
    followed = program(case.bar_program, case.period_s)
    return _engine.solve_spring_slider(spring_slider(case), followed, wanted, case.thermal_program())


def is_whole(case: SpringSliderCase) -> bool:
    """Return whether a history has all cycles."""
    return case.dem_settings.samples_per_cycle * case.thermal.cycles <= WHOLE_HISTORY


def sample_times(case: SpringSliderCase) -> np.ndarray:
    """Return evenly spaced times [s], as many as the DEM run has samples. A very long history has only the times of the
    first and the last cycles."""
    samples, cycles = case.dem_settings.samples_per_cycle, case.thermal.cycles
    if is_whole(case):
        return np.linspace(0, case.duration_s, samples * cycles + 1)
    shown = cycles_shown(case)
    cycle = np.arange(shown * samples + 1) / samples
    times: np.ndarray = np.concatenate((cycle, cycles - shown + cycle)) * case.period_s
    return times


def cycles_shown(case: SpringSliderCase) -> int:
    """Return how many cycles a history keeps at each of its ends, if it omits the cycles between."""
    return min(max(WHOLE_HISTORY // (10 * case.dem_settings.samples_per_cycle), 1), case.thermal.cycles // 2)


def run(case: SpringSliderCase, on_progress: OnProgress) -> Run:
    """Return the exact path as a run, exact also between samples."""
    times = sample_times(case)
    found = _run_at(case, times)
    if not is_whole(case):
        found = _without_what_is_between(case, found)
    on_progress(1.0)
    return found


def _without_what_is_between(case: SpringSliderCase, run: Run) -> Run:
    """Remove the events of the cycles that a run omits, and add a warning about the omission."""
    shown, cycles = cycles_shown(case), case.thermal.cycles
    first, last = shown * case.period_s, (cycles - shown) * case.period_s
    events = Events([event for event in run.events if event.time_s <= first or event.time_s > last])
    said = Note("cycles_left_out", shown=shown, cycles=cycles)
    return replace(run, events=events, warnings=(*run.warnings, said))


def quick(case: SpringSliderCase) -> Run:
    """Return the exact path as a run with only two samples: start and end."""
    return _run_at(case, np.array([0.0, case.duration_s]))


def _run_at(case: SpringSliderCase, times_s: np.ndarray) -> Run:
    path = solve(case, times_s)
    columns = path.sample(np.asarray(times_s, dtype=float))
    return result.reduced_run(case, path, columns, (*buckling(path), *warnings(case)),
                              lambda times: _run_at(case, times))


def number_of_samples(case: SpringSliderCase) -> int:
    """Return how many samples a run has."""
    return len(sample_times(case))
