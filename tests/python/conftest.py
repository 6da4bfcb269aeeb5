# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the built package is, and a case file to damage."""
from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

import pytest

BUILT = Path(os.environ["STATEJUMP_PYTHON_DIR"])
COMMAND = os.environ["STATEJUMP_COMMAND"]
REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(BUILT))


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    status: int
    output: str
    errors: str


@pytest.fixture
def statejump(tmp_path: Path) -> Callable[..., Outcome]:
    """Run the command in a folder of its own."""

    def run(*arguments: object, **environment: str) -> Outcome:
        done = subprocess.run(
            [COMMAND, *map(str, arguments)], cwd=tmp_path, env={**os.environ, **environment},
            capture_output=True, text=True, timeout=300, stdin=subprocess.DEVNULL,
        )
        return Outcome(done.returncode, done.stdout, done.stderr)

    return run


@pytest.fixture
def cases() -> Path:
    """Folder of the case files."""
    return REPOSITORY / "cases"


@pytest.fixture
def edited(tmp_path: Path, cases: Path) -> Callable[..., Path]:
    """Write a case file with replacements to bad.toml. Each text must be there."""

    def write(*replacements: tuple[str, str], case: str = "table1") -> Path:
        text = (cases / f"{case}.toml").read_text()
        for old, new in replacements:
            assert old in text, old
            text = text.replace(old, new, 1)
        path = tmp_path / "bad.toml"
        path.write_text(text)
        return path

    return write


@pytest.fixture
def fake_yade(tmp_path: Path) -> Callable[[str], str]:
    """Return the path of a shell script that stands for yade."""

    def write(body: str) -> str:
        path = tmp_path / "fake-yade"
        path.write_text("#!/bin/sh\n" + body)
        path.chmod(0o755)
        return str(path)

    return write
