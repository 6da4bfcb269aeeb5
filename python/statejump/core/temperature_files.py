# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperatures from files: ``table_file`` of a program, ``members_file`` of a truss.

They are read with the case file, and what they say takes their place: a program becomes a table, the histories of
members an object of arrays. So a result file and the samples of a campaign need none of these files any more.
"""
from __future__ import annotations

import csv
import difflib
import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump.core.errors import MissingKey, NotAllowed, StatejumpError, Unreadable, printable, size
from statejump.core.reading import is_file
from statejump.core.thermal import KEYS_OF_FILES, LARGEST_CHANGE_K, LONGEST_TABLE_S, Thermal
from statejump.schema.fields import Attached, Section, fields_of, rule_of
from statejump.schema.toml import LARGEST_BYTES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]

ZERO_CELSIUS_K = 273.15
ENDINGS = {"_K": 0.0, "_degC": ZERO_CELSIUS_K}
SUFFIXES = (".csv", ".h5", ".hdf5")
HDF5_TEMPERATURES = {"temperature_K": 0.0, "temperature_degC": ZERO_CELSIUS_K}
# Below this a difference of two temperatures is the rounding of °C into kelvin.
SAME_TEMPERATURE_K = 1e-9


@dataclass(frozen=True)
class MemberProgram:
    """The table of one member, as a temperature program has it."""

    table_time_s: Numbers
    table_temperature_change_K: Numbers
    cycles: int
    shape: str = "table"

    @property
    def period_s(self) -> float:
        """Length of a cycle [s]."""
        return float(self.table_time_s[-1])

    def repeated(self, cycles: int) -> MemberProgram:
        """Return the program with another number of cycles."""
        return MemberProgram(self.table_time_s, self.table_temperature_change_K, cycles)


class Histories(Attached):
    """Temperature changes of members over time, straight between the times; immutable.

    :param names: of the members (m)
    :param time_s: from 0, rising (n)
    :param temperature_change_K: from the reference temperature (n, m); the first row is 0
    :param source: how sentences call them; "": not known
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
        """SHA-256 of names and numbers: two histories are equal where theirs is."""
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

    def programs(self, cycles: int) -> list[MemberProgram]:
        """Return the program of every member, in the order of the names."""
        columns = np.ascontiguousarray(self.temperature_change_K.T)
        return [MemberProgram(self.time_s, column, cycles) for column in columns]

    def mean_K(self) -> list[float]:
        """Return the mean temperature change of all members at the times."""
        found: list[float] = self.temperature_change_K.mean(axis=1).tolist()
        return found


@dataclass(frozen=True)
class _Read:
    """What a file holds.

    :param offset_K: what a column's numbers lack to be kelvin (m)
    """

    path: Path
    names: tuple[str, ...]
    offset_K: Numbers
    time_s: Numbers
    values: Numbers

    def column(self, name: str) -> _Read:
        """Return one column alone."""
        place = self.names.index(name)
        return _Read(self.path, (name,), self.offset_K[place:place + 1], self.time_s, self.values[:, place:place + 1])


