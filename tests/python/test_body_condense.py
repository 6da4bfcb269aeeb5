# SPDX-License-Identifier: GPL-3.0-or-later
"""Condensation with CalculiX: closed forms of free thermal shapes, patches, units, recovery, modes, refusals."""
from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from studies.calculix.bracket_decks import EXPANSION, MASS_KG, SANDWICH, bracket, closed_form, panel
from failures import failing
import statejump as sj
from statejump.bodies import CondensedBody
from statejump.bodies.condense import deck as decks
from statejump.bodies.condense.patches import patch, shapes
from statejump.kinds.truss.importing.to_case import SYSTEMS

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
LINEAR = {"uniform": (1.0, np.zeros(3)), "x": (0.0, np.array([1.0, 0, 0])), "y": (0.0, np.array([0, 1.0, 0])),
          "z": (0.0, np.array([0, 0, 1.0]))}
ABC = ["A", "B", "C"]


@pytest.fixture(scope="module")
def fine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("decks") / "bracket.inp"
    path.write_text(bracket())
    return path


@pytest.fixture
def coarse(tmp_path: Path) -> Path:
    (tmp_path / "coarse.inp").write_text(bracket(fine=False))
    return tmp_path / "coarse.inp"


@pytest.fixture(scope="module")
def body(fine: Path) -> CondensedBody:
    return sj.body.condense(fine, ABC, [*LINEAR, "hot=step:1"], points="P", modes=6)


def wanted(path: Path, name: str) -> np.ndarray:
    """Mean motions of the closed form of a linear temperature."""
    deck = decks.read(path)
    found = []
    for patch_name in ABC:
        nodes = deck.nodes_of(patch_name)
        _, rows = patch(nodes, deck.positions, deck.faces(), None)
        found.append(rows @ np.ravel([closed_form(deck.positions[node], *LINEAR[name]) for node in nodes]))
    return np.concatenate(found)


def without_rigid(body: CondensedBody, dofs: np.ndarray) -> np.ndarray:
    motions = body.rigid_motions[:len(dofs)]
    return np.asarray(dofs - motions @ np.linalg.lstsq(motions, dofs, rcond=None)[0])


def scaled(dofs: np.ndarray, length_m: float = 0.1) -> float:
    return float(np.abs(dofs.reshape(-1, 6) * [1, 1, 1, length_m, length_m, length_m]).max())


def test_stiffness_and_mass_of_the_bracket(body: CondensedBody) -> None:
    assert np.allclose(body.node_positions_m, [[0.2, 0.02, 0.005], [0.005, 0.02, 0.12], [0.01, 0.02, 0]], rtol=0, atol=1e-12)
    assert body.measured.rigid_error < 1e-11 and not body.notes
    assert body.measured.mass_kg == pytest.approx(MASS_KG, rel=1e-10)
    # An own 20-node brick with reduced integration, condensed in double precision.
    assert body.stiffness[0, 0] == pytest.approx(1.4526089727366635e8, rel=1e-11)
    assert body.stiffness[1, 1] == pytest.approx(5.6326218712998023e6, rel=1e-11)
    assert body.stiffness[4, 2] == pytest.approx(3.9426221772385928e4, rel=1e-10)


@pytest.mark.parametrize("name", LINEAR)
def test_linear_temperatures_cause_no_force(body: CondensedBody, fine: Path, name: str) -> None:
    shape = body.free_shapes[body.pattern_names.index(name)][:18]
    expected = wanted(fine, name)
    assert scaled(without_rigid(body, shape - expected)) < 1e-9 * scaled(expected)
    force = np.abs(body.stiffness[:18, :18] @ (shape - expected)).max()
    assert force < 1e-9 * 70e9 * 4e-4 * EXPANSION * max(LINEAR[name][0], 0.2)


def test_patterns_of_the_deck_and_points(body: CondensedBody, fine: Path) -> None:
    uniform, hot = (body.free_shapes[body.pattern_names.index(name)] for name in ("uniform", "hot"))
    assert np.abs(without_rigid(body, hot[:18] - 2.5 * uniform[:18])).max() < 1e-9 * np.abs(hot).max()
    assert body.points is not None and body.mesh is not None and body.mesh.rows is not None
    for place, name in enumerate(body.pattern_names[:4]):
        moved = (body.points.rows @ body.free_shapes[place] + body.points.patterns[place]).reshape(-1, 3)
        exact = np.array([closed_form(one, *LINEAR[name]) for one in body.points.positions_m])
        nodes = np.concatenate([wanted(fine, name), np.zeros(6)]) - body.free_shapes[place]
        motion = np.linalg.lstsq(body.rigid_motions, nodes, rcond=None)[0]
        moved += motion[:3] + np.cross(motion[3:], body.points.positions_m)
        assert np.abs(moved - exact).max() < 1e-9 * np.abs(exact).max(), name


