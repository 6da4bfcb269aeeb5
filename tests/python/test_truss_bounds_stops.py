# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of trusses whose stops, plays and cables change their state: closed forms, states, random histories."""
from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest

import statejump as sj
from statejump.kinds.truss.bounds.sliding import sliding
from statejump.kinds.truss.bounds.stops import Programs, clipped, farthest_branch, hull
from statejump.kinds.truss.bounds.study import bounds
from statejump.kinds.truss.bounds.switching import switching
from statejump.kinds.truss.solve import solve
from test_truss_bounds import FREE_m_per_K, STIFFNESS, chain, heated, lattice


def stopped(*limits_N: float, **stops: float) -> dict[str, Any]:
    made = chain(*limits_N)
    made["slider"][-1] |= stops
    return made


def test_a_stop_cuts_the_rest_states_of_one_bar() -> None:
    limit_N, reach_m = 30.0, 30.0 / STIFFNESS
    found = bounds(sj.load(stopped(limit_N, clearance_plus_m=0.4 * reach_m)), ["node:N1.x"], attain=True)
    bound = found.bounds[0]
    assert (found.letter, found.quality) == ("B", "exact")
    assert bound.spread_m == pytest.approx(1.4 * reach_m, rel=3e-6)
    assert bound.reached_m == pytest.approx(bound.spread_m, rel=3e-6)
    assert bound.jump_m == pytest.approx(reach_m, rel=1e-6)
    assert bound.attained_m == pytest.approx(bound.spread_m, rel=1e-4)


def test_a_soft_stop_reduces_what_friction_can_hold() -> None:
    limit_N, reach_m = 30.0, 30.0 / STIFFNESS
    soft = stopped(limit_N, clearance_plus_m=0.4 * reach_m, stop_stiffness_N_per_m=2 * STIFFNESS)
    found = bounds(sj.load(soft), ["node:N1.x"], simulate=False)
    # k u + 2 k (u − 0.4 f/k) = f
    assert found.bounds[0].spread_m == pytest.approx((1 + 1.8 / 3) * reach_m, rel=3e-6)


def test_a_soft_stop_that_carries_the_load_of_the_equilibrium() -> None:
    limit_N, load_N, reach_m = 30.0, 50.0, 30.0 / STIFFNESS
    loaded = stopped(limit_N, clearance_plus_m=reach_m, stop_stiffness_N_per_m=2 * STIFFNESS)
    loaded["node"][1]["force_N"] = [load_N, 0.0]
    found = bounds(sj.load(loaded), ["node:N1.x"], simulate=False)
    # k u + 2 k (u − f/k) = P ± f where the stop is closed, k u = P − f where it is open.
    closed_m = (load_N + limit_N + 2 * limit_N) / (3 * STIFFNESS)
    assert found.bounds[0].spread_m == pytest.approx(closed_m - (load_N - limit_N) / STIFFNESS, rel=3e-6)


def test_a_stop_that_carries_the_load_of_the_equilibrium() -> None:
    reach_m = 30.0 / STIFFNESS
    loaded = stopped(30.0, clearance_plus_m=0.2 * reach_m)
    loaded["node"][1]["force_N"] = [20.0, 0.0]
    found = bounds(sj.load(loaded), ["node:N1.x"], simulate=False)
    # Without friction, the bar alone would lengthen by 20/k; with it, between (20 − 30)/k and the stop.
    assert found.letter == "B"
    assert found.bounds[0].spread_m == pytest.approx((10 / 30 + 0.2) * reach_m, rel=3e-6)


@pytest.mark.parametrize("free_length_m", [1.5002, 1.4999])
def test_a_cable_that_becomes_slack(free_length_m: float) -> None:
    case = sj.load("chain_cable").to_dict()
    case["spring"][0]["free_length_m"] = free_length_m
    found = bounds(sj.load(case), attain=True)
    assert found.letter == "B"
    for bound in found.bounds:
        assert bound.reached_m >= (1 - 1e-4) * bound.spread_m
        assert 0.99 * bound.spread_m <= bound.attained_m <= bound.spread_m * (1 + 1e-6)


