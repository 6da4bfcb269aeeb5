# SPDX-License-Identifier: GPL-3.0-or-later
"""First use: help by task, nearest names, the wrong Python version."""
from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from conftest import BUILT, COMMAND, REPOSITORY
from failures import failure
from statejump import _paths


def test_help_names_every_command_once_by_task(statejump: Callable[..., Any]) -> None:
    from statejump.cli.main import COMMANDS, TASKS

    said = statejump("--help").output
    assert all(f"\n{task}:\n" in said for task in TASKS)
    for name, (_, text) in COMMANDS.items():
        assert text.endswith(".") and said.count(f"\n  {name} ") == 1, name
        assert text in " ".join(said.split()), name


def test_commands_of_a_group_have_whole_sentences(statejump: Callable[..., Any]) -> None:
    assert "..." not in statejump("truss", "--help").output.split("Commands:")[1]


@pytest.mark.parametrize("words, meant", [
    (("reducd", "table1"), "reduced"), (("truss", "anwsers", "x"), "answers"), (("fclib", "slove"), "solve"),
])
def test_misspelt_command_is_told_the_nearest(statejump: Callable[..., Any], words: tuple[str, ...], meant: str) -> None:
    done = statejump(*words)
    assert done.status == 2 and f"'{meant}'?" in done.errors, done.errors
    assert done.errors.count("\n") == 1


def test_another_python_is_told_which_one_it_takes() -> None:
    """The import fails as in another Python version; one sentence names the interpreter needed and both versions."""
    code = ("import sys; sys.version_info = (3, 99, 0, 'final', 0)\n"
            "try:\n    import statejump\nexcept ImportError as error:\n    print(error)")
    done = subprocess.run([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": str(BUILT)},
                          capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.startswith("statejump") and str(_paths.PYTHON) in done.stdout and done.stdout.endswith("(3.99)\n")


def test_manual_and_completion_are_of_the_commands(tmp_path: Path) -> None:
    from statejump.cli.main import COMMANDS

    environment = {**os.environ, "PYTHONPATH": str(BUILT)}
    subprocess.run([sys.executable, str(REPOSITORY / "cmake" / "shell_files.py"), str(tmp_path)], env=environment,
                   timeout=120, check=True)
    assert {path.name for path in tmp_path.iterdir()} == {"statejump.1", "statejump", "_statejump", "statejump.fish"}
    page = (tmp_path / "statejump.1").read_text()
    for name in COMMANDS:
        assert f"\\fB{name}\\fR\n" in page and f".SS statejump {name}" in page, name
    subprocess.run(["bash", "-n", str(tmp_path / "statejump")], timeout=60, check=True)
    done = subprocess.run([COMMAND], capture_output=True, text=True, timeout=60, env={
        **os.environ, "_STATEJUMP_COMPLETE": "bash_complete", "COMP_WORDS": "statejump truss an", "COMP_CWORD": "2"})
    assert done.stdout == "plain,answers\n" and not done.stderr


def test_demo_refuses_other_models_in_one_sentence(statejump: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """``make demo`` builds only the first of the engine's two modules; here the second module is hidden."""
    monkeypatch.setitem(sys.modules, "statejump._engine_more", None)
    assert statejump("reduced", "table1").status == 0
    refused = statejump("reduced", "umbrella_damped")
    assert refused.status == 2 and refused.errors.count("\n") == 1
    assert refused.failure == failure("not_in_build")


def test_engine_has_the_names_of_both_modules() -> None:
    from statejump import _engine

    assert _engine.truss_joints() and _engine.BoreMesh.read
    with pytest.raises(AttributeError, match="'nothing'"):
        _engine.nothing
