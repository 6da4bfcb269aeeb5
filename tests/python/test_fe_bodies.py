# SPDX-License-Identifier: GPL-3.0-or-later
"""Condensed bodies in CalculiX: the meshes of their own decks, beside the reduced model."""
from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest

from failures import failing
import statejump as sj
from statejump.bodies.body import CondensedBody
from statejump.bodies.files import read_body, write_body
from studies import calculix
from studies.calculix import brackets
from studies.calculix.bracket_decks import panel

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
HELD = {"fixed": ["x", "y", "z"], "fixed_rotations": ["x", "y", "z"]}


@pytest.fixture(scope="module")
def bracket() -> CondensedBody:
    return brackets.body(fine=False)


def test_slide_of_two_brackets_is_friction_times_compliance(bracket: CondensedBody) -> None:
    """Rotations change the slide by the square of the temperatures; a thousandth of them leaves the linear answer."""
    expected = brackets.FRICTION_N * brackets.compliance_m_per_N(bracket)
    warm, still = (brackets.slides_m(brackets.case(bracket, scale)) / scale for scale in (1.0, 1e-3))
    assert warm[1::2] == pytest.approx([-expected, expected], rel=1e-7)
    assert still[1::2] == pytest.approx([-expected, expected], rel=1e-9)


def test_two_brackets_equal_their_meshes(bracket: CondensedBody) -> None:
    found = calculix.answer(brackets.case(bracket))
    assert [row.name for row in found.rows] == ["largest_displacement", "largest_jump"]
    assert all(row.difference < 1e-6 for row in found.rows), found.rows
    assert found.deck.count("TYPE=C3D20R") == 2 and "'guide'" in " ".join(found.notes)


def panel_case(content: CondensedBody, **more: Any) -> Any:
    """Return a panel of shells on two held patches, with a slider at a tip, uniformly warm and bowed."""
    at = content.node_positions_m
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    nodes = [{"name": name, "position_m": (turn @ place).tolist(),
              **{"H1": HELD, "T1": {"fixed": ["z"], "guide_normal": turn[:, 1].tolist()}}.get(name, {})}
             for name, place in zip(content.node_names, at)]
    return sj.load({
        "case": {"name": "panel", "kind": "truss"}, "truss": {"dimension": 3}, "node": nodes,
        "body": [{"name": "panel", "nodes": list(content.node_names), "content": content, "axis_x": turn[:, 0].tolist(),
                  "axis_y": turn[:, 1].tolist(), "patterns": ["uniform", "bow"], "temperature_fractions": [1.0, 20.0],
                  **more}],
        "slider": [{"name": "S", "nodes": ["T1"], "axis": turn[:, 0].tolist(), "friction_coefficient": 0.5,
                    "normal_force_N": 20.0}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 20.0, "cycles": 1, "period_s": 1.0}})


@pytest.fixture(scope="module")
def shells(tmp_path_factory: pytest.TempPathFactory) -> CondensedBody:
    folder = tmp_path_factory.mktemp("panel")
    (folder / "panel.inp").write_text(panel())
    body = sj.body.condense(folder / "panel.inp", ["H1", "H2", "T1", "T2"], ["uniform", "bow=thickness"])
    write_body(folder / "panel.h5", body)
    return read_body(folder / "panel.h5")


def test_panel_of_shells_equals_its_mesh(shells: CondensedBody) -> None:
    found = calculix.answer(panel_case(shells))
    assert all(row.difference < 1e-4 for row in found.rows), found.rows
    assert found.rows[-1].values["reduced"] > 1e-7


def test_body_without_deck_has_its_reduced_stiffness(shells: CondensedBody) -> None:
    found = calculix.answer(panel_case(attrs.evolve(shells, deck=None), stiffness_factor=2.0))
    assert all(row.difference < 1e-4 for row in found.rows), found.rows


@pytest.mark.parametrize(("code", "change", "more"), [
    ("fe_body_expanding", {"kinds": ("expanding",) * 4}, {}),
    ("fe_body_units", {"length_m": 1e-3}, {}),
    ("fe_body_factor", {}, {"stiffness_factor": 2.0}),
    ("fe_body_deck_keyword", {"text": "*NODE\n1,0.,0.,0.\n*EQUATION\n1\n1,1,1.\n"}, {}),
])
def test_unsupported_bodies_are_refused(shells: CondensedBody, code: str, change: dict[str, Any], more: dict[str, Any]
                                        ) -> None:
    assert shells.deck is not None
    with failing(code):
        calculix.answer(panel_case(attrs.evolve(shells, deck=attrs.evolve(shells.deck, **change)), **more))


def test_decks_that_do_not_fit_are_refused(tmp_path: Path, shells: CondensedBody) -> None:
    assert shells.deck is not None
    with failing("body_deck"):
        sj.body.from_arrays(shells.node_names, shells.node_positions_m, shells.stiffness,
                            deck=attrs.evolve(shells.deck, kinds=("mean",)))
