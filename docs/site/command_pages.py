# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the page of the commands' help texts, and checks that docs/reference/commands.md has every command."""
from __future__ import annotations

import re
import textwrap

import click

from statejump.cli.main import cli
from statejump.cli.suggesting import commands


def unlisted(text: str) -> list[str]:
    """Return what the page of commands lacks, one sentence each."""
    named = set(re.findall(r"[a-z]+", text))
    return [f"docs/reference/commands.md: '{name}' is missing" for name, _ in commands(cli, "statejump")
            if name.split()[-1] not in named]


def help_page() -> str:
    """Return the page: the help text of every command."""
    title = "Options of the commands"
    lines = [title, "=" * len(title), "", "What ``--help`` says.", ""]
    for name, command in commands(cli, "statejump"):
        text = command.get_help(click.Context(command, info_name=name, terminal_width=100, max_content_width=100))
        lines += [name, "-" * len(name), "", ".. code-block:: text", "", textwrap.indent(text, "   "), ""]
    return "\n".join(lines)
