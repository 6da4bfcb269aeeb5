# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions of the public interface: ``import statejump as sj`` provides them as ``sj.load`` and so on."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from statejump.core.case import Case, Progress
from statejump.control.capabilities import JointStatics, RestSets, VibrationModes, WorstCases
from statejump.core.comparison import FIRST, SECOND, Comparison, of_two
from statejump.core.errors import StatejumpError
from statejump.core.progress import shown
from statejump.core.run import Run
from statejump.kinds import require
from statejump.kinds.loading import load_case
from statejump.kinds.protocol import ModelComparison, RunDifference


def load(source: str | Path | Mapping[str, Any]) -> Case:
    """Return a checked case.

    :param source: path of a case file; name of a shipped case, for example ``table1``; or sections and keys as a dict
    :raises StatejumpError: the file does not exist, or the case is invalid; the message has file, key, value and range
    """
    return load_case(source)


def compare(first: Run, second: Run) -> Comparison:
    """Compare two runs of a case with the tolerances of the case.

    :param first: a run of the reduced model or of the DEM
    :param second: a run of the other model, or another run of the same model
    :raises StatejumpError: the runs belong to different cases, or one of them is incomplete
    """
    if first.definition != second.definition:
        names = f"{first.definition.name}, {second.definition.name}"
        raise StatejumpError(code="runs_of_other_cases", cases=names)
    for run in (first, second):
        if not run.complete:
            raise StatejumpError(code="run_not_complete")
    case = first.definition
    if first.model != second.model:
        by_model = {run.model: run for run in (first, second)}
        return require(case, ModelComparison).compare(case, by_model["reduced"], by_model["dem"])
    rows = require(case, RunDifference).difference(case, first, second.at(first.time_s))
    return Comparison(case, {FIRST: first, SECOND: second}, tuple(of_two(rows)))


def modes(case: Case, count: int = 6) -> Any:
    """Return the natural frequencies and mode shapes of a truss, every joint held.

    :param count: number of modes, from the lowest
    :return: :class:`statejump.kinds.truss.modes.Modes`
    :raises StatejumpError: this kind of case has no modes, or nothing of the case has a mass
    """
    return require(case, VibrationModes).modes(case, count)


def statics(case: Case, friction_coefficient: float | None = None) -> RestSets:
    """Return the rest positions of a loaded joint: a ``statics`` case, or the block of a ``spring_slider`` case.

    :param friction_coefficient: replaces the friction coefficient of the case
    :raises StatejumpError: this kind of case has no rest positions, or the mesh of the case is unusable
    """
    return require(case, JointStatics).statics(case, friction_coefficient)


def worst(case: Case, range_K: str | tuple[float, float], *, output: Sequence[str] = (), groups: Sequence[str] = (),
          cycles: int = 3, paths: int = 300, seed: int = 0, progress: Progress = False) -> Any:
    """Search for the temperature histories with the largest state jump and the largest excursion of a truss.

    :param range_K: lowest and highest ΔT [K] of every member
    :param output: as for bounds, for example ``node:NAME.x``; default: the displacement that may differ most
    :param groups: patterns of names, separated by commas; members of a group have one common temperature
    :param cycles: largest number of cycles of a history
    :param paths: number of paths for each quantity of each output
    :param seed: of the random histories
    :param progress: True: show it on standard error; or a function that receives the finished fraction, 0 to 1
    :return: :class:`statejump.kinds.truss.worst.study.WorstHistories`
    :raises StatejumpError: this kind of case has no such search, an argument is invalid, or no history has a path
    """
    kind = require(case, WorstCases)
    with shown(progress, "worst histories") as on_progress:
        return kind.worst(case, range_K, output=output, groups=groups, cycles=cycles, paths=paths, seed=seed,
                          on_progress=on_progress)
