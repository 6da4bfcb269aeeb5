# SPDX-License-Identifier: GPL-3.0-or-later
"""Mechanisms as trusses in motion: weight, rigid bodies, driven links."""
from __future__ import annotations

import os
import signal
import subprocess
import time
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import COMMAND, REPOSITORY, results_in
from failures import failure, note

import statejump as sj
from statejump.kinds.truss.generate.document import write

CRANK, ROD, SPEED, RAMP = 0.05, 0.12, 523.6, 0.012
MASSES = {"crank": 0.3, "rod": 0.21, "piston": 0.14}
MOMENTS = {"crank": 1e-4, "rod": 2.5e-4}


def without_play(name: str = "slider_crank", bearing: str = "P") -> dict[str, Any]:
    """A shipped mechanism with an exact pin as its joint, and links a hundred times as stiff."""
    made = tomllib.loads((REPOSITORY / "cases" / "trusses" / f"{name}.toml").read_text())
    del made["revolute"]
    made["node"] = [node for node in made["node"] if node["name"] != "J"]
    made["link"][1]["nodes"] = ["A", bearing]
    for link in made["link"]:
        link["cross_section_area_m2"] = 1e-2
    made["truss"].pop("gravity_m_per_s2")
    return made


def piston(angle: np.ndarray) -> np.ndarray:
    return CRANK * np.cos(angle) + np.sqrt(ROD**2 - (CRANK * np.sin(angle)) ** 2)


def reduced_inertia(angle: np.ndarray) -> np.ndarray:
    """2 T/ω² of rigid bodies [kg m²], by differences of places."""
    step = 1e-5

    def places(at: np.ndarray) -> np.ndarray:
        lean = -np.arcsin(CRANK * np.sin(at) / ROD)
        return np.stack((CRANK * np.cos(at) + 0.5 * ROD * np.cos(lean), CRANK * np.sin(at) + 0.5 * ROD * np.sin(lean), lean,
                         piston(at)))

    rates = (places(angle + step) - places(angle - step)) / (2 * step)
    weights = np.array([MASSES["rod"], MASSES["rod"], MOMENTS["rod"], MASSES["piston"]])
    crank = MOMENTS["crank"] + MASSES["crank"] * (CRANK / 2) ** 2
    return crank + (weights[:, None] * rates**2).sum(axis=0)


def test_slider_crank_without_play_moves_and_is_driven_as_rigid_bodies_are() -> None:
    run = sj.load(without_play()).reduced(dynamic=True)
    time = run.time_s
    angle = np.where(time < RAMP, SPEED * time**2 / (2 * RAMP), SPEED * (time - RAMP / 2))
    # Rods of 1e-2 m² stretch by m ω² r l/(E A) = 5e3 N 0.17 m/2e9 N, and the errors of the steps, (ω h)²/12 of the crank.
    assert np.abs(run["position_m"][:, 2, 0] - piston(angle)).max() < 2e-6
    # Power of the drive: d/dt of I ω²/2.
    speed, rate = np.minimum(SPEED * time / RAMP, SPEED), np.where(time < RAMP, SPEED / RAMP, 0.0)
    step = 1e-4
    slope = (reduced_inertia(angle + step) - reduced_inertia(angle - step)) / (2 * step)
    exact = reduced_inertia(angle) * rate + 0.5 * slope * speed**2
    found = run.history["drive_moment_N_m"].values[:, 0]
    settled = (time > 2e-4) & (np.abs(time - RAMP) > 2e-4)  # a corner of the program rings in the links
    # A moment is the mean of its step, 0.6 µs before: ω h/2 times its own slope.
    assert np.abs(found - exact)[settled].max() < 5e-3 * np.abs(exact).max()
    assert abs(run.summary["energy_residue_J"]) < 1e-4 * run["kinetic_energy_J"].max()
    assert run["external_work_J"][-1] == pytest.approx(
        run["kinetic_energy_J"][-1] + run["elastic_energy_J"][-1] + run["damping_dissipation_J"][-1], rel=1e-3)


