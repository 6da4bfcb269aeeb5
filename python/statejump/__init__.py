# SPDX-License-Identifier: GPL-3.0-or-later
"""State jump of deployable structures: an exact reduced model and a DEM model in YADE.

::

    import statejump as sj

    case = sj.load("cases/table1.toml")
    run = case.reduced()
    run.frame(), run.events, run.summary, run.plot()
    sj.compare(run, case.dem(progress=True)).passed

``__all__`` lists the public interface; its members are imported at their first use.
"""
from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

from statejump import _paths
from statejump._version import __version__

if TYPE_CHECKING:
    from statejump.api import compare as compare, load as load, modes as modes, statics as statics, worst as worst
    from statejump.bores.measure import bore as bore
    from statejump.campaign.calls import montecarlo as montecarlo, sweep as sweep
    from statejump.campaign.rare import rare as rare
    from statejump.core.case import Case as Case
    from statejump.core.comparison import Comparison as Comparison, Quantity as Quantity
    from statejump.core.errors import StatejumpError as StatejumpError
    from statejump.core.run import Column as Column, Event as Event, Run as Run
    from statejump.identification.result import identify as identify
    from statejump.kinds.protocol import Kind as Kind
    from statejump.results.read import read as read

if sys.version_info[:2] != _paths.PYTHON_VERSION:
    raise ImportError(
        "statejump was built for {} ({}.{}); this is {} ({}.{})".format(
            _paths.PYTHON, *_paths.PYTHON_VERSION, sys.executable, *sys.version_info[:2]))

# Module of each public name.
_PLACES = {
    **dict.fromkeys(("compare", "load", "modes", "statics", "worst"), "statejump.api"),
    "bore": "statejump.bores.measure",
    **dict.fromkeys(("montecarlo", "sweep"), "statejump.campaign.calls"),
    "rare": "statejump.campaign.rare",
    "identify": "statejump.identification.result",
    "read": "statejump.results.read",
    "Case": "statejump.core.case",
    **dict.fromkeys(("Comparison", "Quantity"), "statejump.core.comparison"),
    "StatejumpError": "statejump.core.errors",
    **dict.fromkeys(("Column", "Event", "Run"), "statejump.core.run"),
    "Kind": "statejump.kinds.protocol",
}
_MODULES = {"body": "statejump.body", "errors": "statejump.core.errors", "fclib": "statejump.fclib",
            "kinds": "statejump.kinds", "laws": "statejump.laws", "surface": "statejump.surface",
            "truss": "statejump.truss"}
__all__ = ["__version__", *_PLACES, *_MODULES]


def __getattr__(name: str) -> Any:
    if name in _PLACES:
        return getattr(import_module(_PLACES[name]), name)
    if name in _MODULES:
        return import_module(_MODULES[name])
    raise AttributeError(f"module 'statejump' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
