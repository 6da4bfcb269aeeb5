# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of models, quantity by quantity, with the tolerances of the case."""
from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from statejump.core import libraries
from statejump.core.errors import NotAllowed
from statejump.core.later import Later
from statejump.core.run import Run
from statejump.core.tables import write_json, write_rows

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from statejump.core.case import Case

# Sources of a value, in the order of the columns.
CLOSED_FORM, REDUCED, DEM, FE = "closed_form", "reduced", "dem", "fe"
# Sources for two runs of one model, or for two files.
FIRST, SECOND = "first", "second"
SIDES = (CLOSED_FORM, REDUCED, DEM, FE, FIRST, SECOND)
_DRAWN, _HTML = Later("statejump.core.figures:drawn"), Later("statejump.core.html:comparison_html")
_SAVED = Later("statejump.results.record:save_as")


@dataclass(frozen=True)
class Quantity:
    """One compared number.

    :param name: name of the quantity
    :param values: two values by their source (``closed_form``, ``reduced``, ``dem``; ``first``, ``second`` for two runs
        of one model); None: the source has no value
    :param difference: second value minus first value; None: one of them is missing
    :param tolerance: largest allowed absolute value of the difference
    """

    name: str
    unit: str
    values: Mapping[str, float | None]
    difference: float | None
    tolerance: float
    passed: bool

    @property
    def finite(self) -> bool:
        """Whether all values of the row are finite numbers."""
        known = [value for value in (*self.values.values(), self.difference, self.tolerance) if value is not None]
        return all(map(math.isfinite, known))

    def __getattr__(self, name: str) -> float | None:
        if name in SIDES:
            return self.values.get(name)
        raise AttributeError(name)

    def to_dict(self) -> dict[str, Any]:
        """Return the row for tables and JSON."""
        return {"name": self.name, "unit": self.unit, **self.values, "difference": self.difference,
                "tolerance": self.tolerance, "pass": self.passed}


def quantity(name: str, unit: str, tolerance: float, **values: float | None) -> Quantity:
    """Return the row of a compared quantity. A value missing on one side fails; one missing on both passes.

    :param values: two values by their source; the first is the reference
    """
    first, second = values.values()
    if first is None or second is None:
        return Quantity(name, unit, values, None, tolerance, passed=first is None and second is None)
    difference = second - first
    passed = bool(math.isfinite(difference) and abs(difference) <= tolerance)
    return Quantity(name, unit, values, difference, tolerance, passed=passed)


def share(difference: float, scale: float) -> float:
    """Return difference / scale [-]: 0 if both are zero, because nothing moves; infinite if only the scale is zero. NaN
    stays NaN, so that its row fails."""
    if difference == 0 and scale == 0:
        return 0.0
    if scale > 0:
        return difference / scale
    return math.nan if math.isnan(scale) else math.copysign(math.inf, difference)


def models(name: str, unit: str, reduced: float | None, dem: float | None, tolerance: float) -> Quantity:
    """Return a row of the two models; see :func:`quantity`."""
    return quantity(name, unit, tolerance, reduced=reduced, dem=dem)


def of_two(rows: Iterable[Quantity]) -> list[Quantity]:
    """Return the compared rows of two runs of any models, with ``first`` and ``second`` as sources of the values."""
    return [replace(row, values=dict(zip((FIRST, SECOND), row.values.values()))) for row in rows]


def sides(rows: Sequence[Quantity]) -> list[str]:
    """Return the sources of the compared values, in the order of ``SIDES``."""
    return [side for side in SIDES if any(side in row.values for row in rows)]


def table(rows: Sequence[Quantity]) -> list[dict[str, Any]]:
    """Return rows that all have the same cells."""
    known = sides(rows)
    return [
        {"name": row.name, "unit": row.unit, **{side: row.values.get(side) for side in known},
         "difference": row.difference, "tolerance": row.tolerance, "pass": row.passed}
        for row in rows
    ]


@dataclass(frozen=True)
class Comparison:
    """Comparison of two models of a case.

    :param reasons: possible reasons for a missed tolerance, with the keys to set; empty if all tolerances are met
    """

    case: Case
    models: Mapping[str, Run]
    rows: tuple[Quantity, ...]
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = field(default=())
    reasons: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether all compared quantities are within tolerance."""
        return all(row.passed for row in self.rows)

    @property
    def missed(self) -> list[str]:
        """Names of the quantities that are not."""
        return [row.name for row in self.rows if not row.passed]

    def with_fe(self, rows: Iterable[Quantity], notes: Iterable[str] = ()) -> Comparison:
        """Return the comparison with a further column for the results of finite elements.

        :param rows: values of the reduced model and of finite elements; differences are relative to the reduced model
        """
        more = []
        for row in rows:
            own = row.values[REDUCED]
            scale = abs(own) if own else 1.0
            more.append(replace(row, name=f"{row.name}, finite elements", tolerance=row.tolerance * scale,
                                difference=None if row.difference is None else row.difference * scale))
        return replace(self, rows=(*self.rows, *more), notes=(*self.notes, *notes))

    def frame(self) -> pandas.DataFrame:
        """Return a row per compared quantity."""
        return libraries.frame(table(self.rows))

    def plot(self, axes: Axes | Sequence[Axes] | None = None) -> Figure:
        """Draw the models in one figure; see :meth:`statejump.Run.plot`."""
        return _DRAWN(self.case, list(self.models.values()), axes)

    def save(self, path: str | Path) -> Path:
        """Write both runs as a result file (HDF5), which :func:`statejump.read` reads; return its path.

        :raises NotWritten: the file cannot be written
        :raises NotAllowed: the file name does not end with ``.h5``, or both runs are of one model
        """
        if FIRST in self.models:
            raise NotAllowed("path", str(path), code="one_run_of_a_model")
        written: Path = _SAVED(Path(path), "compare", self.case, self.models, self)
        return written

    def write(self, folder: Path) -> list[Path]:
        """Write ``comparison.json`` and ``comparison.csv``."""
        document = {"case": self.case.name, "pass": self.passed, "quantities": [row.to_dict() for row in self.rows],
                    "reasons": list(self.reasons)}
        return [write_json(folder / "comparison.json", document), write_comparison_csv(self.rows, folder)]

    def __repr__(self) -> str:
        verdict = "passed" if self.passed else f"missed: {', '.join(self.missed)}"
        return f"Comparison({self.case.name}, {verdict})"

    def _repr_html_(self) -> str:
        html: str = _HTML(self)
        return html


def write_comparison_csv(rows: Sequence[Quantity], folder: Path) -> Path:
    """Write the rows of a comparison to ``comparison.csv``; there must be at least one row."""
    return write_rows(folder / "comparison.csv", table(rows))
