# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a control study that all kinds of cases share: swept parameters, allowed jump, searches."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import wraps
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump.core import libraries
from statejump.core.case import Case
from statejump.core.errors import NotAllowed
from statejump.core.tables import write_csv, write_json
from statejump.schema.fields import rule_of
from statejump.schema.paths import attribute_of

if TYPE_CHECKING:
    import pandas

# Line of a result in figures: its name in the legend, and its style.
Line = tuple[str, Mapping[str, Any]]
RUNS = 40  # default size of an ensemble


@dataclass
class Row:
    """One value of a swept parameter and its jumps. A jump is None if the model has none; ``note`` has the reason."""

    value: float
    results: dict[str, float | None]
    note: str = ""
    dem_jump: float | None = None


@dataclass
class Sweep:
    """Sweep of one parameter; all other parameters keep their values of the case."""

    parameter: str  # path section.key, with the unit in the key
    label: str  # label of the axis, without unit
    display_unit: str
    display_scale: float
    own: float
    rows: list[Row]
    scale: str = "log"  # scale of the axis, log or linear; both show zero
    meets: list[tuple[float, float]] = field(default_factory=list)  # ranges with the wanted value
    recommended: float | None = None

    def row(self, value: float) -> Row:
        """Return the row of a value."""
        return next(row for row in self.rows if row.value == value)

    def insert(self, row: Row) -> None:
        """Insert a row in ascending order of its value. A row with the same value is replaced."""
        self.rows = sorted([kept for kept in self.rows if kept.value != row.value] + [row], key=lambda r: r.value)

    def column(self, name: str) -> np.ndarray:
        """Return the results of all rows; NaN for a missing result."""
        return np.array([np.nan if row.results.get(name) is None else row.results[name] for row in self.rows])

    def shown(self, most: int = 7) -> list[Row]:
        """Return the rows for a table: the value of the case, the recommended value, and some others."""
        stride = max(1, -(-len(self.rows) // most))
        return [
            row for i, row in enumerate(self.rows)
            if i % stride == 0 or row.value in (self.own, self.recommended) or row.dem_jump is not None
            or row is self.rows[-1]
        ]


@dataclass(frozen=True)
class DesignChoices:
    """The node whose jump is evaluated, and the allowed changes, for a case with many nodes and parameters.

    :param node: node whose jump is evaluated; None: the node that moves most
    :param add_spring: pairs of nodes between which a spring may be added
    :param scale: parameters that may be scaled, ``section.item.key`` or ``section.*.key``
    """

    node: str | None = None
    add_spring: Sequence[tuple[str, str]] = ()
    scale: Sequence[str] = ()


@dataclass
class Study:
    """A study of a case.

    :param measure: sentence that names the measured quantity and the method
    :param unit: unit of the jump, m or rad
    :param results: headings of the result columns, by column name with unit
    :param jump: jump of the unchanged case [unit]
    :param wanted: largest allowed jump [unit]; None: there is no jump to control
    :param quantity: name of the results in figures, with their displayed unit
    :param lines: line style of each result in figures, by name
    :param logarithmic: whether figures show the results on a logarithmic axis
    """

    measure: str
    unit: str
    display_unit: str
    display_scale: float
    results: dict[str, str]
    jump: float
    wanted: float | None
    quantity: str
    lines: Mapping[str, Line]
    logarithmic: bool = True
    sweeps: list[Sweep] = field(default_factory=list)
    recommendation: dict[str, Any] = field(default_factory=dict)
    sentences: list[str] = field(default_factory=list)  # the recommendation as sentences
    remarks: list[str] = field(default_factory=list)
    dem: list[dict[str, Any]] = field(default_factory=list)
    # Lower bound of the jump while only one parameter changes: key of the parameter, name in the legend, value [unit].
    floor: tuple[str, str, float] | None = None

    def sweep(self, parameter: str) -> Sweep:
        """Return the sweep of a parameter."""
        return next(sweep for sweep in self.sweeps if sweep.parameter == parameter)

    def columns(self) -> list[str]:
        """Return the names of the columns of :meth:`rows`."""
        return ["parameter", "value", "is_own_value", "is_recommended", *self.results, f"dem_jump_{self.unit}", "note"]

    def rows(self) -> list[tuple[Any, ...]]:
        """Return all that was swept, see :meth:`columns`."""
        return [(sweep.parameter, row.value, int(row.value == sweep.own), int(row.value == sweep.recommended),
                 *(row.results.get(name) for name in self.results), row.dem_jump, row.note)
                for sweep in self.sweeps for row in sweep.rows]

    def frame(self) -> pandas.DataFrame:
        """Return all sweeps as one table, with units in the column names."""
        return libraries.frame(self.rows(), columns=self.columns())


def check_wanted(jump_below: float | None, unit: str) -> None:
    """Raise NotAllowed for an invalid wanted jump."""
    if jump_below is not None and not (isfinite(jump_below) and jump_below > 0):
        raise NotAllowed("--jump-below", jump_below, code="not_positive", unit=unit)


def refuse_runs(runs: int | None, case: Case) -> None:
    """Raise NotAllowed for an ensemble size in a study without ensembles."""
    if runs is not None:
        raise NotAllowed("--runs", runs, code="exact_path_without_ensemble", name_of_case=case.name)


def refuse_choices(choices: DesignChoices, case: Case) -> None:
    """Raise NotAllowed if a node or parameters are selected, for a kind whose study covers them all."""
    asked = (("--node", [choices.node] if choices.node else []),
             ("--add-spring", [" ".join(ends) for ends in choices.add_spring]), ("--free", choices.scale))
    for option, values in asked:
        for value in values:
            raise NotAllowed(option, value, code="one_jump_only", kind=case.kind)


def highest(case: Case, path: str) -> float:
    """Return the largest allowed value of ``section.key``."""
    allowed = rule_of(attribute_of(type(case), path)).allowed
    assert allowed is not None
    return allowed.high


def bisect(
    passes: Callable[[float], bool], bad: float, good: float, relative: float = 1e-12, steps: int = 200
) -> tuple[float, float]:
    """Bisect between ``bad``, which does not pass, and ``good``, which passes; geometrically if both are positive.

    :return: the bracket of both values; its width is less than ``relative`` times its larger end
    """
    for _ in range(steps):
        if abs(good - bad) <= relative * max(abs(good), abs(bad)):
            break
        middle = float(np.sqrt(bad) * np.sqrt(good)) if bad > 0 and good > 0 else (bad + good) / 2
        if middle in (bad, good):
            break
        if passes(middle):
            good = middle
        else:
            bad = middle
    return bad, good


def ranges_that_pass(
    values: Sequence[float], flags: Sequence[bool], passes: Callable[[float], bool] | None = None,
    narrow: Callable[[float, float], float] | None = None,
) -> list[tuple[float, float]]:
    """Return the ranges of neighbouring swept values that pass, with refined ends.

    :param passes: condition for bisection of the ends; None: no refinement
    :param narrow: replaces bisection: a function of a value that does not pass and one that passes, which returns the
        end that passes
    """
    if narrow is None and passes is not None:
        by_bisection = passes

        def narrow(bad: float, good: float) -> float:
            return bisect(by_bisection, bad, good, 1e-9)[1]

    found: list[tuple[float, float]] = []
    i = 0
    while i < len(values):
        if not flags[i]:
            i += 1
            continue
        j = i
        while j + 1 < len(values) and flags[j + 1]:
            j += 1
        low, high = values[i], values[j]
        if narrow is not None and i > 0:
            low = narrow(values[i - 1], low)
        if narrow is not None and j + 1 < len(values):
            high = narrow(values[j + 1], high)
        found.append((low, high))
        i = j + 1
    return found


def grid(own: float, low: float, high: float, count: int, zero: bool = False) -> list[float]:
    """Return a geometric grid from ``low`` to ``high`` that includes the value of the case and, on request, zero."""
    values = {float(value) for value in np.geomspace(low, high, count)}
    # The exact value of the case replaces grid values near it.
    values = {value for value in values if abs(value - own) > 0.02 * abs(value)}
    values.add(float(own))
    if zero:
        values.add(0.0)
    return sorted(values)


def number(value: float | None, digits: int = 4) -> str:
    """Format a number for a sentence or a table."""
    return "none" if value is None else f"{value:.{digits}g}"


def write(case_name: str, study: Study, folder: Path) -> list[Path]:
    """Write ``control.csv`` and ``control.json``."""
    table = write_csv(folder / "control.csv", study.columns(), study.rows())
    summary = write_json(folder / "control.json", {
        "case": case_name,
        "measure": study.measure,
        f"jump_{study.unit}": study.jump,
        f"jump_wanted_below_{study.unit}": study.wanted,
        "recommendation": {**study.recommendation, "sentence": " ".join(study.sentences)},
        "ranges_that_meet_the_wanted_jump": {
            sweep.parameter: {
                "scanned": [sweep.rows[0].value, sweep.rows[-1].value],
                "meet": [list(ends) for ends in sweep.meets],
            }
            for sweep in study.sweeps
        },
        "dem": study.dem,
        "remarks": study.remarks,
    })
    return [table, summary]


def with_notes(study: Callable[..., Study]) -> Callable[..., Study]:
    """Decorate a study: refuse a case without a state jump, and add notes on the temperature program to the remarks."""
    @wraps(study)
    def noted(case: Case, *given: Any, **settings: Any) -> Study:
        case.need_jump("'statejump control'")
        found = study(case, *given, **settings)
        found.remarks += case.thermal_notes
        return found

    return noted
