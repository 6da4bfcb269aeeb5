# SPDX-License-Identifier: GPL-3.0-or-later
"""No run continues with an invalid number: the first step that would use it ends with a message. The JointStepper ends
at the same step with the same message."""
import re
from math import pi, sin

import pytest

START, BETWEEN, WITHIN = 0, 50, 60

# The number that is none, and the part that the plugin names.
FAULTS = {
    "dt nan": "O.dt = nan (scene)",
    "dt inf": "O.dt = inf (scene)",
    "dt zero": "O.dt = 0 (scene)",
    "permanent force": "permanent force = (nan, 0, 0) (body 1)",
    "permanent torque": "permanent torque = (0, 0, inf) (body 1)",
    "position": r"position = \((nan, \S+|\S+, nan), 0\) \(body 1\)",
    "position of the bearing": "position = (0, inf, 0) (body 2)",
    "position of a link's root": "position = (0, nan, 0) (body 0)",
    "velocity": r"velocity = \(\S+, nan, 0\) \(body 1\)",
    "angular velocity": "angular velocity = (0, 0, nan) (body 1)",
    "orientation": "norm of the orientation = nan (body 1)",
    "mass zero": "mass = 0 (body 1)",
    "mass nan": "mass = nan (body 1)",
    "mass negative": "mass = -0.02 (body 1)",
    "mass of a link's tip": "mass = nan (body 4)",
    "inertia zero": "moment of inertia = (1e-06, 1e-06, 0) (body 1)",
    "inertia nan": "moment of inertia = (1e-06, 1e-06, nan) (body 1)",
    "expansion of a material": "ThermalFrictMat.thermalExpansion = nan (body 1)",
    "link": "ThermalLink.thermalExpansion = nan (link 0 1)",
    "link's damping": "ThermalLink.pinDamping = nan (link 3 4)",
    "link's stiffness": "ThermalLink.youngModulus = nan (link 0 1)",
    "spring": "TorsionSpring.stiffness = nan (torsion_spring 1 4)",
    "spring's angle": "TorsionSpring.freeAngle = nan (torsion_spring 1 4)",
    "spring's friction": "TorsionSpring.frictionStiffness = nan (torsion_spring 1 4)",
    "spring's friction without stiffness": "TorsionSpring.frictionStiffness = 0 (torsion_spring 1 4)",
    "spring's slip": "TorsionSpring.slipAngle = nan (torsion_spring 1 4)",
    "young": "ThermalFrictMat.young = nan (body 1)",
    "poisson": "ThermalFrictMat.poisson = nan (body 1)",
    "friction angle": "ThermalFrictMat.frictionAngle = nan (body 1)",
    "friction nan": "JointPhys.tangensOfFrictionAngle = nan (contact 1 2)",
    "friction negative": "JointPhys.tangensOfFrictionAngle = -0.1 (contact 1 2)",
    "modulus nan": "JointPhys.effectiveYoungModulus = nan (contact 1 2)",
    "modulus negative": "JointPhys.effectiveYoungModulus = -1e+10 (contact 1 2)",
    "shear modulus": "JointPhys.effectiveShearModulus = nan (contact 1 2)",
    "mass": "JointPhys.effectiveMass = nan (contact 1 2)",
    "normal damping": "JointPhys.normalDampingRatio = nan (contact 1 2)",
    "tangential damping": "JointPhys.tangentialDampingRatio = nan (contact 1 2)",
    "kept force": r"force = \(\S+, \S+, \S+\) \(contact 1 2\)",
}
AT_START = [name for name in FAULTS if "contact" not in FAULTS[name]]


def part_of(name):
    """Return a fixture that runs a part of the script once and gives its result."""
    @pytest.fixture(scope="module", name=name)
    def found(run_script):
        return run_script("silence.py", name)
    return found


at_start, between, within, kept, by_name = map(part_of, ("at_start", "between", "within", "kept", "by_name"))
bore = part_of("bore")
lengths, good, setters, without_our_engines = map(part_of, ("lengths", "good", "setters", "without_our_engines"))


def assert_said(found, name, steps):
    """Check that both loops end at the same step with the same message: quantity, body, time and temperature."""
    ordinary, stepper = found[name]
    assert stepper == ordinary
    assert_told(ordinary, name, steps)


