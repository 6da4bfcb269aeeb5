# SPDX-License-Identifier: GPL-3.0-or-later
"""A file, or a group of files, is written completely or not at all; only one run at a time writes into a folder."""
from __future__ import annotations

import csv
import multiprocessing
import os
import shutil
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from conftest import COMMAND, results_in
from failures import failing, failure
from statejump.core import output, results_folder, scratch
from statejump.core.errors import NotWritten
from statejump.core.output import write_atomically, write_bytes
from statejump.core.results_folder import Results
from statejump.core.tables import write_columns


def names(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.iterdir())


def test_what_fails_leaves_what_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_bytes(tmp_path / "a.txt", b"before")
    with pytest.raises(ZeroDivisionError):
        with write_atomically(path) as stream:
            stream.write("half")
            1 / 0
    for call in ("fsync", "replace"):
        with monkeypatch.context() as there:
            there.setattr(os, call, full_disk)
            with failing("write_failed", file="a.txt", raised=NotWritten):
                write_bytes(path, b"after")
    assert path.read_bytes() == b"before" and names(tmp_path) == ["a.txt"]


def full_disk(*arguments: object) -> None:
    raise OSError(28, "No space left on device")


def test_columns_are_written_as_by_csv(tmp_path: Path) -> None:
    texts = ["S1", "x,y", 'a"b', "two\nlines", "a\rb", "\u00fc ", ""]
    columns = {"number_m": np.array([0.1, -1e-300, np.nan, np.inf, 1 / 3, -0.0, 5e15]), "count": np.arange(7),
               "yes": np.arange(7) % 2 == 0, "with, comma": np.array(texts), "any": np.array([1.5, None, *texts[:5]])}
    for chosen in (columns, {"text": columns["with, comma"]}):
        write_columns(chosen, tmp_path / "columns.csv")
        with (tmp_path / "expected.csv").open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(chosen)
            rows = zip(*(values.tolist() for values in chosen.values()))
            writer.writerows([cell if isinstance(cell, str) else repr(cell) for cell in row] for row in rows)
        assert (tmp_path / "columns.csv").read_bytes() == (tmp_path / "expected.csv").read_bytes()


@pytest.mark.parametrize("kind", ["folder", "pipe"])
def test_only_a_file_is_replaced(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "a"
    path.mkdir() if kind == "folder" else os.mkfifo(path)
    with failing("target_not_file", file="a", raised=NotWritten):
        write_bytes(path, b"")
    assert not path.is_file()


def test_writers_of_one_name_do_not_meet(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    with write_atomically(path) as first:
        with write_atomically(path) as second:
            second.write("second")
        first.write("first")
    assert path.read_text() == "first" and names(tmp_path) == ["a.txt"]


def test_what_a_kill_leaves_goes_with_the_next_writing(tmp_path: Path) -> None:
    (tmp_path / f".a.txt.0123{output.PARTIAL}").write_text("half")
    (tmp_path / f".b.txt.0123{output.PARTIAL}").write_text("another file's")
    write_bytes(tmp_path / "a.txt", b"")
    assert names(tmp_path) == [f".b.txt.0123{output.PARTIAL}", "a.txt"]


def test_results_appear_together(tmp_path: Path) -> None:
    with Results(tmp_path).folder("case") as folder:
        written = [write_bytes(folder.staged / name, b"1") for name in ("a", "b")]
        (folder.staged / "below").mkdir()
        write_bytes(folder.staged / "below" / "c", b"1")
        assert not [name for name in names(folder.path) if not name.startswith(".")]
        assert folder.publish(written) == [tmp_path / "case" / "a", tmp_path / "case" / "b"]
        write_bytes(folder.staged / "a", b"2")  # and again
        folder.publish()
        write_bytes(folder.staged / "never", b"")
    assert names(tmp_path / "case") == ["a", "b", "below"] and names(tmp_path / "case" / "below") == ["c"]
    assert (tmp_path / "case" / "a").read_bytes() == b"2"


@pytest.mark.parametrize("call", ["rename", "fsync"])
def test_nothing_appears_if_one_thing_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str) -> None:
    with pytest.raises(NotWritten):
        with Results(tmp_path).folder("case") as folder:
            for name in ("a", "b"):
                write_bytes(folder.staged / name, b"")
            monkeypatch.setattr(os, call, full_disk)
            folder.publish()
    assert not (tmp_path / "case").exists()


def test_a_folder_in_the_place_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "case" / "b").mkdir(parents=True)
    with failing("target_not_file", file="b", raised=NotWritten):
        with Results(tmp_path).folder("case") as folder:
            for name in ("a", "b"):
                write_bytes(folder.staged / name, b"")
            folder.publish()
    assert names(tmp_path / "case") == ["b"]


