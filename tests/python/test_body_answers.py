# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers and control of trusses with condensed bodies, beside those of the beams that the bodies condense."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from test_truss_bodies import bracket_case, panel_case
import statejump as sj
from conftest import REPOSITORY
from statejump.control.study import DesignChoices
from statejump.kinds.truss.control.study import control

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