def with_files(data: Mapping[str, Any], folder: Path, section: type[Section] | None) -> Mapping[str, Any]:
    """Return a parsed case file with what its temperature files say in place of their names; itself, where it
    names none. What is wrong with the keys themselves is left to the checks of the case.

    :param folder: where a relative path begins
    :param section: what [thermal] is in this kind of case; None: the kind has none
    :raises StatejumpError: a file cannot be read or is not what it should be: one sentence with its name
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
        if refused.file is None:  # a key of the case
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
    """Raise NotAllowed where what stands beside the name of a file does not go with it."""
    for name in ("reference_temperature_K", "lead_in_s", "lead_out_s", "table_column"):
        if given.get(name) is not None:
            _rule(name, given[name], section)
    if not isinstance(given[key], str):
        raise NotAllowed(f"{section}{key}", given[key], "must be a text in quotes")
    if given.get("shape") != "table":
        raise NotAllowed(f"{section}{key}", given[key], f"only with {section}shape = 'table'")
    others = {"table_file", "members_file", "table_time_s", "table_temperature_change_K"} - {key}
    for other in sorted(other for other in others if given.get(other) is not None):
        raise NotAllowed(f"{section}{other}", beside=f"with {section}{key}")


def _cycles(given: Mapping[str, Any]) -> int:
    cycles = given.get("cycles")
    return cycles if isinstance(cycles, int) else 1


def _without(given: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in given.items() if key not in KEYS_OF_FILES}


def _table(given: Mapping[str, Any], folder: Path, section: str, name: Any) -> dict[str, Any]:
    """Return a program whose table was read."""
    _checked(given, section, "table_file")
    path = folder / given["table_file"]
    read = _read(path, f"{section}table_file")
    column = given.get("table_column") or name
    if column is None:
        if len(read.names) > 1:
            raise MissingKey(f"{section}table_column", f"{path.name} has the columns {_listed(read.names)}")
        column = read.names[0]
    if column not in read.names:
        near = difflib.get_close_matches(str(column), read.names, n=1, cutoff=0.5)
        raise Unreadable(f"has no column {_cell(column)}_K or {_cell(column)}_degC", file=path,
                         cause=None if near else f"its columns are {_listed(read.names)}",
                         remedy=f"did you mean {near[0]!r}?" if near else None)
    time_s, changes = _changes(read.column(column), given, section)
    return {**_without(given), "table_time_s": time_s.tolist(), "table_temperature_change_K": changes[:, 0].tolist()}


def _members(given: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return the common program with the histories of members; as a table it is their mean."""
    _checked(given, "thermal.", "members_file")
    if given.get("table_column") is not None:
        raise NotAllowed("thermal.table_column", beside="with thermal.members_file")
    read = _read(folder / given["members_file"], "thermal.members_file")
    members = Histories(read.names, *_changes(read, given, "thermal."), source=given["members_file"])
    return {**_without(given), "table_time_s": members.time_s.tolist(),
            "table_temperature_change_K": members.mean_K(), "members": members}


def _changes(read: _Read, given: Mapping[str, Any], section: str) -> tuple[Numbers, Numbers]:
    """Return times from 0 and temperature changes from 0 of a file: its own times since its first, between the lead-in
    and the lead-out.

    :raises StatejumpError: it does not begin at the reference temperature and nothing says how to get there
    """
    reference, lead_in, lead_out = (given.get(key) for key in ("reference_temperature_K", "lead_in_s", "lead_out_s"))
    time_s = read.time_s - read.time_s[0]
    changes = read.values
    if reference is not None:
        changes = changes + (read.offset_K - reference)
        _refuse(read, read.values + read.offset_K < 0, "is below absolute zero")
    elif read.offset_K.any():
        raise MissingKey(f"{section}reference_temperature_K",
                         f"{read.path.name} has temperatures in °C, and the stress-free temperature must be stated")
    _refuse(read, np.abs(changes) > LARGEST_CHANGE_K,
            f"is more than {LARGEST_CHANGE_K:g} K away from the stress-free temperature")
    changes = np.where(np.abs(changes) < SAME_TEMPERATURE_K, 0.0, changes)
    if lead_in is not None:
        time_s = np.concatenate(([0.0], time_s + float(lead_in)))
        changes = np.concatenate((np.zeros((1, changes.shape[1])), changes))
    elif changes[0].any():
        first = int(np.argmax(np.abs(changes[0])))
        raise MissingKey(
            f"{section}lead_in_s", f"{read.path.name} begins {changes[0, first]:g} K away from the stress-free "
            f"temperature (column {read.names[first]!r}), and it must be said how long the way there takes",
            remedy=None if reference is not None else
            f"or, if these are temperatures and not changes, {section}reference_temperature_K is")
    if lead_out is not None:
        time_s = np.concatenate((time_s, [time_s[-1] + float(lead_out)]))
        changes = np.concatenate((changes, np.zeros((1, changes.shape[1]))))
    if not time_s[-1] <= LONGEST_TABLE_S:
        raise Unreadable("its last time is too late", cause=f"at most {LONGEST_TABLE_S:g} s are allowed",
                         file=read.path)
    if _cycles(given) > 1 and changes[-1].any():
        last = int(np.argmax(np.abs(changes[-1])))
        raise NotAllowed(
            f"{section}cycles", given.get("cycles"),
            f"{read.path.name} ends {changes[-1, last]:g} K away from the stress-free temperature (column "
            f"{read.names[last]!r}), and what is repeated must end where it begins")
    return time_s, changes


