# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about a run of a truss: Euler load and yield strength of links, status changes that are processed together.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from failures import failing, note
import statejump as sj
from statejump.core.notes import Note
from statejump.core.run import warnings_of
from statejump.kinds.loading import load_case
from statejump.kinds.spring_slider.reduced import spring_slider
from statejump.kinds.truss.resolved import FIXITY

FRICTION_N = 368.55  # of the block of a chain of one: what its bar carries hot


def bar(**keys: Any) -> sj.Case:
    """A chain of one block whose bar has more keys."""
    made = sj.truss.chain(1)
    assert made.slider[0].friction_coefficient * made.slider[0].normal_force_N == pytest.approx(FRICTION_N, rel=1e-15)
    return made.changed({f"link.*.{key}": value for key, value in keys.items()})


def told(case: sj.Case, code: str) -> list[Note]:
    return [warning for warning in case.reduced().warnings if warning == note(code)]


def test_euler_loads_are_those_of_the_spring_slider(cases) -> None:
    other = spring_slider(load_case(cases / "table1.toml"))
    for ends, theirs in ("pinned_pinned", other.euler_load_N("pinned_pinned")), (
            "clamped_clamped", other.euler_load_N("clamped_clamped")):
        assert bar(ends=ends).definition.resolve().links.euler_load_N == pytest.approx([theirs], rel=1e-14)
    # Clamped and pinned: buckled as u'' + k² u = x - 1, so tan(k l) = k l.
    root = np.pi * FIXITY["clamped_pinned"] ** 0.5
    assert np.tan(root) == pytest.approx(root, rel=1e-13) and np.pi < root < 1.5 * np.pi
    assert bar(ends="guided").definition.resolve().links.euler_load_N == [np.inf]


@pytest.mark.parametrize("ends", ["pinned_pinned", "clamped_pinned", "clamped_clamped"])
def test_buckling_is_told_from_the_load_on_at_which_it_happens(ends) -> None:
    moment = FRICTION_N * 0.5**2 / (FIXITY[ends] * np.pi**2 * 70e9)
    warned, = told(bar(ends=ends, second_moment_of_area_m4=moment * (1 - 1e-9)), "link_buckles")
    assert warned == note("link_buckles", link="L1", load="368.6 N", limit="368.5 N", ends=ends.replace("_", "-"), links=1)
    assert warned.details["second_moment_of_area_m4"] == pytest.approx(moment, rel=1e-8)
    assert warned.details["load_N"] == pytest.approx(FRICTION_N, rel=1e-9)
    assert not told(bar(ends=ends, second_moment_of_area_m4=moment * (1 + 1e-9)), "link_buckles")
    assert not told(bar(ends="guided", second_moment_of_area_m4=1e-3 * moment), "link_buckles")


def test_yielding_is_told_in_tension_and_compression() -> None:
    stress = FRICTION_N / 9e-6
    warned, = told(bar(yield_strength_Pa=stress * (1 - 1e-9)), "link_yields")
    assert warned == note("link_yields", link="L1", load="40.95 MPa", limit="40.95 MPa", links=1)
    assert warned.details["limit_Pa"] == stress * (1 - 1e-9) < warned.details["load_Pa"]
    assert not told(bar(yield_strength_Pa=stress * (1 + 1e-9)), "link_yields")
    # A bar that slips while it cools is pulled: no buckling, the same stress.
    cold = bar(yield_strength_Pa=stress * (1 - 1e-9)).changed({"thermal.temperature_change_max_K": -100.0})
    assert told(cold, "link_yields")


def test_the_worst_link_is_named_and_the_others_are_counted() -> None:
    chain = sj.truss.chain(3)
    forces = chain.reduced().native.states["axial_force_N"].max(axis=0)
    strength = 0.5 * (np.sort(forces)[0] + np.sort(forces)[1]) / 9e-6
    warned, = told(chain.changed({"link.*.yield_strength_Pa": strength}), "link_yields")
    assert warned == note("link_yields", link=f"L{1 + int(np.argmax(forces))}", links=2)


def test_what_both_models_warn_of_is_said_once() -> None:
    both = bar(yield_strength_Pa=1e7)
    still, moving = both.reduced(), both.changed({"motion.steps_per_cycle": 1000}).reduced(dynamic=True)
    assert len(still.warnings) == 2 and still.warnings != moving.warnings  # of buckling and of yielding
    assert warnings_of([still, moving]) == [*still.warnings]
    assert warnings_of([still, replace(moving, warnings=(*moving.warnings, "link 'L1' is lost"))]) == [
        *still.warnings, "link 'L1' is lost"]
    # Within one run all are kept: that of two joints in one model differs by their names' numbers.
    assert warnings_of([replace(still, warnings=("joint J1 sticks", "joint J2 sticks"))]) == [
        "joint J1 sticks", "joint J2 sticks"]


def test_motion_and_answers_warn_as_well() -> None:
    case = bar()
    moving = case.changed({"motion.steps_per_cycle": 1000}).reduced(dynamic=True)
    assert any("Euler load" in warning for warning in moving.warnings)
    assert any("Euler load" in note for note in sj.truss.answers(case, sensitivity=False).notes)


def test_keys_of_a_section_are_for_links_only() -> None:
    data = sj.truss.chain(1).to_dict()
    data["spring"] = [{"name": "K", "nodes": ["N0", "N1"], "stiffness_N_per_m": 1.0, "yield_strength_Pa": 1e8}]
    with failing("no_such_key", item="spring 'K'", key="yield_strength_Pa"):
        sj.load(data)
    with failing("misspelt_name", item="link 'L1'", key="ends", value="welded", meant="guided"):
        bar(ends="welded")


def test_changes_that_are_taken_together_are_told() -> None:
    chain = sj.truss.chain(5)
    coarse = chain.changed({"reduced.locate_events": False, "reduced.increments_per_branch": 1})
    warned, = told(coarse, "changes_together")
    assert warned == note("changes_together", number=2)
    assert not told(chain, "changes_together")
