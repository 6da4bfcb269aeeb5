# SPDX-License-Identifier: GPL-3.0-or-later
"""Revolute joint in motion: energy, momentum and invariance under rotation."""
import pytest

from conftest import EPS


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("joint_dynamics.py")


def test_energy_of_a_lossless_thermal_cycle_closes_to_second_order(seen):
    # Links, contact and clearance change with temperature; trapezoidal works are of second order,
    # so halving the step divides the residue by 4. The motion is chaotic, hence not exactly.
    coarse, fine = seen["loop_lossless"]
    for run in (coarse, fine):
        assert run["energies"]["jointFriction"] == run["energies"]["jointDamping"] == 0
        assert run["energies"]["linkDamping"] == 0
        assert 0.05 < run["touched"] < 0.95
        assert abs(run["energies"]["linkThermalWork"]) > 1e-3
    assert coarse["worst"] < 2e-4 * coarse["energies"]["linkThermalWork"] * 2
    assert 2.5 < coarse["worst"] / fine["worst"] < 8


def test_energy_of_a_cycle_with_friction_and_damping_closes(seen):
    # Damping does its work with the velocity half a step late: first order in the step.
    coarse, middle, fine = seen["loop"]
    for run in (coarse, middle, fine):
        for name in ("jointFriction", "jointDamping", "linkDamping"):
            assert run["energies"][name] > 1e-4, name
        assert abs(run["energies"]["jointThermalWork"]) > 1e-5
        assert run["energies"]["jointElastic"] > 0
        assert run["energies"]["linkElastic"] > 0
    supplied = coarse["energies"]["linkThermalWork"]
    assert coarse["worst"] < 1e-3 * supplied
    assert 1.5 < coarse["worst"] / middle["worst"] < 3
    assert 1.5 < middle["worst"] / fine["worst"] < 3


def test_frictionless_bounce_conserves_energy_to_second_order(seen):
    bounces = seen["bounce"]
    for coarse, fine in zip(bounces, bounces[1:]):
        assert 3.6 < coarse["worst"] / fine["worst"] < 4.4
    assert bounces[-1]["worst"] < 1e-4 * bounces[-1]["energy"]
    # Speed after: same size, other direction; the energy error of 2.6e-5 gives 1.3e-5 at most.
    assert bounces[-1]["speed"] == pytest.approx(-0.1, rel=1.5e-5)
    # Hertz: 1/2 m v^2 = 2/5 K delta^2.5; the sampled maximum is within (pi/2 dt/duration)^2 of it.
    expected = (1e-4 / (0.4 * 2.589617e10)) ** 0.4
    assert bounces[-1]["depth"] == pytest.approx(expected, rel=1e-4)


def test_momentum_and_angular_momentum_of_two_free_bodies(seen):
    before, after = seen["momentum"]["before"], seen["momentum"]["after"]
    steps = seen["momentum"]["steps"]
    assert abs(seen["momentum"]["spin_change"]) > 1  # friction did exchange some
    assert seen["momentum"]["friction"] > 0
    # One rounding of each momentum per step.
    for k in range(2):
        assert after[k] == pytest.approx(before[k], abs=steps * EPS * 6e-3)
    assert after[2] == pytest.approx(before[2], abs=steps * EPS * before[3])


def test_turned_scene_moves_the_same(seen):
    # Rounding of a position at 0.04 m from the origin, 7e-18 m, in each of 4000 steps. Times the
    # contact stiffness 5e7 N/m that is a force; over the step 3e-7 s a change of velocity.
    steps = 4000
    position = steps * EPS * 0.04
    force = 5e7 * position
    velocity = steps * 5e7 * EPS * 0.04 / 0.02 * 3e-7
    spin = velocity * 0.02 * 5e-3 / 3e-7
    moved = 0.0
    for straight, turned in zip(seen["straight"], seen["turned"]):
        for found, expected, tolerance in zip(turned, straight, (position, velocity, spin, force)):
            assert found == pytest.approx(expected, rel=0, abs=tolerance)
        moved = max(moved, abs(straight[0][1] + 0.02))
    assert moved > 1e-5
