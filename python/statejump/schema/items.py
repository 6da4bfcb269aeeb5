# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists of tables in case files, [[node]] and the like: items with a name, checked one by one.

An item is declared like any section. pydantic is only asked for the declarations: a truss of 10 000
joints has some 100 000 items, each of which it would take a tenth of a millisecond to judge.
"""
from __future__ import annotations

from math import inf
from typing import Any, Sequence, TypeVar

from pydantic import Field
from pydantic.fields import ModelField

from statejump.schema.fields import Section, check_value, rule, shown, suggestion

ItemType = TypeVar("ItemType", bound="Item")


class Item(Section):
    """One table of a list of tables. It has a name, by which messages call it."""

    class Config:
        copy_on_model_validation = "none"

    name: str = Field(..., description="by which other tables and messages call it")


class TableError(ValueError):
    """A whole sentence about one item; ``case_schema`` shows it as it is."""


def tables(default: Any, source: str) -> Any:
    """Return the pydantic field of a list of tables.

    :param default: ``...`` when at least one table is needed, else ``[]``
    :param source: what the tables are
    """
    return Field(default, tables=True, description=source)


def texts(default: Any, source: str, names: Sequence[str] = ()) -> Any:
    """Return the pydantic field of a list of texts, of given names if any are given."""
    return Field(default, texts=True, description=source, **({"names": tuple(names)} if names else {}))


def numbers(default: Any, unit: str, low: float, high: float, source: str, **more: Any) -> Any:
    """Return the pydantic field of a list of numbers, each within the range; ``length``: how many."""
    return Field(default, unit=unit, low=low, high=high, above=False, listed=True, description=source, **more)


def is_tables(field: ModelField) -> bool:
    """Whether a field of a case is a list of tables."""
    return bool(field.field_info.extra.get("tables"))


def where(section: str, table: Any, number: int) -> str:
    """Return how messages call an item: by its name, by its number while it has none."""
    name = table.get("name") if isinstance(table, dict) else None
    return f"{section} {name!r}" if isinstance(name, str) and name else f"{section} {number}"


def read_tables(model: type[ItemType], section: str, value: Any) -> list[ItemType]:
    """Return the items of a list of tables, else raise TableError with one sentence.

    :param model: what an item is
    :param section: name of the list
    :param value: what tomllib returned for it
    """
    if not isinstance(value, list) or not value or not all(isinstance(table, dict) for table in value):
        given = section if isinstance(value, (list, dict)) else f"{section} = {shown(value)}"
        raise TableError(f"{given} is not allowed: must be one or more sections [[{section}]]")
    fields = model.__fields__
    defaults = {key: field.default for key, field in fields.items() if not field.required}
    needed = [key for key, field in fields.items() if field.required]
    # A number that is one and in its range needs no more than a comparison.
    ranges = {
        key: (field.field_info.extra["low"], field.field_info.extra["high"], field.field_info.extra["above"])
        for key, field in fields.items()
        if field.type_ is float and "low" in field.field_info.extra and not field.field_info.extra.get("listed")
    }
    items = []
    for number, table in enumerate(value, start=1):
        values = dict(defaults)
        for key, given in table.items():
            low, high, above = ranges.get(key, (inf, -inf, True))
            if type(given) is float and low <= given <= high and not (above and given == low):
                values[key] = given
                continue
            field = fields.get(key)
            if field is None:
                hint = suggestion(key, list(fields), "", "")
                raise TableError(f"{where(section, table, number)}: {key} is unknown: {hint}")
            try:
                checked = check_value(given, field.field_info.extra, field.type_)
                if key == "name" and not checked:
                    raise ValueError("must be a text in quotes that is not empty")
            except ValueError as reason:
                raise TableError(
                    f"{where(section, table, number)}: {key} = {shown(given)} is not allowed: {reason}"
                ) from None
            values[key] = float(checked) if field.type_ is float and type(checked) is int else checked
        for key in needed:
            if key not in table:
                needs = rule(fields[key].field_info.extra)
                raise TableError(f"{where(section, table, number)}: {key} is missing: {needs}")
        # As BaseModel.construct does, which takes several times as long.
        item = model.__new__(model)
        object.__setattr__(item, "__dict__", values)
        object.__setattr__(item, "__fields_set__", set(table))
        items.append(item)
    return items
