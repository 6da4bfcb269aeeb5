# SPDX-License-Identifier: GPL-3.0-or-later
"""Missing memory or disk space is reported before a run, and a long run needs no more memory than a short one."""
from __future__ import annotations

import os
import resource
import subprocess
from pathlib import Path

import numpy as np
import pytest

from conftest import COMMAND
from failures import failure
from statejump import load, read
from statejump.kinds import limits
from statejump.core.errors import NotAllowed, NotWritten
from statejump.core.notes import Note
from statejump.core.results_folder import ResultsFolder
from statejump.kinds.spring_slider import reduced


def peak_bytes(folder: Path, *arguments: object) -> int:
    """Run a command and return its peak memory [bytes]."""
    with subprocess.Popen([COMMAND, *map(str, arguments)], cwd=folder, stdout=subprocess.DEVNULL) as run:
        _, status, used = os.wait4(run.pid, 0)
        run.returncode = os.waitstatus_to_exitcode(status)
    assert run.returncode == 0
    return used.ru_maxrss * 1024


def with_cycles(cases: Path, folder: Path, cycles: int) -> Path:
    text = (cases / "table1.toml").read_text()
    assert "\ncycles = 1\n" in text or "\ncycles = 1 " in text
    path = folder / f"cycles_{cycles}.toml"
    path.write_text(text.replace("\ncycles = 1", f"\ncycles = {cycles}", 1))
    return path


def test_many_cycles_need_little_memory(cases: Path, tmp_path: Path) -> None:
    """Both runs keep the first and the last ten cycles. An earlier version stored 4.5 kB per cycle: 20 000 cycles took
    89 MB more than 200. Now one number per cycle remains, 0.16 MB. The limit of 20 MB allows for variation between
    processes."""
    few = peak_bytes(tmp_path, "reduced", with_cycles(cases, tmp_path, 200))
    many = peak_bytes(tmp_path, "reduced", with_cycles(cases, tmp_path, 20_000), "--force")
    assert many < few + 20e6
    result = read(tmp_path / "results" / "table1" / "reduced.h5")
    run = result.models["reduced"]
    assert result.warnings[-1] == Note("cycles_left_out", shown=10, cycles=20_000)
    assert run.time_s[-1] == 20_000 and len(run) == 2 * (10 * 2000 + 1) and np.all(np.diff(run.time_s) > 0)
    assert {event.time_s <= 10 or event.time_s > 19_990 for event in run.events} == {True}


def test_history_that_leaves_cycles_out_is_the_whole_one_there(cases: Path) -> None:
    case = load(cases / "table1.toml").changed({"thermal.cycles": 150})
    run, whole = case.reduced(), reduced._run_at(case.definition, np.linspace(0, 150, 150 * 2000 + 1))
    assert run.summary == whole.summary and len(run.events) < len(whole.events)
    exact = whole.at(run.time_s)
    for name, column in run.history.items():
        assert np.array_equal(column.values, exact.history[name].values), name
    between = np.array([100.25, 70.5])
    for name, column in run.at(between).history.items():
        assert np.array_equal(column.values, whole.at(between).history[name].values), name
    kind = case.definition.behaviour
    assert kind.outcomes(case.definition, run) == kind.outcomes(
        case.definition, whole)
    assert run.plot() is not None


def test_whole_history_stays_whole(cases: Path) -> None:
    case = load(cases / "table1.toml").changed({"thermal.cycles": 100}).definition
    assert np.array_equal(reduced.sample_times(case), np.linspace(0, 100, 200_001))


def test_memory_that_is_not_there(cases: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "free_memory", lambda: 10**9)
    long = load(cases / "umbrella.toml").changed({"thermal.cycles": 100_000})
    for run in (long.reduced, long.dem):
        with pytest.raises(NotAllowed) as refused:
            run()
        assert refused.value.key == "thermal.cycles" and refused.value == failure("too_little_memory")
    monkeypatch.setattr(limits, "free_memory", lambda: None)
    limits.check_memory(long.definition, "dem")


@pytest.mark.parametrize("name", ["table1", "umbrella_damped", "trusses/chain_10", "trusses/ring_12"])
def test_size_of_a_history_is_not_guessed_too_small(cases: Path, tmp_path: Path, name: str, statejump) -> None:
    case = load(cases / f"{name}.toml")
    run, expected = case.reduced(), limits.history_of(case.definition, "reduced")
    values = sum(column.values.size for group in ("history", "energy", "links", "contacts")
                 for column in getattr(run, group).values())
    assert expected.samples == len(run)
    assert values <= 1.25 * expected.samples * expected.values and expected.samples * expected.values < 2 * values


def test_space_that_is_not_there(cases: Path, monkeypatch: pytest.MonkeyPatch, statejump, tmp_path: Path) -> None:
    asked = []

    def full(self: ResultsFolder, needed: float) -> None:
        asked.append(needed)
        raise NotWritten("no space left")

    monkeypatch.setattr(ResultsFolder, "check_space", full)
    for command in ("reduced", "dem", "compare"):
        assert statejump(command, cases / "table1.toml").status == 2
    assert len(asked) == 3 and asked[2] == pytest.approx(asked[0] + asked[1])
    assert not (tmp_path / "results").exists()


ODD = {
    "digits": ("a = " + 5000 * "1", failure("not_toml")),
    "arrays": ("a = " + 5000 * "[" + 5000 * "]", failure("toml_too_deep")),
    "tables": ("a = " + 5000 * "{b=" + "1" + 5000 * "}", failure("toml_too_deep")),
}


@pytest.mark.parametrize("command", ["reduced", "sweep"])
@pytest.mark.parametrize("name", ODD)
def test_odd_toml_is_one_sentence(statejump_process, tmp_path: Path, name: str, command: str) -> None:
    text, sentence = ODD[name]
    (tmp_path / "odd.toml").write_text(text)
    outcome = statejump_process("--json", command, "odd.toml")
    assert outcome.status == 2 and outcome.failure == sentence.at(file="odd.toml"), outcome.errors
    assert outcome.errors.count("\n") == 1


def test_file_without_an_end(tmp_path: Path) -> None:
    def little() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))

    for command in ("reduced", "info", "report", "bore"):
        done = subprocess.run([COMMAND, command, "/dev/zero"], cwd=tmp_path, capture_output=True, text=True, timeout=100,
                              preexec_fn=little)
        assert done.returncode == 2 and done.stderr.count("\n") == 1, (command, done.stderr)


def test_case_from_a_pipe_is_stored(cases: Path, tmp_path: Path) -> None:
    text = (cases / "table1.toml").read_text()
    done = subprocess.run(["bash", "-c", f'"{COMMAND}" reduced <(cat "{cases}/table1.toml") --quiet'], cwd=tmp_path)
    assert done.returncode == 0 and read(tmp_path / "results" / "table1" / "reduced.h5").case_text == text
