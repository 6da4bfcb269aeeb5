# SPDX-License-Identifier: GPL-3.0-or-later
"""Prismatic joints between two bodies: law, energy, stable step, messages. test_stepper.py tests both loops and saving.
"""
import re

import pytest
from conftest import EPS


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("prismatic.py")


def test_law_of_friction_and_stops(seen):
    run = seen["loop"]
    top, limit, soft = run["amplitude"], run["frictionLimit"], run["frictionStiffness"]
    # Three ways: up, down, up. Friction after Masing: twice the law of the first way, from where it turns.
    count = round((len(run["rows"]) - 1) / 5)
    for place, (slide, found, friction, stop, along, across, both, elastic, _) in enumerate(run["rows"]):
        first, down = place <= count, place <= 3 * count
        expected = (min(soft * slide, limit) if first else max(limit - soft * (top - slide), -limit) if down
                    else min(soft * (top + slide) - limit, limit))
        depth = max(slide - run["clearancePlus"], -slide - run["clearanceMinus"], 0.0)
        pushes = run["stopStiffness"] * depth**1.5 * (1 if slide > 0 else -1)
        # Places of order 0.1 m are rounded, a few times each; the slope of a stop is at most 2.2 MN/m.
        place_m = 4 * 0.3 * EPS
        slope = soft + 1.5 * run["stopStiffness"] * depth**0.5
        assert found == pytest.approx(slide, abs=place_m)
        assert friction == pytest.approx(expected, abs=3 * soft * place_m), place
        assert stop == pytest.approx(pushes, abs=slope * place_m), place
        assert along == pytest.approx(expected + pushes, abs=4 * slope * place_m), place
        assert across == pytest.approx(run["stiffnessAcross"] * run["aside"], abs=run["stiffnessAcross"] * 2 * place_m)
        assert both == 0
        stored = (expected**2 / (2 * soft) + 0.4 * abs(pushes) * depth
                  + 0.5 * run["stiffnessAcross"] * run["aside"] ** 2)
        assert elastic == pytest.approx(stored, abs=300 * place_m), place
    # Slipped: each way less what friction bends by. The step in which it begins to slip has the mean force.
    step, bend = top / count, limit / soft
    heat = limit * ((top - bend) + 2 * (2 * top - 2 * bend))
    assert run["rows"][-1][-1] == pytest.approx(heat, abs=3 * soft * step**2 / 2)
    assert all(b[-1] >= a[-1] for a, b in zip(run["rows"], run["rows"][1:]))


def test_energy_and_momentum_of_a_swing_from_stop_to_stop(seen):
    coarse, fine = seen["swing"]
    for run in (coarse, fine):
        assert run["stops"] > 10 and run["slips"] > 100 and run["friction"] > 0.3 * run["first"] and run["damping"] == 0
        assert run["momentum"] < run["steps"] * EPS * 0.02 * 0.3
        assert run["worst"] < 1e-3 * run["first"]
    # The trapezoidal rule at corners and at Hertz's stops: second order.
    assert fine["worst"] < 0.4 * coarse["worst"]


def test_energy_closes_with_dashpots(seen):
    run = seen["damped"]
    assert run["damping"] > 0.01 * run["first"]
    # Of first order in the step: the velocity is half a step late.
    assert run["worst"] < 2e-2 * run["first"]


def test_law_of_soft_stops_and_play(seen):
    run = seen["bolt"]
    limit, soft, half = run["frictionLimit"], run["frictionStiffness"], run["play"] / 2
    place_m, slipped, heat = 4 * 0.3 * EPS, 0.0, 0.0
    for place, (slide, _, friction, stop, along, _, _, elastic, lost) in enumerate(run["rows"]):
        width, before = half + limit / soft, slipped
        slipped = min(max(slipped, slide - width), slide + width)
        heat += limit * abs(slipped - before)
        bend = slide - slipped
        expected = soft * (bend - min(max(bend, -half), half))
        depth = max(slide - run["clearancePlus"], -slide - run["clearanceMinus"], 0.0)
        pushes = run["stopSpring"] * depth * (1 if slide > 0 else -1)
        # A sum of slides has up to one rounding a row.
        assert friction == pytest.approx(expected, abs=1000 * soft * place_m), place
        assert stop == pytest.approx(pushes, abs=run["stopSpring"] * place_m), place
        assert along == pytest.approx(expected + pushes, abs=1000 * (soft + run["stopSpring"]) * place_m)
        stored = (expected**2 / (2 * soft) + 0.5 * run["stopSpring"] * depth**2
                  + 0.5 * run["stiffnessAcross"] * run["aside"] ** 2)
        assert elastic == pytest.approx(stored, abs=3000 * place_m), place
    # The step in which it begins to slip has the mean force of two rows; it begins three times.
    assert run["rows"][-1][-1] == pytest.approx(heat, abs=3 * limit * run["amplitude"] / 200)
    # It crosses half of the play at first and the whole of it behind each of two turns.
    assert sum(row[2] == 0 for row in run["rows"]) > 2.5 * 0.9 * run["play"] / (run["amplitude"] / 200)


def test_energy_of_a_swing_with_soft_stops_and_play(seen):
    coarse, fine = seen["bolt_swing"]
    for run in (coarse, fine):
        assert run["stops"] > 10 and run["slips"] > 10 and run["damping"] == 0
        assert run["worst"] < 1e-3 * run["first"]
    # Forces have corners where a play closes and a stop begins: second order.
    assert fine["worst"] < 0.4 * coarse["worst"]


def test_stable_step(seen):
    inside, beyond = seen["limit"]["0.95"], seen["limit"]["1.05"]
    assert inside["error"][0] == "none"
    assert beyond["error"][0] == "RuntimeError"
    assert re.fullmatch(r"time_step_unstable O.dt = \S+ \(prismatic_joint 0 1\)", beyond["error"][1])
    assert 0.7 * inside["true"] < inside["promised"] <= inside["true"]


@pytest.mark.parametrize(("case", "fault"), [
    ("axis", "not_allowed PrismaticJoint.axis = 0.5"), ("stiffnessAcross", "not_allowed PrismaticJoint.stiffnessAcross = -1"),
    ("frictionLimit", "not_allowed PrismaticJoint.frictionLimit = nan"),
    ("clearancePlus", "not_allowed PrismaticJoint.clearancePlus = -0.001"),
    ("dampingRatio", "not_allowed PrismaticJoint.dampingRatio = -0.1"),
    ("offset", "not_allowed PrismaticJoint.offset = inf"), ("body", "no_body PrismaticJoint.id2 = 7"),
    ("same", "same_body PrismaticJoint.id2 = 0"),
    ("friction", "not_allowed PrismaticJoint.frictionStiffness = 0 (prismatic_joint 0 1)"),
    ("stop", "not_allowed PrismaticJoint.stopStiffness = 0 (prismatic_joint 0 1)"),
    ("none", "holds_none PrismaticJoints.joints"),
])
def test_wrong_use_is_said(seen, case, fault):
    kind, text = seen["wrong"][case]
    assert kind in ("ValueError", "RuntimeError") and text.startswith(fault)
