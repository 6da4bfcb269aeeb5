# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the state jump: searches, measures, sentences, files."""
from __future__ import annotations

import csv
import json
from math import inf, nan
from pathlib import Path

import click
import numpy as np
import pytest

from conftest import results_in
from statejump.cli.control import control_command
from statejump.control import plot as control_plot, study as control_study
from statejump.control.study import Study
from statejump.core.case import Case
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import load_case
from statejump.kinds.spring_slider import control as control_spring_slider
from statejump.kinds.umbrella import control_ensemble, control_loaded
from statejump.kinds.umbrella.control_parameters import FRICTION, SPRING
from statejump.schema.paths import with_values as changed

PRELOAD = control_spring_slider.PRELOAD
TABLE1_JUMP = 30 / 1.26e6


@pytest.fixture
def table1(cases: Path):
    return load_case(cases / "table1.toml")


@pytest.fixture
def loaded(cases: Path):
    return load_case(cases / "umbrella_bias.toml")


@pytest.fixture
def free(cases: Path):
    """The unloaded rib with steps that are long but stable: only the bookkeeping is tested."""
    case = load_case(cases / "umbrella.toml")
    return changed(case, {"ensemble.reduced_steps_per_cycle": 20000, "output.samples_per_cycle": 200})


def command(*arguments: object) -> None:
    """Run as the command line does, without ending the interpreter."""
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
    assert study.sentences == [
        "No preload spring up to 1e+15 N/m, the largest that a case may have, keeps the jump at or below 1e-09 µm."
    ]


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
    assert summary["recommendation"]["sentence"] == "The case has no jump: there is nothing to control."


# ---------------------------------------------------------------- loaded umbrella


def test_enough_friction_rolls_and_leaves_no_jump(loaded) -> None:
    threshold = control_loaded.smallest_friction_that_rolls(loaded)
    above = control_loaded.loaded_jump(changed(loaded, {FRICTION: threshold}))
    below = control_loaded.loaded_jump(changed(loaded, {FRICTION: threshold * (1 - 1e-6)}))
    assert not above.slips_rigid and not above.slips_elastic and above.rigid_rad == 0
    assert above.elastic_rad < 1e-8  # Mindlin's elastic slide
    assert below.slips_rigid or below.slips_elastic
    assert control_loaded.loaded_jump(loaded).size_rad == pytest.approx(1.0297e-4, rel=1e-3)


def test_rigid_jump_does_not_depend_on_the_spring(loaded) -> None:
    sweep = study_of(loaded).sweep(SPRING)
    rigid = sweep.column("jump_rigid_rad")
    assert np.ptp(rigid) < 1e-14 < np.nanmax(sweep.column("jump_elastic_rad")) - np.nanmin(sweep.column("jump_elastic_rad"))


def test_found_torsion_spring_is_smallest(loaded) -> None:
    study = study_of(loaded, 6e-5)
    found = study.recommendation["stiffness_N_m_per_rad"]

    def jump(stiffness: float) -> float:
        return control_loaded.loaded_jump(changed(loaded, {SPRING: stiffness})).size_rad

    assert jump(found) <= 6e-5 < jump(found * (1 - 1e-6))
    assert study.recommendation["compression_over_euler_load"] > 1  # and is said
    assert "Euler load" in study.sentences[-1]


def test_friction_range_of_the_loaded_rib_brackets(loaded) -> None:
    low, high = study_of(loaded, 5e-5).sweep(FRICTION).meets

    def jump(mu: float) -> float:
        return control_loaded.loaded_jump(changed(loaded, {FRICTION: mu})).size_rad

    assert low[0] == 0 and jump(low[1]) <= 5e-5 < jump(low[1] * (1 + 1e-6))
    assert jump(high[0]) <= 5e-5 < jump(high[0] * (1 - 1e-6))


def test_law_without_elastic_path_keeps_the_rigid_one(loaded) -> None:
    study = study_of(changed(loaded, {"joint.normal_law": "persson"}))
    assert list(study.results) == ["jump_rigid_rad"]
    assert study.jump == pytest.approx(1.0295e-4, rel=1e-3)
    assert study.recommendation["stiffness_N_m_per_rad"] is None
    assert "No torsion spring from" in study.sentences[-1]


