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
from test_truss_pad import pad_case

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


# ---------------------------------------------------------------- pads


def test_block_slides_as_its_load_pushes_it() -> None:
    """A mass of 2 kg on a frictional plane, pushed along (3, 4) with 5 N and pressed with 10 N: 1.5 m/s²."""
    made = frame({**node("B", (0.0, 0.0, 0.0)), "mass_kg": 2.0, "force_N": [3.0, 4.0, -10.0]},
                 change_K=1e-9, dimension=3, beam=[],
                 pad=[{"name": "P", "nodes": ["B"], "normal": [0.0, 0.0, 2.0], "normal_stiffness_N_per_m": 1e6,
                       "friction_coefficient": 0.2}])
    found = moving(made, 0.5, 4000, start="drawn")
    assert found["displacement_m"][-1, 0, :2] == pytest.approx(0.5 * 1.5 * 0.5**2 * np.array([0.6, 0.8]), rel=5e-3)
    assert found["pad_friction_N"][-1, 0] == pytest.approx([-1.2, -1.6, 0.0], rel=2e-2, abs=1e-9)
    heat = found["pad_dissipation_J"][-1, 0]
    assert heat == pytest.approx(2.0 * 0.5 * 1.5 * 0.5**2, rel=5e-3)


def test_block_bounces_on_its_pad() -> None:
    """From 1 mm above the plane: the fall, half a swing on the spring, and the rise take as long as a closed form."""
    mass, stiffness, height = 2.0, 1e6, 1e-3
    rate = np.sqrt(stiffness / mass)
    sunk = mass * GRAVITY / stiffness
    fall_s, speed = np.sqrt(2 * height / GRAVITY), np.sqrt(2 * GRAVITY * height)
    touch_s = (2 * np.pi - 2 * np.arctan2(speed / rate, sunk)) / rate
    made = frame({**node("B", (0.0, 0.0), "x"), "mass_kg": mass, "force_N": [0.0, -mass * GRAVITY]},
                 change_K=1e-9, beam=[],
                 pad=[{"name": "P", "nodes": ["B"], "normal": [0.0, 1.0], "normal_stiffness_N_per_m": stiffness,
                       "friction_coefficient": 0.3, "clearance_m": height}])
    errors = []
    for steps in (4000, 8000):
        found = moving(made, 2 * fall_s + touch_s, steps, start="drawn")
        pressed = found["pad_normal_force_N"][:, 0]
        largest = mass * GRAVITY + np.sqrt((mass * GRAVITY) ** 2 + stiffness * mass * speed**2)
        errors.append([abs(found["displacement_m"][-1, 0, 1]) / height, abs(pressed.max() / largest - 1)])
        assert (pressed[: int(0.9 * fall_s / found["time_s"][-1] * steps)] == 0).all() and pressed[-1] == 0
    # Elastic contact is integrated by implicit Euler: first order.
    assert (np.array(errors[1]) < 0.6 * np.array(errors[0])).all() and max(errors[1]) < 0.05


@pytest.mark.parametrize("way", [0.0, 0.4])
def test_slowly_heated_pad_follows_its_path(way: float) -> None:
    made = pad_case(way=way, normal_stiffness_N_per_m=1e8).origin.document
    path = solve.path(parse_case(made).resolve()).states
    found = moving({**made, "thermal": {**made["thermal"], "cycles": 1}}, 1.0, 2000, theta=1.0)
    first = path["time_s"] <= 1.0
    moved = path["displacement_m"][first, 1]
    for axis in (0, 1):
        at = np.interp(path["time_s"][first], found["time_s"], found["displacement_m"][:, 1, axis])
        assert at == pytest.approx(moved[:, axis], abs=1e-3 * np.abs(moved).max())
    assert np.linalg.norm(found["pad_friction_N"][-1, 0]) == pytest.approx(
        np.linalg.norm(path["pad_friction_N"][first][-1, 0]), rel=1e-2)
    assert found["pad_dissipation_J"][-1, 0] == pytest.approx(path["pad_dissipation_J"][first][-1, 0], rel=1e-2)


def test_pad_in_motion_starts_with_the_friction_of_its_path() -> None:
    """The load along the plane is below the friction limit: nothing moves."""
    made = frame({**node("B", (0.0, 0.0, 0.0)), "mass_kg": 2.0, "force_N": [1.0, -1.0, -10.0]},
                 change_K=1e-9, dimension=3, beam=[],
                 pad=[{"name": "P", "nodes": ["B"], "normal": [0.0, 0.0, 2.0], "normal_stiffness_N_per_m": 1e6,
                       "friction_coefficient": 0.2}])
    found = moving(made, 0.1, 200)
    assert np.ptp(found["displacement_m"][:, 0], axis=0).max() < 1e-12
    assert found["pad_friction_N"][:, 0] == pytest.approx(np.tile([-1.0, 1.0, 0.0], (201, 1)), abs=1e-6)


def test_energy_balances_while_the_slide_on_a_pad_turns() -> None:
    """Two bars at right angles follow programs out of phase."""
    made = pad_case(friction_coefficient=0.1, normal_stiffness_N_per_m=1e7).origin.document
    late = {"name": "late", "shape": "table", "table_time_s": [0.0, 0.5, 1.0],
            "table_temperature_change_K": [0.0, 50.0, 0.0]}
    thermal = {"shape": "table", "table_time_s": [0.0, 0.25, 0.75, 1.0],
               "table_temperature_change_K": [0.0, 50.0, -50.0, 0.0]}
    made = {**made, "link": [made["link"][0], {**made["link"][1], "thermal_expansion_per_K": 2e-5, "program": "late"}],
            "program": [late], "thermal": thermal, "output": {"samples_per_cycle": 500}}
    off = []
    for steps in (1000, 2000):
        run = parse_case({**made, "motion": {"steps_per_cycle": steps, "theta": 1.0}}).reduced(dynamic=True)
        heat = run["friction_dissipation_J"]
        assert (np.diff(heat) >= -1e-9 * heat[-1]).all()
        off.append(abs(run.summary["energy_residue_J"]) / heat[-1])
    assert off[1] < 0.6 * off[0] < 0.02
