# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact derivatives of the jump of a case by its parameters and keys; see :mod:`.gradient`."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump.core import libraries
from statejump.core.errors import NotAllowed
from statejump.core.progress import OnProgress
from statejump.kinds.truss.answers.gradient import Gradient, RecordedPath
from statejump.kinds.truss.answers.outputs import chosen_output
from statejump.kinds.truss.answers.parameters import parameters
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.paths import value_of

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class JumpGradient:
    """Derivatives of the jump of an output over all cycles.

    :param output: name of the output
    :param jump: its jump, in ``unit``
    :param rows: of each parameter ``parameter``, ``value``, ``derivative`` (``unit`` per unit of the value),
        ``elasticity`` (relative change of the jump per relative change of the value; None for vectors)
    :param solutions: linear systems that the derivatives of all parameters took
    :param events: events whose time affects the output
    :param one_sided: whether two joints change their status at once at such an event. The derivatives then hold for a
        change to one side only
    """

    output: str
    jump: float
    unit: str
    rows: list[dict[str, Any]]
    solutions: int
    events: int
    one_sided: bool

    def __getitem__(self, key: str) -> Any:
        """Return the derivative by a parameter. :raises KeyError: it is not among the rows"""
        return {row["parameter"]: row["derivative"] for row in self.rows}[key]

    def frame(self) -> pandas.DataFrame:
        """Return the rows as a table."""
        return libraries.frame(self.rows)

    def __repr__(self) -> str:
        return f"JumpGradient({self.output}, jump {self.jump:.6g} {self.unit}, {len(self.rows)} parameters)"


def derivatives(case: TrussCase, *, output: str = "node", keys: Sequence[str] = (), each: bool = True,
                on_progress: OnProgress = lambda share: None) -> JumpGradient:
    """Return the derivatives of a jump from one path with all events located.

    :param output: as of :func:`statejump.truss.answers`
    :param keys: keys of the case with numbers or vectors, as of :meth:`Case.changed`; empty: all parameters of joints,
        links and elements
    :param each: whether parameters are those of single items; False: of all items of a section together
    :raises NotAllowed: the output does not exist, or a key has no numbers
    :raises FailedRun: there is no path
    """
    case.need_jump("'gradient'")
    recorded = RecordedPath(case.resolve(), case.reduced_settings.increments_per_branch, on_progress)
    gradient = Gradient(recorded, chosen_output(recorded.found, output))
    rows = [_of_key(case, gradient, key) for key in keys] if keys else list(_of_parameters(gradient, each))
    for row in rows:
        row["elasticity"] = (row["derivative"] * row["value"] / gradient.jump
                             if gradient.jump and isinstance(row["value"], float) else None)
    return JumpGradient(gradient.output.name, gradient.jump, gradient.output.unit, rows, gradient.solutions,
                        gradient.events, gradient.kinks > 0)


def _of_parameters(gradient: Gradient, each: bool) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    for section, key, values in parameters(gradient.truss):
        there = np.isfinite(values) & (values != 0)
        if not there.any():
            continue
        found = gradient.by_parameter(section, key)
        if not each:
            own = values[there]
            same = float(own[0]) if np.ptp(own) <= 1e-12 * abs(own[0]) else None
            rows.append({"parameter": f"{section}.*.{key}", "value": same,
                         "derivative": None if same is None else found.total / same})
            continue
        names = gradient.names(section)
        rows += [{"parameter": f"{section}.{names[item]}.{key}", "value": float(values[item]),
                  "derivative": float(found.items[item] / values[item])} for item in np.flatnonzero(there)]
    return rows


def _of_key(case: TrussCase, gradient: Gradient, key: str) -> dict[str, Any]:
    """Return the row of a key of the case."""
    value = value_of(case, key)
    try:
        given = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        given = np.array(np.nan)
    if value is None or isinstance(value, bool) or not np.isfinite(given).all():
        raise NotAllowed(key, value, code="key_without_number")
    size = float(np.abs(given).max())
    scale = size if size > 0 else _scale(gradient.truss, key)

    def changed_by(place: tuple[int, ...], step: float) -> ResolvedTruss:
        other = given.copy()
        other[place] += step * scale
        changed: TrussCase = case.changed({key: other.tolist()})  # type: ignore[assignment]  # of the same kind
        return changed.resolve()

    found = np.empty_like(given)
    for place in np.ndindex(*given.shape):
        found[place] = gradient.along(partial(changed_by, place)).total / scale
    if given.ndim == 0:
        return {"parameter": key, "value": float(given), "derivative": float(found)}
    return {"parameter": key, "value": given.tolist(), "derivative": found.tolist()}


def _scale(truss: ResolvedTruss, key: str) -> float:
    """Return the size of a key whose value is zero: that of the truss for lengths, else 1."""
    return float(np.ptp(truss.nodes.position_m, axis=0).max()) if key.endswith("_m") else 1.0
