# SPDX-License-Identifier: GPL-3.0-or-later
"""Failures for programs: JSON with the fields that are known, exit statuses, and the page of mistakes."""
from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from typing import Any

import pytest

from conftest import REPOSITORY
from statejump.cli import main as cli
from statejump.core import errors

SCRIPT = REPOSITORY / "docs" / "make_mistakes.py"


def make_mistakes() -> Any:
    found = importlib.util.spec_from_file_location("make_mistakes", SCRIPT)
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules["make_mistakes"] = module  # dataclasses look their module up
    found.loader.exec_module(module)
    return module


MAKER = make_mistakes()
MISTAKES = [mistake for group in MAKER.GROUPS.values() for mistake in group]


def test_page_of_mistakes_is_current() -> None:
    assert MAKER.PAGE.read_text(encoding="utf-8") == MAKER.table(), "run docs/make_mistakes.py"


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.what)
def test_every_mistake_has_its_fields(mistake: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    name = Path(mistake.case).name + ".toml"
    Path(name).write_text(MAKER.edited(mistake), encoding="utf-8")
    status, plain = MAKER.said([*mistake.command.split(), name])
    status_of_json, line = MAKER.said(["--json", *mistake.command.split(), name])
    assert (status, status_of_json) == (2, 2) and "\n" not in line
    failure = json.loads(line)
    assert plain == "error: " + failure["message"]
    assert [field for field in errors.FIELDS if field in failure] == list(failure)
    assert (failure["kind"], failure["file"], failure["exit_status"]) == ("bad_input", name, 2)
    if mistake.what != "not TOML":
        assert "key" in failure, failure
        assert failure["key"] in plain
        assert "cause" in failure or "remedy" in failure or mistake.what == "missing section"
    if " is not allowed: " in plain and "program is" not in plain:
        assert "value" in failure, failure
    if "did you mean" in plain:
        assert failure["remedy"] == plain[plain.index("did you mean"):]


@pytest.mark.parametrize(
    "mistake, joint, remedy", zip(MAKER.RUNS, (None, "joint_b", "floor"), ("dem.steps_per_cycle", "", "")),
    ids=lambda found: getattr(found, "what", ""),
)
def test_run_in_yade_that_cannot_go_on(
    mistake: Any, joint: str | None, remedy: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    name = Path(mistake.case).name + ".toml"
    Path(name).write_text(MAKER.edited(mistake), encoding="utf-8")
    status, line = MAKER.said(["--json", "dem", name])
    failure = json.loads(line)
    assert (status, failure["kind"], failure["exit_status"]) == (2, "failed_run", 2)
    assert [field for field in errors.FIELDS if field in failure] == list(failure)
    assert failure.get("joint") == joint and "bodies" not in failure["message"]
    assert failure["cause"] in failure["message"] and failure["time_s"] >= 0
    # The sentence says the same as the fields.
    said = errors.read_sentence(failure["message"])
    assert [said[key] for key in ("time_s", "temperature_change_K")] == [
        failure[key] for key in ("time_s", "temperature_change_K")]
    assert said.get("remedy") == failure.get("remedy")
    assert remedy in failure["remedy"] if remedy else "remedy" not in failure
    assert f"| {mistake.what} |" in MAKER.PAGE.read_text(encoding="utf-8")
    assert not [*tmp_path.glob("results/*/*.h5"), *tmp_path.glob("results/*/*.partial")]


SENTENCES = {
    "a.toml: link 'AB': young_modulus_Pa = -1.0 is not allowed: must be above 0":
        {"file": "a.toml", "item": "link 'AB'", "key": "young_modulus_Pa", "value": -1.0, "cause": "must be above 0"},
    "a.toml: thermal.cycles = true is not allowed: must be a whole number":
        {"file": "a.toml", "key": "thermal.cycles", "value": True, "cause": "must be a whole number"},
    "case a: the DEM run failed: too deep (contact of bodies 1 and 2, time 0.25 s, temperature change 40 K)":
        {"time_s": 0.25, "temperature_change_K": 40.0},
    "the truss is a mechanism at a temperature change of 12.5 K (t = 0.125 s): 1 free mode: node 'B' mostly along x":
        {"time_s": 0.125, "temperature_change_K": 12.5, "nodes": ["B"]},
    "too deep at time = 1.5e-3 s, temperature_change = -4e1 K": {"time_s": 1.5e-3, "temperature_change_K": -40.0},
    "revolute 'J1' carries no force at the start: statics does not determine it; load it by a spring":
        {"joint": "J1", "remedy": "load it by a spring"},
    "--runs = 1 is not allowed: must be at least 2": {"key": "--runs", "value": 1, "cause": "must be at least 2"},
}


@pytest.mark.parametrize("sentence", SENTENCES)
def test_what_a_sentence_says(sentence: str) -> None:
    assert errors.read_sentence(sentence) == SENTENCES[sentence]


def test_failed_run_of_the_dem(statejump, cases: Path, fake_yade) -> None:
    yade = fake_yade("echo 'DETAILS {\"joint\": \"floor\", \"cause\": \"the clearance is closed\"}'\n"
                     "echo 'ERROR the clearance is closed (floor, time 0.5 s)'\nexit 2\n")
    outcome = statejump("--json", "dem", cases / "table1.toml", STATEJUMP_YADE=yade)
    failure = json.loads(outcome.errors)
    assert outcome.status == failure["exit_status"] == 2
    assert (failure["kind"], failure["joint"], failure["time_s"]) == ("failed_run", "floor", 0.5)
    assert failure["cause"] == "the clearance is closed"
    assert failure["message"] == "case table1: the DEM run failed: the clearance is closed (floor, time 0.5 s)"


def test_missing_yade_says_what_to_do(statejump, cases: Path) -> None:
    outcome = statejump("--json", "dem", cases / "table1.toml", STATEJUMP_YADE="no-such-yade")
    failure = json.loads(outcome.errors)
    assert failure["kind"] == "failed_run" and failure["remedy"].startswith("install Debian's package 'yade'")


def test_results_that_cannot_be_written(statejump, cases: Path, tmp_path: Path) -> None:
    (tmp_path / "results").write_text("a file where a folder should be")
    failure = json.loads(statejump("--json", "reduced", cases / "table1.toml").errors)
    assert (failure["kind"], failure["remedy"]) == ("output", "choose another with --results")


def test_usage(statejump) -> None:
    for arguments in (("frobnicate",), ("reduced",), ("reduced", "--frob", "a.toml")):
        outcome = statejump("--json", *arguments)
        failure = json.loads(outcome.errors)
        assert (outcome.status, failure["kind"], failure["exit_status"]) == (2, "usage", 2)


def test_success_is_silent_on_standard_error(statejump, cases: Path) -> None:
    plain = statejump("reduced", cases / "table1.toml")
    as_json = statejump("--json", "reduced", cases / "table1.toml")
    assert (as_json.status, as_json.errors, as_json.output) == (0, "", plain.output)


ENDS = [
    (errors.TolerancesMissed("a.toml: tolerance missed: state jump"), 1, "tolerance_missed"),
    (errors.Interrupted("interrupted; nothing was written"), 130, "interrupted"),
    (KeyboardInterrupt(), 130, "interrupted"),
    (ZeroDivisionError("division by zero"), 2, "internal"),
]


@pytest.mark.parametrize("end, status, kind", ENDS, ids=[kind for _, _, kind in ENDS])
def test_exit_statuses(
    end: BaseException, status: int, kind: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def ending(*arguments: object) -> None:
        raise end

    monkeypatch.setattr(cli, "_compare_case", ending)
    assert cli.run(["--json", "compare", "a.toml"]) == status
    failure = json.loads(capsys.readouterr().err)
    assert (failure["kind"], failure["exit_status"]) == (kind, status)
    # Without --json a fault of the program shows where it is; nothing else has a traceback.
    assert cli.run(["compare", "a.toml"]) == status
    assert ("Traceback" in capsys.readouterr().err) == (kind == "internal")
