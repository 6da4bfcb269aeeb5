# SPDX-License-Identifier: GPL-3.0-or-later
"""Worst temperature histories of trusses: all vertices of a small box, bounds, the case of a history, refusals."""
from __future__ import annotations

import json
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import statejump as sj
from conftest import Outcome
from failures import failing
from statejump.kinds.truss.generate.document import document, finished, node
from statejump.kinds.truss.solve import solve, whole_path
from statejump.kinds.truss.worst.histories import histories
from statejump.kinds.truss.worst.search import INCREMENTS, quick_path

BAR: dict[str, Any] = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-5, "thermal_expansion_per_K": 2e-5,
                       "density_kg_per_m3": 2700.0}
STIFFNESS = 70e9 * 1e-5 / 0.5  # of a bar of 0.5 m
RANGE_K = (-3.0, 5.0)  # the second bar slips, the first one only together with it


def chain(*limits_N: float) -> dict[str, Any]:
    """A row of bars from a wall, each end on a slider."""
    made = document("chain", "Chain", "closed form", 2, 5.0, "triangle", 1, 1.0)
    made["node"] = [node("N0", (0, 0), "xy"), *(node(f"N{i}", (0.5 * i, 0), "y") for i in range(1, len(limits_N) + 1))]
    made["link"] = [{"name": f"L{i}", "nodes": [f"N{i - 1}", f"N{i}"], **BAR} for i in range(1, len(limits_N) + 1)]
    made["slider"] = [{"name": f"S{i}", "nodes": [f"N{i}"], "axis": [1.0, 0.0], "friction_coefficient": 0.5,
                       "normal_force_N": 2 * limit} for i, limit in enumerate(limits_N, 1)]
    return finished(made)


def heated(case: dict[str, Any], corners_K: np.ndarray) -> np.ndarray:
    """Displacements of N2 along x in a history with given corners (corners, links), and a return."""
    table = np.vstack((np.zeros(2), corners_K, np.zeros(2)))
    time = np.arange(len(table), dtype=float).tolist()
    made = case | {"link": [link | {"program": f"P{link['name']}"} for link in case["link"]],
                   "thermal": {"shape": "table", "table_time_s": time, "table_temperature_change_K": [0.0] * len(time)},
                   "program": [{"name": f"P{link['name']}", "shape": "table", "table_time_s": time,
                                "table_temperature_change_K": table[:, number].tolist()}
                               for number, link in enumerate(case["link"])]}
    moved: np.ndarray = solve(sj.load(made)).states["displacement_m"][:, 2, 0]
    return moved - moved[0]


def test_no_vertex_is_worse_than_the_history_found() -> None:
    case = chain(30.0, 50.0)
    found = sj.worst(sj.load(case), RANGE_K, output=["node:N2.x"], cycles=1, paths=30)
    paths = [heated(case, np.array(corners).reshape(2, 2)) for corners in product(RANGE_K, repeat=4)]
    jump, peak = found.worst
    assert jump.quantity == "residual jump" and peak.quantity == "peak"
    vertex = max(abs(path[-1]) for path in paths)
    assert vertex > 0 and jump.found >= vertex * (1 - 1e-6)
    assert peak.found >= max(np.abs(path).max() for path in paths) * (1 - 1e-6)
    assert jump.found <= jump.bound * (1 + 1e-7) and peak.found <= peak.bound * (1 + 1e-7)
    assert jump.found > 1.01 * jump.nominal


def test_wide_range_attains_the_bound_of_any_history() -> None:
    jump = sj.worst(sj.load(chain(30.0, 50.0)), (-60.0, 60.0), output=["node:N2.x"], cycles=2, paths=12).worst[0]
    assert jump.guaranteed == pytest.approx((30.0 + 2 * 50.0) / STIFFNESS, rel=1e-12)
    assert jump.found == pytest.approx(jump.guaranteed, rel=1e-4)
    assert "% of the bound" in jump.verdict


def test_members_of_a_group_share_a_temperature() -> None:
    case = sj.load(chain(30.0, 50.0))
    together = sj.worst(case, RANGE_K, output=["node:N2.x"], groups=["L1,L2"], cycles=1, paths=10).worst[0]
    apart = sj.worst(case, RANGE_K, output=["node:N2.x"], cycles=1, paths=4).worst[0]
    assert together.found < together.bound * (1 + 1e-7) < apart.bound
    items = together.case.to_dict()
    assert items["link"][0]["program"] == items["link"][1]["program"]
    assert len(items["program"]) == 1