@pytest.mark.parametrize("bias", [0.05, -0.05])
def test_axial_forces_are_those_of_the_links_stretch(loaded, bias) -> None:
    case = changed(loaded, {"torsion_spring.bias_rad": bias, SPRING: 500.0})
    elastic = control_loaded.loaded_jump(case).elastic
    path = elastic.columns()
    warm = 1 + 23.75e-6 * path["temperature_change_K"]
    for cold, length, axial in (
        (0.05, np.hypot(path["bearing_x_m"], path["bearing_y_m"]), control_loaded.axial_forces_N(elastic)[0]),
        (0.1, np.hypot(path["journal_x_m"] - 0.12, path["journal_y_m"]), control_loaded.axial_forces_N(elastic)[1]),
    ):
        stretch = 630e3 / (cold * warm) * (length - cold * warm)
        assert np.max(np.abs(axial)) > 100
        assert axial == pytest.approx(stretch, rel=1e-6)


def test_link_loads_compare_with_euler(loaded) -> None:
    elastic = control_loaded.loaded_jump(loaded).elastic
    ab, bc = control_loaded.axial_forces_N(elastic)
    loads = control_loaded.link_loads(loaded, elastic)
    euler_bc = np.pi**2 * 70e9 * 9e-6**2 / 12 / 0.1**2
    assert loads["compression_N"] == -min(bc.min(), ab.min()) > 0
    assert loads["over_euler_load"] == pytest.approx(-bc.min() / euler_bc, rel=1e-12)
    assert loads["strain"] == pytest.approx(-bc.min() / 630e3, rel=1e-12)


# ---------------------------------------------------------------- ensemble


def test_ensemble_measure_is_the_same_every_time(free) -> None:
    first, second = (control_ensemble.ensemble_measure(free, 4) for _ in range(2))
    assert first == second
    assert control_ensemble.ensemble_measure(changed(free, {"ensemble.seed": 2}), 4) != first
    assert 0 < first["jump_mean_rad"] <= first["jump_quantile_rad"] <= first["deflection_quantile_rad"] < 0.02


def test_quantile_is_a_value_that_occurred() -> None:
    assert control_ensemble.quantile(np.arange(-40, 0)) == 39
    assert control_ensemble.quantile(np.array([1.0, -3.0])) == 3


def test_upper_bound_covers_the_quantile_as_often_as_it_says() -> None:
    generator = np.random.default_rng(1)
    bounds = [control_ensemble.upper_bound(generator.random(200)) for _ in range(4000)]
    assert 0.95 < np.mean(np.array(bounds) >= 0.95) < 0.985  # discrete: a little above
    assert control_ensemble.upper_bound(np.arange(59)) == 58  # 0.95^59 < 0.05: the largest will do
    assert control_ensemble.upper_bound(-np.arange(20)) == 19


def test_static_deflection_closes_the_triangle(free) -> None:
    ab, bc, base = 0.05 * 1.002375, 0.1 * 1.002375, 0.12 + 1e-4
    static = control_ensemble.static_deflection_rad(free)
    angles = free.theta2_rad + np.array([static, -static])
    tips = ab * np.stack([np.cos(angles), np.sin(angles)])
    gaps = np.abs(np.hypot(tips[0] - base, tips[1]) - bc)
    assert static > 0 and gaps.min() < 1e-12 < gaps.max()  # on one side of the angle, not on the other


def test_smallest_spring_brackets_and_says_what_fails_beyond() -> None:
    def value(stiffness: float) -> float:
        return 5.0 if stiffness < 0.02 or stiffness > 20 else 1.0

    def found_below(wanted: float, scanned: list[float]):
        return control_ensemble.smallest_spring(lambda stiffness: value(stiffness) <= wanted, scanned)

    found = found_below(2.0, [0, 0.001, 0.01, 0.1, 1, 10, 100])
    assert value(found.stiffness) <= 2 < value(found.below)
    assert found.below < 0.02 <= found.stiffness < 1.08 * found.below
    assert found.up_to == 10 and not found.passes_all_stiffer
    assert found_below(0.5, [0, 1, 10]) is None
    assert found_below(9.0, [0, 1, 10]).stiffness == 0


