# SPDX-License-Identifier: GPL-3.0-or-later
"""Outputs of campaigns: any column of a run for a named node or joint, and errors reported before any run."""
from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import Failure, failing, failure
import statejump as sj
from statejump.core.errors import StatejumpError
from test_report import pytestmark as needs_page

TRUSS = "cases/trusses/chain_10.toml"


def test_outputs_are_the_columns_of_the_run() -> None:
    case = sj.load(TRUSS)
    link, node = case.link[0].name, case.node[3].name
    names = [f"jump:position_m[{node}].x", f"end:displacement_m[{node}]", f"max:links.axial_force_N[{link}]",
             f"range:links.angle_rad[{link}]", "min:temperature_change_K"]
    first = case.slider[0].name
    friction = [0.2, 0.3]
    found = sj.sweep(case, {f"slider.{first}.friction_coefficient": friction}, outputs=names).frame()
    for row, value in enumerate(friction):
        run = case.changed({f"slider.{first}.friction_coefficient": value}).reduced()
        columns = run.flat(("history", "energy", "links"))
        moved = np.stack([columns[f"displacement_m[{node}].{axis}"] for axis in "xyz"], axis=1)
        wanted = [moved[-1, 0] - moved[0, 0], np.linalg.norm(moved[-1]), columns[f"links/axial_force_N[{link}]"].max(),
                  np.ptp(columns[f"links/angle_rad[{link}]"]), run["temperature_change_K"].min()]
        np.testing.assert_allclose([found[name][row] for name in names], wanted, rtol=1e-12, atol=1e-15)


def test_ends_alone_need_no_full_run() -> None:
    """Outputs at cycle ends use a quick run with two samples; its jumps agree with a full run's to 1e-6."""
    case = sj.load(TRUSS)
    node = case.node[3].name
    found = sj.sweep(case, {"thermal.cycles": [1]}, outputs=[f"jump:displacement_m[{node}].x"]).frame()
    run = case.reduced()
    columns = run.flat()
    jump = columns[f"displacement_m[{node}].x"][-1] - columns[f"displacement_m[{node}].x"][0]
    assert found[f"jump:displacement_m[{node}].x"][0] == pytest.approx(jump, rel=1e-6)


def test_outputs_of_a_surface_are_its_history() -> None:
    case = sj.load("cases/trusses/umbrella_8.toml")
    names = ["max:surface.pointing_error_rad", "end:surface.rms_rigid_m"]
    found = sj.sweep(case, {"thermal.cycles": [1]}, outputs=names).frame()
    wanted = sj.surface.history(case.reduced())
    assert found[names[0]][0] == wanted["pointing_error_rad"].max()
    assert found[names[1]][0] == wanted["rms_rigid_m"][-1]


def test_a_place_repeats_as_well_as_returns_of_the_temperature_agree() -> None:
    """After heating the block is f l0/(E A) ahead of its initial position, after cooling the same distance behind it.
    """
    table = {"thermal.shape": "table", "thermal.temperature_change_max_K": None, "thermal.period_s": None}
    days = {**table, "thermal.table_time_s": [0, 1, 2, 3, 4, 5, 6],
            "thermal.table_temperature_change_K": [0, 100, 0, -10, 0, 90, 0]}
    jump = 50.0 * 0.3 / (70e9 * 9e-6)
    case = sj.load("table1")
    for changes, wanted in ((days, 2 * jump), ({"thermal.cycles": 3}, 0.0)):
        changed = case.changed(changes)
        found = sj.sweep(changed, {"joint.friction_coefficient": [0.3]}, outputs=["repeat:displacement_m"]).frame()
        assert found["repeat:displacement_m"][0] == pytest.approx(wanted, rel=1e-9, abs=1e-17)


