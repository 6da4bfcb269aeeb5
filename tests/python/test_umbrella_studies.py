# SPDX-License-Identifier: GPL-3.0-or-later
"""Slow heating, a joint at constant temperature, the energy account over time steps, reproducibility in all bits."""
from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from conftest import BUILT, REPOSITORY
from failures import failure
from statejump import _paths
from studies.paper import commands, ensembles
from statejump.core import yade_process
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import load_case
from statejump.kinds.umbrella import dem, reduced as model
from studies.paper import energy, hold, slow
from studies.paper.common import made_by
from statejump.schema.paths import with_values


@pytest.fixture(scope="module")
def bias():
    return load_case(Path(__file__).parents[2] / "cases" / "umbrella_bias.toml")


@pytest.fixture(scope="module")
def damped():
    return load_case(Path(__file__).parents[2] / "cases" / "umbrella_damped.toml")


@pytest.fixture(scope="module")
def left_alone():
    return load_case(Path(__file__).parents[2] / "cases" / "umbrella_hold.toml")


def block(case, name: str) -> slow.Block:
    return next(entry for entry in slow.blocks(case) if entry.name == name)


def differences(of: slow.Block, periods) -> np.ndarray:
    """theta2 and theta4 jump less the quasi-static one, per period."""
    found = [slow.jumps(model.run(slow.at_period(of.case, period))) for period in periods]
    return np.array(found) - of.quasi_static_rad


def test_slow_jump_tends_to_the_elastic_loop(bias):
    found = np.abs(differences(block(bias, "case"), (2, 4, 8)))
    assert np.all(found[1:] < found[:-1] / 2)  # at least as 1/T
    assert np.all(found[-1] < 2e-7)
    assert differences(block(bias, "case"), [32])[0] == pytest.approx(block(bias, "case").predict(32), rel=0.01)


@pytest.mark.parametrize("name", ["pin_damping", "frictionless"])
def test_lag_of_the_pins_is_the_one_over_t_term(bias, name):
    of = block(bias, name)
    for period in (8, 16):
        # the quasi-static rates that the prediction uses leave a term of the order of 1/T²
        assert differences(of, [period])[0] == pytest.approx(of.predict(period), rel=2e-3)
    assert of.predict(16)[0] == pytest.approx(of.predict(8)[0] / 2, rel=2e-2)


def test_frictionless_jump_tends_to_zero(bias):
    of = block(bias, "frictionless")
    assert np.abs(of.quasi_static_rad) == pytest.approx([0, 0], abs=1e-14)
    found = np.abs(differences(of, (2, 4, 8, 16)))[:, 0]
    assert np.all(found[1:] < 0.54 * found[:-1]) and found[-1] < 3e-8  # as 1/T, the swing still dying out


def test_unloaded_joint_converges_as_the_root_only(bias):
    of = block(bias, "unloaded")
    found = differences(of, (1, 16, 32))[:, 0]
    assert found[0] == pytest.approx(1.6e-4, rel=0.05)  # a jump that is none
    assert 0.5 < math.log2(found[1] / found[2]) < 0.62
    assert found[2] / of.predict(32)[0] == pytest.approx(1.0, abs=0.2)
    assert of.predict(32)[0] == pytest.approx(of.predict(8)[0] / 2)


def test_dem_jump_is_the_reduced_one(bias):
    # Where slip and stick change, a model is late by up to a step dt. The swing stands still there, so
    # that costs omega^2 dt^2 of its amplitude, c atan(mu) at most; over the joint's height h that is an
    # angle. omega^2 = F |AC|^2/(c I): pendulum of both links' inertia I under the joint force F.
    case = slow.at_period(bias, 2.0)
    ours, other = slow.jumps(model.run(case)), slow.jumps(ensembles.execute_all([case])[0])
    height, play = bias.ideal_position_m[1], bias.joint.radial_clearance_m
    force = bias.torsion_spring.stiffness_N_m_per_rad * bias.torsion_spring.bias_rad / height
    inertia = sum(link.mass_kg / 3 * link.stress_free_length_m**2 for link in (bias.link_ab, bias.link_bc))
    swing = force * bias.frame.length_m**2 / (play * inertia)
    step = case.period_s / dem.number_of_steps(case)
    tolerance = swing * step**2 * play * math.atan(bias.joint.friction_coefficient) / height
    assert tolerance == pytest.approx(1.7e-9, rel=0.1)
    assert other == pytest.approx(ours, abs=tolerance)