def test_four_bar_without_play_moves_as_its_closed_form_and_with_play_within_it() -> None:
    run = sj.load(without_play("four_bar", "B")).reduced(dynamic=True)
    time, speed, ramp = run.time_s, 157.08, 0.02
    angle = np.where(time < ramp, speed * time**2 / (2 * ramp), speed * (time - ramp / 2))
    crank = 0.05 * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    # The coupler's end is where circles of 0.12 m about the crank and of 0.1 m about the ground meet.
    apart = np.array([0.14, 0.0]) - crank
    distance = np.linalg.norm(apart, axis=1, keepdims=True)
    along = (0.12**2 - 0.1**2 + distance**2) / (2 * distance)
    left = np.stack((-apart[:, 1], apart[:, 0]), axis=1)
    exact = crank + (along * apart + np.sqrt(0.12**2 - along**2) * left) / distance
    # Rods of 1e-2 m² stretch by m ω² r l/(E A) = 4e2 N 0.12 m/2e9 N; a few such, and what rings.
    assert np.abs(run["position_m"][:, 2, :2] - exact).max() < 2e-7

    played = sj.load("four_bar").reduced(dynamic=True)
    off = np.linalg.norm(played.history["eccentricity_m"].values[:, 0], axis=1)
    assert 4.9e-4 < off.max() < 1.1 * 5e-4 and sum(event.kind == "contact" for event in played.events) > 5


def test_shipped_slider_crank_knocks_in_its_play(statejump, tmp_path: Path) -> None:
    outcome = statejump("reduced", "--dynamic", "slider_crank")
    assert outcome.status == 0, outcome.output + outcome.errors
    run = sj.read(tmp_path / "results" / "slider_crank_dynamic" / "reduced.h5").models["reduced"]
    off = np.linalg.norm(run.history["eccentricity_m"].values[:, 0], axis=1)
    assert off.max() < 1.1 * 5e-4 and off.min() < 0.9 * 5e-4  # held by the bearing; it crosses the play
    assert sum(event.kind == "contact" for event in run.events) > 5 or len(run.events) > 10
    assert run.history["drive_moment_N_m"].values.shape == (len(run.time_s), 1)


def test_energy_of_a_driven_mechanism_closes_the_better_the_more_steps_it_has() -> None:
    # Second order, until runs part at their impacts. A solve that leaves a rest in every step, as that of what holds and
    # drives once did (3e-4 J at 160 000 steps beside 1e-5 J), is found by its sum.
    case = sj.load("slider_crank")
    coarse, fine = (
        abs(case.changed({"motion.steps_per_cycle": steps, "output.samples_per_cycle": 100}).reduced(dynamic=True)
            .summary["energy_residue_J"]) for steps in (40_000, 160_000))
    assert fine < coarse


