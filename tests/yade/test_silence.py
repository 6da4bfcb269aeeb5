# SPDX-License-Identifier: GPL-3.0-or-later
"""No run goes on with a number that is none: the first step that would use it ends with a sentence, the JointStepper at
the same step with the same one."""
import re

import pytest

START, BETWEEN, WITHIN = 0, 50, 60

# The sentence, before the time; bodies that the plugin names.
SENTENCES = {
    "dt nan": ("the time step O.dt is nan s, allowed is above 0", []),
    "dt inf": ("the time step O.dt is inf s, allowed is above 0", []),
    "dt zero": ("the time step O.dt is 0 s, allowed is above 0", []),
    "permanent force": ("the permanent force of body 1 is (nan, 0, 0) N, allowed is finite", [1]),
    "permanent torque": ("the permanent torque of body 1 is (0, 0, inf) N m, allowed is finite", [1]),
    "position": (r"the position of body 1 is \((nan, \S+|\S+, nan), 0\) m, allowed is finite", [1]),
    "position of the bearing": (r"the position of body 2 is \(0, inf, 0\) m, allowed is finite", [2]),
    "position of a link's root": (r"the position of body 0 is \(0, nan, 0\) m, allowed is finite", [0]),
    "velocity": (r"the velocity of body 1 is \(\S+, nan, 0\) m/s, allowed is finite", [1]),
    "angular velocity": (r"the angular velocity of body 1 is \(0, 0, nan\) rad/s, allowed is finite", [1]),
    "orientation": ("the norm of the orientation of body 1 is nan, allowed is above 0", [1]),
    "mass zero": ("the mass of body 1 is 0 kg, allowed is above 0", [1]),
    "mass nan": ("the mass of body 1 is nan kg, allowed is above 0", [1]),
    "mass negative": ("the mass of body 1 is -0.02 kg, allowed is above 0", [1]),
    "mass of a link's tip": ("the mass of body 4 is nan kg, allowed is above 0", [4]),
    "inertia zero": ("the moment of inertia of body 1 is (1e-06, 1e-06, 0) kg m2, allowed is above 0", [1]),
    "inertia nan": ("the moment of inertia of body 1 is (1e-06, 1e-06, nan) kg m2, allowed is above 0", [1]),
    "expansion of a material": ("ThermalFrictMat.thermalExpansion of body 1 is nan, allowed is finite [1/K]", [1]),
    "link": ("ThermalLink.thermalExpansion of the link between bodies 0 and 1 is nan 1/K, allowed is finite", [0, 1]),
    "link's damping": (
        "ThermalLink.pinDamping of the link between bodies 3 and 4 is nan N m s/rad, allowed is 0 or above", [3, 4]),
    "link's stiffness": (
        "ThermalLink.youngModulus of the link between bodies 0 and 1 is nan Pa, allowed is 0 or above", [0, 1]),
    "spring": ("TorsionSpring.stiffness of the torsion spring between the links of bodies 1 and 4 is nan N m/rad, "
               "allowed is 0 or above", [1, 4]),
    "spring's angle": ("TorsionSpring.freeAngle of the torsion spring between the links of bodies 1 and 4 is nan rad, "
                       "allowed is finite", [1, 4]),
    "spring's friction": ("TorsionSpring.frictionStiffness of the torsion spring between the links of bodies 1 and 4 is "
                          "nan N m/rad, allowed is 0 or above", [1, 4]),
    "spring's friction without stiffness": (
        "TorsionSpring.frictionStiffness of the torsion spring between the links of bodies 1 and 4 is 0 N m/rad, allowed "
        "is above 0 with a frictionLimit", [1, 4]),
    "spring's slip": ("TorsionSpring.slipAngle of the torsion spring between the links of bodies 1 and 4 is nan rad, "
                      "allowed is finite", [1, 4]),
    "young": ("ThermalFrictMat.young of body 1 is nan, allowed is (0, inf] Pa", [1]),
    "poisson": ("ThermalFrictMat.poisson of body 1 is nan, allowed is (-1, 0.5]", [1]),
    "friction angle": ("ThermalFrictMat.frictionAngle of body 1 is nan, allowed is [0, pi/2) rad", [1]),
    "friction nan": ("JointPhys.tangensOfFrictionAngle is nan -, allowed is 0 or above", [1, 2]),
    "friction negative": ("JointPhys.tangensOfFrictionAngle is -0.1 -, allowed is 0 or above", [1, 2]),
    "modulus nan": ("JointPhys.effectiveYoungModulus is nan Pa, allowed is above 0", [1, 2]),
    "modulus negative": ("JointPhys.effectiveYoungModulus is -1e+10 Pa, allowed is above 0", [1, 2]),
    "shear modulus": ("JointPhys.effectiveShearModulus is nan Pa, allowed is above 0", [1, 2]),
    "mass": ("JointPhys.effectiveMass is nan kg, allowed is 0 or above", [1, 2]),
    "normal damping": ("JointPhys.normalDampingRatio is nan -, allowed is 0 or above", [1, 2]),
    "tangential damping": ("JointPhys.tangentialDampingRatio is nan -, allowed is 0 or above", [1, 2]),
    "kept force": (r"the law answers with a normal stiffness of \S+ N/m and a force of \(\S+, \S+, \S+\) N, allowed is "
                   "finite", [1, 2]),
}
AT_START = [name for name in SENTENCES if SENTENCES[name][1] != [1, 2]]


