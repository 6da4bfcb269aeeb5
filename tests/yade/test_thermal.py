# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature programs, expansion of bodies, thermal links against closed forms."""
from math import asin, hypot, pi, sin, sqrt

import pytest

from conftest import EPS

E, A, L0, ALPHA = 70e9, 9e-6, 0.5, 23.4e-6


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("thermal.py")


def expected_change(shape, t):
    """Temperature change of two cycles of 1 s with an amplitude of 80 K, or of the table."""
    if t >= 2:
        return 0.0
    tau = t % 1.0
    if shape == "triangle":
        return 80 * (1 - abs(2 * tau - 1))
    if shape == "half_sine":
        return 80 * sin(pi * tau)
    if shape == "sine":
        return 80 * sin(2 * pi * tau)
    points = [(0, 0), (0.2, 60), (0.7, -30), (1.0, 0)]
    for (t0, v0), (t1, v1) in zip(points, points[1:]):
        if tau <= t1:
            return v0 + (v1 - v0) * (tau - t0) / (t1 - t0)
    raise AssertionError


@pytest.mark.parametrize("shape", ["triangle", "half_sine", "sine", "table"])
def test_program_values(seen, shape):
    for t, value in zip(seen["programs"]["times"], seen["programs"]["values"][shape]):
        # Rounding of the time within the cycle, times the steepest slope.
        assert value == pytest.approx(expected_change(shape, t), abs=1e3 * 4 * EPS), t
    at = dict(zip(seen["programs"]["times"], seen["programs"]["values"][shape]))
    assert at[0.0] == at[1.0] == at[2.0] == at[3.0] == 0  # exactly: a cycle leaves nothing


def test_strain_is_of_the_total_change_and_returns_exactly(seen):
    found = seen["expansion"]
    for t, *strains in found["rows"]:
        changes = [200 * sin(2 * pi * (t % 1.0))] * 2 + [
            -150 * (1 - abs(2 * (t % 1.5) / 1.5 - 1)) if t < 3 else 0.0
        ]
        for strain, change, alpha in zip(strains, changes, found["alpha"]):
            assert strain == pytest.approx(alpha * change, abs=alpha * 2e3 * 4 * EPS)
    assert found["rows"][-1][0] == 3.0
    assert found["rows"][-1][1:] == [0.0, 0.0, 0.0]  # 3072 steps of up to 1.2 K later
    assert found["radius"] == 5e-3
    assert found["temperature"] == [0.0, 0.0]
    assert found["others_untouched"]


def test_engine_follows_changes_made_between_steps(seen):
    found = seen["changes"]
    assert found["swapped"] == pytest.approx(50 * 2e-5, rel=4 * EPS)
    assert found["added"] == pytest.approx(50 * 2e-5, rel=4 * EPS)
    assert found["only"] == [0, pytest.approx(50 * 2e-5, rel=4 * EPS)]
    assert found["other_alpha"] == pytest.approx(50 * 3e-5, rel=4 * EPS)


@pytest.mark.parametrize("change", [0.0, 80.0, -80.0])
def test_link_force(seen, change):
    found = seen["force"][str(change)]
    free = L0 * (1 + ALPHA * change)
    assert found["free"] == free
    # Coordinates up to 1 m are rounded to 1.1e-16 m, three of them and the norm.
    rounding = 6 * EPS
    for row in found["rows"]:
        tension = E * A / free * row["stretch"]
        tolerance = E * A / free * rounding + abs(tension) * 8 * EPS
        assert row["axial"] == pytest.approx(-tension, abs=tolerance)
        for tip, root, u in zip(row["tip"], row["root"], found["direction"]):
            assert tip == pytest.approx(-tension * u, abs=2 * tolerance)
            assert root == -tip
        energy = 0.5 * tension * row["stretch"]
        assert row["elastic"] == pytest.approx(energy, abs=abs(row["stretch"]) * tolerance + 1e-24)


def test_free_link_expands_without_force(seen):
    found = seen["free"]
    axial, moved, change, _ = found["half"]
    # At the crest the tip's acceleration is -(expansion) omega^2, which takes the force m a, and
    # nothing else acts; the damper sees the strain rate without the thermal part.
    assert change == pytest.approx(100, rel=1e-6)
    inertia = found["m"] * found["expansion"] * found["omega"] ** 2
    assert axial == pytest.approx(-inertia, rel=1e-3)
    assert moved == pytest.approx(found["expansion"], abs=2 * inertia / found["k"])
    # Heated like this but held, the bar would carry 1470 N.
    assert inertia < 3e-3


def test_static_elongation(seen):
    found = seen["hanging"]
    stiffness = E * A / found["free"]
    assert found["free"] == pytest.approx(L0 * (1 + ALPHA * 40), rel=EPS)
    # At rest to rounding: positions of 0.5 m to 1.1e-16 m.
    assert found["length"] - found["free"] == pytest.approx(70 / stiffness, abs=4 * EPS)
    assert found["axial"] == pytest.approx(-70, abs=4 * EPS * stiffness)


