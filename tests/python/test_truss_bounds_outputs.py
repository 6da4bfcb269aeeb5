# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of vector outputs of trusses: surfaces, nodes in a plane; largest norms over boxes."""
from __future__ import annotations

from copy import deepcopy
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import statejump as sj
from failures import failing
from statejump.kinds.truss.bounds.extremes import farthest, zonogon
from statejump.kinds.truss.bounds.sliding import sliding
from statejump.kinds.truss.bounds.study import bounds
from statejump.kinds.truss.generate.document import document, finished, node
from statejump.surface import pointing_rad
from test_truss_bounds import BAR, chain, heated, lattice


def dish(rng: np.random.Generator, feet: int = 6) -> Any:
    """Nodes of a paraboloid, each held by three bars from feet that slide."""
    made = document("dish", "Dish", "random", 3, 20.0, "triangle", 1, 1.0)
    for index in range(feet):
        angle = 2 * np.pi * index / feet + rng.uniform(-0.1, 0.1)
        place = rng.uniform(0.6, 1.0) * np.array([np.cos(angle), np.sin(angle)])
        made["node"].append(node(f"P{index}", (*place, 0.25 * float(place @ place))))
        for leg in range(3):
            foot = (*(place + 0.3 * np.array([np.cos(2 * leg), np.sin(2 * leg)])), -0.5)
            made["node"] += [node(f"F{index}{leg}", foot, "yz"), node(f"W{index}{leg}", (foot[0] + 1, *foot[1:]), "xyz")]
            made["link"] += [{"name": f"{end}{index}{leg}", "nodes": [f"{end}{index}{leg}" if end == "W" else f"P{index}",
                                                                     f"F{index}{leg}"], **BAR} for end in "PW"]
        made["slider"].append({"name": f"S{index}", "nodes": [f"F{index}0"], "axis": [1.0, 0.0, 0.0],
                               "friction_coefficient": 0.3, "normal_force_N": float(10 ** rng.uniform(1, 2))})
    made["reflector"] = {"nodes": [f"P{index}" for index in range(feet)], "axis": [0.0, 0.0, 1.0]}
    return finished(made)


@pytest.mark.parametrize("rows", [1, 2, 3, 5])
def test_largest_norm_over_a_box_lies_between_its_bounds(rows: int) -> None:
    rng = np.random.default_rng(rows)
    for _ in range(5):
        columns = rng.standard_normal((rows, 9)) * 10 ** rng.uniform(-3, 3, 9)
        every = np.array(list(product((-1.0, 1.0), repeat=9)))
        true = np.linalg.norm(every @ columns.T, axis=1).max()
        found = farthest(columns)
        assert found.reached <= true * (1 + 1e-12) and found.bound >= true * (1 - 1e-12)
        assert np.linalg.norm(columns @ found.sign) == pytest.approx(found.reached, rel=1e-12)
        if rows <= 2:
            assert found.bound == pytest.approx(true, rel=1e-12)
        assert found.bound <= 1.1 * true


def test_corners_of_a_zonogon_are_those_of_all_signs() -> None:
    columns = np.random.default_rng(0).standard_normal((2, 7))
    corners = zonogon(columns)
    assert len(corners) == 14
    every = np.array(list(product((-1.0, 1.0), repeat=7))) @ columns.T
    for angle in np.linspace(0, 2 * np.pi, 50):
        way = np.array([np.cos(angle), np.sin(angle)])
        assert (corners @ way).max() == pytest.approx((every @ way).max(), rel=1e-12)
    angles = np.unwrap(np.arctan2(corners[:, 1], corners[:, 0]))
    assert np.all(np.diff(angles) > 0)


OUTPUTS = ["rms", "rms:design", "rms:rigid", "tilt", "zernike:1", "zernike:3", "point", "point:1,0,0", "node:P0.xy",
           "node:P0.xyz"]


def test_outputs_of_a_surface_are_its_errors() -> None:
    case = sj.load(dish(np.random.default_rng(1)))
    found = bounds(case, OUTPUTS, simulate=False)
    moved = 1e-4 * np.random.default_rng(2).standard_normal((len(found.truss.nodes.names), 3))
    design, nodes = sj.surface.reflector_of(case)
    errors = design.errors(moved[nodes])
    p0 = moved[found.truss.nodes.names.index("P0")]
    expected = [errors.rms_m["rigid_focal"], errors.rms_m["design"], errors.rms_m["rigid"],
                np.linalg.norm(errors.tilt_rad), *np.abs(design.zernike_m(moved[nodes])[[0, 2]]),
                *(pointing_rad(design.position_m, moved[nodes], way) for way in ((0, 0, 1), (1, 0, 0))),
                np.linalg.norm(p0[:2]), np.linalg.norm(p0)]
    for bound, value in zip(found.bounds, expected):
        assert bound.output.change(np.zeros_like(moved), moved) == pytest.approx(value, rel=1e-9), bound.output.name


