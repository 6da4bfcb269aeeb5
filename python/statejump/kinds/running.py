# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of a case in one of its models."""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

from statejump.core.case import Case, Progress
from statejump.core.progress import Tell, shown
from statejump.core.run import Run
from statejump.kinds import require
from statejump.kinds.limits import check_memory
from statejump.kinds.protocol import DemInput, DemModel, DynamicModel, QuasiStaticModel, ReducedModel

LABELS = {"reduced": "reduced model", "dynamic": "reduced model", "dem": "DEM"}


def _model(case: Case, name: str) -> Callable[[Any, Tell], Run]:
    if name == "dem":
        return require(case, DemModel).dem
    return require(case, DynamicModel).dynamic if name == "dynamic" else require(case, ReducedModel).reduced


def run(case: Case, name: str, progress: Progress) -> Run:
    """Run a case in a model.

    :param name: ``reduced``, ``dynamic`` or ``dem``
    :param progress: as of :meth:`statejump.Case.reduced`
    """
    model = _model(case, name)
    check_memory(case, "dem" if name == "dem" else "reduced")
    with shown(progress, LABELS[name]) as tell:
        return model(case, tell)


def quasi_static(case: Case) -> Any:
    """Return the paths of infinitely slow heating."""
    return require(case, QuasiStaticModel).quasi_static(case)


def check_dem(case: Case) -> None:
    """Check what the DEM of a case needs; see :meth:`statejump.Case.check_dem`."""
    require(case, DemInput)
    require(case, DemModel).check_dem(case)
