# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of a joint chosen by name: the catalogue inside YADE."""
from math import e, inf, isnan, log, log1p, pi, sqrt

import pytest

from conftest import E_STAR, EPS

LAWS = ["hertz_paper", "hertz_internal", "johnson", "esdu_78035", "persson"]


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("joint_law.py")


def root_of(function, low, high):
    """Root of a function with one sign change, by bisection to the last bit."""
    rising = function(high) > 0
    for _ in range(200):
        middle = 0.5 * (low + high)
        if (function(middle) > 0) == rising:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


def test_defaults_and_names(seen):
    defaults = dict(seen["defaults"])
    assert isnan(defaults.pop("firstContactTime"))
    assert defaults == {
        "normalLaw": "hertz_internal", "dissipationLaw": "none", "frictionLaw": "mindlin",
        "tangentialVelocity": "material", "restitution": 1.0, "smallestImpactSpeed": 1e-6,
        "contactLength": 0.01, "v0": 0.0, "v1": 1e-3, "contacts": 0,
        "label": "",
    }
    assert len(seen["accepted"]) == 16
    for _, name, kept in seen["accepted"]:
        assert kept == name
    assert seen["both"] == [0.5, 2.0]


@pytest.mark.parametrize(
    ("attribute", "value"),
    [
        ("normalLaw", "'jonson'"),
        ("dissipationLaw", "'jonson'"),
        ("frictionLaw", "'jonson'"),
        ("tangentialVelocity", "'jonson'"),
        ("restitution", "0"),
        ("restitution above 1", "1.0001"),
        ("smallestImpactSpeed", "0"),
        ("contactLength", "nan"),
        ("v0", "-1."),
        ("v1", "0"),
    ],
)
def test_wrong_names_and_values_are_refused(seen, attribute, value):
    name = attribute.split()[0]
    for kind, text in seen["refused"][attribute]:
        assert kind == "ValueError"
        assert text.startswith(f"not_allowed Law2_JointGeom_JointPhys_JointLaw.{name} = {value}")
    assert seen["kept"][name] == seen["defaults"][name]


def test_default_laws_are_hertz_mindlin(seen):
    plain, by_name = seen["same"]
    slipped, stuck, apart = 0, 0, 0
    # Both round differently, most in k_t, by a few EPS; the motion is damped and does not amplify
    # it. What differs at one step is some 100 EPS of a force of 100 N, 1e-12 N, over 6000 steps of
    # 2.5e-7 s on 0.02 kg: below 1e-13 m/s, and 1e-16 m.
    tolerances = {"position": 1e-16, "velocity": 1e-12, "spin": 1e-10, "force": 1e-9, "torque": 1e-11,
                  "spring": 1e-9}
    for one, two in zip(plain, by_name):
        assert one["slipping"] == two["slipping"]
        apart += one["slipping"] is None
        slipped += one["slipping"] is True
        stuck += one["slipping"] is False
        for key, tolerance in tolerances.items():
            assert two[key] == (one[key] and pytest.approx(one[key], rel=0, abs=tolerance)), key
        if one["stiffness"]:
            assert two["stiffness"] == pytest.approx(one["stiffness"], rel=1e-12)
        for name, value in one["energies"].items():
            # The work of the changing radii is a central difference, exact to 1e-9 of it.
            accuracy = 1e-9 if name == "jointThermalWork" else 1e-12
            assert two["energies"][name] == pytest.approx(value, rel=0, abs=accuracy * 3e-4), name
    assert slipped >= 3 and stuck >= 20 and apart >= 5
    for name in ("jointFriction", "jointDamping", "jointThermalWork"):
        assert max(row["energies"][name] for row in plain) > 1e-4, name


