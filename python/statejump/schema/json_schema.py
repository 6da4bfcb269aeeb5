# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON Schema of case and campaign files, for editors and for programs that write such files.

The schemas are generated from the definitions that check the files (:mod:`statejump.schema.fields` and the kinds), so
units, ranges, names, defaults and sources are written once. A schema describes every key by itself, and the keys that a
choice requires. It cannot describe conditions between numbers, or that ``1.0`` is not an integer and ``nan`` not a
number. These are checked when a file is read.
"""
from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from statejump import _paths, kinds
from statejump.campaign.campaign_file import FILES
from statejump.design.file import DesignFile
from statejump.core.errors import Range
from statejump.core.output import write_atomically
from statejump.kinds.protocol import Kind
from statejump.schema.fields import (
    TABLES_BESIDE, Section, default_of, fields_of, is_required, rule_of, section_of, tables_of,
)
from statejump.schema.items import Item
from statejump.schema.rules import ATTACHED, NUMBERS, SWITCH, TEXT, TEXTS, WHOLE, Rule, check_name

DRAFT = "http://json-schema.org/draft-07/schema#"
ANY = "case"
DESIGN = "design"
Schema = dict[str, Any]


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _described(attribute: Any) -> Schema:
    """Return the text that an editor shows for a key: its rule, its default and the source of the default."""
    rule = rule_of(attribute)
    source = rule.source
    # The source of a free text describes its purpose.
    is_free = rule.form == TEXT and rule.known is None
    parts = ["true or false" if rule.form == SWITCH else rule.needs()] if not is_free else []
    found: Schema = {}
    if is_required(attribute):
        parts.append(f"Required ({source})" if source else "Required")
    elif default_of(attribute) in (None, "", []):
        parts.append(f"Optional: {source}" if source else "Optional")
    else:
        found["default"] = default_of(attribute)
        parts.append(f"Default {json.dumps(found['default'])}" + (f" ({source})" if source else ""))
    found["description"] = ". ".join(map(_sentence, parts)) + "."
    if rule.unit is not None:
        found["x-unit"] = rule.unit
    found["x-source"] = source
    return found


def _number(allowed: Range, form: str) -> Schema:
    found: Schema = {"type": "integer" if form == WHOLE else "number"}
    if math.isfinite(allowed.low):
        found["exclusiveMinimum" if allowed.above else "minimum"] = allowed.low
    if math.isfinite(allowed.high):
        found["maximum"] = allowed.high
    return found


def _text(rule: Rule) -> Schema:
    found: Schema = {"type": "string"}
    if rule.known is not None:
        found["enum"] = list(rule.names)
    if rule.expression is not None:
        found["pattern"] = f"^{rule.expression}$"
    return found


def key_schema(attribute: Any) -> Schema:
    """Return the schema of one key of a section.

    :param attribute: declaration of the key, a value of :func:`statejump.schema.fields.fields_of`
    """
    rule = rule_of(attribute)
    if rule.form == SWITCH:
        found: Schema = {"type": "boolean"}
    else:
        item = _text(rule) if rule.allowed is None else _number(rule.allowed, rule.form)
        found = {"type": "array", "items": item} if rule.form in (NUMBERS, TEXTS) else item
    if rule.length is not None:
        found.update(minItems=rule.length, maxItems=rule.length)
    return found | _described(attribute)


def _conditions(model: type[Section]) -> list[Schema]:
    """Return schema conditions on the keys that a choice in a section requires or refuses, see ``Section.GOES_WITH``
    and ``Section.ONE_OF``."""
    found = []
    for choice, keys in model.GOES_WITH.items():
        for name in rule_of(fields_of(model)[choice]).names:
            needed = [key for key, names in keys.items() if name in names]
            refused = [key for key, names in keys.items() if name not in names]
            then: Schema = {}
            if needed:
                then["required"] = needed
            if refused:
                then["properties"] = {key: False for key in refused}
            selected = {"properties": {choice: {"const": name}}, "required": [choice]}
            found.append({"if": selected, "then": then})
    for choice, groups_of in model.ONE_OF.items():
        for name in rule_of(fields_of(model)[choice]).names:
            selected = {"properties": {choice: {"const": name}}, "required": [choice]}
            every = {key: False for groups in groups_of.values() for group in groups for key in group}
            groups = groups_of.get(name, ())
            then = {"anyOf": [{"required": list(group)} for group in groups]} if groups else {"properties": every}
            found.append({"if": selected, "then": then})
    return found


def section_schema(model: type[Section]) -> Schema:
    """Return the schema of a section: its keys and no others."""
    keys = {key: attribute for key, attribute in fields_of(model).items() if rule_of(attribute).form != ATTACHED}
    properties = {key: key_schema(attribute) for key, attribute in keys.items()}
    if issubclass(model, Item):
        properties["name"]["minLength"] = 1
    found: Schema = {
        "type": "object",
        "description": " ".join((model.__doc__ or "").split()),
        "properties": properties,
        "required": [key for key, attribute in keys.items() if is_required(attribute)],
        "additionalProperties": False,
    }
    conditions = _conditions(model)
    if conditions:
        found["allOf"] = conditions
    return found


def _part(attribute: Any) -> Schema:
    """Return the schema for a section or list at the top level of a file."""
    section, table = section_of(attribute), tables_of(attribute)
    if table is not None:
        item = section_schema(table)
        return {"type": "array", "items": item, "minItems": 1, "description": item["description"]}
    assert section is not None
    return section_schema(section)


def _file(model: type[Section], title: str, leave_out: Iterable[str] = ()) -> Schema:
    parts = {name: attribute for name, attribute in fields_of(model).items() if name not in leave_out}
    # A list that may be in a file beside the case is not required in the case. Reading the case reports a missing one.
    tables = section_of(parts[TABLES_BESIDE]) if TABLES_BESIDE in parts else None
    beside = fields_of(tables) if tables is not None else {}
    return {
        "title": title,
        "description": " ".join((model.__doc__ or "").split()),
        "type": "object",
        "properties": {name: _part(attribute) for name, attribute in parts.items()},
        "required": [name for name, attribute in parts.items() if is_required(attribute) and name not in beside],
        "additionalProperties": False,
    }


def _kind(kind: Kind) -> Schema:
    found = _file(kind.Case, f"statejump case of kind {kind.name}", kind.Case.NOT_IN_FILE)
    found["properties"]["case"]["properties"]["kind"].update(const=kind.name)
    return found


def _any_case(known: list[str], alone: bool) -> Schema:
    """Return the schema for case files of every kind.

    :param alone: whether to include the schemas of the kinds instead of references to their files
    """
    found: Schema = {
        "title": "statejump case",
        "description": "A case file of any kind; case.kind says which.",
        "type": "object",
        "properties": {"case": {
            "type": "object", "properties": {"kind": {"type": "string", "enum": known}}, "required": ["kind"],
        }},
        "required": ["case"],
        "allOf": [
            {
                "if": {"properties": {"case": {"properties": {"kind": {"const": kind}}, "required": ["kind"]}},
                       "required": ["case"]},
                "then": {"$ref": f"#/definitions/{kind}" if alone else file_name(kind)},
            }
            for kind in known
        ],
    }
    if alone:
        found["definitions"] = {name: _kind(kinds.kind(name)) for name in known}
    return found


def names() -> list[str]:
    """Return the names of all schemas: ``case``, the kinds of cases, the kinds of campaigns, and ``design``."""
    return [ANY, *kinds.names(), *FILES, DESIGN]


def schema(name: str = ANY, alone: bool = True) -> Schema:
    """Return a schema as a dict for json.

    :param name: one of :func:`names`; ``case`` accepts case files of every kind
    :param alone: whether ``case`` includes the schemas of the kinds; otherwise it refers to their files in its folder
    :raises StatejumpError: there is no schema with this name
    """
    check_name("KIND", name, names())
    if name == ANY:
        found = _any_case(kinds.names(), alone)
    elif name in FILES:
        found = _file(FILES[name], f"statejump {name} campaign")
    elif name == DESIGN:
        found = _file(DesignFile, "statejump design file")
    else:
        found = _kind(kinds.kind(name))
    return {"$schema": DRAFT, **found}


def to_json(found: Schema) -> str:
    """Return a schema as the text of its file."""
    return json.dumps(found, indent=1, ensure_ascii=False) + "\n"


def file_name(name: str) -> str:
    """Return the name of the published file of a schema."""
    return f"{name}.schema.json"


def write_all(folder: Path) -> list[Path]:
    """Write every schema into a file of its own in a folder, and return the paths."""
    written = []
    for name in names():
        with write_atomically(folder / file_name(name)) as stream:
            stream.write(to_json(schema(name, alone=False)))
        written.append(folder / file_name(name))
    return written


def head_line(name: str, file: Path) -> str:
    """Return the first line of a case file by which editors (taplo, Even Better TOML) find its schema.

    :param name: name of the schema
    :param file: case file that gets the line; if it is in the same folder tree as the schema, the reference is relative
    """
    to, file = (_paths.SCHEMA / file_name(name)).resolve(), file.resolve()
    if _paths.SCHEMA.resolve().parent in file.parents:
        return f"#:schema {Path(os.path.relpath(to, file.parent)).as_posix()}"
    return f"#:schema {to.as_uri()}"