def part_of(name):
    """Return a fixture: what a part of the script found, or that it failed, once."""
    @pytest.fixture(scope="module", name=name)
    def found(run_script):
        return run_script("silence.py", name)
    return found


at_start, between, within, kept, by_name = map(part_of, ("at_start", "between", "within", "kept", "by_name"))
bore = part_of("bore")
lengths, good, setters, without_our_engines = map(part_of, ("lengths", "good", "setters", "without_our_engines"))


def assert_said(found, name, steps):
    """Same words at the same step both ways: the quantity, its body, the time and the temperature."""
    ordinary, stepper = found[name]
    assert stepper == ordinary
    assert_told(ordinary, *SENTENCES[name], steps)


def assert_told(found, wanted, named, steps):
    """One sentence with the quantity, its body, the time and the temperature, at one of these steps."""
    kind, text, step, part, bodies = found
    assert kind == "RuntimeError"
    pattern = wanted if "\\" in wanted else re.escape(wanted)
    assert re.match(pattern, text), text
    place = r" \((contact of bodies 1 and 2, )?time \S+ s, temperature changes? \S+( K, \S+)* K\)$"
    assert re.search(place, text), text
    assert bodies == named
    assert step in steps, text


@pytest.mark.parametrize("name", AT_START)
def test_first_step_is_not_made(at_start, name):
    assert_said(at_start, name, [START])


@pytest.mark.parametrize("name", [name for name in SENTENCES if name != "kept force"])
def test_what_changes_between_runs_is_seen_before_it_is_used(between, name):
    assert_said(between, name, [BETWEEN])


@pytest.mark.parametrize("when, step", [("between", BETWEEN), ("within", WITHIN + 1)])
def test_force_that_is_kept_is_seen_in_its_step(kept, when, step):
    assert_said({"kept force": kept[when]}, "kept force", [step])


# Within a run: not used by a contact that is there, or seen when the next run begins.
LATER = ("mass negative", "young", "poisson", "friction angle", "shear modulus", "normal damping", "tangential damping")


@pytest.mark.parametrize("name", [name for name in SENTENCES if name not in (*LATER, "kept force")])
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
    assert bore["good"] == 2 * [["none", "", 200, None, None]]
    names = [name for name in bore[when] if when != "within" or name not in LATER]
    assert len(names) == {"start": 19, "between": 27, "within": 20}[when]
    for name in names:
        # No link looks at the velocity before it has moved the body.
        seen = "position" if when == "within" and name == "velocity" else name
        ordinary, stepper = bore[when][name]
        assert stepper == ordinary, name
        assert_told(ordinary, *SENTENCES[seen], steps)


def test_temperature_leaves_a_body_its_length(lengths):
    ordinary, stepper = lengths["body"]
    assert stepper == ordinary
    said = re.match(r"the thermal strain of body 1 is (\S+), allowed is above -1, with thermalExpansion -0.1 1/K \(time "
                    r"(\S+) s, temperature change (\S+) K\)$", ordinary[1])
    # At the instant: the first of 1e-7 s after 30 K sin(pi t/20 us) has passed 10 K, at 2.163 us.
    assert said and ordinary[2] == 22 and float(said[2]) == pytest.approx(2.2e-6)
    assert float(said[1]) == pytest.approx(-0.1 * float(said[3])) and float(said[1]) < -1


@pytest.mark.parametrize("name, expansion, step", [("link", -0.1, 22), ("link that falls", -1.0, 3)])
def test_temperature_leaves_a_link_its_length(lengths, name, expansion, step):
    ordinary, stepper = lengths[name]
    assert stepper == ordinary
    said = re.match(r"the stress-free length is (\S+) m, allowed is above 0, with thermalExpansion (\S+) 1/K of the link "
                    r"between bodies 0 and 1 \(time", ordinary[1])
    assert said and float(said[1]) <= 0 and float(said[2]) == expansion
    assert ordinary[2] == step  # 1 K at 0.212 us


@pytest.mark.parametrize("name", ["joint", "fixed", "by name", "hot"])
def test_what_is_right_runs(good, name):
    for found in good[name]:
        assert found == ["none", "", 200, None, None]


def test_setters_refuse(setters):
    assert len(setters) == 27
    for name, (kind, text, kept) in setters.items():
        assert kind == "ValueError" and kept, name
        attribute = name.split(" = ")[0].replace("Journal.thermal", "ThermalShape.thermal")
        assert text.startswith(f"{attribute} = ") and " is not allowed: must be " in text, text


@pytest.mark.parametrize("name", ["position", "dt zero", "modulus nan", "friction nan"])
def test_scene_without_our_engines_ends(without_our_engines, name):
    kind, _, step = without_our_engines[name]
    assert (kind, step) == ("none", 22)  # after the step, and the one that go() makes
