# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the reference pages of definitions: the keys of case files, and the table of symbols with links."""
from __future__ import annotations

import re
import xml.etree.ElementTree as xml
from importlib import import_module
from pathlib import Path
from typing import Any, Iterator

from statejump import _engine, kinds
from statejump.core.units import unit_of
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.joints import JOINTS
from statejump.schema import json_schema as schema

# Names of the table of symbols that are YADE's own, or say in words how to get a value.
YADES_OWN = {"young", "poisson", "frictionAngle", "state.pos", "kn", "ks", "shearForce", "state.mass"}


def heading(text: str, mark: str) -> str:
    """Return a heading of a page."""
    return f"{text}\n{mark * len(text)}\n"


def sections(name: str) -> Iterator[tuple[str, dict[str, Any], bool]]:
    """Yield the sections of a kind of file: name, schema, and whether the section is a list of tables."""
    for section, found in schema.schema(name)["properties"].items():
        yield section, found.get("items", found), "items" in found


def _escaped(text: str) -> str:
    return re.sub(r"([*|`\\]|_(?=\W|$))", r"\\\1", text)


def keys_page() -> str:
    """Return the page of all keys of case and campaign files, made from the schemas."""
    lines = [heading("Keys of case files", "="), "Units are in the names; values in brackets are units.\n"]
    for name in schema.names():
        if name == schema.ANY:
            continue
        lines += [heading(name, "-"), _escaped(schema.schema(name)["description"]) + "\n"]
        for section, found, is_list in sections(name):
            lines += [heading(f"[[{section}]]" if is_list else f"[{section}]", "~"),
                      _escaped(found["description"]) + "\n"]
            for key, described in found["properties"].items():
                lines += [f".. _key-{name}-{section}-{key}:\n", f".. object:: {section}.{key}\n",
                          f"   {_escaped(described['description'])}\n"]
    return "\n".join(lines)


def key_targets() -> dict[str, list[tuple[str, str]]]:
    """Return where each key is described: its name to (shown, label)."""
    found: dict[str, list[tuple[str, str]]] = {}
    for name in schema.names():
        if name == schema.ANY:
            continue
        for section, content, _ in sections(name):
            for key in content["properties"]:
                place = (f"{name} {section}", f"key-{name}-{section}-{key}".lower())
                found.setdefault(key, []).append(place)
                found.setdefault(f"{section}.{key}", []).append(place)
    return found


def cpp_targets(members: Path) -> dict[str, list[str]]:
    """Return the qualified names of all C++ members by their last part. Members of templates are left out: Sphinx finds
    them only by their arguments, and they repeat documentation from elsewhere."""
    found: dict[str, list[str]] = {}
    for compound in xml.parse(members / "index.xml").getroot():
        if compound.get("kind") not in ("class", "struct", "namespace"):
            continue
        scope = compound.findtext("name") or ""
        if "<" in scope:
            continue
        details = xml.parse(members / f"{compound.get('refid')}.xml").getroot()
        if details.find("compounddef/templateparamlist") is not None:
            continue
        for member in compound.findall("member"):
            name = member.findtext("name") or ""
            entry = f"{scope}::{name}"
            role = {"function": "func", "variable": "member"}.get(member.get("kind") or "")
            if role and f"{role} {entry}" not in found.setdefault(name, []):
                found[name].append(f"{role} {entry}")
    return found


def yade_targets(page: str) -> dict[str, list[str]]:
    """Return the classes that have each attribute of the plugin, read from the page of classes."""
    found: dict[str, list[str]] = {}
    current = ""
    for kind, name in re.findall(r"\.\. py:(class|attribute|function):: (\w+)", page):
        if kind == "class":
            current = name
        if kind == "attribute":
            found.setdefault(name, []).append(f"{current}.{name}")
        else:
            found.setdefault(name, []).append(name)
    return found


