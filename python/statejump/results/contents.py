# SPDX-License-Identifier: GPL-3.0-or-later
"""What a result file holds, in memory: written from it, read into it, exported from it."""
from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np

from statejump.kinds.registry import Case, parse_case
from statejump.core.comparison import Quantity
from statejump.core.history import History

# What a contact does at a sample; the number is the place in this list.
CONTACT_STATES = ("separated", "stick", "slip", "at_stop")
SEPARATED, STICK, SLIP, AT_STOP = range(len(CONTACT_STATES))

# Longest ending first: _N_m is not _m.
_UNITS = {
    "_N_m_per_rad": "N m/rad", "_N_m_s_per_rad": "N m s/rad", "_kg_per_m3": "kg/m3", "_rad_per_s": "rad/s",
    "_m_per_s": "m/s", "_N_per_m": "N/m", "_per_K": "1/K", "_N_m": "N m", "_rad": "rad", "_kg": "kg", "_Pa": "Pa",
    "_m2": "m2", "_m": "m", "_K": "K", "_N": "N", "_J": "J", "_s": "s", "_W": "W",
}


def unit_of(name: str) -> str:
    """Return the unit that a name ends in; ``-`` for none."""
    return next((unit for ending, unit in _UNITS.items() if name.endswith(ending)), "-")


@dataclass(frozen=True)
class Column:
    """Values over the samples of a run: one per sample, or (samples, items), or (samples, items, 3).

    ``items`` is the key of the list of names of the second axis, see :attr:`Result.names`.
    ``labels``: the values are places in this list. ``note`` says where it comes from, if not obvious.
    """

    values: np.ndarray
    unit: str = "-"
    items: str = ""
    labels: tuple[str, ...] = ()
    note: str = ""


@dataclass(frozen=True)
class Event:
    """Something that happened. ``joint`` is the contact or joint, "" for none.

    ``time_uncertainty_s``: 0 for an instant that the model locates, else half the distance of the two
    samples between which it lies.
    """

    kind: str
    time_s: float
    temperature_change_K: float
    joint: str = ""
    time_uncertainty_s: float = 0.0


@dataclass(frozen=True)
class Scalar:
    """One number that sums up a run. NaN: it did not happen."""

    value: float
    unit: str = "-"


@dataclass(frozen=True)
class Answers:
    """What a designer asks of a truss. ``tables`` has the rows of the CSV files of the same names; a value is
    text, a whole number, a number or None."""

    output: str  # what is traced to the joints: node:NAME, rms, tilt
    text: str  # the same in words
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
    """A surface that a part of type ``mesh`` refers to, in the part's own frame."""

    vertices_m: np.ndarray  # (vertices, 3)
    triangles: np.ndarray  # (triangles, 3), places in vertices_m


@dataclass(frozen=True)
class ModelRun:
    """A run of one model. All columns have the length of ``history["time_s"]``."""

    history: dict[str, Column]
    energy: dict[str, Column]
    links: dict[str, Column]  # (samples, links)
    contacts: dict[str, Column]  # (samples, contacts) and (samples, contacts, 3)
    events: list[Event]
    summary: dict[str, Scalar]

    @property
    def time_s(self) -> np.ndarray:
        """Times of the samples [s]."""
        return self.history["time_s"].values

    def column(self, path: str) -> Column:
        """Return a column by its path below the model, as ``history/time_s``. :raises KeyError:"""
        group, _, name = path.partition("/")
        if group not in ("history", "energy", "links", "contacts"):
            raise KeyError(path)
        return getattr(self, group)[name]


def _given(values: Any) -> Any:
    """Return parsed JSON without what is null or a list of nothing: a case file has no such value."""
    if isinstance(values, dict):
        return {key: _given(value) for key, value in values.items() if value is not None and value != []}
    return [_given(value) for value in values] if isinstance(values, list) else values


@dataclass(frozen=True)
class Result:
    """A whole result file. ``models`` has the keys ``reduced``, ``dem`` or both."""

    command: str
    complete: bool
    name: str
    kind: str
    title: str
    source: str
    case_text: str  # as given; "" if the case did not come from a file
    case_json: str  # with all defaults
    provenance: dict[str, Any]
    names: dict[str, list[str]]  # of the second axes of columns
    scene: dict[str, Any]  # see scene.py
    models: dict[str, ModelRun]
    comparison: Optional[list[Quantity]] = None
    warnings: list[str] = field(default_factory=list)
    meshes: dict[str, Mesh] = field(default_factory=dict)
    answers: Optional[Answers] = None

    def case(self) -> Case:
        """Return the case; StatejumpError if this version does not understand it any more."""
        return parse_case(_given(json.loads(self.case_json)), f"case {self.name}")

    @property
    def passed(self) -> Optional[bool]:
        """Whether all compared quantities are within tolerance; None: nothing was compared."""
        return None if self.comparison is None else all(row.passed for row in self.comparison)


def columns_of(history: History) -> tuple[dict[str, Column], dict[str, Column]]:
    """Return a history's columns and, apart from them, its energies (names that end in ``_J``)."""
    plain: dict[str, Column] = {}
    energy: dict[str, Column] = {}
    for name, values in history.columns.items():
        values = np.asarray(values)
        if values.dtype.kind == "U":
            labels, numbers = np.unique(values, return_inverse=True)
            plain[name] = Column(numbers.astype(np.uint8), labels=tuple(labels.tolist()))
            continue
        (energy if name.endswith("_J") else plain)[name] = Column(values.astype(float), unit_of(name))
    return plain, energy


def history_of(run: ModelRun) -> History:
    """Return the columns of one value per sample as a history; inverse of :func:`columns_of`."""
    return History({
        name: np.array(column.labels)[column.values] if column.labels else column.values
        for name, column in {**run.history, **run.energy}.items() if column.values.ndim == 1
    })


# Differs from run to run of the same case: not a result.
_OF_THE_DAY = ("wall_time_s", "cpu_time_s")


def scalars(values: dict[str, Any]) -> dict[str, Scalar]:
    """Return numbers with the units that their names end in; None becomes NaN, texts and what does
    not repeat are left out."""
    return {
        name: Scalar(math.nan if value is None else float(value), unit_of(name))
        for name, value in values.items()
        if (value is None or isinstance(value, (int, float))) and name not in _OF_THE_DAY
    }
