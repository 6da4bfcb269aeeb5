# SPDX-License-Identifier: GPL-3.0-or-later
"""A table of temperatures lasts as long as its last time says, in every kind of case and in both models."""
from __future__ import annotations

import numpy as np
import pytest

import statejump as sj

TABLE = {
    "thermal.shape": "table", "thermal.temperature_change_max_K": None, "thermal.table_time_s": [0, 5, 10],
    "thermal.table_temperature_change_K": [0, 100, 0],
}
PERIODS = {"table1": "dem.period_s", "umbrella_damped": "thermal.period_s", "trusses/umbrella_rib": "thermal.period_s"}


@pytest.mark.parametrize("name", PERIODS)
def test_times_of_a_table_are_the_times(name: str) -> None:
    case = sj.load(f"cases/{name}.toml").changed({**TABLE, PERIODS[name]: None})
    assert (case.period_s, case.duration_s, case.thermal_program().period_s) == (10.0, 10.0, 10.0)
    triangle = sj.load(f"cases/{name}.toml").changed(
        {"thermal.shape": "triangle", "thermal.temperature_change_max_K": 100.0, PERIODS[name]: 10.0})
    ours, other = case.reduced(), triangle.reduced()
    assert ours.time_s[-1] == 10.0
    for jump in (key for key in ours.summary if "jump" in key):
        # The same program said in two ways: its corners may differ by a rounding.
        assert ours.summary[jump] == pytest.approx(other.summary[jump], rel=1e-9, abs=1e-15)


def test_length_of_the_cycle_matters() -> None:
    """The damped rib comes back otherwise from a cycle of 10 s than from one of 1 s: to squeeze one into the other
    was wrong physics."""
    case = sj.load("cases/umbrella_damped.toml")
    slow = case.changed({**TABLE, "thermal.period_s": None}).reduced().summary["theta2_jump_rad"]
    fast = case.reduced().summary["theta2_jump_rad"]
    assert abs(slow - fast) > 1e-5


@pytest.mark.parametrize("name", PERIODS)
def test_period_beside_a_table_must_agree(name: str) -> None:
    key = PERIODS[name]
    case = sj.load(f"cases/{name}.toml")
    assert case.changed({**TABLE, key: 10.0}).period_s == 10.0
    with pytest.raises(sj.StatejumpError) as refused:
        case.changed({**TABLE, key: 1.0})
    assert (refused.value.key, refused.value.value) == (key, 1.0)
    assert refused.value.cause == "the table lasts 10 s, and its own times are the times"


def test_what_goes_to_yade_has_the_times_of_the_table() -> None:
    for name, key in PERIODS.items():
        case = sj.load(f"cases/{name}.toml").changed({**TABLE, key: None}).definition
        if case.kind == "truss":
            continue  # its input needs the path; the program of it is the one above
        values = case.behaviour.dem_input(case)
        assert values["thermal"]["table_time_s"] == [0.0, 5.0, 10.0] and values["period_s"] == 10.0
        steps = values["dem"]["number_of_steps"]
        assert values["dem"]["time_step_s"] * steps == pytest.approx(10.0, rel=4 * np.finfo(float).eps)