def test_a_rigid_motion_moves_points_rigidly(body: CondensedBody) -> None:
    assert body.points is not None and body.mesh is not None and body.mesh.rows is not None
    for places, rows in ((body.points.positions_m, body.points.rows), (body.mesh.points_m, body.mesh.rows)):
        moved = rows @ body.rigid_motions
        exact = np.vstack([np.hstack([np.eye(3), [[0, z, -y], [-z, 0, x], [y, -x, 0]]]) for x, y, z in places])
        assert np.abs(moved - exact).max() < 1e-9


def test_patches_that_do_not_expand_bend_the_bracket(fine: Path) -> None:
    found = {kind: sj.body.condense(fine, [f"{name}={kind}" for name in ABC]) for kind in ("expanding", "rigid")}
    expected = wanted(fine, "uniform")
    for kind, body in found.items():
        assert body.patch == kind
        force = np.abs(body.stiffness @ (body.free_shapes[0] - expected))[[0, 1, 2, 6, 7, 8, 12, 13, 14]].max()
        assert force < 1e-7 if kind == "expanding" else 31 < force < 32  # N per kelvin, 5 % of E A alpha
    assert found["rigid"].stiffness[0, 0] == pytest.approx(1.4846742922764778e8, rel=1e-10)


def test_units_of_the_deck(coarse: Path, tmp_path: Path) -> None:
    (tmp_path / "mm.inp").write_text(bracket(1e3, fine=False, material="70e3", density="2.7e-9"))
    metres = sj.body.condense(coarse, ABC, ["uniform", "x"], points="P", modes=2)
    other = sj.body.condense(tmp_path / "mm.inp", ABC, ["uniform", "x"], points="P", modes=2, units=SYSTEMS["mm-N"])
    assert metres.mass is not None and other.mass is not None and metres.points is not None and other.points is not None
    assert np.abs(other.stiffness - metres.stiffness)[:18, :18].max() < 1e-9 * np.abs(metres.stiffness[:18, :18]).max()
    assert np.abs(other.mass - metres.mass)[:18, :18].max() < 1e-9 * np.abs(metres.mass[:18, :18]).max()
    assert np.abs(without_rigid(metres, (other.free_shapes - metres.free_shapes)[1, :18])).max() < 1e-12
    for one in (metres, other):
        assert sj.body.check(one).fixed_Hz == pytest.approx(sj.body.check(metres).fixed_Hz, rel=1e-8)
    assert np.allclose(other.points.rows[:, :18], metres.points.rows[:, :18], rtol=0, atol=1e-9)


def test_modes_improve_the_frequencies(body: CondensedBody, fine: Path) -> None:
    assert body.mass is not None and body.modes == 6
    assert np.abs(body.stiffness[:18, 18:]).max() < 1e-9 * np.abs(body.stiffness).max()
    assert np.allclose(body.mass[18:, 18:], np.eye(6), rtol=0, atol=1e-9)
    checked = sj.body.check(body)
    assert checked.passed, checked.frame()
    static = sj.body.check(sj.body.from_arrays(ABC, body.node_positions_m, body.stiffness[:18, :18], mass=body.mass[:18, :18]))
    assert (checked.free_Hz[6:9] < static.free_Hz[6:9]).all()


def test_panel_of_shells(tmp_path: Path) -> None:
    (tmp_path / "panel.inp").write_text(panel())
    body = sj.body.condense(tmp_path / "panel.inp", ["H1", "H2", "T1", "T2"], ["uniform", "bow=thickness"])
    assert body.measured.rigid_error < 1e-10 and body.measured.mass_kg == pytest.approx(2.7, rel=1e-7)
    plane = np.hstack([EXPANSION * body.node_positions_m, np.zeros((4, 3))]).ravel()
    assert scaled(without_rigid(body, body.free_shapes[0] - plane)) < 1e-7 * scaled(plane)
    deck = decks.read(tmp_path / "panel.inp")
    bent = []
    for name in body.node_names:
        nodes = deck.nodes_of(name)
        _, rows = patch(nodes, deck.positions, deck.faces(), None)
        bent.append(rows @ np.ravel([closed_form(deck.positions[node], 0.0, np.array([0, 0, 1.0])) for node in nodes]))
    expected = np.concatenate(bent)
    assert scaled(without_rigid(body, body.free_shapes[1] - expected), 0.25) < 1e-5 * scaled(expected, 0.25)


@pytest.mark.parametrize(("deck", "mass_kg"), [
    (panel(stiffened=True), 2.7 + 0.54), (panel(section=SANDWICH), 0.5 * (2 * 0.0003 * 2700 + 0.01 * 50))],
    ids=["stiffened", "sandwich"])
