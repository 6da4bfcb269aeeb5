# SPDX-License-Identifier: GPL-3.0-or-later
"""YADE's versions rotate aspherical bodies differently; no body of the plugin is aspherical."""
import pytest


@pytest.fixture(scope="module")
def ways(run_script):
    return run_script("rotation.py")["ways"]


def test_the_ball_turns_and_rubs(ways):
    assert ways[0]["angle"] > 1e-4
    assert ways[0]["friction"] > 0


def test_no_body_is_aspherical(ways):
    assert not any(any(way["aspherical"]) for way in ways)


def test_no_way_of_turning_aspherical_bodies_changes_a_bit(ways):
    assert len(ways) >= 2
    for way in ways[1:]:
        assert way["rows"] == ways[0]["rows"], way["way"]