def test_recommended_spring_passes_on_both_ensembles_and_a_smaller_one_does_not(free, monkeypatch) -> None:
    """Statistics made up: passes from 0.02 on the ensemble, by its quantile from 0.05 on more runs
    from other starts, by its bound from 0.2."""

    def measure(case, runs, progress=None) -> dict[str, float]:
        spring, other = case.torsion_spring.stiffness_N_m_per_rad, case.ensemble.seed != free.ensemble.seed
        assert runs == (20 if other else 4)
        quantile, bound = 0.05 if other else 0.02, 0.2 if other else 0.02
        values = {"mean": 0.0, "quantile": float(spring < quantile), "bound": float(spring < bound)}
        made = {f"{what}_{name}_rad": value for what in ("jump", "deflection") for name, value in values.items()}
        return {**made, "jump_largest_rad": values["bound"], "jump_largest_run": 1.0}

    monkeypatch.setattr(control_ensemble, "ensemble_measure", measure)
    study = study_of(free, 0.5, runs=4)
    entry = study.recommendation["for_jump"]
    found, below = entry["stiffness_N_m_per_rad"], entry["next_smaller_that_fails_N_m_per_rad"]
    assert below < 0.2 <= found < 1.08 * below
    assert (entry["value_with_it_rad"], entry["bound_on_check_ensemble_rad"]) == (0, 0)
    assert study.sweep(SPRING).recommended == found
    assert "by 20 runs from other starts below 0 mrad with 64 % confidence" in study.sentences[0]


def test_free_rib_gets_an_ensemble_and_a_sentence_when_out_of_reach(free, monkeypatch) -> None:
    monkeypatch.setattr(control_ensemble, "BISECTIONS", 1)
    study = study_of(free, 1e-9, runs=2)
    assert list(study.results) == list(control_ensemble.ENSEMBLE_RESULTS) and "statistics of 2 runs" in study.measure
    assert study.floor is not None and study.floor[0] == SPRING
    assert study.recommendation["for_jump"]["stiffness_N_m_per_rad"] is None
    assert study.recommendation["for_jump"]["best_value_rad"] > 1e-9
    assert study.sentences[0].startswith("No torsion spring from 0 to 1000 N m/rad brings the 95 % quantile of |jump|")


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
    assert "exact quasi-static path" in output and summary["recommendation"]["sentence"] in output


def test_figure_is_the_same_every_time(table1, tmp_path: Path) -> None:
    study = study_of(table1)
    drawn = []
    for name in "ab":
        (tmp_path / name).mkdir()
        drawn.append([path.read_bytes() for path in control_plot.figure("title", study, tmp_path / name)])
    assert drawn[0] == drawn[1]


@pytest.mark.parametrize("case, arguments, sentence", [
    ("table1", ["--jump-below", 0], "--jump-below = 0.0 is not allowed: must be a finite number above 0 [m]"),
    ("table1", ["--jump-below", -1e-6], "--jump-below = -1e-06 is not allowed: must be a finite number above 0 [m]"),
    ("umbrella_bias", ["--jump-below", nan], "--jump-below = nan is not allowed: must be a finite number above 0 [rad]"),
    ("umbrella", ["--jump-below", inf], "--jump-below = inf is not allowed: must be a finite number above 0 [rad]"),
    ("table1", ["--runs", 5], "--runs = 5 is not allowed: case table1 has one exact path, no ensemble is run"),
    ("umbrella_bias", ["--runs", 5],
     "--runs = 5 is not allowed: case umbrella_bias has one exact path, no ensemble is run"),
    ("umbrella", ["--runs", 1], "--runs = 1 is not allowed: must be at least 2"),
])
def test_bad_options_get_one_sentence(cases: Path, tmp_path: Path, case, arguments, sentence) -> None:
    with pytest.raises(StatejumpError) as caught:
        command(cases / f"{case}.toml", *arguments, "--results", tmp_path)
    assert str(caught.value) == sentence and caught.value.exit_status == 2
    assert not list(tmp_path.glob("*/control*"))


@pytest.mark.parametrize("arguments", [["--jump-below", "small"], ["--runs", "2.5"]])
def test_options_that_are_no_numbers(cases: Path, arguments) -> None:
    with pytest.raises(click.BadParameter) as caught:
        command(cases / "table1.toml", *arguments)
    assert arguments[1] in caught.value.format_message()


def test_kind_without_a_study_is_refused(statejump, cases: Path) -> None:
    done = statejump("control", cases / "statics_slot.toml")
    assert done.status == 2
    assert done.errors == (f"error: {cases / 'statics_slot'}.toml: case.kind = 'statics' is not allowed: 'statejump "
                           "control' is for 'spring_slider' and 'umbrella' and 'truss'\n")
