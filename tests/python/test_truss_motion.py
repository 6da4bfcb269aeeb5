# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses in motion, through the command and from Python."""
from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest

from failures import failure, note
import statejump as sj
from statejump.kinds.truss import generate, motion
from statejump.kinds.truss.generate.document import write
from statejump.results.read import read

K = 70e9 * 9e-6 / 0.5  # stiffness of a bar of Table 1 [N/m]
FRICTION = 100.0


def chain(**changes: Any) -> dict[str, Any]:
    made = generate.chain(3, friction_force_N=FRICTION, cycles=1, period_s=0.1)
    made.setdefault("motion", {}).update(changes)
    return made


def case_file(folder: Path, made: dict[str, Any]) -> Path:
    path = folder / f"{made['case']['name']}.toml"
    write(made, path, [])
    return path


def test_a_truss_that_is_held_everywhere_carries_heat_and_does_not_move(statejump, tmp_path: Path) -> None:
    made = chain()
    del made["slider"]
    made.update(node=[{**node, "fixed": ["x", "y", "z"][:made["truss"]["dimension"]]} for node in made["node"]])
    run = sj.load(made).reduced()
    assert not np.any(run.history["displacement_m"].values)
    links, change = made["link"], run.history["temperature_change_K"].values.max()
    at = int(np.argmax(run.history["temperature_change_K"].values))
    strain = links[0]["thermal_expansion_per_K"] * change
    # Of the length that is free of stress.
    assert run.links["axial_force_N"].values[at, 0] == pytest.approx(
        links[0]["young_modulus_Pa"] * links[0]["cross_section_area_m2"] * strain / (1 + strain), rel=1e-12)
    refused = statejump("reduced", "--dynamic", case_file(tmp_path, made))
    assert refused.status == 2 and refused.failure == failure("no_free_dof")


def test_chain_in_motion_is_written_beside_the_quasi_static_run(statejump, tmp_path: Path) -> None:
    outcome = statejump("reduced", "--dynamic", case_file(tmp_path, chain()))
    assert outcome.status == 0, outcome.output + outcome.errors
    assert "contact problems" in outcome.output
    folder = tmp_path / "results" / "chain_3_dynamic"
    run = read(folder / "reduced.h5").models["reduced"]
    # All blocks slide at the end. Inertia: m a of the tip, 1e-2 N at 3.3 mm in 0.05 s, beside 100 N; the last step of
    # heating and of cooling moves the tip by 1e-3 of the way less or more.
    jump = float(np.linalg.norm(run["displacement_m"][-1] - run["displacement_m"][0], axis=1).max())
    assert jump == pytest.approx(FRICTION / K * 6, rel=1e-3)
    assert run.history["velocity_m_per_s"].values.shape == run.history["displacement_m"].values.shape
    heat = run["friction_dissipation_J"]
    assert heat[-1] > 0.1 and np.all(np.diff(heat) > -1e-9 * heat[-1])
    assert abs(run.summary["energy_residue_J"]) < 1e-6 * heat[-1]
    assert (folder / "reduced_history.csv").exists()


def test_masses_are_those_of_rods_or_of_the_dem() -> None:
    # A bar whose end is free swings at the frequency of m/3 at its tip, and so does the lumped one; rods between two
    # moving nodes differ.
    runs = [sj.load(chain(masses=masses)).reduced(dynamic=True) for masses in ("consistent", "lumped")]
    apart = np.abs(runs[0]["displacement_m"] - runs[1]["displacement_m"]).max()
    assert 0 < apart < 1e-2 * np.abs(runs[0]["displacement_m"]).max()
    assert runs[0].summary["unknowns"] == 3


@pytest.mark.parametrize(("key", "value"), [
    ("theta", 0.4), ("restitution", 1.2), ("steps_per_cycle", 5), ("masses", "heavy"), ("displacement_tolerance_m", 0),
])
def test_keys_out_of_range_are_refused(statejump, tmp_path: Path, key: str, value: Any) -> None:
    outcome = statejump("reduced", "--dynamic", case_file(tmp_path, chain(**{key: value})))
    assert outcome.status == 2
    assert (outcome.failure.key, outcome.failure.value) == (f"motion.{key}", value) and len(outcome.errors.splitlines()) == 1
    assert not (tmp_path / "results").exists()


def test_kinds_whose_reduced_model_is_no_truss_are_refused(statejump, tmp_path: Path) -> None:
    outcome = statejump("reduced", "--dynamic", "table1")
    assert outcome.status == 2 and outcome.failure == failure("command_not_for_kind", key="case.kind", value="spring_slider", command="reduced --dynamic", kinds="'truss'")


def test_motion_beside_the_dem(statejump, tmp_path: Path) -> None:
    outcome = statejump("compare", "--dynamic", case_file(tmp_path, chain(masses="lumped")))
    assert outcome.status == 0, outcome.output + outcome.errors
    assert (tmp_path / "results" / "chain_3_dynamic" / "comparison.csv").exists()
    refused = statejump("compare", "--dynamic", *[tmp_path / "results" / "chain_3_dynamic" / "comparison.h5"] * 2)
    assert refused.status == 2 and isinstance(refused.failure, click.UsageError)


