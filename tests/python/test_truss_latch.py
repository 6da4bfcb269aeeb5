# SPDX-License-Identifier: GPL-3.0-or-later
"""Latch hinges: closed forms of a lever, equality with a torsion spring if the play is zero, use in cases, drawings and
commands."""
from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import statejump as sj

from conftest import REPOSITORY, Outcome
from failures import Failure, failing, failure
from test_report import pytestmark as needs_page

from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump import _paths
from statejump.kinds.truss import dem, generate, solve
from statejump.kinds.truss.contact_problems import contact_problems
from statejump.kinds.truss.generate.document import document, finished, node, to_toml
from statejump.results.read import read

L_M, H_M, RIGIDITY_N, EXPANSION = 0.5, 0.4, 7e5, 2e-5
PLAY_RAD, STIFFNESS, FRICTION_N_M = 5e-4, 200.0, 3.0


def lever(**hinge: Any) -> dict[str, Any]:
    """A lever AB on a latch hinge on the ground. A strut CB, heated by 100 K, lifts the lever."""
    made = document("lever", "Lever on a latch hinge", "closed form", 2, 100.0, "triangle", 1, 1.0)
    made["node"] += [node("A", (0, 0), "xy"), node("B", (L_M, 0)), node("C", (L_M, -H_M), "xy")]
    bar = {"young_modulus_Pa": 70e9, "cross_section_area_m2": RIGIDITY_N / 70e9, "density_kg_per_m3": 2700.0}
    made["link"] += [{"name": "AB", "nodes": ["A", "B"], **bar, "thermal_expansion_per_K": 0.0},
                     {"name": "CB", "nodes": ["C", "B"], **bar, "thermal_expansion_per_K": EXPANSION}]
    made["latch_hinge"] = [{
        "name": "latch", "links": ["AB"], "deadband_rad": PLAY_RAD, "stiffness_N_m_per_rad": STIFFNESS,
        "friction_moment_N_m": FRICTION_N_M, **hinge,
    }]
    return finished(made)


def path(made: dict[str, Any], **options: Any) -> solve.TrussPath:
    return solve.path(parse_case(made).resolve(), **options)


# Rotations are 1e-3: a lever of L turns by its lift over L, and the strut stays upright, to a thousandth of that.
SMALL = 2e-3


def test_lever_slips_goes_through_its_play_and_jumps_as_the_closed_form() -> None:
    """The free expansion of the strut is the lift plus its compression by the force M/L: eps H = L phi + c M, with c =
    H / (E A L)."""
    found = path(lever())
    states, compliance = found.states, H_M / (RIGIDITY_N * L_M)
    slip, turn, back = found.events[0], found.events[1], found.events[2]
    assert [event.after for event in (slip, turn, back)] == ["slip_plus", "stick", "slip_minus"]
    assert slip.temperature_change_K == pytest.approx(compliance * FRICTION_N_M / (EXPANSION * H_M), rel=SMALL)
    hot = int(np.argmax(states["temperature_change_K"]))
    growth = EXPANSION * 100.0 * H_M
    highest = (growth - compliance * (FRICTION_N_M - STIFFNESS * PLAY_RAD)) / (L_M + compliance * STIFFNESS)
    assert highest > 2 * PLAY_RAD
    rotation, moment = states["hinge_rotation_rad"][:, 0], states["hinge_moment_N_m"][:, 0]
    assert rotation[hot] == pytest.approx(highest, rel=SMALL)
    assert moment[hot] == pytest.approx(FRICTION_N_M + STIFFNESS * (highest - PLAY_RAD), rel=SMALL)
    # Cooling turns the friction's moment round before the lever moves.
    turned = 2 * compliance * FRICTION_N_M / (EXPANSION * H_M)
    assert 100.0 - back.temperature_change_K == pytest.approx(turned, rel=5 * SMALL)
    # At the end only friction is left, and keeps the lever up.
    assert moment[-1] == pytest.approx(-FRICTION_N_M, rel=1e-9)
    assert rotation[-1] == pytest.approx(compliance * FRICTION_N_M / L_M, rel=SMALL)
    # The moment is that of the strut: statics, exact at the turned place.
    place = found.truss.nodes.position_m[1] + states["displacement_m"][:, 1]
    strut = place - found.truss.nodes.position_m[2]
    along = strut / np.linalg.norm(strut, axis=1)[:, None]
    arm = place[:, 0] * along[:, 1] - place[:, 1] * along[:, 0]
    assert moment == pytest.approx(states["axial_force_N"][:, 1] * arm, rel=1e-9, abs=1e-9)
    # Heat: the friction's moment over all that the hinge turned, both ways.
    heat = FRICTION_N_M * (2 * rotation.max() - rotation[-1])
    assert states["latch_hinge_dissipation_J"][-1, 0] == pytest.approx(heat, rel=1e-6)


