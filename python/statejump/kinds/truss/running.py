# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of a truss in its models."""
from __future__ import annotations

from dataclasses import replace

from statejump.core.errors import Interrupted
from statejump.core.progress import OnProgress
from statejump.core.run import Run
from statejump.core.yade_process import find_yade
from statejump.kinds import of
from statejump.kinds.truss import dem as scene
from statejump.kinds.truss import motion, result, solve
from statejump.kinds.truss.case import TrussCase


def reduced(case: TrussCase, on_progress: OnProgress) -> Run:
    """Run the quasi-static solver."""
    return result.reduced_run(case, solve.solve(case, on_progress), result.sample_times(case))


def dynamic(case: TrussCase, on_progress: OnProgress) -> Run:
    """Run the truss in motion."""
    try:
        return result.motion_run(case, motion.simulate(case, on_progress))
    except Interrupted as stopped:
        if stopped.run is not None:
            stopped.run = replace(result.motion_run(case, stopped.run), complete=False)
        raise stopped from None


def check_dem(case: TrussCase) -> None:
    """Raise StatejumpError if the DEM cannot run a case, as far as this is known without solving it."""
    scene.check(case)
    find_yade()


def dem(case: TrussCase, on_progress: OnProgress) -> Run:
    """Run the truss in YADE."""
    return scene.run(case, of(case).scene_module(), result.dem_run, on_progress)
