# SPDX-License-Identifier: GPL-3.0-or-later
"""Failures for other programs: JSON with the documented fields, exit statuses, and the page of mistakes."""
from __future__ import annotations

import importlib.util
import json
import pickle
import sys
from pathlib import Path
from typing import Any

import pytest

from conftest import REPOSITORY
from statejump.cli import main as cli
from statejump.cli import models
from statejump.core import errors

SCRIPT = REPOSITORY / "studies" / "docs" / "make_mistakes.py"


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
    assert MAKER.PAGE.read_text(encoding="utf-8") == MAKER.table(), "run studies/docs/make_mistakes.py"


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
    assert plain.endswith(failure.get("remedy", ""))


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
    # The sentence contains the values of the fields.
    assert f"time {failure['time_s']:.9g} s, temperature change {failure['temperature_change_K']:.9g} K)" in (
        failure["message"])
    assert failure.get("remedy", "") in failure["message"]
    assert remedy in failure["remedy"] if remedy else "remedy" not in failure
    assert f"| {mistake.what} |" in MAKER.PAGE.read_text(encoding="utf-8")
    assert not [*tmp_path.glob("results/*/*.h5"), *tmp_path.glob("results/*/*.partial")]


@pytest.mark.parametrize("error", [
    errors.NotAllowed("link.length_m", -1.0, allowed=errors.Range(0, 10, "m", above=True), file="a: b.toml", item="link 'x'"),
    errors.MissingKey("frame", section="section [frame]", file="odd.name"),
    errors.FailedRun("the truss is a mechanism", case="a", nodes=("A", "B"), time_s=0.5, temperature_change_K=-3.0,
                     cause="it moves", remedy="hold it"),
], ids=lambda error: type(error).__name__)
def test_fields_do_not_depend_on_the_sentence(error: errors.StatejumpError) -> None:
    # Neither a colon or another suffix in a path nor pickling changes a failure.
    for one in (error, pickle.loads(pickle.dumps(error))):
        found = one.fields()
        assert found["message"] == str(error)
        for name in ("file", "item", "key", "cause", "remedy", "time_s", "temperature_change_K", "case"):
            assert found.get(name) == getattr(error, name)
        assert found.get("nodes", []) == list(error.nodes)


def test_odd_path_keeps_its_fields(statejump, edited, tmp_path: Path) -> None:
    path = edited(("friction_coefficient = 0.3", "friction_coefficient = -0.3"))
    odd = tmp_path / "a: 1-2 s.case"
    odd.write_text(path.read_text())
    failure = json.loads(statejump("--json", "reduced", odd).errors)
    assert (failure["file"], failure["key"], failure["value"]) == (str(odd), "joint.friction_coefficient", -0.3)
    assert failure["allowed"] == {"low": 0, "high": 10, "unit": "-"}


def test_failed_run_of_the_dem(statejump, cases: Path, fake_yade) -> None:
    said = {"failure": {"joint": "floor", "place": "floor", "time_s": 0.5, "cause": "clearance closed"}}
    yade = fake_yade(f"echo 'STATEJUMP {json.dumps(said)}'\nexit 2\n")
    outcome = statejump("--json", "dem", cases / "table1.toml", STATEJUMP_YADE=yade)
    failure = json.loads(outcome.errors)
    assert outcome.status == failure["exit_status"] == 2
    assert (failure["kind"], failure["joint"], failure["time_s"]) == ("failed_run", "floor", 0.5)
    assert (failure["code"], failure["case"], failure["cause"]) == ("dem_failed", "table1", "clearance closed")
    assert failure["message"].endswith("clearance closed (floor, time 0.5 s)")


def test_missing_yade_says_what_to_do(yade, statejump, cases: Path) -> None:
    outcome = statejump("--json", "dem", cases / "table1.toml", STATEJUMP_YADE="no-such-yade")
    failure = json.loads(outcome.errors)
    assert (failure["kind"], failure["code"]) == ("failed_run", "yade_missing") and "'yade'" in failure["remedy"]


def test_results_that_cannot_be_written(statejump, cases: Path, tmp_path: Path) -> None:
    (tmp_path / "results").write_text("a file where a folder should be")
    failure = json.loads(statejump("--json", "reduced", cases / "table1.toml").errors)
    assert (failure["kind"], failure["code"]) == ("output", "write_failed") and "--results" in failure["remedy"]


def test_usage(statejump) -> None:
    for arguments in (("frobnicate",), ("reduced",), ("reduced", "--frob", "a.toml")):
        outcome = statejump("--json", *arguments)
        failure = json.loads(outcome.errors)
        assert (outcome.status, failure["kind"], failure["code"], failure["exit_status"]) == (2, "usage", "usage", 2)


def test_success_is_silent_on_standard_error(statejump, cases: Path) -> None:
    plain = statejump("reduced", cases / "table1.toml")
    as_json = statejump("--json", "reduced", cases / "table1.toml")
    assert (as_json.status, as_json.errors, as_json.output) == (0, "", plain.output)


ENDS = [
    (errors.TolerancesMissed(["state jump"], file="a.toml"), 1, "tolerance_missed"),
    (errors.Interrupted("interrupted; nothing was written"), 130, "interrupted"),
    (KeyboardInterrupt(), 130, "interrupted"),
    (ZeroDivisionError("division by zero"), errors.INTERNAL_STATUS, "internal"),
]


@pytest.mark.parametrize("end, status, kind", ENDS, ids=[kind for _, _, kind in ENDS])
def test_exit_statuses(
    end: BaseException, status: int, kind: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def ending(*arguments: object) -> None:
        raise end

    monkeypatch.setattr(models, "_compare_case", ending)
    assert cli.run(["--json", "compare", "a.toml"]) == status
    failure = json.loads(capsys.readouterr().err)
    assert (failure["kind"], failure["exit_status"]) == (kind, status)
    # Without --json an internal error prints a traceback; no other failure does.
    assert cli.run(["compare", "a.toml"]) == status
    assert ("Traceback" in capsys.readouterr().err) == (kind == "internal")
