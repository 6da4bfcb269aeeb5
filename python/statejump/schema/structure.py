# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of a parsed TOML document to sections. A failure names its section and key."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from statejump.core.errors import MissingKey, NotAllowed, UnknownKey
from statejump.schema.fields import READ, Section, SectionType, fields_of, is_required, rule_of, section_of, tables_of
from statejump.schema.items import read_tables
from statejump.schema.rules import suggestion


def structure(model: type[SectionType], data: Mapping[str, Any]) -> SectionType:
    """Return the sections of a parsed TOML document.

    An unknown key is reported before a missing key, because a misspelt key is both unknown and missing.

    :param model: class of the file, whose fields are sections and lists of tables
    :raises StatejumpError: the first failure, without the file's name
    """
    wanted = fields_of(model)
    for name in data:
        if name not in wanted:
            raise UnknownKey(name, section=f"section [{name}]", **suggestion(name, list(wanted), "[", "]"))
        keys = section_of(wanted[name])
        if keys is not None and isinstance(data[name], Mapping):
            _refuse_unknown(name, keys, data[name])
    for name, attribute in wanted.items():
        if name not in data:
            if is_required(attribute):
                brackets = "[[{}]]" if tables_of(attribute) else "[{}]"
                raise MissingKey(name, section=f"section {brackets.format(name)}")
            continue
        keys = section_of(attribute)
        if keys is not None and isinstance(data[name], Mapping):
            _refuse_missing(name, keys, data[name])
    made: dict[str, Any] = {}
    for name, attribute in wanted.items():
        if name not in data:
            continue
        item, keys = tables_of(attribute), section_of(attribute)
        if item is not None:
            read = attribute.metadata[READ]
            made[name] = read(name, data[name]) if read else read_tables(item, name, data[name])
        elif keys is not None:
            if data[name] is None and attribute.default is None:
                continue  # as to_dict() has it
            if not isinstance(data[name], Mapping):
                raise NotAllowed(name, data[name], code="not_section", wanted=name)
            made[name] = _section(keys, name, data[name])
    return model(**made)


def _refuse_unknown(name: str, keys: type[Section], given: Mapping[str, Any]) -> None:
    known = fields_of(keys)
    for key in given:
        if key not in known:
            raise UnknownKey(f"{name}.{key}", **suggestion(key, list(known), f"{name}.", ""))


def _refuse_missing(name: str, keys: type[Section], given: Mapping[str, Any]) -> None:
    for key, attribute in fields_of(keys).items():
        if key not in given and is_required(attribute):
            raise MissingKey(f"{name}.{key}", rule_of(attribute).needs(), allowed=rule_of(attribute).allowed)


def _section(keys: type[SectionType], name: str, given: Mapping[str, Any]) -> SectionType:
    try:
        return keys(**given)
    except NotAllowed as refused:
        assert refused.key is not None
        refused.value = given.get(refused.key, refused.value)  # as written in the file: 1, not 1.0
        refused.key = f"{name}.{refused.key}"
        raise
