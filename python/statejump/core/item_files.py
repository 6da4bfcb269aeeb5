# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that hold the items of a case file, one row per item and one column per key; ``[tables]`` lists the files.

Text tables: a cell has the same value as in the case file; lists have blanks between their entries and no brackets; an
empty cell is a missing key. HDF5: one data set per key, with n numbers, n texts, or n rows of either; NaN and empty
texts are missing.

The files are read with the case file, and their columns replace its lists.
"""
from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from statejump.core import libraries
from statejump.core.column_units import Column, matched
from statejump.core.errors import NotAllowed, UnknownKey, Unreadable, located
from statejump.core.hdf5 import foreign
from statejump.core.output import write_atomically
from statejump.core.table_files import Place, Table, check_table, open_table, quoted
from statejump.schema.fields import TABLES_BESIDE, Section, fields_of, rule_of, section_of, tables_of
from statejump.schema.item_tables import ItemTable, once
from statejump.schema.rules import NUMBER, NUMBERS, SWITCH, TEXT, TEXTS, WHOLE, Rule, suggestion
from statejump.schema.texts import Numbering, Texts
from statejump.schema.toml import LARGEST_BYTES

MOST_IN_LIST = 16  # largest number of entries of a cell or row: items list ends, directions and components
TEXTS_AT_ONCE = 1 << 14  # block of a data set: as objects they take ten times the memory of the file
SWITCHES = {"true": True, "false": False}


def with_tables(data: Mapping[str, Any], folder: Path, case: type[Section]) -> Mapping[str, Any]:
    """Replace the file names in the section [tables] of a parsed case file by an :class:`ItemTable` for each file.
    Without this section, return the document itself.

    :param folder: folder to which relative paths refer
    :raises StatejumpError: a file cannot be read or is invalid: one sentence with its name
    """
    named, known = data.get(TABLES_BESIDE), fields_of(case)
    if not isinstance(named, Mapping) or TABLES_BESIDE not in known:
        return data
    made = {section: part for section, part in data.items() if section != TABLES_BESIDE}
    lists = {name: items for name, field in known.items() if (items := tables_of(field)) is not None}
    words = Numbering()  # items refer to each other by name
    for section, file in named.items():
        key = f"{TABLES_BESIDE}.{section}"
        if section not in lists or section not in fields_of(_declared(known)):
            raise UnknownKey(key, **suggestion(section, list(fields_of(_declared(known))), f"{TABLES_BESIDE}.", ""))
        if not isinstance(file, str):
            raise NotAllowed(key, file, code="not_string")
        if section in made:
            raise NotAllowed(key, file, code="table_and_section", table=section)
        made[section] = read_items(folder / file, key, lists[section], words)
    return made


def _declared(known: Mapping[str, attrs.Attribute[Any]]) -> type[Section]:
    found = section_of(known[TABLES_BESIDE])
    assert found is not None
    return found


def read_items(path: Path, key: str, model: type[Section], words: Numbering) -> ItemTable:
    """Return the columns of a file of items.

    :param model: class of the items
    :param words: texts of the files that were read before; the texts of this file are added
    :raises StatejumpError: one sentence with the file, and line or column
    """
    read = _text if check_table(path, key, "table_file_not_found") else _hdf5
    with located(file=path):
        return ItemTable(**read(path, model, words))


def _keys(names: Sequence[str], model: type[Section]) -> list[tuple[Column, Rule]]:
    """Return the columns of a file of items, each with the rule of its key."""
    known = fields_of(model)
    return [(column, rule_of(known[column.key])) for column in matched(names, list(known))]


def _text(path: Path, model: type[Section], words: Numbering) -> dict[str, np.ndarray | Texts]:
    blocks: dict[str, list[np.ndarray]] = {}
    with open_table(path, LARGEST_BYTES, "; HDF5 may be larger") as table:
        keys = _keys(table.header, model)
        for lines, rows in table.blocks():
            for (column, rule), cells in zip(keys, zip(*rows)):
                blocks.setdefault(column.key, []).append(_column(table, column, rule, cells, lines, words))
    if not blocks:
        raise Unreadable(code="no_row", file=path)
    joined = {name: _joined(blocks.pop(name)) for name in list(blocks)}  # frees each block when it has been joined
    return {column.key: _texts(joined[column.key], words) if rule.form in (TEXT, TEXTS) else joined[column.key]
            for column, rule in keys}


def _texts(numbers: np.ndarray, words: Numbering) -> Texts:
    """Return a column of texts whose integer codes use as few bytes as possible."""
    return Texts(once(numbers.astype(np.min_scalar_type(numbers.max(initial=0)))), words.words)


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    """Return all blocks of rows as one array. Shorter rows are padded to the length of the longest row."""
    if parts[0].ndim == 1:
        return np.concatenate(parts)
    width = max(part.shape[1] for part in parts)
    empty: Any = np.nan if parts[0].dtype.kind == "f" else 0
    return np.concatenate([
        np.pad(part, ((0, 0), (0, width - part.shape[1])), constant_values=empty) for part in parts
    ])


def _column(
    table: Table, column: Column, rule: Rule, cells: Sequence[str], lines: Sequence[int], words: Numbering
) -> np.ndarray:
    """Convert the cells of a column to the values of its key. Texts become integer codes."""
    def place(index: int) -> tuple[int, str]:
        return lines[index], column.name

    if rule.form == TEXT:
        return words.numbers([cell.strip().encode() for cell in cells])
    if rule.form == SWITCH:
        for line, cell in zip(lines, cells):
            if cell.strip() and cell.strip().lower() not in SWITCHES:
                raise Unreadable(code="cell_not_boolean", file=table.path, line=line, column=quoted(column.name),
                                 cell=quoted(cell))
        return np.array([SWITCHES.get(cell.strip().lower()) for cell in cells], dtype=object)
    if rule.form in (NUMBER, WHOLE):
        numbers = column.converted(table.numbers(cells, place, empty=True))
        if rule.form == NUMBER:
            return numbers
        return np.array([None if value != value else int(value) if value == int(value) else value
                         for value in numbers.tolist()], dtype=object)
    if rule.form not in (NUMBERS, TEXTS):
        raise Unreadable(code="column_not_in_tables", file=table.path, column=quoted(column.name))
    split = [cell.split() for cell in cells]
    width = max(1, *map(len, split))
    for index, entries in enumerate(split):
        if len(entries) > MOST_IN_LIST:
            raise Unreadable(code="cell_too_long", file=table.path, line=lines[index], column=quoted(column.name),
                             entries=len(entries), most=MOST_IN_LIST)
        if rule.form == NUMBERS and entries and len(entries) != width:
            raise Unreadable(code="cell_of_other_length", file=table.path, line=lines[index],
                             column=quoted(column.name), numbers=len(entries), width=width)
    if rule.form == TEXTS:
        made = np.zeros((len(split), width), np.int32)
        made[np.arange(width) < np.array([[len(entries)] for entries in split])] = words.numbers(
            [entry.encode() for entries in split for entry in entries])
        return made
    return column.converted(_lists(table, split, width, place))


def _lists(table: Table, split: Sequence[Sequence[str]], width: int, place: Place) -> np.ndarray:
    """Return the numbers of lists, one row per cell. The row of an empty cell is NaN."""
    given = [index for index, entries in enumerate(split) if entries]
    found = np.full((len(split), width), np.nan)
    found[given] = table.numbers([entry for index in given for entry in split[index]],
                                 lambda entry: place(given[entry // width])).reshape(-1, width)
    return found


def _hdf5(path: Path, model: type[Section], words: Numbering) -> dict[str, np.ndarray | Texts]:
    with foreign(path) as file:
        found = {name.removeprefix("/"): part for name, part in file.items() if name != "/"}
        return {column.key: _of_data_set(path, column, rule, found[column.name], words)
                for column, rule in _keys(list(found), model)}


def _of_data_set(path: Path, column: Column, rule: Rule, data: Any, words: Numbering) -> np.ndarray | Texts:
    h5py = libraries.h5py()

    name = column.name
    lists = rule.form in (NUMBERS, TEXTS)
    if not isinstance(data, h5py.Dataset) or data.ndim != (2 if lists else 1):
        raise Unreadable(code="data_set_of_wrong_shape", file=path, data_set=quoted(name),
                         form="rows" if lists else "single values")
    if lists and data.shape[1] > MOST_IN_LIST:
        raise Unreadable(code="data_set_rows_too_long", file=path, data_set=quoted(name), length=data.shape[1],
                         most=MOST_IN_LIST)
    if rule.form in (NUMBER, NUMBERS, WHOLE, SWITCH):
        if data.dtype.kind not in "fiub":
            raise Unreadable(code="data_set_not_of_numbers", file=path, data_set=quoted(name))
        if rule.form in (NUMBER, NUMBERS):
            return column.converted(np.asarray(data[()], dtype=float))
        return np.asarray(data[()].astype(bool if rule.form == SWITCH else int).tolist(), dtype=object)
    if h5py.check_string_dtype(data.dtype) is None:
        raise Unreadable(code="data_set_not_of_texts", file=path, data_set=quoted(name))
    numbers = np.zeros(data.shape, np.int32)
    step = TEXTS_AT_ONCE // data.shape[1] if lists and data.shape[1] else TEXTS_AT_ONCE
    for start in range(0, len(data), step):
        rows = data[start:start + step]
        try:
            numbers[start:start + step] = words.numbers(rows.reshape(-1).tolist()).reshape(rows.shape)
        except UnicodeDecodeError:
            raise Unreadable(code="data_set_not_utf8", file=path, data_set=quoted(name)) from None
    return _texts(numbers, words)


def to_cells(value: Any) -> str:
    """Return a value of a document as the text of a table's cell."""
    if isinstance(value, (list, tuple)):
        return " ".join(map(to_cells, value))
    return str(value).lower() if isinstance(value, bool) else str(value)


def write_items(items: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Write the items of a document's list as a CSV table.

    :raises StatejumpError: the file cannot be written, or a text of a list contains a blank
    """
    keys = list(dict.fromkeys(key for item in items for key in item))
    with write_atomically(path) as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(keys)
        writer.writerows(_cells(item, keys) for item in items)


def _cells(item: Mapping[str, Any], keys: Sequence[str]) -> Iterator[str]:
    for key in keys:
        value = item.get(key, "")
        if isinstance(value, list) and any(isinstance(word, str) and len(word.split()) != 1 for word in value):
            raise NotAllowed(key, value, code="name_with_blank", item=f"{item.get('name')!r}")
        yield to_cells(value)
