# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of the state jump of trusses: closed forms, attained histories, random trusses under random histories."""
from __future__ import annotations

import json
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import statejump as sj
from conftest import Outcome
from failures import failing
from statejump.kinds.truss.bounds import history, programs
from statejump.kinds.truss.bounds.margin import margin
from statejump.kinds.truss.bounds.programs import Polytope
from statejump.kinds.truss.bounds.sliding import sliding
from statejump.kinds.truss.bounds.study import bounds
from statejump.kinds.truss.generate.document import document, finished, node
from statejump.kinds.truss.solve import solve

BAR: dict[str, Any] = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-5, "thermal_expansion_per_K": 2e-5,
                       "density_kg_per_m3": 2700.0}
STIFFNESS, FREE_m_per_K = 70e9 * 1e-5 / 0.5, 2e-5 * 0.5  # of a bar of 0.5 m
SHIPPED_um = {"chain_10": 3217.5, "iwan_10": 936.0, "latch_boom": 13.7142857, "latch_lever": 6.85714286,
              "telescope": 342.857143, "chain_cable": 952.380952, "bolted_tubes": 342.857143}


def chain(*limits_N: float, change_K: float = 100.0, **more: Any) -> dict[str, Any]:
    """A row of bars from a wall, each end on a slider."""
    made = document("chain", "Chain", "closed form", 2, change_K, "triangle", 1, 1.0)
    made["node"] = [node("N0", (0, 0), "xy"), *(node(f"N{i}", (0.5 * i, 0), "y") for i in range(1, len(limits_N) + 1))]
    made["link"] = [{"name": f"L{i}", "nodes": [f"N{i - 1}", f"N{i}"], **BAR} for i in range(1, len(limits_N) + 1)]
    made["slider"] = [{"name": f"S{i}", "nodes": [f"N{i}"], "axis": [1.0, 0.0], "friction_coefficient": 0.5,
                       "normal_force_N": 2 * limit} for i, limit in enumerate(limits_N, 1)]
    return finished(made | more)


def one(case: Any, output: str, **settings: Any) -> Any:
    return bounds(sj.load(case), [output], **settings).bounds[0]


def test_spread_of_two_blocks_is_that_of_their_friction() -> None:
    found = one(chain(30.0, 50.0), "node:N2.x")
    # A force at N2 stretches both bars, one at N1 only the first.
    assert found.spread_m == pytest.approx(2 * (30.0 + 2 * 50.0) / STIFFNESS, rel=1e-12)
    assert found.fraction == pytest.approx([30 / 130, 100 / 130], rel=1e-12)
    assert found.jump_m == pytest.approx(found.spread_m / 2, rel=1e-12)
    assert found.margin_m == 0.0 and found.simulated_m <= found.jump_m * (1 + 1e-9)


def test_a_loaded_start_is_not_the_centre() -> None:
    loaded = chain(30.0)
    loaded["node"][1]["force_N"] = [20.0, 0.0]
    found = one(loaded, "node:N1.x")
    assert found.jump_m == pytest.approx((30.0 + 20.0) / STIFFNESS, rel=1e-9)
    free = one(loaded | {"start": {"friction": "frictionless"}}, "node:N1.x")
    assert free.jump_m == pytest.approx(30.0 / STIFFNESS, rel=1e-9)


@pytest.mark.parametrize("name", SHIPPED_um)
def test_shipped_cases_reach_their_bound(name: str) -> None:
    found = bounds(sj.load(name), attain=True, simulate=False)
    assert found.quality == ("linear" if name.startswith("latch") else "exact")
    assert found.bounds[0].spread_m == pytest.approx(1e-6 * SHIPPED_um[name], rel=1e-6)
    for bound in found.bounds:
        assert bound.attained_m == pytest.approx(bound.spread_m, rel=1e-4)


