# SPDX-License-Identifier: GPL-3.0-or-later
"""What each kind of case puts into a result file. A kind is a module of its own and its entry here.

A module has ``names(case)`` (lists of items of columns), ``scene(case)`` (see :mod:`.scene`) and
``dem_run(case, done)``, which makes a :class:`~.contents.ModelRun` of a finished or interrupted DEM
run, and ``difference_rows(case, first, second)``, two runs at the same times against the tolerances of
the case; its ``reduced_run`` takes what its own reduced model returns.
"""
from __future__ import annotations

from typing import Any, Protocol

from statejump.kinds.registry import Case, SpringSliderCase, TrussCase, UmbrellaCase
from statejump.core.comparison import Quantity
from statejump.core.yade_process import DemRun
from statejump.kinds.spring_slider import result as kind_spring_slider
from statejump.kinds.truss import result as kind_truss
from statejump.kinds.umbrella import result as kind_umbrella
from statejump.results.contents import ModelRun


class Kind(Protocol):
    """What the module of a kind has."""

    def names(self, case: Any) -> dict[str, list[str]]:
        """Names of the items of columns."""

    def scene(self, case: Any) -> dict[str, Any]:
        """What to draw."""

    def dem_run(self, case: Any, done: DemRun) -> ModelRun:
        """Result of a DEM run."""

    def difference_rows(self, case: Any, first: ModelRun, second: ModelRun) -> list[Quantity]:
        """Two runs of the case against its tolerances; ``Quantity.reduced`` is of the first."""


KINDS: dict[str, Kind] = {
    SpringSliderCase.KIND: kind_spring_slider, UmbrellaCase.KIND: kind_umbrella, TrussCase.KIND: kind_truss,
}


def kind_of(case: Case) -> Kind:
    """Return the module of a case's kind."""
    return KINDS[case.kind]
