# SPDX-License-Identifier: GPL-3.0-or-later
"""The functions of the public interface: ``import statejump as sj`` has them as ``sj.load`` and so on."""
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
    """Return a case, checked as a whole.

    :param source: path of a case file; name of a case that comes with the program, as ``table1``; or sections and
        keys as a dict
    :raises StatejumpError: there is no such file, or the case is not allowed: file, key, value, range
    """
    return load_case(source)


def compare(first: Run, second: Run) -> Comparison:
    """Return two runs of a case beside each other, against the tolerances of the case.

    :param first: a run of the reduced model and
    :param second: one of the DEM, in either order; or two runs of one model
    :raises StatejumpError: they are not of the same case, or one of them is not complete
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
    """Return what a result file (HDF5) holds: its runs by model, its comparison, case, scene and provenance.

    :raises StatejumpError: no such file, not ours, of a newer layout, cut off or damaged
    """
    found: Result = _READ(path)
    return found


def statics(case: Case, friction_coefficient: float | None = None) -> RestSets:
    """Return where friction holds the joint of a case: under the forces of a ``statics`` case, against the bar of a
    ``spring_slider`` case.

    :param friction_coefficient: instead of the case's own
    :raises StatejumpError: the kind of case has no such answer, or its mesh cannot be used
    """
    return require(case, JointStatics).statics(case, friction_coefficient)


def bore(
    path: str | Path, *, unit_m: float = 1.0, journal_radius_m: float | None = None, flip: bool = False
) -> Bore:
    """Return what a measured bore is: roundness, lobes, clearance to a journal.

    :param path: OFF, STL, PLY or OBJ file of its wall
    :param unit_m: length of one unit of the file [m]: 0.001 for millimetres
    :param journal_radius_m: radius of the journal that goes into it [m]
    :param flip: turn every face over, of a file whose normals point into the material
    :raises StatejumpError: the file is not a bore; the sentence says what is wrong and where
    """
    found: Bore = _BORE(Path(path), unit_m=unit_m, journal_radius_m=journal_radius_m, flip=flip)
    return found


def identify(
    source: str | Path | Mapping[str, Any], *, model: str | Sequence[str] = "auto", start: str = "unknown",
    confidence: float = 0.95, target: str | None = None, normal_force_N: float | None = None,
    journal_radius_m: float | None = None, ignored: Sequence[str] = (),
) -> Identification:
    """Return what a measured loop says of a joint: parameters by least squares, noise of the force may be correlated,
    intervals by profile likelihood, the choice among joints by BIC, and what the loop does not say.

    :param source: a table, or columns: ``displacement_m`` and ``force_N``, or ``rotation_rad`` and ``moment_N_m``, or
        the same in other units, row by row as measured; a force is positive where it resists a positive displacement
    :param model: a joint, several, or ``auto``: all of :data:`statejump.identification.models.MODELS`
    :param start: friction before the first row: ``fresh``, it carries nothing; ``cycled``, the path was gone before;
        ``unknown``: it is a parameter too
    :param confidence: of the intervals, 0.5 to 0.999
    :param target: where the joint goes: ``spring_slider`` (default), ``slider``, ``revolute``, ``umbrella`` (default of
        rotations), ``torsion_spring``, ``iwan_joint``
    :param normal_force_N: in the test [N]: friction becomes a coefficient
    :param journal_radius_m: of a moment of friction [m], likewise
    :param ignored: names of columns of a table that are left out
    :raises StatejumpError: the file is no loop, or there is no such joint
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

    :param values: values by key, one or several: ``section.key``, ``section.item.key`` of an item of a list,
        ``section.*.key`` or ``section.joint*.key`` of all that fit; or of a key what a ``[[vary]]`` table says, as
        ``{"start": 0.1, "stop": 1, "count": 10, "spacing": "log"}``
    :param model: ``reduced`` or ``dem``
    :param workers: processes; None: one for each core, or none of their own where the grid is small
    :param outputs: more to record of every run, as ``jump:displacement_m[P].x``: end, jump, max, min or range of any
        column of a run, of one of its items; see :mod:`statejump.campaign.outputs`
    :raises StatejumpError: there is no such key, or the kind of case has no outcomes
    """
    found: Campaign = _SWEEP(case, values, model=model, workers=workers, progress=progress, outputs=outputs)
    return found


def montecarlo(
    case: Case, distributions: Mapping[str, Mapping[str, Any]], *, samples: int = 1000, seed: int = 1,
    model: str = "reduced", workers: int | None = None, progress: Progress = False, outputs: Sequence[str] = (),
) -> Campaign:
    """Run a case whose parameters are random.

    :param distributions: of each key what a ``[[vary]]`` table says, as ``{"distribution": "normal", "relative": 0.1}``
    :param samples: how many are drawn
    :param seed: of the random numbers: the same seed gives the same samples
    :param model: ``reduced`` or ``dem``
    :param workers: as of :func:`sweep`
    :param outputs: as of :func:`sweep`
    :raises StatejumpError: there is no such key or distribution
    """
    found: Campaign = _MONTECARLO(case, distributions, samples=samples, seed=seed, model=model, workers=workers,
                                  progress=progress, outputs=outputs)
    return found