def test_histories_of_single_slides_hold_at_the_lengths_of_hot_links(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(history, "LEAST", ())  # no larger temperatures
    for name in ("chain_cable", "telescope"):
        bound = bounds(sj.load(name), attain=True, simulate=False).bounds[0]
        assert bound.attained_m == pytest.approx(bound.spread_m, rel=1e-6)


@pytest.mark.parametrize("sticking", ["elastic", "partial_slip"])
def test_sticking_stiffness_does_not_change_the_bound(sticking: str) -> None:
    found = one(chain(30.0, 50.0, reduced={"sticking": sticking}), "node:N2.x", attain=True)
    assert found.spread_m == pytest.approx(2 * 130.0 / STIFFNESS, rel=1e-12)
    assert found.attained_m == pytest.approx(found.spread_m, rel=1e-4)


def test_an_iwan_joint_reaches_its_slip_force() -> None:
    made = chain(1.0)
    del made["slider"]
    made["iwan_joint"] = [{"name": "I", "nodes": ["N1"], "axis": [1.0, 0.0], "tangent_stiffness_N_per_m": 1e7,
                           "slip_force_N": 40.0, "exponent": -0.5, "stiffness_ratio": 0.1}]
    found = bounds(sj.load(made), ["node:N1.x"], attain=True)
    assert found.verdict.kind == "repeats"
    assert found.bounds[0].spread_m == pytest.approx(80.0 / STIFFNESS, rel=1e-12)
    assert found.bounds[0].attained_m == pytest.approx(80.0 / STIFFNESS, rel=1e-4)


# One bar on a slider begins to slip where k α L ΔT = f, and in each direction of every cycle where it is 2 f.
LIMIT_N = 20.0
FIRST_K = LIMIT_N / (STIFFNESS * FREE_m_per_K)


@pytest.mark.parametrize("share, kind, slips", [(0.99, "never_slips", False), (1.5, "settles", True),
                                                (2.5, "repeats", True)])
def test_verdict_of_one_bar(share: float, kind: str, slips: bool) -> None:
    found = bounds(sj.load(chain(LIMIT_N)), ["node:N1.x"], range_K=(0.0, 1e-9 + share * FIRST_K))
    assert found.verdict.kind == kind and found.verdict.slips is not None and found.verdict.slips[0] == slips
    assert found.verdict.factor == pytest.approx(2 / share, rel=1e-6)
    assert found.verdict.limiting == "slider 'S1'"
    # It slips by α L ΔT − f/k, and keeps this until it slips back.
    slipped = max(0.0, min(share, 2.0) * FREE_m_per_K * FIRST_K - LIMIT_N / STIFFNESS)
    assert found.bounds[0].range_jump_m == pytest.approx(slipped, rel=1e-4, abs=1e-15)


def test_peak_has_a_thermal_and_a_friction_part() -> None:
    found = one(chain(30.0, 50.0), "node:N2.x", range_K=(-80.0, 60.0))
    assert found.peak_thermal_m == pytest.approx((-160.0 * FREE_m_per_K, 120.0 * FREE_m_per_K), rel=1e-9)


def test_bounds_of_programs_do_not_depend_on_the_solver(monkeypatch: pytest.MonkeyPatch) -> None:
    polytope = Polytope(np.array([[1.0, 1.0]]), np.array([-np.inf]), np.array([1.0]), np.zeros(2), np.ones(2))
    assert polytope.highest_value(np.array([2.0, 1.0])) == pytest.approx(2.0, abs=1e-12)

    class Wrong:
        status = 0
        x = np.zeros(2)

        class ineqlin:
            marginals = -np.array([0.25])

    monkeypatch.setattr(programs, "linprog", lambda *arguments, **settings: Wrong)
    assert polytope.highest_value(np.array([2.0, 1.0])) >= 2.0


def lattice(rng: np.random.Generator) -> dict[str, Any]:
    """A random truss of triangles with sliders and a latch hinge."""
    bays = int(rng.integers(2, 4))
    made = document("lattice", "Lattice", "random", 2, 1.0, "triangle", 1, 1.0,
                    str(rng.choice(["rigid", "elastic", "partial_slip"])))
    for i in range(bays + 1):
        for j in range(2):
            place = np.array([i, 0.8 * j]) + rng.uniform(-0.1, 0.1, 2)
            made["node"].append(node(f"N{i}{j}", place, "xy" if i == 0 else "", force_N=rng.uniform(-5, 5, 2).tolist()))
    for i in range(1, bays + 1):
        for ends in ((f"N{i - 1}0", f"N{i}0"), (f"N{i - 1}1", f"N{i}1"), (f"N{i - 1}0", f"N{i}1"), (f"N{i}0", f"N{i}1")):
            made["link"].append({"name": "_".join(ends), "nodes": list(ends), **BAR,
                                 "cross_section_area_m2": float(10 ** rng.uniform(-5.3, -4))})
    for number in rng.choice(np.arange(2, 2 * bays + 2), 2, replace=False):
        angle = rng.uniform(0, 2 * np.pi)
        made["node"][number]["guide_normal"] = [-np.sin(angle), np.cos(angle)]
        made["slider"].append({"name": f"S{number}", "nodes": [made["node"][number]["name"]], "normal_force_N": 500.0,
                               "axis": [np.cos(angle), np.sin(angle)], "friction_coefficient": rng.uniform(0.1, 0.9)})
    made["latch_hinge"] = [{"name": "latch", "links": [made["link"][0]["name"]], "deadband_rad": 0.02,
                            "stiffness_N_m_per_rad": 100.0, "friction_moment_N_m": rng.uniform(1, 30)}]
    return finished(made)


def heated(case: dict[str, Any], rng: np.random.Generator, most_K: float) -> dict[str, Any]:
    """The case with random temperatures of each link."""
    made, time = deepcopy(case), np.linspace(0, 1, 6).tolist()
    made["thermal"] = {"shape": "table", "table_time_s": time, "table_temperature_change_K": [0.0] * 6}
    made["program"] = []
    for number, link in enumerate(made["link"]):
        link["program"] = f"P{number}"
        changes = [0.0, *rng.uniform(-most_K, most_K, 4), 0.0]
        made["program"].append({"name": f"P{number}", "shape": "table", "table_time_s": time,
                                "table_temperature_change_K": changes})
    return made


@pytest.mark.parametrize("seed", range(8))
def test_no_random_history_leaves_the_bounds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    case, most_K = lattice(rng), float(10 ** rng.uniform(0.5, 2.3))
    found = bounds(sj.load(case), range_K=(-most_K, most_K), simulate=False)
    assert found.quality == "linear"
    states = [solve(sj.load(heated(case, rng, most_K))).states["displacement_m"][[0, -1]] for _ in range(3)]
    for bound in found.bounds:
        values = bound.output.value(np.concatenate(states))
        slack = bound.margin_m + 1e-7 * bound.spread_m
        assert np.ptp(values) <= bound.spread_m + slack
        assert np.abs(values - values[0]).max() <= bound.jump_m + slack
        if np.isfinite(bound.range_spread_m):
            assert np.ptp(values) <= bound.range_spread_m + slack
            assert np.abs(values - values[0]).max() <= bound.range_jump_m + slack


@pytest.mark.parametrize("seed", range(3))
def test_no_random_history_of_a_tripod_leaves_the_bounds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    made = document("tripod", "Tripod", "random", 3, 1.0, "triangle", 1, 1.0)
    made["node"] = [node("A", rng.uniform(-0.2, 0.2, 3) + [0, 0, 1])]
    for foot in range(3):
        place = np.array([np.cos(2 * foot), np.sin(2 * foot), 0.0])
        made["node"] += [node(f"F{foot}", place, "yz"), node(f"W{foot}", place + [1, 0, 0], "xyz")]
        made["link"] += [{"name": f"{one}{foot}", "nodes": [one if one == "A" else f"W{foot}", f"F{foot}"], **BAR}
                         for one in "AW"]
        made["slider"].append({"name": f"S{foot}", "nodes": [f"F{foot}"], "axis": [1.0, 0.0, 0.0],
                               "friction_coefficient": 0.3, "normal_force_N": 10 ** rng.uniform(2, 3.3)})
    case = finished(made)
    found = bounds(sj.load(case), simulate=False)
    assert found.quality == "linear"
    states = [solve(sj.load(heated(case, rng, 100.0))).states["displacement_m"][[0, -1]] for _ in range(3)]
    for bound in found.bounds:
        assert np.ptp(bound.output.value(np.concatenate(states))) <= bound.spread_m * (1 + 1e-7) + bound.margin_m


def test_margin_covers_a_lever_that_turns_far() -> None:
    # The friction moment at the free end of a lever, held by a soft strut, turns it by 0.02.
    case = sj.load("latch_lever").to_dict()
    case["latch_hinge"][0] |= {"friction_moment_N_m": 200.0, "deadband_rad": 0.05}
    case["link"][1]["cross_section_area_m2"] = 2e-7
    found = bounds(sj.load(case), ["node:B.y"], attain=True, simulate=False)
    bound = found.bounds[0]
    assert found.quality == "linear" and bound.margin_m > 1e-3 * bound.spread_m
    assert 0 < abs(bound.attained_m - bound.spread_m) <= bound.margin_m


def test_margin_covers_a_torsion_spring_that_turns_far() -> None:
    case = sj.load("latch_lever").to_dict()
    case["latch_hinge"][0] |= {"friction_moment_N_m": 200.0, "deadband_rad": 0.05}
    case["link"][1]["cross_section_area_m2"] = 2e-7
    case["torsion_spring"] = [{"name": "T", "links": [link["name"] for link in case["link"][:2]],
                               "stiffness_N_m_per_rad": 5e3, "bias_rad": 0.01}]
    found = bounds(sj.load(case), ["node:B.y"], attain=True, simulate=False)
    bound = found.bounds[0]
    assert found.quality == "linear" and bound.margin_m > 1e-4 * bound.spread_m
    assert 0 < abs(bound.attained_m - bound.spread_m) <= bound.margin_m


def test_margin_of_one_turned_bar_bounds_its_exact_force() -> None:
    case = sj.load("latch_lever").to_dict()
    case["latch_hinge"][0] |= {"friction_moment_N_m": 3000.0, "deadband_rad": 0.05}
    of = sliding(sj.load(case))
    found = margin(of)
    # The lever AB, 0.5 m long, is pulled across by at most the range of B.y and stretched by that of B.x.
    e, w = (float(np.abs(of.of_nodes[3 + axis] @ of.by_friction) @ of.limit_N) for axis in (0, 1))
    stiffness = 70e9 * 1e-5 / 0.5
    assert w > 1e-3 and found.quality == "linear"
    for along in (-e, 0.0, e):
        longer = np.hypot(0.5 + along, w) - 0.5
        force = stiffness * longer / (0.5 + longer) * np.array([0.5 + along, w])
        assert abs(force[0] - stiffness * along) <= found.defect_N[0] <= 1.2 * stiffness * w**2 / (2 * 0.5)
        assert abs(force[1]) <= found.defect_N[2]


REFUSED = {
    "clearance": ("ball_tripod", {}, "bounds_of_clearance"),
    "no friction": ("telescope", {"friction_coefficient": 0.0}, "bounds_without_friction"),
}


@pytest.mark.parametrize("which", REFUSED)
def test_trusses_without_bounds_are_refused(which: str) -> None:
    name, changes, code = REFUSED[which]
    case = sj.load(name).to_dict()
    for slider in case.get("slider", []):
        slider.update(changes)
    with failing(code):
        bounds(sj.load(case), simulate=False)


def test_a_pad_is_refused_by_its_friction_limit() -> None:
    case = chain(30.0)
    del case["slider"]
    case["node"][1].pop("fixed", None)
    case["node"][1]["force_N"] = [0.0, -50.0]
    case["pad"] = [{"name": "P", "nodes": ["N1"], "normal": [0.0, 1.0], "normal_stiffness_N_per_m": 1e7,
                    "friction_coefficient": 0.3}]
    with failing("bounds_of_pad", joint_with_clearance="pad 'P'"):
        bounds(sj.load(case), simulate=False)


def test_a_motion_that_nothing_holds_is_named() -> None:
    loose = chain(30.0)
    loose["node"].append(node("M", (1.0, 0.0), "y"))
    loose["slider"].append(loose["slider"][0] | {"name": "S2", "nodes": ["M"], "normal_force_N": 0.0})
    with failing("bounds_of_mechanism", nodes=("M",), mode="M (x)"):
        bounds(sj.load(loose), simulate=False)


def test_a_truss_that_only_friction_keeps_from_buckling_is_refused() -> None:
    made = document("strut", "Strut", "closed form", 2, 1.0, "triangle", 1, 1.0)
    made["node"] = [node("A", (0, 0), "xy"), node("B", (0.5, 0), "x"), node("C", (1, 0), "xy")]
    made["link"] = [{"name": f"L{ends}", "nodes": list(ends), **BAR, "stress_free_length_m": 0.5005}
                    for ends in ("AB", "BC")]
    made["slider"] = [{"name": "S", "nodes": ["B"], "axis": [0.0, 1.0], "friction_coefficient": 0.5,
                       "normal_force_N": 20.0}]
    force_N = 70e9 * 1e-5 * (0.5 / 0.5005 - 1)  # in each bar, of negative stiffness 2 N/L across
    for share, stable in ((0.99, False), (1.01, True)):
        made["spring"] = [{"name": "Y", "nodes": ["B", "D"], "stiffness_N_per_m": -share * 2 * force_N / 0.5}]
        with_spring = finished(made | {"node": [*made["node"], node("D", (0.5, 1), "xy")]})
        if stable:
            assert bounds(sj.load(with_spring), ["node:B.y"], simulate=False).bounds[0].spread_m > 0
        else:
            with failing("bounds_of_unstable"):
                bounds(sj.load(with_spring), simulate=False)


def test_wrong_outputs_and_ranges_are_refused() -> None:
    case = sj.load(chain(30.0))
    for output in ("N1", "node:N1.y"):
        with failing("bounds_bad_output"):
            bounds(case, [output])
    for range_K in ("20:80", "60", "-80:inf", (0.0, 0.0)):
        with failing("bounds_bad_range"):
            bounds(case, range_K=range_K)


def test_a_large_chain_takes_one_factorisation() -> None:
    found = bounds(sj.load(chain(*[1.0] * 2000)), ["node:N2000.x"])
    assert found.quality == "exact" and np.isnan(found.bounds[0].simulated_m)
    assert found.bounds[0].spread_m == pytest.approx(2 * 2000 * 2001 / 2 / STIFFNESS, rel=1e-9)


def test_command_writes_a_case_that_attains_the_bound(statejump: Any, tmp_path: Path) -> None:
    done: Outcome = statejump("bounds", "latch_boom", "--output", "node:B.y", "--range", "-80:60", "--attain", "--json")
    assert done.status == 0, done
    folder = tmp_path / "results" / "latch_boom_bounds"
    record = json.loads((folder / "bounds.json").read_text())
    assert record == json.loads(done.output) and record["class"] == "A"
    path = solve(sj.load(folder / "latch_boom_attains_B_y.toml")).states
    middle = int(np.abs(path["time_s"] - path["time_s"][-1] / 2).argmin())
    reached = path["displacement_m"][middle, 1, 1] - path["displacement_m"][-1, 1, 1]
    assert reached == pytest.approx(record["bounds"][0]["spread_m"], rel=1e-4)
    for name in ("bounds.png", "bounds_over_range.png", "bounds_joints.png"):
        assert (folder / name).stat().st_size > 1000


def test_command_refuses_in_one_sentence(statejump: Any) -> None:
    done: Outcome = statejump("bounds", "ball_tripod")
    assert done.status == 2 and done.failure.code == "bounds_of_clearance"
