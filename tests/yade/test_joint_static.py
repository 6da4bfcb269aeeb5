# SPDX-License-Identifier: GPL-3.0-or-later
"""Revolute joint and slider (Table 2 of the paper) at prescribed positions, compared with closed forms."""
from math import sqrt

import pytest

from conftest import E_STAR, EPS, G_STAR

MU = 0.3
R1, R2 = 5e-3, 5.1e-3


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("joint_static.py")


def radii(seen, change):
    alpha_1, alpha_2 = seen["alphas"]
    return R1 * (1 + alpha_1 * change), R2 * (1 + alpha_2 * change)


def test_elastic_constants_of_table_2():
    # Seven printed digits.
    assert 4 / 3 * E_STAR * sqrt(R1 * R2 / (R2 - R1)) == pytest.approx(2.589617e10, rel=2e-7)
    assert G_STAR == pytest.approx(7.918552e9, rel=1e-7)


@pytest.mark.parametrize("change", [0.0, 50.0])
def test_force_indentation_curve(seen, change):
    r1, r2 = radii(seen, change)
    radius = r1 * r2 / (r2 - r1)
    stiffness = 4 / 3 * E_STAR * sqrt(radius)
    curve = seen["curves"][str(change)]
    assert curve["clearance"] == pytest.approx(r2 - r1, rel=1e-12)
    for row in curve["rows"]:
        depth = row["depth"]
        # The depth is a difference of radii: a few roundings of R2 against it; force ~ depth^1.5.
        tolerance = 1.5 * 4 * EPS * r2 / depth + 20 * EPS * r2 / (r2 - r1)
        force = stiffness * depth**1.5
        assert row["force"][0] == pytest.approx(-0.6 * force, rel=tolerance)
        assert row["force"][1] == pytest.approx(-0.8 * force, rel=tolerance)
        assert row["force"][2] == 0
        assert row["reaction"] == [-f for f in row["force"]]
        assert row["R"] == pytest.approx(radius, rel=20 * EPS * r2 / (r2 - r1))
        assert row["refR"] == pytest.approx([r1, r2], rel=4 * EPS)
        assert row["kn"] == pytest.approx(2 * E_STAR * sqrt(radius * depth), rel=tolerance)
        assert row["ks"] == pytest.approx(8 * G_STAR * sqrt(radius * depth), rel=tolerance)
    assert curve["gone"]


def test_printed_stiffness_of_table_2(seen):
    # K = 2.589617e10 N/m^1.5, given to seven digits.
    for row in seen["curves"]["0.0"]["rows"]:
        force = sqrt(sum(f * f for f in row["force"]))
        assert force / row["depth"] ** 1.5 == pytest.approx(2.589617e10, rel=2e-7)


def test_temperature_changes_clearance_and_stiffness(seen):
    # The journal expands more: the clearance shrinks by 2.7 %, the contact gets stiffer by 1.4 %.
    cold, warm = (seen["curves"][key] for key in ("0.0", "50.0"))
    assert warm["clearance"] / cold["clearance"] == pytest.approx(0.9721, abs=1e-4)
    ratio = warm["rows"][0]["kn"] / cold["rows"][0]["kn"]
    assert ratio == pytest.approx(1.0148, abs=5e-4)


@pytest.mark.parametrize("case", ["spinning", "spinning_swapped"])
def test_stick_slip_of_a_turning_journal(seen, case):
    found = seen[case]
    radius = R1 * R2 / (R2 - R1)
    normal = 4 / 3 * E_STAR * sqrt(radius) * found["depth"] ** 1.5
    shear = 8 * G_STAR * sqrt(radius * found["depth"])
    # Roundings of the depth (as above) and one per step of the sum of slides.
    tolerance = 1.5 * 4 * EPS * R2 / found["depth"] + 20 * EPS * R2 / (R2 - R1) + 120 * EPS
    limit = MU * normal
    force = 0.0
    slips = 0
    for i, (tangential, pressing, torque, reaction, slipping) in enumerate(found["rows"]):
        # Turning forwards moves the journal's surface at +x along +y, friction points to -y.
        slide = found["slide_per_step"] * (1 if i < 80 else -1)
        trial = force - shear * slide
        force = max(-limit, min(limit, trial))
        slips += abs(trial) > limit
        assert pressing == pytest.approx(normal, rel=tolerance)
        assert tangential == pytest.approx(force, abs=limit * tolerance * 4)
        assert torque == pytest.approx(found["arm"] * force, abs=limit * R1 * tolerance * 4)
        assert slipping == (abs(trial) > limit)
    assert 20 < slips < 100
    assert found["rows"][79][0] == pytest.approx(-limit, rel=tolerance)
    # id1 is the journal, whichever body came first.
    assert found["ids"][:2] == found["ids"][2:]


def test_order_of_bodies_does_not_matter(seen):
    assert seen["spinning"]["rows"] == seen["spinning_swapped"]["rows"]


def test_pulled_pad_sticks_then_slides(seen):
    found = seen["sliding_pad"]
    normal = 4 / 3 * E_STAR * sqrt(found["radius"]) * found["depth"] ** 1.5
    shear = 8 * G_STAR * sqrt(found["radius"] * found["depth"])
    tolerance = 1.5 * 4 * EPS * found["radius"] / found["depth"] + 150 * EPS
    reached = 0
    for i, (tangential, upwards) in enumerate(found["rows"]):
        expected = min(shear * found["slide_per_step"] * (i + 1), MU * normal)
        reached += expected == MU * normal
        assert upwards == pytest.approx(normal, rel=tolerance)
        assert tangential == pytest.approx(-expected, rel=tolerance)
    assert 20 < reached < 130


def test_static_load_is_held_without_creep(seen):
    found = seen["static"]
    # 20 000 steps at rest. Rounding of the depth (1e-18 of 1e-6 m) makes the stiffness flicker, and
    # each flicker may lose that fraction of the spring's stretch, 1e-7 m: 1e-15 m in all. A law
    # that creeps, v = v0 F/(mu F_N) with v0 = 1e-3 m/s, would move 1e-7 m.
    for before, after in zip(found["before"], found["after"]):
        assert abs(after - before) < 1e-15
    assert all(abs(v) < 1e-12 for v in found["velocity"])
    # The load is carried: by normal and shear force together, the shear force below the limit.
    normal, shear = found["forces"]
    for n, s, load in zip(normal, shear, found["load"]):
        assert n + s == pytest.approx(load, abs=1e-9)
    size = sqrt(sum(s * s for s in shear))
    assert 0.5 < size < MU * sqrt(sum(n * n for n in normal))


def test_forces_and_moments_balance(seen):
    for force, moment, scale, largest in seen["balance"]:
        assert force == 0  # action and reaction are the same number
        # Rounding of positions (0.5 m from the point) times forces, some ten operations.
        assert moment < 20 * EPS * scale
        # The check could not fail if the torques were that small anyway.
        assert largest > 1e3 * EPS * scale