def test_a_kill_between_two_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The next run in the folder completes files whose publication has begun, and removes other temporary files."""
    moved = os.replace
    case = tmp_path / "case"

    def once(source: Path, target: Path) -> None:
        if (case / "a").exists():
            raise OSError(5, "Input/output error")
        moved(source, target)

    with failing("write_failed", raised=NotWritten):
        with Results(tmp_path).folder("case") as folder:
            for name in ("a", "b"):
                write_bytes(folder.staged / name, b"1")
            monkeypatch.setattr(results_folder.os, "replace", once)
            folder.publish()
    monkeypatch.undo()
    (case / f".0123{output.PARTIAL}").mkdir()
    (case / f".0123{output.PARTIAL}" / "half").write_text("")
    with Results(tmp_path).folder("case"):
        pass
    assert names(case) == ["a", "b"]


def hold(root: Path, held: multiprocessing.synchronize.Event, go: multiprocessing.synchronize.Event) -> None:
    with Results(root).folder("case") as folder:
        held.set()
        go.wait(30)
        write_bytes(folder.staged / "first", b"")
        folder.publish()


def test_one_run_at_a_time(tmp_path: Path) -> None:
    context = multiprocessing.get_context("fork")
    held, go = context.Event(), context.Event()
    other = context.Process(target=hold, args=(tmp_path, held, go))
    other.start()
    assert held.wait(30)
    with pytest.raises(NotWritten) as refused:
        with Results(tmp_path).folder("case"):
            pass
    assert refused.value == failure("folder_in_use", file="case")
    go.set()
    with Results(tmp_path, wait=True).folder("case") as folder:
        assert names(folder.path)[1:] == ["first"]
    other.join()
    assert names(tmp_path / "case") == ["first"]


def test_a_killed_run_lets_go(tmp_path: Path) -> None:
    context = multiprocessing.get_context("fork")
    held, go = context.Event(), context.Event()
    other = context.Process(target=hold, args=(tmp_path, held, go))
    other.start()
    assert held.wait(30)
    other.kill()
    other.join()
    assert [name.endswith(output.PARTIAL) for name in names(tmp_path / "case")] == [True]
    with Results(tmp_path).folder("case"):
        pass
    assert names(tmp_path / "case") == []


def test_two_commands_at_once(cases: Path, tmp_path: Path) -> None:
    """With --wait, commands that write the same results wait for each other and succeed."""
    runs = [subprocess.Popen([COMMAND, "reduced", cases / "table1.toml", "--wait"], cwd=tmp_path, text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE) for _ in range(3)]
    for run in runs:
        _, errors = run.communicate(timeout=120)
        assert (run.returncode, errors) == (0, "")
    assert results_in(tmp_path / "results" / "table1") == ["reduced.h5", "reduced_history.csv"]


def test_space_is_asked_for(tmp_path: Path) -> None:
    with Results(tmp_path).folder("case") as folder:
        folder.check_space(1)
        with failing("no_space_left", needed="100 TB", raised=NotWritten):
            folder.check_space(1e14)


@pytest.fixture
def bound(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the command without the superuser's right to ignore file permissions."""
    before: list[str] = []
    if os.geteuid() == 0:
        before = ["setpriv", "--bounding-set=-dac_override,-dac_read_search", "--inh-caps=-all"]
        if shutil.which("setpriv") is None or subprocess.run([*before, "true"], capture_output=True).returncode != 0:
            pytest.skip("the superuser writes everywhere")
    return lambda *words: subprocess.run([*before, COMMAND, *map(str, words)], cwd=tmp_path, text=True, timeout=200,
                                         capture_output=True, stdin=subprocess.DEVNULL)


def test_read_only_folder(bound, statejump, cases: Path, tmp_path: Path) -> None:
    assert statejump("reduced", cases / "table1.toml", "--results", "there").status == 0
    file, locked = tmp_path / "there/table1/reduced.h5", tmp_path / "locked"
    (tmp_path / "history.csv").write_text("slide_m,penetration_depth_m\n0,1e-6\n5e-8,1e-6\n")
    drive = ("--effective-young-modulus", 38.5e9, "--effective-shear-modulus", 7.9e9, "--effective-radius", 0.01,
             "--friction-coefficient", 0.3)
    locked.mkdir(mode=0o555)
    for target, *words in (
        ("locked/table1", "reduced", cases / "table1.toml", "--results", "locked"),
        ("locked/out", "export", file, "--to", "locked/out"),
        ("locked/page.html", "report", file, "-o", "locked/page.html"),
        ("locked/new/page.html", "report", file, "-o", "locked/new/page.html"),
        ("locked/out.csv", "laws", "--drive", "history.csv", "--law", "mindlin", *drive, "-o", "locked/out.csv"),
        ("locked/ring.toml", "truss", "ring", 12, "-o", "locked/ring.toml"),
    ):
        done = bound("--json", *words)
        assert done.returncode == 2 and done.stderr == failure("write_failed", file=target), words
    assert names(locked) == []


