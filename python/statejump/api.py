# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions of the public interface: ``import statejump as sj`` provides them as ``sj.load`` and so on."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from statejump.core.case import Case, Progress
from statejump.control.capabilities import JointStatics, RestSets
from statejump.core.comparison import FIRST, SECOND, Comparison, of_two
from statejump.core.errors import StatejumpError
from statejump.core.later import Later
from statejump.core.run import Run
from statejump.kinds import require
from statejump.kinds.loading import load_case
from statejump.kinds.protocol import ModelComparison, RunDifference

if TYPE_CHECKING:
    from statejump.bores import Bore
    from statejump.identification import Identification
    from statejump.campaign import Campaign
    from statejump.results.contents import Result

_BORE, _IDENTIFIED = Later("statejump.bores:measured"), Later("statejump.identification:identified")
_SWEEP, _MONTECARLO = Later("statejump.campaign:sweep"), Later("statejump.campaign:montecarlo")
_READ = Later("statejump.results.read:read")


def load(source: str | Path | Mapping[str, Any]) -> Case:
    """Return a checked case.

    :param source: path of a case file; name of a shipped case, for example ``table1``; or sections and keys as a dict
    :raises StatejumpError: the file does not exist, or the case is invalid; the message has file, key, value and range
    """
    return load_case(source)


def compare(first: Run, second: Run) -> Comparison:
    """Compare two runs of a case with the tolerances of the case.

    :param first: a run of the reduced model or of the DEM
    :param second: a run of the other model, or of the same model
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


def read(path: str | Path) -> Result:
    """Return the content of a result file (HDF5): runs by model, comparison, case, scene and provenance.

    :raises StatejumpError: the file does not exist, is no result file, has a newer layout, or is damaged
    """
    found: Result = _READ(path)
    return found


def statics(case: Case, friction_coefficient: float | None = None) -> RestSets:
    """Return the rest positions of a loaded joint, for a ``statics`` case or the block of a ``spring_slider`` case.

    :param friction_coefficient: replaces that of the case
    :raises StatejumpError: the kind has no rest positions, or its mesh is unusable
    """
    return require(case, JointStatics).statics(case, friction_coefficient)


def bore(
    path: str | Path, *, unit_m: float = 1.0, journal_radius_m: float | None = None, flip: bool = False
) -> Bore:
    """Measure a bore: roundness, lobes, clearance to a journal.

    :param path: OFF, STL, PLY or OBJ file of its wall
    :param unit_m: length of one unit of the file [m]: 0.001 for millimetres
    :param journal_radius_m: radius of the journal in the bore [m]
    :param flip: reverse every face, for a file whose normals point into the material
    :raises StatejumpError: the file is not a bore; the message has reason and position
    """
    found: Bore = _BORE(Path(path), unit_m=unit_m, journal_radius_m=journal_radius_m, flip=flip)
    return found


def identify(
    source: str | Path | Mapping[str, Any], *, model: str | Sequence[str] = "auto", start: str = "unknown",
    confidence: float = 0.95, target: str | None = None, normal_force_N: float | None = None,
    journal_radius_m: float | None = None, ignored: Sequence[str] = (),
) -> Identification:
    """Identify a joint from a measured loop.

    Least squares find the parameters; noise of the force may be correlated. Profile likelihood gives the intervals, and
    BIC selects the joint. Notes list the parameters that the loop does not determine.

    :param source: a table, or columns: ``displacement_m`` and ``force_N``, or ``rotation_rad`` and ``moment_N_m``, or
        the same in other units, row by row as measured. The force is positive if it resists a positive displacement
    :param model: a joint, several, or ``auto``: all of :data:`statejump.identification.models.MODELS`
    :param start: friction before the first row: ``fresh``: zero; ``cycled``: the path was traversed before;
        ``unknown``: it is a parameter
    :param confidence: confidence level of the intervals, 0.5 to 0.999
    :param target: item of a case for the joint: ``spring_slider`` (default), ``slider``, ``revolute``, ``umbrella``
        (default of rotations), ``torsion_spring``, ``iwan_joint``
    :param normal_force_N: normal force in the test [N]; converts friction to a coefficient
    :param journal_radius_m: radius of the journal [m]; converts a moment of friction to a coefficient
    :param ignored: names of columns of a table that are not used
    :raises StatejumpError: the file is not a loop, or the joint is unknown
    """
    found: Identification = _IDENTIFIED(
        source, model=model, start=start, confidence=confidence, target=target, normal_force_N=normal_force_N,
        journal_radius_m=journal_radius_m, ignored=ignored)
    return found


def sweep(
    case: Case, values: Mapping[str, float | Sequence[float] | Mapping[str, Any]], *, model: str = "reduced",
    workers: int | None = None, progress: Progress = False, outputs: Sequence[str] = (),
) -> Campaign:
    """Run a case on a grid of its parameters.

    :param values: values by key. Keys are ``section.key``, ``section.item.key`` of one item of a list, or
        ``section.*.key`` or ``section.joint*.key`` of all matching items. A value is a list, or the fields of a
        ``[[vary]]`` table: ``{"start": 0.1, "stop": 1, "count": 10, "spacing": "log"}``
    :param model: ``reduced`` or ``dem``
    :param workers: number of processes; None: one for each core, or no separate process if the grid is small
    :param outputs: further outputs to record of every run, for example ``jump:displacement_m[P].x``: end, jump, max,
        min or range of any column of a run at one item; see :mod:`statejump.campaign.outputs`
    :raises StatejumpError: a key is unknown, or the kind has no outcomes
    """
    found: Campaign = _SWEEP(case, values, model=model, workers=workers, progress=progress, outputs=outputs)
    return found


def montecarlo(
    case: Case, distributions: Mapping[str, Mapping[str, Any]], *, samples: int = 1000, seed: int = 1,
    model: str = "reduced", workers: int | None = None, progress: Progress = False, outputs: Sequence[str] = (),
) -> Campaign:
    """Run a case with random parameters.

    :param distributions: for each key the fields of a ``[[vary]]`` table, for example ``{"distribution": "normal",
        "relative": 0.1}``
    :param samples: number of samples
    :param seed: seed of the random numbers; the same seed gives the same samples
    :param model: ``reduced`` or ``dem``
    :param workers: as for :func:`sweep`
    :param outputs: as for :func:`sweep`
    :raises StatejumpError: a key or distribution is unknown
    """
    found: Campaign = _MONTECARLO(case, distributions, samples=samples, seed=seed, model=model, workers=workers,
                                  progress=progress, outputs=outputs)
    return found
