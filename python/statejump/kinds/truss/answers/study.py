# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers to the design questions of a truss: jumps, verdict, ranking of joints, surface, sensitivities."""
from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump.core import libraries
from statejump.core.engine_failures import EngineFailed
from statejump.core.errors import ABSENT, NotAllowed, Range, StatejumpError
from statejump.core.later import Later
from statejump.core.notes import Note
from statejump.core.progress import OnProgress
from statejump.core.run import Run
from statejump.core.units import plain
from statejump.kinds.truss.answers import reflector, rows
from statejump.kinds.truss.answers.contributions import Contributions, contributions, turning_joint
from statejump.kinds.truss.answers.jumps import node_jumps, quick_path
from statejump.kinds.truss.answers.outputs import Output, chosen_output
from statejump.kinds.truss.answers.sensitivity import STEP, sensitivities
from statejump.kinds.truss.answers.verdict import RESOLVED, Verdict, judged, others
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.result import reduced_run
from statejump.kinds.truss.solve import TrussPath
from statejump.results.contents import Answers, Scalar
from statejump.schema.rules import NUMBER, WHOLE, Rule

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

_JUMPS = Later("statejump.kinds.truss.answers.figure:jumps_figure")
_RANKING = Later("statejump.kinds.truss.answers.figure:ranking_figure")
_WRITTEN = Later("statejump.kinds.truss.answers.write:write")
NO_JUMP = 1e-9  # fraction of the largest jump of a node below which a jump is rounding
MOST_SAMPLES = 1000  # samples of the path in the result file; at least the ends of every cycle
CYCLES = Rule(WHOLE, allowed=Range(1, 100_000), optional=True)
STEPS = Rule(NUMBER, allowed=Range(1e-6, 0.2))

# Called with the name of the next step; returns a context with the progress function of this step.
Phase = Callable[[str], AbstractContextManager[OnProgress]]


def silent(label: str) -> AbstractContextManager[OnProgress]:
    """Tell nobody."""
    return nullcontext(lambda share: None)


@dataclass(frozen=True)
class TrussAnswers:
    """Answers to the design questions of a truss.

    :param case: the case, with the number of cycles that were run
    :param record: jump, verdict, notes and tables, as stored in the result file
    :param run: the quasi-static path
    :param output: the output whose jump is divided among the joints
    :param checked: the verdict on whether the jump settles over the cycles
    :param shares: contribution of each joint to the jump; None: there is no jump, or no equilibrium without friction
    """

    case: TrussCase
    record: Answers
    run: Run
    output: Output
    checked: Verdict
    shares: Contributions | None

    @property
    def path(self) -> TrussPath:
        """The path of the solver, with the ends of its cycles."""
        found: TrussPath = self.run.native
        return found

    @property
    def jump(self) -> float:
        """Jump of the output over all cycles; ``record.unit`` is its unit."""
        return self.record.summary["jump"].value

    @property
    def verdict(self) -> str:
        """One of ``no jump``, ``one cycle``, ``shakedown``, ``ratcheting``, ``not settled``, ``not resolved``."""
        return self.record.verdict

    @property
    def notes(self) -> list[str]:
        """What limits the answers."""
        return self.record.notes

    @property
    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """Rows of the tables ``cycles``, ``node_jumps``, ``joint_jumps``, ``surface``, ``contributions`` and
        ``sensitivities``, as far as they were requested and exist."""
        return self.record.tables

    def frame(self, table: str) -> pandas.DataFrame:
        """Return a table, with units in its column names. :raises KeyError: it does not exist"""
        return libraries.frame(self.tables[table])

    def plot(self) -> Figure:
        """Draw the truss with its jumps, magnified."""
        return _JUMPS(self.path, self.shares, self.case.title)

    def plot_ranking(self) -> Figure:
        """Draw the ranking of the joints. :raises StatejumpError: the joints could not be ranked"""
        if self.shares is None:
            raise StatejumpError(code="no_ranking", cause="; ".join(self.notes), case=self.case.name)
        return _RANKING(self.shares, self.output, self.case.title)

    def write(self, folder: Path, frames: int = 0, phase: Phase = silent) -> list[Path]:
        """Write result file, tables, figures and ``answers.md``, and return their paths.

        :param folder: an existing folder
        :param frames: number of files for ParaView, evenly spread over the path; 0: no such files
        """
        return _WRITTEN(self, folder, frames, phase)

    def __repr__(self) -> str:
        return f"TrussAnswers({self.case.name}, jump {plain(self.jump, self.record.unit)}, {self.verdict})"


