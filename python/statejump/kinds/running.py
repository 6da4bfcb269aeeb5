# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case in one of its models."""
from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from statejump.core import yade_process
from statejump.core.case import Case, Progress
from statejump.core.errors import StatejumpError
from statejump.core.progress import OnProgress, shown
from statejump.core.run import Run
from statejump.kinds import require
from statejump.kinds.limits import check_memory
from statejump.kinds.protocol import (
    DemInput, DemModel, DemResult, DemValues, DynamicModel, QuasiStaticModel, ReducedModel, TracedModel,
)

LABELS = {"reduced": "reduced model", "dynamic": "reduced model", "dem": "DEM"}
Trace = str | Path | Callable[[tuple[Any, ...]], object]


def run(case: Case, name: str, progress: Progress, *, trace: Trace | None = None,
        keep_input: str | Path | None = None) -> Run:
    """Run a case in one of its models.

    :param name: ``reduced``, ``dynamic`` or ``dem``
    :param progress: as for :meth:`statejump.Case.reduced`
    :param trace: as for :meth:`statejump.Case.reduced`
    :param keep_input: as for :meth:`statejump.Case.dem`
    """
    if trace is not None:
        return _traced(case, name, progress, trace)
    if name == "dem":
        model = require(case, DemModel).dem if keep_input is None else _keeping(case, Path(keep_input))
    else:
        model = require(case, DynamicModel).dynamic if name == "dynamic" else require(case, ReducedModel).reduced
    check_memory(case, "dem" if name == "dem" else "reduced")
    with shown(progress, LABELS[name]) as on_progress:
        return model(case, on_progress)


def _traced(case: Case, name: str, progress: Progress, trace: Trace) -> Run:
    if name == "dynamic":
        raise StatejumpError(code="trace_of_motion", case=case.name)
    model = require(case, TracedModel)
    check_memory(case, "reduced")
    with shown(progress, LABELS[name]) as on_progress:
        return model.traced(case, on_progress, trace if callable(trace) else Path(trace))


def _keeping(case: Case, folder: Path) -> Callable[[Any, OnProgress], Run]:
    """Write the input of a DEM run into a folder; return a function that runs the DEM with this input."""
    make_run = require(case, DemResult).dem_run
    values = require(case, DemValues).dem_values(case)
    yade_process.keep_input(values, folder)
    return lambda _, on_progress: yade_process.run(case, values, make_run, on_progress)


def keep_input(case: Case, folder: Path) -> str:
    """Write script and data of the DEM run into a folder; return the shell command that repeats the run."""
    yade_process.check_folder(folder)
    return yade_process.keep_input(require(case, DemValues).dem_values(case), folder)


def view(case: Case, folder: Path) -> None:
    """Write script and data of the DEM run into a folder, and open YADE's 3-D view of this input."""
    yade_process.check_display()
    yade_process.check_folder(folder)
    values = require(case, DemValues).dem_values(case)
    yade_process.keep_input(values, folder)
    yade_process.view(values, folder)


def quasi_static(case: Case) -> Any:
    """Return the paths of infinitely slow heating."""
    return require(case, QuasiStaticModel).quasi_static(case)


def check_dem(case: Case) -> None:
    """Check the requirements of the DEM run of a case; see :meth:`statejump.Case.check_dem`."""
    require(case, DemInput)
    require(case, DemModel).check_dem(case)
