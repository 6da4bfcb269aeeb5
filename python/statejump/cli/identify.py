# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump identify``: a joint from a measured loop."""
from __future__ import annotations

from pathlib import Path
from shlex import quote

import click

from statejump.cli.terminal import QUIET, RESULTS, make_console, print_shown
from statejump.core.errors import NotAllowed, StatejumpError, UnknownKey
from statejump.core.results_folder import Results
from statejump.identification import identify
from statejump.identification.loop import read_loop
from statejump.identification.prediction import compared, write_prediction

# Options of the command by argument of the library, for messages.
OPTIONS = {"model": "--model", "start": "--start", "confidence": "--confidence", "target": "--for",
           "normal_force_N": "--normal-force", "journal_radius_m": "--journal-radius",
           "ignored": "--ignore"}


@click.command("identify")
@click.argument("loop_file", metavar="LOOP.csv", type=click.Path(path_type=Path))
@click.option("--model", default="auto", show_default=True, metavar="NAME",
              help="Joint that is fitted: linear, clearance, coulomb, coulomb_clearance, coulomb_soft_stops, "
                   "coulomb_play, mindlin, iwan, the last six also with _spring at the end, coulomb_soft_play; auto: "
                   "all, the best by BIC.")
@click.option("--start", default="unknown", show_default=True, metavar="HOW",
              help="Friction before the first row: fresh (carries nothing), cycled (the path was gone before), unknown "
                   "(what fits best).")
@click.option("--confidence", type=float, default=0.95, show_default=True, metavar="P", help="Of the intervals.")
@click.option("--for", "target", default=None, metavar="WHAT",
              help="Section that is written: spring_slider, slider, revolute, umbrella, torsion_spring, iwan_joint.  "
                   "[default: spring_slider, of rotations umbrella]")
@click.option("--normal-force", type=float, default=None, metavar="N",
              help="Normal force in the test [N]: friction becomes a coefficient.")
@click.option("--journal-radius", type=float, default=None, metavar="M",
              help="Radius of the journal [m], of a moment of friction likewise.")
@click.option("--ignore", "ignored", multiple=True, metavar="COLUMN", help="Leave out a column of the table.")
@click.option("--columns", default=None, metavar="NAMES",
              help="Names of the columns, for a table without a header or in place of its own: disp_mm,force_kN.")
@click.option("--predict", "other_file", default=None, metavar="OTHER.csv", type=click.Path(path_type=Path),
              help="Another test of the same joint: its force and energy loss are predicted and compared.")
@RESULTS
@QUIET
def identify_command(
    loop_file: Path, model: str, start: str, confidence: float, target: str | None, normal_force: float | None,
    journal_radius: float | None, ignored: tuple[str, ...], columns: str | None, other_file: Path | None,
    results: Results, quiet: bool,
) -> None:
    """Clearance, stiffness, friction and preload of a joint from the measured loop in LOOP.csv, with intervals.

    LOOP.csv has the columns displacement_m and force_N, or rotation_rad and moment_N_m, row by row as measured, or the
    same in other units, as "disp [mm]" and "Force [kN]".

    \b
    Example:
      statejump identify hinge.csv --normal-force 100
    """
    console = make_console(quiet)
    given = [name.strip() for name in columns.split(",")] if columns else ()
    with results.folder(f"identify_{loop_file.stem}") as folder:
        try:
            found = identify(loop_file, model=model, start=start, confidence=confidence, target=target,
                             normal_force_N=normal_force, journal_radius_m=journal_radius, ignored=ignored,
                             columns=given)
            other = read_loop(other_file, start, ignored, given) if other_file else None
        except StatejumpError as refused:
            if isinstance(refused, NotAllowed) and refused.key in OPTIONS:
                refused.key = OPTIONS[refused.key]
            if isinstance(refused, UnknownKey) and not refused.remedy:
                refused.remedy = f"--ignore {quote(str(refused.key))} leaves it out, --columns gives other names"
            if refused.code in ("column_of_other_unit", "column_without_unit", "columns_of_one_key"):
                said = f"--ignore {quote(str(refused.details['column']))} leaves it out"
                refused.remedy = f"{refused.remedy}; {said}" if refused.remedy else said
            if refused.code == "table_without_header":
                refused.remedy = "--columns names them, for example --columns displacement_mm,force_kN"
            raise
        files = found.write(folder.staged)
        if other is not None:
            files.append(write_prediction(found, other, folder.staged / "prediction.csv"))
        written = folder.publish(files)
    print_shown(found.summary_lines(), console)
    if other is not None:
        print_shown([compared(found, other)], console)
    console.print(found.joint(), markup=False, highlight=False)
    console.print(f"results: {', '.join(str(path) for path in written)}")
