# SPDX-License-Identifier: GPL-3.0-or-later
"""Page of the commands' own help texts, and the check that docs/commands.md has every command."""
from __future__ import annotations

import re
import textwrap
from typing import Iterator

import click

from statejump.cli.main import cli


def commands(command: click.Command = cli, name: str = "statejump") -> Iterator[tuple[str, click.Command]]:
    """Yield every command that does something: as it is typed, and itself."""
    if isinstance(command, click.Group):
        context = click.Context(command, info_name=name)
        for part in command.list_commands(context):
            found = command.get_command(context, part)
            assert found is not None
            yield from commands(found, f"{name} {part}")
    else:
        yield name, command


def unlisted(text: str) -> list[str]:
    """Return what the page of commands lacks, one sentence each."""
    named = set(re.findall(r"[a-z]+", text))
    return [f"docs/commands.md: '{name}' is missing" for name, _ in commands() if name.split()[-1] not in named]


def help_page() -> str:
    """Return the page: the help text of every command."""
    title = "Options of the commands"
    lines = [title, "=" * len(title), "", "What ``--help`` says.", ""]
    for name, command in commands():
        text = command.get_help(click.Context(command, info_name=name, terminal_width=100, max_content_width=100))
        lines += [name, "-" * len(name), "", ".. code-block:: text", "", textwrap.indent(text, "   "), ""]
    return "\n".join(lines)
