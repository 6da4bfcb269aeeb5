# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes and bars from two tables."""
from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Union

from statejump.core.column_units import matched
from statejump.core.errors import Unreadable, located
from statejump.core.reading import is_file
from statejump.core.table_files import numbers_of, open_table
from statejump.kinds.truss.importing.model import LARGEST_BYTES, Bar, Deck, quoted

NODE = ("name", "x_m", "y_m")
NODE_MORE = ("z_m", "fixed", "force_x_N", "force_y_N", "force_z_N")
BAR = ("name", "first", "second", "young_modulus_Pa", "cross_section_area_m2", "thermal_expansion_per_K")
BAR_MORE = ("density_kg_per_m3", "poisson_ratio", "temperature_change_K")
TEXTS = ("name", "fixed", "first", "second")
MORE = (*NODE_MORE, *BAR_MORE)
Cell = Union[str, float]


def read(nodes: Path, bars: Path) -> Deck:
    """Return the truss described by two tables, in SI units.

    :raises Unreadable: one sentence with file and line
    """
    deck = Deck(nodes)
    for line, row in _rows(deck, nodes, NODE, NODE_MORE):
        name, fixed = _text(row, "name"), _text(row, "fixed")
        deck.add_node(line, name, (_number(row, "x_m"), _number(row, "y_m"), _optional(row, "z_m") or 0.0))
        if set(fixed) - set("xyz "):
            raise deck.fail(line, "deck_bad_value", problem=f"fixed = {quoted(fixed)} is not of the letters x, y and z")
        deck.fix(name, fixed.replace(" ", ""))
        x, y, z = (_optional(row, f"force_{axis}_N") or 0.0 for axis in "xyz")
        deck.load(name, (x, y, z))
        deck.take("row of nodes", "node")
    deck.path = bars
    for line, row in _rows(deck, bars, BAR, BAR_MORE):
        ends = (_text(row, "first"), _text(row, "second"))
        for end in ends:
            if end not in deck.nodes:
                raise deck.fail(line, "deck_undefined", what_it_is="node", name=quoted(end))
        modulus, area, expansion = (_number(row, key) for key in BAR[3:])
        deck.bars.append(Bar(
            _text(row, "name"), ends, "row of bars", modulus, area, expansion, _optional(row, "poisson_ratio"),
            _optional(row, "density_kg_per_m3"), temperature_change=_optional(row, "temperature_change_K"),
        ))
        deck.take("row of bars", "link")
    return deck


def _rows(deck: Deck, path: Path, needed: Sequence[str], more: Sequence[str]) -> list[tuple[int, dict[str, Cell]]]:
    """Return the rows of a table in SI units, each as its line number and its cells by column."""
    deck.path = path
    if not is_file(path):
        raise Unreadable(code="file_not_found", file=path)
    with open_table(path, LARGEST_BYTES) as table:
        with located(file=path):
            columns = matched(table.header, (*needed, *more))
        missing = [key for key in needed if key not in {column.key for column in columns}]
        if missing:
            raise deck.fail(1, "missing_column", column=missing[0], needed=", ".join(needed))
        found: list[tuple[int, dict[str, Cell]]] = []
        for lines, rows in table.blocks():
            deck.room(lines[-1], len(found) + len(rows))
            cells: dict[str, Sequence[Cell]] = {}
            for column, part in zip(columns, zip(*rows)):
                cells[column.key] = [cell.strip() for cell in part] if column.key in TEXTS else numbers_of(
                    table, column, part, lines, empty=column.key in MORE).tolist()
            found += zip(lines, (dict(zip(cells, row)) for row in zip(*cells.values())))
    return found


def _optional(row: dict[str, Cell], key: str) -> float | None:
    """Return the number in a cell that may be empty or missing."""
    value = row.get(key)
    return value if isinstance(value, float) and value == value else None


def _number(row: dict[str, Cell], key: str) -> float:
    value = row[key]
    assert isinstance(value, float)
    return value


def _text(row: dict[str, Cell], key: str) -> str:
    return str(row.get(key, ""))
