# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump fclib``: frictional contact problems in files of FCLIB."""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from statejump.cli.terminal import QUIET, make_console

if TYPE_CHECKING:
    from statejump.fclib import Merit


@click.group("fclib")
def fclib_command() -> None:
    """Frictional contact problems of many contacts, in files of FCLIB.

    \b
    Example:
      statejump fclib solve Capsules-i125-1213.hdf5 -o solved.hdf5
    """


def _told(name: str, merit: Merit) -> str:
    return f"{name}: merit {merit.natural_map:.3g}, scaled {merit.scaled:.3g}"


@fclib_command.command("solve")
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
@click.option("-o", "--output", metavar="OUT", type=click.Path(path_type=Path),
              help="File of FCLIB that gets problem and solution; only what is solved is written.")
@click.option("--tolerance", type=float, default=1e-10, show_default=True, metavar="MERIT",
              help="Largest merit of a solution.")
@click.option("--method", default="automatic", show_default=True,
              type=click.Choice(["automatic", "gauss_seidel", "newton", "interior_point", "lemke"]),
              help="How; lemke in the plane only.")
@click.option("--most-sweeps", type=int, default=5000, show_default=True, metavar="N",
              help="Sweeps of Gauss-Seidel after which it is given up.")
@QUIET
def solve_command(file: Path, output: Path | None, tolerance: float, method: str, most_sweeps: int,
                  quiet: bool) -> None:
    """Solve the local problem in FILE (HDF5): W, q, friction, 2-D or 3-D.

    Prints the merit of what FILE holds as solution or guess, then iterations, time and merit of the solution found.
    Exit status 0 where both merits are within the tolerance, 1 where no method came to it, 2 for a file that is not
    right.

    \b
    Example:
      statejump fclib solve Capsules-i125-1213.hdf5 -o solved.hdf5
    """
    from statejump import fclib
    from statejump.core.output import check_target

    console = make_console(quiet)
    if output is not None:
        check_target(output)
    problem = fclib.read(file)
    console.print(f"{problem.title or file.name}: {problem.contacts} contacts in {problem.dimension}-D")
    for stored in problem.stored:
        console.print(_told(f"stored {stored.name}", fclib.merit(problem, stored.reactions)))
    solution = fclib.solve(problem, tolerance=tolerance, method=method, most_sweeps=most_sweeps)
    console.print(_told(f"found by {solution.method.replace('_', ' ')}", solution.merit))
    console.print(f"iterations: {solution.effort}; {solution.seconds:.3g} s")
    if not solution.solved:
        raise fclib.NotSolved(solution, tolerance, file=file)
    if output is not None:
        fclib.write(output, problem, solution)
        console.print(f"results: {output}")