def assert_told(found, name, steps):
    """Check the error at one of these steps: its quantity and part, and time and temperature in its message."""
    kind, text, step, fault, _ = found
    assert kind == "RuntimeError"
    wanted = f"{'law_not_finite' if name == 'kept force' else 'not_allowed'} {FAULTS[name]}"
    assert re.fullmatch(wanted if "\\" in wanted else re.escape(wanted), fault), fault
    place = r" \((contact of bodies 1 and 2, )?time \S+ s, temperature changes? \S+( K, \S+)* K\)$"
    assert re.search(place, text), text
    assert step in steps, text


@pytest.mark.parametrize("name", AT_START)
def test_first_step_is_not_made(at_start, name):
    assert_said(at_start, name, [START])


@pytest.mark.parametrize("name", [name for name in FAULTS if name != "kept force"])
def test_what_changes_between_runs_is_seen_before_it_is_used(between, name):
    assert_said(between, name, [BETWEEN])


@pytest.mark.parametrize("when, step", [("between", BETWEEN), ("within", WITHIN + 1)])
def test_force_that_is_kept_is_seen_in_its_step(kept, when, step):
    assert_said({"kept force": kept[when]}, "kept force", [step])


# Within a run: not used by a contact that is there, or seen when the next run begins.
LATER = ("mass negative", "young", "poisson", "friction angle", "shear modulus", "normal damping", "tangential damping")


@pytest.mark.parametrize("name", [name for name in FAULTS if name not in (*LATER, "kept force")])
def test_what_a_script_changes_within_a_run_is_seen_in_the_next_steps(within, name):
    # The change is made at the end of step 60; forces that are none move a body in the step after, and are seen there
    # where they are ours, else by what they have moved.
    assert_said(within, name, [WITHIN + 1, WITHIN + 2])


@pytest.mark.parametrize("law", ["johnson", "hertz_paper"])
@pytest.mark.parametrize("name", ["position", "modulus nan", "modulus negative", "friction nan"])
def test_laws_by_name(by_name, law, name):
    assert_said({name: by_name[f"{law} {name}"]}, name, [BETWEEN, WITHIN + 1])


@pytest.mark.parametrize("when, steps", [("start", [START]), ("between", [BETWEEN]), ("within", [WITHIN + 1, WITHIN + 2])])
def test_bore_of_triangles_asks_the_same(bore, when, steps):
    assert bore["good"] == 2 * [["none", "", 200, "", None]]
    names = [name for name in bore[when] if when != "within" or name not in LATER]
    assert len(names) == {"start": 19, "between": 27, "within": 20}[when]
    for name in names:
        # No link looks at the velocity before it has moved the body.
        seen = "position" if when == "within" and name == "velocity" else name
        ordinary, stepper = bore[when][name]
        assert stepper == ordinary, name
        assert_told(ordinary, seen, steps)


def test_temperature_leaves_a_body_its_length(lengths):
    ordinary, stepper = lengths["body"]
    assert stepper == ordinary
    # At the instant: the first of 1e-7 s after 30 K sin(pi t/20 us) has passed 10 K, at 2.163 us.
    fault, time_s = ordinary[3:]
    assert ordinary[2] == 22 and time_s == pytest.approx(2.2e-6)
    assert fault.startswith("no_length thermal strain = ") and fault.endswith(" (body 1)")
    strain = float(fault.split()[4])
    assert strain == pytest.approx(-0.1 * 30 * sin(pi * time_s / 20e-6), rel=1e-8) and strain < -1


@pytest.mark.parametrize("name, step", [("link", 22), ("link that falls", 3)])
def test_temperature_leaves_a_link_its_length(lengths, name, step):
    ordinary, stepper = lengths[name]
    assert stepper == ordinary
    fault = ordinary[3]
    assert fault.startswith("no_length stress-free length = ") and fault.endswith(" (link 0 1)")
    assert float(fault.split()[4]) <= 0
    assert ordinary[2] == step  # 1 K at 0.212 us


@pytest.mark.parametrize("name", ["joint", "fixed", "by name", "hot"])
def test_what_is_right_runs(good, name):
    for found in good[name]:
        assert found == ["none", "", 200, "", None]


def test_setters_refuse(setters):
    assert len(setters) == 27
    for name, (kind, text, kept) in setters.items():
        assert kind == "ValueError" and kept, name
        attribute = name.split(" = ")[0].replace("Journal.thermal", "ThermalShape.thermal")
        assert text.startswith(f"not_allowed {attribute} = "), text


@pytest.mark.parametrize("name", ["position", "dt zero", "modulus nan", "friction nan"])
def test_scene_without_our_engines_ends(without_our_engines, name):
    kind, _, step = without_our_engines[name]
    assert (kind, step) == ("none", 22)  # after the step, and the one that go() makes