def normal_law(name, depth, r1, r2, length=0.01):
    """Force [N] and stiffness [N/m] from the printed formulas."""
    clearance = r2 - r1
    if name.startswith("hertz"):
        radius = r1 * r2 / (r2 + r1 if name == "hertz_paper" else clearance)
        force = 4 / 3 * E_STAR * sqrt(radius) * depth**1.5
        return force, 1.5 * force / depth
    if name == "persson":
        def at(t):
            x = 2 - log1p(t) - 2 * t * t
            n = 2 + 5 * t + 2 * t * t - (1 + 2 * t) * log1p(t)
            offset = (3 * t - 2 * t / (1 + t) - 2 * t * t + (1 + 2 * t) * log1p(t)) / n
            c = (
                log(4 * (1 + t) / t) - 2 - offset / 2
                + t * (2 + 2.5 * t + (1 + 2 * t) * x / n) / (1 + t) ** 2
                + (1 + 2 * t) ** 2 * log1p(t) / ((1 + t) * n)
            )
            load = 2 * pi * t * (1 + t) / x  # f/(E* dR)
            return load, c, c * load / pi + offset

        t = root_of(lambda t: at(t)[2] - depth / clearance, 1e-9, 0.83)
        load, c, _ = at(t)
        return load * E_STAR * clearance * length, pi * E_STAR * length / c
    sign = {"johnson": -1, "esdu_78035": 1}[name]
    modulus = pi * E_STAR

    def depth_of(line_force):
        return line_force / modulus * (log(4 * modulus * clearance / line_force) + sign)

    turning = 4 * modulus * clearance * e ** (sign - 1)
    line_force = root_of(lambda f: depth_of(f) - depth, 1e-6 * turning, turning)
    compliance = (log(4 * modulus * clearance / line_force) + sign - 1) / modulus
    return line_force * length, length / compliance


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("case", ["force", "hot"])
def test_normal_law_gives_its_formula(seen, case, name):
    found = seen[case][name]
    # 60 K and 20e-6/K on the bearing alone.
    radii = [5e-3, 5.1e-3 * (1 + (0.0012 if case == "hot" else 0.0))]
    assert found["radii"] == pytest.approx(radii, rel=4 * EPS)
    force, stiffness = normal_law(name, 1.1e-4 - (radii[1] - radii[0]), *radii)
    # The depth, 4e-6 m and more, is what is left of radii of 5e-3 m: rounded to 8e-19/4e-6 of it,
    # thrice in a force, and again in the root that is expected here.
    assert found["force"] == pytest.approx(force, rel=3e-12)
    assert found["kn"] == pytest.approx(stiffness, rel=1e-11)
    assert found["on_bearing"] == found["force"]
    assert 0 < found["energy"] < force * found["depth"] / 2


def test_ambrosio_creeps_and_mindlin_holds(seen):
    creeping, holding = seen["floor"]["ambrosio"], seen["floor"]["mindlin"]
    # Steady: mu F_N (v - v0)/(v1 - v0) = T. The approach to it decays with c/m = 3.75e5/s.
    speed = 2e-4 + (1e-3 - 2e-4) * 20 / (0.3 * 100)
    # F_N itself rests to its rounding: depth 1e-6 of a position 0.02 m, 3.5e-18/1e-6, 1.5 times.
    assert creeping["speed"] == pytest.approx(speed, rel=1e-11)
    assert creeping["moved"] == pytest.approx(speed * creeping["seconds"], rel=1e-11)
    assert creeping["dissipated"] == pytest.approx(20 * creeping["moved"], rel=1e-11)
    assert abs(holding["speed"]) < 1e-12
    assert abs(holding["moved"]) < 1e-13
    # A regularised friction is a damper c = mu F_N/(v1 - v0), and an explicit step must resolve it:
    # 2 m / c, of which the promise, with twice the damping, is half and a little less.
    limit = 2 * creeping["mass"] / (0.3 * 100 / 8e-4)
    assert 0.4 * limit < creeping["stable"] < 0.5 * limit
    assert holding["stable"] > 5 * limit
    assert creeping["ks"] == 0 < holding["ks"]
    assert creeping["radii"] == [0.02, inf]


def ratio_of(name, restitution):
    """a = chi v0 / K of the laws."""
    return {
        "none": 0.0,
        "lankarani_nikravesh": 0.75 * (1 - restitution**2),
        "hunt_crossley": 1.5 * (1 - restitution),
        "flores": 1.6 * (1 - restitution) / restitution,
        # the root of true_restitution(a) = restitution
        "exact_restitution": root_of(lambda a: restitution - true_restitution(a), 1e-6, 0.999999 / restitution),
    }[name]


def true_restitution(a):
    """Restitution e' that solves a - ln(1 + a) = -a e' - ln(1 - a e')."""
    if a == 0:
        return 1.0
    lost = a - log1p(a)
    return root_of(lambda x: -a * x - log1p(-a * x) - lost, 0.0, min(1.0, (1 - 1e-12) / a))


@pytest.mark.parametrize("restitution", [0.3, 0.9])
@pytest.mark.parametrize("name", ["none", "lankarani_nikravesh", "hunt_crossley", "flores", "exact_restitution"])
def test_restitution_of_a_free_impact(seen, name, restitution):
    a = ratio_of(name, restitution)
    expected = true_restitution(a)
    for run in seen["impact"][f"{name} {restitution}"]:
        assert run["impact_speed"] == pytest.approx(0.1, rel=1e-6)
        assert run["contacts"] == 2
        # Contact of 7e-5 s in steps of 4e-8 s: (5.7e-4)^2 = 3e-7.
        assert -run["speed"] / 0.1 == pytest.approx(expected, abs=3e-7)
        # The account takes the velocity half a step late: first order, 5.7e-4, and more where a
        # strong damper changes the velocity fast.
        lost = run["energy"] * (1 - expected**2)
        assert run["damping"] == pytest.approx(lost, rel=5.7e-4 * (1 + a), abs=0)
    assert (name == "none") == (expected == 1)


def test_restitution_does_not_depend_on_the_normal_law(seen):
    expected = true_restitution(ratio_of("flores", 0.7))
    for run in seen["persson_impact"]:
        # Stiffer: 1.5e-5 s of contact, (2.7e-3)^2.
        assert -run["speed"] / 0.1 == pytest.approx(expected, abs=7e-6)


