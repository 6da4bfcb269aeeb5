# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid bodies and hinges of beams in motion: pendulums against closed forms, slow heating against the quasi-static
path, balance of energy."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk

from test_truss_beam import clamp, frame
from test_truss_beam_ends import hinged, rotation_matrix

from statejump.kinds.loading import parse_case
from statejump.kinds.truss import motion, solve
from statejump.kinds.truss.generate.document import node

GRAVITY = 9.81


def moving(made: dict[str, Any], period_s: float, steps: int, **keys: Any) -> dict[str, np.ndarray]:
    """Return the states of a motion over one cycle of equal steps, all of them sampled."""
    made = {**made, "thermal": {**made["thermal"], "period_s": period_s},
            "motion": {"steps_per_cycle": steps, **keys}, "output": {"samples_per_cycle": steps}}
    return motion.simulate(parse_case(made)).states


def residue(found: dict[str, np.ndarray]) -> np.ndarray:
    """Energy stored and dissipated minus energy supplied, since the start [J]."""
    sums = found["elastic_energy_J"] + found["kinetic_energy_J"] + found["load_potential_J"]
    heat = sum(values.sum(axis=1) for key, values in found.items() if key.endswith("_dissipation_J") and values.ndim == 2)
    return np.asarray(sums - sums[0] + heat - found["thermal_work_J"])


def pendulum(load: list[float]) -> dict[str, Any]:
    """A mass of 2 kg at the end of a rigid arm of 0.5 m that rotates about a support."""
    return frame(node("P", (0.0, 0.0), "xy"), {**node("Q", (0.5, 0.0)), "mass_kg": 2.0, "force_N": load},
                 change_K=1e-9, beam=[],
                 rigid=[{"name": "arm", "master": "P", "nodes": ["Q"], "rotations": []}])


def test_rigid_arm_swings_as_a_pendulum() -> None:
    """From the horizontal, the period is 4 K(sin² 45°) sqrt(l/g). Length and energy are exact to second order."""
    period_s = 4 * float(ellipk(0.5)) * np.sqrt(0.5 / GRAVITY)
    errors = []
    for steps in (200, 400):
        found = moving(pendulum([0.0, -2.0 * GRAVITY]), period_s, steps, start="drawn")
        at = found["displacement_m"][:, 1] + [0.5, 0.0, 0.0]
        length = np.linalg.norm(at, axis=1) / 0.5 - 1
        energy = found["kinetic_energy_J"].max()
        assert energy == pytest.approx(2.0 * GRAVITY * 0.5, rel=1e-3)
        errors.append([np.linalg.norm(found["displacement_m"][-1, 1]), np.abs(length).max(),
                       np.abs(residue(found)).max() / energy])
    assert errors[1] == pytest.approx([0, 0, 0], abs=2e-3)
    assert (np.array(errors[1]) < 0.3 * np.array(errors[0])).all()


def test_force_of_a_swinging_arm() -> None:
    """At the lowest point of a pendulum from the horizontal, the arm carries three weights."""
    quarter_s = float(ellipk(0.5)) * np.sqrt(0.5 / GRAVITY)
    found = moving(pendulum([0.0, -2.0 * GRAVITY]), quarter_s, 400, start="drawn")
    assert found["rigid_force_N"][-1, 0, 1] == pytest.approx(3 * 2.0 * GRAVITY, rel=1e-2)
    assert abs(found["rigid_force_N"][0, 0, 1]) < 1e-9


def test_pendulum_in_space_is_that_in_a_plane() -> None:
    """Arms to two masses beside the line (2, 2, 1)/3 at 0.5 m, loads along (1, -2, 2)/3 across it."""
    period_s = 4 * float(ellipk(0.5)) * np.sqrt(0.5 / GRAVITY)
    along, down = np.array([2.0, 2.0, 1.0]) / 3, np.array([1.0, -2.0, 2.0]) / 3
    bobs = [{**node(name, tuple(0.5 * along + aside * np.cross(along, down))), "mass_kg": 1.0,
             "force_N": list(GRAVITY * down)} for name, aside in (("Q", 0.1), ("W", -0.1))]
    made = frame(node("P", (0.0, 0.0, 0.0), "xyz"), *bobs, change_K=1e-9, dimension=3, beam=[],
                 rigid=[{"name": "arms", "master": "P", "nodes": ["Q", "W"], "rotations": []}])
    found = moving(made, period_s, 200, start="drawn")["displacement_m"]
    plane = moving(pendulum([0.0, -2.0 * GRAVITY]), period_s, 200, start="drawn")["displacement_m"][:, 1]
    for bob in (1, 2):
        assert np.outer(plane[:, 0], along) - np.outer(plane[:, 1], down) == pytest.approx(found[:, bob], abs=1e-9)


