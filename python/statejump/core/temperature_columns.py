# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of temperatures over time in a text table or an HDF5 file."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core import libraries
from statejump.core.column_units import TIMES, Column, conversion, matched, splits
from statejump.core.errors import StatejumpError, UnknownKey, Unreadable
from statejump.core.hdf5 import foreign
from statejump.core.table_files import Table, check_table, numbers_of, open_table, quoted
from statejump.core.thermal import Numbers
from statejump.core.units import Conversion
from statejump.schema.toml import LARGEST_BYTES

ZERO_CELSIUS_K = 273.15
ENDINGS = {"_K": 0.0, "_degC": ZERO_CELSIUS_K}
ACCEPTED = "NAME_K, NAME_degC, NAME [K] or NAME [°C]"
HDF5_TEMPERATURES = {"temperature_K": 0.0, "temperature_degC": ZERO_CELSIUS_K}
ENDS = ("@a", "@b")  # endings of names of columns: first and second node of a link


@dataclass(frozen=True)
class Read:
    """The content of a file of temperatures.

    :param offset_K: offset that converts numbers to kelvin, for each of m columns
    """

    path: Path
    names: tuple[str, ...]
    offset_K: Numbers
    time_s: Numbers
    values: Numbers

    def column(self, name: str) -> Read:
        """Return one column alone."""
        place = self.names.index(name)
        return Read(self.path, (name,), self.offset_K[place:place + 1], self.time_s, self.values[:, place:place + 1])


def of_means(read: Read) -> Read:
    """Replace the two columns for both ends of a link by their mean, which determines the length of a straight rod.

    :raises Unreadable: the column of the other end is missing or has another unit, or the link also has a column of its
        own
    """
    place = {name: index for index, name in enumerate(read.names)}
    pairs: dict[str, tuple[int, int]] = {}  # a single column is used for both
    for name, index in place.items():
        link, end = name[:-len(ENDS[0])], name[-len(ENDS[0]):]
        if end not in ENDS or not link:
            pairs[name] = index, index
            continue
        other = link + ENDS[1 - ENDS.index(end)]
        without, beside = (link, True) if link in place else (other, False)
        if beside or other not in place:
            raise Unreadable(code="link_ends_incomplete", file=read.path, column=quoted(name),
                             relation="beside" if beside else "without", other=quoted(without))
        if read.offset_K[index] != read.offset_K[place[other]]:
            raise Unreadable(code="columns_of_other_units", file=read.path, column=quoted(name), other=quoted(other))
        pairs[link] = index, place[other]
    if len(pairs) == len(place):
        return read
    first, second = np.array(list(pairs.values())).T
    return Read(read.path, tuple(pairs), read.offset_K[first], read.time_s,
                0.5 * (read.values[:, first] + read.values[:, second]))


def refuse(read: Read, wrong: np.ndarray, what: str, reason: str) -> None:
    """Raise Unreadable for the first invalid value. ``reason`` is that of programs."""
    if wrong.any():
        row, column = np.unravel_index(int(np.argmax(wrong)), wrong.shape)
        raise Unreadable(code="bad_temperature", cause=f"{read.values[row, column]:g} {what}", file=read.path,
                         column=quoted(read.names[column]), at_s=read.time_s[row], reason=reason,
                         value_K=float(read.values[row, column]))


def listed(names: tuple[str, ...]) -> str:
    return ", ".join(map(quoted, names[:5])) + (", ..." if len(names) > 5 else "")


def read_columns(path: Path, key: str) -> Read:
    """Return the content of a file of temperatures.

    :raises StatejumpError: one sentence with the file, and line or column
    """
    found = _text(path) if check_table(path, key, "temperature_file_not_found") else _hdf5(path)
    _check_names(path, found.names)
    if len(found.time_s) < 2:
        raise Unreadable(code="fewer_than_two_times", file=path)
    return found


def _check_names(path: Path, names: tuple[str, ...]) -> None:
    if len(set(names)) < len(names):
        seen: set[str] = set()
        again = next(name for name in names if name in seen or seen.add(name))  # type: ignore[func-returns-value]
        raise Unreadable(code="columns_of_one_name", file=path, column=quoted(again))


