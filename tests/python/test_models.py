# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduced model through the package, comparison logic, and written files."""
from __future__ import annotations

import csv
import dataclasses
import gc
import json
from pathlib import Path

import numpy as np
import pytest

from failures import failing, note
from statejump import _engine
from statejump.core.comparison import Comparison
from statejump.core.figures import save
from statejump.core.output import write_atomically
from statejump.core.run import Run
from statejump.core.table_files import read_columns
from statejump.kinds.loading import load_case
from statejump.kinds.spring_slider import compare, dem, reduced, result, stable_step
from statejump.kinds.spring_slider.case import SpringSliderCase as Case

E, A, L0, ALPHA, FRICTION, CLEARANCE = 70e9, 9e-6, 0.5, 23.4e-6, 30.0, 1e-3
# Closed forms of a few operations: rounding of a few units in the last place each.
RELATIVE = 1e-12


@pytest.fixture
def table1(cases: Path) -> Case:
    return load_case(cases / "table1.toml")


def first(path: _engine.SpringSliderPath, kind: str) -> float:
    return next(event.temperature_change_K for event in path.events if event.kind == kind)


def test_table1_events_and_jump(table1: Case) -> None:
    path = reduced.solve(table1)
    rigidity = E * A
    assert path.state_jump_m == pytest.approx(FRICTION * L0 / rigidity, rel=RELATIVE)
    assert path.state_jump_m == pytest.approx(2.380952e-5, rel=2e-7)
    # x_T = l0 a dT, l_T = l0 (1 + a dT): E A x_T = +-f l_T + E A x, linear in dT
    assert first(path, "first_slip") == pytest.approx(FRICTION / (ALPHA * (rigidity - FRICTION)), rel=RELATIVE)
    for kind, sign, printed in (("stop_reached", 1, 87.509255), ("stop_left", -1, 83.431111)):
        exact = (CLEARANCE / L0 * rigidity + sign * FRICTION) / (ALPHA * (rigidity - sign * FRICTION))
        assert first(path, kind) == pytest.approx(exact, rel=RELATIVE)
        assert exact == pytest.approx(printed, abs=1e-6)


def test_wide_clearance_never_meets_the_stop(cases: Path) -> None:
    path = reduced.solve(load_case(cases / "table1_wide.toml"))
    assert path.state_jump_m == pytest.approx(FRICTION * L0 / (E * A), rel=RELATIVE)
    assert not any(event.kind.startswith("stop") for event in path.events)


def test_preload_reduces_the_jump(table1: Case) -> None:
    path = reduced.solve(table1.changed({"joint.preload_stiffness_N_per_m": 2e6}))
    assert path.state_jump_m == pytest.approx(FRICTION / (E * A / L0 + 2e6), rel=RELATIVE)


def test_table_program_lasts_as_long_as_its_times_say(cases: Path, edited) -> None:
    path = edited(('"half_sine"', '"table"'), ("temperature_change_max_K = 100",
                  "table_time_s = [0, 3000, 5400]\ntable_temperature_change_K = [0, 100, 0]"),
                  ("period_s = 1.0", ""))
    case = load_case(path)
    assert case.period_s == 5400 and case.thermal.table_time_s == [0, 3000, 5400]
    assert reduced.solve(case).state_jump_m == pytest.approx(FRICTION * L0 / (E * A), rel=RELATIVE)
    assert case.thermal_program().temperature_change(3000.0) == pytest.approx(100.0, rel=RELATIVE)
    assert dem.dem_input(case)["thermal"]["table_time_s"] == case.thermal.table_time_s


def test_expanding_pads_are_announced(table1: Case) -> None:
    assert reduced.warnings(table1) == []
    case = table1.changed({"joint.pad_thermal_expansion_per_K": 1e-5})
    assert reduced.warnings(case) == [note("clearances_kept", change_m=pytest.approx(1e-5 * table1.joint.pad_radius_m * 100, rel=1e-9))]


def test_steps_fill_the_program_exactly(table1: Case) -> None:
    steps = dem.number_of_steps(table1)
    assert steps % table1.dem_settings.samples_per_cycle == 0
    wanted = table1.dem_settings.time_step_fraction * stable_step.stable_time_step(table1)
    assert 0 < dem.time_step(table1) <= wanted


Columns = dict[str, np.ndarray]


def exact_run(case: Case) -> Run:
    return reduced.run(case, lambda share: None)


def synthetic(case: Case) -> Columns:
    """Columns of a DEM run that equals the reduced model."""
    path = reduced.solve(case)
    columns = exact_run(case).flat()
    count = len(columns["time_s"])
    stage = columns.pop("stage")
    columns["slipping"] = (np.isin(stage, ("S2", "S5"))).astype(float)
    columns["stop_contact"] = np.zeros(count)
    reached, left = first(path, "stop_reached"), first(path, "stop_left")
    half = count // 2
    change = columns["temperature_change_K"]
    columns["stop_contact"][:half] = change[:half] >= reached
    columns["stop_contact"][half:] = change[half:] >= left
    for name in ("contact_energy_J", "kinetic_energy_J", "damping_dissipation_J", "external_work_J"):
        columns[name] = np.zeros(count)
    return columns


def compared(case: Case, columns: Columns) -> Comparison:
    return compare.compare(case, exact_run(case), result.dem_run(case, columns, {}))


def missed(case: Case, columns: Columns) -> list[str]:
    return compared(case, columns).missed


def test_equal_histories_pass(table1: Case) -> None:
    assert missed(table1, synthetic(table1)) == []


