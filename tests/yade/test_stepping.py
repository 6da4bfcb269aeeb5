# SPDX-License-Identifier: GPL-3.0-or-later
"""Time steps and misuse: the documented stability limits hold, and mistakes are reported."""
from math import sqrt

import pytest

from conftest import E_STAR, G_STAR

RADIUS = 5e-3 * 5.1e-3 / 1e-4


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("stepping.py")


def test_global_stiffness_time_stepper_sees_the_contact(seen):
    found = seen["global"]
    kn = 2 * E_STAR * sqrt(RADIUS * found["depth"])
    ks = 8 * G_STAR * sqrt(RADIUS * found["depth"])
    assert found["kn"] == pytest.approx(kn, rel=1e-12)
    assert found["ks"] == pytest.approx(ks, rel=1e-12)
    # YADE: 0.8 * 1.41044 sqrt(m / K) of the softest body, K the largest diagonal entry of
    # kn n n + ks (1 - n n), n = (0.6, 0.8, 0); the inertias of the scene do not decide.
    stiffest = max(ks + (kn - ks) * n**2 for n in (0.6, 0.8, 0))
    expected = 0.8 * 1.41044 * sqrt(found["masses"][0] / stiffest)
    assert found["dt"] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("case", ["False", "True"])
def test_spring_is_stable_up_to_the_limit_and_refused_beyond(seen, case):
    inside, beyond = seen["spring"]["0.95 " + case], seen["spring"]["1.05 " + case]
    # Leapfrog at omega dt = 1.9 keeps the amplitude / sqrt(1 - (omega dt/2)^2) = 3.2 times.
    assert inside["error"][0] == "none"
    assert inside["largest"] < 1e-6 / sqrt(1 - 0.95**2) * 1.001
    assert beyond["error"][0] in ("RuntimeError", "ValueError")
    assert beyond["error"][1].startswith("time_step_unstable O.dt = ")
    # Never above the true limit, and not wastefully below: a factor sqrt(2) at most here.
    assert inside["limit"] / 1.415 <= inside["promised"] <= inside["limit"]


def test_two_springs_limit(seen):
    # Each spring alone is far from its limit, so nothing is refused and the motion shows the limit.
    assert seen["unguarded"]["0.95"]["largest"] < 3.3e-6
    assert seen["unguarded"]["1.05"]["largest"] > 1
    for found in seen["unguarded"].values():
        assert found["limit"] / 1.415 <= found["promised"] <= found["limit"]


def test_a_spring_that_cooling_shortens_is_stiffer(seen):
    """The step uses E A / l_T. A spring that heating lengthens keeps the smaller limit of its reference length."""
    cold, reference, warm = seen["cold"]
    assert reference == pytest.approx(sqrt(2 * 0.01 * 0.5 / (70e9 * 9e-6)), rel=1e-12)
    assert cold == pytest.approx(sqrt(0.7) * reference, rel=1e-12) and warm == reference


def test_damped_spring_is_stable(seen):
    assert seen["damped"] < 1e-12


@pytest.mark.parametrize("inertia", ["0.5", "0.4", "0.02"])
def test_joint_is_stable_for_any_inertia(seen, inertia):
    # Starts with 1e-3 rad/s; unstable means growth by powers of ten within 2000 steps.
    assert seen["joint"][inertia]["spin"] < 5e-3


def test_nothing_acts(seen):
    assert seen["nothing_acts"]


def test_too_large_time_step_stops(seen):
    kind, text, iteration = seen["too_large_contact"]
    assert kind == "RuntimeError"
    assert text == "time_step_unstable O.dt = 0.001 (contact 0 1)"
    assert iteration <= 1


def test_scene_without_our_engines_stops_as_well(seen):
    kind, _, iteration = seen["without_our_engines"]
    assert kind == "none" and iteration == 1  # the run ended after the step


FAULTS = {
    "missing_program_of_engine": "missing ThermalExpansionEngine.program",
    "missing_program_of_link": "missing ThermalLink.program",
    "missing_id1": "no_body ThermalLink.id1 = -1",
    "missing_id2": "no_body ThermalLink.id2 = 99",
    "missing_body_of_engine": "no_body ThermalExpansionEngine.ids = 77",
    "body_without_thermal_shape": "no_thermal_body ThermalExpansionEngine.ids = 0",
    "tilt": "tilted maxTilt (contact 1 2)",
    "closed_by_expansion": "clearance_closed journal = 0.0051035 (contact 1 2)",
    "closed_from_start": "clearance_closed journal = 0.006",
    "rotations_free": "rotations_free ThermalLink.tipTurnsWithLink = 1",
    "no_length": "not_allowed ThermalLink.stressFreeLength = 0 (link 0 1)",
    "same_body": "ends_coincide (link 1 1)",
    "poisson": "not_allowed ThermalFrictMat.poisson = 0.7 (body 1)",
    "young": "not_allowed ThermalFrictMat.young = -1 (body 1)",
    "friction_angle": "not_allowed ThermalFrictMat.frictionAngle = -0.1 (body 1)",
}


@pytest.mark.parametrize("name", FAULTS)
def test_wrong_use_is_said_and_yade_survives(seen, name):
    kind, text, iteration = seen["wrong"][name]
    assert kind in ("RuntimeError", "ValueError")
    assert text.startswith(FAULTS[name])
    assert iteration <= 2


@pytest.mark.parametrize("name", ["nothing_wrong", "tilt_within"])
def test_right_use_runs(seen, name):
    assert seen["wrong"][name] == ["none", "", 20]


def test_failure_of_another_scene_is_forgotten(seen):
    assert seen["after_failure"] == ["none", "", 10]
