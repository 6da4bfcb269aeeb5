# SPDX-License-Identifier: GPL-3.0-or-later
"""Positions in which friction holds the block of the paper's Table 1: closed form, and what the reduced model reports
about them."""
from __future__ import annotations

from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

import statejump as sj

TABLE1 = "cases/table1.toml"
# Two places a friction limit f = 30 N apart on k = E A/l0 = 1.26e6 N/m, on either side.
LENGTH_m = 2 * 30 / 1.26e6


def test_length_at_the_reference_temperature() -> None:
    found = sj.statics(sj.load(TABLE1))
    # A product and a quotient of numbers that are read exactly: some roundings.
    assert found.largest_jump_m == pytest.approx(LENGTH_m, rel=1e-13)
    jump = sj.load(TABLE1).reduced().summary["state_jump_m"]
    assert jump == pytest.approx(found.largest_jump_m / 2, rel=1e-13)  # from the middle to one end


def test_stop_takes_what_is_beyond_it() -> None:
    row = sj.statics(sj.load(TABLE1)).frame().iloc[-1]
    assert row["temperature_change_K"] == 100.0
    # At 100 K the bar wants 1.17 mm; friction would hold the block down to 23.9 µm below it, the stop is at 1 mm.
    assert (row["from_m"], row["to_m"]) == (1e-3, 1e-3)


def test_every_state_of_the_reduced_model_is_in_its_rest_set() -> None:
    case = sj.load(TABLE1).changed({"joint.preload_stiffness_N_per_m": 3e5})
    run = case.reduced()
    from statejump.kinds.spring_slider.statics import segment

    for change, place in zip(run["temperature_change_K"][::50], run["displacement_m"][::50]):
        allowed = segment(case.definition, case.friction_force_N, change)
        # Sliding states are at an end of it: rounding of the place, of the order of 1 mm.
        assert allowed.from_m - 1e-16 <= place <= allowed.to_m + 1e-16


def test_friction_of_its_own_and_none() -> None:
    case = sj.load(TABLE1)
    assert sj.statics(case, 0.0).largest_jump_m == 0.0
    assert sj.statics(case, 0.6).largest_jump_m == pytest.approx(2 * LENGTH_m, rel=1e-13)


def test_command(statejump: Callable[..., Any], tmp_path: Path) -> None:
    done = statejump("statics", TABLE1)
    assert done.status == 0, done.errors
    assert "47.619 µm" in done.output
    assert (tmp_path / "results" / "table1" / "statics.json").exists()


def test_picture_shows_the_band() -> None:
    figure = sj.statics(sj.load(TABLE1)).plot()
    axes = figure.axes[0]
    assert axes.get_xlabel() == "Temperature change [K]"
    assert np.ptp(axes.dataLim.intervalx) == pytest.approx(100.0)