def _text(path: Path) -> Read:
    with open_table(path, LARGEST_BYTES) as table:
        at, time = _time(table)
        if len(table.header) < 2:
            raise Unreadable(code="no_temperature_column", file=path)
        others = [place for place in range(len(table.header)) if place != at]
        columns = [_temperature(path, table.header[place]) for place in others]
        times, rows = [], []
        for line, row in table.rows():
            times.append((line, row[at]))
            rows.append(_values(table, line, row, others))
        lines, cells = zip(*times) if times else ((), ())
        time_s = numbers_of(table, time, cells, lines) if times else np.zeros(0)
    for place in np.flatnonzero(np.diff(time_s) <= 0):
        raise Unreadable(code="times_not_increasing", file=path, line=times[place + 1][0], column=table.header[at],
                         time=times[place + 1][1].strip(), before=times[place][1].strip())
    values = np.array(rows).reshape(-1, len(columns))
    scale = np.array([found.factor / found.divisor for _, found in columns])
    return Read(path, tuple(name for name, _ in columns), np.array([found.offset for _, found in columns]), time_s,
                values if (scale == 1).all() else values * scale)


def _time(table: Table) -> tuple[int, Column]:
    """Return index and key of the time column: the first column, or else the only column with a name of times."""
    try:
        return 0, matched(table.header[:1], ("time_s",), {"time_s": TIMES})[0]
    except StatejumpError as refused:
        found = []
        for place, name in enumerate(table.header[1:], start=1):
            with suppress(StatejumpError):
                found.append((place, matched([name], ("time_s",))[0]))
        if len(found) == 1:
            return found[0]
        said = "it must be the time" if isinstance(refused, UnknownKey) else refused.cause
        raise Unreadable(code="first_column_no_times", cause=said, reason=refused.code, file=table.path,
                         column=quoted(table.header[0])) from None


def _temperature(path: Path, cell: str) -> tuple[str, Conversion]:
    """Return the name in a column heading of temperatures, and the conversion of the column's numbers to kelvin."""
    for ending, offset in ENDINGS.items():
        if cell.endswith(ending) and cell.removesuffix(ending).isprintable() and cell != ending:
            return cell.removesuffix(ending), Conversion(offset=offset)
    ways = [(name.strip(), unit) for name, unit in splits(cell)
            if name.strip() and cell.isprintable() and not unit.isdecimal()]  # "Sensor 1" has no unit
    for name, unit in ways:
        found = conversion(unit, "K")
        if found is not None:
            return name, found
    raise Unreadable(
        code="temperature_column_without_unit",
        cause="it names no unit of temperature" if not ways else f"{quoted(ways[0][1])} is no unit of temperature",
        file=path, column=quoted(cell), accepted=ACCEPTED, unit=ways[0][1] if ways else "",
    )


def _values(table: Table, line: int, row: Sequence[str], places: Sequence[int]) -> Numbers:
    return table.numbers([row[place] for place in places], lambda index: (line, table.header[places[index]]))


def _hdf5(path: Path) -> Read:
    with foreign(path) as found:
        units = [name for name in HDF5_TEMPERATURES if f"/{name}" in found]
        if len(units) != 1:
            raise Unreadable(code="temperatures_missing", file=path, data_sets=" and ".join(HDF5_TEMPERATURES))
        time_s, values = _array(found, "time_s", 1, path), _array(found, units[0], 2, path)
        names = _names(found, path)
    if values.shape != (len(time_s), len(names)) or not names:
        raise Unreadable(code="temperatures_of_other_shape", file=path, data_set=units[0], rows=values.shape[0],
                         columns=values.shape[1], times=len(time_s), members=len(names))
    read = Read(path, names, np.full(len(names), HDF5_TEMPERATURES[units[0]]), time_s, values)
    bad = ~np.isfinite(time_s)
    bad[1:] |= ~(time_s[1:] > time_s[:-1])
    if bad.any():
        place = int(np.argmax(bad))
        raise Unreadable(code="time_not_increasing", file=path, index=place, at_s=time_s[place])
    refuse(read, ~np.isfinite(values), "is not a finite number", "not_finite")
    return read


def _array(found: Mapping[str, Any], name: str, dimension: int, path: Path) -> Numbers:
    h5py = libraries.h5py()

    item = found.get(f"/{name}")
    if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "iuf" or len(item.shape or ()) != dimension:
        raise Unreadable(code="data_set_missing", file=path, data_set=name, axes=dimension)
    return np.asarray(item[()], dtype=float)


def _names(found: Mapping[str, Any], path: Path) -> tuple[str, ...]:
    h5py = libraries.h5py()

    item = found.get("/members")
    if not isinstance(item, h5py.Dataset) or len(item.shape or ()) != 1 or h5py.check_string_dtype(item.dtype) is None:
        raise Unreadable(code="members_missing", file=path)
    try:
        names = tuple(str(name) for name in item.asstr()[()])
    except UnicodeDecodeError:
        raise Unreadable(code="members_not_utf8", file=path) from None
    if any(not name or not name.isprintable() for name in names):
        raise Unreadable(code="member_without_name", file=path)
    return names
