# SPDX-License-Identifier: GPL-3.0-or-later
"""Prediction of another test of an identified joint, and intervals of joints that change from cycle to cycle."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import statejump as sj
from statejump.cli.identify import identify_command
from statejump.identification.fit import Fits, intervals
from statejump.identification.hysteresis import remembered
from statejump.identification.loop import read_loop
from statejump.identification.models import MODELS
from statejump.identification.noise import between_cycles, cycles_of
from statejump.identification.prediction import work

ROWS = 80  # of a cycle
JOINT = {"stiffness": 1e6, "friction": 100.0, "preload": 5.0}


def path(cycles: int) -> np.ndarray:
    return 1e-3 * np.sin(2 * np.pi * np.arange(cycles * ROWS + 1) / ROWS)


def changing(cycles: int, spread: float, seed: int, noise_N: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return path and force of a joint whose friction differs between cycles, with slow noise."""
    rng = np.random.default_rng(seed)
    moved = path(cycles)
    factors = np.repeat(1 + spread * rng.normal(size=cycles + 1), ROWS)[:len(moved)]
    force = MODELS["coulomb"].answer(JOINT, moved, remembered(moved, False))
    noise = np.convolve(rng.normal(size=len(moved) + 4), np.ones(5) / 5**0.5, "valid")
    return moved, 5.0 + (force - 5.0) * factors + noise_N * noise


@pytest.mark.parametrize("cycles", (1, 3, 8))
def test_cycles_are_counted_from_reversals(cycles: int) -> None:
    moved = path(cycles) + 1e-6 * np.random.default_rng(1).normal(size=cycles * ROWS + 1)
    found = cycles_of(moved)
    assert found[0] == 0 and (np.diff(found) >= 0).all()
    # The first cycle begins at the first row and ends at the third reversal.
    assert found[-1] == max(0, cycles - 1) and (np.bincount(found)[1:-1] == pytest.approx(ROWS, abs=2))


def test_independent_residuals_have_no_change_between_cycles() -> None:
    rng = np.random.default_rng(3)
    cycles = np.repeat(np.arange(40), 25)
    factors = [between_cycles(rng.normal(size=1000), rng.normal(size=1000), cycles) for _ in range(50)]
    assert np.mean(factors) == pytest.approx(1.0, abs=0.1)
    assert between_cycles(np.ones(50), np.ones(50), np.repeat([0, 1], 25)) == 0.0


def test_intervals_contain_the_friction_of_joints_that_change() -> None:
    """12 loops of 5 cycles, friction ±3 % from cycle to cycle. Intervals at 95 % should contain the mean friction in
    11.4 loops."""
    inside = 0
    for seed in range(12):
        moved, force = changing(5, 0.03, seed)
        fits = Fits(read_loop({"displacement_m": moved, "force_N": force}, "cycled"))
        found = intervals(fits, "coulomb", 0.95, ["friction"])[1]
        interval = found.of["friction"]
        inside += interval.low <= JOINT["friction"] <= interval.high
    assert inside >= 10


def test_prediction_contains_force_and_loss_of_another_test() -> None:
    """6 pairs of tests; the intervals are at 95 %."""
    inside, rows = 0, []
    for seed in range(6):
        moved, force = changing(5, 0.03, seed)
        found = sj.identify({"displacement_m": moved, "force_N": force}, model="coulomb", start="cycled")
        other, measured = changing(4, 0.03, 100 + seed)
        made = found.predict(other)
        inside += abs(work(measured, other) - made.loss_J) <= made.loss_error_J
        rows.append(made.contains(measured))
        assert made.loss_error_J < 0.2 * made.loss_J
    assert inside >= 5 and np.mean(rows) > 0.91


def test_loop_of_one_cycle_predicts_with_the_interval_of_its_friction() -> None:
    moved, force = changing(1, 0.0, 1)
    found = sj.identify({"displacement_m": moved, "force_N": force}, model="coulomb", start="fresh")
    made = found.predict(2 * moved)
    interval = found.intervals["friction"]
    own = work(force, moved) / work(found.answer(), moved) - 1
    relative = np.hypot(own, (interval.high - interval.low) / 2 / found.values["friction"])
    assert made.loss_error_J == pytest.approx(relative * made.loss_J)


def test_command_compares_with_another_test(tmp_path: Path) -> None:
    for name, seed in (("one", 1), ("other", 2)):
        moved, force = changing(4, 0.02, seed)
        np.savetxt(tmp_path / f"{name}.csv", np.column_stack((moved, force)), delimiter=",",
                   header="displacement_m,force_N", comments="")
    done = CliRunner().invoke(identify_command, [
        str(tmp_path / "one.csv"), "--model", "coulomb", "--predict", str(tmp_path / "other.csv"), "--results",
        str(tmp_path / "results")], catch_exceptions=False)
    assert done.exit_code == 0 and "prediction of other" in done.output and "energy loss" in done.output
    (written,) = (tmp_path / "results").rglob("prediction.csv")
    rows = np.genfromtxt(written, delimiter=",", names=True)
    assert rows.dtype.names == ("displacement_m", "force_N", "predicted_force_N", "low_N", "high_N")
    assert (rows["low_N"] < rows["predicted_force_N"]).all() and len(rows) == 4 * ROWS + 1
