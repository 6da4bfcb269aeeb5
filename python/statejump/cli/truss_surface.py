# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump truss surface``: RMS errors, tilt, focal change, Zernike terms and pointing of a reflecting surface."""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from statejump import surface
from statejump.campaign.outputs import unit
from statejump.cli.terminal import QUIET, RESULTS, CaseFile, loaded, make_console, print_shown, undivided
from statejump.core.case import Case
from statejump.core.errors import MissingKey, NotAllowed, StatejumpError
from statejump.core.results_folder import Results
from statejump.core.table_files import SUFFIXES, read_columns
from statejump.core.tables import Shown, write_columns, write_csv
from statejump.core.units import plain
from statejump.kinds import require
from statejump.kinds.protocol import ReducedModel
from statejump.surface import Design, repeatability, summary
from statejump.surface.runs import displacements_m

if TYPE_CHECKING:
    from rich.console import Console

# Options of the command by argument of the library, for messages.
OPTIONS = {"axis": "--axis", "focal_length_m": "--focal-length", "direction": "--direction", "terms": "--zernike",
           "measure": "--measure", "share": "--share", "length_m": "--length"}


@click.command("surface")
@click.argument("file", metavar="CASE|NODES.csv", type=CaseFile())
@click.option("--measure", default="normal", show_default=True, metavar="HOW",
              help="What RMS is of: normal, half_path (of Ruze's formula), axial.")
@click.option("--direction", type=float, nargs=3, default=None, metavar="X Y Z",
              help="Direction whose pointing error is reported.  [default: the axis]")
@click.option("--zernike", "terms", type=int, default=None, metavar="N",
              help="Zernike terms, 1 to 36.  [default: as many whole orders as the nodes determine]")
@click.option("--axis", type=float, nargs=3, default=None, metavar="X Y Z",
              help="Axis of the paraboloid of NODES.csv.  [default: 0 0 1]")
@click.option("--focal-length", type=float, default=None, metavar="M",
              help="Focal length of NODES.csv [m].  [default: best fit]")
@click.option("--samples", type=click.Path(path_type=Path), default=None, metavar="SAMPLES.csv",
              help="Campaign whose repeatability is reported, with --column.")
@click.option("--column", default=None, metavar="NAME",
              help="Change of a length in SAMPLES.csv, as repeat:displacement_m[NODE].")
@click.option("--share", type=float, default=0.99, show_default=True, metavar="P",
              help="Of the samples that stay below.")
@click.option("--length", type=float, default=None, metavar="M",
              help="Length to which the repeatability refers [m].  [default: diameter of the aperture]")
@RESULTS
@QUIET
def surface_command(
    file: Path, measure: str, direction: tuple[float, float, float] | None, terms: int | None,
    axis: tuple[float, float, float] | None, focal_length: float | None, samples: Path | None, column: str | None,
    share: float, length: float | None, results: Results, quiet: bool,
) -> None:
    """What the reflector of CASE does over its cycles, or what displacements in NODES.csv do to a surface.

    NODES.csv has the columns x_m, y_m, z_m, displacement_x_m, displacement_y_m, displacement_z_m; node may be there.

    \b
    Examples:
      statejump truss surface cases/trusses/umbrella_8.toml
      statejump truss surface nodes.csv --focal-length 2.5 --zernike 36
    """
    console = make_console(quiet)
    if (samples is None) != (column is None):
        raise MissingKey("--column" if column is None else "--samples", code="samples_and_column")
    notes: list[str] = []
    history: dict[str, np.ndarray] = {}
    case: Case | None = None
    try:
        if file.suffix.lower() in SUFFIXES:
            drawn, moved = summary.read_nodes(file)
            design = surface.Design.of(drawn, (0, 0, 1) if axis is None else axis, focal_length)
            states, name = {"nodes": moved}, file.stem
        else:
            for option, given in (("--axis", axis), ("--focal-length", focal_length)):
                if given is not None:
                    raise NotAllowed(option, code="conflicts_with_case")
            case = loaded(file, ReducedModel)
            name, notes = case.name, list(case.thermal_notes)
            design, states, history = _of_case(case, measure, console)
        tables = {
            state: [*summary.state_rows(design, moved, measure, direction), *summary.zernike_rows(design, moved, terms)]
            for state, moved in states.items()}
        shown: list[Shown | str] = [_shown("drawn surface", summary.design_rows(design))]
        shown += [_shown(state, rows) for state, rows in tables.items()]
        if design.profile:
            shown.append("note: the nodes lie in one plane with the axis: this is a profile against a parabola")
        if design.focal_length_m is None:
            shown.append("note: the nodes do not determine a focal length: the best fit is flat")
        shown += [f"note: {note}" for note in notes]
        if samples is not None and column is not None:
            shown.append(_repeatability(samples, column, share, 2 * design.aperture_m[1] if length is None else length))
    except StatejumpError as refused:
        if isinstance(refused, NotAllowed) and refused.key in OPTIONS:
            refused.key = OPTIONS[refused.key]
        raise
    with results.folder(name, case) as folder:
        path = folder.staged / "surface.csv"
        write_csv(path, ("state", *summary.HEADER), [(state, *row) for state, rows in tables.items() for row in rows])
        written = [path]
        if history:
            written.append(folder.staged / "surface_history.csv")
            write_columns(history, written[-1])
        written = folder.publish(written)
    print_shown(shown, console)
    console.print(f"results: {', '.join(str(path) for path in written)}")


def _of_case(
    case: Case, measure: str, console: Console
) -> tuple[Design, dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return the reflecting surface of a case, the displacements of its nodes at the largest error and at the end of
    the run, and the history of its errors."""
    design, nodes = surface.reflector_of(case)
    with undivided(console, f"{case.name}, reduced model") as on_progress:
        run = require(case, ReducedModel).reduced(case, on_progress)
    history = surface.history(run, measure)
    moves = displacements_m(run, design, nodes)
    worst = int(np.argmax(history["rms_design_m"]))
    return design, {
        f"farthest from the design, at {history['temperature_change_K'][worst]:.4g} K": moves[worst],
        "end of the last cycle" if case.has_jump else "end of the program": moves[-1]}, history


def _shown(title: str, rows: list[tuple[str, str, float]]) -> Shown:
    return Shown(title, ("quantity", "value"), [(quantity, plain(value, unit, 4)) for quantity, unit, value in rows],
                 left=("quantity",))


def _repeatability(samples: Path, column: str, share: float, length_m: float) -> str:
    columns = read_columns(samples)
    lengths = [name for name in columns if unit(name) == "m" and np.issubdtype(columns[name].dtype, np.number)]
    if column not in lengths:
        raise NotAllowed("--column", column, file=samples, **(
            {"code": "not_one_of", "known": ", ".join(lengths)} if lengths else {"code": "no_length_column"}))
    found = repeatability(columns[column], length_m, share)
    size = np.abs(columns[column])
    worst = int(np.nanargmax(size))
    return (f"repeatability of {column}: {found.um_per_m:.4g} µm/m at {100 * share:g} % of {found.samples:,} samples, "
            f"95 % interval {found.low:.4g} to {found.high:.4g} µm/m, over {length_m:.4g} m; "
            f"largest {1e6 * size[worst] / length_m:.4g} µm/m, in sample {worst}")
