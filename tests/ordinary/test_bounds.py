# SPDX-License-Identifier: GPL-3.0-or-later
"""A small part of the campaign of bounds."""
from __future__ import annotations

from argparse import Namespace
from collections import Counter

import pytest

import bounds_campaign
import statejump as sj
from walking import walker


def test_no_state_of_ordinary_structures_leaves_its_bounds() -> None:
    families = ["warren", "tower", "rib", "bracket"]
    arguments = Namespace(count=2, seed=50, most=3, histories=1, families=families, classes=["A", "B", "C"], limit=100,
                          attain=False)
    rows = list(bounds_campaign.compared(arguments, Counter()))
    assert len({(row["family"], row["seed"]) for row in rows}) >= 4
    assert not [row for row in rows if row["outside"]]
    assert all(row["reached_m"] <= row["spread_m"] * (1 + 1e-6) for row in rows)


def test_a_history_attains_the_bound_of_a_structure_with_stops() -> None:
    arguments = Namespace(count=1, seed=1, most=1, histories=1, families=["tower"], classes=["B"], limit=100,
                          attain=True)
    (row, *_) = bounds_campaign.compared(arguments, Counter())
    assert row["class"] == "B" and not row["outside"]
    assert row["attained_m"] >= 0.999 * row["spread_m"] and row["in_range_m"] <= row["range_m"] + row["margin_m"]


def test_the_table_counts_states_outside() -> None:
    row = dict.fromkeys(bounds_campaign.FIELDS, 1) | {"class": "A", "quality": "exact", "outside": 1, "spread_m": 2.0}
    assert "| A | exact | 1 | 1 | 1 | 0.5000 | 0.5000 | 0.5000 |" in bounds_campaign.table([row])


@pytest.mark.parametrize("blocks", [4, 5, 10])
def test_the_drift_of_walking_blocks_is_that_of_whole_numbers_of_blocks(blocks: int) -> None:
    one = walker("sheet", blocks, 0.3)
    verdict = sj.load(one.document()).bounds(output=["node:N0.x"]).verdict
    assert verdict.kind == "may_ratchet"
    # Strains are added in theory but multiplied in the solver.
    assert verdict.drift_m == pytest.approx(one.walk_of_blocks_m, rel=1e-4)
    assert abs(one.walk_m / verdict.drift_m - 1) > 1e-3  # a continuous sheet walks by another distance