def test_hold_by_mindlin_and_creep_by_ambrosio(left_alone):
    case = hold.held(left_alone, period_s=0.2)
    rate = 100_000
    runs = {(run.law, run.model): run for run in [
        *(hold.run_reduced(case, law, rate) for law in hold.LAWS),
        *hold.run_dem([(law, rate) for law in hold.LAWS], case, lambda: None),
    ]}
    creep = hold.predict(case)
    assert runs["mindlin", "reduced"].drift_m < 1e-9
    # the fresh contact overshoots, at most to twice T/k_t
    assert creep.first_slide_m < runs["mindlin", "DEM"].drift_m < 2 * creep.first_slide_m
    assert runs["mindlin", "DEM"].settled_drift_m < 1e-9
    for name in ("reduced", "DEM"):
        run = runs["ambrosio", name]
        assert run.creep_rate_m_per_s == pytest.approx(creep.creep_rate_m_per_s, rel=0.02)
        assert run.slide_m[-1] == pytest.approx(np.interp(0.2, creep.time_s, creep.slide_m), rel=0.02)
    # v0 + (v1 - v0) T/(mu F_N), T/F_N = tan phi: what the prediction starts with
    start = 1e-5 + 9e-5 * math.tan(0.0744449738045623) / 0.15
    assert hold.creep_rate_at_start(case) == pytest.approx(start)
    assert creep.slide_m[1] / creep.time_s[1] == pytest.approx(-start, rel=1e-3)


def test_energy_residue_falls_with_the_steps(damped):
    found = energy.study(
        energy.variants(damped), lambda fraction: None, energy.REDUCED_STEPS_PER_SECOND[:6],
        energy.DEM_STEPS_PER_SECOND[:3],
    )
    fits = {(result.variant.name, row.model, row.instant): row.fit for result in found for row in result.rows}
    for name in ("reduced", "DEM"):
        for instant in ("heating", "end"):
            assert fits["as_case", name, instant] > 0.95, (name, instant)
    assert fits["conservative", "reduced", "heating"] > 2.5  # then chaos
    # free ringing: the integrators' own orders
    assert fits["conservative", "reduced", "before contact"] > 4.3
    assert fits["conservative", "DEM", "before contact"] == pytest.approx(2, abs=0.3)
    finest = [row for row in found[1].rows if row.model == "reduced" and row.instant == "before contact"]
    assert [row.order for row in finest[2:4]] == pytest.approx([5, 5], abs=0.2)
    last = [row for row in found[0].rows if row.instant == "end"]
    assert all(abs(row.residue_over_thermal_work) < 2e-3 for row in last if row.steps_per_second >= 200_000)


def test_energy_book_sees_what_is_missing(damped):
    """An account without one of its terms does not close."""
    variant = energy.variants(damped)[0]
    columns = model.run(energy.with_steps(variant.case, 200_000)).flat()
    whole = abs(energy.residue_J(columns))
    for name in ("friction_dissipation_J", "axial_dissipation_J", "pin_dissipation_J"):
        assert abs(energy.residue_J({**columns, name: 0 * columns[name]})) > 100 * whole, name


