# SPDX-License-Identifier: GPL-3.0-or-later
"""Designs: optimum, robustness, false optimum, derivatives, files, refusals, Ctrl-C."""
from __future__ import annotations

import json
from math import exp, log
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import Outcome

import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.design import gradients as derivatives, study
from statejump.design.cost import Formula
from statejump.design.file import DesignVariable
from statejump.design.model import Model, Setting
from statejump.design.result import FALSE, HOLDS, NOT_MET
from statejump.design.study import design
from statejump.design.variables import groups_of

K = {"name": "K", "keys": ["torsion_spring.*.stiffness_N_m_per_rad"], "low": 0.05, "high": 20.0}
C = {"name": "c", "keys": ["revolute.*.radial_clearance_m"], "low": 0.05, "high": 3.0}
JUMP = {"name": "jump", "quantity": "jump_m", "at_most": 6e-6}
FRICTION = {"key": "revolute.*.friction_coefficient", "distribution": "lognormal", "relative": 0.2}
WANTED: dict[str, Any] = {"design": {"samples": 60, "tail": False}, "variable": [K, C],
                          "cost": {"formula": "sum(K) + sum(1/c)"}, "requirement": [JUMP]}


@pytest.fixture(scope="module")
def rib() -> sj.Case:
    return sj.truss.umbrella(1)


def test_optimum_without_robustness_is_at_the_limit(rib: sj.Case) -> None:
    found = design(rib, {**WANTED, "robust": {"friction": [1.0]}})
    # The jump is proportional to the clearance; the spring hardly matters and becomes cheap.
    factors = [group.factor(float(x)) for group, x in zip(found.groups, found.x)]
    assert factors[0] == pytest.approx(0.05) and factors[1] == pytest.approx(0.4612, rel=1e-3)
    assert 0 <= found.margins.min() < 1e-4 and found.cost == pytest.approx(0.05 + 1 / factors[1])
    assert found.price["jump"] == pytest.approx(1 / factors[1] / found.cost, rel=0.02)
    assert found.elasticities[1] == pytest.approx(1.0, rel=0.02)


def test_robust_design_holds_where_the_other_fails(rib: sj.Case) -> None:
    nominal = design(rib, {**WANTED, "robust": {"friction": [1.0]}, "scatter": [FRICTION]})
    robust = design(rib, {**WANTED, "robust": {"clearance": [1.3]}, "scatter": [FRICTION]})
    assert nominal.scatter is not None and robust.scatter is not None
    assert nominal.verdict == "fails under scatter" and nominal.scatter.probability > 0.2
    assert robust.verdict == HOLDS and robust.scatter.interval[1] < 0.1 < nominal.scatter.interval[0]
    assert robust.cost == pytest.approx(4.6155, rel=1e-3)
    assert robust.case.reduced().summary["largest_jump_m"] < 6e-6


def test_falling_side_of_the_tent_is_a_false_optimum() -> None:
    # At this clearance the jump falls with friction, and larger clearances are cheaper.
    beyond = sj.truss.umbrella(1, radial_clearance_m=2e-4)
    found = design(beyond, {**WANTED, "robust": {"friction": [1.0]}})
    assert found.verdict == FALSE and found.profile is not None
    assert found.margins.min() > 0.5 and found.profile.peak[1] > 1
    assert "falling side" in " ".join(found.sentences)


def test_no_design_meets_an_impossible_requirement(rib: sj.Case) -> None:
    found = design(rib, {**WANTED, "variable": [K], "cost": {"formula": "K"}, "robust": {"friction": [1.0]}})
    assert found.verdict == NOT_MET


def test_derivatives_of_a_proportional_jump(rib: sj.Case) -> None:
    model = Model(rib, groups_of(rib, [DesignVariable(**C)]))  # type: ignore[arg-type]
    requirements = study.requirements_of(rib, study.structure(study.DesignFile, WANTED).requirement)  # type: ignore[arg-type]
    x = np.array([log(0.5)])
    values = study.at_setting(model, x, requirements, Setting())
    slopes = derivatives.gradients(model, x, requirements, Setting(), 1e-3, values)
    place = int(values.argmax())
    finer = derivatives.gradients(model, x, requirements, Setting(), 1e-2, values)
    assert slopes[place, 0] == pytest.approx(values[place], rel=0.02)
    assert slopes[place, 0] == pytest.approx(finer[place, 0], rel=1e-3)


def test_arrays_and_cases_give_the_same_jump(rib: sj.Case) -> None:
    model = Model(rib, groups_of(rib, [DesignVariable(**K), DesignVariable(**C)]))  # type: ignore[arg-type]
    assert model.arrays
    x, setting = np.array([log(0.3), log(0.7)]), Setting(1.2, 0.9)
    moved = []
    for model.arrays in (True, False):
        moved.append(model.path(x, setting).cycle_ends["displacement_m"])
    assert np.allclose(*moved, rtol=1e-9, atol=1e-16)
    made = model.case(x, setting)
    assert made["revolute.joint.radial_clearance_m"] == pytest.approx(1e-4 * 0.7 * 0.9)
    assert made["revolute.joint.friction_coefficient"] == pytest.approx(0.15 * 1.2)


