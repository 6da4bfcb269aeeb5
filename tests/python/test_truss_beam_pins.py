# SPDX-License-Identifier: GPL-3.0-or-later
"""Revolutes and balls on nodes of beams: the node turns their parts, as a rigid stub of a link would."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from test_truss_beam import STEEL, WARM, clamp, frame, states
from test_truss_beam_ends import SPACE

from statejump.kinds.loading import parse_case
from statejump.kinds.truss import motion
from statejump.kinds.truss.generate.document import node

PIN: dict[str, Any] = {"journal_radius_m": 0.02, "radial_clearance_m": 1e-4, "friction_coefficient": 0.4,
                       "young_modulus_Pa": 70e9}
# A stub of a link, held by a rigid arm, along which nothing expands.
STUB: dict[str, Any] = {**STEEL, "cross_section_area_m2": 1e-4, "thermal_expansion_per_K": 0.0}


# Directions of the plane of the frame in space, and its normal.
TURNED = np.array([[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]]) / 3


def pinned_beams(dimension: int, sticking: str, *, stub: bool) -> dict[str, Any]:
    """Two clamped beams, which a gradient bends; the journal on the end of one turns in the bearing of the other.

    :param stub: links on rigid arms turn journal and bearing
    """
    def vector(x: float, y: float) -> list[float]:
        return [x, y] if dimension == 2 else (x * TURNED[0] + y * TURNED[1]).tolist()

    def place(x: float, y: float) -> tuple[float, ...]:
        return tuple(vector(x, y))

    end: dict[str, Any] = {} if dimension == 2 else {"axis": TURNED[2].tolist()}
    keys = WARM if dimension == 2 else {**WARM, **SPACE, "axis_y": TURNED[1].tolist()}
    nodes = [clamp("A", place(0, 0)), node("J", place(3, 0)), node("B", place(3, 0)), clamp("C", place(5, 0.5))]
    made = frame(*nodes, dimension=dimension,
                 beam=[{"nodes": ["A", "J"], **keys}, {"nodes": ["B", "C"], **keys, "temperature_fraction": -0.4}],
                 revolute=[{"name": "pin", "journal_node": "J", "bearing_node": "B", **PIN, **end}])
    made["reduced"] = {"sticking": sticking}
    made["node"][1]["force_N"], made["node"][2]["force_N"] = vector(0, -3e3), vector(0, 2e3)
    if stub:
        made["node"] += [node("J2", place(2, 0.2)), node("B2", place(3, 1))]
        made["link"] = [{"name": name, "nodes": [name, name + "2"], **STUB} for name in ("J", "B")]
        made["rigid"] = [{"name": name, "master": name, "nodes": [name + "2"]} for name in ("J", "B")]
        made["revolute"][0] |= {"journal_link": "J", "bearing_link": "B"}
    return made


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("sticking", ["rigid", "elastic", "partial_slip"])
def test_node_turns_journal_and_bearing_as_a_stub_does(dimension: int, sticking: str) -> None:
    own = states(pinned_beams(dimension, sticking, stub=False))
    stub = states(pinned_beams(dimension, sticking, stub=True))
    size = np.abs(stub["displacement_m"]).max()
    # Both runs locate the same events, each to 1e-9 of a branch.
    assert own["displacement_m"][-1] == pytest.approx(stub["displacement_m"][-1, :4], abs=1e-8 * size)
    assert own["friction_force_N"][-1] == pytest.approx(stub["friction_force_N"][-1], rel=1e-6)
    # The turn matters: rubbing changes the shape, by far more than the tolerance.
    assert np.abs(own["displacement_m"][-1] - own["displacement_m"][0]).max() > 1e-6 * size


@pytest.mark.parametrize("sticking", ["elastic", "partial_slip"])
def test_ball_that_moves_in_a_plane_is_the_revolute(sticking: str) -> None:
    made = pinned_beams(3, sticking, stub=False)
    revolute = states(made)
    del made["revolute"]
    pin = {key: value for key, value in PIN.items() if key != "journal_radius_m"}
    made["ball_joint"] = [{"name": "pin", "ball_node": "J", "socket_node": "B",
                           "ball_radius_m": PIN["journal_radius_m"], **pin}]
    ball = states(made)
    size = np.abs(revolute["displacement_m"]).max()
    # A ball is second-order accurate in the increment.
    assert ball["displacement_m"][-1] == pytest.approx(revolute["displacement_m"][-1], abs=1e-4 * size)


@pytest.mark.parametrize("dimension", [2, 3])
def test_slow_motion_follows_the_path(dimension: int) -> None:
    made = pinned_beams(dimension, "elastic", stub=False)
    made["beam"] = [{**beam, "density_kg_per_m3": 7800.0} for beam in made["beam"]]
    made["motion"] = {"steps_per_cycle": 1000, "theta": 1.0}
    made["thermal"]["period_s"] = 20.0
    path = states(made)
    moved = motion.simulate(parse_case(made)).states
    # Friction of a step follows its temperature by one step of 1000 at most.
    size = np.abs(path["displacement_m"]).max()
    assert moved["displacement_m"][-1] == pytest.approx(path["displacement_m"][-1], abs=1e-3 * size)
    assert moved["friction_force_N"][-1] == pytest.approx(path["friction_force_N"][-1], rel=2e-3)