@pytest.mark.parametrize("case", [0, 1])
def test_frequency_of_free_oscillation(seen, case):
    found = seen["oscillation"][case]
    # Leapfrog: sin(omega' dt / 2) = omega dt / 2. The correction is 1.7e-3 here.
    dt = found["omega_dt"] / found["continuous"]
    expected = 2 / dt * asin(found["omega_dt"] / 2)
    assert expected / found["continuous"] - 1 > 1.6e-3
    # Crossings by straight lines: (omega dt)^2/16 of a step at worst, over 650 rad.
    tolerance = found["omega_dt"] ** 3 / 16 * 2 / (2 * pi * found["periods"])
    assert found["periods"] > 100
    assert found["omega"] == pytest.approx(expected, rel=tolerance)


def test_moment_on_tip_becomes_a_couple(seen):
    found = seen["couple"]
    for root, tip in zip(found["root"], found["tip"]):
        assert root == -tip
    # Beside the couple the link pulls by rounding: 6 eps of its length times k = 1.26e6 N/m, along
    # the link, so without moment.
    assert found["carried"] == pytest.approx(found["across"], abs=50 * EPS)
    assert hypot(*found["tip"]) == pytest.approx(hypot(*found["across"]) / L0, abs=1e-8)


def test_moments_of_joint_and_link_balance(seen):
    assert len(seen["joint_on_link"]) > 30
    for force, moment, scale, torque in seen["joint_on_link"]:
        assert force == pytest.approx(0, abs=20 * EPS * scale)
        assert moment == pytest.approx(0, abs=20 * EPS * scale)
    # Forgetting the moment on the tip would show.
    assert max(row[3] for row in seen["joint_on_link"]) > 0.1


@pytest.mark.parametrize("case", [0, 1])
def test_angular_momentum_of_a_planar_link(seen, case):
    found = seen["pendulum"][case]
    for iteration, momentum, *_ in found["rows"]:
        expected = found["start"] + found["moment"] * found["dt"] * iteration
        # r x F of the axial force is rounding: forces up to k times the stretch. One such rounding
        # per step: F dt L eps, F below 1 N (centrifugal, 0.36 N, and ringing).
        tolerance = iteration * EPS * (found["start"] + 5 * found["dt"] * 1e2)
        assert momentum == pytest.approx(expected, abs=tolerance)
    assert abs(found["moment"] * found["dt"] * found["rows"][-1][0]) >= case * 1e-4


@pytest.mark.parametrize("case", [0, 1])
def test_tip_turns_with_its_link(seen, case):
    found = seen["pendulum"][case]
    turned = 0.0
    for row in found["rows"]:
        x, y, cosine, sine, spin, rate = row[2:]
        # Angle of the body = angle of the link - its angle at the start + 0.25 rad.
        x0, y0 = found["start_angle"]
        c, s = x * x0 + y * y0, y * x0 - x * y0
        c0, s0 = 0.9689124217106447, 0.24740395925452294  # cos, sin of 0.25
        expected = (c * c0 - s * s0, s * c0 + c * s0)
        # Turned onto the link in each step, then moved on by the integrator with the spin: what is
        # left is of second order in the turn of one step, 6.6e-5 rad, and does not add up.
        assert (cosine, sine) == pytest.approx(expected, abs=2 * (rate * found["dt"]) ** 2)
        # The spin lags by one step: one kick of the couple, M dt / (m L^2), and centrifugal terms.
        kick = found["moment"] * found["dt"] / (0.02 * 0.25)
        assert spin == pytest.approx(rate, rel=2e-4, abs=2 * kick)
        turned = max(turned, abs(s))
    assert turned > 0.9


def test_cables_pull_by_turns_and_never_push(seen):
    for run in (*seen["cables"], *seen["damped cables"]):
        assert run["least"] == 0 and min(run["most"]) > 100
        assert not run["both"] and run["neither"] > 0.2 and run["corners"] >= 6
    for run in seen["cables"]:
        # Kinetic energy in flight is that of the spring at its longest.
        assert run["most"] == pytest.approx([sqrt(2 * run["first"] * run["stiffness"])] * 2, rel=1e-3)
        # Where a cable becomes taut or slack within a step of ds, the trapezoidal rule misses k ds^2 / 8 at most.
        assert run["worst"] <= run["corners"] * run["stiffness"] * (5 * run["dt"]) ** 2 / 8
    coarse, fine = seen["damped cables"]
    assert fine["damped"] > 0.05 * fine["first"]
    # First order: a dashpot does its work with the velocity half a step late.
    assert fine["worst"] < 0.7 * coarse["worst"] < 0.02 * coarse["first"]