KIND = failure("command_not_for_kind", key="case.kind", value="spring_slider", kinds="'umbrella'")
MISTAKES = {
    "slow, other kind": (commands.slow_command, "table1", (), KIND),
    "slow, not loaded": (commands.slow_command, "umbrella_damped", (),
                         failure("not_allowed", key="start.mode", value="matched")),
    "slow, undamped": (commands.slow_command, "umbrella_bias", (("axial_damping_ratio = 0.1", "axial_damping_ratio = 0"),),
                       failure("not_allowed", key="damping.axial_damping_ratio", value=0.0)),
    "slow, no memory": (commands.slow_command, "umbrella_bias",
                        (('friction_law = "mindlin"', 'friction_law = "ambrosio"'),),
                        failure("not_allowed", key="joint.friction_law", value="ambrosio")),
    "slow, force vanishes": (commands.slow_command, "umbrella_bias", (("bias_rad = 0.05", "bias_rad = -0.003"),),
                             failure("contact_force_vanishes")),
    "slow, line contact": (commands.slow_command, "umbrella_bias", (('"hertz_internal"', '"johnson"'),),
                           failure("out_of_range", argument="normal")),
    "hold, other kind": (commands.hold_command, "table1", (), KIND),
    "hold, no spring": (commands.hold_command, "umbrella_damped", (),
                        failure("not_allowed", key="start.mode", value="matched")),
    "hold, no friction": (commands.hold_command, "umbrella_bias",
                          (("friction_coefficient = 0.15", "friction_coefficient = 0"),),
                          failure("not_allowed", key="joint.friction_coefficient", value=0.0)),
    "hold, no clearance to load": (commands.hold_command, "umbrella_bias", (("bias_rad = 0.05", "bias_rad = 0.001"),),
                                   failure("unloaded_joint")),
    "energy, other kind": (commands.energy_command, "table1", (), KIND),
    "energy, constant temperature": (commands.energy_command, "umbrella_hold", (),
                                     failure("not_allowed", key="thermal.temperature_change_max_K", value=0)),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistake_is_one_sentence(name, edited, cases, tmp_path):
    command, case, changes, wanted = MISTAKES[name]
    path = edited(*changes, case=case) if changes else cases / f"{case}.toml"
    outcome = CliRunner().invoke(command, [str(path), "--results", str(tmp_path / "results")])
    assert isinstance(outcome.exception, StatejumpError), outcome.exception
    assert outcome.exception == wanted and "\n" not in str(outcome.exception)
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize("name, shipped", [("figures", "umbrella"), ("slow", "umbrella_bias"), ("hold", "umbrella_hold")])
def test_shipped_case_is_found_from_every_folder(name, shipped, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command = getattr(commands, f"{name}_command")
    given = command.make_context(name, []).params["case_file"]
    assert given == _paths.SHARE / "cases" / f"{shipped}.toml" and load_case(given).name == shipped


def test_energy_finds_a_shipped_case_from_every_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for word in ("cases/umbrella_damped.toml", "umbrella_damped"):
        given = commands.energy_command.make_context("energy", [word]).params["case_file"]
        assert load_case(given).name == "umbrella_damped"


def test_pages_name_the_case_file_that_was_given(edited, cases, tmp_path, monkeypatch):
    own = edited(case="umbrella_damped")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(tmp_path)
    assert made_by("slow", load_case(own)) .split() == ["statejump", "slow", "bad.toml"]
    # A shipped case by the name under which it is found from every folder.
    assert made_by("slow", load_case("umbrella_bias")) .split() == ["statejump", "slow", "cases/umbrella_bias.toml"]
    monkeypatch.chdir(elsewhere)
    assert made_by("hold", load_case(own)) == f"statejump hold {Path('..') / 'bad.toml'}"
    # What is not in a file cannot be named.
    assert made_by("hold", load_case(load_case(own).to_dict())) == "statejump hold"
    assert made_by("hold", load_case(own).changed({"joint.friction_coefficient": 0.2})) == "statejump hold"


def test_studies_leave_the_callers_matplotlib_alone():
    """Drawing changes neither matplotlib's backend nor pyplot, which would open windows."""
    program = """
import sys
import matplotlib
matplotlib.use("svg")
import statejump.kinds.umbrella.figure, studies.paper.energy, studies.paper.hold, studies.paper.slow
import studies.paper.figures.study
from statejump.core.figures import panels
panels(1, 1, (2, 2))
print(matplotlib.get_backend().lower(), "matplotlib.pyplot" in sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", program], env={"PYTHONPATH": f"{BUILT}:{REPOSITORY}"}, capture_output=True, text=True)
    assert done.stdout.split() == ["svg", "False"], done.stderr


def test_dem_gives_the_same_bits_twice(bias):
    values = {"scene": "scene_umbrella", **dem.dem_input(with_values(bias, {
        "thermal.period_s": 0.5, "dem.steps_per_cycle": 50_000, "output.samples_per_cycle": 500, "dem.threads": 1}))}
    first, second = (yade_process.execute(values, lambda share: None) for _ in range(2))
    for run in (first, second):
        del run.about["wall_time_s"], run.about["cpu_time_s"]
    assert first.about == second.about
    assert first.columns.keys() == second.columns.keys()
    for column, column_values in first.columns.items():
        assert column_values.tobytes() == second.columns[column].tobytes(), column


def test_ensemble_does_not_depend_on_the_number_of_workers(cases, monkeypatch):
    case = with_values(load_case(cases / "umbrella.toml"), {
        "ensemble.reduced_steps_per_cycle": 20_000, "output.samples_per_cycle": 100})
    found = {}
    for workers in (1, 2):
        monkeypatch.setattr(ensembles.os, "cpu_count", lambda workers=workers: workers)
        found[workers] = ensembles.ensemble(case, runs=6)
    for name in ("time_s", "theta2_rad", "end_eccentricity_m"):
        assert getattr(found[1], name).tobytes() == getattr(found[2], name).tobytes(), name
    assert len(np.unique(found[1].jump_rad)) == 6  # the starts do differ


def test_studies_are_commands_where_they_are(statejump: Any, tmp_path: Path) -> None:
    assert statejump("slow", "--help").status == 0
    without = ("from statejump import _paths; _paths._SHARE = {!r}\n"
               "from statejump.cli.main import COMMANDS; print('slow' in COMMANDS, 'reduced' in COMMANDS)")
    environment = {**os.environ, "PYTHONPATH": str(BUILT)}
    found = subprocess.run([sys.executable, "-c", without.format(str(tmp_path))], capture_output=True, text=True,
                           check=True, env=environment)
    assert found.stdout.split() == ["False", "True"]
    module = subprocess.run([sys.executable, "-m", "studies.paper", "slow", "--help"], capture_output=True, text=True,
                            check=True, cwd=REPOSITORY, env=environment)
    assert "slower cycles" in " ".join(module.stdout.split())


def test_studies_are_of_ribs(statejump: Any) -> None:
    refused = statejump("slow", "cases/table1.toml")
    assert (refused.status, refused.failure) == (2, failure("command_not_for_kind", command="slow"))