@pytest.mark.parametrize("arm", [(1.0, 0.5), (1.4, 0.3)])
def test_slowly_heated_arm_follows_its_path(arm: tuple[float, float]) -> None:
    """A cantilever with a gradient carries a mass on an arm; inertia is of the square of the periods over the cycle."""
    warm = {"gradient_per_m": [2.5, 0.0], "temperature_fraction": 0.0, "density_kg_per_m3": 7800.0}
    made = frame(clamp("A", (0.0, 0.0)), node("B", (1.0, 0.0)), {**node("C", arm), "mass_kg": 5.0, "force_N": [0.0, -50.0]},
                 beam=[{"nodes": ["A", "B"], "shape": "rectangle", "dimensions_m": [0.05, 0.02], **warm}],
                 rigid=[{"name": "R", "master": "B", "nodes": ["C"]}])
    path = solve.path(parse_case({**made, "thermal": {**made["thermal"], "period_s": 20.0}}).resolve()).states
    found = moving(made, 20.0, 2000, theta=1.0)
    assert np.interp(path["time_s"], found["time_s"], found["displacement_m"][:, 2, 1]) == pytest.approx(
        path["displacement_m"][:, 2, 1], abs=2e-4 * np.ptp(path["displacement_m"][:, 2, 1]))
    assert found["rigid_force_N"][:, 0] == pytest.approx(np.tile([0.0, 50.0, 0.0], (2001, 1)), abs=5e-2)  # inertia at the corners
    apart = np.linalg.norm(found["displacement_m"][:, 2] - found["displacement_m"][:, 1] + [arm[0] - 1.0, arm[1], 0.0], axis=1)
    assert np.abs(apart - np.hypot(arm[0] - 1.0, arm[1])).max() < 1e-9


# ---------------------------------------------------------------- hinges


def dense(made: dict[str, Any]) -> dict[str, Any]:
    made["beam"] = [{**beam, "density_kg_per_m3": 2700.0} for beam in made["beam"]]
    return made


@pytest.mark.parametrize("keys", [{"stiffness_N_m_per_rad": 40.0, "friction_moment_N_m": 1.0},
                                  {"stiffness_N_m_per_rad": 40.0, "deadband_rad": 0.05, "preload_moment_N_m": 0.3}])
def test_slowly_heated_hinge_follows_its_path(keys: dict[str, float]) -> None:
    made = dense(hinged(**keys))
    path = solve.path(parse_case({**made, "thermal": {**made["thermal"], "period_s": 50.0}}).resolve()).states
    found = moving(made, 50.0, 2000, theta=1.0)
    angle = path["beam_hinge_rotation_rad"][:, 0]
    assert np.interp(path["time_s"], found["time_s"], found["beam_hinge_rotation_rad"][:, 0]) == pytest.approx(
        angle, abs=2e-3 * np.ptp(angle))
    if "friction_moment_N_m" in keys:
        assert abs(found["beam_hinge_rotation_rad"][-1, 0]) == pytest.approx(0.0101694915254, rel=2e-3)
        assert found["hinge_dissipation_J"][-1, 0] == pytest.approx(path["hinge_dissipation_J"][-1, 0], rel=5e-3)


def double_pendulum(axis: list[float]) -> dict[str, Any]:
    """Two rigid bodies on hinges, the second about the axis. Each carries two masses."""
    places = {"P": (0.0, 0.0, 0.0), "S": (0.0, 0.0, 0.0), "A": (0.5, 0.1, 0.0), "E": (1.0, 0.0, 0.0), "T": (1.0, 0.0, 0.0),
              "B": (1.3, -0.2, 0.3), "C": (1.6, 0.2, 0.1)}
    nodes = [node("P", places["P"], "xyz"), node("S", places["S"])]
    nodes[0]["fixed_rotations"] = ["x", "y", "z"]
    nodes += [{**node(name, places[name]), "mass_kg": mass, "force_N": [0.0, 0.0, -GRAVITY * mass]}
              for name, mass in (("A", 1.0), ("E", 0.5), ("B", 0.7), ("C", 0.6))]
    nodes.insert(4, node("T", places["T"]))
    return frame(*nodes, change_K=1e-9, dimension=3, beam=[],
                 rigid=[{"name": "first", "master": "S", "nodes": ["A", "E"]},
                        {"name": "second", "master": "T", "nodes": ["B", "C"], "rotations": []}],
                 hinge=[{"name": "H", "nodes": ["P", "S"], "axis": [0.3, 1.0, 0.1]},
                        {"name": "K", "nodes": ["E", "T"], "axis": axis}])


def test_bodies_on_hinges_in_space_keep_their_energy_and_their_axes() -> None:
    axis = np.array([0.0, 0.8, 0.6])
    energies, tilts = [], []
    for steps in (300, 600):
        found = moving(double_pendulum(list(axis)), 0.8, steps, start="drawn")
        energies.append(np.abs(residue(found)).max() / found["kinetic_energy_J"].max())
        turned = [[rotation_matrix(rotation[node]) @ axis for node in (3, 4)] for rotation in found["rotation_rad"][1:]]
        tilts.append(np.abs(np.diff(turned, axis=1)).max())
    assert energies[1] < 0.3 * energies[0] < 3e-3
    assert tilts[1] < 0.3 * tilts[0] < 1e-2
    assert np.abs(found["beam_hinge_rotation_rad"]).max(axis=0).min() > 0.5
