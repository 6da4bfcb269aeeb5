# SPDX-License-Identifier: GPL-3.0-or-later
"""Torsion springs between two links and viscous pins, against closed forms."""
import re
from math import pi, sqrt

import pytest

from conftest import EPS


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("torsion.py")


@pytest.mark.parametrize("case", range(6))
def test_angle_moment_and_couples(seen, case):
    row = seen["angles"][case]
    first, second = row["directions"]
    angle = second - first
    angle += 2 * pi * ((angle <= -pi) - (angle > pi))
    assert row["angle"] == pytest.approx(angle, abs=8 * EPS)
    moment = 3.0 * (angle - row["free"])
    # K_M = 3 N m/rad times the rounding of the angle; the axial springs pull by the rounding of
    # their lengths, 1.75e5 N/m times 1e-16 m, on arms of 1 m.
    tolerance = 30 * EPS + 1.75e5 * 2 * EPS
    assert row["moment"] == pytest.approx(moment, abs=30 * EPS)
    assert row["energy"] == pytest.approx(moment**2 / 6, rel=40 * EPS)
    assert row["on_links"] == [
        pytest.approx(moment, abs=tolerance), pytest.approx(-moment, abs=tolerance)
    ]
    assert row["force"] == pytest.approx([0, 0, 0], abs=tolerance)
    assert row["total"] == pytest.approx(0, abs=tolerance)
    assert row["along"] == pytest.approx([0, 0], abs=tolerance)


def test_static_balance(seen):
    found = seen["balance"]
    assert max(found["speeds"]) < 1e-10
    spring, other = found["moments"]
    assert spring == pytest.approx(2.0 * (found["angles"][0] - 1.2), rel=1e-12)
    assert other == pytest.approx(5.0 * (found["angles"][1] - 0.3), rel=1e-12)
    pulled = [a[0] * f[1] - a[1] * f[0] for a, f in zip(found["arms"], found["pulls"])]
    # Link 1 carries +M of its own spring and -M of the other; link 2 carries -M. At rest to the
    # rounding of the axial springs, 1.75e5 N/m times 1e-16 m.
    assert spring - other + pulled[0] == pytest.approx(0, abs=1e-9)
    assert -spring + pulled[1] == pytest.approx(0, abs=1e-9)
    assert abs(spring) > 0.2 and abs(other) > 0.02
    energy = spring**2 / 4 + other**2 / 10
    assert found["energy"] == pytest.approx(energy, rel=1e-12)


def test_energy_of_a_free_oscillation_closes_to_second_order(seen):
    runs = seen["oscillation"]
    for coarse, fine in zip(runs, runs[1:]):
        assert coarse["first"] == pytest.approx(0.5 * 2.0 * 0.3**2, rel=1e-12)
        assert 3.6 < coarse["worst"] / fine["worst"] < 4.4
    assert runs[-1]["worst"] < 1e-8 * runs[-1]["first"]
    for run in runs:
        # Equal and opposite couples: the moments of momentum of both links, each about its own
        # root, stay opposite. One rounding per step of the couple's impulse, and of the axial force
        # of rounding, 1.75e5 N/m * 1e-16 m, on an arm of 0.5 m times dt.
        first, second = run["momentum"]
        assert abs(first) > 1e-2
        assert first + second == pytest.approx(0, abs=run["steps"] * 4e-5 * 2e-11)
        assert run["promised"] > 1e-4


def test_stable_up_to_the_limit_and_refused_beyond(seen):
    inside, beyond = seen["limit"]["0.95"], seen["limit"]["1.05"]
    # Leapfrog at omega dt = 1.9 keeps the amplitude, 1e-6 rad, / sqrt(1 - 0.95^2).
    assert inside["error"][0] == "none"
    assert inside["largest"] < 1e-6 / (1 - 0.95**2) ** 0.5 * 1.01
    assert beyond["error"][0] == "RuntimeError"
    assert re.fullmatch(r"time_step_unstable O.dt = \S+ \(torsion_spring 2 3\)", beyond["error"][1])
    # One end of four moves: the promise is the limit itself, less the soft axial spring.
    assert 0.99 * inside["true"] < inside["promised"] <= inside["true"]


