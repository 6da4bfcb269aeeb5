# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump body``: condensed bodies of finite-element models."""
from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import click

from statejump import body as bodies
from statejump.bodies.body import CondensedBody
from statejump.bodies.figure import drawn
from statejump.bodies.page import write as write_page
from statejump.cli.suggesting import Suggesting
from statejump.cli.terminal import QUIET, RESULTS, make_console, print_shown, undivided
from statejump.cli.truss_import import units_of
from statejump.core.errors import NotAllowed, StatejumpError, TolerancesMissed
from statejump.core.figures import save
from statejump.core.output import check_suffix, check_target
from statejump.core.results_folder import Results

Command = TypeVar("Command", bound=Callable[..., Any])
SUFFIXES = (".h5", ".hdf5")
# Options of the commands by argument of the library, for messages.
OPTIONS = {"stiffness": "--stiffness", "mass": "--mass", "load": "--load", "interface": "--interface",
           "pattern": "--pattern", "modes": "--modes"}


@click.group("body", cls=Suggesting)
def body_command() -> None:
    """Condensed bodies: linear structures of a finite-element model between the joints.

    \b
    Examples:
      statejump body condense panel.inp -o panel.h5 --interface HINGE_1 --interface HINGE_2 --pattern uniform
      statejump body import wing.op4 wing.pch -o wing.h5
      statejump body check panel.h5
    """


def _output(command: Command) -> Command:
    for option in (
        click.option("--force", is_flag=True, help="Overwrite the file."),
        click.option("--reference-temperature", type=float, metavar="KELVIN",
                     help="Temperature at which the body has its shape."),
        click.option("--force-unit", type=click.FloatRange(min=0, min_open=True), metavar="NEWTON",
                     help="Force of one unit of the files, in place of --units."),
        click.option("--length-unit", type=click.FloatRange(min=0, min_open=True), metavar="METRES",
                     help="Length of one unit of the files, in place of --units."),
        click.option("--units", type=click.Choice(["SI", "mm-N", "mm-kN-t", "mm-kg-s", "in-lbf"]),
                     help="Units of the files.  [default: SI]"),
        click.option("-o", "--output", required=True, metavar="BODY", type=click.Path(path_type=Path),
                     help="File of the body (.h5)."),
    ):
        command = option(command)
    return command


def _check_output(output: Path, force: bool) -> None:
    check_suffix("--output", output, *SUFFIXES)
    if os.path.exists(output) and not force:
        raise StatejumpError(code="exists_already", file=output)
    check_target(output)


def _written(body: CondensedBody, output: Path, quiet: bool) -> None:
    """Write a body, and print its checks."""
    bodies.write(output, body)
    console = make_console(quiet)
    print_shown(bodies.check(body).tables(), console)
    for note in body.notes:
        console.print(f"warning: {note}")
    console.print(f"{output}: nodes {len(body.node_names)}, dofs {body.interface_dofs}, modes {body.modes}, patterns "
                  f"{len(body.pattern_names)}")


def _renamed(refused: NotAllowed) -> NotAllowed:
    refused.key = OPTIONS.get(refused.key or "", refused.key)
    return refused


@body_command.command("check")
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
@RESULTS
@QUIET
def check_command(file: Path, results: Results, quiet: bool) -> None:
    """Checks of the body in FILE: rigid motions, mass, frequencies, free thermal expansion.

    Writes a page with pictures of free thermal shapes and modes. Exit status 1 if a bound is missed.

    \b
    Example:
      statejump body check panel.h5
    """
    console = make_console(quiet)
    checked = bodies.check(bodies.read(file))
    with results.folder(f"body_{file.stem}") as folder:
        written = folder.publish(write_page(checked, folder.staged, file.name))
    print_shown(checked.tables(), console)
    for note in checked.body.notes:
        console.print(f"warning: {note}")
    console.print(f"results: {', '.join(str(path) for path in written)}")
    if not checked.passed:
        raise TolerancesMissed([row.name for row in checked.rows if not row.passed], file=file)


@body_command.command("plot")
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
@RESULTS
@QUIET
def plot_command(file: Path, results: Results, quiet: bool) -> None:
    """Picture of the body in FILE, its free thermal shapes and modes.

    \b
    Example:
      statejump body plot panel.h5
    """
    body = bodies.read(file)
    with results.folder(f"body_{file.stem}") as folder:
        written = folder.publish(save(drawn(body), folder.staged, "body"))
    make_console(quiet).print(f"results: {', '.join(str(path) for path in written)}")


