# SPDX-License-Identifier: GPL-3.0-or-later
"""Impact of two free balls: Hertz's law, momentum, published impacts of spheres; the example script.

Published values are read from figures of Chung and Ooi, Granul. Matter 13, 2011, to about one per cent of full scale.
"""
from math import radians, tan

import numpy as np
import pytest
from conftest import EPS, REPOSITORY, check_hertz, yade

LAWS = ["mindlin", "mindlin_deresiewicz"]

# Test 1, glass: time [us], force [kN]. Limestone: the same.
FORCE = {
    "glass": [
        (3.876, 1.520), (6.244, 3.128), (8.469, 4.804), (10.622, 6.436), (12.632, 7.888), (14.569, 9.073),
        (16.507, 9.966), (18.445, 10.525), (20.455, 10.704), (22.321, 10.480), (25.191, 9.475), (27.201, 8.358),
        (29.139, 7.039), (31.220, 5.453), (33.373, 3.821), (35.813, 2.078), (38.612, 0.559),
    ],
    "limestone": [
        (4.787, 0.948), (8.457, 2.095), (11.489, 3.167), (14.441, 4.238), (17.394, 5.285), (19.867, 6.033),
        (22.580, 6.632), (25.213, 7.031), (27.846, 7.157), (30.000, 6.959), (32.713, 6.511), (35.665, 5.890),
        (38.059, 4.995), (41.090, 4.000), (44.202, 2.832), (47.314, 1.688), (50.904, 0.569),
    ],
}
# Test 8: minus the tangential restitution of the touching side, for angles of incidence of 85 to 5 degrees.
RESTITUTION = {
    "alloy": [
        0.815, 0.626, 0.439, 0.238, 0.017, -0.096, -0.111, -0.090, -0.058, -0.006, 0.049, 0.103, 0.139, 0.162, 0.106,
        0.108, 0.106,
    ],
    "nylon": [
        0.815, 0.630, 0.434, 0.236, 0.019, -0.102, -0.124, -0.122, -0.102, -0.063, -0.010, 0.052, 0.116, 0.151, 0.112,
        0.108, 0.109,
    ],
}


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("impact.py")


@pytest.mark.parametrize("law", ["hertz_mindlin", "by_name"])
@pytest.mark.parametrize("change", [0, 80])
def test_force_is_hertz_in_every_direction_at_any_temperature(seen, law, change):
    found = seen["forces"][law][str(change)]
    r1, r2 = 5e-3 * (1 + 23.4e-6 * change), 3e-3 * (1 + 12e-6 * change)
    radius = r1 * r2 / (r1 + r2)
    assert found["gone"]
    for row in found["rows"]:
        assert row["R"] == pytest.approx(radius, rel=8 * EPS)
        # The depth is what is left of 8 mm, some roundings of 1e-18 m.
        check_hertz(row, (r1, -r2), radius, accuracy=1.5 * 6e-18 / row["depth"] + 1e-14)


def test_impact_takes_hertzs_time_depth_and_force(seen):
    found = seen["head_on"]["1.0"]
    depth, force, duration = found["hertz"]
    # 2000 steps: of second order, and either end is seen to a step.
    assert found["depth"] == pytest.approx(depth, rel=1e-6)
    assert found["force"] == pytest.approx(force, rel=2e-6)
    assert found["duration"] == pytest.approx(duration, rel=2 / 2000)


def test_restitution_is_what_is_asked_for(seen):
    for asked, found in seen["head_on"].items():
        assert found["restitution"] == pytest.approx(float(asked), abs=1e-3)
        assert not any(abs(w) > 1e-9 for spin in found["spin"] for w in spin)
    # Without loss what is left is that of the last step: first order or better.
    errors = [abs(one["restitution"] - 1) for one in seen["steps"]]
    assert errors[2] < 0.6 * errors[0] < 1e-2


@pytest.mark.parametrize("law", LAWS)
def test_momenta_are_kept_and_what_is_lost_is_booked(seen, law):
    found = seen["oblique"][law]
    # Force and reaction act at one point; leapfrog keeps both momenta. 4000 steps of roundings.
    assert found["momentum"] < 4000 * EPS and found["angular"] < 4000 * EPS
    # The energy account is trapezoidal: second order in the step.
    assert found["heat"] == pytest.approx(found["lost"], rel=2e-4)
    assert found["lost"] > 0.05 * found["kinetic"]


