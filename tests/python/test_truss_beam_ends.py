# SPDX-License-Identifier: GPL-3.0-or-later
"""Ends of beams: releases, rigid offsets, rigid bodies, hinges. Closed forms by hand; refusals."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from test_truss_beam import SLENDER, STEEL, WARM, clamp, frame, of_hottest, states

from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.truss.generate.document import node

EI = 6e7  # N m² of WARM
COLD: dict[str, Any] = {"cross_section_area_m2": 2e-2, "second_moments_of_area_m4": [EI / 210e9, EI / 210e9]}
SPACE: dict[str, Any] = {"torsion_constant_m4": 4e-4, "axis_y": [0.0, 0.0, 1.0]}
ALUMINIUM: dict[str, Any] = {"young_modulus_Pa": 70e9, "thermal_expansion_per_K": 23e-6, "cross_section_area_m2": 2e-4,
                             "second_moments_of_area_m4": [0.02**3 * 0.01 / 12, 0.01**3 * 0.02 / 12]}


def refused(made: dict[str, Any]) -> str:
    with pytest.raises(StatejumpError) as caught:
        parse_case(made).resolve()
    return str(caught.value.code)


# ---------------------------------------------------------------- releases


def test_released_end_is_that_of_a_propped_beam() -> None:
    made = frame(clamp("A", (0.0, 0.0)), node("B", (3.0, 0.0)), clamp("C", (6.0, 0.0)),
                 beam=[{"nodes": ["A", "B"], **WARM}, {"nodes": ["B", "C"], **WARM, "released_second": ["Rz"]}])
    found = states(made)
    assert abs(of_hottest(found, "beam_force_first_N")[0, 1]) == pytest.approx(9e3, rel=1.3e-5)
    assert abs(of_hottest(found, "beam_moment_first_N_m")[0, 2]) == pytest.approx(54e3, rel=1.3e-5)
    assert of_hottest(found, "beam_moment_second_N_m")[1, 2] == 0


def test_portal_with_a_pinned_beam_is_two_cantilevers() -> None:
    # H at the top of one column: each carries H/2, as the pinned beam is stiff: u = H h³/(6 E I).
    stiff = {**COLD, "cross_section_area_m2": 10.0}
    made = frame(clamp("A", (0.0, 0.0)), node("B", (0.0, 4.0), **{}), node("C", (6.0, 4.0)), clamp("D", (6.0, 0.0)),
                 change_K=1e-9,
                 beam=[{"nodes": ["A", "B"], **COLD},
                       {"nodes": ["B", "C"], **stiff, "released_first": ["Rz"], "released_second": ["Rz"]},
                       {"nodes": ["C", "D"], **COLD}])
    made["node"][1]["force_N"] = [2000.0, 0.0]
    found = states(made)
    assert of_hottest(found, "displacement_m")[1, 0] == pytest.approx(2000 * 4**3 / (6 * EI), rel=2e-5)
    assert of_hottest(found, "beam_force_first_N")[1, 0] == pytest.approx(-1000, rel=1e-4)
    assert np.abs(of_hottest(found, "beam_moment_first_N_m")[1]).max() == 0


def pinned_triangle(dimension: int) -> dict[str, Any]:
    """Three beams with all moments released, as links; in space a tripod."""
    released = {"released_first": ["Rz"], "released_second": ["Rz"]}
    if dimension == 2:
        nodes = [node("A", (0.0, 0.0), "xy"), node("B", (4.0, 0.0), "y"), node("C", (2.0, 3.0), force_N=[3e3, -5e3])]
        pairs = [["A", "B"], ["B", "C"], ["A", "C"]]
        return frame(*nodes, change_K=30.0, beam=[{"nodes": pair, **COLD, **released} for pair in pairs])
    released = {"released_first": ["Rx", "Ry", "Rz"], "released_second": ["Ry", "Rz"]}
    nodes = [node(name, place, "xyz") for name, place in
             (("A", (0.0, 0.0, 0.0)), ("B", (4.0, 0.0, 0.0)), ("C", (1.0, 3.0, 0.0)))]
    return frame(*nodes, {**node("D", (2.0, 1.0, 3.0)), "force_N": [3e3, -5e3, 1e3]}, change_K=30.0, dimension=3,
                 beam=[{"nodes": [end, "D"], **COLD, **SPACE, **released} for end in "ABC"])


@pytest.mark.parametrize("dimension", [2, 3])
def test_beams_without_moments_are_links(dimension: int) -> None:
    made = pinned_triangle(dimension)
    links = {**{key: part for key, part in made.items() if key != "beam"}, "link": [{"name": beam["name"], "nodes": beam["nodes"], "cross_section_area_m2": 2e-2, **STEEL}
                              for beam in made["beam"]]}
    bars, beams = states(links), states(made)
    assert beams["displacement_m"] == pytest.approx(bars["displacement_m"], rel=1e-9, abs=1e-15)
    assert -beams["beam_force_first_N"][..., 0] == pytest.approx(bars["axial_force_N"], rel=1e-9, abs=1e-5)


def test_bar_that_turns_far_has_no_limit_of_rotation() -> None:
    # A pendulum, pulled to the side by a spring of length zero: the bar rotates by far more than 1 rad.
    made = frame(node("A", (0.0, 0.0), "xy"), node("B", (1.0, 0.0)), node("S", (-2.0, 1.5), "xy"), change_K=1e-9,
                 beam=[{"nodes": ["A", "B"], **SLENDER, "released_first": ["Rz"], "released_second": ["Rz"]}],
                 spring=[{"name": "pull", "nodes": ["B", "S"], "stiffness_N_per_m": 10.0, "free_length_m": 0.0}])
    made["node"][1]["force_N"] = [0.0, 5.0]
    try:
        place = states(made)["displacement_m"][-1, 1, :2] + [1.0, 0.0]
    except StatejumpError as error:  # pragma: no cover - shows the message
        pytest.fail(str(error))
    # The spring pulls with k (S - B) and the load adds 5 N: B lies on their sum's line through A.
    along = np.array([-20.0, 20.0]) / np.hypot(20.0, 20.0)
    assert place / np.linalg.norm(place) == pytest.approx(along, abs=1e-6)


def test_released_axial_force() -> None:
    made = frame(clamp("A", (0.0, 0.0)), clamp("B", (6.0, 0.0)),
                 beam=[{"nodes": ["A", "B"], **COLD, "released_second": ["Fx"]}])
    assert np.abs(states(made)["beam_force_first_N"]).max() < 1e-9


def test_slender_bar_under_its_buckling_load_is_refused() -> None:
    made = frame(node("A", (0.0, 0.0), "xy"), {**node("B", (1.0, 0.0), "y"), "force_N": [-130.0, 0.0]}, change_K=1e-9,
                 beam=[{"nodes": ["A", "B"], **SLENDER, "released_first": ["Rz"], "released_second": ["Rz"]}])
    with pytest.raises(StatejumpError, match="buckling load"):
        states(made)


def test_releases_that_leave_a_mechanism_are_refused() -> None:
    made = pinned_triangle(3)
    made["beam"][0]["released_second"] = ["Rx"]
    assert refused(made) == "released_twice"
    made = pinned_triangle(2)
    made["beam"][0] |= {"released_first": ["Fx"], "released_second": ["Fx"]}
    assert refused(made) == "released_twice"
    made["beam"][0] |= {"released_first": ["Ry"], "released_second": []}
    assert refused(made) == "planar_releases"
    made = pinned_triangle(2)
    made["node"][2]["moment_N_m"] = [1.0]
    assert refused(made) == "node_without_rotation"


# ---------------------------------------------------------------- offsets and rigid bodies


def eccentric(**more: Any) -> dict[str, Any]:
    """A cantilever of 1 m along x, loaded by a force along -x at 0.5 m above its tip."""
    return frame(clamp("A", (0.0, 0.0)), node("B", (1.0, 0.0)), change_K=1e-6, **more)


def test_offset_turns_with_its_node() -> None:
    # The node B is 0.5 m above the end of the beam and carries the load; a [[rigid]] makes the same structure.
    load = {"force_N": [-5.0, 0.0]}
    offset = frame(clamp("A", (0.0, 0.0)), {**node("C", (1.0, 0.5)), **load}, change_K=1e-6,
                   beam=[{"nodes": ["A", "C"], **SLENDER, "offset_second_m": [0.0, -0.5]}])
    rigid = frame(clamp("A", (0.0, 0.0)), node("B", (1.0, 0.0)), {**node("C", (1.0, 0.5)), **load}, change_K=1e-6,
                  beam=[{"nodes": ["A", "B"], **SLENDER}], rigid=[{"name": "R", "master": "B", "nodes": ["C"]}])
    one, other = states(offset), states(rigid)
    turned = other["rotation_rad"][-1, 1, 2]
    assert turned > 0.2
    assert one["rotation_rad"][-1, 1, 2] == pytest.approx(turned, rel=1e-9)
    assert one["displacement_m"][-1, 1] == pytest.approx(other["displacement_m"][-1, 2], abs=1e-10)
    assert one["beam_moment_second_N_m"][-1, 0, 2] == pytest.approx(5.0 * 0.5 * np.cos(turned), rel=1e-7)
    assert other["rigid_force_N"][-1, 0] == pytest.approx([5.0, 0.0, 0.0], abs=1e-7)


def test_rigid_body_in_space_keeps_its_shape() -> None:
    places = {"B": (1.0, 0.0, 0.0), "C": (1.2, 0.3, 0.1), "D": (0.9, -0.2, 0.4), "E": (1.5, 0.0, 0.2)}
    made = frame(clamp("A", (0.0, 0.0, 0.0)), *(node(name, place) for name, place in places.items()), change_K=1e-6,
                 dimension=3, beam=[{"nodes": ["A", "B"], **SLENDER, **SPACE, "torsion_constant_m4": 2e-8}],
                 rigid=[{"name": "R", "master": "B", "nodes": ["C", "D"]}, {"name": "S", "master": "C", "nodes": ["E"]}])
    for index, force in ((2, [1.0, -3.0, 2.0]), (3, [-1.0, 2.0, 2.0]), (4, [0.0, 1.0, -2.0])):
        made["node"][index]["force_N"] = force
    found = states(made)
    moved = found["displacement_m"][-1, 1:] + np.array(list(places.values()))
    drawn = np.array(list(places.values()))
    assert np.abs(found["rotation_rad"][-1, 1]).max() > 0.05
    for a in range(4):
        for b in range(a):
            assert np.linalg.norm(moved[a] - moved[b]) == pytest.approx(np.linalg.norm(drawn[a] - drawn[b]), rel=1e-12)
    # Moment of the loads about the clamp, from the deformed positions.
    forces = np.array([[0, 0, 0], [1.0, -3, 2], [-1.0, 2, 2], [0, 1.0, -2]])
    moment = np.cross(moved, forces).sum(axis=0)
    frame_moment = found["beam_moment_first_N_m"][-1, 0]
    assert np.linalg.norm(frame_moment) == pytest.approx(np.linalg.norm(moment), rel=1e-9)


def test_rigid_body_on_bars_has_a_master_without_beams() -> None:
    # A plate on three links in a plane: it rotates as a lever.
    bar = {"cross_section_area_m2": 1e-4, **STEEL}
    made = frame(node("A", (0.0, 0.0), "xy"), node("B", (1.0, 0.0), "xy"), node("C", (-1.0, 1.0), "xy"),
                 node("P", (0.0, 1.0)), node("Q", (1.0, 1.0)), {**node("R", (2.0, 1.0)), "force_N": [0.0, -100.0]},
                 change_K=1e-9, beam=[], rigid=[{"name": "plate", "master": "P", "nodes": ["Q", "R"]}],
                 link=[{"name": name, "nodes": list(name), **bar} for name in ("AP", "BQ", "CP")])
    found = states(made)
    assert found["axial_force_N"][-1] == pytest.approx([-100.0, 200.0, 0.0], rel=1e-4, abs=1e-3)


def test_rigid_without_rotations_holds_displacements_only() -> None:
    made = frame(clamp("A", (0.0, 0.0)), node("B", (1.0, 0.0)), node("C", (1.0, 0.0)), clamp("D", (2.0, 0.0)),
                 change_K=1e-9, beam=[{"nodes": ["A", "B"], **COLD}, {"nodes": ["C", "D"], **COLD}],
                 rigid=[{"name": "pin", "master": "B", "nodes": ["C"], "rotations": []}])
    made["node"][1]["force_N"] = [0.0, 1e3]
    found = states(made)
    # Two cantilevers share the load.
    assert found["displacement_m"][-1, 1, 1] == pytest.approx(500 / (3 * EI), rel=1e-9)
    assert found["rotation_rad"][-1, 1, 2] == pytest.approx(-found["rotation_rad"][-1, 2, 2], rel=1e-9)


@pytest.mark.parametrize("rigid, code", [
    ([{"master": "B", "nodes": ["B"]}], "rigid_node_repeated"),
    ([{"master": "B", "nodes": []}], "rigid_without_node"),
    ([{"master": "B", "nodes": ["C"], "rotations": ["x"]}], "rigid_rotations"),
    ([{"master": "B", "nodes": ["C"]}, {"master": "D", "nodes": ["C"]}], "rigid_node_twice"),
    ([{"master": "B", "nodes": ["C"]}, {"master": "C", "nodes": ["B"]}], "rigid_ring"),
    ([{"master": "A", "nodes": ["D"]}], "rigid_node_fixed"),
    ([{"master": "B", "nodes": ["X"]}], "reference_without_section"),
])
def test_refused_rigid_bodies(rigid: list[dict[str, Any]], code: str) -> None:
    made = frame(clamp("A", (0.0, 0.0)), node("B", (1.0, 0.0)), node("C", (1.0, 0.5)), node("D", (2.0, 0.0), "xy"),
                 beam=[{"nodes": ["A", "B"], **COLD}],
                 rigid=[{"name": f"R{k}", **one} for k, one in enumerate(rigid)])
    if code == "reference_without_section":
        assert refused(made) in ("misspelt_reference", "undefined_reference")
    else:
        assert refused(made) == code


# ---------------------------------------------------------------- hinges


def hinged(**hinge: Any) -> dict[str, Any]:
    """Clamp - 1 m - hinge - 1 m - guided clamp, under a gradient of 20 K over 10 mm, one cycle."""
    warm = {**ALUMINIUM, "temperature_fraction": 0.0, "gradient_per_m": [100.0, 0.0]}
    end = {**node("D", (2.0, 0.0)), "fixed": [], "fixed_rotations": ["z"]}
    return frame(clamp("A", (0.0, 0.0)), node("B", (1.0, 0.0)), node("C", (1.0, 0.0)), end, change_K=20.0,
                 beam=[{"nodes": ["A", "B"], **warm}, {"nodes": ["C", "D"], **warm}],
                 hinge=[{"name": "H", "nodes": ["B", "C"], **hinge}])


def test_hinge_keeps_an_angle_by_friction() -> None:
    found = states(hinged(stiffness_N_m_per_rad=40.0, friction_moment_N_m=1.0))
    assert abs(found["beam_hinge_rotation_rad"][-1, 0]) == pytest.approx(0.0101694915254, abs=1e-10)


def test_hinge_without_moment_releases_the_rotation() -> None:
    found = states(hinged())
    # 2 κ L of both beams, bent freely.
    assert abs(of_hottest(found, "beam_hinge_rotation_rad")[0]) == pytest.approx(2 * 23e-6 * 20 / 0.01, rel=1e-9)
    assert np.abs(of_hottest(found, "beam_moment_second_N_m")).max() < 1e-7


def test_hinge_with_play() -> None:
    found = states(hinged(stiffness_N_m_per_rad=40.0, deadband_rad=0.05))
    # φ (1 + 2 K L/(E I)) = 2 κ L + play 2 K L/(E I)
    ratio = 2 * 40.0 / (70e9 * 0.02 * 0.01**3 / 12)
    expected = (2 * 23e-6 * 20 / 0.01 + 0.05 * ratio) / (1 + ratio)
    assert abs(of_hottest(found, "beam_hinge_rotation_rad")[0]) == pytest.approx(expected, rel=1e-9)


def test_hinge_in_space_rotates_about_its_axis_only() -> None:
    tip = {**node("D", (2.0, 0.0, 0.0)), "force_N": [0.0, 1.0, 2.0]}
    made = frame(clamp("A", (0.0, 0.0, 0.0)), node("B", (1.0, 0.0, 0.0)), node("C", (1.0, 0.0, 0.0)), tip,
                 change_K=1e-6, dimension=3,
                 beam=[{"nodes": pair, **SLENDER, **SPACE, "torsion_constant_m4": 2e-8}
                       for pair in (["A", "B"], ["C", "D"])],
                 hinge=[{"name": "H", "nodes": ["B", "C"], "axis": [0.0, 1.0, 0.0], "stiffness_N_m_per_rad": 5.0}])
    found = states(made)
    # The moment about the axis of the hinge, fixed to B, is K φ.
    angle = found["beam_hinge_rotation_rad"][-1, 0]
    assert abs(angle) > 0.1
    assert found["beam_hinge_moment_N_m"][-1, 0] == pytest.approx(5.0 * angle, rel=1e-12)
    rotations = [rotation_matrix(found["rotation_rad"][-1, k]) for k in (1, 2)]
    relative = rotations[0].T @ rotations[1]
    assert relative @ [0, 1, 0] == pytest.approx([0, 1, 0], abs=1e-12)
    assert found["displacement_m"][-1, 1] == pytest.approx(found["displacement_m"][-1, 2], abs=1e-15)


def rotation_matrix(vector: np.ndarray) -> np.ndarray:
    angle = np.linalg.norm(vector)
    skew = np.cross(np.eye(3), vector / angle)
    return np.asarray(np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew)


def test_refused_hinges() -> None:
    made = hinged(friction_moment_N_m=1.0)
    made["node"][2]["position_m"] = [1.0, 0.1]
    assert refused(made) == "hinge_apart"
    made = hinged(friction_moment_N_m=1.0)
    made["reduced"] = {**made.get("reduced", {}), "sticking": "elastic"}
    assert refused(made) == "hinge_sticking_missing"


# ---------------------------------------------------------------- free spins


def strut(friction: float = 0.0) -> dict[str, Any]:
    """A warm strut in two beams between balls; a spring presses it, and its middle node carries a load across."""
    ball = {"ball_radius_m": 0.02, "radial_clearance_m": 1e-4, "friction_coefficient": friction}
    made = frame(node("A", (0.0, 0.0, 0.0), "xyz"), node("P", (0.0, 0.0, 0.0)), node("M", (1.0, 0.0, 0.0)),
                 node("Q", (2.0, 0.0, 0.0)), node("B", (2.0, 0.0, 0.0), "yz"), node("C", (4.0, 0.0, 0.0), "xyz"),
                 change_K=30.0, dimension=3,
                 beam=[{"nodes": ["P", "M"], **COLD, **SPACE}, {"nodes": ["M", "Q"], **COLD, **SPACE}],
                 ball_joint=[{"name": "foot", "socket_node": "A", "ball_node": "P", **ball},
                             {"name": "head", "socket_node": "B", "ball_node": "Q", **ball}],
                 spring=[{"name": "spring", "nodes": ["B", "C"], "stiffness_N_per_m": 1e6, "preload_N": -100.0}])
    made["node"][2]["force_N"] = [0.0, -10.0, 5.0]
    made["reduced"] = {"sticking": "elastic"}
    return made


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_free_spin_of_a_strut_is_held_and_noted(friction: float) -> None:
    made = strut(friction)
    case = parse_case(made)
    run = case.reduced()
    assert [one.code for one in run.warnings if one.code == "free_spin"] == ["free_spin"]
    assert "beam 'beam 1': free to spin" in next(one for one in run.warnings if one.code == "free_spin")
    # A support of the rotation about the strut holds the spin too.
    made["node"][2]["fixed_rotations"] = ["x"]
    held = states(made)
    size = np.abs(held["displacement_m"]).max()
    assert run["displacement_m"][-1] == pytest.approx(held["displacement_m"][-1], abs=1e-9 * size)
    assert held["displacement_m"][:, 2, 1].min() < -1e-6


def test_moment_about_a_free_spin_is_refused() -> None:
    made = strut()
    made["node"][2]["moment_N_m"] = [1.0, 0.0, 0.0]
    with pytest.raises(StatejumpError) as caught:
        parse_case(made).reduced()
    assert caught.value.code == "held_mechanism"
