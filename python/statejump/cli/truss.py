# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump truss``: make case files of trusses with generators, and draw trusses."""
from __future__ import annotations

import inspect
import os
import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from statejump.cli.suggesting import Suggesting
from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, print_shown, progress
from statejump.cli.truss_answers import answers_command
from statejump.cli.truss_import import TABLES, import_command, new_files
from statejump.cli.truss_surface import surface_command
from statejump.control.capabilities import Creaking
from statejump.core.case import Case
from statejump.core.errors import NotWritten, located
from statejump.core.results_folder import Results
from statejump.core.thermal import SHAPES
from statejump.core.units import split_unit
from statejump.kinds import require
from statejump.kinds.truss.generate.document import write
from statejump.kinds.truss.joints.revolute import Revolute
from statejump.kinds.truss.sections import TrussReduced
from statejump.report.capabilities import CaseDrawing
from statejump.schema.fields import fields_of, rule_of
from statejump.schema.json_schema import head_line
from statejump.schema.rules import folder_name
from statejump.truss import LARGEST, LEAST, MAKERS

# Keys that take one of several names.
_NAMES = {
    "shape": [name for name in SHAPES if name != "table"],
    "contact": list(rule_of(fields_of(Revolute)["contact"]).names),
    "sticking": list(rule_of(fields_of(TrussReduced)["sticking"]).names),
}


@click.group("truss", cls=Suggesting)
def truss_command() -> None:
    """Trusses of many joints: make case files of a size N, draw them, answer a designer's questions.

    \b
    Example:
      statejump truss ring 12 -o ring_12.toml
    """


def _shown(key: str) -> str:
    """Return the command option for a key. Its name omits the unit, which the help text contains."""
    return "--" + split_unit(key)[0].replace("_", "-")


def _summary(function: Callable[..., Case]) -> tuple[str, dict[str, str]]:
    """Return the docstring of a generator without its parameters, and the texts of the parameters."""
    text = inspect.getdoc(function) or ""
    described = dict(re.findall(r"^:param (\w+): (.*)$", text, re.MULTILINE))
    return text.split(":param", 1)[0].strip(), described


def _help(function: Callable[..., Case], kind: str) -> str:
    text, _ = _summary(function)
    blocks = ["\b\n" + block if block.startswith("    ") else block.replace("::", ":")
              for block in re.split(r"\n\n(?! )|\n\n(?=    )", text)]
    return "\n\n".join([*blocks, f"\b\nExample:\n  statejump truss {kind} {max(LEAST[kind], 6)} -o {kind}.toml"])


def _generator_command(kind: str, function: Callable[..., Case]) -> click.Command:
    """Return the command that writes the truss of a generator. Its options are the parameters of the function."""
    keys = {key: parameter.default for key, parameter in inspect.signature(function).parameters.items()
            if key not in ("n", "name")}
    _, described = _summary(function)

    def make(n: int, output: Path, tables: bool, force: bool, quiet: bool, **values: Any) -> None:
        console = make_console(quiet)
        beside = new_files(output, tables, force)
        if not os.path.isdir(output.parent):
            raise NotWritten(code="output_folder_missing", file=output, folder=output.parent)
        with located(file=output):
            case = function(n, name=folder_name(output.stem), **values)
        given = [
            _shown(key) + (f" {value}" if not isinstance(value, bool) else "") if value is not False
            else "--no-" + _shown(key)[2:]
            for key, value in values.items() if value != keys[key]
        ]
        line = " ".join(["statejump truss", kind, str(n), *given, *["--tables"] * tables, "-o",
                         shlex.quote(output.name)])
        write(case.origin.data, output,
              [head_line(case.kind, output), f"# Made by: {line}", "# Units are in the names."], beside)
        joints = len(case.slider) + len(case.revolute)
        console.print(f"{output}: nodes {len(case.node)}, links {len(case.link)}, joints {joints}")

    command = click.Command(kind, callback=make, help=_help(function, kind))
    command.params = [
        click.Argument(["n"], metavar="N", type=click.IntRange(LEAST[kind], LARGEST)),
        click.Option(["-o", "--output", "output"], required=True, metavar="FILE", type=click.Path(path_type=Path),
                     help="Case file to write; its name is that of the case."),
        click.Option(["--tables"], **TABLES),
        click.Option(["--force"], is_flag=True, help="Overwrite the file."),
    ]
    for key, default in keys.items():
        help_text = described[key][0].upper() + described[key][1:] + "."
        if isinstance(default, bool):
            option = click.Option([f"{_shown(key)}/--no-{_shown(key)[2:]}", key], default=default, help=help_text)
        else:
            kind_of = click.Choice(_NAMES[key]) if key in _NAMES else type(default)
            option = click.Option([_shown(key), key], default=default, type=kind_of, help=help_text, show_default=True)
        command.params.append(option)
    return QUIET(command)


for _kind, _function in MAKERS.items():
    truss_command.add_command(_generator_command(_kind, _function))


@truss_command.command("draw")
@CASE
@click.option("--names", is_flag=True, help="Name all nodes; without it those of a truss of at most 24 places.")
@RESULTS
@QUIET
def draw_command(case_file: Path, names: bool, results: Results, quiet: bool) -> None:
    """Draw CASE: nodes, links by temperature, supports, joints, springs, loads.

    \b
    Example:
      statejump truss draw cases/trusses/ring_12.toml
    """
    from statejump.core.figures import save  # imports matplotlib (0.4 s), which other commands do not need

    console = make_console(quiet)
    case = loaded(case_file, CaseDrawing)
    with results.folder(case.name, case) as folder:
        drawn = require(case, CaseDrawing).draw(case, names=names)
        written = folder.publish(save(drawn, folder.staged, f"{case.name}_truss"))
    console.print(f"drawing: {', '.join(str(path) for path in written)}")


@truss_command.command("creak")
@CASE
@click.option("--node", required=True, metavar="NAME", help="Whose acceleration is asked for.")
@RESULTS
@QUIET
def creak_command(case_file: Path, node: str, results: Results, quiet: bool) -> None:
    """CASE in motion: which joints slip when and with how much heat, and what a node feels of it: acceleration,
    spectrum, peak and RMS in octaves.

    \b
    Example:
      statejump truss creak cases/trusses/chain_10.toml --node N10
    """
    console = make_console(quiet)
    case = loaded(case_file, Creaking)
    with results.folder(f"{case.name}_creak", case) as folder:
        with progress(console, "motion") as on_progress:
            found = require(case, Creaking).creak(case, node, on_progress)
        written = folder.publish(found.write(folder.staged))
    print_shown(found.summary_lines(), console)
    console.print(f"results: {', '.join(str(path) for path in written)}")


truss_command.add_command(import_command)
truss_command.add_command(answers_command)
truss_command.add_command(surface_command)
