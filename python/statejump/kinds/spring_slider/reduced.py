# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduced model of a case: the exact quasi-static path."""
from __future__ import annotations

import numpy as np

from statejump import _engine
from statejump.schema.fields import Case
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.core.history import History


def thermal_program(case: Case) -> _engine.ThermalProgram:
    """Temperature program of a case of any kind."""
    thermal = case.thermal
    if thermal.shape == "table":
        return _engine.ThermalProgram(
            shape="table",
            cycles=thermal.cycles,
            table_time_s=case.table_time_s,
            table_temperature_change_K=thermal.table_temperature_change_K,
        )
    return _engine.ThermalProgram(
        shape=thermal.shape,
        temperature_change_max_K=thermal.temperature_change_max_K,
        period_s=case.period_s,
        cycles=thermal.cycles,
    )


def spring_slider(case: SpringSliderCase) -> _engine.SpringSlider:
    """Reduced model of a ``spring_slider`` case."""
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
    """What the case asks for and the reduced model leaves out, as sentences."""
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
    """Exact path of a case: segments, events, state jump."""
    return _engine.solve_spring_slider(spring_slider(case), thermal_program(case))


def sample(path: _engine.SpringSliderPath, times_s: np.ndarray) -> History:
    """History of a path at the given times [s]; exact at any sampling."""
    columns = path.sample(np.asarray(times_s, dtype=float))
    return History({name: np.asarray(values) for name, values in columns.items()})


def sample_times(case: SpringSliderCase) -> np.ndarray:
    """As many evenly spaced times as the DEM run has samples [s]."""
    cycles = case.thermal.cycles
    return np.linspace(0, case.dem.period_s * cycles, case.dem.samples_per_cycle * cycles + 1)
