# SPDX-License-Identifier: GPL-3.0-or-later
"""Order of the error of a bent body: it neglects the shortening φ²/24 of a circular arc of angle φ."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from body_parts import MOMENTS_M4, YOUNG_PA, frame_body

import statejump as sj

LENGTH_M, Y = 1.0, (0.0, 1.0, 0.0)


def bent(angle_rad: float, bodies: int) -> float:
    """Return the axial displacement of the end of a cantilever that a moment bends to a circular arc, relative to that
    of the exact arc, over the length."""
    places = np.linspace([0.0, 0.0, 0.0], [LENGTH_M, 0.0, 0.0], bodies + 1)
    names = [f"N{k}" for k in range(bodies + 1)]
    foot = {"fixed": ["x", "y", "z"], "fixed_rotations": ["x", "y", "z"]}
    moment = YOUNG_PA * MOMENTS_M4[1] * angle_rad / LENGTH_M
    nodes: list[dict[str, Any]] = [{"name": name, "position_m": place.tolist()} for name, place in zip(names, places)]
    nodes[0] |= foot
    nodes[-1] |= {"moment_N_m": [0.0, 0.0, moment]}
    made = sj.load({
        "case": {"name": "arc", "kind": "truss"}, "truss": {"dimension": 3}, "node": nodes,
        "body": [{"name": f"B{k}", "nodes": names[k:k + 2],
                  "content": frame_body(places[k:k + 2], [(0, 1, Y)], (0, 1), ("first", "second"))}
                 for k in range(bodies)],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 1e-6, "period_s": 1.0}})
    moved = made.reduced().history["displacement_m"].values[0, -1]
    chord = np.hypot(LENGTH_M + moved[0], moved[1])
    return float(chord / (2 * LENGTH_M / angle_rad * np.sin(angle_rad / 2)) - 1)


@pytest.mark.parametrize("bodies", (1, 2, 4))
def test_error_of_an_arc_is_the_square_of_its_angle(bodies: int) -> None:
    """Each of n bodies bends by φ/n: the chord is too long by φ²/(24 n²)."""
    for angle in (0.02, 0.1):
        assert bent(angle, bodies) == pytest.approx(angle**2 / 24 / bodies**2, rel=2e-3)


def test_error_in_kelvins() -> None:
    """0.01 rad correspond to 0.18 K of an expansion of 23e-6 per kelvin."""
    assert bent(0.01, 1) / 23e-6 == pytest.approx(0.18, rel=0.01)
