# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes and bars from two CSV tables."""
from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from statejump.core.errors import Unreadable
from statejump.core.reading import finite_number
from statejump.kinds.truss.importing.model import Bar, Deck, quoted, text_of

NODE = ("name", "x_m", "y_m")
NODE_MORE = ("z_m", "fixed", "force_x_N", "force_y_N", "force_z_N")
BAR = ("name", "first", "second", "young_modulus_Pa", "cross_section_area_m2", "thermal_expansion_per_K")
BAR_MORE = ("density_kg_per_m3", "poisson_ratio", "temperature_change_K")


def read(nodes: Path, bars: Path) -> Deck:
    """Return what two tables say, in SI units.

    :raises Unreadable: one sentence with file and line
    """
    deck = Deck(nodes)
    for line, row in _rows(deck, nodes, NODE, NODE_MORE):
        deck.add_node(line, row["name"], (_number(deck, line, row, "x_m"), _number(deck, line, row, "y_m"),
                                          _optional(deck, line, row, "z_m") or 0.0))
        if set(row.get("fixed", "")) - set("xyz "):
            raise deck.fail(line, f"fixed = {quoted(row['fixed'])}", "must be of the letters x, y and z")
        deck.fix(row["name"], row.get("fixed", "").replace(" ", ""))
        x, y, z = (_optional(deck, line, row, f"force_{axis}_N") or 0.0 for axis in "xyz")
        deck.load(row["name"], (x, y, z))
        deck.take("row of nodes", "node")
    deck.path = bars
    for line, row in _rows(deck, bars, BAR, BAR_MORE):
        ends = (row["first"], row["second"])
        for end in ends:
            if end not in deck.nodes:
                raise deck.fail(line, f"there is no node {quoted(end)}")
        modulus, area, expansion = (_number(deck, line, row, key) for key in BAR[3:])
        deck.bars.append(Bar(
            row["name"], ends, "row of bars", modulus, area, expansion, _optional(deck, line, row, "poisson_ratio"),
            _optional(deck, line, row, "density_kg_per_m3"),
            temperature_change=_optional(deck, line, row, "temperature_change_K"),
        ))
        deck.take("row of bars", "link")
    return deck


def _rows(deck: Deck, path: Path, needed: Sequence[str], more: Sequence[str]) -> list[tuple[int, dict[str, str]]]:
    """Return the rows of a table by column, with their lines."""
    deck.path = path
    try:
        reader = csv.reader(text_of(path))
        header = [cell.strip() for cell in next(reader, [])]
        for name in needed:
            if name not in header:
                raise deck.fail(1, f"column {name} is missing", "needed are " + ", ".join(needed))
        for name in header:
            if name not in needed and name not in more:
                raise deck.fail(1, f"column {quoted(name)} is unknown", "known are " + ", ".join([*needed, *more]))
        if len(set(header)) < len(header):
            raise deck.fail(1, "two columns have the same name")
        found: list[tuple[int, dict[str, str]]] = []
        for row in reader:
            if not row:
                continue
            if len(row) != len(header):
                raise deck.fail(reader.line_num, f"{len(row)} cells", f"the header has {len(header)}")
            deck.room(reader.line_num, len(found) + 1)
            found.append((reader.line_num, dict(zip(header, (cell.strip() for cell in row)))))
    except csv.Error as failure:
        raise Unreadable("not CSV", cause=str(failure), file=path) from None
    return found


def _optional(deck: Deck, line: int, row: dict[str, str], key: str) -> float | None:
    """Return the number of a cell that may be empty or not there."""
    return _number(deck, line, row, key) if row.get(key) else None


def _number(deck: Deck, line: int, row: dict[str, str], key: str) -> float:
    cell = row[key]
    value = finite_number(cell)
    if value is None:
        raise deck.fail(line, f"{key} = {quoted(cell)}", "must be a finite number")
    return value