@body_command.command("import")
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--stiffness", metavar="NAME", help="Matrix that is the stiffness.  [default: KAAX, KAA, KXX ...]")
@click.option("--mass", metavar="NAME", help="Matrix that is the mass.  [default: MAAX, MAA, MXX ...]")
@click.option("--load", metavar="NAME", help="Matrix of thermal loads, a column for each --pattern.")
@click.option("--pattern", "patterns", multiple=True, metavar="NAME", help="Name of a column of --load.")
@click.option("--cd", "systems", multiple=True, metavar="NODE=SYSTEM",
              help="Displacement coordinate system of a node, in place of field 7 of its GRID card.")
@_output
@QUIET
def import_command(
    files: Sequence[Path], stiffness: str | None, mass: str | None, load: str | None, patterns: Sequence[str],
    systems: Sequence[str], output: Path, units: str | None, length_unit: float | None, force_unit: float | None,
    reference_temperature: float | None, force: bool, quiet: bool,
) -> None:
    """A body from reduced matrices of Nastran (.op4, .pch with DMIG) or Abaqus (.mtx).

    Give the files of one run together: .op4 with .pch or .asm, .mtx with the deck (.inp) or a table of nodes
    (name,x_m,y_m,z_m).

    \b
    Examples:
      statejump body import wing.op4 wing.pch -o wing.h5
      statejump body import panel_STIF1.mtx panel.inp -o panel.h5 --units mm-N
    """
    _check_output(output, force)
    try:
        body = bodies.import_body(
            list(files), stiffness=stiffness, mass=mass, load=load, pattern_names=list(patterns),
            units=units_of(units, length_unit, force_unit), reference_temperature_K=reference_temperature,
            systems=dict(_pair("--cd", text) for text in systems))
    except NotAllowed as refused:
        raise _renamed(refused) from None
    _written(body, output, quiet)


def _pair(option: str, text: str) -> tuple[int, int]:
    node, _, system = text.partition("=")
    if not (node.isdecimal() and system.isdecimal()):
        raise NotAllowed(option, text, code="body_pair")
    return int(node), int(system)


def _place(text: str) -> tuple[str, list[float]]:
    name, _, place = text.partition("=")
    try:
        values = [float(word) for word in place.split(",")]
    except ValueError:
        values = []
    if len(values) != 3:
        raise NotAllowed("--at", text, code="body_place")
    return name, values


@body_command.command("condense")
@click.argument("deck", metavar="DECK.inp", type=click.Path(path_type=Path))
@click.option("--interface", "interfaces", multiple=True, required=True, metavar="NSET[=KIND]",
              help="Set of nodes that becomes an interface node: mean (default), expanding, rigid or node.")
@click.option("--pattern", "patterns", multiple=True, metavar="NAME[=WHAT]",
              help="Temperature pattern: uniform, x, y, z, thickness, set:NSET, step:N, FILE.csv.  [default: uniform]")
@click.option("--modes", type=click.IntRange(min=0), default=0, show_default=True,
              help="Fixed-interface modes, for motion.")
@click.option("--points", metavar="NSET", help="Nodes whose displacements are recovered.")
@click.option("--at", "places", multiple=True, metavar="NSET=X,Y,Z",
              help="Position of an interface node, in units of the deck.  [default: the centre of its patch]")
@_output
@QUIET
def condense_command(
    deck: Path, interfaces: Sequence[str], patterns: Sequence[str], modes: int, points: str | None,
    places: Sequence[str], output: Path, units: str | None, length_unit: float | None, force_unit: float | None,
    reference_temperature: float | None, force: bool, quiet: bool,
) -> None:
    """A body from the deck of CalculiX DECK.inp, of solids and shells. Runs ccx.

    Supports, loads and steps of the deck are left out. A rigid patch does not expand, which bends the body; take it
    only if the part behind it does not expand either.

    \b
    Example:
      statejump body condense panel.inp -o panel.h5 --interface HINGE_1 --interface HINGE_2 --pattern uniform \\
        --pattern bow=thickness --points SURFACE --modes 12
    """
    _check_output(output, force)
    console = make_console(quiet)
    try:
        with undivided(console, deck.name) as on_progress:
            body = bodies.condense(
                deck, list(interfaces), list(patterns) or ["uniform"], modes=modes, points=points,
                at=dict(_place(text) for text in places), units=units_of(units, length_unit, force_unit),
                reference_temperature_K=reference_temperature, on_progress=on_progress)
    except NotAllowed as refused:
        raise _renamed(refused) from None
    _written(body, output, quiet)