def test_creak_tells_slips_and_bands(statejump, tmp_path: Path) -> None:
    outcome = statejump("truss", "creak", case_file(tmp_path, chain()), "--node", "N3")
    assert outcome.status == 0, outcome.output + outcome.errors
    folder = tmp_path / "results" / "chain_3_creak"
    assert {path.name for path in folder.iterdir()} >= {"reduced.h5", "slips.csv", "bands.csv", "spectrum.csv", "creak.png"}
    found = sj.truss.creak(sj.load(chain()), "N3")
    # Every block slides out and back; what friction takes is in the slips.
    slips = found.frame("slips")
    assert set(slips["joint"]) == {"S1", "S2", "S3"} and len(slips) >= 6
    assert slips["heat_J"].sum() == pytest.approx(found.run["friction_dissipation_J"][-1], rel=1e-2)
    # Parseval: octaves add up to the whole, as far as filters of fourth order part them; so does the density, as far as
    # its segments see the slowest motion.
    bands = found.frame("bands")
    assert np.sqrt((bands["rms_m_per_s2"] ** 2).sum()) == pytest.approx(found.rms_m_per_s2, rel=0.1)
    step = np.diff(found.frequency_Hz)[0]
    assert np.sqrt(found.density_m2_per_s4_per_Hz.sum() * step) == pytest.approx(found.rms_m_per_s2, rel=0.1)
    assert bands["peak_m_per_s2"].max() <= 1.5 * found.peak_m_per_s2
    refused = statejump("truss", "creak", tmp_path / "chain_3.toml", "--node", "N9")
    assert (refused.status, refused.failure) == (2, failure("undefined_node", key="node", value="N9", known="N0, N1, N2, N3"))


def test_steps_whose_contacts_keep_their_branches_share_their_factors() -> None:
    # Blocks let go and catch; each time the branches change, and between those times the step is the same.
    found = motion.simulate(sj.load(generate.chain(20)).changed({"motion.steps_per_cycle": 4000}).definition)
    assert len(found.events) > 20
    assert found.factorizations < 2 * len(found.events) < 400


def test_what_a_motion_leaves_open_is_told() -> None:
    found = motion.simulate(sj.load(chain()).definition)
    assert found.warnings == ()
    damped = replace(found, inexact_steps=3).warnings
    assert damped == (note("steps_damped", inexact=3, steps=found.steps, time_step_s=found.time_step_s),)
    open_ended = replace(found, jammed=(0.25, ["S1"]), undetermined=(0.5, ["S1", "S2"]), inexact_steps=3, equal=False)
    assert open_ended.warnings == (
        note("steps_inexact", inexact=3, steps=found.steps), note("joint_jammed", time_s=0.25, joint="S1"),
        note("reactions_not_unique", time_s=0.5, joints=("S1", "S2")))


def test_steps_as_long_as_a_tolerance_allows_meet_equal_ones(statejump, tmp_path: Path) -> None:
    made = chain(displacement_tolerance_m=1e-9)
    equal = sj.load(chain()).changed({"motion.steps_per_cycle": 100_000}).reduced(dynamic=True)
    run = sj.load(made).reduced(dynamic=True)
    # Errors of steps add up over what rings: a few hundred of them, at most.
    assert run.summary["steps"] < 10_000 and run.summary["rejected_steps"] > 0
    assert run.summary["time_step_s"] < 0.1 / run.summary["steps"]
    apart = np.abs(run["displacement_m"] - equal["displacement_m"]).max()
    assert apart < 300e-9
    assert np.array_equal(run.time_s, equal.time_s)
    heat = run["friction_dissipation_J"]
    assert heat[-1] == pytest.approx(equal["friction_dissipation_J"][-1], rel=1e-3)
    outcome = statejump("reduced", "--dynamic", case_file(tmp_path, made))
    assert outcome.status == 0 and f"{run.summary['steps']:,.0f} steps" in outcome.output
    # A spectrum is of equal steps, and so is theta.
    refused = statejump("truss", "creak", tmp_path / "chain_3.toml", "--node", "N3")
    assert (refused.status, refused.failure) == (2, failure("spectrum_of_unequal_steps", key="motion.displacement_tolerance_m", value=1e-9))
    refused = statejump("reduced", "--dynamic", case_file(tmp_path, chain(displacement_tolerance_m=1e-9, theta=1.0)))
    assert (refused.status, refused.failure) == (2, failure("theta_without_equal_steps", key="motion.theta", value=1.0))


def test_branches_that_are_not_found_at_once_are_sought_in_a_shorter_step() -> None:
    # A journal crosses its bearing and knocks in a tenth of the cycle, whatever the tolerance.
    case = sj.load(generate.umbrella(1, period_s=1.0)).changed({
        "motion.displacement_tolerance_m": 1.0, "output.samples_per_cycle": 10})
    found = motion.simulate(case.definition)
    assert found.rejected_steps > 0
    assert found.iterations == 0  # no contact problem
    assert found.steps < 60


def test_blocks_that_let_go_by_the_dozen_find_their_branches_in_one_step() -> None:
    # Pivots of all blocks at once come back to where they were.
    case = sj.load(generate.chain(50, friction_force_N=30.0, period_s=0.1)).changed({
        "motion.displacement_tolerance_m": 1.0, "output.samples_per_cycle": 10})
    found = motion.simulate(case.definition)
    assert (found.steps, found.rejected_steps, found.iterations) == (10, 0, 0)
