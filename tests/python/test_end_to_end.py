# SPDX-License-Identifier: GPL-3.0-or-later
"""End-to-end runs through YADE: the promised results for Table 1."""
from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest

from conftest import REPOSITORY, results_in
from failures import failure
from statejump.core.table_files import read_columns

CASES = ("table1", "table1_wide", "table1_frictionless", "table1_ten_cycles")


def quantities(folder: Path) -> dict[str, dict]:
    document = json.loads((folder / "comparison.json").read_text())
    return {entry["name"]: entry for entry in document["quantities"]}


@pytest.mark.parametrize("name", CASES)
def test_compare(statejump, cases: Path, tmp_path: Path, name: str) -> None:
    outcome = statejump("compare", cases / f"{name}.toml")
    assert outcome.status == 0, outcome.output + outcome.errors
    folder = tmp_path / "results" / name
    found = quantities(folder)
    assert results_in(folder) == sorted([
        "comparison.csv", "comparison.h5", "comparison.json", "dem_history.csv", "dem_run.json", "reduced_history.csv",
        f"{name}.png", f"{name}.svg"])
    jump = found["state_jump"]
    if name == "table1_frictionless":
        assert abs(jump["dem"]) < 1e-9
    else:
        assert jump["dem"] == pytest.approx(2.380952e-5, rel=0.005)
        assert abs(found["first_slip_temperature_change"]["difference"]) < 0.5
        assert abs(found["energy_residual_over_friction_work"]["dem"]) < 0.001
    if name in ("table1", "table1_ten_cycles"):
        assert found["stop_reached_temperature_change"]["dem"] == pytest.approx(87.509255, abs=0.5)
        assert found["stop_left_temperature_change"]["dem"] == pytest.approx(83.431111, abs=0.5)
    if name == "table1_wide":
        assert found["stop_reached_temperature_change"]["dem"] is None
    assert found["displacement_rms_over_largest"]["dem"] < 0.01
    if name == "table1_ten_cycles":
        assert found["loop_drift_over_largest_displacement"]["dem"] < 1e-4


def test_a_missed_tolerance_is_named(statejump, edited) -> None:
    # The pads of the stop penetrate by micrometres, so an RMS tolerance of 1e-4 cannot be met.
    path = edited(("displacement_rms_relative = 0.01", "displacement_rms_relative = 1e-4"),
                  ("period_s = 1.0", "period_s = 0.1"))
    outcome = statejump("compare", path)
    assert outcome.status == 1
    assert outcome.failure == failure("tolerance_missed") and "displacement_rms_over_largest" in outcome.errors


def test_preload_spring_in_the_dem(statejump, edited, tmp_path: Path) -> None:
    path = edited(("clearance_plus_m = 1e-3", "clearance_plus_m = 1e-3\npreload_stiffness_N_per_m = 1e6"),
                  ("period_s = 1.0", "period_s = 0.25"))
    outcome = statejump("compare", path)
    assert outcome.status == 0, outcome.output + outcome.errors
    jump = quantities(tmp_path / "results" / "table1")["state_jump"]
    assert jump["reduced"] == pytest.approx(30 / (1.26e6 + 1e6), rel=1e-12)
    assert jump["dem"] == pytest.approx(jump["reduced"], rel=0.005)


def started(friction: str) -> tuple[str, str]:
    """Return the edit that selects the initial friction."""
    return "[thermal]", f'[start]\nfriction = "{friction}"\n\n[thermal]'


@pytest.mark.parametrize("friction, jump_N", [("stuck", 60.0), ("frictionless", 30.0)])
def test_preload_force_in_the_dem(statejump, edited, tmp_path: Path, friction: str, jump_N: float) -> None:
    # Both models start at 630 or 600 N over 1.26e6 + 2e5 N/m, beyond the middle, so the stop + is reached at a lower
    # temperature. If friction carried load at the start, it changes from one limit to the other.
    path = edited(("clearance_plus_m = 1e-3", "clearance_plus_m = 1e-3\npreload_force_N = -630\n"
                   "preload_stiffness_N_per_m = 2e5"), ("period_s = 1.0", "period_s = 0.25"), started(friction))
    outcome = statejump("compare", path)
    assert outcome.status == 0, outcome.output + outcome.errors
    found = quantities(tmp_path / "results" / "table1")
    assert found["state_jump"]["reduced"] == pytest.approx(jump_N / 1.46e6, rel=1e-12)
    with_none = 87.5092 + 0.2  # without a force, and rounded up
    assert found["stop_reached_temperature_change"]["dem"] < with_none - 25


@pytest.mark.parametrize("friction, carried_N", [("stuck", 30.0), ("frictionless", 0.0)])
def test_block_that_a_preload_force_seats_on_a_stop_in_the_dem(
    statejump, edited, tmp_path: Path, friction: str, carried_N: float
) -> None:
    path = edited(("clearance_plus_m = 1e-3", "clearance_plus_m = 1e-3\npreload_force_N = 1350"),
                  ("period_s = 1.0", "period_s = 0.25"), started(friction))
    outcome = statejump("dem", path)
    assert outcome.status == 0, outcome.output + outcome.errors
    history = read_columns(tmp_path / "results" / "table1" / "dem_history.csv")
    x, stop = history["displacement_m"], history["stop_force_N"]
    depth = -1e-3 - x
    # Of the 1350 N the bar carries k (c + depth), friction its part, and the stop the rest from the first step on,
    # except for the heating in one step, 1e-6 of it.
    assert stop[0] == pytest.approx(1350 - carried_N - 1.26e6 * (1e-3 + depth[0]), abs=1e-4)
    # The first sample heats by 0.157 K, 2.3 N in the bar. An error of the start would move the block by more than the
    # compliance of a Hertzian stop, depth/(3/2 F), allows.
    assert abs(x[1] - x[0]) < 2.32 / (1.5 * stop[1] / depth[1])
    # The block returns to the stop. Friction carries f at the end, so the stop carries less, and the jump is its change
    # of depth if friction carried nothing at the start. 1 N: at the end friction is that far from its limit, because
    # the tangential spring follows the load.
    assert stop[-1] == pytest.approx(1350 - 30 - 1.26e6 * (1e-3 + depth[-1]), abs=1.0)
    # The dashpot of the stop adds 0.04 N, 70 N s/m at 0.5 mm/s.
    assert depth[-1] / depth[0] == pytest.approx((stop[-1] / stop[0]) ** (2 / 3), rel=1e-3)


def test_table_program_in_the_dem(statejump, edited, tmp_path: Path) -> None:
    path = edited(('"half_sine"', '"table"'), ("temperature_change_max_K = 100",
                  "table_time_s = [0, 0.14, 0.25]\ntable_temperature_change_K = [0, 100, 0]"),
                  ("period_s = 1.0", "#"))
    outcome = statejump("compare", path)
    assert outcome.status == 0, outcome.output + outcome.errors


def test_tutorial_script_runs_by_itself(yade: str) -> None:
    environment = {**os.environ, "PYTHONPATH": os.environ["STATEJUMP_PYTHON_DIR"]}
    done = subprocess.run([yade, "-n", "-x", str(REPOSITORY / "yade_scripts" / "examples" / "table1.py")],
                          capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=120, env=environment)
    line = next(line for line in done.stdout.splitlines() if line.startswith("state jump: "))
    assert float(line.split()[2]) == pytest.approx(23.80952, rel=0.005)
