# SPDX-License-Identifier: GPL-3.0-or-later
"""No valid value of a quantity serves as a special marker; failures are raised and name the bodies."""
from __future__ import annotations

import pytest


@pytest.fixture(scope="module")
def seen(run_script):
    return run_script("sentinels.py")


@pytest.mark.parametrize("speed", [1.0, 0.5])
def test_contact_begins_once_whatever_its_speed(seen, speed):
    """-1 m/s is a possible speed of approach."""
    assert seen["parting"][str(speed)] == {"contacts": 1, "speed": -speed, "begun": True}


def test_guide_planes_raise_failures(seen):
    """GuidePlanes raises a failure once. It does not report it again, and the next run is not stopped."""
    kind, text, stop = seen["guided"]
    assert (kind, text) == ("RuntimeError", "time_step_unstable O.dt = 0.001 (contact 0 1)")
    assert stop == 0


def test_ball_in_a_mesh_is_no_socket(seen):
    fault = "law_needs_axis normalLaw, tangentialVelocity = johnson, material (contact 0 1)"
    assert seen["mesh"] == ["RuntimeError", fault]