def test_each_tolerance_can_be_missed(table1: Case) -> None:
    history = synthetic(table1)
    x, change = history["displacement_m"], history["temperature_change_K"]
    last = np.zeros_like(x)
    last[-1] = 1.01 * 0.005 * x[-1]
    assert missed(table1, {**history, "displacement_m": x + last}) == ["state_jump"]
    late = ((change > 2.7) & (np.arange(len(x)) < len(x) // 2)).astype(float)
    assert missed(table1, {**history, "slipping": late}) == ["first_slip_temperature_change"]
    never = np.zeros_like(x)
    assert missed(table1, {**history, "stop_contact": never}) == [
        "stop_reached_temperature_change", "stop_left_temperature_change"]
    wave = 0.015e-3 * np.sin(np.linspace(0, np.pi, len(x)))  # 1.06 % of 1 mm in RMS
    assert missed(table1, {**history, "displacement_m": x + wave}) == ["displacement_rms_over_largest"]
    work = history["thermal_work_J"] * 1.0011
    assert missed(table1, {**history, "thermal_work_J": work}) == ["energy_residual_over_friction_work"]
    broken = x.copy()
    broken[1000] = np.nan
    assert "displacement_rms_over_largest" in missed(table1, {**history, "displacement_m": broken})


def test_drift_of_later_cycles_is_noticed(cases: Path) -> None:
    case = load_case(cases / "table1_ten_cycles.toml")
    columns = exact_run(case).flat()
    columns["slipping"] = columns["stop_contact"] = np.zeros(len(columns["time_s"]))
    del columns["stage"]
    x = columns["displacement_m"]

    def drift_of(displacement_m: np.ndarray) -> float:
        run = result.dem_run(case, {**columns, "displacement_m": displacement_m}, {})
        return compare.loop_drift(run, case.dem_settings.samples_per_cycle, 10)

    assert drift_of(x) < 1e-15  # the exact loop closes to the rounding of 1 mm
    drift = drift_of(x + np.linspace(0, 1e-5, len(x)))
    assert drift == pytest.approx(8e-6, rel=1e-3)  # eight periods of 1e-5 / 10 each


def test_comparison_files(table1: Case, tmp_path: Path) -> None:
    found = compared(table1, synthetic(table1))
    first_row = found.rows[0]
    bad = dataclasses.replace(first_row, values={**first_row.values, "dem": None}, difference=None, passed=False)
    dataclasses.replace(found, rows=(bad, *found.rows[1:])).write(tmp_path)
    document = json.loads((tmp_path / "comparison.json").read_text())
    assert document["pass"] is False and document["case"] == "table1"
    assert list(document["quantities"][0]) == ["name", "unit", "reduced", "dem", "difference", "tolerance", "pass"]
    assert document["quantities"][0]["name"] == "state_jump"
    with (tmp_path / "comparison.csv").open() as stream:
        rows = list(csv.reader(stream))
    assert rows[0] == ["name", "unit", "reduced", "dem", "difference", "tolerance", "pass"]
    assert rows[1][3:5] == ["", ""] and rows[1][-1] == "False"


def test_history_survives_its_file(table1: Case, tmp_path: Path) -> None:
    run = exact_run(table1).at(np.linspace(0, 1, 7))
    run.write_csv(tmp_path / "h.csv")
    again = read_columns(tmp_path / "h.csv")
    assert list(again) == list(run.flat())
    for name, values in run.flat().items():
        assert np.array_equal(values, again[name]), name
    (tmp_path / "x.csv").write_text("time_s,colour\n")
    with failing("no_samples", file="x.csv"):
        read_columns(tmp_path / "x.csv")


def test_a_failed_write_leaves_nothing(tmp_path: Path) -> None:
    target = tmp_path / "table.csv"
    target.write_text("old")
    with pytest.raises(RuntimeError):
        with write_atomically(target) as stream:
            stream.write("new, half")
            raise RuntimeError("stop here")
    assert target.read_text() == "old"
    with failing("write_failed"):
        with write_atomically(tmp_path / "no" / "folder.csv") as stream:
            stream.write("x")
    assert [entry.name for entry in tmp_path.iterdir()] == ["table.csv"]


def test_figure_shows_both_models_and_repeats_bit_for_bit(table1: Case, tmp_path: Path) -> None:
    found = compared(table1, synthetic(table1))
    png, svg = save(found.plot(), tmp_path, "table1")
    text = svg.read_text()
    for label in ("reduced model (exact)", "DEM (YADE)", "S1", "S5", "stop", "Temperature change [K]",
                  "Axial force, compression positive [N]", "state jump 23.81"):
        assert label in text, label
    assert png.stat().st_size > 20_000
    before = text
    save(found.plot(), tmp_path, "table1")
    assert svg.read_text() == before


def test_figure_that_has_gone_leaves_nothing(table1: Case, tmp_path: Path) -> None:
    """matplotlib's own constrained layout would leave two grids of each drawing."""
    def grids() -> int:
        gc.collect()
        return sum(type(one).__name__ == "LayoutGrid" for one in gc.get_objects())

    found, before = compared(table1, synthetic(table1)), grids()
    save(found.plot(), tmp_path, "table1")
    assert grids() == before


def test_units_are_shown_on_screen(statejump, cases: Path) -> None:
    shown = statejump("reduced", cases / "table1.toml").output
    for heading in ("ΔT [K]", "time [s]", "displacement [m]", "axial force [N]"):
        assert heading in shown
