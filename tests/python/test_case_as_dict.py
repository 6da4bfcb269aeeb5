# SPDX-License-Identifier: GPL-3.0-or-later
"""A case as a dict: its dict makes an equal case."""
from __future__ import annotations

from pathlib import Path

import pytest

import statejump as sj
from conftest import REPOSITORY

CASES = sorted([*(REPOSITORY / "cases").glob("*.toml"), *(REPOSITORY / "cases" / "trusses").glob("*.toml")])


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_loads_again(path: Path) -> None:
    case = sj.load(path)
    assert sj.load(case.to_dict()) == case


def test_items_can_be_added() -> None:
    data = sj.truss.chain(1).to_dict()
    data["node"].append({"name": "G", "position_m": [1.0, 0.0], "fixed": ["x", "y"]})
    data["spring"] = [{"name": "K", "nodes": ["N1", "G"], "stiffness_N_per_m": 1.0}]
    assert [spring.name for spring in sj.load(data).spring] == ["K"]