def test_the_play_of_a_latch() -> None:
    case = sj.load("latch_lever").to_dict()
    case["latch_hinge"][0]["deadband_rad"] = 1e-6
    found = bounds(sj.load(case), ["node:B.y"], attain=True)
    bound = found.bounds[0]
    assert (found.letter, found.quality) == ("B", "linear")
    assert bound.attained_m == pytest.approx(bound.spread_m, rel=1e-4)


def random_stops(rng: np.random.Generator) -> dict[str, Any]:
    """A random lattice whose sliders have stops within their reach, and a cable."""
    made = lattice(rng)
    reach_m = 1e-5
    for slider in made.get("slider", []):
        side = str(rng.choice(["plus", "minus"]))
        slider[f"clearance_{side}_m"] = float(10 ** rng.uniform(-1.5, 0.5)) * reach_m
        if rng.random() < 0.3:
            slider["stop_stiffness_N_per_m"] = float(10 ** rng.uniform(5, 7))
    ends = [one["name"] for one in made["node"]]
    first, last = np.array(made["node"][0]["position_m"]), np.array(made["node"][-1]["position_m"])
    made["spring"] = [{"name": "cable", "nodes": [ends[0], ends[-1]], "stiffness_N_per_m": 1e5, "cable": True,
                       "free_length_m": float(np.linalg.norm(last - first)) * (1 + float(rng.uniform(-1, 1)) * 1e-6)}]
    return made


@pytest.mark.parametrize("seed", range(4))
def test_states_obey_their_laws_and_lie_within_the_programs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    at = switching(sliding(sj.load(random_stops(rng))))
    of, box = at.linear, at.box
    friction, force = rng.standard_normal(len(of.limit_N)) / of.limit_N.clip(1e-9), np.zeros(len(of.parts))
    friction[of.limit_N == 0] = 0.0
    force[:] = 0.1 * rng.standard_normal(len(of.parts)) * np.abs(friction).max()
    found = farthest_branch(of, box, friction, force)
    programs = Programs(of, box.lines(of))
    most = -np.inf
    signs = np.array(list(product((-1.0, 1.0), repeat=len(of.limit_N)))) if len(of.limit_N) < 7 else (
        rng.choice([-1.0, 1.0], (64, len(of.limit_N))))
    for share in np.concatenate((signs, rng.uniform(-1, 1, (40, len(of.limit_N))))):
        h = of.state(share * of.limit_N)
        assert h is not None
        z = of.position_m - of.by_friction @ (share * of.limit_N) - of.compliance @ h
        for index, part in enumerate(of.parts):
            line = clipped(part, box.low[index], box.high[index], box.least[index], box.most[index])
            scale = np.where(np.ptp(line, axis=0) > 0, np.ptp(line, axis=0), 1.0)
            rows, right = hull(line)
            assert np.all(rows @ (z[index], h[index]) <= right + 1e-6 * (np.abs(rows) @ scale))
            ways = np.diff(line, axis=0) / scale
            shares = np.clip((((z[index], h[index]) - line[:-1]) / scale * ways).sum(axis=1)
                             / np.maximum((ways**2).sum(axis=1), 1e-300), 0, 1)
            near = np.linalg.norm(((z[index], h[index]) - line[:-1]) / scale - shares[:, None] * ways, axis=1).min()
            assert near < 1e-6
        most = max(most, float(friction @ (share * of.limit_N) + force @ h))
    assert most <= found.bound + 1e-9 * abs(found.bound) and found.reached <= found.bound
    assert found.bound <= programs.solved(friction, force).bound * (1 + 2e-6)
    assert found.reached >= 0.98 * found.bound


