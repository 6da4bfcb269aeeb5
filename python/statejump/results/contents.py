# SPDX-License-Identifier: GPL-3.0-or-later
"""The contents of a result file in memory, from which it is written, read and exported."""
from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from statejump.core.case import Case
from statejump.core.comparison import Comparison, Quantity
from statejump.core.errors import located
from statejump.core.run import Run
from statejump.core.temperature_files import Histories
from statejump.core.units import unit_of
from statejump.kinds.loading import parse_case


@dataclass(frozen=True)
class Scalar:
    """One number among the answers; NaN: no value."""

    value: float
    unit: str = "-"


@dataclass(frozen=True)
class Answers:
    """Answers to design questions on a truss. ``tables`` has the rows of the CSV files of that name; a cell is a text,
    an integer, a number or None."""

    output: str  # the output whose jump is attributed to joints: node:NAME, rms, tilt
    text: str  # the same in a sentence
    unit: str
    verdict: str
    verdict_text: str
    notes: list[str]
    summary: dict[str, Scalar]
    tables: dict[str, list[dict[str, Any]]]

    def unit_of(self, column: str) -> str:
        """Return the unit of a column of a table."""
        own = {"contribution": self.unit, "jump_change_per_unit": f"{self.unit} per unit of the parameter"}
        return own.get(column) or unit_of(column)


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh of a part of type ``mesh``, in the part's own coordinate frame."""

    vertices_m: np.ndarray  # (vertices, 3)
    triangles: np.ndarray  # (triangles, 3), indices into vertices_m


def _given(values: Any) -> Any:
    """Return parsed JSON without null values and empty lists, because a case file cannot contain them."""
    if isinstance(values, dict):
        return {key: _given(value) for key, value in values.items() if value is not None and value != []}
    return [_given(value) for value in values] if isinstance(values, list) else values


@dataclass(frozen=True)
class Result:
    """The contents of a whole result file. ``models`` has the runs by model: ``reduced``, ``dem`` or both."""

    command: str
    complete: bool
    name: str
    kind: str
    title: str
    source: str
    case_text: str  # text of the case file; "" if the case was made in Python
    case_json: str  # with all defaults
    provenance: dict[str, Any]
    names: dict[str, list[str]]  # of the second axes of columns
    scene: dict[str, Any]  # see scene.py
    models: dict[str, Run]
    rows: tuple[Quantity, ...] | None = None  # of a comparison; None: no comparison
    reasons: list[str] = field(default_factory=list)  # possible reasons for a missed tolerance
    warnings: list[str] = field(default_factory=list)
    meshes: dict[str, Mesh] = field(default_factory=dict)
    answers: Answers | None = None
    members: Histories | None = None  # for a truss with temperature histories of members

    @cached_property
    def definition(self) -> Case:
        """The sections and keys of the case. :raises StatejumpError: this version cannot read the case any more"""
        data = _given(json.loads(self.case_json))
        if self.members is not None:
            data["thermal"]["members"] = self.members
        with located(case=self.name):
            return parse_case(data)

    @property
    def case(self) -> Case:
        """The case. :raises StatejumpError: this version cannot read the case any more"""
        return self.definition

    @property
    def comparison(self) -> Comparison | None:
        """The comparison of the models; None: no comparison."""
        if self.rows is None:
            return None
        return Comparison(self.definition, self.models, self.rows, warnings=tuple(self.warnings),
                          reasons=tuple(self.reasons))

    @property
    def passed(self) -> bool | None:
        """Whether all compared quantities are within their tolerances; None if there is no comparison."""
        return None if self.rows is None else all(row.passed for row in self.rows)
