# SPDX-License-Identifier: GPL-3.0-or-later
"""A comparison leaves out nodes of elements that are slack in the play of their pins, and no other nodes."""
from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from failures import note
from statejump.core.run import Run
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import compare, result, slack, solve

BAR = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 2e-5, "thermal_expansion_per_K": 2.3e-5, "density_kg_per_m3": 2700.0}
PLAY_M = 3e-4


def post(change_K: float, **truss: Any) -> dict[str, Any]:
    """Two legs hold a tip. A post to the tip has play at both ends; when heated, it grows by 19 um/K less than the tip
    rises."""
    places = {"A": [0.0, 0.0], "B": [2.0, 0.0], "tip": [1.0, 1.2], "foot": [1.0, 0.0], "low": [1.0, 0.0], "high": [1.0, 1.2]}
    nodes = [{"name": name, "position_m": place} | ({"fixed": ["x", "y"]} if name in ("A", "B", "foot") else {})
             for name, place in places.items()]
    links = [{"name": "left", "nodes": ["A", "tip"], **BAR}, {"name": "right", "nodes": ["B", "tip"], **BAR},
             {"name": "post", "nodes": ["low", "high"], **BAR}]
    pin = {"journal_link": "post", "journal_radius_m": 4e-3, "radial_clearance_m": PLAY_M, "friction_coefficient": 0.1}
    pins = [{"name": "below", "bearing_node": "foot", "journal_node": "low", **pin},
            {"name": "above", "bearing_node": "tip", "journal_node": "high", "bearing_link": "left", **pin}]
    return {"case": {"name": "post", "kind": "truss"}, "truss": {"dimension": 2, **truss}, "node": nodes, "link": links, "revolute": pins,
            "thermal": {"shape": "triangle", "temperature_change_max_K": change_K, "period_s": 1.0}}


def solved(document: dict[str, Any]) -> tuple[Any, Run]:
    case = parse_case(document)
    return case, result.reduced_run(case, solve.path(case.resolve()), result.sample_times(case))


def shifted(run: Run, node: int, by_m: float) -> Run:
    """The run with one node displaced, from a tenth of the samples to the end."""
    column = run.history["displacement_m"]
    values = column.values.copy()
    values[len(values) // 10:, node, 1] += by_m
    return replace(run, history={**run.history, "displacement_m": replace(column, values=values)}, native=None)


def missed(case: Any, first: Run, second: Run) -> list[str]:
    return [row.name for row in compare.difference(case, first, second) if not row.passed]


@pytest.mark.parametrize("node", [4, 5])
def test_where_a_slack_bar_hangs_is_not_compared(node: int) -> None:
    case, run = solved(post(10.0))
    assert missed(case, run, shifted(run, node, PLAY_M / 2)) == []
    (said,) = slack.sentence(case, compare.hung_nodes(case, run))
    assert said == note("slack_not_compared", nodes=("low", "high"))


def test_the_tip_is_compared_while_a_bar_at_it_hangs() -> None:
    case, run = solved(post(10.0))
    assert len(missed(case, run, shifted(run, 2, PLAY_M / 2))) > 2


def test_a_bar_is_compared_where_it_carries() -> None:
    case, run = solved(post(80.0))
    hung = compare.hung_nodes(case, run)
    carries = np.abs(run.links["axial_force_N"].values[:, 2]) > 1.0
    assert 0 < carries.sum() < len(carries)
    assert not hung[carries].any() and hung[~carries][:, [4, 5]].all() and not hung[:, :4].any()
    assert "displacement_largest_rms_over_largest" in missed(case, run, shifted(run, 5, PLAY_M / 2))


def test_a_bar_that_hangs_by_its_weight_is_compared() -> None:
    document = post(10.0, gravity_m_per_s2=[0.0, -9.81])
    document["revolute"][0]["radial_clearance_m"] = 3 * PLAY_M  # open below
    case, run = solved(document)
    hung = compare.hung_nodes(case, run)
    assert not hung.any() and slack.sentence(case, hung) == ()
