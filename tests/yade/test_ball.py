# SPDX-License-Identifier: GPL-3.0-or-later
"""Ball in a socket."""
from math import sqrt

import pytest

from conftest import E_STAR, EPS, G_STAR, check_hertz

LAWS = ["hertz_mindlin", "by_name"]


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("ball.py")


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("change", [0, 80])
def test_force_is_hertz_in_every_direction_at_any_temperature(seen, law, change):
    curve = seen["curves"][law][str(change)]
    r1, r2 = 5e-3 * (1 + 23.4e-6 * change), 5.1e-3 * (1 + 12e-6 * change)
    radius = r1 * r2 / (r2 - r1)
    assert curve["gone"]
    for row in curve["rows"]:
        # c of 1e-4 is what is left of radii of 5e-3 m, 9e-19 m each.
        assert row["R"] == pytest.approx(radius, rel=1e-13)
        # The depth is rounded like that, 2e-18 m of it with the position.
        check_hertz(row, (r1, r2), radius, accuracy=1.5 * 2e-18 / row["depth"] + 1e-13)


@pytest.mark.parametrize("law", LAWS)
def test_in_a_plane_it_is_the_journal_in_its_bearing(seen, law):
    # The same operations on the same numbers; an axis along z only takes zeros away.
    assert seen["planar"][f"ball {law}"] == seen["planar"][f"joint {law}"]
    first, last = (seen["planar"][f"ball {law}"][i] for i in (0, -1))
    assert first != last


@pytest.mark.parametrize("law", LAWS)
def test_friction_holds_up_to_its_limit(seen, law):
    held, slides = (seen["held"][law][t] for t in ("29.0", "40.0"))
    assert held["still"] < 1e-15 and not held["slipping"]
    # It creeps by F_t/k_t along the wall and 0.46 um into it, and swings once beyond.
    a = sqrt(0.255 * 2.46e-6)
    assert held["moved"] < 2 * 29 / (8 * G_STAR * a) + 1e-6
    # In equilibrium; the normal has turned a little by the elastic creep across it.
    assert sqrt(held["normal"] ** 2 + held["shear"] ** 2) == pytest.approx(sqrt(100**2 + 29**2), rel=1e-9)
    assert held["normal"] == pytest.approx(100, rel=0.01)
    # From 21.8 degrees beside the force to 16.7 at least, on a circle of 0.1 mm.
    assert slides["moved"] > 9e-6 and slides["still"] < 1e-9
    assert slides["shear"] <= 0.3 * slides["normal"] * (1 + 1e-12)
    for row in (held, slides):
        # Force and reaction at one point: no moment is left, to roundings of |r||F|, 5 mm 104 N.
        assert row["moments"] <= 8 * EPS * 0.5 and row["torque"] <= 8 * EPS * 0.5
    # At 2 um, with the mobility 1/m; both springs and dampers together.
    a = sqrt(0.255 * 2e-6)
    k = 2 * E_STAR * a + 8 * G_STAR * a
    c = sum(2 * 0.5 * sqrt(0.1 * each) for each in (2 * E_STAR * a, 8 * G_STAR * a))
    m = 0.1
    stable = 4 / (2 * c / m + sqrt((2 * c / m) ** 2 + 4 * 2 * k / m))
    assert held["stable"] == pytest.approx(stable, rel=1e-6)


def test_laws_that_need_an_axis_are_refused(seen):
    for name in ("paper", "johnson", "persson"):
        kind, text = seen["refused"][name]
        assert kind == "RuntimeError"
        assert text.startswith("law_needs_axis normalLaw, tangentialVelocity = ") and text.endswith(" (contact 0 1)")
        assert name in text
    assert seen["refused"]["hertz_paper"] == ["none", ""]


def test_closed_clearance_is_one_sentence(seen):
    assert seen["closed"] == ["RuntimeError", "clearance_closed ball = 0.00515 (contact 0 1)"]
