# SPDX-License-Identifier: GPL-3.0-or-later
"""Entries of the validation manual: what is compared with what, the differences, the verdict."""
from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import Any

import attrs

import statejump as sj

CLOSED_FORM = "closed form"
OTHER_CODE = "other code"
MEASUREMENT = "measurement"
ORDER = "order of magnitude"  # a measurement whose parameters are not all known

PARTS = (
    "Statics and thermal bars", "Beams and frames", "Dynamics with friction", "Contact and laws", "Thermal walking",
    "Joints from tests", "Whole structures", "Condensed bodies", "The paper's own figures", "Frictional shakedown",
)


@attrs.frozen
class Row:
    """One compared number.

    :param theory: the value of the reference's formula without the named model difference; None: no such difference
    :param refined: our value on a finer discretisation, or extrapolated; None: the discretisation is exact
    :param tolerance: allowed relative difference, in place of the entry's
    :param low: with ``high``, the interval of a measurement, in place of a tolerance
    """

    quantity: str
    unit: str
    reference: float
    ours: float
    theory: float | None = None
    refined: float | None = None
    tolerance: float | None = None
    low: float | None = None
    high: float | None = None
    scale: float | None = None  # of the relative difference; |reference|

    @property
    def total(self) -> float:
        """Relative difference of our value from the reference."""
        return self._relative(self.ours - self.reference)

    @property
    def model(self) -> float:
        """Part of the difference that the named model difference explains."""
        return 0.0 if self.theory is None else self._relative(self.theory - self.reference)

    @property
    def discretisation(self) -> float:
        """Part of the difference that refinement removes."""
        return 0.0 if self.refined is None else self._relative(self.ours - self.refined)

    @property
    def rest(self) -> float:
        """Part of the difference that neither model nor discretisation explains."""
        return self.total - self.model - self.discretisation

    def passes(self, tolerance: float) -> bool:
        """Return whether our value is in the interval, or model differences and tolerance explain it."""
        if self.low is not None and self.high is not None:
            return self.low <= self.ours <= self.high
        return math.isfinite(self.ours) and self.unexplained <= self.allowed(tolerance)

    def allowed(self, tolerance: float) -> float:
        """Return the allowed relative difference, given the entry's."""
        return tolerance if self.tolerance is None else self.tolerance

    @property
    def unexplained(self) -> float:
        """Size of the difference that the named model difference does not explain."""
        return abs(self.total - self.model)

    def _relative(self, difference: float) -> float:
        return difference / (self.scale or abs(self.reference) or 1.0)


@attrs.frozen
class Curve:
    """A line or points of the picture of an entry."""

    label: str
    x: Sequence[float]
    y: Sequence[float]
    ours: bool = True


@attrs.frozen
class Picture:
    """Our curve over theirs."""

    x: str
    y: str
    curves: Sequence[Curve]


@attrs.frozen
class Entry:
    """One page of the manual.

    :param case: the case that was run; None: no case file, for example a contact law alone
    :param model: the named model difference; empty: none
    """

    name: str
    part: str
    title: str
    kind: str
    source: str
    uncertainty: str
    statement: str
    rows: Sequence[Row]
    tolerance: float
    reason: str
    verdict: str
    case: sj.Case | None = None
    model: str = ""
    picture: Picture | None = None
    sketch: str = ""

    @property
    def passed(self) -> bool:
        """Whether every row passes."""
        return all(row.passes(self.tolerance) for row in self.rows)

    @property
    def by_interval(self) -> bool:
        """Whether intervals judge all rows."""
        return all(row.low is not None for row in self.rows)

    @property
    def worst(self) -> Row:
        """The row that is nearest to its tolerance, or farthest beyond; with intervals only, the largest difference."""
        if self.by_interval:
            return max(self.rows, key=lambda row: row.unexplained)
        judged = [row for row in self.rows if row.low is None]
        return max(judged, key=lambda row: row.unexplained / row.allowed(self.tolerance))

    @property
    def largest(self) -> float:
        """Difference of the worst row that the named model difference does not explain."""
        return self.worst.unexplained


def rounded(difference: float) -> str:
    """Return a relative difference as text that rounding errors of a machine do not change."""
    return "< 1e-7" if abs(difference) < 1e-7 else f"{difference:.1e}"


def show(entry: Entry) -> None:
    """Print an entry; end with status 1 if it fails."""
    print(f"{entry.title} ({entry.kind}): {entry.source}")
    for row in entry.rows:
        mark = "passes" if row.passes(entry.tolerance) else "FAILS"
        print(f"  {row.quantity} [{row.unit}]: reference {row.reference:.7g}, ours {row.ours:.7g}, difference "
              f"{rounded(row.total)}, model {rounded(row.model)}, discretisation {rounded(row.discretisation)}, "
              f"rest {rounded(row.rest)}: {mark}")
    print(("passes: " if entry.passed else "FAILS: ") + entry.verdict)
    sys.exit(0 if entry.passed else 1)


def truss(name: str, nodes: Sequence[dict[str, Any]], change_K: float = 1e-6, dimension: int = 2,
          **sections: Any) -> sj.Case:
    """Return the case of a truss whose temperature rises by ``change_K`` and falls again, or follows a given table."""
    thermal = sections.pop("thermal", {})
    if thermal.get("shape") != "table":
        thermal = {"shape": "triangle", "temperature_change_max_K": change_K, "period_s": 1.0, **thermal}
    return sj.load({"case": {"name": name, "kind": "truss"}, "truss": {"dimension": dimension}, "node": list(nodes),
                    **sections, "thermal": thermal})


def node(name: str, *position: float, fixed: str = "", clamped: bool = False, **more: Any) -> dict[str, Any]:
    """Return a node; ``fixed`` lists the letters of its fixed directions, a clamp also holds its rotations."""
    axes = "xyz"[: len(position)]
    made: dict[str, Any] = {"name": name, "position_m": list(position), **more}
    if fixed or clamped:
        made["fixed"] = list(axes if clamped else fixed)
    if clamped:
        made["fixed_rotations"] = ["z"] if len(axes) == 2 else list(axes)
    return made


def link(name: str, first: str, second: str, stiffness_Pa: float, area_m2: float, alpha: float = 0.0,
         **more: Any) -> dict[str, Any]:
    """Return a link."""
    return {"name": name, "nodes": [first, second], "young_modulus_Pa": stiffness_Pa, "cross_section_area_m2": area_m2,
            "thermal_expansion_per_K": alpha, **more}


def hottest(run: sj.Run, column: str) -> Any:
    """Return a column of a run at the largest temperature change."""
    return run[column][int(abs(run["temperature_change_K"]).argmax())]


def chain(count: int, keys: dict[str, Any], prefix: str = "N") -> list[dict[str, Any]]:
    """Return ``count`` beams with the same keys between the nodes prefix0, prefix1, ..."""
    return [{"name": f"B{k}", "nodes": [f"{prefix}{k}", f"{prefix}{k + 1}"], "thermal_expansion_per_K": 0.0, **keys}
            for k in range(count)]


def section(young_Pa: float, area_m2: float, moment_m4: float, **more: Any) -> dict[str, Any]:
    """Return the keys of a beam's section with the same moment about both axes."""
    return {"young_modulus_Pa": young_Pa, "cross_section_area_m2": area_m2,
            "second_moments_of_area_m4": [moment_m4, moment_m4], **more}
