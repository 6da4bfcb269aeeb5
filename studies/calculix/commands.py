# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump fe``: comparison of a case in CalculiX with the reduced model."""
from __future__ import annotations

from pathlib import Path

import click

from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, print_comparison
from statejump.core.errors import TolerancesMissed
from statejump.core.results_folder import Results
from statejump.core.tables import write_rows, write_text
from studies import calculix


@click.command("fe")
@CASE
@RESULTS
@QUIET
def fe_command(case_file: Path, results: Results, quiet: bool) -> None:
    """CASE in finite elements beside the reduced model: writes a deck, runs CalculiX (ccx), reads it back.

    A bar on a slider gets frictional contact and stops; of a truss every joint is locked, and where its only joints are
    sliders they slip as well. Beams bend, condensed bodies are the meshes of their decks, and sliders and hinges
    between them slip. Exit status 1 where the two differ by more than they may.

    \b
    Example:
      statejump fe cases/table1.toml
    """
    console = make_console(quiet)
    case = loaded(case_file)
    calculix.check(case)
    with results.folder(case.name, case) as folder:
        found = calculix.answer(case)
        write_text(folder.staged / "fe.inp", found.deck.splitlines())
        write_rows(folder.staged / "fe.csv", [row.to_dict() for row in found.rows])
        written = folder.publish([folder.staged / "fe.inp", folder.staged / "fe.csv"])
    print_comparison(f"{case.title}: differences relative", found.rows, console)
    for note in found.notes:
        console.print(f"note: {note}")
    console.print(f"results: {', '.join(str(path) for path in written)}")
    missed = [row.name for row in found.rows if not row.passed]
    if missed:
        raise TolerancesMissed(missed, case=case.name)
