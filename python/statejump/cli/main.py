# SPDX-License-Identifier: GPL-3.0-or-later
"""The ``statejump`` command: its subcommands, and the report of their failures. The module of a subcommand is imported
only when the subcommand is called. docs/reference/mistakes.md lists the exit statuses."""
from __future__ import annotations

import os
import signal
import sys
import traceback
import warnings
from collections.abc import Sequence
from importlib import import_module
from itertools import takewhile
from typing import Any, TextIO

import click

from statejump._version import __version__
from statejump.cli import streams, studies
from statejump.cli.suggesting import Suggesting
from statejump.core import errors
from statejump.core.errors import Interrupted, StatejumpError, TolerancesMissed, printable

JSON = "--json"

# Commands by task: module and function of each command, and its text in ``--help``.
TASKS: dict[str, dict[str, tuple[str, str]]] = {
    "One case": {
        "reduced": ("models:reduced_command", "Reduced model of CASE: events, state jump, history."),
        "dem": ("models:dem_command", "DEM run of CASE in YADE: history."),
        "compare": ("models:compare_command",
                    "Both models of CASE side by side, or two result files of the same case."),
        "control": ("control:control_command", "What makes the state jump of CASE smaller, and by how much."),
        "design": ("design:design_command", "Variables of least cost with which CASE meets requirements."),
        "bounds": ("bounds:bounds_command", "How far CASE can come back, whatever the temperature history."),
        "worst": ("worst:worst_command", "Temperature histories with the largest state jump and peak of a truss."),
        "modes": ("modes:modes_command", "Natural frequencies and mode shapes of a truss."),
        "statics": ("statics:statics_command", "Where the joint of CASE can rest, and the largest jump it can make."),
    },
    "Joints, contacts and temperatures": {
        "identify": ("identify:identify_command", "Clearance, stiffness, friction of a joint from a measured loop."),
        "bore": ("bore:bore_command", "What a measured bore is: roundness, lobes, clearance."),
        "laws": ("laws:laws_command", "Catalogue of contact laws, and their curves for the joint of CASE."),
        "orbit": ("orbit:orbit_command",
                  "Temperatures of members over an orbit with shadow, as a file that cases take."),
        "fclib": ("fclib:fclib_command", "Frictional contact problems of many contacts, in files of FCLIB."),
    },
    "Trusses and antennas": {
        "truss": ("truss:truss_command", "Trusses: make, draw, and what a designer asks of them."),
        "body": ("body:body_command", "Condensed bodies of finite-element models: make, import, check, draw."),
    },
    "Many cases": {
        "montecarlo": ("campaign:montecarlo_command", "Many samples of a case whose parameters are random."),
        "rare": ("rare:rare_command", "Small probability that an outcome is beyond a limit."),
        "sweep": ("campaign:sweep_command", "A case on a grid of its parameters."),
    },
    "Results and files": {
        "report": ("report:report_command", "One HTML page of a run, or of many."),
        "info": ("results:info_command", "What is in a result file."),
        "export": ("results:export_command", "CSV tables and ParaView files of a result file."),
        "schema": ("schema:schema_command", "JSON Schema of case and campaign files."),
    },
}
PAPER = "studies.paper.commands"
if studies.PRESENT:
    TASKS["One case"]["fe"] = (
        "studies.calculix.commands:fe_command", "CASE in finite elements (CalculiX) beside the reduced model.")
    TASKS["The paper"] = {
        "figures": (f"{PAPER}:figures_command", "The paper's Figs 13-16 in both models, and its claims in numbers."),
        "slow": (f"{PAPER}:slow_command", "Slow heating tends to the quasi-static path."),
        "hold": (f"{PAPER}:hold_command", "Friction that creeps and friction that holds."),
        "convergence": (f"{PAPER}:convergence_command",
                        "DEM error of CASE against cycle duration and time step."),
        "energy": (f"{PAPER}:energy_command", "Energy account of CASE over time steps."),
    }
COMMANDS = {name: found for commands in TASKS.values() for name, found in commands.items()}


