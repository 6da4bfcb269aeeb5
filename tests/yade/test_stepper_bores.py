# SPDX-License-Identifier: GPL-3.0-or-later
"""JointStepper in bores of triangles: same steps as YADE's loop, bit for bit, and the same messages of failures."""
import pytest

SCENES = [
    "lobed", "lobed_without_energy", "lobed_round", "lobed_searching", "lobed_in_pieces", "lobed_every_step", "lobed_saved",
    "sliding", "leaving", "wedged", "wedged_saved", "free_bore", "free_bore_saved", "free_bore_recorded", "ball_in_cup",
    "ball_in_cup_saved", "ball_in_bore", "bumps", "crowd", "crowd_in_parts", "crowd_erased",
]


@pytest.fixture(scope="module")
def scenes(run_script):
    return run_script("stepper_bores.py", "scenes")


@pytest.fixture(scope="module")
def laws(run_script):
    return run_script("stepper_bores.py", "laws")


@pytest.fixture(scope="module")
def failures(run_script):
    return run_script("stepper_bores.py", "failures")


def test_every_scene_is_there(scenes):
    assert sorted(scenes) == sorted(SCENES)


@pytest.mark.parametrize("name", SCENES)
def test_same_state_bit_for_bit(scenes, name):
    # Positions, velocities, orientations, forces, each contact's geometry and physics, what is known of the wall,
    # energies, bounds, laws, recorded rows; no tolerance.
    assert scenes[name]["differences"] == []


@pytest.mark.parametrize("name", [name for name in SCENES if name not in ("lobed_every_step", "leaving")])
def test_most_steps_are_the_steppers(scenes, name):
    assert scenes[name]["made_by_yade"] < 0.03 * scenes[name]["steps"]


def test_scenes_have_what_is_compared(scenes):
    # Contacts that begin again and again; several at once; every energy; the other law beside.
    assert scenes["lobed"]["began"] > 3 and scenes["bumps"]["began"] > 1 and scenes["ball_in_cup"]["began"] > 1
    assert scenes["sliding"]["facets"] > 2 and scenes["leaving"]["began"] > scenes["leaving"]["touching"] == 0
    assert scenes["wedged"]["began"] >= 2 and scenes["wedged"]["largest"] == 2
    assert scenes["crowd"]["touching"] > 10 and scenes["crowd"]["began"] > 60
    assert scenes["free_bore"]["began"] > 1 and scenes["free_bore"]["law"][1] > 1
    for name in ("wedged_saved", "free_bore_saved"):
        assert scenes[name]["touching"] > 0
    for name in ("jointFriction", "jointDamping", "jointThermalWork", "linkDamping", "linkThermalWork"):
        assert scenes["free_bore"]["energy"][name] != 0, name


def test_every_law_bit_for_bit(laws):
    assert len(laws) >= 14
    for name, found in laws.items():
        assert found["differences"] == [], name
        assert found["began"] > 0, name
        assert found["made_by_yade"] < 0.03 * found["steps"], name


@pytest.mark.parametrize("name, fault", [
    ("closing", "wall_conforms radius of curvature = "), ("too_deep", "time_step_unstable O.dt = 3e-05 "),
    ("parting", "law_left_range johnson = "), ("bulging", "law_for_flat_walls normalLaw = johnson "),
    ("tilting", "tilted maxTilt "),
])
def test_failure_is_that_of_the_ordinary_loop(failures, name, fault):
    # Class, sentence with bodies, time and temperature, step, time, time of the failure, fault.
    ordinary, stepper = failures[name]
    assert stepper == ordinary
    assert ordinary[0] == "RuntimeError"
    assert ordinary[5].startswith(fault) and ordinary[5].endswith("(contact 0 1)")
    assert ordinary[2] > 10, "not in the first steps, which are YADE's"


def test_parts_beside_each_other_are_equal(run_script):
    one, two = (run_script("stepper_bores.py", "parts", threads=threads) for threads in (1, 2))
    assert one == two and one["touching"] > 10
