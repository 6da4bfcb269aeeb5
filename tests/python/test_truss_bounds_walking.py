# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses with motions that friction alone holds: factor to the limit, drift per cycle, mechanism."""
from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import statejump as sj
from conftest import Outcome
from statejump.kinds.truss.bounds.study import bounds
from statejump.kinds.truss.generate.document import document, finished, node
from test_truss_bounds import BAR, FREE_m_per_K, STIFFNESS, chain


def blocks(limits_N: tuple[float, ...], loads_N: tuple[float, ...], change_K: float) -> dict[str, Any]:
    """A row of blocks with bars between them, on a slope without end."""
    made = document("blocks", "Blocks", "closed form", 2, change_K, "triangle", 1, 1.0)
    made["node"] = [node(f"N{i}", (0.5 * i, 0), "y") | {"force_N": [load, 0.0]} for i, load in enumerate(loads_N)]
    made["link"] = [{"name": f"L{i}", "nodes": [f"N{i - 1}", f"N{i}"], **BAR} for i in range(1, len(loads_N))]
    made["slider"] = [{"name": f"S{i}", "nodes": [f"N{i}"], "axis": [1.0, 0.0], "friction_coefficient": 0.5,
                       "normal_force_N": 2 * limit} for i, limit in enumerate(limits_N)]
    return finished(made)


FORCE_N_per_K = STIFFNESS * FREE_m_per_K


@pytest.mark.parametrize("load_N, share", [(5.0, 0.8), (5.0, 1.3), (15.0, 3.0), (1.0, 0.9)])
def test_slope_ratchet_has_the_factor_and_the_drift_of_its_closed_form(load_N: float, share: float) -> None:
    limit_N = 20.0
    change_K = share * 2 * (limit_N - load_N) / FORCE_N_per_K
    found = bounds(sj.load(blocks((limit_N, limit_N), (load_N, load_N), change_K)), ["node:N1.x"])
    assert found.verdict.factor == pytest.approx(1 / share, rel=1e-6)
    assert np.isinf(found.bounds[0].spread)
    if share < 1:
        assert found.verdict.kind == "settles"
        return
    assert found.verdict.kind == "may_ratchet" and "N0 (x)" in found.verdict.mechanism
    # One block slides down while the bar heats, the other one while it cools.
    drift_m = FREE_m_per_K * change_K - 2 * (limit_N - load_N) / STIFFNESS
    assert found.verdict.drift_m == pytest.approx(drift_m, rel=1e-4)


def test_three_blocks_walk_at_the_factor_of_their_program() -> None:
    # Two of three equal blocks slip at once: the middle one with each of its neighbours in turn, or with neither.
    limit_N, load_N = 20.0, 8.0
    for share in (0.9, 1.1):
        change_K = share * 2 * (limit_N - load_N) / FORCE_N_per_K
        found = bounds(sj.load(blocks((limit_N,) * 3, (load_N,) * 3, change_K)), ["node:N1.x"])
        eta = found.verdict.factor
        path = sj.load(blocks((limit_N,) * 3, (load_N,) * 3, change_K) | {
            "thermal": {"shape": "triangle", "temperature_change_max_K": change_K, "cycles": 8, "period_s": 1.0}})
        states = path.reduced().native.states
        last = int(np.abs(states["time_s"] - 7.0).argmin())
        drift = np.abs(states["displacement_m"][-1] - states["displacement_m"][last]).max()
        assert (eta < 1) == (drift > 1e-9), (eta, drift)


def test_blocks_on_a_plane_settle_in_shape_and_do_not_certify_alternating_slip() -> None:
    limit_N = 20.0
    # Without a load, the weaker block slips to and fro: η = 2 f/(k α L ΔT).
    found = bounds(sj.load(blocks((limit_N, 3 * limit_N), (0.0, 0.0), 3 * limit_N / FORCE_N_per_K)), ["node:N1.x"])
    assert found.verdict.factor == pytest.approx(2 / 3, rel=1e-6)
    assert found.verdict.kind == "may_ratchet" and found.verdict.limiting == "slider 'S0'"
    assert found.verdict.drift_m < 1e-9 and "alternating" in found.verdict.text


def test_a_motion_that_friction_holds_is_bounded_if_no_mechanism_moves_it() -> None:
    loose = chain(30.0)
    loose["node"].append(node("M", (1.0, 0.0), "y"))
    loose["slider"].append(loose["slider"][0] | {"name": "S2", "nodes": ["M"]})
    found = bounds(sj.load(loose), ["node:N1.x", "node:M.x"])
    assert found.bounds[0].spread_m == pytest.approx(2 * 30.0 / STIFFNESS, rel=1e-9)
    assert np.isinf(found.bounds[1].spread_m)


def test_command_names_the_mechanism(statejump: Any, tmp_path: Path) -> None:
    case = blocks((20.0, 20.0), (5.0, 5.0), 2.6 * 15.0 / FORCE_N_per_K)
    sj.load(case).save(tmp_path / "blocks.toml")
    done: Outcome = statejump("bounds", str(tmp_path / "blocks.toml"), "--json")
    assert done.status == 0, done
    record = json.loads(done.output)
    assert record["verdict"]["kind"] == "may_ratchet" and record["verdict"]["mechanism"]
    assert record["bounds"][0]["unbounded"] and record["bounds"][0]["spread_m"] is None
