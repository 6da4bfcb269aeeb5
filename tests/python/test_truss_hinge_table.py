# SPDX-License-Identifier: GPL-3.0-or-later
"""Hinges with a moment curve from a table: closed forms, hysteresis of a tape spring under temperature, motion,
refusals."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from test_truss_beam_ends import hinged

from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import motion, solve

# Both beams of 1 m under the gradient press the hinge as a spring that is relaxed at the free angle.
BEAMS_N_M_PER_RAD = 70e9 * 0.02 * 0.01**3 / 12 / 2
FREE_RAD = 2 * 23e-6 * 20 / 0.01
# A tape spring: stiff up to a peak, then a low steady moment.
TAPE_RAD, TAPE_N_M = [-0.3, -0.03, -0.02, 0.0, 0.02, 0.03, 0.3], [-0.4, -0.4, -2.0, 0.0, 2.0, 0.4, 0.4]


def with_table(angle_rad: list[float], moment_N_m: list[float], **keys: Any) -> dict[str, Any]:
    return hinged(table_angle_rad=angle_rad, table_moment_N_m=moment_N_m, **keys)


def path(made: dict[str, Any], **options: Any) -> Any:
    return solve.path(parse_case(made).resolve(), **options)


@pytest.mark.parametrize("more", [{}, {"friction_moment_N_m": 1.0}])
def test_two_points_are_a_stiffness(more: dict[str, float]) -> None:
    table, spring = path(with_table([-0.5, 0.5], [-20.0, 20.0], **more)), path(hinged(stiffness_N_m_per_rad=40.0, **more))
    for key in ("displacement_m", "beam_hinge_moment_N_m", "elastic_energy_J", "hinge_dissipation_J"):
        assert table.states[key] == pytest.approx(spring.states[key], rel=1e-9, abs=1e-13)


def test_stiffening_hinge_is_on_its_curve() -> None:
    """The rotation is the root of M(φ) = k (free angle − φ); the energy balance contains the integral of the curve."""
    angle, moment = [-0.1, -0.05, 0.0, 0.01, 0.05, 0.1], [-9.0, -2.0, 0.0, 0.1, 2.0, 9.0]
    found = path(with_table(angle, moment))
    curve = PchipInterpolator(angle, moment)
    hot = int(np.argmax(found.states["temperature_change_K"]))
    rotation = abs(found.states["beam_hinge_rotation_rad"][hot, 0])
    expected = brentq(lambda at: curve(at) - BEAMS_N_M_PER_RAD * (FREE_RAD - at), 0.0, 0.1, xtol=1e-15)
    assert rotation == pytest.approx(expected, rel=1e-9)
    bent = 0.5 * BEAMS_N_M_PER_RAD * (FREE_RAD - rotation) ** 2
    energy = found.states["elastic_energy_J"][hot]
    assert energy == pytest.approx(curve.integrate(0.0, rotation) + bent, rel=1e-6)
    # The slope of the curve is continuous, its change is not: the work of a step across a point is of the third order.
    assert abs(found.energy_residue_J) < 1e-8 * energy


def limit_points() -> tuple[float, float]:
    """Free angles at which the rotation on the tape spring snaps: when it is heated, and when it is cooled."""
    at = np.linspace(0.0, 0.1, 1_000_001)
    free = at + PchipInterpolator(TAPE_RAD, TAPE_N_M)(at) / BEAMS_N_M_PER_RAD
    peak = int(np.argmax(free[at < 0.03]))
    return float(free[peak]), float(free[peak:].min())


def test_tape_spring_snaps_with_hysteresis() -> None:
    found = path(with_table(TAPE_RAD, TAPE_N_M), increments_per_branch=400)
    snaps, back = limit_points()
    free = FREE_RAD * found.states["temperature_change_K"] / 20.0
    rotation = np.abs(found.states["beam_hinge_rotation_rad"][:, 0])
    heating = np.arange(len(free)) <= int(np.argmax(free))
    # On the steep branch below, and on the plateau beyond the snap.
    assert (rotation[heating & (free < 0.99 * snaps)] < 0.021).all()
    beyond = (heating & (free > 1.01 * snaps)) | (~heating & (free > 1.01 * back))
    assert rotation[beyond] == pytest.approx(free[beyond] - 0.4 / BEAMS_N_M_PER_RAD, abs=1e-9)
    assert (rotation[~heating & (free < 0.99 * back)] < 0.021).all()
    assert rotation[-1] < 1e-12
    assert [note["kind"] for note in found.notes].count("snap") >= 1


def test_tape_spring_snaps_in_motion() -> None:
    made = with_table(TAPE_RAD, TAPE_N_M)
    made["beam"] = [{**beam, "density_kg_per_m3": 2700.0} for beam in made["beam"]]
    made = {**made, "thermal": {**made["thermal"], "period_s": 6.0}, "motion": {"steps_per_cycle": 300_000},
            "output": {"samples_per_cycle": 2000}}
    found = motion.simulate(parse_case(made)).states
    free = FREE_RAD * found["temperature_change_K"] / 20.0
    rotation = np.abs(found["beam_hinge_rotation_rad"][:, 0])
    snaps, _ = limit_points()
    first = int(np.argmax(rotation > 0.03))
    assert free[first] == pytest.approx(snaps, rel=0.02)
    stored = found["elastic_energy_J"] + found["kinetic_energy_J"]
    assert np.abs(stored - stored[0] - found["thermal_work_J"]).max() < 1e-2 * stored.max()
    assert found["kinetic_energy_J"][first:].max() > 0.1 * found["elastic_energy_J"].max()


@pytest.mark.parametrize(("keys", "code"), [
    ({"table_angle_rad": [0.0, 1.0]}, "moment_table_incomplete"),
    ({"table_angle_rad": [0.0, 1.0], "table_moment_N_m": [0.0]}, "moment_table_length"),
    ({"table_angle_rad": [0.0, 1.0, 1.0], "table_moment_N_m": [0.0, 1.0, 2.0]}, "moment_table_not_increasing"),
    ({"table_angle_rad": [0.1, 1.0], "table_moment_N_m": [0.0, 1.0]}, "moment_table_without_zero"),
])
def test_wrong_tables_are_refused(keys: dict[str, Any], code: str) -> None:
    with pytest.raises(StatejumpError) as refused:
        parse_case(hinged(**keys))
    assert refused.value.code == code


def test_a_hinge_that_leaves_its_table_is_refused() -> None:
    with pytest.raises(StatejumpError) as refused:
        path(with_table([-0.01, 0.01], [-0.1, 0.1]))
    assert refused.value.code == "hinge_left_table" and "'H'" in str(refused.value)