def test_returns_of_a_truss_are_those_of_every_program() -> None:
    case = sj.load(TRUSS)
    node = case.node[3].name
    assert case.changed({"thermal.cycles": 3}).definition.returns_s().tolist() == [1.0, 2.0, 3.0]
    table = {"thermal.shape": "table", "thermal.temperature_change_max_K": None, "thermal.period_s": None,
             "thermal.table_time_s": [0, 1, 2, 3, 4], "thermal.table_temperature_change_K": [0, 100, 0, -100, 0]}
    changed = case.changed(table)
    assert changed.definition.returns_s().tolist() == [2.0, 4.0]
    found = sj.sweep(changed, {"thermal.cycles": [1]}, outputs=[f"repeat:displacement_m[{node}]"]).frame()
    moved = changed.reduced().at(np.array([2.0, 4.0])).history["displacement_m"].values[:, 3]
    assert found[f"repeat:displacement_m[{node}]"][0] == pytest.approx(np.linalg.norm(moved[1] - moved[0]), rel=1e-6)
    assert np.linalg.norm(moved[1] - moved[0]) > 1e-6


def test_bounds_are_those_of_the_varied_case() -> None:
    limits = [50.0, 100.0]
    names = ["bound:spread_m[node:C.x]", "bound:jump_m[node:C.x]", "jump:displacement_m[C].x"]
    found = sj.sweep(sj.load("telescope"), {"slider.S.normal_force_N": limits}, outputs=names).frame()
    case = sj.load("telescope").definition
    whole = case.bounds(output=["node:C.x"], simulate=False).bounds[0].spread_m
    assert found[names[0]].to_numpy() == pytest.approx(whole * np.array(limits) / case.slider[0].normal_force_N, rel=1e-9)
    assert np.all(np.abs(found[names[2]]) <= found[names[1]] * (1 + 1e-6))


@pytest.mark.parametrize("output, sentence", [
    ("bound:spread_m", failure("output_bound_not_chosen", key="outputs", value="bound:spread_m")),
    ("bound:spread_m[Q]", failure("output_item_undefined", key="outputs", value="bound:spread_m[Q]", what_it_is="output of bounds", known="node:NAME.x, rms, tilt, zernike:K, point")),
    ("max:surface.rms_rigid_m", failure("output_without_surface", key="outputs")),
    ("jump", failure("bad_output_name", key="outputs", value="jump")),
    ("mean:displacement_m[N1]", failure("output_how_unknown", key="outputs", value="mean:displacement_m[N1]", hows="end, jump, max, min, range, repeat, bound")),
    ("repeat:displacement_m[N1]", failure("output_without_jump", key="outputs", value="repeat:displacement_m[N1]", times=1)),
    ("jump:displacment_m[N1]", failure("output_misspelt", key="outputs", value="jump:displacment_m[N1]", meant="displacement_m")),
    ("jump:displacement_m", failure("output_item_not_chosen", key="outputs", value="jump:displacement_m", column="displacement_m", items="nodes")),
    ("jump:displacement_m[N1].w", failure("output_axis", key="outputs", value="jump:displacement_m[N1].w", known="x, y, z")),
    ("jump:displacement_m[nowhere at all]", failure("output_item_undefined", key="outputs", value="jump:displacement_m[nowhere at all]", what_it_is="node", known="N0, N1, N2, N3, N4, N5, N6, N7, N8, N9, N10")),
    ("max:axial_force_N[L1]", failure("output_misspelt", key="outputs", value="max:axial_force_N[L1]", meant="links.axial_force_N")),
    ("max:time_s[L1]", failure("output_without_items", key="outputs", value="max:time_s[L1]", column="time_s")),
    ("max:time_s.x", failure("output_not_vector", key="outputs", value="max:time_s.x", column="time_s")),
])
def test_what_is_refused(output: str, sentence: Failure) -> None:
    case = sj.load(TRUSS)
    output = output.replace("N1", case.node[1].name).replace("L1", case.link[0].name)
    with pytest.raises(StatejumpError) as refused:
        sj.sweep(case, {"thermal.cycles": [1]}, outputs=[output])
    assert refused.value == sentence


def test_near_name_of_a_node_is_told() -> None:
    case = sj.load(TRUSS)
    name = case.node[3].name
    with failing("output_misspelt", key="outputs", value="jump:displacement_m[N3x]", meant="N3"):
        sj.sweep(case, {"thermal.cycles": [1]}, outputs=[f"jump:displacement_m[{name}x]"])


