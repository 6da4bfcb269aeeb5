# SPDX-License-Identifier: GPL-3.0-or-later
"""JointStepper: same steps as YADE's loop, bit for bit, and the same messages of failures."""
import pytest

SCENES = [
    "joint", "joint_without_energy", "joint_by_name", "joint_damped", "joint_in_gravity",
    "joint_in_undamped_gravity", "joint_in_damped_gravity", "ball", "balls", "balls_by_name", "balls_saved", "guided",
    "prismatic", "prismatic_saved", "approaching", "mixed",
    "mixed_by_name", "mixed_partial_slip", "mixed_every_step", "crowd", "crowd_with_energy", "in_pieces", "saved", "erased",
    "joint_recorded", "prismatic_recorded", "approaching_recorded", "mixed_by_name_recorded", "crowd_recorded",
    "mixed_saved_recorded",
]


@pytest.fixture(scope="module")
def scenes(run_script):
    return run_script("stepper.py", "scenes")


@pytest.fixture(scope="module")
def laws(run_script):
    return run_script("stepper.py", "laws")


@pytest.fixture(scope="module")
def recording(run_script):
    return run_script("stepper.py", "recording")


@pytest.fixture(scope="module")
def failures(run_script):
    return run_script("stepper.py", "failures")


@pytest.fixture(scope="module")
def wrong(run_script):
    return run_script("stepper.py", "wrong")


def test_every_scene_is_there(scenes):
    assert sorted(scenes) == sorted(SCENES)


@pytest.mark.parametrize("name", SCENES)
def test_same_state_bit_for_bit(scenes, name):
    # Positions, velocities, orientations, forces, contacts, links, springs, energies, bounds, laws, recorded rows; no
    # tolerance.
    assert scenes[name]["differences"] == []


@pytest.mark.parametrize("name", [name for name in SCENES if name != "mixed_every_step" and "approaching" not in name])
def test_most_steps_are_the_steppers(scenes, name):
    assert scenes[name]["made_by_yade"] < 0.03 * scenes[name]["steps"]


def test_steps_before_the_collider_looks_again_are_yades(scenes):
    # 4000 steps of 1e-6 s at 20 m/s are 80 mm, the collider looks every 0.1 mm: some 800 times, each after one step.
    assert 800 < scenes["approaching"]["made_by_yade"] < 2000


def test_scenes_have_what_is_compared(scenes):
    # Contacts that begin again and again, that stay, that slip; every energy.
    assert scenes["joint_by_name"]["law"][1] > 1
    assert scenes["balls_by_name"]["law"][1] >= 3  # ball on ball twice, ball on wall
    assert scenes["crowd"]["touching"] == 45 and scenes["mixed"]["touching"] == 4
    energy = {**scenes["mixed_by_name"]["energy"], **scenes["joint_damped"]["energy"]}
    for name in ("jointFriction", "jointDamping", "jointThermalWork", "linkDamping", "linkThermalWork", "pinDamping",
                 "torsionFriction", "nonviscDamp"):
        assert energy[name] != 0, name
    slid = scenes["prismatic"]["energy"]
    assert slid["prismaticFriction"] > 0 and slid["prismaticDamping"] > 0
    assert scenes["joint_in_gravity"]["energy"]["gravWork"] != 0


def test_recorder_keeps_what_a_script_reads(recording):
    # Time, energies, contacts, bodies, links, springs; by YADE's loop, to which the scenes compare the stepper's.
    assert len(recording["kept"]) == 72 and recording["after"] == 0
    assert recording["kept"] == recording["read"]
    assert len({row[16] for row in recording["kept"]}) > 1, "contacts begin and end"


def test_every_law_bit_for_bit(laws):
    assert len(laws) >= 14
    for name, found in laws.items():
        assert found["differences"] == [], name
        assert found["law"][1] > 0, name  # contacts have begun
        assert found["made_by_yade"] < 0.03 * found["steps"], name


@pytest.mark.parametrize("name, fault", [
    ("closing", "clearance_closed journal = "), ("too_deep", "time_step_unstable O.dt = 3e-05 "),
    ("parting", "law_left_range johnson = "),
])
def test_failure_is_that_of_the_ordinary_loop(failures, name, fault):
    # Class, sentence with bodies, time and temperature, step, time, time of the failure, fault.
    ordinary, stepper = failures[name]
    assert stepper == ordinary
    assert stepper[5].startswith(fault) and stepper[5].endswith("(contact 0 1)")


@pytest.mark.parametrize("name, fault", [
    ("sphere", "unknown_shape body 90 = Sphere"), ("two", "two_steppers JointStepper"),
    ("before_resetter", "misplaced_engine JointStepper"), ("last", "misplaced_engine ThermalExpansionEngine"),
    ("loop_first", "misplaced_engine ThermalExpansionEngine"),
    ("recorder_first", "misplaced_engine ThermalExpansionEngine"),
    ("recorded_body", "no_body StateRecorder.bodies = 400"), ("no_newton", "no_newton NewtonIntegrator"),
    ("unknown", "unknown_engine ForceEngine"), ("no_verlet", "no_verlet_distance InsertionSortCollider.verletDist"),
    ("periodic", "periodic O.periodic"), ("mask", "mask NewtonIntegrator.mask"),
    ("attribute", "not_allowed JointStepper.substeps = 0"),
])
def test_what_it_cannot_step_is_refused(wrong, name, fault):
    assert wrong[name] == fault


@pytest.mark.parametrize("fault", [
    "not_allowed StateRecorder.iterPeriod = 0", "odd_ids StateRecorder.contacts",
    "contact_twice StateRecorder.contacts = 2 and 1", "holds_none StateRecorder.links",
])
def test_wrong_attributes_of_the_recorder(wrong, fault):
    assert fault in wrong.values()


@pytest.mark.parametrize("name, value", [("zero", "0"), ("negative", "-3")])
def test_wrong_numbers_of_substeps(wrong, name, value):
    assert wrong[f"substeps {name}"] == ["ValueError", f"not_allowed JointStepper.substeps = {value}"]


@pytest.mark.parametrize("name, value", [("fraction", "1.5"), ("text", "'many'"), ("set", "2.5")])
def test_substeps_are_a_whole_number(wrong, name, value):
    assert wrong[f"substeps {name}"] == ["TypeError", f"wrong_type JointStepper.substeps = {value}"]
