# SPDX-License-Identifier: GPL-3.0-or-later
"""Convergence of the DEM: table and text are derived from the case and the numbers."""
from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import statejump as sj
from statejump.core.run import Column, Run
from statejump.kinds.spring_slider import result
from statejump.kinds.spring_slider.case import SpringSliderCase
from studies.paper import convergence


def dem_like(case: SpringSliderCase, error_m: float) -> Run:
    """The exact run in the form of a DEM run, with a known error that grows with time."""
    exact = case.reduced()
    columns = exact.flat()
    stage = columns.pop("stage")
    columns["slipping"] = np.isin(stage, ("S2", "S5")).astype(float)
    columns["stop_contact"] = (columns["stop_force_N"] != 0).astype(float)
    for name in ("contact_energy_J", "kinetic_energy_J", "damping_dissipation_J", "external_work_J"):
        columns[name] = np.zeros(len(stage))
    run = result.dem_run(case, columns, {})
    off = error_m * np.linspace(0, 1, len(stage))
    moved = Column(columns["displacement_m"] + off, "m")
    jump = {"state_jump_m": run.summary["state_jump_m"] + error_m}
    return replace(run, history={**run.history, "displacement_m": moved}, summary={**run.summary, **jump})


def found_of(case: SpringSliderCase) -> convergence.Convergence:
    """A study whose errors decrease with the heating rate and are proportional to the time step."""
    slower, finer = convergence.variants(case)
    runs = ([dem_like(variant, 1e-8 / (1 + place)) for place, variant in enumerate(slower)],
            [dem_like(variant, 1e-8 * variant.dem_settings.time_step_fraction) for variant in finer])
    return convergence.compared(case, (slower, finer), runs)


@pytest.fixture(scope="module")
def table1() -> SpringSliderCase:
    case = sj.load("table1").definition
    assert isinstance(case, SpringSliderCase)
    return case


def test_variants_change_the_period_and_the_step_alone(table1: SpringSliderCase) -> None:
    slower, finer = convergence.variants(table1)
    assert [case.period_s / table1.period_s for case in slower] == list(convergence.PERIOD_FACTORS)
    assert [case.dem_settings.time_step_fraction for case in finer] == list(convergence.STEP_FRACTIONS)
    assert {case.period_s for case in finer} == {table1.period_s / 16}
    slower, finer = convergence.variants(table1, decades=2)
    assert [case.period_s / table1.period_s for case in slower[-3:]] == [4, 40, 400]
    assert [case.dem_settings.time_step_fraction for case in finer[-3:]] == pytest.approx([0.025, 0.0025, 0.00025])
    data = table1.to_dict()
    data["thermal"] = {"shape": "table", "table_time_s": [0, 2.0, 4.0], "table_temperature_change_K": [0, 100.0, 0]}
    data["dem"] = {}
    slower, _ = convergence.variants(sj.load(data).definition)
    assert [case.period_s for case in slower] == [4 * factor for factor in convergence.PERIOD_FACTORS]


def test_table_and_text_follow_from_the_numbers(table1: SpringSliderCase, tmp_path: Path) -> None:
    found = found_of(table1)
    table, text = found.write(tmp_path)
    with table.open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 12 and rows[0]["displacement_rms_from_finest_step_m"] == rows[-1]["first_slip_error_K"] == ""
    # The jump has an error of 1e-8 m; the jump is 30 N / 1.26 MN/m.
    assert float(rows[0]["state_jump_error_relative"]) == pytest.approx(1e-8 / (30 / 1.26e6), rel=1e-6)
    said = text.read_text()
    assert "`statejump convergence cases/table1.toml`" in said
    assert "falls, 0.00042 to 7e-05" in said
    # Hertz: (100 N / (4/3 E* sqrt(50 mm)))^(2/3), E* = 38.46 GPa; -(0.3 δ + δ²/(2 jump)) / 0.5 m
    depth = (100 / (4 / 3 * 70e9 / (2 * 0.91) * math.sqrt(0.05))) ** (2 / 3)
    share = -(0.3 * depth + depth**2 / (2 * 30 / 1.26e6)) / 0.5
    assert "δ = 4.2 µm" in said and f"{share:.2g} of" in said and f"{share:.2g}" == "-3.3e-06"
    # Errors that grow instead are reported as such.
    worse = replace(found, slower=tuple(reversed(found.slower)))
    assert "not fall, 7e-05 to 0.00042" in "\n".join(convergence.explanation(worse))


def test_text_of_another_case(table1: SpringSliderCase, tmp_path: Path) -> None:
    data = table1.to_dict()
    data["joint"]["friction_coefficient"] = 0.0
    data["joint"]["clearance_plus_m"] = data["joint"]["clearance_minus_m"] = 0.1
    case = sj.load(data).definition
    assert isinstance(case, SpringSliderCase)
    _, text = found_of(case).write(tmp_path)
    said = text.read_text()
    assert "Made by `statejump convergence`" in said and "first slip" not in said.rpartition("What stays")[2]
    assert "stop" not in said.rpartition("What stays")[2] and "normal force" not in said