def test_play_and_friction_have_the_loop_of_their_law(seen):
    run = seen["latch"]
    top, limit, soft = run["amplitude"], run["frictionLimit"], run["frictionStiffness"]
    # Three ways: up, down, up. Friction after Masing: twice the law of the first way, from where it turns.
    count = round((len(run["rows"]) - 1) / 5)
    for place, (stretch, moment, friction, elastic, _) in enumerate(run["rows"]):
        first, down = place <= count, place <= 3 * count
        expected = (min(soft * stretch, limit) if first else max(limit - soft * (top - stretch), -limit) if down
                    else min(soft * (top + stretch) - limit, limit))
        beyond = stretch - max(min(stretch, run["deadband"]), -run["deadband"])
        # Roundings of angles of order 1, times stiffnesses of 6 N m/rad.
        assert friction == pytest.approx(expected, abs=100 * EPS), place
        assert moment == pytest.approx(run["preload"] + 2.0 * beyond + expected, abs=200 * EPS), place
        stored = run["preload"] * stretch + beyond**2 + expected**2 / (2 * soft)
        assert elastic == pytest.approx(stored, abs=100 * EPS), place
    # Slipped: each way less what friction bends by. The step in which it begins to slip has the mean moment.
    step, bend = top / count, limit / soft
    heat = limit * ((top - bend) + 2 * (2 * top - 2 * bend))
    assert run["rows"][-1][-1] == pytest.approx(heat, abs=3 * soft * step**2 / 2)
    assert all(b[-1] >= a[-1] for a, b in zip(run["rows"], run["rows"][1:]))


def test_energy_of_a_swing_through_the_play_closes_to_second_order(seen):
    runs = seen["latch_swing"]
    inertia = 1 / (1 / (0.02 * 0.4**2) + 1 / (0.04 * 0.5**2))
    for run in runs:
        # 0.3 rad at the start; friction takes most of it.
        assert run["friction"] > 0.5 * (run["first"] - 0.3 * 0.3)
        # The trapezoidal rule misses dK ds^2 / 8 at most where the slope changes by dK within a step of ds.
        turn = sqrt(2 * run["first"] / inertia) * run["dt"]
        assert run["worst"] < run["corners"] * (2.0 + 4.0) * turn**2 / 8


def test_friction_that_sticks_counts_in_the_stable_step(seen):
    inside, beyond = seen["latch_limit"]["0.95"], seen["latch_limit"]["1.05"]
    assert inside["error"][0] == "none"
    assert beyond["error"][0] == "RuntimeError" and beyond["error"][1].startswith("time_step_unstable O.dt = ")
    assert 0.99 * inside["true"] < inside["promised"] <= inside["true"]


@pytest.mark.parametrize("both_free", [0, 1])
def test_pin_damping_decays_the_turn(seen, both_free):
    for run in seen["decay"][both_free]:
        # Rate c_p/(m L^2) of the tip's mass m, a third of a rod's: 3 c_p/(m_rod L^2). Leapfrog
        # takes the damper's velocity of the last half step: factor 1 - rate dt of each step, which
        # the integration of a turning vector repeats to second order in the turn of a step, and
        # the link is stretched by 1e-8 of its length.
        for steps, spin in run["rows"]:
            expected = run["spin"] * (1 - run["rate"] * run["dt"]) ** steps
            turn = 3.0 * run["dt"]
            assert spin == pytest.approx(expected, rel=steps * run["rate"] * run["dt"] * turn + 1e-6)
        assert run["rows"][-1][1] < 0.15 * run["spin"]
        assert run["momentum"] == pytest.approx(0, abs=run["rows"][-1][0] * EPS * 0.1)
    coarse, fine = seen["decay"][both_free]
    last = fine["rows"][-1][1] / fine["spin"]
    assert fine["energy"] == pytest.approx(fine["kinetic"] * (1 - last**2), rel=1e-4)
    # First order: the damper does its work with the velocity half a step late.
    assert 1.8 < coarse["worst"] / fine["worst"] < 2.2


def test_a_stiff_pin_decides_the_time_step(seen):
    inside, beyond = seen["pin_limit"]["0.95"], seen["pin_limit"]["1.05"]
    assert inside["error"][0] == "none" and inside["speed"] < 1e-12
    assert beyond["error"][0] == "RuntimeError" and beyond["error"][1].startswith("time_step_unstable O.dt = ")
    # 2 m L^2/c_p; half of it is promised, because any damper could pull at both ends of a link.
    assert 0.45 * inside["true"] < inside["promised"] <= inside["true"]


@pytest.mark.parametrize(
    ("case", "fault"),
    [
        ("link1", "missing TorsionSpring.link1"), ("link2", "missing TorsionSpring.link2"),
        ("None", "holds_none TorsionSprings.springs"), ("plane", "leaves_plane (link 0 2)"),
        ("body", "no_body ThermalLink.id2 = 3"),
    ],
)
def test_wrong_use_is_said(seen, case, fault):
    kind, text = seen["wrong"][case]
    assert kind in ("ValueError", "RuntimeError") and text == fault
    assert seen["wrong"]["nothing"] == ["none", ""]
