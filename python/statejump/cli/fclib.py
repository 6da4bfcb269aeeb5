# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump fclib``: frictional contact problems in files of FCLIB."""
from __future__ import annotations

from pathlib import Path

import click

from statejump import fclib
from statejump.cli.suggesting import Suggesting
from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, undivided
from statejump.core.errors import NotAllowed
from statejump.core.output import check_suffix, check_target
from statejump.core.results_folder import Results
from statejump.fclib import Merit
from statejump.kinds import require
from statejump.kinds.protocol import ContactProblems


@click.group("fclib", cls=Suggesting)
def fclib_command() -> None:
    """Frictional contact problems of many contacts, in files of FCLIB.

    \b
    Example:
      statejump fclib solve Capsules-i125-1213.hdf5 -o solved.hdf5
      statejump fclib write cases/trusses/ring_12.toml
    """


def _merit_line(name: str, merit: Merit) -> str:
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
    console = make_console(quiet)
    if output is not None:
        check_suffix("--output", output, ".hdf5", ".h5")
        check_target(output)
    problem = fclib.read(file)
    console.print(f"{problem.title or file.name}: {problem.contacts} contacts in {problem.dimension}-D")
    for stored in problem.stored:
        console.print(_merit_line(f"stored {stored.name}", fclib.merit(problem, stored.reactions)))
    solution = fclib.solve(problem, tolerance=tolerance, method=method, most_sweeps=most_sweeps)
    console.print(_merit_line(f"found by {solution.method.replace('_', ' ')}", solution.merit))
    console.print(f"iterations: {solution.effort}; {solution.seconds:.3g} s")
    if not solution.solved:
        raise fclib.NotSolved(solution, tolerance, file=file)
    if output is not None:
        fclib.write(output, problem, solution)
        console.print(f"results: {output}")


@fclib_command.command("write")
@CASE
@click.option("--number", type=int, default=20, show_default=True, metavar="N",
              help="Of steps, evenly spread over the path.")
@RESULTS
@QUIET
def write_command(case_file: Path, number: int, results: Results, quiet: bool) -> None:
    """Write frictional contact problems of the joints along the path of CASE, a truss, as FCLIB's local problems.

    The truss is condensed to its joints; u = W r + q are the motions [m] of one step of the path. Each file holds the
    path's own forces as its solution. They appear in the folder fclib of the case's results.

    \b
    Example:
      statejump fclib write cases/trusses/ring_12.toml --number 50
    """
    console = make_console(quiet)
    case = loaded(case_file, ContactProblems)
    try:
        with (undivided(console, f"{case.name}, path") as on_progress,
              results.folder(f"{case.name}/fclib", case) as folder):
            found = require(case, ContactProblems).contact_problems(case, number, on_progress)
            written = []
            for place, one in enumerate(found, start=1):
                path = folder.staged / f"step_{place:0{len(str(number))}d}.hdf5"
                fclib.write(path, one.problem, one.problem.stored[0])
                written.append(path)
            written = folder.publish(written)
    except NotAllowed as refused:
        refused.key = {"number": "--number"}.get(refused.key or "", refused.key)
        raise
    worst = max((one.merit.largest for one in found), default=0.0)
    console.print(f"{len(written)} problems of {max((one.problem.contacts for one in found), default=0)} contacts at "
                  f"most; the path's own forces have a merit of {worst:.3g} at most")
    console.print(f"results: {folder.path}")
