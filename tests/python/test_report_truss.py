# SPDX-License-Identifier: GPL-3.0-or-later
"""Report page of a truss: jumps, ranking of joints, sensitivities; also without results of `truss answers`."""
from __future__ import annotations

import re
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

from conftest import COMMAND, REPOSITORY, Outcome
from failures import failure
from test_report import MEGABYTE, Page, decoded, pytestmark, written  # noqa: F401  (no page, no test)

import statejump as sj
from statejump.cli.report import result_files
from statejump.core import units
from statejump.core.run import GROUPS
from statejump.kinds.truss.page import SHOWN_JUMP
from statejump.report import labels
from statejump.report.document import Document
from statejump.report.drawing import round_down
from statejump.report.unsolved import UnsolvedDocument
from statejump.results.contents import Result
from statejump.results.read import read

TRUSSES = REPOSITORY / "cases" / "trusses"


def made(root: Path, *arguments: object) -> None:
    done = subprocess.run([COMMAND, *map(str, arguments), "--quiet"], cwd=root, capture_output=True, text=True,
                          timeout=300, stdin=subprocess.DEVNULL)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of `truss answers` for a planar and a spatial truss; for others only the quasi-static path."""
    root = tmp_path_factory.mktemp("trusses")
    made(root, "truss", "answers", TRUSSES / "mast_6.toml", "--cycles", 3)
    made(root, "truss", "answers", TRUSSES / "umbrella_8.toml", "--no-sensitivity")
    made(root, "reduced", TRUSSES / "ring_12.toml")
    made(root, "reduced", TRUSSES / "chain_10.toml")
    return root / "results"


def truss_of(result: Result) -> dict[str, Any]:
    return Document(result, "x.h5", "run1", 1e6).payload()["truss"]


def test_numbers_on_the_page_are_those_of_the_answers(statejump: Callable[..., Outcome], results: Path) -> None:
    found, size = written(statejump, results / "mast_6")
    result = read(results / "mast_6" / "answers.h5")
    answers = result.answers
    assert all(found.words.count(warning[1:]) == 1 for warning in result.warnings)
    assert answers is not None and size < 3 * MEGABYTE
    assert units.text(answers.summary["jump"].value, "m") in found.words and answers.verdict_text in found.words
    for row in answers.tables["contributions"]:
        assert row["joint"] in found.words and units.text(row["contribution"], "m", 4) in found.words
    strongest = max(answers.tables["sensitivities"], key=lambda row: abs(row["elasticity"]))
    assert labels.of_kind("truss").parameter(strongest["parameter"]) in found.words
    assert f"{strongest['elasticity']:+.3g}" in found.words
    assert "30 nodes and 24 links" in found.words and "0.5 to 1 of" in found.words
    assert "Both models" not in found.words and "all joints" in found.words


def test_the_drawing_gets_the_jumps_of_each_cycle(results: Path) -> None:
    result = read(results / "mast_6" / "answers.h5")
    answers, truss = result.answers, truss_of(result)
    assert answers is not None and [entry["cycle"] for entry in truss["cycles"]] == [1, 2, 3]
    for entry in truss["cycles"]:
        rows = [row for row in answers.tables["node_jumps"] if row["cycle"] == entry["cycle"]]
        jumps = np.array([[row[f"jump_{axis}_m"] for axis in "xyz"] for row in rows])
        assert decoded(entry["jump"], 3 * len(rows)) == pytest.approx(jumps.ravel(), rel=1e-6, abs=1e-15)
    assert truss["nodes"] == [row["node"] for row in rows]
    start = decoded(truss["start"], 90).reshape(-1, 3).astype(float)
    largest = np.linalg.norm(jumps, axis=1).max()
    assert truss["largest_m"] == pytest.approx(largest, rel=1e-12)
    assert truss["magnification"] == round_down(SHOWN_JUMP * np.ptp(start, axis=0).max() / largest)
    held = {row["joint"]: row["contribution"] for row in answers.tables["contributions"]}
    heat = {row["joint"]: row["dissipation_J"] for row in answers.tables["joint_jumps"] if row["cycle"] == 3}
    assert {joint["name"]: joint["contribution"] for joint in truss["joints"]} == held
    assert {joint["name"]: joint["heat"] for joint in truss["joints"]} == heat
    assert [measure["key"] for measure in truss["measures"]] == ["contribution", "heat", "jump"]
    # Joints stand at the node of their bearing, links between theirs.
    case = result.case
    assert [truss["nodes"][joint["node"]] for joint in truss["joints"]] == [item.bearing_node for item in case.revolute]
    assert [[truss["nodes"][node] for node in line["nodes"]] for line in truss["lines"]] == [
        *(item.nodes for item in case.link), *(item.nodes for item in case.spring),
        *([item.bearing_node, item.journal_node] for item in case.revolute)]


def test_a_loop_that_looks_like_a_line_is_shown_without_it(results: Path) -> None:
    document = Document(read(results / "ring_12" / "reduced.h5"), "x.h5", "run1", 1e6)
    shown = {chart["title"]: chart for chart in document.payload()["charts"]}
    thin = next(chart for title, chart in shown.items() if "straight part" in title)
    whole = shown[thin["title"].partition(",")[0]]
    assert thin["title"].endswith("/K") and thin["y"]["label"].partition(" [")[0] == whole["y"]["label"].partition(" [")[0]
    change = document.result.models["reduced"]["temperature_change_K"]
    loop, left = (document._columns["reduced"][chart["y"]["column"]] for chart in (whole, thin))
    # A straight line less: the same jump, on a scale on which it is seen.
    assert left[-1] - left[0] == pytest.approx(loop[-1] - loop[0], rel=1e-9)
    assert np.ptp(left) < 0.01 * np.ptp(loop) and abs(left[-1] - left[0]) > 0.3 * np.ptp(left)
    assert np.polyfit(change, loop - left, 1, full=True)[1] < (1e-12 * np.ptp(loop)) ** 2 * len(loop)
    assert thin["marks"][-1]["value"] == whole["marks"][-1]["value"]
    chain = Document(read(results / "chain_10" / "reduced.h5"), "x.h5", "run1", 1e6).payload()["charts"]
    assert not any("straight part" in chart["title"] for chart in chain)


def test_page_of_a_reflector(statejump: Callable[..., Outcome], results: Path) -> None:
    found, _ = written(statejump, results / "umbrella_8")
    assert "Reflecting surface" in found.words and "focal length" in found.words
    assert "would change" not in found.words and "Focal shift" not in found.words
    assert found.data["runs"][0]["truss"]["dimension"] == 3
    # Its joints lie in space: journals are drawn about their own axes, which the ribs' planes have as normals.
    axes = [part["axis"] for part in found.data["runs"][0]["scene"]["parts"] if part["type"] == "journal"]
    assert len(axes) == 8 and axes[2] == pytest.approx([0, -1, 0], abs=1e-12)


def test_without_answers_joints_are_ranked_by_motion_and_heat(statejump: Callable[..., Outcome], results: Path) -> None:
    found, _ = written(statejump, results / "ring_12")
    assert "no contributions" in found.words and "what holds" in found.words
    result = read(results / "ring_12" / "reduced.h5")
    run, truss = result.models["reduced"], found.data["runs"][0]["truss"]
    assert [measure["key"] for measure in truss["measures"]] == ["heat", "jump"]
    heat, place = run.contacts["dissipation_J"].values[-1], run.history["eccentricity_m"].values
    assert [joint["heat"] for joint in truss["joints"]] == heat.tolist()
    assert [joint["jump"] for joint in truss["joints"]] == np.linalg.norm(place[-1] - place[0], axis=1).tolist()
    moved = run.history["displacement_m"].values
    assert decoded(truss["cycles"][0]["jump"], 3 * len(truss["nodes"])) == pytest.approx(
        (moved[-1] - moved[0]).ravel(), rel=1e-6, abs=1e-18)
    # An older file, or one of the DEM alone, has no heat of joints.
    del run.contacts["dissipation_J"]
    assert [measure["key"] for measure in truss_of(result)["measures"]] == ["jump"]


def test_interrupted_run_shows_what_there_is(results: Path) -> None:
    result = read(results / "chain_10" / "reduced.h5")
    run = result.models["reduced"]

    def cut(columns: dict[str, Any]) -> dict[str, Any]:
        return {name: replace(column, values=column.values[:30]) for name, column in columns.items()}

    short = replace(run, **{group: cut(getattr(run, group)) for group in GROUPS})
    truss = truss_of(replace(result, complete=False, models={"reduced": short}))
    assert len(truss["cycles"]) == 1 and truss["largest_m"] > 0


def test_replay_without_clearance_magnifies_the_way(results: Path) -> None:
    """Blocks without stops have no clearance: the chain's end is magnified to at most 10 % of the chain's length."""
    scene = Document(read(results / "chain_10" / "reduced.h5"), "x.h5", "run1", 1e6).payload()["scene"]
    # 5 m of bars between hot and half slipped out: 2.34e-3 of that at most, 42 times in a tenth.
    assert scene["clearance_m"] == 0 and scene["magnification"] == scene["magnification_of_deformation"] >= 20
    assert scene["deforms"]
    scene = Document(read(results / "ring_12" / "reduced.h5"), "x.h5", "run1", 1e6).payload()["scene"]
    assert scene["magnification"] > scene["magnification_of_deformation"] >= 10


def test_a_page_of_a_truss_before_it_is_solved(statejump: Callable[..., Outcome]) -> None:
    found, size = written(statejump, TRUSSES / "mast_6.toml")
    assert "30 nodes and 24 links" in found.words and UnsolvedDocument.verdict[1] in found.words
    assert [address[:22] for address in found.addresses if address.startswith("data:image")] == ["data:image/png;base64,"]
    assert "increments_per_branch" in found.words and size < 2.5e6
    refused = statejump("report", TRUSSES.parent / "table1.toml")
    assert refused.status == 2 and refused.failure == failure("page_only_of_truss")


def test_answers_stand_beside_a_comparison(tmp_path: Path) -> None:
    for name in ("answers", "comparison", "reduced", "dem"):
        (tmp_path / f"{name}.h5").touch()
    assert [path.stem for path in result_files(tmp_path)] == ["answers", "comparison"]


def test_a_hundred_joints_in_space(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    made(tmp_path, "truss", "answers", TRUSSES / "umbrella_100.toml", "--no-sensitivity")
    found, size = written(statejump, tmp_path / "results" / "umbrella_100")
    assert size < 10 * MEGABYTE
    truss = found.data["runs"][0]["truss"]
    assert len(truss["joints"]) == 100 and truss["most"] < 100 and "85 more in" in found.words
    assert "100 revolute joints" in found.words
    # Inputs are summed up, not listed: 200 links in a few rows.
    assert "200 entries" in found.words


@pytest.mark.parametrize(("kind", "facts"), [
    ("chain_10", {"plane": [11, 10, 1, 10], "sliding": [10, 36.85]}),
    ("umbrella_8", {"spatial": [32, 16, 16, 16], "cables": [8, 8]}),
    ("ring_12", {"shaded": [0, 1], "elastically": []}),
])
def test_case_in_words(kind: str, facts: dict[str, list[float]]) -> None:
    """One sentence has each word, and these numbers."""
    described = labels.described(sj.load(TRUSSES / f"{kind}.toml").definition)
    for word, numbers in facts.items():
        (sentence,) = [one for one in described if word in one]
        assert [float(number) for number in re.findall(r"\d+(?:\.\d+)?", sentence)] == numbers, sentence
    assert "100\u202fK" in described[-1]


def test_the_page_shows_the_bounds_of_a_truss(statejump: Callable[..., Outcome], results: Path) -> None:
    found, _ = written(statejump, results / "chain_10")
    assert "Bounds of the state jump" in found.words and "Class A, exact" in found.words
    assert units.text(3217.5e-6, "m", 4) in found.words
    assert sum(address.startswith("data:image/png") for address in found.addresses) == 2