@pytest.mark.parametrize("seed", range(5))
def test_no_random_history_leaves_the_bounds(seed: int) -> None:
    rng = np.random.default_rng(10 + seed)
    made, most_K = random_stops(rng), float(10 ** rng.uniform(0.5, 2.3))
    found = bounds(sj.load(made), simulate=False)
    assert found.quality in ("linear", "exact")
    states = np.concatenate([solve(sj.load(heated(made, rng, most_K))).states["displacement_m"][[0, -1]]
                             for _ in range(3)])
    for bound in found.bounds:
        values = bound.output.value(states)
        slack = bound.margin_m + 1e-7 * bound.spread_m
        assert np.ptp(values) <= bound.spread_m + slack
        assert np.abs(values - values[0]).max() <= bound.jump_m + slack
        assert bound.reached_m >= 0.9 * bound.spread_m


@pytest.mark.parametrize("share", [0.99, 1.2, 1.7, 4.0])
def test_range_bounds_of_one_bar_with_a_stop(share: float) -> None:
    limit_N, reach_m = 30.0, 30.0 / STIFFNESS
    first_K = reach_m / FREE_m_per_K  # slip begins
    stop_m = 0.4 * reach_m
    case = stopped(limit_N, clearance_plus_m=stop_m)
    found = bounds(sj.load(case), ["node:N1.x"], range_K=(0.0, share * first_K), simulate=False)
    bound = found.bounds[0]
    assert found.letter == "B" and found.verdict.kind == ("never_slips" if share < 1 else "bounded")
    # The block slips to the stop or to (share − 1) reach. It keeps at most f/k while it cools; it never goes below 0.
    slipped_m = min(max(share - 1, 0.0) * reach_m, stop_m)
    assert bound.range_spread_m == pytest.approx(slipped_m, rel=1e-4, abs=1e-13)


def test_a_range_that_reaches_a_stop_while_hot_uses_programs_with_stops() -> None:
    limit_N, reach_m = 30.0, 30.0 / STIFFNESS
    case = stopped(limit_N, clearance_plus_m=1.5 * reach_m)  # never reached at the reference temperature
    wide = bounds(sj.load(case), ["node:N1.x"], range_K=(0.0, 4 * reach_m / FREE_m_per_K), simulate=False)
    assert wide.letter == "A" and wide.verdict.kind == "bounded"
    assert wide.bounds[0].range_spread_m == pytest.approx(reach_m, rel=1e-4)
    low = bounds(sj.load(case), ["node:N1.x"], range_K=(0.0, 0.4 * reach_m / FREE_m_per_K), simulate=False)
    assert low.verdict.kind == "never_slips" and np.isfinite(low.verdict.factor)


def test_no_peak_is_bounded_where_a_play_closes_while_hot() -> None:
    # The latch of the boom is in its play in all rest states; hot, its spring bends the boom by six times its jump.
    found = bounds(sj.load("trusses/latch_boom").definition, ["node:B.y"], "-60:100", simulate=False).bounds[0]
    assert np.isnan(found.peak_thermal).all() and np.isfinite(found.jump)


@pytest.mark.parametrize("seed", range(4))
def test_no_random_history_leaves_its_range_bounds(seed: int) -> None:
    rng = np.random.default_rng(40 + seed)
    made, most_K = random_stops(rng), float(10 ** rng.uniform(0.3, 1.3))
    found = bounds(sj.load(made), range_K=(-most_K, most_K), simulate=False)
    states = np.concatenate([solve(sj.load(heated(made, rng, most_K))).states["displacement_m"][[0, -1]]
                             for _ in range(3)])
    for bound in found.bounds:
        values = bound.output.value(states)
        slack = bound.margin_m + 1e-7 * bound.spread_m
        if np.isfinite(bound.range_spread_m):
            assert np.ptp(values) <= bound.range_spread_m + slack
            assert np.abs(values - values[0]).max() <= bound.range_jump_m + slack
