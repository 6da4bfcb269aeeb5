# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses without joints or links, and jumps that are zero or only rounding: every command ends with a clear sentence.
"""
from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import note
import statejump as sj
from statejump.core.notes import Note
from statejump.core.run import Column, Run
from statejump.kinds.truss import compare
from statejump.kinds.truss.generate.document import write
from statejump.kinds.truss.scales import COORDINATES, ROUNDING, scales
from statejump.results.read import read

BAR = {"young_modulus_Pa": 110e9, "cross_section_area_m2": 5e-5, "thermal_expansion_per_K": 9e-6,
       "density_kg_per_m3": 4400.0}
LOAD_N = [340.0, -810.0]


def frame(**more: Any) -> dict[str, Any]:
    """Three planar bars, one more than needed, under a load that is no round number, to cause rounding."""
    nodes = [("A", [0.0, 0.0]), ("B", [0.9, 0.07]), ("C", [1.63, -0.11])]
    return {
        "case": {"name": "frame", "kind": "truss"}, "truss": {"dimension": 2},
        "node": [*({"name": name, "position_m": at, "fixed": ["x", "y"]} for name, at in nodes),
                 {"name": "P", "position_m": [0.71, 0.83], "force_N": LOAD_N}],
        "link": [{"name": f"{name}P", "nodes": [name, "P"], **BAR} for name, _ in nodes],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 85.0, "period_s": 0.2}, **more,
    }


def oscillator(**more: Any) -> dict[str, Any]:
    """A mass on two springs, held by a slider: no link."""
    return {
        "case": {"name": "oscillator", "kind": "truss"}, "truss": {"dimension": 2},
        "node": [{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
                 {"name": "M", "position_m": [0.4, 0.0], "fixed": ["y"], "mass_kg": 0.3, "force_N": [2.0, 0.0]},
                 {"name": "B", "position_m": [1.1, 0.0], "fixed": ["x", "y"]}],
        "spring": [{"name": "AM", "nodes": ["A", "M"], "stiffness_N_per_m": 900.0},
                   {"name": "MB", "nodes": ["M", "B"], "stiffness_N_per_m": 400.0}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 20.0}, **more,
    }


SLIDER = {"name": "S", "nodes": ["M"], "axis": [1.0, 0.0], "friction_coefficient": 0.2, "normal_force_N": 50.0}


def file_of(folder: Path, made: dict[str, Any]) -> Path:
    write(made, folder / f"{made['case']['name']}.toml", [])
    return folder / f"{made['case']['name']}.toml"


def test_answers_without_joints(statejump, tmp_path: Path) -> None:
    done = statejump("truss", "answers", file_of(tmp_path, frame()), "--frames", "2")
    assert done.status == 0, done.errors
    said = " ".join(done.output.split())
    answers = read(tmp_path / "results" / "frame" / "answers.h5").answers
    assert answers is not None and answers.verdict == "no jump" and answers.verdict_text in said
    assert answers.notes[-1] == Note("nothing_ranked") and answers.notes[-1] in said and "not resolved" not in said
    assert ": jump 0 m" in said
    assert statejump("report", "results/frame/answers.h5").status == 0


def test_control_without_joints(statejump, tmp_path: Path) -> None:
    path = file_of(tmp_path, frame())
    done = statejump("control", path)
    (sentence,) = sj.truss.control(sj.load(path)).sentences
    assert sentence == note("nothing_to_control") and done.status == 0 and sentence in done.output, done.output + done.errors
    done = statejump("control", path, "--jump-below", "1e-6", "--add-spring", "A", "P")
    sentence = sj.truss.control(sj.load(path), jump_below=1e-6, add_spring=[("A", "P")]).sentences[0]
    assert sentence == note("nothing_needed") and done.status == 0 and sentence in " ".join(done.output.split())


@pytest.mark.parametrize("command", [("reduced",), ("reduced", "--dynamic"), ("truss", "draw"),
                                     ("truss", "creak", "--node", "P"), ("fe",)])
def test_commands_without_joints(statejump, tmp_path: Path, command: tuple[str, ...]) -> None:
    done = statejump(*command, file_of(tmp_path, frame(motion={"steps_per_cycle": 2000})))
    assert done.status == 0, done.errors
    if command == ("reduced",):
        assert "rounding between" in " ".join(done.output.split())
        assert statejump("report", "results/frame/reduced.h5").status == 0
        assert "No node" in (tmp_path / "results" / "frame" / "report.html").read_text()


def test_without_links(statejump, tmp_path: Path) -> None:
    free = sj.load(oscillator()).reduced()
    # 2 N on 900 and 400 N/m in parallel.
    assert free["displacement_m"][:, 1, 0] == pytest.approx(2.0 / 1300.0, rel=1e-9)
    path = file_of(tmp_path, oscillator(slider=[SLIDER]))
    for command in (("reduced",), ("truss", "answers"), ("control",), ("truss", "draw"), ("reduced", "--dynamic")):
        done = statejump(*command, path)
        assert done.status == 0, (command, done.errors)
    assert statejump("report", "results/oscillator/reduced.h5").status == 0


def test_scales_do_not_vanish() -> None:
    truss = sj.load(frame()).definition.resolve()
    still = np.zeros((2, 4, 3))
    found = scales(truss, still)
    strain = 9e-6 * 85.0
    assert found.motion_m == pytest.approx(1.63 * strain) and found.rounding_m == pytest.approx(ROUNDING * 1.63 * strain)
    assert found.force_N == pytest.approx(110e9 * 5e-5 * strain)
    # Without expansion the shortest bar under the load, sqrt(0.19² + 0.76²) m long.
    loaded = sj.load(frame(thermal={"shape": "triangle", "temperature_change_max_K": 0.0})).definition.resolve()
    assert scales(loaded, still).motion_m == pytest.approx(np.hypot(*LOAD_N) * np.hypot(0.19, 0.76) / (110e9 * 5e-5))
    # Neither motion nor expansion: the rounding of coordinates is left.
    unloaded = replace(loaded, nodes=replace(loaded.nodes, force_N=still[0]))
    assert scales(unloaded, still).rounding_m == pytest.approx(1.63 * COORDINATES)
    moved = still.copy()
    moved[1, 3, 1] = 0.5
    assert scales(truss, moved).motion_m == 0.5


def shifted(run: Run, by_m: float) -> Run:
    """Return a run in the form of a DEM run whose last sample is displaced by rounding."""
    moved = run["displacement_m"].copy()
    moved[-1, 3, 0] += by_m
    nothing = Column(np.zeros(len(run)), "J")
    return replace(run, model="dem", history={**run.history, "displacement_m": Column(moved, "m", "nodes")},
                   energy={**run.energy, "kinetic_energy_J": nothing, "damping_dissipation_J": nothing,
                           "impact_dissipation_J": nothing}, sampler=None)


@pytest.mark.parametrize("load", [LOAD_N, None])
def test_zero_beside_zero_passes(load: list[float] | None) -> None:
    made = frame()
    made["node"][3]["force_N"] = load
    case = sj.load(made).definition
    run = case.behaviour.reduced(case, lambda share: None)
    motion_m = scales(case.resolve(), run["displacement_m"]).motion_m
    # A hundredth of the difference of displacements that the case allows is allowed to a jump of zero.
    assert compare.compare(case, run, shifted(run, 0.9e-4 * motion_m)).passed
    missed = compare.compare(case, run, shifted(run, 1.1e-4 * motion_m))
    assert [name for name in missed.missed if name.startswith("jump")] == [
        name for name in (row.name for row in missed.rows) if name.startswith("jump")]


def test_compare_without_joints(statejump, tmp_path: Path) -> None:
    done = statejump("compare", file_of(tmp_path, frame(thermal={
        "shape": "triangle", "temperature_change_max_K": 85.0, "period_s": 1.0})))
    assert done.status == 0, done.output + done.errors
