# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths of keys: ``section.key`` as in a case file, ``section.item.key`` for one item of a list of tables,
``section.*.key`` for all its items, ``section.joint*.key`` for matching items. Names of items may contain dots, because
the key follows the last dot."""
from __future__ import annotations

import warnings
from collections.abc import Collection, Iterable, Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Any

import attrs
import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError, UnknownKey
from statejump.core.notes import Note
from statejump.schema.fields import Section, SectionType, evolved, fields_of, rule_of, section_of, tables_of
from statejump.schema.rules import ATTACHED, suggestion

EVERY = "*"


def split_path(path: str) -> tuple[str, str, str]:
    """Split a path into section, item ("" if the section is not a list) and key."""
    section, _, rest = path.partition(".")
    item, _, key = rest.rpartition(".")
    return section, item, key


def meant(item: str, names: Collection[str]) -> list[str]:
    """Return the names that the item of a path means: itself if it is a name, otherwise all names that match it."""
    return [item] if item in names else [name for name in names if fnmatchcase(name, item)]


def plain(value: Any) -> Any:
    """Convert numbers and arrays of numpy to numbers and lists of Python, also inside lists and dicts."""
    if isinstance(value, Mapping):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    return value.tolist() if isinstance(value, (np.generic, np.ndarray)) else value


def keys_of(model: type[Section]) -> dict[str, attrs.Attribute[Any]]:
    """Return every key of a kind of case by its path. The path of a key of items is ``section.*.key``."""
    found = {}
    for name, attribute in fields_of(model).items():
        item = tables_of(attribute)
        keys = item or section_of(attribute)
        for key, inner in fields_of(keys).items() if keys else ():
            if rule_of(inner).form == ATTACHED:
                continue
            found[f"{name}.{EVERY}.{key}" if item else f"{name}.{key}"] = inner
    return found


def pattern_of(path: str) -> str:
    """Return a path with ``*`` for the name of its item."""
    section, item, key = split_path(path)
    return f"{section}.{EVERY}.{key}" if item else path


def current(model: type[Section], path: str, file: str = "") -> str:
    """Return the present path of a key. If the given path is a former one, also emit a :class:`FutureWarning`.

    :param file: name of the file with the key, for the warning
    """
    now: str | None = model.MOVED.get(path)
    if now is None:
        return path
    where = f"{file}: " if file else ""
    warnings.warn(Note("key_moved", where=where, path=path, now=now), FutureWarning, stacklevel=2)
    return now


def with_keys_moved(model: type[Section], data: Mapping[str, Any], file: str = "") -> Mapping[str, Any]:
    """Return a parsed case file with every key at its present path instead of a former one.

    :param file: name of the file, for warnings
    :raises NotAllowed: a key has a value both at its former and at its present path
    """
    for old in model.MOVED:
        section, _, key = split_path(old)
        part = data.get(section)
        if not isinstance(part, Mapping) or key not in part:
            continue
        now = current(model, old, file)
        there, _, name = split_path(now)
        target = data.get(there, {})
        if not isinstance(target, Mapping):
            continue  # reading the section reports the fault
        if name in target:
            raise NotAllowed(old, part[key], code="deprecated_key_duplicated", new_key=now, old_key=old)
        data = {**data, section: {name: value for name, value in part.items() if name != key}}
        data[there] = {**data.get(there, {}), name: part[key]}  # which may be the same section
    return data


def attribute_of(model: type[Section], path: str) -> attrs.Attribute[Any]:
    """Return the declaration of a key. :raises UnknownKey: there is none"""
    known, pattern = keys_of(model), pattern_of(path)
    if pattern not in known:
        now = model.MOVED.get(path)
        renamed = {"code": "key_renamed", "now": str(now)}
        raise UnknownKey(path, **(suggestion(path, list(known)) if now is None else renamed))
    return known[pattern]


def set_value(model: type[Section], data: dict[str, Any], path: str, value: Any) -> None:
    """Set the value of a key in a parsed case file. None removes the key, so that its default applies.

    :raises UnknownKey: the key or the item does not exist
    """
    path = current(model, path)
    attribute_of(model, path)
    section, item, key = split_path(path)
    if not item:
        targets = [data.setdefault(section, {})]
    else:
        tables = data.get(section, [])
        names = [str(table.get("name")) for table in tables]
        wanted = set(meant(item, names))
        targets = [table for table, name in zip(tables, names) if name in wanted]
        if not targets:
            raise UnknownKey(path, **_no_item(section, item, key, names))
    value = plain(value)
    for target in targets:
        if value is None:
            target.pop(key, None)
        else:
            target[key] = value


def _no_item(section: str, item: str, key: str, names: Sequence[str]) -> dict[str, Any]:
    """Return the fields of an UnknownKey error about an item that does not exist."""
    if not names:
        return {"code": "section_not_in_case", "table": section}
    if any(sign in item for sign in "*?["):
        known = ", ".join(names[:5]) + (", ..." if len(names) > 5 else "")
        return {"code": "no_item_fits", "table": section, "pattern": item, "known": known}
    return suggestion(item, names, f"{section}.", f".{key}")


def filled(data: Mapping[str, Any], values: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Return a copy of a parsed case file with many other values. A pattern sets the value in every matching item.

    :param values: pairs of path and value; the caller must know that the case has these paths
    """
    changed: dict[str, Any] = {
        section: [dict(table) for table in content] if isinstance(content, list) else dict(content)
        for section, content in data.items()
    }
    places: dict[str, dict[str, int]] = {}
    for path, value in values:
        section, item, key = split_path(path)
        if not item:
            changed.setdefault(section, {})[key] = value
            continue
        tables = changed[section]
        if section not in places:
            places[section] = {table["name"]: place for place, table in enumerate(tables)}
        targets = tables if item == EVERY else [tables[places[section][name]] for name in meant(item, places[section])]
        for table in targets:
            table[key] = value
    return changed


def value_of(case: Section, path: str) -> Any:
    """Return the value of a key of a case. :raises UnknownKey: the key or the item does not exist

    :raises StatejumpError: a pattern matches items with several values
    """
    path = current(type(case), path)
    attribute_of(type(case), path)
    section, item, key = split_path(path)
    if not item:
        return getattr(case.value_named(section), key)
    items = case.value_named(section)
    names = [one.name for one in items]
    wanted = set(meant(item, names))
    found = [getattr(one, key) for one in items if one.name in wanted]
    if not found:
        raise UnknownKey(path, **_no_item(section, item, key, names))
    if any(value != found[0] for value in found):
        raise StatejumpError(code="several_values", key=path, path=path)
    return found[0]


def with_values(case: SectionType, changes: Mapping[str, Any]) -> SectionType:
    """Return a case with other values. Each value is checked against its rule, but the case is not checked as a whole,
    because a study may use values that no case file would have.

    :param changes: values by ``section.key``; keys of lists of tables cannot be changed
    :raises NotAllowed: a value violates its rule
    """
    sections: dict[str, dict[str, Any]] = {}
    for path, value in changes.items():
        section, _, key = path.partition(".")
        sections.setdefault(section, {})[key] = value
    made = {}
    for section, values in sections.items():
        try:
            made[section] = evolved(case.value_named(section), **values)
        except NotAllowed as refused:
            refused.key = f"{section}.{refused.key}"
            raise
    return evolved(case, **made)