def test_command(statejump: Callable[..., Any], tmp_path: Path, cases: Path) -> None:
    (tmp_path / "campaign.toml").write_text(f"""
[campaign]
name = "outputs"
case = "{cases}/table1.toml"
outputs = ["max:axial_force_N", "range:links.axial_force_N[bar]"]
[[vary]]
key = "joint.friction_coefficient"
values = [0.2, 0.3]
""")
    done = statejump("sweep", "campaign.toml")
    assert done.status == 0, done.errors
    with (tmp_path / "results" / "outputs" / "samples.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    force = [float(row["max:axial_force_N"]) for row in rows]
    # The history has samples, the path is exact: the largest force is at most one sample away.
    assert force == pytest.approx([float(row["largest_axial_force_N"]) for row in rows], rel=1e-3)
    ran = json.loads((tmp_path / "results" / "outputs" / "run.json").read_text())
    assert ran["wall_time_s"] >= ran["start_time_s"] >= 0


def test_wall_time_includes_the_start_of_workers() -> None:
    done = sj.sweep(sj.load("table1"), {"joint.friction_coefficient": [0.2, 0.3]}, workers=1).done
    assert 0 < done.start_time_s < done.wall_time_s


def test_a_case_and_a_file_of_distributions_are_a_campaign(
    statejump: Callable[..., Any], tmp_path: Path, cases: Path
) -> None:
    vary = '[[vary]]\nkey = "joint.friction_coefficient"\ndistribution = "normal"\nrelative = 0.1\n'
    (tmp_path / "vary.toml").write_text(vary)
    done = statejump("montecarlo", f"{cases}/table1.toml", "--vary", "vary.toml", "--samples", 5, "--seed", 3,
                     "--output", "max:axial_force_N")
    assert done.status == 0, done.errors
    (tmp_path / "campaign.toml").write_text(f"""
[campaign]
name = "same"
case = "{cases}/table1.toml"
samples = 5
seed = 3
outputs = ["max:axial_force_N"]
{vary}""")
    done = statejump("montecarlo", "campaign.toml")
    assert done.status == 0, done.errors
    ours, theirs = ((tmp_path / "results" / name / "samples.csv").read_text() for name in ("table1_montecarlo", "same"))
    assert ours == theirs


@needs_page
def test_a_page_of_a_campaign_needs_no_campaign_file(
    statejump: Callable[..., Any], tmp_path: Path, cases: Path
) -> None:
    (tmp_path / "vary.toml").write_text(
        '[[vary]]\nkey = "joint.friction_coefficient"\ndistribution = "normal"\nrelative = 0.1\n')
    for command in (["montecarlo", f"{cases}/table1.toml", "--vary", "vary.toml", "--samples", 2],
                    ["report", "results/table1_montecarlo"]):
        done = statejump(*command)
        assert done.status == 0, done.errors


@pytest.mark.parametrize("arguments, sentence", [
    (["table1.toml"], failure("vary_file_missing", key="--vary")),
    (["table1.toml", "--vary", "none.toml"], failure("case_file_not_found", file="none.toml")),
    (["table1.toml", "--vary", "other.toml"], failure("no_such_key", file="other.toml", key="slider")),
    (["table1.toml", "--vary", "vary.toml", "--samples", 0], failure("out_of_range", key="--samples", value=0)),
    (["table1.toml", "--vary", "vary.toml", "--output", "x"], failure("bad_output_name", key="--output", value="x")),
    (["campaigns/table1_tolerances.toml", "--samples", 5], failure("conflicts_with_campaign_file", key="--samples")),
])
def test_what_a_campaign_of_a_case_refuses(
    arguments: list[Any], sentence: Failure, statejump: Callable[..., Any], tmp_path: Path, cases: Path
) -> None:
    (tmp_path / "vary.toml").write_text(
        '[[vary]]\nkey = "joint.friction_coefficient"\ndistribution = "normal"\nrelative = 0.1\n')
    (tmp_path / "other.toml").write_text("[slider]\n")
    told = statejump("--json", "montecarlo", f"{cases}/{arguments[0]}", *arguments[1:])
    assert told.status == 2 and told.errors.count("\n") == 1 and told.failure == sentence, told.errors
