# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets and pipes walk down an incline as theory predicts. walking.py tests more numbers of blocks."""
from __future__ import annotations

from dataclasses import replace

import pytest

from walking import row, solved, walker

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
