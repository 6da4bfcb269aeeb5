# SPDX-License-Identifier: GPL-3.0-or-later
"""No value that may occur stands for another meaning; failures are raised, and call bodies by their names."""
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
    """Known to those who record them: no second report, and no stop that outlives the scene's run."""
    kind, text, stop = seen["guided"]
    assert kind == "RuntimeError" and "is above the stable one" in text
    assert stop == 0


def test_ball_in_a_mesh_is_no_socket(seen):
    kind, text = seen["mesh"]
    assert kind == "RuntimeError"
    assert text.startswith(
        "a Ball in a MeshBore needs normalLaw 'hertz_paper' or 'hertz_internal' and tangentialVelocity 'material', "
        "not 'johnson' and 'material' (contact of bodies 0 and 1, ")