def _refuse(read: _Read, wrong: NDArray[np.bool_], what: str) -> None:
    """Raise Unreadable for the first value that is wrong."""
    if wrong.any():
        row, column = np.unravel_index(int(np.argmax(wrong)), wrong.shape)
        raise Unreadable(f"column {_cell(read.names[column])} at {read.time_s[row]:g} s",
                         cause=f"{read.values[row, column]:g} {what}", file=read.path)


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(map(_cell, names[:5])) + (", ..." if len(names) > 5 else "")


def _cell(text: Any) -> str:
    """Return what stands in a file as a sentence quotes it."""
    shown = repr(printable(str(text)))
    return shown if len(shown) <= 40 else shown[:36] + "...'"


def _read(path: Path, key: str) -> _Read:
    """Return what a file of temperatures holds.

    :raises StatejumpError: one sentence with the file, and line or column
    """
    if path.suffix.lower() not in SUFFIXES:
        raise NotAllowed(key, path.name, f"must end with {', '.join(SUFFIXES)}")
    if not is_file(path):
        raise Unreadable("no such file of temperatures", file=path)
    found = _csv(path) if path.suffix.lower() == ".csv" else _hdf5(path)
    _check_names(path, found.names)
    if len(found.time_s) < 2:
        raise Unreadable("has fewer than two times", file=path)
    return found


def _check_names(path: Path, names: tuple[str, ...]) -> None:
    if len(set(names)) < len(names):
        seen: set[str] = set()
        again = next(name for name in names if name in seen or seen.add(name))  # type: ignore[func-returns-value]
        raise Unreadable(f"two columns are called {_cell(again)}", file=path)


def _csv(path: Path) -> _Read:
    try:
        if path.stat().st_size > LARGEST_BYTES:
            raise Unreadable("cannot be read", cause=f"it is larger than {size(LARGEST_BYTES)}", file=path)
        with path.open(newline="", encoding="utf-8-sig") as stream:
            return _rows(path, csv.reader(stream))
    except UnicodeDecodeError:
        raise Unreadable("not CSV", cause="the file is not UTF-8 text", file=path) from None
    except csv.Error as failure:
        raise Unreadable("not CSV", cause=str(failure), file=path) from None
    except OSError as failure:
        raise Unreadable("cannot be read", cause=failure.strerror, file=path) from None


def _rows(path: Path, reader: Iterator[list[str]]) -> _Read:
    header = [cell.strip() for cell in next(reader, [])]
    if not header or header[0] != "time_s":
        raise Unreadable(f"line 1: the first column is {_cell(header[0] if header else '')}",
                         cause="it must be time_s", file=path)
    if len(header) < 2:
        raise Unreadable("line 1: there is no column of temperatures", file=path)
    names, offsets = [], []
    for cell in header[1:]:
        ending = next((ending for ending in ENDINGS if cell.endswith(ending)), "")
        name = cell.removesuffix(ending)
        if not ending or not name or not name.isprintable():
            raise Unreadable(f"line 1: column {_cell(cell)}", cause="it must be NAME_K or NAME_degC", file=path)
        names.append(name)
        offsets.append(ENDINGS[ending])
    rows: list[Numbers] = []
    last = -np.inf
    for line, row in enumerate(reader, start=2):
        if not row:
            continue
        if len(row) != len(header):
            raise Unreadable(f"line {line} has {len(row)} cells", cause=f"the header has {len(header)}", file=path)
        values = _values(path, line, header, row)
        if not values[0] > last:
            raise Unreadable(f"line {line}: time_s = {values[0]:g}", file=path,
                             cause=f"times must rise, and {last:g} is before it")
        last = values[0]
        rows.append(values)
    table = np.array(rows).reshape(-1, len(header))
    return _Read(path, tuple(names), np.array(offsets), table[:, 0].copy(), table[:, 1:])


