# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures: the built package, the command, and case files to damage."""
from __future__ import annotations

import hashlib
import io
import json
import os
import random
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Iterator

import pytest

BUILT = Path(os.environ["STATEJUMP_PYTHON_DIR"])
COMMAND = os.environ["STATEJUMP_COMMAND"]
REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(BUILT), str(REPOSITORY)]  # the latter for studies
from statejump import _paths  # noqa: E402

# Reason in the failure of anything that needs YADE, in a build without YADE.
WITHOUT_YADE = "this statejump was built without it"


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    status: int
    output: str
    errors: str
    failure: Any = None  # cause of the end: the error in this process, or the JSON of a process that ran with --json


def results_in(folder: Path) -> list[str]:
    """Return the names of results in a folder, without the file that marks the folder's owner."""
    return sorted(entry.name for entry in folder.iterdir() if entry.name != ".case.json")


def sealed(path: Path) -> Path:
    """Give a changed HDF5 file a valid checksum, to test the checks after the checksum."""
    from statejump.core.hdf5 import HEAD_BYTES, head

    content = path.read_bytes()
    body = content[HEAD_BYTES if content.startswith(b"statejump") else 0:]
    path.write_bytes(head(hashlib.sha256(body).hexdigest()) + body)
    return path


@pytest.fixture(autouse=True)
def skipped_without_yade(monkeypatch: pytest.MonkeyPatch) -> None:
    """In a build without YADE, skip a test as soon as it needs YADE."""
    from statejump.core import yade_process

    if not _paths.YADE:
        monkeypatch.setattr(yade_process, "find_yade", lambda: pytest.skip("needs YADE"))


# Commands that start processes, which would import the test instead of the command.
SPREADING = ("montecarlo", "sweep")


@pytest.fixture
def statejump_process(tmp_path: Path) -> Callable[..., Outcome]:
    """Return a function that runs the command in a separate process and folder, with the given environment variables.
    """

    def run(*arguments: object, **environment: str) -> Outcome:
        done = subprocess.run(
            [COMMAND, *map(str, arguments)], cwd=tmp_path, env={**os.environ, **environment},
            capture_output=True, text=True, timeout=300, stdin=subprocess.DEVNULL,
        )
        if not _paths.YADE and WITHOUT_YADE in done.stderr:
            pytest.skip("needs YADE")
        as_json = "--json" in map(str, arguments) and done.returncode != 0 and done.stderr.startswith("{")
        return Outcome(done.returncode, done.stdout, done.stderr, json.loads(done.stderr) if as_json else None)

    return run


@pytest.fixture
def statejump(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, statejump_process: Callable[..., Outcome]
) -> Callable[..., Outcome]:
    """Return a function that runs the command in a separate folder; in this process where possible, to save time."""
    from statejump.cli import main

    def run(*arguments: object, **environment: str) -> Outcome:
        words = [str(argument) for argument in arguments]
        if environment or any(word in SPREADING for word in words):
            return statejump_process(*words, **environment)
        output, errors = io.StringIO(), io.StringIO()
        ended: list[BaseException] = []
        report = main._report_failure
        with monkeypatch.context() as there, redirect_stdout(output), redirect_stderr(errors):
            there.chdir(tmp_path)
            there.setattr(main, "_report_failure", lambda error, as_json: (ended.append(error), report(error, as_json))[1])
            try:
                status = main.run(words)
            except SystemExit as end:
                status = int(end.code or 0)
        return Outcome(status, output.getvalue(), errors.getvalue(), ended[0] if ended else None)

    return run


@pytest.fixture
def cases() -> Path:
    """Folder of the case files."""
    return REPOSITORY / "cases"


@pytest.fixture
def edited(tmp_path: Path, cases: Path) -> Callable[..., Path]:
    """Write a case file with text replacements to bad.toml. Each text to replace must occur."""

    def write(*replacements: tuple[str, str], case: str = "table1") -> Path:
        text = (cases / f"{case}.toml").read_text()
        for old, new in replacements:
            assert old in text, old
            text = text.replace(old, new, 1)
        path = tmp_path / "bad.toml"
        path.write_text(text)
        return path

    return write


def damaged(original: dict[str, Any], values: list[Any], count: int) -> Iterator[dict[str, Any]]:
    """Yield copies of a parsed case file with up to three wrong values, keys or sections."""
    rng = random.Random(1)
    for _ in range(count):
        data = {section: dict(keys) for section, keys in original.items()}
        for _ in range(rng.choice((1, 1, 2, 3))):
            section = rng.choice(list(data))
            if not isinstance(data[section], dict) or not data[section]:
                continue
            action, key = rng.random(), rng.choice(list(data[section]))
            if action < 0.8:
                data[section][key] = rng.choice(values)
            elif action < 0.9:
                del data[section][key]
            else:
                data[section] = rng.choice(values)
        yield data


@pytest.fixture(scope="session")
def yade() -> str:
    """Return the yade command for which the plugin was built."""
    if not _paths.YADE:
        pytest.skip("needs YADE")
    return "yade"


@pytest.fixture
def fake_yade(yade: str, tmp_path: Path) -> Callable[[str], str]:
    """Return a function that writes a shell script to use in place of yade, and returns its path."""

    def write(body: str) -> str:
        path = tmp_path / "fake-yade"
        path.write_text("#!/bin/sh\n" + body)
        path.chmod(0o755)
        return str(path)

    return write
