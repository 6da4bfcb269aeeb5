# SPDX-License-Identifier: GPL-3.0-or-later
"""Script and input of a DEM run, kept in a folder: the printed command repeats the run bit for bit."""
from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from failures import failing
import statejump as sj
from statejump.core.errors import FailedRun, NotAllowed
from statejump.core.samples import read_samples
from statejump.kinds import running

SHORT = {"table1": {"thermal.period_s": 0.05}, "umbrella_damped": {"thermal.period_s": 0.1, "dem.steps_per_cycle": 50_000}}


def short_case(name: str) -> sj.Case:
    if name == "chain":
        return sj.truss.chain(2)
    return sj.load(f"cases/{name}.toml").changed(SHORT[name])


def by_hand(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(shlex.split(command), cwd=folder, capture_output=True, text=True)


@pytest.mark.parametrize("name", ["table1", "umbrella_damped", "chain"])
def test_the_printed_command_repeats_the_run(statejump, tmp_path: Path, yade: str, name: str) -> None:
    case = short_case(name)
    case.save(tmp_path / "case.toml")
    outcome = statejump("dem", "case.toml", "--keep-input", "input")
    assert outcome.status == 0, outcome.errors
    command = next(line for line in outcome.output.splitlines() if line.startswith("env PYTHONPATH="))
    done = by_hand(command, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    again = read_samples(tmp_path / "input" / "dem.samples")
    history = sj.read(tmp_path / "results" / case.name / "dem.h5").models["dem"].frame()
    shared = [name for name in again if name in history]
    assert len(shared) >= 9 and len(again["time_s"]) == len(history)
    for column in shared:
        np.testing.assert_array_equal(again[column], history[column], err_msg=column)


def test_a_changed_script_is_the_one_that_runs(tmp_path: Path, yade: str) -> None:
    command = running.keep_input(short_case("table1"), tmp_path / "input")
    script = tmp_path / "input" / "run_case.py"
    script.write_text(script.read_text().replace("def view(", "print('changed')\n\n\ndef view("))
    done = by_hand(command, tmp_path)
    assert done.returncode == 0 and "changed" in done.stdout


def test_python_keeps_the_input_and_runs(tmp_path: Path, yade: str) -> None:
    case = short_case("table1")
    kept = case.dem(keep_input=tmp_path / "input")
    assert (tmp_path / "input" / "case.json").is_file()
    np.testing.assert_array_equal(kept.frame().to_numpy(), case.dem().frame().to_numpy())


def test_a_folder_with_other_files_is_refused(tmp_path: Path, yade: str) -> None:
    (tmp_path / "mine.txt").write_text("")
    with pytest.raises(NotAllowed):
        running.keep_input(short_case("table1"), tmp_path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["mine.txt"]


def test_an_earlier_input_is_replaced(tmp_path: Path, yade: str) -> None:
    for period_s in 0.05, 0.1:
        running.keep_input(short_case("table1").changed({"thermal.period_s": period_s}), tmp_path / "input")
    assert '"period_s": 0.1' in (tmp_path / "input" / "case.json").read_text()


def test_a_failure_by_hand_keeps_its_traceback(tmp_path: Path, yade: str) -> None:
    case = short_case("table1")
    command = running.keep_input(case, tmp_path / "input")
    (tmp_path / "input" / "case.json").write_text("{}")
    done = by_hand(command, tmp_path)
    assert done.returncode == 2 and "STATEJUMP" in done.stdout


def test_no_view_without_a_display(tmp_path: Path, yade: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with failing("no_display", raised=FailedRun):
        running.view(short_case("table1"), tmp_path / "input")
    monkeypatch.setenv("DISPLAY", ":4711")
    with failing("no_display", raised=FailedRun, value=":4711"):
        running.view(short_case("table1"), tmp_path / "input")


@pytest.mark.skipif(shutil.which("xvfb-run") is None, reason="needs a virtual display")
def test_view_builds_the_scene_and_takes_steps(statejump_process, tmp_path: Path, yade: str) -> None:
    short_case("table1").save(tmp_path / "case.toml")
    command = ["xvfb-run", "-a", os.environ["STATEJUMP_COMMAND"], "dem", "case.toml", "--view"]
    done = subprocess.run(command, cwd=tmp_path, text=True, capture_output=True, timeout=300,
                          input="O.run(5, True)\nprint('steps', O.iter, 'bodies', len(O.bodies))\nexit()\ny\n")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "steps 5 bodies 5" in done.stdout
    assert not (tmp_path / "results").exists()
