# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduced model of a ``spring_slider`` case: the exact quasi-static path."""
from __future__ import annotations

import numpy as np

from statejump import _engine
from statejump.core.progress import Tell
from statejump.core.run import Run
from statejump.kinds.spring_slider import result
from statejump.kinds.spring_slider.case import SpringSliderCase


def spring_slider(case: SpringSliderCase) -> _engine.SpringSlider:
    """Return the engine's model of a case."""
    return _engine.SpringSlider(
        young_modulus_Pa=case.link.young_modulus_Pa,
        cross_section_area_m2=case.link.cross_section_area_m2,
        stress_free_length_m=case.link.stress_free_length_m,
        thermal_expansion_per_K=case.link.thermal_expansion_per_K,
        friction_force_N=case.friction_force_N,
        clearance_minus_m=case.joint.clearance_minus_m,
        clearance_plus_m=case.joint.clearance_plus_m,
        preload_stiffness_N_per_m=case.joint.preload_stiffness_N_per_m,
    )


def warnings(case: SpringSliderCase) -> list[str]:
    """Return what the case asks for and the reduced model leaves out, as sentences."""
    changes = [
        abs(case.clearance_m(side, change) - case.clearance_m(side, 0.0))
        for side in (-1, 1)
        for change in case.temperature_range_K
    ]
    if max(changes) == 0:
        return []
    return [
        "the reduced model keeps the clearances of the reference temperature; expansion of pad and "
        f"slot changes them by up to {max(changes):.3g} m in the DEM"
    ]


def solve(case: SpringSliderCase) -> _engine.SpringSliderPath:
    """Return the exact path of a case: segments, events, state jump."""
    return _engine.solve_spring_slider(spring_slider(case), case.thermal_program())


def sample_times(case: SpringSliderCase) -> np.ndarray:
    """Return as many evenly spaced times as the DEM run has samples [s]."""
    return np.linspace(0, case.duration_s, case.dem.samples_per_cycle * case.thermal.cycles + 1)


def run(case: SpringSliderCase, tell: Tell) -> Run:
    """Return the exact path as a run; at other times it is as exact."""
    found = _run_at(case, sample_times(case))
    tell(1.0)
    return found


def quick(case: SpringSliderCase) -> Run:
    """Return the exact path as a run of two samples, its ends."""
    return _run_at(case, np.array([0.0, case.duration_s]))


def _run_at(case: SpringSliderCase, times_s: np.ndarray) -> Run:
    path = solve(case)
    said = (*path.warnings, *warnings(case))

    def sampled(times_s: np.ndarray) -> Run:
        columns = path.sample(np.asarray(times_s, dtype=float))
        return result.reduced_run(case, path, columns, said, sampled)

    return sampled(times_s)
