# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump laws``: the catalogue of contact laws and their curves."""
from __future__ import annotations

from pathlib import Path

import click
from rich.table import Table

from statejump import _engine
from statejump.cli.terminal import QUIET, RESULTS, CaseFile, loaded, make_console
from statejump.core.errors import StatejumpError
from statejump.core.output import results_folder
from statejump.laws import build, curves
from statejump.laws.traits import KINDS, catalogue


class CaseOrCommand(click.Group):
    """A group whose first argument may be a case: ``statejump laws [CASE]`` is ``statejump laws show [CASE]``."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Put the command in front of a case."""
        if not args or (args[0] not in self.commands and args[0] not in ctx.help_option_names):
            args = ["show", *args]
        return super().parse_args(ctx, args)


@click.group("laws", cls=CaseOrCommand)
def laws_command() -> None:
    """Catalogue of contact laws, and their curves for the joint of CASE (the paper's without).

    \b
    Examples:
      statejump laws
      statejump laws cases/umbrella.toml
      statejump laws build my_law.hpp
    """


@laws_command.command("show")
@click.argument("case_file", metavar="[CASE]", required=False, type=CaseFile())
@RESULTS
@QUIET
def show_command(case_file: Path | None, results: Path, quiet: bool) -> None:
    """Print the catalogue; draw the curves for the joint of CASE (the paper's without)."""
    problems = _engine.user_law_problems()
    if problems:
        raise StatejumpError("; ".join(problems))
    console = make_console(quiet)
    case = loaded(case_file, "laws") if case_file is not None else None
    folder = results_folder(results, "laws")
    for kind in KINDS:
        table = Table(title=f"{kind} laws", show_lines=True)
        for heading in ("name", "formula", "range", "source", "holds a static load"):
            table.add_column(heading, overflow="fold")
        for law in catalogue(kind):
            table.add_row(law.name, law.formula, law.range, law.source, "yes" if law.holds_static_load else "no")
        console.print(table)
    if case is None:
        written = curves.figure(curves.paper_joint(), folder, "laws")
    else:
        written = curves.figure(case.behaviour.ability("laws", case)(case), folder, f"laws_{case.name}")
    console.print(f"curves: {', '.join(str(name) for name in written)}")


@laws_command.command("build")
@click.argument("header", metavar="HEADER", type=click.Path(path_type=Path))
@click.option("--folder", type=click.Path(file_okay=False, path_type=Path), metavar="FOLDER",
              help="Where the law goes; without, the folder of your own that every program searches. Another one is "
                   "searched if $STATEJUMP_LAWS lists it.")
@QUIET
def build_command(header: Path, folder: Path | None, quiet: bool) -> None:
    """Compile a law of your own: case files, 'statejump laws' and YADE scripts then know it by its name.

    HEADER holds one type like those of the catalogue and says 'using UserLaw = ...;' of it.

    \b
    Example:
      statejump laws build my_law.hpp
    """
    console = make_console(quiet)
    written = build.build(header, folder)
    console.print(f"law: {written}")
    if folder is not None and folder.resolve() not in (Path(each).resolve() for each in _engine.user_law_folders()):
        console.print(f"searched only if $STATEJUMP_LAWS lists {folder}")
