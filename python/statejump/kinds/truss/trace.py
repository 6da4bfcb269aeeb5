# SPDX-License-Identifier: GPL-3.0-or-later
"""Trace of the quasi-static solver: a row for every iteration of Newton's method."""
from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

from statejump.core.errors import StatejumpError
from statejump.core.output import check_suffix, write_atomically
from statejump.core.progress import OnProgress
from statejump.core.run import Run
from statejump.core.tables import cells
from statejump.kinds.truss import result
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.solve import solve

# Entries of a row, in the order of engine/include/statejump/truss/trace.hpp.
COLUMNS = (
    "branch",  # number of the monotone branch of the temperature programs, from 1; 0: the start
    "increment",  # number within the branch; 0: the short first step
    "step",  # number of the attempted step of the path, from 1; 0: the start
    "solve",  # Newton solve of the path, from 1
    "joints",  # treatment of joints: friction; at the start also pins or frictionless
    "opening",  # fraction of the clearances that is open
    "time_s",
    "temperature_change_K",
    "iteration",  # within the solve, from 1
    "node_residual_N",  # of the balance of forces at nodes
    "closure_residual_m",  # of closed or sticking joints
    "joint_residual_N",  # residual of the forces of slipping or open joints
    "step_length_m",  # largest displacement of the step; empty: no step
    "status_changes",  # joints that changed their status
    "changed_joint",  # the first of them
    "factorizations",  # made in this iteration
    "decision",  # step, halved_step, status_change, restart, or the end of the solution
    "step_end",  # result of the step of the path, in its last row
)


def traced(case: TrussCase, on_progress: OnProgress, trace: Path | Callable[[tuple[Any, ...]], object]) -> Run:
    """Run the quasi-static solver and trace it. The file also appears if the run fails or is interrupted.

    :param trace: CSV file, or a function that receives each row
    :raises NotWritten: the file cannot be written
    """
    if not isinstance(trace, Path):
        return _run(case, on_progress, trace)
    check_suffix("--trace", trace, ".csv")
    failure: StatejumpError | None = None
    with write_atomically(trace) as stream:
        writer = csv.writer(stream)
        writer.writerow(COLUMNS)
        try:
            run = _run(case, on_progress, lambda row: writer.writerow(cells(row)))
        except StatejumpError as error:
            failure = error
    if failure is not None:
        raise failure
    return run


def _run(case: TrussCase, on_progress: OnProgress, trace: Callable[[tuple[Any, ...]], object]) -> Run:
    return result.reduced_run(case, solve(case, on_progress, trace), result.sample_times(case))
