# SPDX-License-Identifier: GPL-3.0-or-later
"""The period of a temperature table is its last time, in every kind of case and in both models."""
from __future__ import annotations

import tomllib
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import statejump as sj
from conftest import REPOSITORY, Outcome
from failures import failure
from statejump.core.notes import Note

TABLE = {
    "thermal.shape": "table", "thermal.temperature_change_max_K": None, "thermal.table_time_s": [0, 5, 10],
    "thermal.table_temperature_change_K": [0, 100, 0],
}
CASES = ("table1", "umbrella_damped", "trusses/umbrella_rib")
PERIOD = "thermal.period_s"


@pytest.mark.parametrize("name", CASES)
def test_times_of_a_table_are_the_times(name: str) -> None:
    case = sj.load(f"cases/{name}.toml").changed({**TABLE, PERIOD: None})
    assert (case.period_s, case.duration_s, case.thermal_program().period_s) == (10.0, 10.0, 10.0)
    triangle = sj.load(f"cases/{name}.toml").changed(
        {"thermal.shape": "triangle", "thermal.temperature_change_max_K": 100.0, PERIOD: 10.0})
    ours, other = case.reduced(), triangle.reduced()
    assert ours.time_s[-1] == 10.0
    for jump in (key for key in ours.summary if "jump" in key):
        # The same program said in two ways: its corners may differ by a rounding.
        assert ours.summary[jump] == pytest.approx(other.summary[jump], rel=1e-9, abs=1e-15)


def test_length_of_the_cycle_matters() -> None:
    """The damped rib returns to different positions after cycles of 10 s and of 1 s; scaling a table to another period
    was wrong physics."""
    case = sj.load("cases/umbrella_damped.toml")
    slow = case.changed({**TABLE, "thermal.period_s": None}).reduced().summary["theta2_jump_rad"]
    fast = case.reduced().summary["theta2_jump_rad"]
    assert abs(slow - fast) > 1e-5


@pytest.mark.parametrize("name", CASES)
def test_period_beside_a_table_must_agree(name: str) -> None:
    case = sj.load(f"cases/{name}.toml")
    assert case.changed({**TABLE, PERIOD: 10.0}).period_s == 10.0
    with pytest.raises(sj.StatejumpError) as refused:
        case.changed({**TABLE, PERIOD: 1.0})
    assert refused.value == failure("period_beside_table", key=PERIOD, value=1.0, lasts=10.0)


def test_what_goes_to_yade_has_the_times_of_the_table() -> None:
    for name in CASES:
        case = sj.load(f"cases/{name}.toml").changed({**TABLE, PERIOD: None}).definition
        if case.kind == "truss":
            continue  # its input needs the path; the program of it is the one above
        values = case.behaviour.dem_input(case)
        assert values["thermal"]["table_time_s"] == [0.0, 5.0, 10.0] and values["period_s"] == 10.0
        steps = values["dem"]["number_of_steps"]
        assert values["dem"]["time_step_s"] * steps == pytest.approx(10.0, rel=4 * np.finfo(float).eps)


def old_document() -> dict[str, Any]:
    """Return the paper's Table 1 in an old file format, in which the DEM's section held the period."""
    data = tomllib.loads((REPOSITORY / "cases" / "table1.toml").read_text(encoding="utf-8"))
    data["dem"]["period_s"] = data["thermal"].pop("period_s") / 4
    return data


def test_old_place_of_the_period_is_understood_and_told() -> None:
    with pytest.warns(FutureWarning, match=r"^dem.period_s\b.* thermal.period_s\b"):
        case = sj.load(old_document())
    assert case["thermal.period_s"] == 0.25
    # What is kept has the new place: nothing is told again.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert case.changed({"joint.friction_coefficient": 0.1}).period_s == 0.25
    with pytest.warns(FutureWarning):
        assert case.changed({"dem.period_s": 0.5}).period_s == 0.5


def test_a_period_in_both_places_is_refused() -> None:
    data = old_document()
    data["thermal"]["period_s"] = 1.0
    with pytest.warns(FutureWarning), pytest.raises(sj.StatejumpError) as refused:
        sj.load(data)
    assert refused.value == failure("deprecated_key_duplicated", key="dem.period_s", value=0.25, new_key="thermal.period_s", old_key="dem.period_s")


def test_command_tells_the_old_place_in_one_line(statejump_process: Callable[..., Outcome], tmp_path: Path) -> None:
    text = (REPOSITORY / "cases" / "table1.toml").read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if line.startswith("period_s"))
    (tmp_path / "old.toml").write_text(text.replace(line + "\n", "").replace("[dem]", "[dem]\nperiod_s = 0.25"))
    done = statejump_process("reduced", "old.toml")
    assert done.status == 0
    assert done.errors == f"warning: {Note('key_moved', where='old.toml: ', path='dem.period_s', now='thermal.period_s')}\n"
