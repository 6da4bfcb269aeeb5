# SPDX-License-Identifier: GPL-3.0-or-later
"""A design: what moved, what it buys, and how sure it is."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.later import Later
from statejump.core.tables import Shown
from statejump.core.units import text
from statejump.design.checks import Profile, Scattered
from statejump.design.requirements import Row
from statejump.design.variables import Group
from statejump.kinds.truss.case import TrussCase

_WRITE = Later("statejump.design.page:write")
AT_BOUND = 1e-6
HOLDS, NOT_MET, UNCHECKED, FRAGILE = "holds", "not met", "not checked", "fails under scatter"
FALSE, RELIES = "false optimum", "relies on friction"
MOST_PROBABLE = 0.05  # probability of a violation above which a design fails under scatter
SHOWN = 40  # variables in the printed table


@dataclass(frozen=True)
class Stage:
    """One search: the points of its grid, the cost it reached, paths, and how it ended."""

    name: str
    cost: float
    paths: int
    gradients: int
    solutions: int  # linear systems solved for exact derivatives
    message: str


@dataclass(frozen=True)
class Design:
    """The result of a design.

    :param case: the designed case
    :param x: factor or shift of every variable
    :param values: value of every row
    :param margins: distance of every row from its limit, relative to the limit
    :param before: value of every row in the unchanged case
    :param elasticities: change in per cent of the critical value per per cent of each variable
    :param price: per cent of the cost that a limit wider by 1 % saves, by requirement
    """

    base: TrussCase
    case: TrussCase
    groups: Sequence[Group]
    x: np.ndarray
    cost: float
    cost_before: float
    rows: Sequence[Row]
    values: np.ndarray
    margins: np.ndarray
    before: np.ndarray
    elasticities: np.ndarray
    price: Mapping[str, float]
    profile: Profile | None
    scatter: Scattered | None
    tail: Any
    stages: Sequence[Stage]
    notes: Sequence[str]
    method: str
    step: float
    interrupted: bool = False

    @property
    def critical(self) -> int:
        """The row that is nearest to its limit."""
        return int(np.argmin(self.margins))

    @property
    def paths(self) -> int:
        """Paths of all searches."""
        return sum(stage.paths for stage in self.stages)

    @property
    def verdict(self) -> str:
        """HOLDS, NOT_MET, FALSE, RELIES, FRAGILE or UNCHECKED."""
        if self.margins.min() < 0:
            return NOT_MET
        false = self.profile is not None and self.profile.false
        if self.scatter is None:
            return FALSE if false else UNCHECKED
        if self.scatter.probability > MOST_PROBABLE:
            return FALSE if false else FRAGILE
        return RELIES if false else HOLDS

    @property
    def sentences(self) -> list[str]:
        """The verdict and its reasons."""
        row = self.rows[self.critical]
        where = "" if row.setting is None else f" at {row.setting}"
        found = [f"verdict: {self.verdict}",
                 f"cost {self.cost:.6g}, before {self.cost_before:.6g}; critical: {row.requirement.name} of {row.label}"
                 f"{where}, {text(self.values[self.critical], row.requirement.unit, 4)}"]
        if self.profile is not None and self.profile.falling:
            factor, peak = self.profile.peak
            found.append(f"falling side of the tent: with friction × {factor:.3g} the largest value is "
                         f"{100 * peak:.4g} % of its limit, with friction × 1 {100 * self.profile.own:.4g} %")
        if self.scatter is not None:
            low, high = self.scatter.interval
            found.append(f"P(a requirement is violated) = {self.scatter.probability:.4g}, 95 % from {low:.2g} to "
                         f"{high:.2g}, {self.scatter.samples} samples, {self.scatter.failed} without a path")
        if self.tail is not None:
            low, high = self.tail.interval
            found.append(f"P({self.tail.event}) = {self.tail.probability:.3g}, 95 % from {low:.2g} to {high:.2g}, "
                         f"{self.tail.runs} runs of FORM and importance sampling")
        found += [f"a limit of {name} wider by 1 % saves {price:.2g} % of the cost" for name, price in
                  self.price.items() if price > 0]
        return [*found, *self.notes]

    def moved(self) -> list[dict[str, Any]]:
        """Return one row for each number that the design may change."""
        found = []
        for group, x, slope in zip(self.groups, self.x, self.elasticities):
            at = "low" if x <= group.x(group.low) + AT_BOUND else "high" if x >= group.x(group.high) - AT_BOUND else ""
            for target, value in group.values(float(x)):
                axis = "" if target.axis < 0 else f".{'xyz'[target.axis]}"
                found.append({"variable": group.label, "key": f"{target.path}{axis}", "before": target.value,
                              "after": value, "factor": None if group.shifts else group.factor(float(x)),
                              "at_bound": at, "elasticity_of_critical": float(slope)})
        return found

    def met(self) -> list[dict[str, Any]]:
        """Return one row for each requirement: its critical value."""
        found = []
        for name in dict.fromkeys(row.requirement.name for row in self.rows):
            places = [place for place, row in enumerate(self.rows) if row.requirement.name == name]
            place = min(places, key=lambda one: self.margins[one])
            row = self.rows[place]
            found.append({"requirement": name, "limit": row.requirement.text, "critical": row.label,
                          "at": "" if row.setting is None else str(row.setting), "unit": row.requirement.unit,
                          "before": float(self.before[place]), "after": float(self.values[place]),
                          "margin": float(self.margins[place])})
        return found

    def summary_lines(self) -> list[Shown | str]:
        """Return the tables and lines that the command prints."""
        moved = self.moved()
        rows = [(row["variable"], row["key"], f"{row['before']:.6g}", f"{row['after']:.6g}",
                 "" if row["factor"] is None else f"{row['factor']:.4g}", row["at_bound"],
                 f"{row['elasticity_of_critical']:.3g}") for row in moved[:SHOWN]]
        lines: list[Shown | str] = [Shown(
            f"design of {self.base.name}", ("variable", "key", "before", "after", "factor", "at bound", "elasticity"),
            rows, left=("variable", "key", "at bound"))]
        if len(moved) > SHOWN:
            lines.append(f"{len(moved) - SHOWN} more in variables.csv")
        met = [(row["requirement"], row["limit"], row["critical"], row["at"], text(row["before"], row["unit"], 4),
                text(row["after"], row["unit"], 4), f"{100 * row['margin']:.3g}") for row in self.met()]
        heads = ("requirement", "limit", "critical", "at", "before", "after", "margin [%]")
        stages = [(stage.name, f"{stage.cost:.6g}", str(stage.paths), str(stage.gradients), str(stage.solutions),
                   stage.message) for stage in self.stages]
        title = f"searches, {self.method}; exact derivatives of jumps, else differences with a step of {self.step:g}"
        return [*lines, Shown("requirements", heads, met, left=heads[:4]),
                Shown(title, ("search", "cost", "paths", "gradients", "adjoint solutions", "end"), stages,
                      left=("search", "end")),
                *self.sentences]

    def record(self) -> dict[str, Any]:
        """Return the design as plain values, as in ``design.json``."""
        return {
            "case": self.base.name, "designed_case": f"{self.case.name}.toml", "verdict": self.verdict,
            "sentences": self.sentences, "method": self.method, "step": self.step, "cost": self.cost,
            "cost_before": self.cost_before, "paths": self.paths, "interrupted": self.interrupted,
            "searches": [vars(stage) for stage in self.stages], "requirements": self.met(), "variables": self.moved(),
            "price": dict(self.price),
            "scatter": None if self.scatter is None else {
                "samples": self.scatter.samples, "violated": self.scatter.violated, "failed": self.scatter.failed,
                "probability": self.scatter.probability, "interval_95": list(self.scatter.interval)},
            "tail": None if self.tail is None else self.tail.record(),
            "friction": None if self.profile is None else {
                "factors": self.profile.factors.tolist(), "value_over_limit": self.profile.worst.tolist(),
                "before": self.profile.before.tolist(), "falling": self.profile.falling}}

    def write(self, folder: Path) -> list[Path]:
        """Write the case, tables, page and picture; return the paths."""
        written: list[Path] = _WRITE(self, folder)
        return written