def test_energy_is_kept_across_the_edges_of_plays_and_of_cables() -> None:
    """Steps end where a play closes or a slack cable becomes taut. The work is then fourth-order accurate, (1/20)^4 of
    the bending energy.

    The boom rotates by 0.01 rad and crosses its play twice; steps across its ends would cause an error of 1e-4."""
    for name in ("latch_lever", "latch_boom", "chain_cable"):
        case = sj.load(REPOSITORY / f"cases/trusses/{name}.toml").changed({"reduced.increments_per_branch": 20})
        run = case.reduced()
        work = run["thermal_work_J"] + run["external_work_J"]
        residue = work - run["elastic_energy_J"] - run["friction_dissipation_J"]
        assert np.abs(residue - residue[0]).max() < 1e-10 * np.abs(work).max(), name


def test_increments_do_not_matter() -> None:
    few, many = (path(lever(), increments_per_branch=k, locate_events=False) for k in (3, 200))
    ends = [found.cycle_ends["displacement_m"][-1] for found in (few, many)]
    assert ends[0] == pytest.approx(ends[1], rel=0, abs=1e-6 * np.abs(ends[1]).max())


def test_hinge_without_play_and_friction_is_a_torsion_spring() -> None:
    spring = generate.umbrella(1)
    latch = {**spring, "latch_hinge": [{
        "name": "latch", "links": ["AB", "CB"], "deadband_rad": 0.0, "stiffness_N_m_per_rad": 1.0,
        "preload_moment_N_m": -0.05,
    }]}
    del latch["torsion_spring"]
    one, other = path(spring), path(latch)
    changes = [[event.after for event in found.events if event.name == "joint"] for found in (one, other)]
    assert changes[0] == changes[1]
    assert one.cycle_ends["displacement_m"] == pytest.approx(other.cycle_ends["displacement_m"], rel=0, abs=1e-13)


def test_links_within_the_play_of_a_latch_are_slack() -> None:
    """Within the play of a latch without friction, nothing holds the links of a rib, so their forces are zero."""
    made = generate.umbrella(1)
    del made["torsion_spring"]
    made["latch_hinge"] = [{"name": "latch", "links": ["AB", "CB"], "deadband_rad": 0.1,
                            "stiffness_N_m_per_rad": 1.0}]
    found = path(made)
    assert [(note["kind"], note["joints"]) for note in found.notes] == [("slack", [("revolute", "joint")])]
    assert np.abs(found.states["axial_force_N"]).max() < 1e-6 and np.all(found.states["normal_force_N"] == 0)


def test_runs_have_its_columns_and_its_events() -> None:
    case = parse_case(lever())
    run = case.behaviour.reduced(case, lambda share: None)
    assert run.history["hinge_moment_N_m"].unit == "N m" and run.history["hinge_rotation_rad"].items == "latch_hinges"
    assert run["friction_dissipation_J"][-1] > 0
    assert [event.kind for event in run.events][:1] == ["first_slip"] and run.events[0].joint == "latch"
    problems = contact_problems(case, 6)
    assert max(one.merit.largest for one in problems) <= 1e-10