class Commands(Suggesting):
    """A group of commands that imports the module of a command only when the command is called."""

    def list_commands(self, context: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        module, _, attribute = COMMANDS[name][0].partition(":")
        of_study = module.startswith(studies.FOLDER)
        loaded = studies.module(module) if of_study else import_module(f"statejump.cli.{module}")
        found: click.Command = getattr(loaded, attribute)
        return found

    def format_commands(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        for task, commands in TASKS.items():
            with formatter.section(task):
                formatter.write_dl([(name, text) for name, (_, text) in commands.items()])


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="statejump")
@click.option(JSON, is_flag=True, expose_value=False, help="Failures as one line of JSON on standard error.")
def cli() -> None:
    """State jump of deployable structures: an exact reduced model and a DEM model in YADE.

    \b
    Example:
      statejump compare cases/table1.toml
    """


def _report_failure(error: BaseException, as_json: bool) -> int:
    """Report on standard error why the command ended; return the exit status."""
    if isinstance(error, StatejumpError):
        failure = error.fields()
    elif isinstance(error, click.ClickException):
        failure = errors.fields("usage", error.format_message(), 2)
    elif isinstance(error, (click.exceptions.Abort, KeyboardInterrupt)):
        failure = errors.fields("interrupted", "interrupted", Interrupted.exit_status)
    else:  # internal error: status 1 would mean that a tolerance is missed
        failure = errors.fields(
            "internal", f"a fault of statejump itself: {type(error).__name__}: {error}", errors.INTERNAL_STATUS,
            remedy="run the command without --json for the traceback",
        )
        if not as_json:
            traceback.print_exception(error)
    if as_json:
        click.echo(errors.to_json(failure), err=True)
    else:
        is_error = failure["kind"] not in (TolerancesMissed.kind, Interrupted.kind)
        click.echo(printable(("error: " if is_error else "") + failure["message"]), err=True)
    status: int = failure["exit_status"]
    return status


def _wants_json(arguments: Sequence[str]) -> bool:
    return JSON in takewhile(lambda word: word.startswith("-"), arguments)


def run(arguments: Sequence[str]) -> int:
    """Run the command with these arguments and return its exit status; failures are reported on standard error."""
    as_json = _wants_json(arguments)
    try:
        try:
            os.getcwd()
        except FileNotFoundError:
            raise StatejumpError(code="working_folder_gone") from None
        # Figures are files: ignore an interactive backend from the environment, here and in YADE.
        os.environ["MPLBACKEND"] = "agg"
        cli.main(list(arguments), standalone_mode=False)
    except click.exceptions.Exit as end:
        return int(end.exit_code)
    except (Exception, KeyboardInterrupt) as error:
        return _report_failure(error, as_json)
    return 0


def _ended(number: int, frame: Any) -> None:
    sys.exit(128 + number)


# On these signals (kill, closed terminal) the command ends YADE and cleans up as on Ctrl-C.
ENDING = (signal.SIGTERM, signal.SIGHUP)


_WARNED: set[str] = set()  # what was printed


def _warned(message: Warning | str, category: type[Warning], filename: str, lineno: int, file: TextIO | None = None,
            line: str | None = None) -> None:
    """Report a warning of a library once, in the format of the command and without the line of code."""
    text = printable(str(message))
    if text not in _WARNED:  # a file may be read twice
        _WARNED.add(text)
        print(f"warning: {text}", file=sys.stderr)


def main() -> None:
    """Entry point of the launcher."""
    streams.install()
    warnings.showwarning = _warned
    for number in ENDING:
        if signal.getsignal(number) is not signal.SIG_IGN:  # as of nohup
            signal.signal(number, _ended)
    arguments = sys.argv[1:]
    try:
        # The launcher blocks these signals until the handlers are installed.
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT, *ENDING})
        status = run(arguments)
    except KeyboardInterrupt as early:
        status = _report_failure(early, _wants_json(arguments))
    lost = streams.finish()
    if lost is not None:
        lost_status = _report_failure(lost, _wants_json(arguments))
        status = status or lost_status
    sys.exit(status)
