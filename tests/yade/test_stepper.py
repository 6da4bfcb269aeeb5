# SPDX-License-Identifier: GPL-3.0-or-later
"""JointStepper: the same steps as YADE's loop makes, bit for bit, and the same words where something fails."""
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


@pytest.mark.parametrize("name, words", [
    ("closing", "the clearance is closed"), ("too_deep", "the time step 3e-05 s is above the stable one, "),
    ("parting", "johnson: penetration_depth"),
])
def test_failure_is_that_of_the_ordinary_loop(failures, name, words):
    # Class, sentence with bodies, time and temperature, step, time, time of the failure.
    ordinary, stepper = failures[name]
    assert stepper == ordinary
    assert words in stepper[1] and "bodies 0 and 1" in stepper[1]


ORDER = ("stands in the wrong place, the order is ForceResetter, JointStepper, ThermalExpansionEngine and "
         "InsertionSortCollider, InteractionLoop, ThermalLinks, TorsionSprings, PrismaticJoints and GuidePlanes, "
         "StateRecorder, NewtonIntegrator")


@pytest.mark.parametrize("name, sentence", [
    ("sphere", "JointStepper: it does not know the shape of body 90, Sphere"),
    ("two", "JointStepper: there are two of them"),
    ("before_resetter", "JointStepper: JointStepper " + ORDER),
    ("last", "JointStepper: ThermalExpansionEngine " + ORDER),
    ("loop_first", "JointStepper: ThermalExpansionEngine " + ORDER),
    ("recorder_first", "JointStepper: ThermalExpansionEngine " + ORDER),
    ("recorded_body", "StateRecorder.bodies: there is no body 400"),
    ("no_newton", "JointStepper: there is no NewtonIntegrator"),
    ("unknown", "JointStepper: it does not know the engine ForceEngine"),
    ("no_verlet", "JointStepper: InsertionSortCollider.verletDist must be above 0 [m]: without it the collider looks "
                  "for contacts in every step"),
    ("periodic", "JointStepper: the scene is periodic"),
    ("mask", "JointStepper: NewtonIntegrator.mask must be -1: every body moves"),
    ("attribute", "JointStepper.substeps = 0 is not allowed: must be 1 or above [-]"),
])
def test_what_it_cannot_step_is_refused(wrong, name, sentence):
    assert wrong[name] == sentence


@pytest.mark.parametrize("sentence", [
    "StateRecorder.iterPeriod = 0 is not allowed: must be 1 or above [-]",
    "StateRecorder.contacts holds an odd number of ids: two of each contact",
    "StateRecorder.contacts names bodies 2 and 1 twice", "StateRecorder.links holds None",
])
def test_wrong_attributes_of_the_recorder(wrong, sentence):
    assert sentence in wrong.values()


@pytest.mark.parametrize("name, value", [("zero", "0"), ("negative", "-3")])
def test_wrong_numbers_of_substeps(wrong, name, value):
    kind, text = wrong[f"substeps {name}"]
    assert kind == "ValueError"
    assert text == f"JointStepper.substeps = {value} is not allowed: must be 1 or above [-]"


@pytest.mark.parametrize("name, value", [("fraction", "1.5"), ("text", "'many'"), ("set", "2.5")])
def test_substeps_are_a_whole_number(wrong, name, value):
    assert wrong[f"substeps {name}"] == ["TypeError", f"JointStepper.substeps = {value} is not allowed: must be a whole number"]
