# SPDX-License-Identifier: GPL-3.0-or-later
"""Random trusses without loads and joints expand freely. free_expansion.py runs the whole campaign."""
from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

from free_expansion import checked, trusses

SAMPLE = [one for one in trusses(60, 5000) if one.members <= 100]


def test_a_truss_without_loads_and_joints_expands_freely() -> None:
    wrong = {one.document["case"]["name"]: found["wrong"] for one in SAMPLE if (found := checked(one))["wrong"]}
    assert not wrong


def test_the_sample_has_determinate_and_redundant_trusses_in_plane_and_space() -> None:
    assert len({one.group for one in SAMPLE}) == 4


def test_a_bar_that_is_too_warm_is_noticed() -> None:
    """A bar of a redundant truss is too warm by 1e-6 of ΔT; the other bars restrain it."""
    one = next(one for one in SAMPLE if one.redundant > 0 and one.document["thermal"].get("temperature_change_max_K"))
    made = deepcopy(one.document)
    made["link"][0]["temperature_fraction"] = 1 + 1e-6
    assert "forces" in checked(replace(one, document=made))["wrong"]
