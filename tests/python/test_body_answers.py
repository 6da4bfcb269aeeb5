# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers and control of trusses with condensed bodies, beside those of the beams that the bodies condense."""
from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest

from failures import failing
from test_truss_bodies import bracket_case, panel_case
import statejump as sj
from conftest import REPOSITORY
from statejump.control.study import DesignChoices
from statejump.kinds.truss.control.study import control
from statejump.schema.toml import to_toml

SLIDER = {"name": "S", "nodes": ["tip"], "axis": [1.0, 0.0, 0.0], "friction_coefficient": 0.1, "normal_force_N": 2000.0}


def elasticities(answers: Any) -> dict[str, float]:
    return {row["parameter"]: row["elasticity"] for row in answers.tables["sensitivities"]}


def test_answers_equal_those_of_the_beams() -> None:
    of_beams, of_bodies = (sj.truss.answers(bracket_case(as_body)) for as_body in (False, True))
    assert of_bodies.verdict == of_beams.verdict == "shakedown"
    assert of_bodies.jump == pytest.approx(of_beams.jump, rel=2e-5)
    shares = of_bodies.tables["contributions"]
    assert [row["joint"] for row in shares] == ["S"] and shares[0]["share"] == pytest.approx(1.0, abs=1e-6)
    found, expected = elasticities(of_bodies), elasticities(of_beams)
    for name in expected:
        assert found[name] == pytest.approx(expected[name], abs=1e-4)
    # The jump is friction times a compliance: a factor of all stiffnesses divides it.
    assert found["body.*.stiffness_factor"] + found["spring.*.stiffness_N_per_m"] == pytest.approx(-1.0, abs=1e-3)
    assert found["body.*.expansion_factor"] == pytest.approx(0.0, abs=1e-6)


def test_surface_of_answers_has_points_of_bodies() -> None:
    """A point of a body is where the same point is as an interface node."""
    found = []
    for hidden in (True, False):
        data = panel_case(np.eye(3), hidden).origin.document
        nodes = [{**node, "fixed": ["y", "z"]} if node["name"] == "tip" else node for node in data["node"]]
        points = {"nodes": ["foot", "tip"], "points": ["P/corner"]} if hidden else {"nodes": ["foot", "corner", "tip"]}
        case = sj.load({**data, "node": nodes, "slider": [SLIDER], "truss": {"dimension": 3},
                        "reflector": {"axis": [0.0, 0.0, 1.0], **points}})
        found.append(sj.truss.answers(case, output="node:tip", sensitivity=False))
    assert abs(found[0].jump) > 1e-7
    assert found[0].jump == pytest.approx(found[1].jump, rel=1e-3)
    surfaces = [one.tables.get("surface", []) for one in found]
    assert len(surfaces[0]) == len(surfaces[1])


def test_joints_that_turn_nodes_are_not_ranked() -> None:
    answers = sj.truss.answers(sj.load(REPOSITORY / "cases/trusses/hinged_panel.toml"), sensitivity=False)
    assert "joint_turns_nodes" in [getattr(note, "code", None) for note in answers.notes]
    assert [row["state"] for row in answers.tables["surface"]][:2] == ["start", "hottest"]
    assert "contributions" not in answers.tables and answers.shares is None


def test_control_finds_the_friction_of_half_the_jump() -> None:
    """The jump is proportional to the friction."""
    case, wanted = bracket_case(True), "slider.*.friction_coefficient"
    study = control(case, choices=DesignChoices(scale=[wanted]))
    values = {one["parameter"]: one["value"] for one in study.recommendation["candidates"]}
    assert values[f"scale {wanted}"] == pytest.approx(0.5, rel=1e-3)


def members_case(folder: Path, columns: str, **more: Any) -> Any:
    """Return a body of two patterns whose temperatures are columns of a table."""
    made = panel_case(np.eye(3), False).origin.document
    body = made["body"][0]
    shapes = body["content"].free_shapes[0] * [[1.0], [0.5]]
    content = attrs.evolve(body["content"], pattern_names=("uniform", "half"), free_shapes=shapes)
    path = sj.load({**{key: value for key, value in made.items() if key != "reflector"},
                    "body": [{**body, "content": content, "patterns": ["uniform", "half"]}]}).save(folder / "case.toml")
    data = tomllib.loads(Path(path).read_text())
    data["body"][0] |= more
    data["thermal"] = {"shape": "table", "members_file": "members.csv"}
    (folder / "members.csv").write_text(columns)
    (folder / "case.toml").write_text(to_toml(data))
    return sj.load(folder / "case.toml")


def test_columns_of_members_scale_patterns(tmp_path: Path) -> None:
    """A column of the half pattern has half of the effect of the same column of the whole pattern."""
    whole, half = (
        members_case(tmp_path, f"time_s,P/uniform_K,P/half_K\n0,0,0\n1,{first},{second}\n2,0,0\n").reduced()
        for first, second in ((60, 0), (0, 120)))
    moved = [one.history["displacement_m"].values for one in (whole, half)]
    at = [int(np.argmin(np.abs(one.history["time_s"].values - 1.0))) for one in (whole, half)]
    assert np.abs(moved[0][at[0]] - moved[0][0]).max() > 1e-4
    assert moved[1][at[1]] == pytest.approx(moved[0][at[0]], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(("header", "more", "code"), [
    ("P/uniform_K,P/cold_K", {}, "no_column_of_item"), ("P/uniform_K,P/half_K,Q_K", {}, "column_of_several"),
    ("P/uniform_K,P/half_K", {"temperature_fractions": [1.0, 2.0]}, "temperature_from_members_file"),
])
def test_wrong_columns_of_members_are_refused(tmp_path: Path, header: str, more: dict[str, Any], code: str) -> None:
    zeros = ",".join(["0"] * (header.count(",") + 1))
    with failing(code):
        members_case(tmp_path, f"time_s,{header}\n0,{zeros}\n1,{zeros}\n", **more)
