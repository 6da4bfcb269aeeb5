# SPDX-License-Identifier: GPL-3.0-or-later
"""Rare events: probabilities against the closed form of Table 1, intervals, refusals of FORM, Ctrl-C."""
from __future__ import annotations

import json
from math import isclose
from pathlib import Path
from typing import Any, Callable, Sequence

import numpy as np
import pytest

from conftest import REPOSITORY, Outcome

import statejump as sj
from statejump.campaign.rare import design_point, model
from statejump.campaign.sampling import Distribution
from statejump.campaign.work import Sample
from statejump.core import libraries

pytest.importorskip("openturns")
FRICTION = {"joint.friction_coefficient": {"distribution": "lognormal", "relative": 0.2}}
AREA = {"link.cross_section_area_m2": {"distribution": "uniform", "relative": 0.05}}
VARY = {**FRICTION, **AREA, "link.young_modulus_Pa": {"distribution": "normal", "relative": 0.03}}
LIMIT_M = 4.97e-5


def probability(limit_m: float) -> float:
    """Return the probability from the closed form of the jump, mu N l/(E A), and its drawn values."""
    generator, count = np.random.default_rng(5), 2_000_000
    spread = np.sqrt(np.log1p(0.2**2))
    friction = 0.3 * np.exp(spread * generator.standard_normal(count) - spread**2 / 2)
    stiffness = 70e9 * (1 + 0.03 * generator.standard_normal(count)) * 9e-6 * (1 + 0.05 * generator.uniform(-1, 1, count))
    return float(np.mean(friction * 100 * 0.5 / stiffness > limit_m))


def test_importance_sampling_finds_the_probability_of_the_closed_form() -> None:
    case = sj.load("table1")
    found = sj.rare(case, VARY, outcome="state_jump_m", above=LIMIT_M, seed=3)
    again = sj.rare(case, VARY, outcome="state_jump_m", above=LIMIT_M, seed=3)
    exact = probability(LIMIT_M)
    assert exact < 2e-4 and found.estimate.variation <= 0.1 and found.runs < 600
    # 3 standard errors of importance sampling and of the reference
    assert isclose(found.probability, exact, rel_tol=3 * np.hypot(0.1, (2e6 * exact) ** -0.5))
    assert found.interval[0] < found.probability < found.interval[1] and found.form_is_valid
    assert found.record() == again.record()


def test_subset_simulation_finds_the_probability_below_a_limit() -> None:
    found = sj.rare(sj.load("table1"), FRICTION, outcome="state_jump_m", below=1.3e-5, method="subset", runs=300)
    exact = 1 - probability(1.3e-5)
    assert found.design is None and isclose(found.probability, exact, rel_tol=3 * found.estimate.variation)


def test_sobol_indices_of_a_nearly_linear_outcome() -> None:
    found = sj.rare(sj.load("table1"), {**FRICTION, **AREA}, outcome="state_jump_m", above=4.5e-5, sobol=100)
    assert found.sobol[0].total > 0.8 > 0.3 > found.sobol[1].total


def refused(case: Any, vary: Any, **event: Any) -> str:
    with pytest.raises(sj.StatejumpError) as caught:
        sj.rare(case, vary, **{"outcome": "state_jump_m", **event})
    return caught.value.code


def test_form_is_refused_at_the_tent() -> None:
    # Friction above half of the thermal force E A alpha dT keeps the slider from slipping back: the jump falls again.
    case = sj.load("table1").origin.document
    tent = sj.load({**case, "joint": {**case["joint"], "normal_force_N": 2000.0}})
    vary = {"joint.friction_coefficient": {"distribution": "normal", "relative": 0.1}}
    assert refused(tent, vary, above=5.8e-4) == "rare_tent"


