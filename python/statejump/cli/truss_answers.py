# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump truss answers``: jumps, verdict, ranking of joints, surface, energy, sensitivities."""
from __future__ import annotations

import re
from contextlib import AbstractContextManager
from pathlib import Path

import click

from statejump.cli.terminal import CASE, QUIET, RESULTS, loaded, make_console, progress
from statejump.control.capabilities import DesignAnswers
from statejump.core.errors import Interrupted, NotAllowed, Range
from statejump.core.results_folder import Results
from statejump.core.progress import OnProgress
from statejump.core.units import plain
from statejump.kinds import require
from statejump.schema.rules import WHOLE, Rule

FRAMES = Rule(WHOLE, allowed=Range(0, 1_000_000))
# Options by the parameter that they set.
OPTIONS = {name: f"--{name}" for name in ("output", "cycles", "step", "frames")}


def folder_of(case: str, output: str) -> str:
    """Return the subfolder for answers on an output. A selected output has its own, so that other answers are kept."""
    return case if output == "node" else f"{case}/answers_{re.sub(r'[^A-Za-z0-9_.-]', '_', output)}"


@click.command("answers")
@CASE
@click.option("--output", default="node", show_default=True, metavar="NAME",
              help="What is judged and traced to the joints: node (the most moved one), node:NAME, rms or tilt of the "
                   "reflector. The answers about another than the default get a folder of their own.")
@click.option("--cycles", type=int, metavar="N", help="Cycles instead of the case's.")
@click.option("--each", is_flag=True, help="Sensitivities to every single item, not only to all of a kind together.")
@click.option("--step", type=float, default=0.01, show_default=True, help="Of the sensitivities, relative.")
@click.option("--no-sensitivity", "skip_sensitivity", is_flag=True, help="Leave sensitivities out.")
@click.option("--frames", type=int, default=0, show_default=True, help="Write that many .vtu files for ParaView.")
@RESULTS
@QUIET
def answers_command(
    case_file: Path, output: str, cycles: int | None, each: bool, step: float, skip_sensitivity: bool, frames: int,
    results: Results, quiet: bool,
) -> None:
    """What a designer asks of CASE: jumps, whether they settle, which joints hold them, what they follow.

    \b
    Examples:
      statejump truss answers cases/trusses/ring_12.toml
      statejump truss answers cases/trusses/mast_6.toml --cycles 5 --output node:R6 --each
    """
    console = make_console(quiet)
    case = loaded(case_file, DesignAnswers)

    def phase(label: str) -> AbstractContextManager[OnProgress]:
        return progress(console, f"{case.name}, {label}")

    try:
        with results.folder(folder_of(case.name, output), case) as folder:
            FRAMES.check("frames", frames)
            found = require(case, DesignAnswers).answers(
                case, output=output, cycles=cycles, each=each, step=step, sensitivity=not skip_sensitivity, phase=phase,
            )
            written = folder.publish(found.write(folder.staged, frames, phase))
    except NotAllowed as refused:
        refused.key = OPTIONS.get(refused.key or "", refused.key)
        raise
    except KeyboardInterrupt:
        raise Interrupted() from None
    console.print(f"{found.record.text}: jump {plain(found.jump, found.record.unit)}")
    console.print(found.record.verdict_text)
    for note in found.notes:
        console.print(f"note: {note}")
    console.print(f"results: {', '.join(str(path) for path in written)}")
