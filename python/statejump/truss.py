# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses: generated cases of any size, drawings, and design questions.

::

    import statejump as sj

    case = sj.truss.ring(12, radial_clearance_m=1e-5)
    sj.truss.draw(case)
    found = sj.truss.answers(case, cycles=3)
    found.verdict, found.frame("contributions")

Every generator of a truss takes the number of its bays, ribs or blocks first, then keys with defaults, like the
commands of ``statejump truss``.
"""
from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

from statejump.core.case import Case, Progress
from statejump.control.capabilities import ControlStudy, Creaking, DesignAnswers, TrussDesign
from statejump.control.study import DesignChoices, Study
from statejump.core.errors import Range
from statejump.core.progress import shown
from statejump.kinds import require
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import generate
from statejump.kinds.truss.generate.document import Document
from statejump.report.capabilities import CaseDrawing
from statejump.schema.paths import plain
from statejump.schema.rules import WHOLE, Rule

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from statejump.design.result import Design
    from statejump.kinds.truss.answers.study import TrussAnswers
    from statejump.kinds.truss.creak import Creak

__all__ = ["answers", "chain", "control", "creak", "design", "draw", "iwan", "mast", "ring", "umbrella"]

Keys = ParamSpec("Keys")
LARGEST = 1_000_000
# Smallest number of bays, ribs or blocks of each generator.
LEAST = {"chain": 1, "iwan": 1, "umbrella": 1, "ring": 3, "mast": 1}


def _making(document: Callable[Keys, Document]) -> Callable[Keys, Case]:
    """Convert a generator of case documents to a function that returns a case."""
    name = document.__name__
    number = Rule(WHOLE, allowed=Range(LEAST[name], LARGEST))

    @wraps(document)
    def make(*given: Keys.args, **keys: Keys.kwargs) -> Case:
        bound = inspect.signature(document).bind(*plain(given), **plain(keys))
        number.check("n", bound.arguments["n"])
        return parse_case(document(*bound.args, **bound.kwargs))

    make.__module__ = __name__
    make.__signature__ = inspect.signature(document).replace(return_annotation="Case")  # type: ignore[attr-defined]
    return make


chain = _making(generate.chain)
iwan = _making(generate.iwan)
umbrella = _making(generate.umbrella)
ring = _making(generate.ring)
mast = _making(generate.mast)
# The commands of ``statejump truss`` are made from these functions.
MAKERS = dict[str, Callable[..., Case]](chain=chain, iwan=iwan, umbrella=umbrella, ring=ring, mast=mast)


def draw(case: Case, axes: Axes | None = None, names: bool = False) -> Figure:
    """Draw a truss without solving it: nodes, links coloured by temperature, supports, joints, springs, loads.

    :param case: a case of kind ``truss``
    :param axes: axes to draw into, with projection ``3d`` for a spatial truss; None: a new figure
    :param names: whether to write the names of all nodes, however many there are
    :raises StatejumpError: the case is of another kind, or the axes are not three-dimensional
    """
    return require(case, CaseDrawing).draw(case, axes, names)


def creak(case: Case, node: str, *, progress: Progress = False) -> Creak:
    """Return results of a truss in motion: slips of the joints with their heat, and the acceleration of a node with its
    spectrum and its peak and RMS in octaves.

    :param case: a case of kind ``truss``; its section ``[motion]`` sets the time steps
    :param node: name of the node
    :param progress: True: show it on standard error; or a function that receives the finished fraction, 0 to 1
    :raises StatejumpError: the case is of another kind, the node does not exist, or a time step has no solution
    """
    kind = require(case, Creaking)
    with shown(progress, "motion") as on_progress:
        found: Creak = kind.creak(case, node, on_progress)
    return found


def answers(
    case: Case, *, output: str = "node", cycles: int | None = None, each: bool = False, step: float = 0.01,
    sensitivity: bool = True, progress: Progress = False,
) -> TrussAnswers:
    """Answer the design questions of a truss: jumps, whether they settle, contributions of joints, sensitivities.

    :param case: a case of kind ``truss``
    :param output: the output whose jump is divided among the joints: ``node`` (the node that moves most),
        ``node:NAME``, or ``rms`` or ``tilt`` of the reflector
    :param cycles: replaces the number of cycles of the case
    :param each: whether to compute also the sensitivity to every single item
    :param step: relative change of each parameter
    :param sensitivity: whether to compute sensitivities
    :param progress: True: show it on standard error; or a function that receives the finished fraction of each part
    :raises StatejumpError: the case is of another kind, the output does not exist, or the solver finds no path
    """
    found: TrussAnswers = require(case, DesignAnswers).answers(
        case, output=output, cycles=cycles, each=each, step=step, sensitivity=sensitivity,
        phase=lambda label: shown(progress, label),
    )
    return found


def control(
    case: Case, *, node: str | None = None, jump_below: float | None = None,
    add_spring: Sequence[tuple[str, str]] = (), scale: Sequence[str] = (), progress: Progress = False,
) -> Study:
    """Return, for each candidate by itself, the smallest change of springs, preloads, friction or other parameters that
    keeps the jump of a node at or below a value, and the best candidate.

    :param case: a case of kind ``truss``
    :param node: name of the node; None: the node that moves most
    :param jump_below: largest allowed jump over all cycles [m]; None: half of the jump of the case
    :param add_spring: pairs of nodes between which a spring may be added, unloaded in the reference configuration
    :param scale: keys whose values may be scaled: ``section.item.key``, or ``section.*.key`` for all items. Without any
        candidate, all keys that may affect a jump
    :param progress: True: show it on standard error; or a function that receives the finished fraction, 0 to 1
    :return: ``sentences`` and ``remarks`` state the result as text, ``recommendation`` as numbers; ``frame()`` has the
        whole scan
    :raises StatejumpError: the case is of another kind, a node or key does not exist, or the solver finds no path
    """
    kind = require(case, ControlStudy)
    with shown(progress, "control") as on_progress:
        found = kind.control(case, jump_below=jump_below, on_progress=on_progress,
                             choices=DesignChoices(node, add_spring, scale))
    return found


def design(case: Case, wanted: str | Path | Mapping[str, Any], *, progress: Progress = False) -> Design:
    """Return the design of least cost that meets requirements over a grid of friction and clearances.

    :param case: a case of kind ``truss``
    :param wanted: path of a design file, or its sections as a dict
    :param progress: True: show it on standard error; or a function that receives the finished fraction, 0 to 1
    :return: ``case`` is the designed case, ``verdict`` and ``sentences`` state the result as text, ``record()`` as
        numbers
    :raises StatejumpError: the case is of another kind, or the design file is invalid for it
    """
    kind = require(case, TrussDesign)
    with shown(progress, "design") as on_progress:
        found: Design = kind.design(case, wanted, on_progress)
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
