# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump laws``: the catalogue of contact laws and their curves."""
from __future__ import annotations

from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Any, TypeVar

import click
from rich.table import Table

from statejump import _engine
from statejump.cli.suggesting import Suggesting
from statejump.cli.terminal import QUIET, RESULTS, CaseFile, loaded, make_console
from statejump.core.errors import StatejumpError
from statejump.core.output import check_suffix
from statejump.core.results_folder import Results
from statejump.kinds import require
from statejump.kinds.protocol import JointOfLaws
from statejump.laws import build, curves
from statejump.laws.drive import drive_file
from statejump.laws.traits import KINDS, catalogue

Command = TypeVar("Command", bound=Callable[..., Any])


class CaseOrCommand(Suggesting):
    """A group of commands whose first argument may be a case: ``statejump laws [CASE]`` means ``statejump laws show
    [CASE]``, and ``statejump laws --drive FILE`` means ``statejump laws drive --drive FILE``."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Insert the name of the command before its arguments."""
        if not args or (args[0] not in self.commands and args[0] not in ctx.help_option_names):
            driven = any(argument.partition("=")[0] == "--drive" for argument in args)
            args = ["drive" if driven else "show", *args]
        return super().parse_args(ctx, args)


@click.group("laws", cls=CaseOrCommand)
def laws_command() -> None:
    """Catalogue of contact laws, and their curves for the joint of CASE (the paper's without).

    \b
    Examples:
      statejump laws
      statejump laws cases/umbrella.toml
      statejump laws build my_law.hpp
      statejump laws --drive history.csv --law mindlin -o out.csv ...
    """


@laws_command.command("show")
@click.argument("case_file", metavar="[CASE]", required=False, type=CaseFile())
@RESULTS
@QUIET
def show_command(case_file: Path | None, results: Results, quiet: bool) -> None:
    """Print the catalogue; draw the curves for the joint of CASE (the paper's without)."""
    problems = _engine.user_law_problems()
    if problems:
        raise StatejumpError("; ".join(problems), code="bad_law")
    console = make_console(quiet)
    case = loaded(case_file, JointOfLaws) if case_file is not None else None
    for kind in KINDS:
        table = Table(title=f"{kind.replace('_', ' ').capitalize()} laws", show_lines=True)
        for heading in ("name", "formula", "range", "source", "holds a static load"):
            table.add_column(heading, overflow="fold")
        for law in catalogue(kind):
            table.add_row(law.name, law.formula, law.range, law.source, "yes" if law.holds_static_load else "no")
        console.print(table)
    with results.folder("laws") as folder:
        if case is None:
            joint, name = curves.paper_joint(), "laws"
        else:
            joint, name = require(case, JointOfLaws).laws(case), f"laws_{case.name}"
        written = folder.publish(curves.figure(joint, folder.staged, name))
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


def _number(name: str, unit: str, text: str, needed: bool = False) -> Callable[[Command], Command]:
    return click.option(f"--{name}", type=float, required=needed, metavar=unit, help=f"{text} [{unit}].")


@laws_command.command("drive")
@click.option("--drive", "history", required=True, metavar="HISTORY.csv", type=click.Path(path_type=Path),
              help="Path of the contact: columns penetration_depth_m or normal_force_N; slide_m, or slide_x_m and "
                   "slide_y_m, or tangential_force_N; time_s for a law that depends on velocity. A row is a turning "
                   "point or a point of a straight part; the contact is made at the first.")
@click.option("--law", required=True, metavar="NAME", help="Name of a friction, normal or dissipation law.")
@_number("effective-young-modulus", "Pa", "E*, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2", True)
@_number("effective-shear-modulus", "Pa", "G*, 1/G* = (2 - nu1)/G1 + (2 - nu2)/G2", True)
@_number("effective-radius", "m", "R; of a journal in a bore R1 R2/(R2 - R1)", True)
@_number("friction-coefficient", "-", "mu", True)
@click.option("--steps-per-row", type=int, default=1, show_default=True, metavar="N",
              help="Equal steps from one row to the next.")
@_number("radial-clearance", "m", "R2 - R1, which a line contact needs; without it the wall is flat")
@_number("contact-length", "m", "Of a line contact")
@_number("restitution", "-", "What a dissipation law is asked for")
@_number("smallest-impact-speed", "m/s", "Floor of the impact speed that scales dissipation")
@_number("v0", "m/s", "Of the friction law that reads it")
@_number("v1", "m/s", "Of the friction law that reads it")
@click.option("-o", "--output", "written", required=True, metavar="OUT.csv", type=click.Path(path_type=Path),
              help="What the law answers: the columns of the history, forces, energies, dissipation, state.")
@QUIET
def drive_command(
    history: Path, law: str, effective_young_modulus: float, effective_shear_modulus: float, effective_radius: float,
    friction_coefficient: float, steps_per_row: int, radial_clearance: float | None, contact_length: float | None,
    restitution: float | None, smallest_impact_speed: float | None, v0: float | None, v1: float | None, written: Path,
    quiet: bool,
) -> None:
    """Lead one contact along a path and write what a law answers; 'statejump laws --drive' is the same.

    \b
    Example:
      statejump laws --drive history.csv --law mindlin --effective-young-modulus 38.5e9
          --effective-shear-modulus 7.9e9 --effective-radius 0.01 --friction-coefficient 0.3 -o out.csv
    """
    check_suffix("--output", written, ".csv")
    drive_file(
        law, history, written, effective_young_modulus_Pa=effective_young_modulus,
        effective_shear_modulus_Pa=effective_shear_modulus, effective_radius_m=effective_radius,
        friction_coefficient=friction_coefficient, steps_per_row=steps_per_row,
        radial_clearance_m=inf if radial_clearance is None else radial_clearance, contact_length_m=contact_length,
        restitution=restitution, smallest_impact_speed_m_per_s=smallest_impact_speed, v0_m_per_s=v0, v1_m_per_s=v1,
    )
    make_console(quiet).print(f"written: {written}")
