# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of trusses with clearance revolutes: shipped cases, exact rest states, random histories."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import statejump as sj
from failures import failing
from statejump.kinds.truss.bounds.clearance import Clearances, clearances
from statejump.kinds.truss.bounds.contact_states import farthest_state
from statejump.kinds.truss.bounds.contacts import contacts
from statejump.kinds.truss.bounds.sectors import first, forces, highest, propagated
from statejump.kinds.truss.bounds.simulated import repeated
from statejump.kinds.truss.bounds.study import bounds
from statejump.kinds.truss.solve import solve
from test_truss_bounds import heated

# Output; bound and reached spread [µm] of an independent computation.
SHIPPED_um = {"umbrella_rib": ("node:J.y", 22.86, 22.55), "umbrella_8": ("node:J1.y", 23.98, 23.65),
              "ring_12": ("node:J6.y", 4.01, 3.72), "mast_6": ("node:R6.y", 122.1, 101.0)}


@pytest.mark.parametrize("name", SHIPPED_um)
def test_shipped_cases_are_bounded_tightly(name: str) -> None:
    output, most, least = SHIPPED_um[name]
    found = bounds(sj.load(name), [output])
    bound = found.bounds[0]
    assert found.letter == "C" and found.quality == "linear" and not found.verdict.certified
    assert found.verdict.kind == "repeats" and "not certified" in found.verdict.text
    assert 1e-6 * least <= bound.reached_m <= bound.spread_m <= bound.spread_m + bound.margin_m <= 1e-6 * most
    assert bound.simulated_m <= bound.jump_m <= bound.spread_m
    assert "all contacts of revolutes stay closed in all rest states" in found.facts


def rest_state_is_exact(of: Clearances, state: np.ndarray) -> None:
    """Check the laws of all contacts in a state."""
    count = of.count
    d, f = state[:2 * count].reshape(-1, 2), state[2 * count:3 * count]
    size = np.linalg.norm(d, axis=1)
    n = d / size[:, None]
    q = of.forces(state)
    normal = -(q * n).sum(axis=1)
    assert np.all(normal > 0)
    assert size == pytest.approx(of.clearance_m + (normal / of.hertz_N_per_m15) ** (2 / 3), rel=1e-9)
    moment = d[:, 0] * q[:, 1] - d[:, 1] * q[:, 0]
    assert moment == pytest.approx(size * f, rel=1e-7, abs=1e-9 * np.abs(f).max() * size.max())
    assert np.all(np.abs(f) <= np.tan(of.friction_angle_rad) * normal * (1 + 1e-9))


@pytest.mark.parametrize("name", ["umbrella_rib", "ring_12"])
def test_rest_states_are_exact_and_within_all_ranges(name: str) -> None:
    of = clearances(sj.load(name))
    at, programs = propagated(of), contacts(of).wide
    seen = forces(of, at)
    rng = np.random.default_rng(0)
    for _ in range(4):
        places = of.of_nodes[:3 * len(of.truss.nodes.names)]
        row = rng.standard_normal(places.shape[0]) @ places @ of.by_state
        found = farthest_state(of, row)
        assert found is not None
        rest_state_is_exact(of, found.state)
        for sectors in (first(of), at):
            assert row @ found.state <= highest(of, sectors, row)
        wide = np.concatenate((row, np.zeros(len(programs.of.limit_N) - len(of.limit_N))))
        assert row @ found.state <= programs.of_state(wide)
        size = np.linalg.norm(of.forces(found.state), axis=1)
        assert np.all(size <= seen.most_N * (1 + 1e-9)) and np.all(size >= seen.least_N * (1 - 1e-9))
        turned = found.angle_rad - at.middle_rad
        assert np.all(np.abs((turned + np.pi) % (2 * np.pi) - np.pi) <= at.half_rad * (1 + 1e-9))


@pytest.mark.parametrize("name, most_K, histories", [("umbrella_rib", 400.0, 8), ("ring_12", 60.0, 1)])
def test_no_random_history_leaves_the_bounds(name: str, most_K: float, histories: int) -> None:
    case = sj.load(name).to_dict()
    found = bounds(sj.load(name), simulate=False)
    rng = np.random.default_rng(0)
    states = np.concatenate([solve(sj.load(heated(case, rng, most_K))).states["displacement_m"][[0, -1]]
                             for _ in range(histories)])
    for bound in found.bounds:
        values = bound.output.value(states)
        assert np.ptp(values) <= bound.spread_m + bound.margin_m
        assert np.abs(values - values[0]).max() <= bound.jump_m + bound.margin_m


def test_pictures_show_sectors_and_contributions(tmp_path: Path) -> None:
    found = bounds(sj.load("mast_6"), ["node:R6.y"], simulate=False)
    written = {path.name for path in found.write(tmp_path)}
    assert {"bounds.png", "bounds_joints.png", "bounds_sectors.png", "bounds.json"} <= written


def test_a_history_attains_the_bound_of_the_rib() -> None:
    found = bounds(sj.load("umbrella_rib"), ["node:J.y"], attain=True, simulate=False)
    bound = found.bounds[0]
    assert bound.attained_m == pytest.approx(bound.spread_m, rel=1e-3)
    assert bound.attained_m <= bound.spread_m + bound.margin_m


def heated_to(change_K: float) -> Any:
    case = sj.load("umbrella_rib").to_dict()
    case["thermal"]["temperature_change_max_K"] = change_K
    return sj.load(case)


@pytest.mark.parametrize("share, rubs", [(0.85, False), (1.15, True)])
def test_the_factor_of_a_rib_agrees_with_its_simulation(share: float, rubs: bool) -> None:
    # The linear factor differs from that of exact contacts by up to 14 %.
    factor = 100.0 * bounds(heated_to(100.0), ["node:J.y"], simulate=False).verdict.factor
    case = heated_to(share * factor)
    found = bounds(case, ["node:J.y"], simulate=False).verdict
    assert not found.certified and (found.kind == "repeats") == rubs
    seen = repeated(case)
    assert seen is not None and seen.rubs == rubs and not seen.drifts


def test_a_rib_that_is_hardly_heated_is_estimated_never_to_slip() -> None:
    found = bounds(heated_to(20.0), ["node:J.y"], simulate=False)
    assert found.verdict.kind == "never_slips" and not found.verdict.certified and found.verdict.factor > 1
    assert not found.record()["verdict"]["certified"]
    assert found.bounds[0].range_spread_m == found.bounds[0].spread_m  # an estimate does not narrow a bound


def changed(name: str, **values: Any) -> Any:
    case = sj.load(name).to_dict()
    for joint in case["revolute"]:
        joint.update(values)
    return sj.load(case)


def test_without_friction_there_is_one_rest_state() -> None:
    found = bounds(changed("umbrella_rib", friction_coefficient=0.0), ["node:J.y"], simulate=False)
    assert found.bounds[0].spread_m < 1e-9


def test_trusses_without_bounds_are_refused() -> None:
    with failing("bounds_of_amplified_friction"):
        bounds(changed("umbrella_rib", friction_coefficient=10.0, journal_radius_m=0.1), simulate=False)