def test_formula_has_exact_derivatives() -> None:
    formula = Formula("sum(K)**2 + 0.5*sum(sqrt(c)) - exp(-K)/2", ("K", "c"))
    values = {"K": np.array([2.0]), "c": np.array([4.0, 9.0]), "mass_kg": np.array(0.0)}
    slopes = {"K": np.eye(3)[:, :1], "c": np.eye(3)[:, 1:], "mass_kg": np.zeros(3)}
    assert formula(values).real == pytest.approx(4 + 2.5 - exp(-2) / 2)
    assert np.allclose(formula.gradient(values, slopes), [4 + exp(-2) / 2, 0.125, 0.5 / 6], rtol=1e-14)


def test_areas_and_positions_of_least_mass_at_a_frequency() -> None:
    case = sj.load("two_bar_snap")
    links = [link.name for link in case.link]
    assert len(links) == 2
    document = {**case.origin.document, "link": [{**one, "mass_kg": None, "density_kg_per_m3": 2700.0}
                                                for one in case.origin.document["link"]]}
    document["link"] = [{key: value for key, value in one.items() if value is not None} for one in document["link"]]
    heavy = sj.load(document)
    own = sj.modes(heavy, 1).frequency_Hz[0]
    found = design(heavy, {
        "variable": [{"name": "A", "keys": ["link.*.cross_section_area_m2"], "low": 0.6, "high": 2.0, "each": False}],
        "cost": {"formula": "mass_kg"}, "design": {"iterations": 5},
        "requirement": [{"name": "f", "quantity": "frequency_Hz", "at_least": 0.85 * own}]})
    assert found.margins.min() >= 0 and found.cost < found.cost_before


@pytest.mark.parametrize(("changes", "code"), [
    ({"cost": {"formula": "sum(K) + sum(q)"}}, "design_bad_formula"),
    ({"cost": {"formula": "K + __import__('os')"}}, "design_bad_formula"),
    ({"cost": {"formula": "c**1000"}}, "design_bad_formula"),
    ({"cost": {"formula": "1/(K - K)"}}, "design_bad_formula"),
    ({"variable": [K, K]}, "duplicate"),
    ({"variable": [K, {**K, "name": "L"}]}, "design_key_twice"),
    ({"variable": [{**K, "low": 0.0}]}, "design_log_not_positive"),
    ({"variable": [{**K, "low": 30.0}]}, "not_above_low"),
    ({"variable": [{**K, "keys": ["node.B.position_m"]}]}, "design_axis_and_position"),
    ({"variable": [{**K, "keys": ["torsion_spring.q*.stiffness_N_m_per_rad"]}]}, "no_item_fits"),
    ({"variable": [{**K, "keys": []}]}, "design_no_keys"),
    ({"requirement": [{**JUMP, "at_least": 1.0}]}, "rare_needs_limit"),
    ({"requirement": [{**JUMP, "nodes": ["Q*"]}]}, "design_no_node"),
    ({"requirement": [{**JUMP, "quantity": "bound"}]}, "design_output_of_bound"),
    ({"requirement": [{**JUMP, "quantity": "tilt_rad"}]}, "no_fit"),
    ({"robust": {"friction": [0.0]}}, "design_bad_grid"),
    ({"scatter": [{**FRICTION, "key": "revolute.*.friction"}]}, None),
])
def test_bad_designs_are_refused(rib: sj.Case, changes: dict[str, Any], code: str | None) -> None:
    with pytest.raises(StatejumpError) as caught:
        design(rib, {**WANTED, **changes})
    assert code is None or caught.value.code == code
    assert "\n" not in str(caught.value)


def test_interrupted_design_keeps_the_best(rib: sj.Case, monkeypatch: pytest.MonkeyPatch) -> None:
    count, own = [0], Model.path

    def path(self: Model, *arguments: Any) -> Any:
        count[0] += 1
        if count[0] == 20:
            raise KeyboardInterrupt
        return own(self, *arguments)

    monkeypatch.setattr(Model, "path", path)
    found = design(rib, {**WANTED, "robust": {"friction": [1.0]}, "scatter": [FRICTION]})
    assert found.interrupted and found.scatter is None
    assert found.margins.min() > -1 and found.record()["interrupted"]


def test_command_writes_a_case_that_runs(statejump: Any, tmp_path: Path, rib: sj.Case) -> None:
    rib.save(tmp_path / "rib.toml")
    text = ['[cost]', 'formula = "sum(1/c)"', '[robust]', 'friction = [1.0]', '[[variable]]', 'name = "c"',
            'keys = ["revolute.*.radial_clearance_m"]', 'low = 0.05', 'high = 3', '[[requirement]]', 'name = "jump"',
            'quantity = "jump_m"', 'at_most = 6e-6']
    (tmp_path / "design.toml").write_text("\n".join(text), encoding="utf-8")
    done: Outcome = statejump("design", "rib.toml", "design.toml", "--results", "out")
    assert done.status == 0, done.errors
    folder = tmp_path / "out" / "umbrella_1_design"
    record = json.loads((folder / "design.json").read_text(encoding="utf-8"))
    run = sj.load(folder / "umbrella_1_designed.toml").reduced()
    assert run.summary["largest_jump_m"] == pytest.approx(record["requirements"][0]["after"], rel=1e-6)
    assert {"design.md", "design.png", "variables.csv"} <= {path.name for path in folder.iterdir()}
    bad = (tmp_path / "design.toml").read_text(encoding="utf-8").replace("low = 0.05", "low = 5")
    (tmp_path / "design.toml").write_text(bad, encoding="utf-8")
    refused: Outcome = statejump("design", "rib.toml", "design.toml", "--results", "out")
    assert refused.status == 2 and refused.errors.count("\n") == 1 and "variable 'c'" in refused.errors
