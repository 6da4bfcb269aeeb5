# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the state jump: searches, measures, messages, files."""
from __future__ import annotations

import csv
import json
from math import inf, nan
from pathlib import Path

import click
import pytest

from conftest import results_in
from failures import failure, note
from statejump.cli.control import control_command
from statejump.control import plot as control_plot, study as control_study
from statejump.control.study import Study
from statejump.core.case import Case
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import load_case
from statejump.kinds.spring_slider import control as control_spring_slider
from statejump.schema.paths import with_values as changed

PRELOAD = control_spring_slider.PRELOAD
FRICTION = "joint.friction_coefficient"
TABLE1_JUMP = 30 / 1.26e6


@pytest.fixture
def table1(cases: Path):
    return load_case(cases / "table1.toml")


def command(*arguments: object) -> None:
    """Run the command line without ending the interpreter."""
    control_command.main([str(argument) for argument in arguments], standalone_mode=False)


def study_of(case: Case, jump_below: float | None = None, runs: int | None = None) -> Study:
    return case.behaviour.control(case, jump_below=jump_below, runs=runs)


# ---------------------------------------------------------------- spring_slider


@pytest.mark.parametrize("changes", [
    {},
    {"joint.friction_coefficient": 0.05},
    {"joint.friction_coefficient": 2.0},
    {"link.cross_section_area_m2": 2e-6},
    {"link.young_modulus_Pa": 210e9},
    {PRELOAD: 3e5},
    {PRELOAD: 8e6, "joint.friction_coefficient": 1.0},
    {"joint.clearance_plus_m": 2e-3, "joint.clearance_minus_m": 2e-3},
])
def test_closed_form_is_the_solved_jump(table1, changes) -> None:
    case = changed(table1, changes)
    jump = control_spring_slider.jump_of(case)
    expected = case.joint.friction_coefficient * 100 / (
        case.link.young_modulus_Pa * case.link.cross_section_area_m2 / 0.5 + case.joint.preload_stiffness_N_per_m
    )
    assert jump.closed_form_m == pytest.approx(expected, rel=1e-14)
    assert jump.size_m == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("hottest, mu", [(3.0, 0.3), (100.0, 9.0)])
def test_closed_form_is_withheld_when_the_cycle_does_not_end_sliding(table1, hottest, mu) -> None:
    case = changed(table1, {"thermal.temperature_change_max_K": hottest, "joint.friction_coefficient": mu})
    jump = control_spring_slider.jump_of(case)
    assert jump.slips and jump.closed_form_m is None and 0 < jump.size_m < mu * 100 / 1.26e6


def test_no_slip_no_jump(table1) -> None:
    jump = control_spring_slider.jump_of(changed(table1, {"thermal.temperature_change_max_K": 2.0}))
    assert jump == control_spring_slider.Jump(0.0, None, False)


@pytest.mark.parametrize("hottest, wanted, by", [
    (100.0, TABLE1_JUMP / 2, "closed form"),
    (100.0, 3.3e-7, "closed form"),
    (3.0, 6e-6, "bisection"),
])
def test_smallest_preload_is_smallest(table1, hottest, wanted, by) -> None:
    case = changed(table1, {"thermal.temperature_change_max_K": hottest})
    spring = control_spring_slider.smallest_preload(case, wanted)

    def jump(stiffness: float) -> float:
        return control_spring_slider.jump_of(changed(case, {PRELOAD: stiffness})).size_m

    assert spring.by == by
    assert spring.jump_m == jump(spring.stiffness_N_per_m) <= wanted < jump(spring.stiffness_N_per_m * (1 - 1e-9))
    if by == "closed form":
        assert spring.stiffness_N_per_m == pytest.approx(30 / wanted - 1.26e6, rel=1e-12)


def test_no_preload_is_needed_or_none_is_stiff_enough(table1) -> None:
    assert control_spring_slider.smallest_preload(table1, 1e-3).by == "none"
    assert control_spring_slider.smallest_preload(table1, 1e-15) is None
    study = study_of(table1, 1e-15)
    assert study.sentences == [note("no_preload", largest_N_per_m=1e15, wanted_m=1e-15)]


