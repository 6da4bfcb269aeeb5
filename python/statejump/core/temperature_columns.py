# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of temperatures over time in a CSV or HDF5 file."""
from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump.core.errors import NotAllowed, Unreadable, printable
from statejump.core.reading import check_size, finite_number, is_file, open_csv
from statejump.schema.toml import LARGEST_BYTES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]

ZERO_CELSIUS_K = 273.15
ENDINGS = {"_K": 0.0, "_degC": ZERO_CELSIUS_K}
SUFFIXES = (".csv", ".h5", ".hdf5")
HDF5_TEMPERATURES = {"temperature_K": 0.0, "temperature_degC": ZERO_CELSIUS_K}
ENDS = ("@a", "@b")  # of the names of columns: first and second node of a link


@dataclass(frozen=True)
class Read:
    """What a file holds.

    :param offset_K: what a column's numbers lack to be kelvin (m)
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
    """Return the columns with one in place of two that are of both ends of a link: their mean, which is what a straight
    rod's length follows.

    :raises Unreadable: the other end is missing, has another unit, or the link has a column of its own too
    """
    place = {name: index for index, name in enumerate(read.names)}
    pairs: dict[str, tuple[int, int]] = {}  # a column alone is both
    for name, index in place.items():
        link, end = name[:-len(ENDS[0])], name[-len(ENDS[0]):]
        if end not in ENDS or not link:
            pairs[name] = index, index
            continue
        other = link + ENDS[1 - ENDS.index(end)]
        without, beside = (link, True) if link in place else (other, False)
        if beside or other not in place:
            raise Unreadable(f"has the column {quoted(name)} {'beside' if beside else 'without'} {quoted(without)}",
                             cause="a link has one temperature, or one at either end", file=read.path)
        if read.offset_K[index] != read.offset_K[place[other]]:
            raise Unreadable(f"columns {quoted(name)} and {quoted(other)}", cause="one is in kelvin, the other in °C",
                             file=read.path)
        pairs[link] = index, place[other]
    if len(pairs) == len(place):
        return read
    first, second = np.array(list(pairs.values())).T
    return Read(read.path, tuple(pairs), read.offset_K[first], read.time_s,
                0.5 * (read.values[:, first] + read.values[:, second]))


def refuse(read: Read, wrong: NDArray[np.bool_], what: str) -> None:
    """Raise Unreadable for the first value that is wrong."""
    if wrong.any():
        row, column = np.unravel_index(int(np.argmax(wrong)), wrong.shape)
        raise Unreadable(f"column {quoted(read.names[column])} at {read.time_s[row]:g} s",
                         cause=f"{read.values[row, column]:g} {what}", file=read.path)


def listed(names: tuple[str, ...]) -> str:
    return ", ".join(map(quoted, names[:5])) + (", ..." if len(names) > 5 else "")


def quoted(text: Any) -> str:
    """Return what stands in a file as a sentence quotes it."""
    shown = repr(printable(str(text)))
    return shown if len(shown) <= 40 else shown[:36] + "...'"


def read_columns(path: Path, key: str) -> Read:
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
        raise Unreadable(f"two columns are called {quoted(again)}", file=path)


def _csv(path: Path) -> Read:
    with open_csv(path) as stream:
        check_size(path, LARGEST_BYTES)
        return _rows(path, csv.reader(stream))


def _rows(path: Path, reader: Iterator[list[str]]) -> Read:
    header = [cell.strip() for cell in next(reader, [])]
    if not header or header[0] != "time_s":
        raise Unreadable(f"line 1: the first column is {quoted(header[0] if header else '')}",
                         cause="it must be time_s", file=path)
    if len(header) < 2:
        raise Unreadable("line 1: there is no column of temperatures", file=path)
    names, offsets = [], []
    for cell in header[1:]:
        ending = next((ending for ending in ENDINGS if cell.endswith(ending)), "")
        name = cell.removesuffix(ending)
        if not ending or not name or not name.isprintable():
            raise Unreadable(f"line 1: column {quoted(cell)}", cause="it must be NAME_K or NAME_degC", file=path)
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
    return Read(path, tuple(names), np.array(offsets), table[:, 0].copy(), table[:, 1:])


def _values(path: Path, line: int, header: list[str], row: list[str]) -> Numbers:
    try:
        values = np.fromiter(map(float, row), float, len(row))
        if np.isfinite(values).all() and "_" not in "".join(row):  # Python takes 1_000 for a number
            return values
    except ValueError:
        pass
    for cell, name in zip(row, header):
        if finite_number(cell) is None:
            what = f"{quoted(cell)} is not a finite number" if cell.strip() else "the cell is empty"
            raise Unreadable(f"line {line}, column {quoted(name)}", cause=what, file=path)
    raise AssertionError("a row is refused by one of its cells")


def _hdf5(path: Path) -> Read:
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
    read = Read(path, names, np.full(len(names), HDF5_TEMPERATURES[units[0]]), time_s, values)
    bad = ~np.isfinite(time_s)
    bad[1:] |= ~(time_s[1:] > time_s[:-1])
    if bad.any():
        place = int(np.argmax(bad))
        raise Unreadable(f"time_s[{place}] = {time_s[place]:g}", cause="times must be finite and rise", file=path)
    refuse(read, ~np.isfinite(values), "is not a finite number")
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