def _rows(text: str) -> Iterator[list[list[str]]]:
    """Yield the rows of the tables of docs/reference/symbols.md: cells."""
    table: list[list[str]] = []
    for line in [*text.splitlines(), ""]:
        if line.startswith("|"):
            cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            if not set("".join(cells)) <= set("-|"):
                table.append(cells)
        elif table:
            yield table
            table = []


def symbols_page(document: str, members: Path, yade_page: str) -> str:
    """Return the tables of docs/reference/symbols.md with a link from every name to its documentation.

    :raises SystemExit: a name has no documentation
    """
    keys, cpp, yade = key_targets(), cpp_targets(members), yade_targets(yade_page)
    lost: list[str] = []

    def linked(name: str, column: int) -> str:
        plain = name.split("(")[0]
        if column == 3 and plain in keys:
            return ", ".join(f":ref:`{shown} <{label}>`" for shown, label in keys[plain])
        entries = [entry for entry in cpp.get(plain.rpartition("::")[2], []) if entry.endswith(plain)]
        if column == 4 and entries:
            return ", ".join(f":cpp:{role}:`{found.removeprefix('statejump::')} <{found}>`"
                             for role, found in map(str.split, entries))
        last = plain.rsplit(".", 1)[-1]
        matching = [target for target in yade.get(last, []) if target == plain or target.endswith("." + last)]
        if plain.count(".") and plain in matching:
            matching = [plain]
        if column == 5 and matching:
            return ", ".join(f":py:obj:`{target} <statejump_yade.{target}>`" for target in matching)
        if name not in YADES_OWN and column != 3:
            lost.append(f"{name} (column {column})")
        return ""

    # Names of histories and of the engine's Python module, which no table of keys holds.
    columns = history_columns()
    lines = [heading("Where each name is documented", "="),
             "The names of the :doc:`table of symbols </docs/reference/symbols>`.\n"]
    for table in _rows(document):
        for cells in table[1:]:
            title = re.sub(r"\\\|", "|", cells[0])
            lines.append(f".. rubric:: {_escaped(title)}: {_escaped(cells[1])} [{_escaped(cells[2])}]\n")
            for column in range(3, len(cells)):
                for name in re.findall(r"`([^`]+)`", cells[column]):
                    target = linked(name, column)
                    if not target and column == 3:
                        if name not in columns and not name.endswith("_m"):
                            lost.append(f"{name} (column 3)")
                        target = "column of histories, argument of the engine's module"
                    lines.append(f"- ``{name}``: {target or 'of YADE itself'}")
            lines.append("")
    if lost:
        raise SystemExit("docs/reference/symbols.md has names that are documented nowhere: " + ", ".join(lost))
    return "\n".join(lines)


def columns_page() -> str:
    """Return the page of the columns of histories, by kind of case, with the units that end the column names."""
    lines = [heading("Columns of histories", "="),
             "The columns of ``*_history.csv`` and of ``Run.frame()``, in their order; the unit ends the name. What "
             "belongs to several items has the item's name in brackets, a vector its axis behind them: "
             "``displacement_m[J].x``. "
             "All places of a result file: :doc:`/docs/reference/result_file`.\n"]
    for name in kinds.names():
        columns = kinds.kind(name).COLUMNS
        if columns:
            lines += [heading(name, "-"), ".. list-table::\n   :header-rows: 1\n\n   * - column\n     - unit",
                      *(f"   * - ``{column}``\n     - {unit_of(column)}" for column in columns), ""]
    return "\n".join(lines)


def history_columns() -> set[str]:
    """Return the names of columns and arguments that the docstrings of the engine's modules contain."""
    found = {column for name in kinds.names() for column in kinds.kind(name).COLUMNS}
    found.update(column.name for joint in JOINTS for column in joint.columns)
    found.update(column.name for element in ELEMENTS for column in element.columns)
    for value in (*vars(_engine).values(), *vars(import_module("statejump._engine_more")).values()):
        inner = vars(value) if isinstance(value, type) else {}
        found.update(inner)
        for documented in (value, *inner.values()):
            found.update(re.findall(r"\w+", getattr(documented, "__doc__", "") or ""))
    return found