def test_weight_hangs_on_bars_as_statics_says() -> None:
    # A bar of 2 kg that hangs from its first node and carries 3 kg: half of it and the load pull.
    made = {
        "case": {"name": "hanging", "kind": "truss"}, "truss": {"dimension": 2, "gravity_m_per_s2": [0.0, -9.81]},
        "node": [{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
                 {"name": "B", "position_m": [0.0, -1.0], "fixed": ["x"], "mass_kg": 3.0}],
        "link": [{"name": "L", "nodes": ["A", "B"], "young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-4,
                  "thermal_expansion_per_K": 2e-5, "mass_kg": 2.0}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 10.0, "cycles": 1, "period_s": 0.1},
    }
    run = sj.load(made).reduced()
    assert run.links["axial_force_N"].values == pytest.approx(-(3.0 + 1.0) * 9.81, rel=1e-9)
    assert sj.load(made).reduced(dynamic=True).links["axial_force_N"].values[0] == pytest.approx(-4 * 9.81, rel=1e-9)
    made["link"][0]["centre_of_mass_m"] = [0.25, 0.0]  # a quarter of the way down
    assert sj.load(made).reduced().links["axial_force_N"].values == pytest.approx(-(3.0 + 0.5) * 9.81, rel=1e-9)


@pytest.mark.parametrize("command", ["reduced", "dem"])
def test_models_without_drives_refuse_them(statejump, command: str) -> None:
    outcome = statejump(command, "slider_crank")
    assert (outcome.status, outcome.failure) == (2, failure("driven_truss", drive="motor"))


def test_a_mechanism_that_starts_from_an_equilibrium_is_told_of_the_drawn_shape(statejump, tmp_path: Path) -> None:
    made = without_play()
    made["motion"]["start"] = "equilibrium"
    write(made, tmp_path / "stuck.toml", [])
    outcome = statejump("reduced", "--dynamic", tmp_path / "stuck.toml")
    assert outcome.status != 0 and outcome.failure == failure("held_mechanism", nodes=['A'], modes=1)


def _set(made: dict[str, Any], place: tuple[Any, ...], value: Any) -> None:
    for key in place[:-1]:
        made = made[key]
    made[place[-1]] = value


@pytest.mark.parametrize(("place", "value", "said"), [
    (("truss", "gravity_m_per_s2"), [9.81], ("gravity_m_per_s2", "2 numbers")),
    (("link", 0, "moment_of_inertia_kg_m2"), -1.0, ("moment_of_inertia_kg_m2", "-1")),
    (("link", 0, "centre_of_mass_m"), [0.1], ("centre_of_mass_m", "2")),
    (("link", 0, "mass_kg"), None, ("link 'crank'", "mass_kg")),
    (("drive", 0, "link"), "crnk", ("drive 'motor'", "crank")),
    (("drive", 0, "angular_velocity_rad_per_s"), None, ("drive 'motor'", "angular_velocity_rad_per_s")),
    (("drive", 0, "table_time_s"), [0.0], ("drive 'motor'", "table_angular_velocity_rad_per_s")),
    (("motion", "masses"), "lumped", ("motion.masses", "link 'crank'", "consistent")),
    (("motion", "start"), "moving", ("start", "drawn")),
])
def test_bad_input_is_one_sentence(statejump, tmp_path: Path, place: tuple[Any, ...], value: Any, said: tuple[str, ...]) -> None:
    made = without_play()
    _set(made, place, value)
    if value is None:
        parent = made[place[0]][place[1]]
        del parent[place[2]]
    write(made, tmp_path / "bad.toml", [])
    outcome = statejump("reduced", "--dynamic", tmp_path / "bad.toml")
    assert outcome.status == 2 and len(outcome.errors.splitlines()) == 1, outcome.errors
    for part in said:
        assert part in outcome.errors
    assert not (tmp_path / "results").exists()


def test_interrupt_keeps_the_samples_so_far(tmp_path: Path) -> None:
    made = without_play()
    made["motion"]["steps_per_cycle"] = 100_000_000
    made["output"] = {"samples_per_cycle": 100_000}
    write(made, tmp_path / "long.toml", [])
    process = subprocess.Popen(
        [COMMAND, "reduced", "--dynamic", "long.toml"], cwd=tmp_path, text=True, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    assert process.stdout is not None and "0 %" in process.stdout.readline()
    time.sleep(3)  # a sample takes a few hundredths of a second
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    folder = tmp_path / "results" / "slider_crank_dynamic"
    assert process.returncode == 130, errors
    said = errors.splitlines()[-1]
    assert said.startswith("interrupted; the ") and said.endswith("reduced.interrupted.h5"), errors
    kept = sj.read(folder / "reduced.interrupted.h5").models["reduced"]
    assert 1 < len(kept.time_s) < 100_001 and f"the {len(kept)} samples" in said
    assert results_in(folder) == [
        "reduced.interrupted.h5", "reduced_history.interrupted.csv"]


def test_steps_without_solution_are_damped_and_reported(statejump, tmp_path: Path) -> None:
    made = without_play()
    made["motion"]["steps_per_cycle"] = 10  # the crank turns by 2.5 rad in a step
    made["output"] = {"samples_per_cycle": 10}
    write(made, tmp_path / "coarse.toml", [])
    outcome = statejump("reduced", "--dynamic", tmp_path / "coarse.toml")
    assert outcome.status == 0, outcome.errors
    said, = sj.load(tmp_path / "coarse.toml").reduced(dynamic=True).warnings
    assert said == note("steps_damped") and said in outcome.output