def _values(path: Path, line: int, header: list[str], row: list[str]) -> Numbers:
    try:
        values = np.fromiter(map(float, row), float, len(row))
        if np.isfinite(values).all() and "_" not in "".join(row):  # Python takes 1_000 for a number
            return values
    except ValueError:
        pass
    for cell, name in zip(row, header):
        try:
            wrong = "_" in cell or not isfinite(float(cell))
        except ValueError:
            wrong = True
        if wrong:
            what = f"{_cell(cell)} is not a finite number" if cell.strip() else "the cell is empty"
            raise Unreadable(f"line {line}, column {_cell(name)}", cause=what, file=path)
    raise AssertionError("a row is refused by one of its cells")


def _hdf5(path: Path) -> _Read:
    import h5py

    from statejump.core.hdf5 import objects

    try:
        if not h5py.is_hdf5(path):
            raise Unreadable("cannot be read", cause="it is not HDF5", file=path)
        with h5py.File(path, "r") as file:
            found = objects(file, path)
            units = [name for name in HDF5_TEMPERATURES if f"/{name}" in found]
            if len(units) != 1:
                raise Unreadable("must have one of the data sets " + " and ".join(HDF5_TEMPERATURES), file=path)
            time_s, values = _array(found, "time_s", 1, path), _array(found, units[0], 2, path)
            names = _names(found, path)
    except (OSError, RuntimeError, MemoryError) as error:
        raise Unreadable("cannot be read", cause=" ".join(str(error).split()), file=path) from None
    if values.shape != (len(time_s), len(names)) or not names:
        raise Unreadable(f"{units[0]} is {values.shape[0]} x {values.shape[1]}",
                         cause=f"there are {len(time_s)} times and {len(names)} members", file=path)
    read = _Read(path, names, np.full(len(names), HDF5_TEMPERATURES[units[0]]), time_s, values)
    bad = ~np.isfinite(time_s)
    bad[1:] |= ~(np.diff(time_s) > 0)
    if bad.any():
        place = int(np.argmax(bad))
        raise Unreadable(f"time_s[{place}] = {time_s[place]:g}", cause="times must be finite and rise", file=path)
    _refuse(read, ~np.isfinite(values), "is not a finite number")
    return read


def _array(found: Mapping[str, Any], name: str, dimension: int, path: Path) -> Numbers:
    import h5py

    item = found.get(f"/{name}")
    if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "iuf" or len(item.shape or ()) != dimension:
        raise Unreadable(f"must have the data set {name}", cause=f"numbers along {dimension} axes", file=path)
    return np.asarray(item[()], dtype=float)


def _names(found: Mapping[str, Any], path: Path) -> tuple[str, ...]:
    import h5py

    item = found.get("/members")
    if not isinstance(item, h5py.Dataset) or len(item.shape or ()) != 1 or h5py.check_string_dtype(item.dtype) is None:
        raise Unreadable("must have the data set members", cause="their names, texts along one axis", file=path)
    try:
        names = tuple(str(name) for name in item.asstr()[()])
    except UnicodeDecodeError:
        raise Unreadable("members has texts that are not UTF-8", file=path) from None
    if any(not name or not name.isprintable() for name in names):
        raise Unreadable("members has a name that is empty or not printable", file=path)
    return names
