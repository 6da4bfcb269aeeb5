# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts YADE with in_yade.py of this folder and reads its measurements."""
from __future__ import annotations

import json
import os
import shlex
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from .binary import Libraries

SCRIPT = Path(__file__).resolve().parent / "in_yade.py"
TIMEOUT_S = 300


class NotMeasured(Exception):
    """YADE returned no measurement; the message has the reason."""


@dataclass
class Found:
    """What was measured inside of YADE."""

    version: str
    members: dict[tuple[str, str], tuple[int, str]]  # class, member: offset [byte], type
    shown: dict[str, list[str]]
    by_getter: list[tuple[str, str]]
    by_value: list[tuple[str, str]]
    read: int  # attributes of all classes
    seconds: float  # without YADE's start


def command_of(folder: Path) -> str | None:
    """Return the yade command installed beside the libraries of a folder, if there is one."""
    command = folder.resolve().parents[2] / "bin" / "yade"
    return str(command) if command.exists() else None


def measure(command: str, libraries: Libraries) -> Found:
    """Run the measurement inside of YADE."""
    with tempfile.TemporaryDirectory(prefix="measure-yade-") as folder:
        try:
            done = subprocess.run([*shlex.split(command), "-n", "-x", str(SCRIPT)], cwd=folder, check=False,
                                  capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=TIMEOUT_S,
                                  env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1",
                                       "STATEJUMP_FORCES_AT": str(libraries.forces_offset() or "")})
        except (OSError, subprocess.TimeoutExpired) as error:
            raise NotMeasured(f"{command} cannot be run here: {error}") from error
    line = next((one for one in done.stdout.splitlines() if one.startswith("MEASURED ")), None)
    if line is None:
        words = (done.stdout + done.stderr).strip().splitlines()[-1:]
        raise NotMeasured(f"{command} ended without an answer: {' '.join(words)}")
    said = json.loads(line.removeprefix("MEASURED "))
    # A copy that was unpacked into a folder uses the paths of the system.
    if not Path(said["library"]).samefile(libraries.folder / "libyade.so"):
        raise NotMeasured(f"{command} runs with {said['library']}")
    members = {(row[0], row[1]): (row[2], row[3]) for row in said["getters"] + said["values"]}
    shown: dict[str, list[str]] = {}
    for row in said["getters"]:
        shown.setdefault(row[0], []).append(row[1])
    return Found(said["version"], members, shown, [(row[0], row[1]) for row in said["getters"]],
                 [(row[0], row[1]) for row in said["values"]], said["read"], said["seconds"])
