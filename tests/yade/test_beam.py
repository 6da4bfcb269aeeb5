# SPDX-License-Identifier: GPL-3.0-or-later
"""Beams between bodies: stable step, momentum and energy, saving in mid run, messages."""
import pytest
from conftest import EPS


@pytest.fixture(scope="module")
def seen(run_script, tmp_path_factory):
    return run_script("beam.py", str(tmp_path_factory.mktemp("beam")))


def test_stable_step_is_that_of_the_highest_frequency(seen):
    for name, run in seen["frequency"].items():
        # The bound of a body assumes an equal motion of the other end. A single beam at a support has none.
        assert (0.7 if name == "one" else 0.9) < run["ratio"] <= 1 + 1e-6, (name, run)


def test_free_swing_keeps_momentum_and_energy(seen):
    coarse, fine = seen["swing"]
    assert coarse["elastic"] > 0.05
    for run in (coarse, fine):
        # Of velocities of order 1 m/s, in 400 and 800 steps.
        assert run["momentum"] < 800 * EPS * 2
    # Leapfrog is of second order.
    assert fine["energy"] < 0.35 * coarse["energy"]
    assert fine["moment"] < 0.35 * coarse["moment"] + 800 * EPS


@pytest.mark.parametrize("file", ["beam.yade", "beam.xml"])
def test_saved_run_continues_bit_for_bit(seen, file):
    assert seen["saved"][file] == seen["saved"]["straight"]
    energy = seen["saved"]["straight"]["energy"]
    assert energy["beamElastic"] > 0 and energy["beamDamping"] > 0 and energy["beamThermalWork"] != 0


def test_messages(seen):
    codes = {name: one["code"] for name, one in seen["messages"].items()}
    assert codes == {"step": "time_step_unstable", "program": "missing", "axis": "not_allowed",
                     "release": "not_allowed", "rotation": "beam_rotation", "mass": "not_allowed",
                     "inertia": "not_allowed", "stepper": "unknown_engine"}
