# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the manual page and the shell completion from the definitions of the commands.

PYTHONPATH=build/python /usr/bin/python3 cmake/shell_files.py FOLDER
"""
from __future__ import annotations

import re
import sys
from pathlib import Path

import click
from click.shell_completion import get_completion_class

from statejump import __version__
from statejump.cli.main import TASKS, cli
from statejump.cli.suggesting import commands

NAME = "statejump"
SHELLS = {"bash": NAME, "zsh": f"_{NAME}", "fish": f"{NAME}.fish"}


def escaped(text: str) -> str:
    """Return text escaped for troff: it has no backslash, and no line begins with a control character."""
    return re.sub(r"^([.'])", r"\\&\1", text.replace("\\", r"\e").replace("-", r"\-"), flags=re.MULTILINE)


def manual() -> str:
    """Return the manual page."""
    lines = [f'.TH STATEJUMP 1 "" "statejump {__version__}" "User Commands"', ".SH NAME",
             r"statejump \- state jump of deployable structures", ".SH SYNOPSIS", r".B statejump",
             r"[\fB\-\-json\fR] \fICOMMAND\fR ...", ".SH COMMANDS"]
    for task, found in TASKS.items():
        lines += [f".SS {escaped(task)}"]
        for name, (_, text) in found.items():
            lines += [".TP", rf"\fB{name}\fR", escaped(text)]
    lines += [".SH OPTIONS OF THE COMMANDS"]
    for name, command in commands(cli, NAME):
        shown = click.Context(command, info_name=name, terminal_width=78, max_content_width=78)
        lines += [f".SS {escaped(name)}", ".nf", escaped(command.get_help(shown)), ".fi"]
    lines += [".SH EXIT STATUS",
              "0: done; 1: a tolerance is missed or a contact problem is not solved; 2: bad input, a failed run or "
              "results that could not be written; 70: a fault of the program; 130: interrupted.",
              ".SH LICENCE", escaped("GPL-3.0-or-later.")]
    return "\n".join(lines) + "\n"


def main(folder: Path) -> None:
    """Write the files."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{NAME}.1").write_text(manual(), encoding="utf-8")
    for shell, file in SHELLS.items():
        made = get_completion_class(shell)
        assert made is not None
        # Not source(): it asks which bash runs here, and the file is for the one of whoever installs it.
        completion = made(cli, {}, NAME, f"_{NAME.upper()}_COMPLETE")
        (folder / file).write_text(completion.source_template % completion.source_vars(), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
