# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON Schema of case and campaign files, for editors and for programs that write such files.

Generated from the definitions that check the files (:mod:`statejump.schema.fields` and the kinds), so that
units, ranges, names, defaults and their sources are written down once. A schema says what is right of
every key by itself and which keys go with which choice. It cannot say what is wrong between numbers, that
``1.0`` is no whole number, nor that ``nan`` is no number: reading the file does.
"""
from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any

import click
from pydantic.fields import ModelField

from statejump import _paths
from statejump.campaign import campaign_file
from statejump.kinds.registry import KINDS
from statejump.schema.fields import Case, Section, check_name, rule
from statejump.schema.items import Item
from statejump.core.errors import StatejumpError
from statejump.core.output import write_atomically

DRAFT = "http://json-schema.org/draft-07/schema#"
ANY = "case"
Schema = dict[str, Any]


def _is_section(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, Section)


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _described(field: ModelField) -> Schema:
    """What a person reads when the editor points at a key: rule, default and where it comes from."""
    info = field.field_info
    source = info.description or ""
    if field.type_ is bool:
        parts = ["true or false"]
    else:  # what a free text is for is said by its source
        parts = [rule(info.extra)] if {"low", "names", "texts"} & info.extra.keys() else []
    found: Schema = {}
    if field.required:
        parts.append(f"Required ({source})" if source else "Required")
    elif field.default in (None, "", []):
        parts.append(f"Optional: {source}" if source else "Optional")
    else:
        found["default"] = field.default
        parts.append(f"Default {json.dumps(field.default)}" + (f" ({source})" if source else ""))
    found["description"] = ". ".join(map(_sentence, parts)) + "."
    if "unit" in info.extra:
        found["x-unit"] = info.extra["unit"]
    found["x-source"] = source
    return found


def _number(extra: dict[str, Any], kind: Any) -> Schema:
    found: Schema = {"type": "integer" if kind is int else "number"}
    if math.isfinite(extra["low"]):
        found["exclusiveMinimum" if extra["above"] else "minimum"] = extra["low"]
    if math.isfinite(extra["high"]):
        found["maximum"] = extra["high"]
    return found


def _text(extra: dict[str, Any]) -> Schema:
    found: Schema = {"type": "string"}
    if "names" in extra:
        found["enum"] = list(extra["names"])
    if "pattern" in extra:
        found["pattern"] = f"^{extra['pattern']}$"
    return found


def key_schema(field: ModelField) -> Schema:
    """Return the schema of one key of a section."""
    extra = field.field_info.extra
    if extra.get("texts"):
        found: Schema = {"type": "array", "items": _text(extra)}
    elif field.type_ is bool:
        found = {"type": "boolean"}
    elif "low" not in extra:
        found = _text(extra)
    elif extra.get("listed"):
        found = {"type": "array", "items": _number(extra, float)}
    else:
        found = _number(extra, field.type_)
    if "length" in extra:
        found.update(minItems=extra["length"], maxItems=extra["length"])
    return found | _described(field)


def _conditions(model: type[Section]) -> list[Schema]:
    """Keys that one choice of a section needs and the others refuse, see ``Section.GOES_WITH``."""
    found = []
    for choice, keys in model.GOES_WITH.items():
        for name in model.__fields__[choice].field_info.extra["names"]:
            needed = [key for key, names in keys.items() if name in names]
            refused = [key for key, names in keys.items() if name not in names]
            then: Schema = {}
            if needed:
                then["required"] = needed
            if refused:
                then["properties"] = {key: False for key in refused}
            selected = {"properties": {choice: {"const": name}}, "required": [choice]}
            found.append({"if": selected, "then": then})
    return found


def section_schema(model: type[Section]) -> Schema:
    """Return the schema of a section: its keys and no others."""
    properties = {key: key_schema(field) for key, field in model.__fields__.items()}
    if issubclass(model, Item):
        properties["name"]["minLength"] = 1
    found: Schema = {
        "type": "object",
        "description": " ".join((model.__doc__ or "").split()),
        "properties": properties,
        "required": [key for key, field in model.__fields__.items() if field.required],
        "additionalProperties": False,
    }
    conditions = _conditions(model)
    if conditions:
        found["allOf"] = conditions
    return found


def _part(field: ModelField) -> Schema:
    """Return the schema of what stands under one name at the top of a file."""
    tables = field.field_info.extra.get("tables")
    if not tables:
        return section_schema(field.type_)
    # Tables that code of their own judges declare their items beside the field.
    item = section_schema(tables if _is_section(tables) else field.type_)
    return {"type": "array", "items": item, "minItems": 1, "description": item["description"]}


def _file(model: type[Section], title: str, leave_out: tuple[str, ...] = ()) -> Schema:
    fields = {name: field for name, field in model.__fields__.items() if name not in leave_out}
    return {
        "title": title,
        "description": " ".join((model.__doc__ or "").split()),
        "type": "object",
        "properties": {name: _part(field) for name, field in fields.items()},
        "required": [name for name, field in fields.items() if field.required],
        "additionalProperties": False,
    }


def _kind(model: type[Case]) -> Schema:
    found = _file(model, f"statejump case of kind {model.KIND}", model.NOT_IN_FILE)
    found["properties"]["case"]["properties"]["kind"].update(const=model.KIND)
    return found


def _any_case() -> Schema:
    kinds = list(KINDS)
    return {
        "title": "statejump case",
        "description": "A case file of any kind; case.kind says which.",
        "type": "object",
        "properties": {"case": {
            "type": "object", "properties": {"kind": {"type": "string", "enum": kinds}}, "required": ["kind"],
        }},
        "required": ["case"],
        "allOf": [
            {
                "if": {"properties": {"case": {"properties": {"kind": {"const": kind}}, "required": ["kind"]}},
                       "required": ["case"]},
                "then": {"$ref": f"#/definitions/{kind}"},
            }
            for kind in kinds
        ],
        "definitions": {kind: _kind(KINDS[kind]) for kind in kinds},
    }


def names() -> list[str]:
    """Return the names of all schemas: ``case``, the kinds of cases and the kinds of campaigns."""
    return [ANY, *KINDS, *campaign_file.FILES]


def schema(name: str = ANY) -> Schema:
    """Return a schema as a document that json can write.

    :param name: one of :func:`names`; ``case`` takes case files of every kind
    :raises StatejumpError: there is no such schema
    """
    try:
        check_name(name, names())
    except ValueError as reason:
        raise StatejumpError(f"KIND = {name!r} is not allowed: {reason}") from None
    if name == ANY:
        found = _any_case()
    elif name in KINDS:
        found = _kind(KINDS[name])
    else:
        found = _file(campaign_file.FILES[name], f"statejump {name} campaign")
    return {"$schema": DRAFT, **found}


def to_json(found: Schema) -> str:
    """Return a schema as the text of its file."""
    return json.dumps(found, indent=1, ensure_ascii=False) + "\n"


def file_name(name: str) -> str:
    """Return the name of the published file of a schema."""
    return f"{name}.schema.json"


def head_line(name: str, file: Path) -> str:
    """Return the first line of a case file by which editors (taplo, Even Better TOML) find its schema.

    :param name: name of the schema
    :param file: where the line will be; files of one tree refer to each other relatively
    """
    to, file = (_paths.SCHEMA / file_name(name)).resolve(), file.resolve()
    if _paths.SCHEMA.resolve().parent in file.parents:
        return f"#:schema {Path(os.path.relpath(to, file.parent)).as_posix()}"
    return f"#:schema {to.as_uri()}"


@click.command("schema")
@click.argument("kind", metavar="[KIND]", default=ANY)
@click.option("-o", "--output", metavar="FILE", type=click.Path(path_type=Path), help="File to write instead.")
@click.option("--all", "folder", metavar="FOLDER", type=click.Path(path_type=Path, file_okay=False),
              help="Write every schema into a folder.")
def schema_command(kind: str, output: Path | None, folder: Path | None) -> None:
    """JSON Schema of case files of KIND, or of campaigns: case (every kind), spring_slider, umbrella,
    statics, truss, montecarlo, sweep.

    \b
    Examples:
      statejump schema truss
      statejump schema -o case.schema.json
    """
    if folder is not None:
        for name in names():
            with write_atomically(folder / file_name(name)) as stream:
                stream.write(to_json(schema(name)))
        return
    text = to_json(schema(kind))
    if output is None:
        click.echo(text, nl=False)
        return
    with write_atomically(output) as stream:
        stream.write(text)
