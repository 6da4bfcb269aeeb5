# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured interfaces as tables, and the differences between two of them."""
from __future__ import annotations

import csv
from dataclasses import dataclass, field
from pathlib import Path

ABI = Path(__file__).resolve().parents[2] / "contact_laws" / "yade_abi"
_MEMBERS = ["class", "member", "offset_bytes", "size_bytes", "seen_by", "in_headers", "type"]


@dataclass
class Interface:
    """Interface of YADE by class: sizes [byte], members (offset [byte], type), virtual function tables, stored names.
    """

    name: str
    sizes: dict[str, int] = field(default_factory=dict)
    members: dict[tuple[str, str], tuple[int, str]] = field(default_factory=dict)
    tables: dict[str, list[str]] = field(default_factory=dict)
    stored: dict[str, list[str]] = field(default_factory=dict)
    shown: dict[str, list[str]] = field(default_factory=dict)  # plain data members in Python
    running: bool = False  # members and what Python shows are measured
    binaries: list[str] = field(default_factory=list)

    def title(self) -> str:
        """Return the name of the interface and the YADE binaries that have it."""
        return f"{self.name} ({'; '.join(self.binaries)})" if self.binaries else self.name


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def _read(name: str) -> Interface:
    result = Interface(name, running=True)
    for row in _rows(ABI / "variants" / f"{name}_members.csv"):
        if row["member"]:
            result.members[row["class"], row["member"]] = (int(row["offset_bytes"]), row["type"])
        elif row["seen_by"] == "allocation":
            result.sizes[row["class"]] = int(row["size_bytes"])
    for row in _rows(ABI / "variants" / f"{name}_tables.csv"):
        result.tables.setdefault(row["class"], []).append(row["entry"])
    for row in _rows(ABI / "variants" / f"{name}_names.csv"):
        names = result.stored if row["where"] == "stored" else result.shown
        names.setdefault(row["class"], []).append(row["name"])
    return result


def known() -> list[Interface]:
    """Return the variants that the plugin knows."""
    result = [_read(path.name.split("_")[0]) for path in sorted((ABI / "variants").glob("*_members.csv"))]
    for row in _rows(ABI / "known_binaries.csv"):
        for one in result:
            if one.name == row["variant"]:
                one.binaries.append(f"YADE {row['version']} of {row['release']}")
    return result


def known_binary(build_ids: dict[str, str]) -> str | None:
    """Return the name of the binary with these identifiers."""
    for row in _rows(ABI / "known_binaries.csv"):
        if all(row[library.removesuffix(".so")] == identifier for library, identifier in build_ids.items()):
            return f"YADE {row['version']} of {row['release']}"
    return None


def differences(measured: Interface, reference: Interface) -> list[str]:
    """Return sentences on differences of the measured interface from the reference."""
    result = []
    for name, size in reference.sizes.items():
        found = measured.sizes.get(name)
        if found != size:
            result.append(f"size of {name}: {found} bytes, {size} in {reference.name}")
    for name, table in reference.tables.items():
        found_table = measured.tables.get(name, [])
        if found_table == table:
            continue
        if len(found_table) != len(table):
            result.append(f"table of {name}: {len(found_table)} entries, {len(table)} in {reference.name}")
        new, gone = set(found_table) - set(table), set(table) - set(found_table)
        result += [f"table of {name}: new entry {found_table.index(one)}, {one}" for one in sorted(new)]
        result += [f"table of {name}: without {one}, entry {table.index(one)} in {reference.name}"
                   for one in sorted(gone)]
        if not new and not gone and len(found_table) == len(table):
            result.append(f"table of {name}: another order")
    result += _other_names("stored attributes", measured.stored, reference.stored)
    if measured.running:
        for (name, member), place in reference.members.items():
            found_place = measured.members.get((name, member))
            if found_place != place:
                says = f"at {found_place[0]}, {found_place[1]}" if found_place else "not found"
                result.append(f"{name}.{member}: {says}; at {place[0]}, {place[1]} in {reference.name}")
        result += _other_names("attributes in Python", measured.shown, reference.shown)
    return result


def _other_names(what: str, measured: dict[str, list[str]], reference: dict[str, list[str]]) -> list[str]:
    result = []
    for name, names in reference.items():
        new, gone = set(measured.get(name, [])) - set(names), set(names) - set(measured.get(name, []))
        if new:
            result.append(f"{what} of {name}: new {', '.join(sorted(new))}")
        if gone:
            result.append(f"{what} of {name}: without {', '.join(sorted(gone))}")
    return result


def write(measured: Interface, like: Interface, folder: Path) -> None:
    """Write the three tables of an interface variant; classes and members are those of a known variant."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "measured_members.csv").open("w", newline="") as file:
        members = csv.DictWriter(file, _MEMBERS, lineterminator="\n")
        members.writeheader()
        for row in _rows(ABI / "variants" / f"{like.name}_members.csv"):
            key = (row["class"], row["member"])
            if not row["member"] and row["seen_by"] == "allocation":
                row["size_bytes"] = str(measured.sizes.get(row["class"], ""))
            elif row["member"] and measured.running:
                place = measured.members.get(key)
                row["offset_bytes"], row["type"] = (str(place[0]), place[1]) if place else ("", "")
            members.writerow(row)
    with (folder / "measured_tables.csv").open("w", newline="") as file:
        tables = csv.writer(file, lineterminator="\n")
        tables.writerow(["class", "place", "entry"])
        tables.writerows([name, i, entry] for name, table in measured.tables.items() for i, entry in enumerate(table))
    with (folder / "measured_names.csv").open("w", newline="") as file:
        attributes = csv.writer(file, lineterminator="\n")
        attributes.writerow(["class", "where", "name"])
        for where, names in (("stored", measured.stored), ("shown", measured.shown)):
            attributes.writerows([name, where, one] for name, found in names.items() for one in found)