def test_stiffened_and_sandwich_panels(tmp_path: Path, deck: str, mass_kg: float) -> None:
    (tmp_path / "panel.inp").write_text(deck)
    body = sj.body.condense(tmp_path / "panel.inp", ["H1", "H2", "T1", "T2"])
    assert body.measured.rigid_error < 1e-7 and body.measured.mass_kg == pytest.approx(mass_kg, rel=1e-4)
    plane = np.hstack([EXPANSION * body.node_positions_m, np.zeros((4, 3))]).ravel()
    assert scaled(without_rigid(body, body.free_shapes[0] - plane)) < 1e-6 * scaled(plane)
    if "STIFFENER" in deck:
        with failing("condense_beam_node"):
            (tmp_path / "panel.inp").write_text(deck.replace("*MATERIAL", "*NSET,NSET=E\n290,\n291,\n292,\n293,\n294,\n*MATERIAL", 1))
            sj.body.condense(tmp_path / "panel.inp", ["E"])


@pytest.mark.parametrize("count", [3, 4, 6, 8])
def test_shape_functions_of_faces(count: int) -> None:
    corners = np.array([[0, 0], [1, 0], [0, 1]]) if count in (3, 6) else np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    middles = (corners + np.roll(corners, -1, axis=0)) / 2
    places = np.vstack([corners, middles])[:count]
    for number, place in enumerate(places):
        assert shapes(count, *place)[0] == pytest.approx(np.eye(count)[number], abs=1e-14)
    values, slopes = shapes(count, 0.3, 0.2)
    assert values.sum() == pytest.approx(1.0) and values @ places == pytest.approx([0.3, 0.2])
    for axis, step in enumerate(np.eye(2) * 1e-6):
        rise = (shapes(count, *(np.array([0.3, 0.2]) + step))[0] - shapes(count, *(np.array([0.3, 0.2]) - step))[0]) / 2e-6
        assert slopes[axis] == pytest.approx(rise, abs=1e-8)


def test_node_of_three_dofs(coarse: Path) -> None:
    body = sj.body.condense(coarse, ["A", "ONE=node"])
    assert body.node_freedoms.tolist() == [6, 3] and body.measured.rigid_error < 1e-10


@pytest.mark.parametrize(("interfaces", "patterns", "code", "fields"), [
    (["NONE"], ["uniform"], "condense_no_set", {"name": "NONE"}),
    (["A=soft"], ["uniform"], "condense_kind", {}),
    (["A=node"], ["uniform"], "condense_one_node", {}),
    (["ONE"], ["uniform"], "condense_patch_line", {}),
    (["A"], ["warm=somehow"], "condense_pattern", {}),
    (["A"], ["warm=thickness"], "condense_no_shells", {}),
    (["A"], ["warm=step:2"], "condense_no_step", {"steps": 1}),
    (["A"], ["uniform", "uniform=x"], "condense_pattern_twice", {"value": "uniform"}),
    ([], ["uniform"], "condense_no_interface", {}),
])
def test_wrong_arguments_are_refused(coarse: Path, interfaces: list[str], patterns: list[str], code: str,
                                     fields: dict[str, object]) -> None:
    with failing(code, **fields):
        sj.body.condense(coarse, interfaces, patterns)


@pytest.mark.parametrize(("old", "new", "code", "fields"), [
    ("*SOLID SECTION", "*PLASTIC\n1e8,0.\n*SOLID SECTION", "condense_keyword", {"keyword": "PLASTIC"}),
    ("*ELASTIC\n70e9,0.3\n", "*ELASTIC\n70e9,0.3,0.\n60e9,0.3,100.\n", "condense_not_constant", {"keyword": "ELASTIC"}),
    ("TYPE=C3D20R", "TYPE=T3D3", "condense_element", {"kind": "T3D3"}),
    ("*BOUNDARY", "*INITIAL CONDITIONS,TYPE=TEMPERATURE\nA,0.\nB,5.\n*BOUNDARY", "condense_initial", {}),
    ("NALL,2.5", "A,2.5", "condense_node_cold", {}),
    ("*SOLID SECTION,ELSET=EALL", "*SOLID SECTION,ELSET=ENONE", "calculix_failed", {}),
])
def test_unsupported_decks_are_refused(coarse: Path, old: str, new: str, code: str, fields: dict[str, object]) -> None:
    text = coarse.read_text()
    assert old in text
    coarse.write_text(text.replace(old, new))
    with failing(code, file="coarse.inp" if code not in ("condense_node_cold",) else None, **fields):
        sj.body.condense(coarse, ["A"], ["uniform", "hot=step:1"])


def test_modes_need_a_density(coarse: Path) -> None:
    text = coarse.read_text()
    coarse.write_text(text.replace("*DENSITY\n2700.\n", ""))
    with failing("condense_no_density"):
        sj.body.condense(coarse, ["A"], modes=2)
    body = sj.body.condense(coarse, ["A", "B"])
    assert body.mass is None and body.measured.rigid_error < 1e-9