@pytest.mark.parametrize("metal", FORCE)
def test_published_force_of_two_equal_spheres(seen, metal):
    time, _, force = np.array(seen["test_1"][metal]["curve"]).T
    at, read = np.array(FORCE[metal]).T
    off = np.interp(at * 1e-6, time, force) / 1e3 - read
    assert np.sqrt(np.mean(off**2)) < 0.02 * read.max()


def test_equal_spheres_with_opposite_spins_do_not_rub(seen):
    # Test 7: both touching sides move alike, so nothing happens along them.
    for found in seen["test_7"].values():
        assert found["spin"][0][2] == pytest.approx(5, rel=1e-12) and found["spin"][1][2] == pytest.approx(-5, rel=1e-12)
        assert all(abs(v[1]) < 1e-12 for v in found["velocity"])
        assert found["restitution"] == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("metal", RESTITUTION)
def test_published_oblique_impact_of_unequal_spheres(seen, law, metal):
    """Test 8 with tangents of the impact angle of 5 to 85 degrees; published values are sorted from 85 degrees down."""
    along, normal = np.array(seen["test_8"][law][metal])[::-1].T
    read = np.array(RESTITUTION[metal])
    assert np.all(np.abs(normal + 0.5) < 2e-3)
    # Where it slides throughout nothing counts but Coulomb's limit: rigid bodies.
    tangents = np.array([tan(radians(5 * k)) for k in range(17, 0, -1)])
    sliding = 1 - 3.5 * 0.4 * 1.5 / tangents
    assert along[:4] == pytest.approx(sliding[:4], abs=2e-3)
    assert np.sqrt(np.mean((along - read)[:5] ** 2)) < 0.005  # readings are to a hundredth


@pytest.mark.parametrize("metal", RESTITUTION)
def test_published_oblique_impact_has_dashpots_along_the_surface(seen, metal):
    """If the contact sticks, the published spheres hardly rebound tangentially: the dashpots of that code cause this.
    """
    read = np.array(RESTITUTION[metal])
    away = {
        (law, scene): np.sqrt(np.mean((np.array(seen[scene][law][metal])[::-1, 0] - read) ** 2))
        for law in LAWS for scene in ("test_8", "test_8_dashpots")
    }
    print({f"{law} {scene}": round(rms, 4) for (law, scene), rms in away.items()})
    assert away["mindlin", "test_8_dashpots"] < 0.07 < 0.3 < away["mindlin", "test_8"]


def test_a_harder_large_sphere_changes_nothing_along_the_surface(seen):
    # Of one Poisson's ratio both stiffnesses of the contact keep their ratio: case A is case B.
    same = np.array(seen["test_8"]["mindlin_deresiewicz"]["alloy"])[::4]
    assert np.array(seen["test_8_harder"]) == pytest.approx(same, abs=2e-3)


def test_saved_while_touching_it_goes_on_bit_for_bit(seen):
    straight, saved = seen["resumed"]
    assert straight == saved
    assert straight[2] >= 3 and straight[3]  # partial slip was saved; they have parted since


def test_laws_and_places_that_two_balls_cannot_have(seen):
    for name in ("hertz_paper", "johnson"):
        fault = f"law_for_flat_walls normalLaw = {name} (contact 0 1)"
        assert seen["refused"][name] == ["RuntimeError", fault]
    fault = "law_needs_axis normalLaw, tangentialVelocity = hertz_internal, paper (contact 0 1)"
    assert seen["refused"]["paper"] == ["RuntimeError", fault]
    assert seen["refused"]["hertz_internal"] == ["none", ""]
    assert seen["refused"]["inside"] == ["RuntimeError", "centre_inside distance = 0.0045 (contact 0 1)"]


def test_example():
    done = yade(REPOSITORY / "yade_scripts" / "examples" / "impact.py", environment={"RESTITUTION": "0.8", "SPIN": "500"})
    assert done.returncode == 0, done.stderr
    assert "loss 40.3" in done.stdout and "loss 10.69" in done.stdout
    found = float(done.stdout.split("restitution ")[1].split(",")[0])
    assert found == pytest.approx(0.8, abs=1e-3)  # 2000 steps, and the normal turns meanwhile
