# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperatures from files: ``table_file`` of a temperature program, ``members_file`` of a truss.

Loading a case reads these files and replaces their names by their contents: a program becomes a table, the histories of
members become an object of arrays. Result files and samples of a campaign therefore need none of the files.
"""
from __future__ import annotations

import difflib
import hashlib
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.errors import MissingKey, NotAllowed, StatejumpError, Unreadable
from statejump.core.plausibility import warn_of_reference
from statejump.core.table_files import quoted
from statejump.core.temperature_columns import Read, listed, of_means, read_columns, refuse
from statejump.core.thermal import (
    KEYS_OF_FILES, LARGEST_CHANGE_K, LONGEST_TABLE_S, SAME_TEMPERATURE_K, SAME_TIME, MemberProgram, Numbers,
    Thermal,
)
from statejump.schema.fields import Attached, Section, fields_of, rule_of


class Histories(Attached):
    """Temperature changes of members over time, linear between the times; immutable.

    :param names: names of the m members
    :param time_s: n times [s], rising from 0
    :param temperature_change_K: changes from the reference temperature (n, m) [K]; the first row is 0
    :param source: name of the file in messages; "": unknown
    """

    def __init__(
        self, names: tuple[str, ...], time_s: Numbers, temperature_change_K: Numbers, source: str = ""
    ) -> None:
        self.names, self.time_s, self.temperature_change_K = names, time_s, temperature_change_K
        self.source = source
        for values in (time_s, temperature_change_K):
            values.setflags(write=False)

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of names and numbers. Two histories with the same hash are equal."""
        digest = hashlib.sha256("\n".join(self.names).encode())
        for values in (self.time_s, self.temperature_change_K):
            digest.update(np.ascontiguousarray(values).data)
        return digest.hexdigest()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Histories) and self.sha256 == other.sha256

    def __hash__(self) -> int:
        return hash(self.sha256)

    def __deepcopy__(self, memo: dict[int, Any]) -> Histories:
        return self

    def to_json(self) -> dict[str, Any]:
        return {"members": len(self.names), "times": len(self.time_s), "sha256": self.sha256}

    def programs(self, cycles: int, period_s: float) -> list[MemberProgram]:
        """Return the temperature program of every member, in the order of names, with the return until ``period_s``."""
        times, changes = self.time_s, self.temperature_change_K
        if period_s - times[-1] > SAME_TIME * times[-1]:
            times, changes = np.append(times, period_s), np.vstack((changes, np.zeros(changes.shape[1])))
        columns = np.ascontiguousarray(changes.T)
        return [MemberProgram(times, column, cycles) for column in columns]

    def furthest_at_end(self, cycles: int) -> MemberProgram:
        """Return the program of the member whose last temperature is furthest from the reference temperature."""
        furthest = int(np.argmax(np.abs(self.temperature_change_K[-1])))
        return MemberProgram(self.time_s, self.temperature_change_K[:, furthest], cycles)

    def mean_K(self) -> list[float]:
        """Return the mean temperature change of all members at the times."""
        found: list[float] = self.temperature_change_K.mean(axis=1).tolist()
        return found


def with_files(data: Mapping[str, Any], folder: Path, section: type[Section] | None) -> Mapping[str, Any]:
    """Return a parsed case file in which the contents of temperature files replace their names. Without such files,
    return the document itself. The checks of the case find other faults.

    :param folder: folder to which relative paths refer
    :param section: class of the section [thermal] of this kind of case; None: the kind has no such section
    :raises StatejumpError: a file cannot be read or is invalid: one sentence with its name
    """
    thermal, programs = data.get("thermal"), data.get("program")
    if section is None or not isinstance(thermal, Mapping):
        return data
    made = dict(data)
    common = {key: thermal[key] for key in ("reference_temperature_K", "lead_in_s", "lead_out_s") if key in thermal}
    if thermal.get("members_file") is not None and "members_file" in fields_of(section):
        made["thermal"] = _members(thermal, folder)
    elif thermal.get("table_file") is not None:
        made["thermal"] = _table(thermal, folder, "thermal.", None)
    if isinstance(programs, list):
        made["program"] = [_program(item, folder, common) for item in programs]
    return made


def _program(item: Any, folder: Path, common: Mapping[str, Any]) -> Any:
    if not isinstance(item, Mapping) or item.get("table_file") is None:
        return item
    try:
        found = _table({**common, **item}, folder, "", item.get("name"))
    except StatejumpError as refused:
        if refused.file is None:  # a key of the case itself
            refused.item = f"program {item.get('name')!r}"
        raise
    return found


def _rule(key: str, value: Any, section: str) -> None:
    try:
        rule_of(fields_of(Thermal)[key]).check(f"{section}{key}", value)
    except NotAllowed as refused:
        refused.key = f"{section}{key}"
        raise