def test_commands(statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    case = tmp_path / "lever.toml"
    case.write_text(to_toml(lever()))
    for words in (("reduced",), ("truss", "draw"), ("truss", "answers", "--no-sensitivity")):
        done = statejump(*words[:2] if words[0] == "truss" else words, case, *words[2:])
        assert done.status == 0, (words, done.errors)
    assert statejump("info", tmp_path / "results" / "lever" / "reduced.h5").status == 0
    assert statejump("reduced", "--dynamic", case).status == 0


@pytest.mark.parametrize("name", ["latch_lever", "latch_boom"])
def test_dem_goes_through_the_play_and_slips_as_the_path(statejump: Callable[..., Outcome], tmp_path: Path,
                                                         name: str) -> None:
    done = statejump("compare", "--results", tmp_path, _paths.SHARE / "cases" / "trusses" / f"{name}.toml")
    assert done.status == 0, done.output + done.errors
    found = read(tmp_path / name / "comparison.h5")
    rows = {row.name: row.values["dem"] for row in found.rows or ()}
    # A strut's tip, 9 g on 1.75e6 N/m, follows its end within v / omega: 1.6 mm/s over 1.4e4 /s are 1.2e-7 m of 0.8 mm
    # wherever the speed turns; dashpots of 0.1 take that away long before the next sample.
    assert rows["displacement_largest_rms_over_largest"] < 1.5e-4
    assert rows["jump_largest_difference_over_largest_jump_or_loop"] < 1e-6
    assert abs(rows["energy_residual_over_friction_work"]) < 1e-6
    runs = list(found.models.values())
    play = 5e-4
    assert all(run.history["hinge_rotation_rad"].values.max() > 2 * play for run in runs)
    path_events, dem_events = ([(event.kind, event.joint, event.time_s) for event in run.events] for run in runs)
    assert [event[:2] for event in dem_events] == [event[:2] for event in path_events] and len(dem_events) >= 3
    # The DEM is sampled 200 times a second; a joint that turns back is told at the sample after.
    assert [event[2] for event in dem_events] == pytest.approx([event[2] for event in path_events], abs=1.5 / 200)


def test_dem_begins_with_the_friction_of_the_path() -> None:
    """The preload moment exceeds the friction limit: friction acts at its limit, the truss carries the rest."""
    case = parse_case(lever(preload_moment_N_m=-5.0, deadband_rad=0.1))
    start = solve.solve(case)
    values = dem.resolved(case, start)["latch_hinge"]
    assert values["start_friction_N_m"] == pytest.approx([FRICTION_N_M], rel=1e-9)
    run = case.behaviour.dem(case, lambda share: None)
    assert run.history["hinge_moment_N_m"].values[0, 0] == pytest.approx(-2.0, rel=1e-9)


def test_what_the_dem_cannot_turn_is_refused() -> None:
    case = parse_case(lever())
    found = path(lever())
    found.states["hinge_rotation_rad"][3, 0] = 1.6
    with failing("dem_large_rotation", joint="latch"):
        dem.resolved(case, found)


def test_vtk_files_have_it_as_a_point(tmp_path: Path) -> None:
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    from statejump.kinds.truss.answers import vtk

    found = path(lever())
    vtk.series(found, tmp_path, "path", 0)
    hot = int(np.argmax(found.states["temperature_change_K"]))
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(sorted(tmp_path.glob("*.vtu"))[hot]))
    reader.Update()
    grid, cells = reader.GetOutput(), reader.GetOutput().GetCellData()
    # Two links, then the hinge, at A.
    assert grid.GetNumberOfCells() == 3 and grid.GetCell(2).GetPointId(0) == 0
    assert [cells.GetAbstractArray("name").GetValue(k) for k in range(3)] == ["AB", "CB", "latch"]
    for name in ("hinge_rotation_rad", "hinge_moment_N_m"):
        values = [cells.GetArray(name).GetValue(k) for k in range(3)]
        assert np.isnan(values[:2]).all() and values[2] == found.states[name][hot, 0] != 0
    assert cells.GetArray("status").GetValue(2) == found.states["latch_hinge_status"][hot, 0]


@needs_page
@pytest.mark.parametrize("command", [("reduced",), ("truss", "answers")])
def test_page(statejump: Callable[..., Outcome], tmp_path: Path, command: tuple[str, ...]) -> None:
    case = tmp_path / "lever.toml"
    case.write_text(to_toml(lever()))
    assert statejump(*command, case).status == 0
    report = statejump("report", tmp_path / "results" / "lever")
    assert report.status == 0, report.errors
    assert "1 latch hinge" in (tmp_path / "results" / "lever" / "report.html").read_text()


@pytest.mark.parametrize("change, sentence", [
    ({"deadband_rad": -1e-3}, failure("out_of_range", item="latch_hinge 'latch'", key="deadband_rad", value=-0.001)),
    ({"links": ["AX"]}, failure("misspelt_reference", item="latch_hinge 'latch'", key="links", value=["AX"], meant="AB", what_it_is="link", name="AX", joint="latch")),
    ({"links": ["AB", "AB"]}, failure("equal_links", item="latch_hinge 'latch'", key="links", value=["AB", "AB"], joint="latch")),
    ({"axis": [0.0, 0.0, 1.0]}, failure("planar_axis", item="latch_hinge 'latch'", key="axis", value=[0.0, 0.0, 1.0], joint="latch")),
])
def test_mistakes(change: dict[str, Any], sentence: Failure) -> None:
    with pytest.raises(StatejumpError) as refused:
        parse_case(lever(**change)).resolve()
    assert refused.value == sentence


@needs_page
def test_page_ranks_the_latch_by_its_heat_and_its_turn(statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    case = tmp_path / "lever.toml"
    case.write_text(to_toml(lever()))
    assert statejump("reduced", case).status == 0
    done = statejump("report", tmp_path / "results" / "lever", "-o", tmp_path / "page.html")
    assert done.status == 0, done.errors
    page = (tmp_path / "page.html").read_text()
    assert "hinge latch" in page and "Rotation of latch" in page
    assert "of friction" in page and "Turn of" in page
    found = read(tmp_path / "results" / "lever" / "reduced.h5").models["reduced"]
    heat = found["latch_hinge_dissipation_J"]
    assert heat[-1, 0] == pytest.approx(found["friction_dissipation_J"][-1], rel=1e-12) and heat[-1, 0] > 0