def test_energy_closes_with_any_laws(seen):
    # Damping does its work with the velocity half a step late: first order. Were the wrench not the
    # transpose of the velocity that friction sees, the residue would not fall at all.
    runs = seen["cycle"]
    for coarse, fine in zip(runs, runs[1:]):
        assert 1.5 < coarse["worst"] / fine["worst"] < 3
    for name, least in (("jointDamping", 1e-2), ("jointFriction", 1e-6), ("jointThermalWork", 2e-4)):
        assert runs[-1]["energies"][name] > least
    assert runs[-1]["worst"] < 2e-3 * runs[-1]["energies"]["jointDamping"]


def test_energy_of_a_lossless_cycle_closes_to_second_order(seen):
    coarse, fine = seen["lossless"]
    for run in (coarse, fine):
        assert run["energies"]["jointFriction"] == run["energies"]["jointDamping"] == 0
    # Divided by 4 at least; the motion is chaotic, hence not exactly.
    assert 2.5 < coarse["worst"] / fine["worst"] < 16
    # Without the work of the changing radii 2.4e-4 J would be missing.
    assert fine["energies"]["jointThermalWork"] > 1e-4
    assert fine["worst"] < 2e-6


def test_first_contact_of_a_drifting_journal_is_exact(seen):
    for run in seen["drifting"]:
        assert isnan(run["before"][0]) and run["before"][1] == 0
        assert run["contacts"] == 1
        assert run["seen"] > 1.6e-3
        # 8e-5 m at 0.05 m/s. Position 1e-4 rounded in each step, over the speed; the clearance is
        # rounded as radii of 5e-3 m are.
        steps = 300
        assert run["time"] == pytest.approx(1.6e-3, abs=(steps * 1e-4 + 5e-3) * EPS / 0.05)


def test_first_contact_of_a_pulled_journal_is_of_second_order(seen):
    # 0.05 t + 25 t^2 = 8e-5; a parabola leaves its chord by a dt^2/8 at most.
    touched = (-0.05 + sqrt(0.05**2 + 4 * 25 * 8e-5)) / 50
    speed = 0.05 + 50 * touched
    for k, run in enumerate(seen["pulled"]):
        time_step = 1.1e-5 / 2**k
        bound = 50 * time_step**2 / 8 / speed
        assert abs(run["time"] - touched) < 1.01 * bound + 1e-14
        assert run["seen"] - touched > 0


def test_first_contact_by_expansion_alone(seen):
    # 0.9e-4 = R2 - R1 + (R2 a2 - R1 a1) dT with a1 = 20e-6/K, a2 = 10e-6/K and 1000 K/s.
    expected = 1e-5 / (5e-3 * 20e-6 - 5.1e-3 * 10e-6) / 1000
    # Radii of 5e-3 m are rounded to 9e-19 m; they close by 4.9e-5 m/s.
    assert seen["closing"] == pytest.approx(expected, abs=4e-18 / 4.9e-5)


def test_contact_from_the_start_and_many_contacts(seen, run_script):
    assert seen["touching"] == [0.0, 1]
    two = run_script("joint_law.py", threads=2)
    assert [seen["many"]["threads"], two["many"]["threads"]] == [1, 2]
    for found in (seen["many"], two["many"]):
        assert found["contacts"] == 40
        # The last of them started 3.9e-6 m closer. Positions of 2 m rounded in each of 1522 steps.
        expected = (8e-5 - 3.9e-6) / 0.05
        assert found["time"] == pytest.approx(expected, abs=1522 * 2 * EPS / 0.05)


@pytest.mark.parametrize(
    ("case", "fault"),
    [
        ("johnson", "law_left_range johnson = 6e-05"),
        ("esdu_78035", "law_left_range esdu_78035 = 0.00041"),
        ("persson", "law_left_range persson = 0.0051"),
        ("slider johnson", "law_needs_axis normalLaw, tangentialVelocity = johnson, material"),
        ("slider paper", "law_needs_axis normalLaw, tangentialVelocity = hertz_internal, paper"),
    ],
)
def test_outside_of_a_law_the_run_stops(seen, case, fault):
    kind, text, iteration = seen["failing"][case]
    assert (kind, text) == ("RuntimeError", f"{fault} (contact 0 1)")
    assert iteration <= 1


def test_within_the_range_the_run_goes_on(seen):
    for case in ("slider hertz_paper", "inside"):
        assert seen["failing"][case] == ["none", "", 10]


def test_run_into_the_end_of_the_range_stops_there(seen):
    kind, text, iteration, depth = seen["to_the_end"]
    assert kind == "RuntimeError" and text.startswith("law_left_range johnson = 5.41")
    assert iteration == 3
    # 5.4e-5 m and 0.05 m/s: beyond 4 dR / e^2 = 5.41341e-5 m after 3 steps of 1e-6 s.
    assert 4e-4 / e**2 < depth < 4e-4 / e**2 + 0.05e-6
