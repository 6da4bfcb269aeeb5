# SPDX-License-Identifier: GPL-3.0-or-later
"""Groups of commands that suggest the nearest name for a misspelt command, and list commands in full sentences."""
from __future__ import annotations

from collections.abc import Iterator

import click


class Suggesting(click.Group):
    """A group of commands."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as unknown:
            from difflib import get_close_matches  # imported only for misspelt words, because it slows the start

            near = get_close_matches(args[0], self.list_commands(ctx), n=1)
            if near and self.get_command(ctx, args[0]) is None:
                unknown.message += f" Did you mean {near[0]!r}?"
            raise

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List every command with the complete first sentence of its help."""
        found = [(name, self.get_command(ctx, name)) for name in self.list_commands(ctx)]
        rows = [(name, command.get_short_help_str(limit=1000)) for name, command in found
                if command is not None and not command.hidden]
        if rows:
            with formatter.section("Commands"):
                formatter.write_dl(rows)


def commands(command: click.Command, name: str) -> Iterator[tuple[str, click.Command]]:
    """Yield every executable command with its full name."""
    if isinstance(command, click.Group):
        context = click.Context(command, info_name=name)
        for part in command.list_commands(context):
            found = command.get_command(context, part)
            assert found is not None
            yield from commands(found, f"{name} {part}")
    else:
        yield name, command