@pytest.mark.parametrize(("margin", "code"), [
    (lambda u: u[0] - 3 - 0.3 * abs(u[1] - 0.2), "rare_kink"),
    (lambda u: (u[0] ** 2 + 0.2 * u[0] - 9) / 9, "rare_not_unique"),
])
def test_form_is_refused_at_a_kink_and_at_two_design_points(
    margin: Callable[[Sequence[float]], float], code: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(model.Model, "at", lambda self, variates: margin(variates))
    assert refused(sj.load("table1"), {**FRICTION, **AREA}, above=1.0) == code


def test_form_is_refused_where_the_unchanged_case_or_no_case_is_beyond_the_limit() -> None:
    assert refused(sj.load("table1"), FRICTION, above=1e-5) == "rare_frequent"
    assert refused(sj.load("table1"), AREA, above=1e-3) == "rare_no_design_point"


@pytest.mark.parametrize(("wanted", "code"), [
    ({}, "rare_needs_limit"), ({"above": 1.0, "below": 1.0}, "rare_needs_limit"), ({"above": 1.0, "runs": 3}, "below_minimum"),
    ({"above": 1.0, "outcome": "state_jump"}, "misspelt_name"), ({"above": 1.0, "method": "sorm"}, "misspelt_name"),
])
def test_wrong_arguments_are_refused(wanted: dict[str, Any], code: str) -> None:
    assert refused(sj.load("table1"), FRICTION, **wanted) == code


def test_the_missing_library_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr(libraries, "import_module", missing)
    assert refused(sj.load("table1"), FRICTION, above=4e-5) == "openturns_missing"


def test_ctrl_c_ends_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = []

    def interrupted(recipe: model.Shifted, index: int) -> Any:
        runs.append(index)
        if len(runs) == 5:
            raise KeyboardInterrupt
        return original(recipe, index)

    original = model.run_sample
    monkeypatch.setattr(model, "run_sample", interrupted)
    with pytest.raises(KeyboardInterrupt):
        sj.rare(sj.load("table1"), VARY, outcome="state_jump_m", above=LIMIT_M)
    assert len(runs) == 5


def test_failed_samples_widen_the_interval(monkeypatch: pytest.MonkeyPatch) -> None:
    original = model.run_sample

    def failing_often(recipe: model.Shifted, index: int) -> Any:
        return Sample(index, None, "no equilibrium") if index % 10 == 1 else original(recipe, index)

    monkeypatch.setattr(model, "run_sample", failing_often)
    found = sj.rare(sj.load("table1"), VARY, outcome="state_jump_m", above=LIMIT_M)
    assert found.failed > 30 and found.interval[1] / found.probability > 1.1 * found.probability / found.interval[0]


@pytest.mark.parametrize("kind", ["normal", "lognormal", "uniform", "truncated_normal"])
def test_values_at_variates_have_the_distribution_of_drawn_values(kind: str) -> None:
    item = Distribution(("key",), kind, 2.0, 0.5, 1.5, 3.0)
    generator, count = np.random.default_rng(2), 4000
    drawn = np.sort([item.draw(generator) for _ in range(count)])
    at = np.sort([item.at(float(one)) for one in generator.standard_normal(count)])
    assert float(np.abs(np.searchsorted(at, drawn) / count - np.arange(count) / count).max()) < 0.05


def test_the_command_writes_the_result(statejump: Callable[..., Outcome], cases: Path, tmp_path: Path) -> None:
    campaign = cases / "campaigns" / "table1_tolerances.toml"
    done = statejump("rare", campaign, "--outcome", "state_jump_m", "--above", "4.7e-5", "--results", tmp_path)
    assert done.status == 0, done.errors
    found = json.loads((tmp_path / "campaign_table1_tolerances_rare" / "rare.json").read_text())
    assert found["interval_95"][0] < found["probability"] < found["interval_95"][1] and found["form"]["valid"]
    assert 1e-4 < found["probability"] < 6e-4 and len(found["form"]["design_point"]) == 5
    assert design_point.KINK < 1


def command(tmp_path: Path) -> list[str]:
    text = ['[campaign]', 'name = "tail"', f'case = "{REPOSITORY}/cases/table1.toml"', 'samples = 10', 'seed = 3', '[[vary]]',
            'key = "joint.friction_coefficient"', 'distribution = "lognormal"', 'relative = 0.2']
    (tmp_path / "tail.toml").write_text("\n".join(text), encoding="utf-8")
    return ["rare", "tail.toml", "--outcome", "state_jump_m", "--above", "4.5e-5", "--results", "out"]


def test_an_interrupted_command_goes_on(statejump: Callable[..., Outcome], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    arguments, original, runs = command(tmp_path), model.run_sample, list[int]()

    def interrupted(recipe: model.Shifted, index: int) -> Any:
        runs.append(index)
        if len(runs) == 60:
            raise KeyboardInterrupt
        return original(recipe, index)

    monkeypatch.setattr(model, "run_sample", interrupted)
    stopped = statejump(*arguments)
    journal = tmp_path / "out" / "tail_rare" / "rare.journal"
    assert stopped.status == 130 and "59 runs are kept" in stopped.errors and journal.exists()
    torn = journal.read_bytes()[:-3]  # the last line: its run is repeated
    journal.write_bytes(torn)
    runs[:] = [0] * 60
    assert statejump(*arguments).status == 0
    found = json.loads((tmp_path / "out" / "tail_rare" / "rare.json").read_text(encoding="utf-8"))
    assert len(runs) - 60 == found["runs"] - 58
    monkeypatch.setattr(model, "run_sample", original)
    assert statejump(*arguments, "--restart", "--workers", "2").status == 0
    assert json.loads((tmp_path / "out" / "tail_rare" / "rare.json").read_text(encoding="utf-8")) == found
    journal.write_bytes(torn.replace(b"0", b"1", 1))
    damaged = statejump(*arguments)
    assert damaged.status == 2 and "line 1 is damaged" in damaged.errors
