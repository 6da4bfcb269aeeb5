# SPDX-License-Identifier: GPL-3.0-or-later
"""Script and data of a DEM run in a folder of the user, who can repeat, change or view the run by hand."""
from __future__ import annotations

import json
import os
import shlex
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from statejump import _paths
from statejump.core.errors import FailedRun, NotAllowed
from statejump.core.output import not_written, write_bytes
from statejump.core.yade_process import DATA, RUNNER, command_of, python_path

NO_DISPLAY = 3  # exit status of the script


def check_folder(folder: Path) -> None:
    """Raise NotAllowed for a folder with files that are not the input of a DEM run."""
    if folder.is_dir() and any(folder.iterdir()) and not (folder / RUNNER).is_file():
        raise NotAllowed("--keep-input", str(folder), code="folder_not_empty")


def keep_input(values: Mapping[str, Any], folder: Path) -> str:
    """Write script and data of a DEM run into a folder; return the shell command that repeats the run.

    :param values: the resolved case, as :func:`statejump.core.yade_process.run` takes it
    :raises NotAllowed: the folder has other files
    :raises NotWritten: the folder cannot be written
    """
    check_folder(folder)
    runner = _paths.YADE_SCRIPTS / "runner"
    files = {file.relative_to(runner): file.read_bytes() for file in runner.rglob("*.py")
             if file.name != "batch_case.py"}
    files[Path(DATA)] = (json.dumps(values, indent=1) + "\n").encode()
    for name, content in files.items():
        target = folder / name
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise not_written(target.parent, error) from None
        write_bytes(target, content)
    return shlex.join(["env", f"PYTHONPATH={python_path()}", *command_of(values, folder / RUNNER)])


def check_display() -> None:
    """Raise FailedRun if YADE has no display for its 3-D view."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise _no_display("there is no display")


def _no_display(cause: str, display: str | None = None) -> FailedRun:
    return FailedRun(code="no_display", cause=cause, **{} if display is None else {"value": display})


def view(values: Mapping[str, Any], folder: Path) -> None:
    """Open YADE with its 3-D view and its prompt on a kept input; return when the user ends YADE.

    :raises FailedRun: there is no display, or YADE ended with an error
    """
    check_display()
    environment = dict(os.environ, PYTHONPATH=python_path(), STATEJUMP_VIEW="1")
    status = subprocess.run(command_of(values, folder / RUNNER, view=True), env=environment, check=False).returncode
    if status == NO_DISPLAY:
        display = os.environ.get("DISPLAY", "")
        raise _no_display(f"YADE cannot connect to the display {display!r}", display)
    if status != 0:
        raise FailedRun(code="yade_view_ended", status=status, case=values["case"]["name"])