def _checked(given: Mapping[str, Any], section: str, key: str) -> None:
    """Raise NotAllowed for a key that contradicts the use of a temperature file."""
    for name in ("reference_temperature_K", "lead_in_s", "lead_out_s", "table_column"):
        if given.get(name) is not None:
            _rule(name, given[name], section)
    if not isinstance(given[key], str):
        raise NotAllowed(f"{section}{key}", given[key], code="not_string")
    if given.get("shape") != "table":
        raise NotAllowed(f"{section}{key}", given[key], code="requires_table_shape", in_section=section)
    others = {"table_file", "members_file", "table_time_s", "table_temperature_change_K"} - {key}
    for other in sorted(other for other in others if given.get(other) is not None):
        raise NotAllowed(f"{section}{other}", code="conflicting_key", other=f"{section}{key}")


def _cycles(given: Mapping[str, Any]) -> int:
    cycles = given.get("cycles")
    return cycles if isinstance(cycles, int) else 1


def _without(given: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in given.items() if key not in KEYS_OF_FILES}


def _table(given: Mapping[str, Any], folder: Path, section: str, name: Any) -> dict[str, Any]:
    """Return a program whose table was read."""
    _checked(given, section, "table_file")
    path = folder / given["table_file"]
    read = read_columns(path, f"{section}table_file")
    column = given.get("table_column") or name
    if column is None:
        if len(read.names) > 1:
            raise MissingKey(f"{section}table_column", code="several_columns", table=path.name,
                             columns=listed(read.names))
        column = read.names[0]
    if column not in read.names:
        near = difflib.get_close_matches(str(column), read.names, n=1, cutoff=0.5)
        if near:
            raise Unreadable(code="misspelt_column", file=path, column=quoted(column), meant=near[0])
        raise Unreadable(code="column_not_found", file=path, column=quoted(column), known=listed(read.names))
    time_s, changes = _changes(read.column(column), given, section)
    return {**_without(given), "table_time_s": time_s.tolist(), "table_temperature_change_K": changes[:, 0].tolist()}


def _members(given: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return the section [thermal] with the histories of members from a file. Its table has the mean of all members."""
    _checked(given, "thermal.", "members_file")
    if given.get("table_column") is not None:
        raise NotAllowed("thermal.table_column", code="conflicting_key", other="thermal.members_file")
    read = of_means(read_columns(folder / given["members_file"], "thermal.members_file"))
    members = Histories(read.names, *_changes(read, given, "thermal."), source=given["members_file"])
    return {**_without(given), "table_time_s": members.time_s.tolist(),
            "table_temperature_change_K": members.mean_K(), "members": members}


def _changes(read: Read, given: Mapping[str, Any], section: str) -> tuple[Numbers, Numbers]:
    """Return times and temperature changes from a file, both starting at 0. The times of the file lie between the
    lead-in and the lead-out.

    :raises StatejumpError: the first row is not at the reference temperature, and the case has no lead-in
    """
    reference, lead_in, lead_out = (given.get(key) for key in ("reference_temperature_K", "lead_in_s", "lead_out_s"))
    time_s = read.time_s - read.time_s[0]
    changes = read.values
    if reference is not None:
        warn_of_reference(f"{section}reference_temperature_K", reference)
        changes = changes + (read.offset_K - reference)
        refuse(read, read.values + read.offset_K < 0, "is below absolute zero", "below_absolute_zero")
    elif read.offset_K.any():
        raise MissingKey(f"{section}reference_temperature_K", code="reference_missing", table=read.path.name)
    refuse(read, np.abs(changes) > LARGEST_CHANGE_K,
           f"is more than {LARGEST_CHANGE_K:g} K away from the stress-free temperature", "change_too_large")
    changes = np.where(np.abs(changes) < SAME_TEMPERATURE_K, 0.0, changes)
    if lead_in is not None:
        time_s = np.concatenate(([0.0], time_s + float(lead_in)))
        changes = np.concatenate((np.zeros((1, changes.shape[1])), changes))
    elif changes[0].any():
        first = int(np.argmax(np.abs(changes[0])))
        remedy = f"or, if these are temperatures and not changes, {section}reference_temperature_K is"
        raise MissingKey(
            f"{section}lead_in_s", code="lead_in_missing", remedy=remedy if reference is None else None,
            table=read.path.name, away_K=changes[0, first], column=read.names[first],
        )
    if lead_out is not None:
        time_s = np.concatenate((time_s, [time_s[-1] + float(lead_out)]))
        changes = np.concatenate((changes, np.zeros((1, changes.shape[1]))))
    if not time_s[-1] <= LONGEST_TABLE_S:
        raise Unreadable(code="last_time_too_late", file=read.path, latest_s=LONGEST_TABLE_S)
    close = np.flatnonzero(~(np.diff(time_s) > np.finfo(float).eps * time_s[-1]))  # rounding of a time near the end
    if close.size:
        raise Unreadable(code="times_too_close", file=read.path, first_s=time_s[close[0]],
                         second_s=time_s[close[0] + 1], whole_s=time_s[-1])
    if _cycles(given) > 1 and changes[-1].any() and given.get("return_to_reference") is False:
        last = int(np.argmax(np.abs(changes[-1])))
        raise NotAllowed(f"{section}cycles", given.get("cycles"), code="table_not_periodic", table=read.path.name,
                         away_K=changes[-1, last], column=read.names[last])
    return time_s, changes
