# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets and pipes walk down an incline as theory predicts. walking.py tests more numbers of blocks."""
from __future__ import annotations

from dataclasses import replace
from math import atan

import pytest

import statejump as sj
from walking import EVENT, Walker, row, solved, walker

LIMIT_S = 60.0


@pytest.mark.parametrize("friction", [0.2, 0.342, 0.6])
@pytest.mark.parametrize("blocks", [4, 9, 20, 37])
@pytest.mark.parametrize("kind", ["sheet", "pipe"])
def test_walks_by_its_blocks(kind: str, blocks: int, friction: float) -> None:
    one = walker(kind, blocks, friction)
    text, good = row(one, solved(one, LIMIT_S))
    assert good, text


def test_many_blocks_walk_as_a_sheet() -> None:
    many = replace(walker("pipe", 4, 0.3), blocks=10**6 + 1)
    assert many.walk_of_blocks_m == pytest.approx(many.walk_m, rel=1e-5)


def test_another_friction_is_noticed() -> None:
    """With 0.5 % more friction the same blocks rest, but the pipe loses more of its expansion."""
    one = walker("pipe", 9, 0.3)
    assert not row(replace(one, friction=0.3015), solved(one, LIMIT_S))[1]


def test_a_time_out_is_reported() -> None:
    one = walker("sheet", 37, 0.3)
    assert solved(one, 1e-3)["sentence"] == "more than 0.001 s"


def test_beam_on_an_incline_never_settles() -> None:
    """A beam of 1 km on 100 blocks, 400 N/m, E A = 3e9 N, in every cycle after the first."""
    one = Walker("incline", 100, 0.3, atan(0.05), 1000.0, 400.0, 3e9, 1.0, 1.17e-5, 80.0)
    made = one.document()
    made["beam"] = [{**bar, "second_moments_of_area_m4": [0.1, 0.1]} for bar in made.pop("link")]
    ends = sj.load(made).reduced().native.cycle_ends["displacement_m"][:, :, 0]
    # Friction holds back one.lost of cold bars in cooling, and of warm, longer bars in heating.
    exact = one.apart * one.length_m / one.blocks * (one.expansion - one.lost * (1 + one.expansion / 2))
    assert exact == pytest.approx(0.153457754722, rel=1e-10)
    late_m = 4 * one.blocks * EVENT * one.expansion * one.length_m
    assert (ends[2:] - ends[1:-1]).mean(axis=1) == pytest.approx(exact, abs=late_m)
