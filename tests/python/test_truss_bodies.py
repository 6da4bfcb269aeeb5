# SPDX-License-Identifier: GPL-3.0-or-later
"""Condensed bodies in trusses: they equal the links, beams and frames that they condense."""
from __future__ import annotations

import pickle
import shutil
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest
from body_parts import (
    AREA_M2, DENSITY, EXPANSION_PER_K, MOMENTS_M4, YOUNG_PA, bar_body, beam_keys, frame_body,
)

from conftest import REPOSITORY

import statejump as sj
from statejump.bodies.body import Points
from statejump.bodies.condense.run import condense
from statejump.bodies.files import read_body, write_body
from statejump.core.errors import StatejumpError

ROUNDING = 1e-9
# A body is linear in its frame. Links take strains relative to the heated length, and beams have frames of their own,
# so displacements differ by a fraction that is proportional to the temperature change.
FALLS = 8.0  # least factor if temperatures and forces are divided by 10; 10 without rounding

BRACKET = np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.12, 0.03]])
Y = (0.0, 1.0, 0.0)
Z = (0.0, 0.0, 1.0)


def rotation(angle: float) -> np.ndarray:
    """Return a rotation about an axis without symmetry."""
    x, y, z = np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8])
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def bracket_case(as_body: bool, turn: np.ndarray | None = None, change_K: float = 60.0, **more: Any) -> Any:
    """Return two brackets, tip to tip, with a slider with friction and a spring between the tips."""
    turn = np.eye(3) if turn is None else turn
    mirror = np.diag([1.0, 1.0, -1.0])
    shapes = {"L": BRACKET, "R": BRACKET @ mirror + [0.0, 0.0, 0.06]}
    nodes: list[dict[str, Any]] = []
    beams: list[dict[str, Any]] = []
    bodies: list[dict[str, Any]] = []
    for side, positions in shapes.items():
        for number, position in enumerate(positions):
            if as_body and number == 1:
                continue
            ground = {"fixed": ["x", "y", "z"], "fixed_rotations": ["x", "y", "z"]} if number == 0 else {}
            nodes.append({"name": f"{side}{number}", "position_m": (turn @ position).tolist(), **ground})
        if as_body:
            # In axes of its own, which the case turns into place.
            own = rotation(0.7)
            content = frame_body(positions @ turn.T, [(0, 1, turn @ Y), (1, 2, turn @ Z)], (0, 2), ("foot", "tip"), own)
            bodies.append({"name": side, "nodes": [f"{side}0", f"{side}2"], "content": content,
                           "axis_x": own[:, 0].tolist(), "axis_y": own[:, 1].tolist()})
        else:
            beams += [{"name": f"{side}{k}", "nodes": [f"{side}{k}", f"{side}{k + 1}"], **beam_keys(turn @ axis)}
                      for k, axis in enumerate((Y, Z))]
    slider = {"name": "S", "nodes": ["L2", "R2"], "axis": (turn @ [1.0, 0.0, 0.0]).tolist(),
              "friction_coefficient": 0.1, "normal_force_N": change_K / 3}
    pull = {"name": "anchor", "position_m": (turn @ [0.5, 0.12, 0.03]).tolist(), "fixed": ["x", "y", "z"]}
    return sj.load({
        "case": {"name": "brackets", "kind": "truss"}, "truss": {"dimension": 3}, "node": [*nodes, pull],
        **({"body": bodies} if as_body else {"beam": beams}), "slider": [slider],
        "spring": [{"name": "K", "nodes": ["R2", "anchor"], "stiffness_N_per_m": 1e5}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": change_K, "cycles": 2, "period_s": 1.0},
        **more})


def jump(case: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return displacements at the largest temperature and the jump, of the tips."""
    run = case.reduced()
    moved = run.history["displacement_m"].values
    names = [node.name for node in case.node]
    tips = [names.index(name) for name in ("L2", "R2")]
    middle = int(np.argmax(run.history["temperature_change_K"].values))
    return moved[middle][tips], (moved[-1] - moved[0])[tips]


def test_frame_equals_its_beams() -> None:
    def difference(change_K: float) -> np.ndarray:
        """Return the differences while hot and of the jump, over the largest displacement."""
        of_beams, of_bodies = (jump(bracket_case(as_body, change_K=change_K)) for as_body in (False, True))
        size = np.abs(of_beams[0]).max()
        assert np.abs(of_beams[1]).max() > 1e-3 * size  # it has a jump
        return np.array([np.abs(beams - bodies).max() / size for beams, bodies in zip(of_beams, of_bodies)])

    some, fewer = difference(60.0), difference(6.0)
    assert (FALLS * fewer <= some).all(), (some, fewer)


@pytest.mark.parametrize("angle", (0.1, 1.0, 3.0))
def test_rotated_structure_has_the_same_jump(angle: float) -> None:
    turn = rotation(angle)
    here, there = jump(bracket_case(True)), jump(bracket_case(True, turn))
    for one, other in zip(here, there):
        assert np.abs(one @ turn.T - other).max() <= ROUNDING * np.abs(one).max()


def bar_case(as_body: bool, change_K: float = 80.0) -> Any:
    """Return a chain: a bar, a slider with friction on it, and a spring."""
    nodes = [{"name": "A", "position_m": [0.0, 0.0, 0.0], "fixed": ["x", "y", "z"]},
             {"name": "B", "position_m": [0.6, 0.8, 0.0], "fixed": ["z"], "guide_normal": [-0.8, 0.6, 0.0]},
             {"name": "C", "position_m": [1.2, 1.6, 0.0], "fixed": ["x", "y", "z"]}]
    bar = {"name": "bar", "nodes": ["A", "B"]}
    parts: dict[str, Any] = {"body": [{**bar, "content": bar_body(1.0), "axis_x": [0.6, 0.8, 0.0],
                                       "axis_y": [-0.8, 0.6, 0.0]}]} if as_body else {
        "link": [{**bar, "young_modulus_Pa": YOUNG_PA, "cross_section_area_m2": AREA_M2,
                  "thermal_expansion_per_K": EXPANSION_PER_K, "density_kg_per_m3": DENSITY}]}
    return sj.load({
        "case": {"name": "bar", "kind": "truss"}, "truss": {"dimension": 3}, "node": nodes, **parts,
        "slider": [{"name": "S", "nodes": ["B"], "axis": [0.6, 0.8, 0.0], "friction_coefficient": 0.2,
                    "normal_force_N": 6.25 * change_K}],
        "spring": [{"name": "K", "nodes": ["B", "C"], "stiffness_N_per_m": 1e6}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": change_K, "cycles": 2, "period_s": 1.0}})


def test_bar_equals_its_link() -> None:
    def difference(change_K: float) -> float:
        """Return the difference over the largest displacement."""
        runs = [bar_case(as_body, change_K).reduced() for as_body in (False, True)]
        link, body = (run.history["displacement_m"].values for run in runs)
        assert runs[0].summary["largest_jump_m"] > 1e-3 * np.abs(link).max()
        return float(np.abs(link - body).max() / np.abs(link).max())

    some, fewer, least = difference(8.0), difference(0.8), difference(8e-5)
    assert FALLS * fewer <= some
    assert least <= ROUNDING


def test_case_is_saved_pickled_and_read_from_its_result(tmp_path: Path) -> None:
    case = bracket_case(True)
    expected = jump(case)
    saved = case.save(tmp_path / "brackets.toml")
    assert (tmp_path / "brackets_L.h5").is_file()
    for again in (sj.load(saved), pickle.loads(pickle.dumps(case))):
        for one, other in zip(expected, jump(again)):
            assert np.abs(one - other).max() <= ROUNDING * np.abs(one).max()
    with pytest.raises(StatejumpError) as refused:
        case.to_toml()
    assert refused.value.code == "body_content_not_in_text"


def changed(part: dict[str, Any], section: str = "body") -> Any:
    """Return the bar as a body with changed keys."""
    data = bar_case(True).origin.document
    data = {**data, section: [{**data[section][0], **part}]}
    return sj.load(data)


@pytest.mark.parametrize(("keys", "code"), [
    ({"content": None}, "body_file_missing"),
    ({"nodes": ["A", "B", "C"]}, "body_nodes"),
    ({"nodes": ["A", "A"]}, "body_node_repeated"),
    ({"nodes": ["A", "C"]}, "body_node_beside"),
    ({"axis_x": [-0.8, 0.6, 0.0]}, "body_axes_parallel"),
    ({"interface": ["a", "c"]}, "undefined_reference"),
    ({"patterns": ["hot"]}, "undefined_reference"),
    ({"programs": ["orbit"]}, "reference_without_section"),
    ({"temperature_fractions": [1.0, 2.0]}, "body_one_each"),
])
def test_wrong_keys_are_refused(keys: dict[str, Any], code: str) -> None:
    with pytest.raises(StatejumpError) as refused:
        changed(keys)
    assert refused.value.code == code


def test_bent_body_is_noted() -> None:
    case = bracket_case(True, change_K=6.0)
    assert not case.reduced().warnings
    data = case.origin.document
    nodes = [{**node, "force_N": [0.0, 0.0, 3000.0]} if node["name"] == "L2" else node for node in data["node"]]
    notes = sj.load({**data, "node": nodes}).reduced().warnings
    assert [note.code for note in notes] == ["body_bends"] * 2


def cantilever(tmp_path: Path, mass: np.ndarray | None, tip_kg: float = 0.0, **more: Any) -> Any:
    """Return a cantilever along x as a body in a file."""
    positions = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]])
    body = frame_body(positions, [(0, 1, Y)], (0, 1), ("root", "tip"))
    write_body(tmp_path / "cantilever.h5", attrs.evolve(body, mass=mass))
    return sj.load({
        "case": {"name": "cantilever", "kind": "truss"},
        "node": [{"name": "A", "position_m": positions[0].tolist(), "fixed": ["x", "y", "z"],
                  "fixed_rotations": ["x", "y", "z"]},
                 {"name": "B", "position_m": positions[1].tolist(), "mass_kg": tip_kg}],
        "body": [{"name": "boom", "nodes": ["A", "B"], "body_file": str(tmp_path / "cantilever.h5")}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 50.0, "cycles": 1, "period_s": 1.0},
        **{"truss": {"dimension": 3}, **more}})


def test_frequencies_of_a_body(tmp_path: Path) -> None:
    """A mass at the tip of a massless cantilever has sqrt(3 E I/(m l^3)) about both axes, and sqrt(E A/(m l))."""
    case = cantilever(tmp_path, np.zeros((12, 12)), 2.0)
    found = np.sort(sj.modes(case).frequency_Hz)
    stiffnesses = [3 * YOUNG_PA * moment / 0.5**3 for moment in MOMENTS_M4] + [YOUNG_PA * AREA_M2 / 0.5]
    expected = np.sort(np.sqrt(np.array(stiffnesses) / 2.0) / (2 * np.pi))
    assert np.allclose(found[:3], expected, rtol=1e-9)


def test_weight_of_a_body(tmp_path: Path) -> None:
    """A uniform cantilever sags by w l^4/(8 E I): the consistent loads of its mass give the exact displacement."""
    length, line_density = 0.5, 3.0
    mass = np.zeros((12, 12))
    for axis, turn, sign in ((1, 5, 1.0), (2, 4, -1.0)):
        at, a = [axis, turn, axis + 6, turn + 6], sign * length
        mass[np.ix_(at, at)] = line_density * length / 420 * np.array(
            [[156, 22 * a, 54, -13 * a], [22 * a, 4 * a * a, 13 * a, -3 * a * a],
             [54, 13 * a, 156, -22 * a], [-13 * a, -3 * a * a, -22 * a, 4 * a * a]])
    mass[0, 0] = mass[6, 6] = line_density * length / 3
    mass[0, 6] = mass[6, 0] = line_density * length / 6
    gravity = {"truss": {"dimension": 3, "gravity_m_per_s2": [0.0, 0.0, -9.81]}}
    moved = cantilever(tmp_path, mass, **gravity).reduced().history["displacement_m"].values[0, 1, 2]
    sag = line_density * 9.81 * length**4 / (8 * YOUNG_PA * MOMENTS_M4[0])
    # The frame rotates by about sag/l, whose square shortens the projection.
    assert abs(moved + sag) <= 2 * (sag / length) ** 2 * sag + ROUNDING * sag
    with pytest.raises(StatejumpError) as refused:
        cantilever(tmp_path, None, **gravity)
    assert refused.value.code == "mass_of_condensed_body_missing"


def panel_case(turn: np.ndarray, hidden: bool) -> Any:
    """Return the left bracket with its corner as a point of the body or, not hidden, as an interface node."""
    names, kept = (("foot", "tip"), (0, 2)) if hidden else (("foot", "corner", "tip"), (0, 1, 2))
    positions = BRACKET @ turn.T
    body = frame_body(positions, [(0, 1, turn @ Y), (1, 2, turn @ Z)], kept, names, turn)
    if hidden:
        body = attrs.evolve(body, points=corner_point(turn))
    nodes = [{"name": name, "position_m": positions[place].tolist()} for name, place in zip(names, kept)]
    nodes[0] |= {"fixed": ["x", "y", "z"], "fixed_rotations": ["x", "y", "z"]}
    nodes[-1] |= {"force_N": (turn @ [3.0, 20.0, -10.0]).tolist()}
    return sj.load({
        "case": {"name": "panel", "kind": "truss"}, "truss": {"dimension": 3}, "node": nodes,
        "body": [{"name": "P", "nodes": list(names), "content": body, "axis_x": turn[:, 0].tolist(),
                  "axis_y": turn[:, 1].tolist()}],
        "reflector": {"axis": [0.0, 0.0, 1.0], **(
            {"nodes": ["tip"], "points": ["P/corner"]} if hidden else {"nodes": ["corner", "tip"]})},
        "thermal": {"shape": "triangle", "temperature_change_max_K": 60.0, "cycles": 1, "period_s": 1.0}})


def corner_point(turn: np.ndarray) -> Points:
    """Return the recovery of the corner of the bracket, in the axes of the body."""
    whole = frame_body(BRACKET, [(0, 1, Y), (1, 2, Z)], (0, 1, 2), ("foot", "corner", "tip"))
    kept = np.r_[0:6, 12:18]
    rows = -np.linalg.solve(whole.stiffness[6:12, 6:12], whole.stiffness[6:12][:, kept])[:3]
    shapes = whole.free_shapes
    patterns = shapes[:, 6:9] - shapes[:, kept] @ rows.T
    return Points(("corner",), BRACKET[1:2], rows, patterns)


def test_points_move_as_interface_nodes() -> None:
    turn = rotation(0.9)
    hidden, shown = panel_case(turn, True).reduced(), panel_case(turn, False).reduced()
    found = hidden.history["point_displacement_m"].values[:, 0]
    expected = shown.history["displacement_m"].values[:, 1]
    # The frames of both bodies differ by their rotations, 1e-4, whose square changes positions of 0.2 m.
    assert np.abs(found - expected).max() <= 4 * 0.2 * (2e-4) ** 2
    assert np.abs(expected).max() > 1e-4
    with pytest.raises(StatejumpError) as refused:
        data = panel_case(turn, True).origin.document
        sj.load({**data, "reflector": {**data["reflector"], "points": ["P/edge"]}})
    assert refused.value.code == "undefined_reference"


def test_shipped_panel_is_that_of_its_deck() -> None:
    if shutil.which("ccx") is None:
        pytest.skip("CalculiX is not installed")
    shipped = read_body(REPOSITORY / "cases" / "bodies" / "panel.h5")
    made = condense(REPOSITORY / "cases" / "bodies" / "panel.inp", ["HINGEL", "HINGER", "TIPL", "TIPR"],
                    ["uniform", "bow=thickness"], points="FACE")
    assert made.node_names == shipped.node_names and made.pattern_names == shipped.pattern_names
    largest = np.abs(shipped.stiffness).max()
    # The condensation loses digits with the thickness: 1e-7 of forces beside 1e-16 of the mesh's stiffest entry.
    assert np.abs(made.stiffness - shipped.stiffness).max() <= 1e-7 * largest
    for one, other in zip(made.free_shapes, shipped.free_shapes):  # up to a rigid motion
        assert np.abs(shipped.stiffness @ (one - other)).max() <= 1e-7 * largest * np.abs(one).max()


def test_bounds_of_bodies_contain_the_jump() -> None:
    """A free slider between bodies: its friction times the compliance of both, whatever the temperatures."""
    case = bracket_case(True)
    found = case.bounds(range_K="-60:60")
    jumped = np.abs(jump(case)[1]).max()
    largest = max(bound.jump for bound in found.bounds)
    assert jumped <= largest * (1 + 1e-6)
    assert largest <= 1.001 * jumped  # the cycle slips both ways, so it reaches the bound
