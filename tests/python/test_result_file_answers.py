# SPDX-License-Identifier: GPL-3.0-or-later
"""Results of `truss answers` in the result file: layout, values read back, and use by the commands."""
from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from conftest import REPOSITORY, sealed
from failures import Failure, failing, failure
from test_result_file import check_layout, run

from statejump.results import layout
from statejump.results.contents import Scalar
from statejump.results.read import read
from statejump.results.write import write

CASE = REPOSITORY / "cases" / "trusses" / "umbrella_8.toml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results folder of ``truss answers`` for two cycles of a truss with a reflector."""
    root = tmp_path_factory.mktemp("answers")
    (root / "results" / "umbrella_8").mkdir(parents=True)
    (root / "results" / "umbrella_8" / "reduced_history.csv").write_text("another run\n")
    done = run(root, "truss", "answers", CASE, "--cycles", 2)
    assert done.returncode == 0, done.stderr
    return root / "results" / "umbrella_8"


def test_layout_and_columns(folder: Path) -> None:
    check_layout(folder / "answers.h5")
    with h5py.File(folder / "answers.h5") as file:
        tables = [name for name in file["answers"] if name not in ("notes", "summary")]
        assert sorted(tables) == sorted(layout.TABLES)
        for name in tables:
            assert sorted(file[f"answers/{name}"]) == sorted(layout.TABLES[name][1]), name
        unit = {name: file[f"answers/{name}"].attrs["unit"] for name in (
            "contributions/contribution", "contributions/share", "joint_jumps/dissipation_of_cycle_J",
            "surface/tilt_change_rad", "sensitivities/jump_change_per_unit")}
    assert list(unit.values())[:4] == ["m", "-", "J", "rad"] and list(unit.values())[4].startswith("m per")


def test_tables_are_those_of_the_csv_files(folder: Path) -> None:
    found = read(folder / "answers.h5").answers
    assert found is not None
    for name, rows in found.tables.items():
        with (folder / f"{name}.csv").open() as stream:
            written = list(csv.reader(stream))
        assert tuple(written[0]) == tuple(rows[0]) == layout.TABLES[name][1]
        assert [["" if value is None else repr(value) if isinstance(value, float) else str(value)
                 for value in row.values()] for row in rows] == written[1:], name
    summary = json.loads((folder / "answers.json").read_text())
    assert (found.output, found.verdict, found.notes) == tuple(summary[key] for key in ("output", "verdict", "notes"))
    told = {name: scalar.value for name, scalar in found.summary.items()}
    assert told == {name: summary[name] for name in found.summary}
    assert found.summary["jump"] == Scalar(summary["jump"], "m") and found.verdict == "shakedown"
    # A ring of nodes has no focal length: no number, neither here nor there.
    assert {row["focal_length_m"] for row in found.tables["surface"]} == {None}


def test_the_path_beside_the_answers_is_theirs(folder: Path) -> None:
    result = read(folder / "answers.h5")
    path, answers = result.models["reduced"], result.answers
    assert answers is not None and result.complete and result.command == "truss answers"
    assert result.case_text == CASE.read_text() and result.case.thermal.cycles == 2  # --cycles, not the file's 1
    # Cycles end at samples: the same numbers.
    moved = path.history["displacement_m"].values
    last = [row for row in answers.tables["node_jumps"] if row["cycle"] == 2]
    assert np.array_equal([[row[f"jump_{axis}_m"] for axis in "xyz"] for row in last], moved[-1] - moved[0])
    heat = [row["dissipation_J"] for row in answers.tables["joint_jumps"] if row["cycle"] == 2]
    assert np.array_equal(heat, path.contacts["dissipation_J"].values[-1]) and min(heat) > 0
    # The quick path does not locate what does not matter: half an increment of 50 in a branch of 8 s.
    half = {round(event.time_uncertainty_s, 9) for event in path.events}
    assert half == {0.0, 0.08}
    assert (folder / "reduced_history.csv").read_text() == "another run\n"


def test_same_bytes_and_nothing_lost(folder: Path, tmp_path: Path) -> None:
    write(read(folder / "answers.h5"), tmp_path / "copy.h5")
    assert (tmp_path / "copy.h5").read_bytes() == (folder / "answers.h5").read_bytes()


def test_commands_take_it(folder: Path, tmp_path: Path) -> None:
    shown = run(tmp_path, "info", folder / "answers.h5")
    assert shown.returncode == 0, shown.stderr
    answers = read(folder / "answers.h5").answers
    for text in (f"answers: {answers.text}", f"{answers.verdict}: {answers.verdict_text}",
                 "sum_of_contributions", "contributions", "statejump truss answers", "contacts/dissipation_J"):
        assert text in shown.stdout, text
    assert run(tmp_path, "export", folder / "answers.h5", "--format", "csv", "--to", "out").returncode == 0
    for name in layout.TABLES:
        assert (tmp_path / "out" / f"{name}.csv").read_bytes() == (folder / f"{name}.csv").read_bytes(), name
    done = run(tmp_path, "compare", folder / "answers.h5", folder / "answers.h5")
    assert done.returncode == 0, done.stderr


def test_damaged_answers_are_one_sentence(folder: Path, tmp_path: Path) -> None:
    path = tmp_path / "bad.h5"
    path.write_bytes((folder / "answers.h5").read_bytes())
    with h5py.File(path, "r+") as file:
        del file["answers/node_jumps/node"]
        file["answers/node_jumps"]["node"] = ["A1"]
    sealed(path)
    with failing("damaged", file="bad.h5", object="/answers/node_jumps/node") as raised:
        read(path)
    assert "\n" not in str(raised.value)


def test_no_number_comes_back_as_none(folder: Path, tmp_path: Path) -> None:
    result = read(folder / "answers.h5")
    assert result.answers is not None
    rows = [{**row, "elasticity": None, "verdict": "failed: ∞"} for row in result.answers.tables["sensitivities"]]
    changed = replace(result.answers, tables={**result.answers.tables, "sensitivities": rows, "surface": []})
    write(replace(result, answers=changed), tmp_path / "changed.h5")
    assert read(tmp_path / "changed.h5").answers == changed


@pytest.mark.parametrize("names", [("jump",), ("sum_of_contributions",), ("sum_error_relative",)])
def test_answers_that_lack_a_number_are_refused(folder: Path, tmp_path: Path, names: tuple[str, ...]) -> None:
    path = tmp_path / "bad.h5"
    path.write_bytes((folder / "answers.h5").read_bytes())
    with h5py.File(path, "r+") as file:
        for name in names:
            del file[f"answers/summary/{name}"]
    sealed(path)
    with failing("damaged", object=f"/answers/summary/{names[0]}", file="bad.h5"):
        read(path)


@pytest.mark.parametrize("column, value, said", [
    ("answers/node_jumps/jump_x_m", np.nan, failure("damaged", object="/answers/node_jumps/jump_x_m")),
    ("models/reduced/contacts/tangential_force_N", 1e308, failure("drawing_not_finite")),
    ("models/reduced/history/position_m", 1e308, failure("drawing_not_finite")),
])
def test_what_cannot_be_drawn_is_one_sentence(folder: Path, tmp_path: Path, column: str, value: float, said: Failure) -> None:
    path = tmp_path / "bad.h5"
    path.write_bytes((folder / "answers.h5").read_bytes())
    with h5py.File(path, "r+") as file:
        file[column][-1] = value
    sealed(path)
    done = run(tmp_path, "--json", "report", path)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and said == done.stderr, done.stderr
    assert not list(tmp_path.rglob("*.html"))
