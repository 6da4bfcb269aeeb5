# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the state jump of the rib: by the quasi-static path if the joint is loaded, else by ensemble statistics.
"""
from __future__ import annotations

import re
from math import inf, nan
from pathlib import Path

import numpy as np
import pytest

from failures import failing, failure
from statejump.control.study import DesignChoices, Study
from statejump.core.case import Case
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import load_case
from statejump.schema.paths import with_values as changed
from studies.rib_control import ensemble, loaded as loaded_rib, study as rib_study
from studies.rib_control.parameters import FRICTION, SPRING


@pytest.fixture
def loaded(cases: Path):
    return load_case(cases / "umbrella_bias.toml")


@pytest.fixture
def free(cases: Path):
    """The unloaded rib with long but stable time steps; tests use its counts and tables, not its accuracy."""
    case = load_case(cases / "umbrella.toml")
    return changed(case, {"ensemble.reduced_steps_per_cycle": 20000, "output.samples_per_cycle": 200})


def study_of(case: Case, jump_below: float | None = None, runs: int | None = None) -> Study:
    return rib_study.control(case, jump_below=jump_below, runs=runs)


# ---------------------------------------------------------------- loaded umbrella


def test_enough_friction_rolls_and_leaves_no_jump(loaded) -> None:
    threshold = loaded_rib.smallest_friction_that_rolls(loaded)
    above = loaded_rib.loaded_jump(changed(loaded, {FRICTION: threshold}))
    below = loaded_rib.loaded_jump(changed(loaded, {FRICTION: threshold * (1 - 1e-6)}))
    assert not above.slips_rigid and not above.slips_elastic and above.rigid_rad == 0
    assert above.elastic_rad < 1e-8  # Mindlin's elastic slide
    assert below.slips_rigid or below.slips_elastic
    assert loaded_rib.loaded_jump(loaded).size_rad == pytest.approx(1.0297e-4, rel=1e-3)


def test_rigid_jump_does_not_depend_on_the_spring(loaded) -> None:
    sweep = study_of(loaded).sweep(SPRING)
    rigid = sweep.column("jump_rigid_rad")
    assert np.ptp(rigid) < 1e-14 < np.nanmax(sweep.column("jump_elastic_rad")) - np.nanmin(sweep.column("jump_elastic_rad"))


def test_found_torsion_spring_is_smallest(loaded) -> None:
    study = study_of(loaded, 6e-5)
    found = study.recommendation["stiffness_N_m_per_rad"]

    def jump(stiffness: float) -> float:
        return loaded_rib.loaded_jump(changed(loaded, {SPRING: stiffness})).size_rad

    assert jump(found) <= 6e-5 < jump(found * (1 - 1e-6))
    assert study.recommendation["compression_over_euler_load"] > 1  # and is said
    assert "Euler load" in study.sentences[-1]


def test_friction_range_of_the_loaded_rib_brackets(loaded) -> None:
    low, high = study_of(loaded, 5e-5).sweep(FRICTION).meets

    def jump(mu: float) -> float:
        return loaded_rib.loaded_jump(changed(loaded, {FRICTION: mu})).size_rad

    assert low[0] == 0 and jump(low[1]) <= 5e-5 < jump(low[1] * (1 + 1e-6))
    assert jump(high[0]) <= 5e-5 < jump(high[0] * (1 - 1e-6))


def test_law_without_elastic_path_keeps_the_rigid_one(loaded) -> None:
    study = study_of(changed(loaded, {"joint.normal_law": "persson"}))
    assert list(study.results) == ["jump_rigid_rad"]
    assert study.jump == pytest.approx(1.0295e-4, rel=1e-3)
    assert study.recommendation["stiffness_N_m_per_rad"] is None
    assert "N m/rad" in study.sentences[-1] and "µrad" in study.sentences[-1]


@pytest.mark.parametrize("bias", [0.05, -0.05])
def test_axial_forces_are_those_of_the_links_stretch(loaded, bias) -> None:
    case = changed(loaded, {"torsion_spring.bias_rad": bias, SPRING: 500.0})
    elastic = loaded_rib.loaded_jump(case).elastic
    path = elastic.columns()
    warm = 1 + 23.75e-6 * path["temperature_change_K"]
    for cold, length, axial in (
        (0.05, np.hypot(path["bearing_x_m"], path["bearing_y_m"]), loaded_rib.axial_forces_N(elastic)[0]),
        (0.1, np.hypot(path["journal_x_m"] - 0.12, path["journal_y_m"]), loaded_rib.axial_forces_N(elastic)[1]),
    ):
        stretch = 630e3 / (cold * warm) * (length - cold * warm)
        assert np.max(np.abs(axial)) > 100
        assert axial == pytest.approx(stretch, rel=1e-6)


def test_link_loads_compare_with_euler(loaded) -> None:
    elastic = loaded_rib.loaded_jump(loaded).elastic
    ab, bc = loaded_rib.axial_forces_N(elastic)
    loads = loaded_rib.link_loads(loaded, elastic)
    euler_bc = np.pi**2 * 70e9 * 9e-6**2 / 12 / 0.1**2
    assert loads["compression_N"] == -min(bc.min(), ab.min()) > 0
    assert loads["over_euler_load"] == pytest.approx(-bc.min() / euler_bc, rel=1e-12)
    assert loads["strain"] == pytest.approx(-bc.min() / 630e3, rel=1e-12)


# ---------------------------------------------------------------- ensemble


def test_ensemble_measure_is_the_same_every_time(free) -> None:
    first, second = (ensemble.ensemble_measure(free, 4) for _ in range(2))
    assert first == second
    assert ensemble.ensemble_measure(changed(free, {"ensemble.seed": 2}), 4) != first
    assert 0 < first["jump_mean_rad"] <= first["jump_quantile_rad"] <= first["deflection_quantile_rad"] < 0.02


def test_quantile_is_a_value_that_occurred() -> None:
    assert ensemble.quantile(np.arange(-40, 0)) == 39
    assert ensemble.quantile(np.array([1.0, -3.0])) == 3


def test_upper_bound_covers_the_quantile_as_often_as_it_says() -> None:
    generator = np.random.default_rng(1)
    bounds = [ensemble.upper_bound(generator.random(200)) for _ in range(4000)]
    assert 0.95 < np.mean(np.array(bounds) >= 0.95) < 0.985  # discrete: a little above
    assert ensemble.upper_bound(np.arange(59)) == 58  # 0.95^59 < 0.05: the largest will do
    assert ensemble.upper_bound(-np.arange(20)) == 19


def test_static_deflection_closes_the_triangle(free) -> None:
    ab, bc, base = 0.05 * 1.002375, 0.1 * 1.002375, 0.12 + 1e-4
    static = ensemble.static_deflection_rad(free)
    angles = free.theta2_rad + np.array([static, -static])
    tips = ab * np.stack([np.cos(angles), np.sin(angles)])
    gaps = np.abs(np.hypot(tips[0] - base, tips[1]) - bc)
    assert static > 0 and gaps.min() < 1e-12 < gaps.max()  # on one side of the angle, not on the other


def test_smallest_spring_brackets_and_says_what_fails_beyond() -> None:
    def value(stiffness: float) -> float:
        return 5.0 if stiffness < 0.02 or stiffness > 20 else 1.0

    def found_below(wanted: float, scanned: list[float]):
        return ensemble.smallest_spring(lambda stiffness: value(stiffness) <= wanted, scanned)

    found = found_below(2.0, [0, 0.001, 0.01, 0.1, 1, 10, 100])
    assert value(found.stiffness) <= 2 < value(found.below)
    assert found.below < 0.02 <= found.stiffness < 1.08 * found.below
    assert found.up_to == 10 and not found.passes_all_stiffer
    assert found_below(0.5, [0, 1, 10]) is None
    assert found_below(9.0, [0, 1, 10]).stiffness == 0


def test_recommended_spring_passes_on_both_ensembles_and_a_smaller_one_does_not(free, monkeypatch) -> None:
    """Made-up statistics: springs pass from 0.02 on in the ensemble, and with more runs from other starts from 0.05 on
    by the quantile and from 0.2 on by the upper bound."""

    def measure(case, runs, progress=None) -> dict[str, float]:
        spring, other = case.torsion_spring.stiffness_N_m_per_rad, case.ensemble.seed != free.ensemble.seed
        assert runs == (20 if other else 4)
        quantile, bound = 0.05 if other else 0.02, 0.2 if other else 0.02
        values = {"mean": 0.0, "quantile": float(spring < quantile), "bound": float(spring < bound)}
        made = {f"{what}_{name}_rad": value for what in ("jump", "deflection") for name, value in values.items()}
        return {**made, "jump_largest_rad": values["bound"], "jump_largest_run": 1.0}

    monkeypatch.setattr(ensemble, "ensemble_measure", measure)
    study = study_of(free, 0.5, runs=4)
    entry = study.recommendation["for_jump"]
    found, below = entry["stiffness_N_m_per_rad"], entry["next_smaller_that_fails_N_m_per_rad"]
    assert below < 0.2 <= found < 1.08 * below
    assert (entry["value_with_it_rad"], entry["bound_on_check_ensemble_rad"]) == (0, 0)
    assert study.sweep(SPRING).recommended == found
    assert entry["check_ensemble_runs"] == 20 and re.findall(r"by (\d+) .* below (\d+) mrad .* (\d+) %", study.sentences[0]) == [
        ("20", "0", "64")]


def test_free_rib_gets_an_ensemble_and_a_sentence_when_out_of_reach(free, monkeypatch) -> None:
    monkeypatch.setattr(ensemble, "BISECTIONS", 1)
    study = study_of(free, 1e-9, runs=2)
    assert list(study.results) == list(ensemble.ENSEMBLE_RESULTS) and "statistics of 2 runs" in study.measure
    assert study.floor is not None and study.floor[0] == SPRING
    assert study.recommendation["for_jump"]["stiffness_N_m_per_rad"] is None
    assert study.recommendation["for_jump"]["best_value_rad"] > 1e-9
    assert re.findall(r"from (\d+) to (\d+) N m/rad .* (\d+) % quantile", study.sentences[0]) == [("0", "1000", "95")]


@pytest.mark.parametrize("case, settings, wanted", [
    ("umbrella_bias", {"jump_below": nan}, failure("not_positive", key="--jump-below", value=nan, unit="rad")),
    ("umbrella", {"jump_below": inf}, failure("not_positive", key="--jump-below", value=inf, unit="rad")),
    ("umbrella_bias", {"runs": 5},
     failure("exact_path_without_ensemble", key="--runs", value=5)),
    ("umbrella", {"runs": 1}, failure("below_minimum", key="--runs", value=1, least=2)),
])
def test_bad_settings_get_one_sentence(cases: Path, case, settings, wanted) -> None:
    with pytest.raises(StatejumpError) as caught:
        study_of(load_case(cases / f"{case}.toml"), **settings)
    assert caught.value == wanted and caught.value.exit_status == 2


def test_a_node_to_choose_is_refused(loaded) -> None:
    with failing("one_jump_only", key="--node", value="A"):
        rib_study.control(loaded, choices=DesignChoices("A"))


def test_the_command_takes_the_rib_as_a_kind_of_ones_own(statejump_process, cases: Path, tmp_path: Path) -> None:
    done = statejump_process("control", cases / "umbrella_bias.toml", "--results", tmp_path,
                             STATEJUMP_KINDS="studies.rib_control:KIND")
    assert done.status == 0 and "quasi-static path" in done.output
    assert (tmp_path / "umbrella_bias/control.json").is_file()
