# SPDX-License-Identifier: GPL-3.0-or-later
"""The report page in headless Chromium: drive.mjs says what is checked."""
from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
CASES = ("table1", "umbrella_damped")
TRUSSES = {"ring_12": ("--cycles", "2"), "umbrella_8": ("--no-sensitivity",)}


def _run(*command: object, folder: Path) -> None:
    done = subprocess.run(
        [str(part) for part in command], cwd=folder, env=os.environ, capture_output=True, text=True, timeout=300,
        stdin=subprocess.DEVNULL,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with a report page of each case, one of the first two cases, and pages with results of `truss answers`."""
    folder = tmp_path_factory.mktemp("pages")
    statejump = os.environ["STATEJUMP_COMMAND"]
    for case in CASES:
        _run(statejump, "compare", HERE.parents[1] / "cases" / f"{case}.toml", "--quiet", folder=folder)
        _run(statejump, "report", f"results/{case}", "-o", f"{case}.html", folder=folder)
    _run(statejump, "report", "results", "-o", "several.html", folder=folder)
    for case, more in TRUSSES.items():
        _run(statejump, "truss", "answers", HERE.parents[1] / "cases" / "trusses" / f"{case}.toml", *more, "--quiet",
             folder=folder)
        _run(statejump, "report", f"results/{case}", "-o", f"{case}.html", folder=folder)
    return folder


@pytest.mark.parametrize(
    ("page", "checks"),
    [
        ("table1", ["replay", "keyboard", "themes", "narrow", "names"]),
        ("umbrella_damped", ["replay", "narrow"]),
        ("table1", ["without_webgl"]),
        ("ring_12", ["truss", "narrow", "names"]),
        ("umbrella_8", ["truss_in_space", "narrow"]),
        ("several", ["several"]),
    ],
)
def test_page(pages: Path, page: str, checks: list[str]) -> None:
    _run(os.environ["STATEJUMP_NODE"], HERE / "drive.mjs", pages / f"{page}.html", *checks, folder=pages)