def study(
    case: TrussCase, *, output: str = "node", cycles: int | None = None, each: bool = False, step: float = STEP,
    sensitivity: bool = True, phase: Phase = silent,
) -> TrussAnswers:
    """Answer the design questions of a truss.

    :param output: the output whose jump is divided among the joints: ``node`` (the node that moves most),
        ``node:NAME``, or ``rms`` or ``tilt`` of the reflector
    :param cycles: replaces the number of cycles of the case
    :param each: whether to compute also the sensitivity to every single item
    :param step: relative change of each parameter
    :param sensitivity: whether to compute sensitivities
    :param phase: called with the name of each part
    :raises NotAllowed: the output does not exist, or a number is out of its range
    :raises FailedRun: the solver finds no quasi-static path
    :raises Interrupted: Ctrl-C was pressed
    """
    STEPS.check("step", step)
    case = _of_cycles(case, cycles)
    truss, increments = case.resolve(), case.reduced_settings.increments_per_branch
    with phase("path") as on_progress:
        found = quick_path(truss, increments, on_progress)
    asked = chosen_output(found, output)
    checked, finer = judged(found, increments, lambda more: quick_path(truss, more, cycle_ends_only=True), asked)
    jump, rounding = asked.jump(found), asked.rounding(found)
    if abs(jump) <= rounding:
        jump = 0.0
    tables: dict[str, list[rows.Row]] = {
        "cycles": rows.cycle_rows(found), "node_jumps": rows.node_rows(found), "joint_jumps": rows.joint_rows(found),
    }
    run = reduced_run(case, found, _sample_times(case))
    notes = [*others(found, finer, checked, asked), *_surface(found, tables), *run.warnings]
    change = abs(asked.jump(finer) - jump)
    if change > max(RESOLVED * abs(jump), rounding):
        notes.append(Note("jump_not_resolved", change=change, unit=asked.unit))
    shares = None
    if not _jumps(found, asked, jump):
        notes.append(Note("nothing_ranked"))
    else:
        with phase("contributions of joints") as on_progress:
            shares = _shares(found, asked, on_progress, tables, notes)
        if sensitivity:
            with phase("sensitivities") as on_progress:
                asked_of = sensitivities(found, asked, each=each, step=step, increments=increments,
                                         on_progress=on_progress)
            tables["sensitivities"] = rows.sensitivity_rows(asked_of, jump)
            if any(row.verdict == "not differentiable" for row in asked_of):
                notes.append(Note("jump_has_kink"))
    record = Answers(asked.name, asked.text, asked.unit, checked.word, checked.text, notes,
                     _numbers(found, checked, asked, jump, shares), tables)
    return TrussAnswers(case, record, run, asked, checked, shares)


def answer(case: TrussCase, **settings: Any) -> TrussAnswers:
    """Answer the design questions of a truss that has a state jump; see :func:`statejump.truss.answers`."""
    case.need_jump("'statejump truss answers'")
    return study(case, **settings)


def _of_cycles(case: TrussCase, cycles: int | None) -> TrussCase:
    CYCLES.check("cycles", cycles)
    if cycles is None or cycles == case.thermal.cycles:
        return case
    for program in case.program:
        if program.cycles is not None:
            raise NotAllowed("cycles", ABSENT, code="program_has_own_cycles", program=program.name)
    changed = case.changed({"thermal.cycles": cycles})
    assert isinstance(changed, TrussCase)
    # The answers refer to the given file. The resolved case has the number of cycles that were run.
    changed.with_origin(replace(changed.origin, text=case.origin.text))
    return changed


def _surface(found: TrussPath, tables: dict[str, list[rows.Row]]) -> list[str]:
    """Add the table of the reflecting surface to the answers; return notes on the limits of the fit."""
    surface = reflector.surface(found.truss)
    if surface is not None:
        tables["surface"] = rows.surface_rows(found, surface)
        return [f"reflecting surface: {note}" for note in surface.notes]
    return [] if found.truss.reflector is None else ["reflecting surface: its nodes do not determine a fit"]


def _jumps(found: TrussPath, output: Output, jump: float) -> bool:
    """Return whether the jump of an output exceeds rounding."""
    largest = float(np.linalg.norm(node_jumps(found)[-1], axis=1).max())
    size = float(np.ptp(found.truss.nodes.position_m, axis=0).max())
    return abs(jump) > NO_JUMP * (largest / size if output.unit == "rad" else largest)


def _shares(found: TrussPath, output: Output, on_progress: OnProgress, tables: dict[str, list[rows.Row]],
            notes: list[str]) -> Contributions | None:
    if not found.truss.number_of_joints():
        notes.append("the truss has no joints: none are ranked")
        return None
    turning = turning_joint(found.truss)
    if turning is not None:
        notes.append(Note("joint_turns_nodes", joint=f"{turning[0]} {turning[1]!r}"))
        return None
    try:
        shares = contributions(found, output, on_progress)
    except EngineFailed as failure:
        notes.append(f"no contributions: the truss without friction: {failure.sentence}")
        return None
    notes += shares.notes
    if not shares.contribution.any():
        notes.append("no joint holds the jump by friction: none are ranked")
        return None
    tables["contributions"] = rows.contribution_rows(shares)
    return shares


def _numbers(found: TrussPath, checked: Verdict, output: Output, jump: float,
             shares: Contributions | None) -> dict[str, Scalar]:
    numbers = {
        "jump": Scalar(jump, output.unit), "energy_residue_J": Scalar(found.energy_residue_J, "J"),
        "motion_of_last_cycle": Scalar(float(checked.cycle_jump[-1]), output.unit),
        "uncertainty_of_last_cycle": Scalar(float(checked.uncertainty[-1]), output.unit),
    }
    if shares is not None:
        numbers["sum_of_contributions"] = Scalar(float(shares.contribution.sum()), output.unit)
        numbers["sum_error_relative"] = Scalar(shares.sum_error)
        numbers["jump_from_friction_forces"] = Scalar(shares.reproduced, output.unit)
    return numbers


def _sample_times(case: TrussCase) -> np.ndarray:
    """Return the times [s] of the path that go into the result file."""
    cycles = case.thermal.cycles
    samples = max(1, min(case.samples_per_cycle, MOST_SAMPLES // cycles))
    return np.linspace(0, case.period_s * cycles, samples * cycles + 1)