@pytest.mark.parametrize("seed", range(2))
def test_no_history_leaves_the_bounds_of_a_surface(seed: int) -> None:
    rng = np.random.default_rng(seed)
    made, most_K = dish(rng), 60.0
    found = bounds(sj.load(made), OUTPUTS, range_K=(-most_K, most_K), simulate=False)
    of = sliding(sj.load(made))
    for bound in found.bounds:
        assert bound.reached <= bound.spread <= 1.1 * bound.reached
        assert bound.range_spread <= bound.spread and bound.range_jump <= bound.spread
        # The signs of all joints reach no more than the bound.
        gains = of.gains_of(bound.output.rows(of))[0] * of.limit_N
        every = np.array(list(product((-1.0, 1.0), repeat=gains.shape[1]))) @ gains.T
        most = 2 * np.linalg.norm(every, axis=1).max()
        assert bound.reached <= most * (1 + 1e-9) and most <= bound.spread * (1 + 1e-9)
    states = []
    for _ in range(2):
        path = sj.load(heated(made, rng, most_K)).reduced().native.states["displacement_m"]
        states += [path[0], path[-1]]
    for bound in found.bounds:
        changes = [bound.output.change(one, other) for one in states for other in states]
        assert max(changes) <= bound.range_spread * (1 + 1e-7) + bound.margin
        assert max(bound.output.change(states[0], one) for one in states) <= bound.range_jump * (1 + 1e-7) + bound.margin


def test_a_history_attains_the_tilt_and_the_picture_is_a_zonogon(tmp_path: Path) -> None:
    found = bounds(sj.load(dish(np.random.default_rng(3), 5)), ["tilt", "rms"], attain=True)
    for bound in found.bounds:
        assert bound.attained == pytest.approx(bound.reached, rel=1e-3)
    assert found.bounds[0].spread_rad == found.bounds[0].spread and not hasattr(found.bounds[0], "spread_m")
    assert (tmp_path / "bounds_planetilt.png") in found.write(tmp_path)
    assert {"spread_m", "spread_rad"} <= set((tmp_path / "bounds.csv").read_text().splitlines()[0].split(","))


def test_surfaces_and_their_outputs_are_refused_by_name() -> None:
    with failing("reflector_missing"):
        bounds(sj.load(chain(30.0)), ["rms"], simulate=False)
    case = sj.load(dish(np.random.default_rng(0)))
    for output in ("rms:x", "tilt:1", "zernike:0", "zernike:99", "point:1,0", "point:a", "edge:P0"):
        with failing("bounds_bad_output"):
            bounds(case, [output], simulate=False)


@pytest.mark.parametrize("output", ["node:N20.y", "node:N21.xy"])
def test_gradients_are_those_of_differences(output: str) -> None:
    case = lattice(np.random.default_rng(3))
    for one in case["node"]:
        one.pop("force_N", None)  # forces would change the equilibrium and its geometric stiffness
    found = bounds(sj.load(case), [output], simulate=False)
    bound, record = found.bounds[0], found.record()
    step = 1e-4
    for number, link in enumerate(case["link"][:4]):
        spreads = []
        for factor in (1 + step, 1 - step):
            changed = deepcopy(case)
            changed["link"][number]["cross_section_area_m2"] *= factor
            spreads.append(bounds(sj.load(changed), [output], simulate=False).bounds[0].spread_m)
        slope = (spreads[0] - spreads[1]) / (2 * step)
        assert bound.by_stiffness[number] == pytest.approx(slope, rel=1e-4, abs=1e-6 * bound.spread_m)
        assert record["elements"][number]["element"] == f"link '{link['name']}'"
    weaker = deepcopy(case)
    weaker["slider"][0]["friction_coefficient"] *= 1 - step
    drop = bound.spread_m - bounds(sj.load(weaker), [output], simulate=False).bounds[0].spread_m
    limit = record["joints"][0]["friction_limit_N"]
    assert record["joints"][0]["spread_by_limit"][output] * limit * step == pytest.approx(drop, rel=1e-3)