def test_what_may_not_be_read(bound, cases: Path, tmp_path: Path) -> None:
    """Unreadable files, and files in unsearchable folders, are reported in one line each."""
    (tmp_path / "case.toml").write_text((cases / "table1.toml").read_text())
    (tmp_path / "case.toml").chmod(0)
    (tmp_path / "locked").mkdir(mode=0)
    for words in ("reduced case.toml", "reduced locked/x.toml", "sweep case.toml", "sweep locked/x.toml", "info case.toml",
                  "info locked/x.h5", "export locked/x.h5", "report locked/x.h5", "compare locked/x.h5 y.h5",
                  "bore locked/x.stl", "fclib solve locked/x.hdf5", "laws build locked/x.hpp",
                  f"reduced {cases}/table1.toml --results locked/x", f"info {'x' * 300}.h5",
                  "truss ring 12 -o locked/x.toml", f"truss ring 12 -o {'x' * 300}.toml"):
        done = bound(*words.split())
        assert done.returncode == 2 and done.stderr.startswith("error: ") and done.stderr.count("\n") == 1, done.stderr
        assert any(name in done.stderr for name in ("case.toml", "locked/x", "x" * 300)), done.stderr


def test_scratch_of_killed_runs_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scratch.tempfile, "tempdir", str(tmp_path))
    for name, age_s in (("old", 100), ("young", 0)):
        left = tmp_path / f"{scratch.PREFIX}{name}"
        (left / "below").mkdir(parents=True)
        os.utime(left, (time.time() - age_s,) * 2)
    with scratch.scratch() as held:
        os.utime(held, (0, 0))
        with scratch.scratch() as other:
            assert names(tmp_path) == sorted([held.name, other.name, f"{scratch.PREFIX}young"])
    assert names(tmp_path) == [f"{scratch.PREFIX}young"]


def copied(cases: Path, path: Path, *replacements: tuple[str, str]) -> Path:
    text = (cases / "table1.toml").read_text()
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    return path


def test_a_copied_case_does_not_replace_results(statejump, cases: Path, tmp_path: Path) -> None:
    changed = ("friction_coefficient = 0.3", "friction_coefficient = 0.2")
    assert statejump("reduced", cases / "table1.toml").status == 0
    file = tmp_path / "results" / "table1" / "reduced_history.csv"
    before = file.read_bytes()
    # a copy that says the same is the same case, also from another folder
    assert statejump("reduced", copied(cases, tmp_path / "a" / "table1.toml")).status == 0
    assert file.read_bytes() == before
    # an edited file replaces its own results
    mine = copied(cases, tmp_path / "a" / "table1.toml", changed)
    assert statejump("reduced", mine).status == 0
    assert file.read_bytes() != before
    other = copied(cases, tmp_path / "b" / "table1.toml")
    after = file.read_bytes()
    for command in (("reduced",), ("dem",), ("compare",), ("fe",), ("control",), ("convergence",)):
        refused = statejump(*command, other)
        assert (refused.status, file.read_bytes()) == (2, after), command
        assert refused.failure == failure("results_of_other_case", other="a/table1.toml", file="table1")
    assert statejump("reduced", other, "--force").status == 0 and file.read_bytes() == before
    assert statejump("reduced", other).status == 0


def test_a_folder_within_that_of_another_case_is_refused(statejump, cases: Path, tmp_path: Path) -> None:
    assert statejump("truss", "draw", cases / "trusses" / "chain_10.toml").status == 0
    copy = tmp_path / "copy.toml"
    copy.write_text((cases / "trusses" / "chain_10.toml").read_text().replace("title = \"", "title = \"My "))
    refused = statejump("fclib", "write", copy, "--number", 1)
    assert refused.status == 2 and refused.failure == failure("results_of_other_case", file="chain_10")
    assert not (tmp_path / "results" / "chain_10" / "fclib").exists()


def test_refused_commands_leave_no_folders(statejump, cases: Path, tmp_path: Path) -> None:
    for words in (("truss", "answers", cases / "trusses" / "ring_12.toml", "--output", "node:none"),
                  ("control", cases / "trusses" / "ring_12.toml", "--node", "none"),
                  ("reduced", cases / "table1.toml", "--dynamic")):
        assert statejump(*words, "--results", "new/one").status == 2
        assert names(tmp_path) == [], words
    (tmp_path / "old").mkdir()
    assert statejump("control", cases / "trusses" / "ring_12.toml", "--node", "none", "--results", "old").status == 2
    assert names(tmp_path) == ["old"] and names(tmp_path / "old") == []