def test_ranges_of_the_other_remedies(table1) -> None:
    study = study_of(table1)
    assert study.wanted == study.jump / 2 == pytest.approx(TABLE1_JUMP / 2, rel=1e-12)
    (friction,), (area,) = study.sweep(FRICTION).meets, study.sweep("link.cross_section_area_m2").meets
    assert friction[1] == pytest.approx(0.15, rel=1e-8)
    assert area[0] == pytest.approx(18e-6, rel=1e-8)
    clearance, = study.sweep("joint.clearance_plus_m").meets
    assert clearance[1] == pytest.approx(TABLE1_JUMP / 2, rel=1e-8)  # a play below the jump limits it


def test_frictionless_case_has_nothing_to_control(cases: Path, tmp_path: Path) -> None:
    command(cases / "table1_frictionless.toml", "--results", tmp_path, "--quiet")
    summary = json.loads((tmp_path / "table1_frictionless/control.json").read_text())
    assert summary["jump_m"] == 0 and summary["jump_wanted_below_m"] is None
    study, = study_of(load_case(cases / "table1_frictionless.toml")).sentences
    assert study == note("nothing_to_control") and summary["recommendation"]["sentence"] == study


# ---------------------------------------------------------------- searches, files, bad input


def test_bisect_narrows_from_both_sides() -> None:
    bad, good = control_study.bisect(lambda x: x >= 0.3, 0.0, 1.0)
    assert bad < 0.3 <= good <= 0.3 * (1 + 1e-11)
    bad, good = control_study.bisect(lambda x: x <= 0.3, 1.0, 0.01)
    assert good <= 0.3 < bad


def test_files_hold_units_numbers_and_marks(table1, cases: Path, tmp_path: Path, capsys) -> None:
    command(cases / "table1.toml", "--jump-below", 5e-6, "--results", tmp_path)
    folder = tmp_path / "table1"
    assert results_in(folder) == [
        "control.csv", "control.json", "control.png", "control.svg"]
    with (folder / "control.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["parameter"] for row in rows} == {
        FRICTION, "link.cross_section_area_m2", PRELOAD, "joint.clearance_plus_m"}
    recommended, = (row for row in rows if row["is_recommended"] == "1")
    assert recommended["parameter"] == PRELOAD and float(recommended["value"]) == pytest.approx(4.74e6)
    assert float(recommended["jump_m"]) <= 5e-6
    own = [row for row in rows if row["is_own_value"] == "1"]
    assert [float(row["jump_m"]) for row in own] == [pytest.approx(TABLE1_JUMP)] * 4
    summary = json.loads((folder / "control.json").read_text())
    assert summary["recommendation"]["preload_stiffness_N_per_m"] == pytest.approx(4.74e6)
    output = capsys.readouterr().out
    assert "quasi-static path" in output and summary["recommendation"]["sentence"] in output


def test_figure_is_the_same_every_time(table1, tmp_path: Path) -> None:
    study = study_of(table1)
    drawn = []
    for name in "ab":
        (tmp_path / name).mkdir()
        drawn.append([path.read_bytes() for path in control_plot.figure("title", study, tmp_path / name)])
    assert drawn[0] == drawn[1]


@pytest.mark.parametrize("case, arguments, wanted", [
    ("table1", ["--jump-below", 0], failure("not_positive", key="--jump-below", value=0.0, unit="m")),
    ("table1", ["--jump-below", -1e-6], failure("not_positive", key="--jump-below", value=-1e-06, unit="m")),
    ("table1", ["--jump-below", nan], failure("not_positive", key="--jump-below", value=nan, unit="m")),
    ("table1", ["--jump-below", inf], failure("not_positive", key="--jump-below", value=inf, unit="m")),
    ("table1", ["--runs", 5], failure("exact_path_without_ensemble", key="--runs", value=5)),
])
def test_bad_options_get_one_sentence(cases: Path, tmp_path: Path, case, arguments, wanted) -> None:
    with pytest.raises(StatejumpError) as caught:
        command(cases / f"{case}.toml", *arguments, "--results", tmp_path)
    assert caught.value == wanted and caught.value.exit_status == 2
    assert not list(tmp_path.glob("*/control*"))


@pytest.mark.parametrize("arguments", [["--jump-below", "small"], ["--runs", "2.5"]])
def test_options_that_are_no_numbers(cases: Path, arguments) -> None:
    with pytest.raises(click.BadParameter) as caught:
        command(cases / "table1.toml", *arguments)
    assert arguments[1] in caught.value.format_message()


def test_kind_without_a_study_is_refused(statejump, cases: Path) -> None:
    done = statejump("control", cases / "statics_slot.toml")
    assert done.status == 2
    assert done.failure == failure("command_not_for_kind", file="statics_slot.toml", value="statics", command="control")
