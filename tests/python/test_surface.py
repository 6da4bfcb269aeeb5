# SPDX-License-Identifier: GPL-3.0-or-later
"""A reflecting surface: a known displacement is recovered by the fit; what cannot be determined is reported."""
from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import failing, failure
import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.core.tables import write_columns
from statejump.surface.zernike import noll, zernike

FOCAL = 2.5


def nodes(rings: int = 8, radius: float = 1.5) -> np.ndarray:
    """The vertex of the paraboloid of focal length FOCAL, and rings of 6, 12, 18, ... nodes on it."""
    found = [(0.0, 0.0)]
    for ring in range(1, rings + 1):
        angle = 2 * np.pi * np.arange(6 * ring) / (6 * ring)
        found += list(zip(radius * ring / rings * np.cos(angle), radius * ring / rings * np.sin(angle)))
    across = np.array(found)
    return np.column_stack((across, np.sum(across**2, axis=1) / (4 * FOCAL)))


DRAWN = nodes()
DESIGN = sj.surface.Design.of(DRAWN)


def turned(positions: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    return np.cross(rotation, positions)


def test_drawn_paraboloid_is_found_wherever_it_stands() -> None:
    """The tolerance is the rounding of coordinates of some metres, over a sag of 0.2 m."""
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    vertex = np.array([3.0, -2.0, 7.0])
    found = sj.surface.Design.of(DRAWN @ turn.T + vertex, turn[:, 2])
    assert found.focal_length_m == pytest.approx(FOCAL, rel=1e-12) and found.design_rms_m < 1e-14
    np.testing.assert_allclose(found.vertex_m, vertex, rtol=0, atol=1e-13)
    assert found.aperture_m[1] == pytest.approx(1.5, rel=1e-12)


def test_tilt_and_shift_are_found_and_leave_nothing() -> None:
    tilt, shift = np.array([2e-6, -3e-6]), np.array([4e-6, 5e-6, -6e-6])
    moved = turned(DRAWN, np.array([-tilt[1], tilt[0], 0.0])) + shift
    found = DESIGN.errors(moved)
    np.testing.assert_allclose(found.tilt_rad, tilt, rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.vertex_shift_m, shift, rtol=0, atol=1e-15)
    assert abs(found.focal_change_m or 0.0) < 1e-15
    assert found.rms_m["rigid"] < 1e-17 and found.rms_m["rigid_focal"] < 1e-17
    expected = np.sum(DESIGN.normals * moved, axis=1)  # frame and axes of space are the same here
    assert found.rms_m["design"] == pytest.approx(np.sqrt(np.mean(expected**2)), rel=1e-12) and expected.any()
    for direction, size in (((0, 0, 1), np.linalg.norm(tilt)), ((1, 0, 0), abs(tilt[0]))):
        assert sj.surface.pointing_rad(DRAWN, moved, direction) == pytest.approx(size, rel=1e-9)


def test_change_of_focal_length_is_found_by_the_last_definition_alone() -> None:
    change = 1e-5
    moved = np.zeros_like(DRAWN)
    moved[:, 2] = -change * np.sum(DRAWN[:, :2]**2, axis=1) / (4 * FOCAL**2)
    found = DESIGN.errors(moved)
    assert found.focal_change_m == pytest.approx(change, rel=1e-10) and found.rms_m["rigid_focal"] < 1e-18
    assert 1e-8 < found.rms_m["rigid"] < found.rms_m["design"]
    # Of half of the ray's path it is the error along the normal times the normal's part along the axis.
    weight = DESIGN.normals[:, 2]
    half = DESIGN.errors(moved, "half_path")
    assert half.rms_m["design"] == pytest.approx(np.sqrt(np.mean((moved[:, 2] * weight**2) ** 2)), rel=1e-12)


@pytest.mark.parametrize("term", range(1, 37))
def test_every_zernike_term_returns_its_coefficient(term: int) -> None:
    """A least-squares fit of exact Zernike terms is exact, but for rounding times the condition number of 217 nodes."""
    moved = np.zeros_like(DRAWN)
    moved[:, 2] = 1e-6 * zernike(term, DRAWN[:, :2] / 1.5)
    wanted = np.zeros(36)
    wanted[term - 1] = 1e-6
    np.testing.assert_allclose(DESIGN.zernike_m(moved), wanted, rtol=0, atol=1e-18)


def test_zernike_terms_are_those_of_noll() -> None:
    """Terms are orthonormal over the circle, by Gauss quadrature along the radius; the first terms equal Noll's
    formulas."""
    assert [noll(term) for term in range(1, 12)] == [
        (0, 0), (1, 1), (1, -1), (2, 0), (2, -2), (2, 2), (3, -1), (3, 1), (3, -3), (3, 3), (4, 0)]
    along, weight = np.polynomial.legendre.leggauss(20)
    angle = 2 * np.pi * np.arange(64) / 64
    radius = np.repeat((along + 1) / 2, 64)
    around = np.tile(angle, 20)
    share = np.repeat(weight / 2, 64) * 2 * radius / 64
    terms = np.stack([zernike(term, np.column_stack((radius * np.cos(around), radius * np.sin(around))))
                      for term in range(1, 37)])
    np.testing.assert_allclose((terms * share) @ terms.T, np.eye(36), rtol=0, atol=1e-12)
    at = np.array([[0.6, 0.3]])
    r2 = 0.45
    assert zernike(4, at)[0] == pytest.approx(np.sqrt(3) * (2 * r2 - 1))
    assert zernike(8, at)[0] == pytest.approx(np.sqrt(8) * (3 * r2 - 2) * 0.6)


def test_profile_of_a_planar_truss_is_a_parabola() -> None:
    x = np.linspace(-1, 1, 9)
    flat = np.column_stack((x, x**2 / (4 * FOCAL), 0 * x))
    design = sj.surface.Design.of(flat, (0, 1, 0))
    assert design.profile and design.focal_length_m == pytest.approx(FOCAL, rel=1e-12)
    found = design.errors(turned(flat, np.array([0, 0, 1e-6])))  # anticlockwise: the axis goes to -x
    np.testing.assert_allclose(found.tilt_rad, [-1e-6], rtol=1e-9)
    assert found.rms_m["rigid"] < 1e-17
    with failing("profile_without_zernike"):
        design.zernike_m(np.zeros((9, 3)))


def test_few_nodes_determine_few_terms() -> None:
    few = sj.surface.Design.of(nodes(1), focal_length_m=FOCAL)
    assert len(few.zernike_m(np.zeros((7, 3)))) == 6
    for given, sentence in (
        (lambda: few.zernike_m(np.zeros((7, 3)), 10), failure("zernike_undetermined", count=7, terms=10)),
        (lambda: few.zernike_m(np.zeros((7, 3)), 37), failure("terms_out_of_range", key="terms", value=37, most=36)),
        (lambda: few.errors(np.zeros((6, 3))), failure("array_of_other_shape", key="displacement_m", count=7)),
        (lambda: few.errors(np.zeros((7, 3)), "x"), failure("not_one_of", key="measure", value="x", known="normal, half_path, axial")),
        (lambda: sj.surface.Design.of(nodes(1)[[1]]), failure("nodes_along_axis")),
        (lambda: sj.surface.Design.of(nodes(1), (0, 0, 0)), failure("no_direction", key="axis", value=[0, 0, 0])),
        (lambda: sj.surface.pointing_rad(nodes(1)[:2], nodes(1)[:2], (0, 0, 1)), failure("nodes_on_one_line")),
    ):
        with pytest.raises(StatejumpError) as refused:
            given()
        assert refused.value == sentence


def test_repeatability_is_a_quantile_with_an_honest_interval() -> None:
    """Changes are uniform up to 1 µm over 2 m: their 99 % quantile is 0.495 µm/m. Too few samples give no upper end."""
    drawn = np.random.default_rng(1).uniform(-1e-6, 1e-6, 20000)
    found = sj.surface.repeatability(drawn, 2.0)
    assert found.low < 0.495 < found.high and found.high - found.low < 5e-3
    assert sj.surface.repeatability(drawn[:100], 2.0).high == np.inf
    inside = 0
    for seed in range(200):
        some = sj.surface.repeatability(np.random.default_rng(seed).uniform(0, 1e-6, 2000), 1.0)
        inside += some.low <= 0.99 <= some.high
    assert inside >= 180  # 190 of 200 are expected, sd 3


def test_nodes_without_a_focal_length_are_fitted_by_a_plane() -> None:
    ring = nodes(1)[1:]
    design = sj.surface.Design.of(ring)
    found = design.errors(turned(ring, np.array([0, 1e-6, 0])))
    assert design.focal_length_m is None and found.focal_change_m is None
    np.testing.assert_allclose(found.tilt_rad, [1e-6, 0], rtol=0, atol=1e-15)
    assert found.rms_m["rigid_focal"] < 1e-17


def test_command_of_a_table_of_nodes(statejump: Callable[..., Any], tmp_path: Path) -> None:
    tilt = turned(DRAWN, np.array([0, 2e-6, 0]))
    columns = dict(zip(("x_m", "y_m", "z_m"), DRAWN.T)) | dict(
        zip(("displacement_x_m", "displacement_y_m", "displacement_z_m"), tilt.T))
    write_columns(columns, tmp_path / "nodes.csv")
    done = statejump("truss", "surface", "nodes.csv", "--focal-length", FOCAL, "--zernike", 6)
    assert done.status == 0, done.errors
    assert "axis towards x" in done.output and "2 µrad" in done.output
    rows = (tmp_path / "results" / "nodes" / "surface.csv").read_text().splitlines()
    assert rows[0] == "state,quantity,unit,value" and sum("Zernike" in row for row in rows) == 6
    del columns["z_m"]
    write_columns(columns, tmp_path / "nodes.csv")
    done = statejump("truss", "surface", "nodes.csv")
    assert (done.status, done.failure) == (2, failure("node_column_missing", key="z_m", file="nodes.csv"))


def test_command_of_a_truss(statejump: Callable[..., Any], tmp_path: Path, cases: Path) -> None:
    (tmp_path / "samples.csv").write_text("sample,reflector_rms_of_change_m\n" + "".join(
        f"{i},{i * 1e-8}\n" for i in range(500)))
    done = statejump("truss", "surface", cases / "trusses" / "umbrella_8.toml", "--samples", "samples.csv", "--column",
                     "reflector_rms_of_change_m")
    assert done.status == 0, done.errors
    assert "last cycle" in done.output and "µm/m at 99 % of 500 samples" in done.output
    history = (tmp_path / "results" / "umbrella_8" / "surface_history.csv").read_text().splitlines()
    assert history[0].startswith("time_s,temperature_change_K,rms_design_m,rms_rigid_m,rms_rigid_focal_m,tilt_1_rad")
    for arguments, sentence in (
        ((cases / "trusses" / "chain_10.toml",), failure("reflector_missing")),
        ((cases / "table1.toml",), failure("command_not_for_kind", key="case.kind", value="spring_slider", command="truss surface", kinds="'truss'")),
        ((cases / "trusses" / "umbrella_8.toml", "--focal-length", 1), failure("conflicts_with_case", key="--focal-length")),
        ((cases / "trusses" / "umbrella_8.toml", "--samples", "samples.csv"), failure("samples_and_column", key="--column")),
    ):
        done = statejump("truss", "surface", *arguments)
        assert done.status == 2 and done.failure == sentence, done.errors


def test_best_fit_of_the_surface_is_that_of_the_answers() -> None:
    """Two best fits of a reflector distorted by two changed joints: linear about the reference configuration, and
    nonlinear through the displaced nodes. They differ in second order, displacement over size: 82 µm/41 mm = 2e-3."""
    from statejump.kinds.truss.answers import reflector

    case = sj.load("cases/trusses/umbrella_8.toml").changed({
        "revolute.joint1.friction_coefficient": 0.3, "revolute.joint4.friction_coefficient": 0.01})
    run = case.reduced()
    linear = sj.surface.history(run)
    fit = reflector.surface(case.definition.resolve())
    assert fit is not None
    start, end = (fit.fit(np.asarray(run.history["displacement_m"].values)[place]) for place in (0, -1))
    change = np.sqrt(np.mean((end.residual_m - start.residual_m) ** 2))
    assert change > 1e-6 and linear["rms_rigid_focal_m"][-1] == pytest.approx(change, rel=1e-2, abs=0)