def test_histories_stay_within_the_range_and_return() -> None:
    found = sj.worst(sj.load(chain(30.0, 50.0)), RANGE_K, output=["node:N2.x"], cycles=2, paths=8)
    for one in found.worst:
        for program in one.case.to_dict()["program"]:
            table = np.array(program["table_temperature_change_K"])
            assert table[0] == table[-1] == 0 and len(table) % 3 == 1
            assert table.min() >= RANGE_K[0] and table.max() <= RANGE_K[1]


def test_temperature_fractions_do_not_widen_the_range() -> None:
    case = chain(30.0, 50.0)
    case["link"][1]["temperature_fraction"] = 4.0
    made = histories(sj.load(case), *RANGE_K, groups=()).prepared.resolve()
    assert np.allclose(made.links.temperature_fraction, 1.0)


def test_a_truss_with_clearances_has_no_bound_of_peaks() -> None:
    found = sj.worst(sj.load("umbrella_rib"), (-60.0, 100.0), cycles=1, paths=6)
    jump, peak = found.worst
    assert found.facts[0].startswith("class C") and 0 < jump.found <= jump.guaranteed
    assert np.isnan(peak.bound) and "no bound" in peak.verdict and peak.found > 0


def test_reflector_is_an_output() -> None:
    case = sj.load("umbrella_8").to_dict()
    assert "reflector" in case
    jump, peak = sj.worst(sj.load(case), (-6.0, 10.0), output=["tilt"], cycles=1, paths=3).worst
    assert "tilt_rad" not in jump.record() and jump.record()["found_rad"] == jump.found >= 0
    assert peak.found > 0


def test_wrong_input_is_refused() -> None:
    case = sj.load(chain(30.0))
    for range_K, more, code in (("20:80", {}, "bounds_bad_range"), (RANGE_K, {"groups": ["M*"]}, "worst_bad_group"),
                                (RANGE_K, {"output": ["N1"]}, "bounds_bad_output"),
                                (RANGE_K, {"paths": 0}, "out_of_range"), (RANGE_K, {"cycles": 0}, "out_of_range")):
        with failing(code):
            sj.worst(case, range_K, **more)
    cold = chain(30.0)
    cold["link"][0]["thermal_expansion_per_K"] = 0.0
    with failing("worst_without_members"):
        sj.worst(sj.load(cold), RANGE_K)


def test_a_case_of_the_command_repeats_the_number(statejump: Any, tmp_path: Path) -> None:
    done: Outcome = statejump("worst", "latch_boom", "--range", "-80:60", "--output", "node:C.y", "--cycles", "1",
                              "--paths", "12", "--json")
    assert done.status == 0, done
    folder = tmp_path / "results" / "latch_boom_worst"
    record = json.loads((folder / "worst.json").read_text())
    assert record == json.loads(done.output)
    jump, peak = record["worst"]
    moved = solve(sj.load(folder / jump["case"])).states["displacement_m"][:, 2, 1]
    assert abs(moved[-1] - moved[0]) == jump["found_m"] > 0
    moved = solve(sj.load(folder / peak["case"])).states["displacement_m"][:, 2, 1]
    assert np.abs(moved - moved[0]).max() == peak["found_m"]
    assert jump["found_m"] <= jump["guaranteed_m"] * (1 + 1e-7)


def test_command_refuses_in_one_sentence(statejump: Any) -> None:
    done: Outcome = statejump("worst", "chain_10", "--range", "60")
    assert done.status == 2 and done.failure.code == "bounds_bad_range" and "--range" in str(done.failure)
    done = statejump("worst", "table1", "--range", "-1:1")
    assert done.status == 2


def test_histories_in_which_many_joints_change_together_have_a_path() -> None:
    """Ten blocks between members that all go from one end of the range to the other: with given friction limits a path
    always exists. Its end does not depend on located events, but for slip that reverses within one increment."""
    found = histories(sj.load("trusses/chain_10"), -80.0, 60.0, [])
    for seed in range(8):
        rng = np.random.default_rng(seed)
        truss = found.truss(np.where(rng.random((3, 2, len(found.variables))) < 0.5, -80.0, 60.0))
        quick, located = quick_path(truss, INCREMENTS), whole_path(truss, increments_per_branch=INCREMENTS)
        ends = [path.cycle_ends["displacement_m"] for path in (quick, located)]
        assert np.allclose(*ends, rtol=0, atol=0.02 * np.abs(ends[1]).max())
        assert quick.solves < 2 * located.solves
