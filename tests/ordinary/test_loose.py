# SPDX-License-Identifier: GPL-3.0-or-later
"""Structures with play larger than the deformation by loads and temperatures. Each represents a type of path that an
earlier solver did not find."""
from __future__ import annotations

import numpy as np
import pytest

import statejump as sj
from statejump.core.notes import Note
import structures
import worker


@pytest.mark.parametrize(("family", "seed"), [
    pytest.param("bracket", 114, id="contacts_of_a_loose_redundant_start_give_way_as_they_open"),
    pytest.param("cable_stayed", 506, id="a_contact_that_pulls_while_it_sticks_and_closes_while_it_is_open_slides"),
    pytest.param("k_truss", 10, id="an_element_under_compression_hangs_slack_within_its_play"),
    pytest.param("k_truss", 9007, id="a_journal_that_finds_no_place_at_the_start_comes_to_rest_against_dashpots"),
    pytest.param("mast", 3021, id="steps_along_directions_that_hardly_anything_holds_may_grow"),
    pytest.param("ring", 102, id="ways_on_that_rounding_does_not_tell_apart_are_one"),
])
def test_finishes(family: str, seed: int) -> None:
    found = worker.run(structures.make(family, seed).document)
    assert found["outcome"] == "finished", found["sentence"]


def test_a_snap_within_the_play_is_noted() -> None:
    found = sj.load(structures.make("k_truss", 9007).document).reduced().warnings
    assert any(isinstance(warning, Note) and warning.code == "snap" for warning in found), found


def test_many_slack_joints_are_not_located_and_noted() -> None:
    case = structures.make("tower", 9154).document
    coarse, fine = (
        sj.load({**case, "reduced": {**case.get("reduced", {}), "increments_per_branch": number}}).reduced()
        for number in (200, 400))
    assert [note.code for note in coarse.warnings if isinstance(note, Note)].count("not_located") == 1
    # A change of contact is found at most one increment late, a two-hundredth of the motion of a branch.
    moved_m = [run["displacement_m"] for run in (coarse, fine)]
    jumps_m = [moved[-1] - moved[0] for moved in moved_m]
    assert np.abs(jumps_m[1] - jumps_m[0]).max() < np.ptp(moved_m[1], axis=0).max() / 200


@pytest.mark.parametrize(("family", "seed", "codes"), [
    ("rib", 31000, ["changes_passed"]),  # two latches start to slip within one increment
    ("k_truss", 31000, []),  # five latches stop together as the temperature turns: nothing is lost
    ("walking", 31000, [])])
def test_only_changes_that_are_passed_are_noted(family: str, seed: int, codes: list[str]) -> None:
    run = sj.load(structures.make(family, seed).document).reduced()
    found = [note.code for note in run.warnings if isinstance(note, Note)]
    assert [code for code in found if code in ("changes_together", "changes_passed")] == codes
