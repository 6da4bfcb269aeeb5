# SPDX-License-Identifier: GPL-3.0-or-later
"""Structures with slack bars: solver, truss dynamics and DEM agree, also with steps much longer than all periods."""
from __future__ import annotations

import numpy as np
import pytest

import slack
import statejump as sj
import structures
from statejump.kinds.truss.dem import check
from statejump.kinds.truss.scales import scales


def test_structures_are_redundant_and_of_both_dimensions() -> None:
    made = [slack.document(*one) for one in slack.CHOSEN]
    assert len({one["case"]["name"] for one in made}) == 20
    assert {one["truss"]["dimension"] for one in made} == {2, 3}
    for one in made:
        check(sj.load(one).definition)
        assert one.get("revolute") or one.get("ball_joint")


# One structure that stays slack, one whose part closes and carries force, one in space.
@pytest.mark.parametrize("name", ["tower_1", "pratt_5", "boom_5"])
def test_models_agree(name: str) -> None:
    (chosen,) = [one for one in slack.CHOSEN if f"{one[0]}_{one[1]}" == name]
    case = sj.load(slack.document(*chosen))
    exact = case.reduced()
    own = slack.agreement(exact, exact)
    assert own.slack > 0.05 and own.play <= slack.PLAY
    for other in (case.reduced(dynamic=True), case.dem()):
        found = slack.agreement(exact, other)
        assert found.agrees, found


# Steps of half a second with periods of milliseconds: a bar slack in its pins has only its mass.
@pytest.mark.parametrize(("family", "seed"), [("tensegrity", 500), ("ring", 505)])
def test_motion_in_long_steps_ends_where_the_path_does(family: str, seed: int) -> None:
    case = sj.load(structures.make(family, seed).document)
    path, motion = case.reduced(), case.reduced(dynamic=True)
    truss = path.native.truss
    hanging = {node for node, *_ in slack.pins(motion)}
    carries = np.array([node.name not in hanging for node in case.definition.node])
    ends = [run["displacement_m"][-1][carries] for run in (path, motion)]
    of = scales(truss, path["displacement_m"])
    assert motion.native.rejected_steps > 0 and len(motion.time_s) == case.definition.samples_per_cycle + 1
    assert np.abs(ends[1] - ends[0]).max() <= 1e-2 * of.motion_m
