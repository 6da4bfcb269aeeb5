# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump bore``: what a measured bore is."""
from __future__ import annotations

from pathlib import Path

import click

from statejump.bores import measure
from statejump.bores.measure import NoBore, check_journal
from statejump.cli.terminal import QUIET, RESULTS, make_console, print_shown
from statejump.core.errors import NotAllowed
from statejump.core.results_folder import Results

# Options of the command by argument of the library, for messages.
OPTIONS = {"inside_out": "--flip", "too_large": "--scale 0.001"}


@click.command("bore")
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
@click.option("--journal-radius", "journal_radius", type=float, default=None, metavar="M",
              help="Radius of the journal [m]: adds the clearance.")
@click.option("--scale", type=float, default=1.0, show_default=True, metavar="S",
              help="Unit of the file [m], 0.001 for millimetres.")
@click.option("--flip", is_flag=True, help="Turn every face over.")
@RESULTS
@QUIET
def bore_command(
    file: Path, journal_radius: float | None, scale: float, flip: bool, results: Results, quiet: bool
) -> None:
    """What the bore in FILE (OFF, STL, PLY, OBJ) is: radius, roundness, lobes, clearance.

    \b
    Example:
      statejump bore bearing.stl --scale 0.001 --journal-radius 5e-3
    """
    console = make_console(quiet)
    check_journal("--journal-radius", journal_radius)
    try:
        bore = measure.bore(file, unit_m=scale, journal_radius_m=journal_radius, flip=flip)
    except NotAllowed as refused:
        refused.key = "--journal-radius"
        raise
    except NoBore as failure:
        failure.remedy = OPTIONS.get(failure.fault)
        raise
    with results.folder(f"bore_{file.stem}") as folder:
        written = folder.publish(bore.write(folder.staged))
    print_shown(bore.summary_lines(), console)
    console.print(f"results: {', '.join(str(path) for path in written)}")
