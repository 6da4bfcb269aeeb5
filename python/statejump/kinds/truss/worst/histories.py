# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature histories of members within a box, as trusses for a search and as cases for a file.

A history has cycles of CORNERS corners and a return to ΔT = 0. Temperatures are linear between corners.
"""
from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.core.thermal import MemberProgram, Thermal
from statejump.kinds.loading import load_case
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import evolved

CORNERS = 2  # of a cycle, without its return
MEMBERS = ("link", "beam")
EXPANSION = "thermal_expansion_per_K"
REST = "joints"  # the variable of all joints that expand and are in no group


@dataclass(frozen=True)
class Variable:
    """Items with one common temperature.

    :param items: their sections, and their indices in these sections
    """

    name: str
    items: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Histories:
    """Histories of a case. The temperature of every variable stays between two values, and starts at 0.

    :param data: the document of the case; each of its variables has a program of its own
    """

    data: dict[str, Any]
    variables: Sequence[Variable]
    low_K: float
    high_K: float
    prepared: TrussCase  # a case whose programs reach both ends of the range

    def legs(self, corners_K: np.ndarray) -> np.ndarray:
        """Return temperatures (rows, variables) at the rows of a table, given corners (cycles, CORNERS, variables)."""
        cycles, _, count = corners_K.shape
        with_return = np.concatenate((corners_K, np.zeros((cycles, 1, count))), axis=1)
        return np.concatenate((np.zeros((1, count)), with_return.reshape(-1, count)))

    def returns_s(self, cycles: int) -> np.ndarray:
        """Return the ends of the cycles [s]."""
        return np.arange(1, cycles + 1) * (CORNERS + 1.0)

    def truss(self, corners_K: np.ndarray) -> ResolvedTruss:
        """Return the truss with a history."""
        legs = self.legs(corners_K)
        time = np.arange(len(legs), dtype=float).tolist()
        known = self.prepared.resolve()
        tables = [legs[:, 0], *legs.T]
        programs: list[Thermal | MemberProgram] = []
        for program, table in zip(known.programs, tables, strict=True):
            assert isinstance(program, Thermal)
            programs.append(evolved(program, table_time_s=time, table_temperature_change_K=table.tolist(),
                                    period_s=time[-1]))
        return replace(known, programs=tuple(programs))

    def case(self, corners_K: np.ndarray, name: str, title: str) -> TrussCase:
        """Return the case with a history."""
        data = deepcopy(self.data)
        data["case"] = {**data["case"], "name": name, "title": title}
        return _with_tables(data, self.variables, self.legs(corners_K))


def histories(case: TrussCase, low_K: float, high_K: float, groups: Sequence[str]) -> Histories:
    """Return the histories of a case.

    :param groups: patterns of names, such as ``L1*``, separated by commas; items of a group have one common temperature
    :raises StatejumpError: the histories of a member cannot be replaced
    """
    for body in case.body:
        raise StatejumpError(code="worst_part", place=case.name, case=case.name, part=f"body {body.name!r}")
    for link in case.link:
        if link.expansion is not None:
            raise StatejumpError(code="worst_part", place=case.name, case=case.name,
                                 part=f"link {link.name!r} with an expansion table")
    for beam in case.beam:
        if beam.gradient_program is not None:
            raise StatejumpError(code="worst_part", place=case.name, case=case.name,
                                 part=f"beam {beam.name!r} with gradient_program")
    data = deepcopy(dict(case.origin.document))
    found = _variables(case, data, groups)
    if not found:
        raise StatejumpError(code="worst_without_members", place=case.name, case=case.name)
    for number, variable in enumerate(found):
        for section, index in variable.items:
            item = data[section][index]
            item.pop("temperature_fraction", None)  # the temperature of a variable is that of its members
            item["program"] = f"T{number}"
    ends = np.array([[0.0], [high_K], [low_K], [0.0]]) * np.ones(len(found))
    return Histories(data, found, low_K, high_K, _with_tables(deepcopy(data), found, ends))


def _sections() -> list[str]:
    return [*MEMBERS, *(joint.section for joint in JOINTS if joint.has_temperature)]


def _variables(case: TrussCase, data: dict[str, Any], groups: Sequence[str]) -> list[Variable]:
    """Return the variables of all items that expand: groups in their order, other members, and other joints."""
    items = [(section, index, item["name"]) for section in _sections()
             for index, item in enumerate(data.get(section, [])) if _expands(item)]
    left, found = dict.fromkeys(items), []
    for group in groups:
        patterns = [pattern.strip() for pattern in group.split(",")]
        inside = [item for item in left if any(fnmatchcase(item[2], pattern) for pattern in patterns)]
        if not inside:
            raise NotAllowed("group", group, code="worst_bad_group")
        for item in inside:
            del left[item]
        found.append(Variable(group, tuple(item[:2] for item in inside)))
    found += [Variable(name, ((section, index),)) for section, index, name in left if section in MEMBERS]
    joints = tuple((section, index) for section, index, _ in left if section not in MEMBERS)
    return [*found, Variable(REST, joints)] if joints else found


def _expands(item: dict[str, Any]) -> bool:
    return (any(value for key, value in item.items() if key.endswith(EXPANSION))
            and item.get("temperature_fraction", 1.0) != 0)


def _with_tables(data: dict[str, Any], variables: Sequence[Variable], legs: np.ndarray) -> TrussCase:
    """Return a case whose variables follow a table each; [thermal] shows the first one."""
    table = {"shape": "table", "table_time_s": np.arange(len(legs), dtype=float).tolist()}
    columns = [{**table, "table_temperature_change_K": column.tolist()} for column in legs.T]
    data["thermal"] = {**columns[0], "cycles": 1}
    data["program"] = [{"name": f"T{number}", **column} for number, column in enumerate(columns)]
    made = load_case(data)
    assert isinstance(made, TrussCase)
    return made
