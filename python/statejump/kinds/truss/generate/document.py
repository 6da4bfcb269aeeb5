# SPDX-License-Identifier: GPL-3.0-or-later
"""Case files of trusses as documents: shared code of the generators, and output as TOML."""
from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from statejump.core.item_files import write_items
from statejump.core.output import write_atomically
from statejump.schema.fields import TABLES_BESIDE
from statejump.schema.toml import to_toml

Document = dict[str, Any]

# The bar of the paper's Table 1.
TABLE1_BAR: dict[str, Any] = {
    "young_modulus_Pa": 70e9, "cross_section_area_m2": 9e-6, "thermal_expansion_per_K": 23.4e-6,
    "density_kg_per_m3": 2700.0,
}
TABLE1_LENGTH_M = 0.5
_LISTS = ("node", "link", "slider", "revolute", "spring", "torsion_spring")


def document(
    name: str, title: str, source: str, dimension: int, temperature_change_K: float, shape: str, cycles: int,
    period_s: float, sticking: str = "rigid",
) -> Document:
    """Return a case document with header and temperature program, without items."""
    header = {"name": name, "kind": "truss", "title": title, "source": source}
    return {
        "case": header,
        "truss": {"dimension": dimension},
        **{section: [] for section in _LISTS},
        "thermal": {
            "shape": shape, "temperature_change_max_K": float(temperature_change_K), "cycles": cycles,
            "period_s": float(period_s),
        },
        "reduced": {"sticking": sticking} if sticking != "rigid" else {},
        **({"dem": {"friction_law": "mindlin_deresiewicz"}} if sticking == "partial_slip" else {}),
    }


def finished(made: Document) -> Document:
    """Return the document without what stayed empty."""
    return {section: content for section, content in made.items() if content}


def tidy(values: Iterable[float]) -> list[float]:
    """Return numbers without the rounding of sines and cosines: 0 instead of 6e-17 or -0."""
    return [round(value, 15) + 0.0 for value in values]


def node(name: str, position_m: Sequence[float], fixed: str = "", **more: Any) -> dict[str, Any]:
    """Return a node; ``fixed`` lists the letters of its fixed directions."""
    made: dict[str, Any] = {"name": name, "position_m": tidy(map(float, position_m))}
    if fixed:
        made["fixed"] = list(fixed)
    return made | more


def table_path(path: Path, section: str) -> Path:
    """Return the path of the file that holds the items of a list."""
    return path.with_name(f"{path.stem}_{section}.csv")


def write(made: Mapping[str, Any], path: Path, header: Sequence[str], tables: Collection[str] = ()) -> None:
    """Write the document of a case to a file.

    :param header: comment lines at its head
    :param tables: lists whose items go into CSV files beside the case
    :raises StatejumpError: a file cannot be written
    """
    beside = {section: table_path(path, section) for section in tables if section in made}
    for section, table in beside.items():
        write_items(made[section], table)
    if beside:
        made = {**{section: part for section, part in made.items() if section not in beside},
                TABLES_BESIDE: {section: table.name for section, table in beside.items()}}
    with write_atomically(path) as stream:
        stream.writelines(f"{line}\n" for line in header)
        stream.write(to_toml(made))
