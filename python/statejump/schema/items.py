# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists of tables in case files, [[node]] and the like: items with a name, checked one by one."""
from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite
from typing import Any, TypeVar

from statejump.core.errors import ABSENT, MissingKey, NotAllowed, UnknownKey
from statejump.schema.fields import Section, default_of, definition, fields_of, is_required, rule_of, text
from statejump.schema.item_tables import ItemColumns, ItemTable, where
from statejump.schema.rules import NUMBER, NUMBERS, TEXT, TEXTS, suggestion

ItemType = TypeVar("ItemType", bound=Section)


@definition
class Item(Section):
    """One table of a list of tables. It has a name, by which messages call it."""

    name: str = text(..., "by which other tables and messages call it")

    def __attrs_post_init__(self) -> None:
        if not self.name:
            raise NotAllowed("name", self.name, code="empty_string")


def read_tables(model: type[ItemType], section: str, value: Any) -> Sequence[ItemType]:
    """Return the items of a list of tables, as they are given: one by one, or by columns.

    A truss of 10 000 joints has some 100 000 items. A number that is one and in its range is told by a
    comparison, and items are made without going through the checks of their class once more.

    :param model: what an item is
    :param section: name of the list
    :param value: what tomllib returned for it, or an :class:`~statejump.schema.item_tables.ItemTable`
    :raises StatejumpError: one failure, without the file's name
    """
    if isinstance(value, ItemTable):
        return ItemColumns(model, section, value)
    if not isinstance(value, list) or not value or not all(isinstance(table, dict) for table in value):
        given = ABSENT if isinstance(value, (list, dict)) else value
        raise NotAllowed(section, given, code="not_table_list", table=section)
    fields = fields_of(model)
    rules = {key: rule_of(field) for key, field in fields.items()}
    needed = [key for key, field in fields.items() if is_required(field)]
    optional = {key: field for key, field in fields.items() if not is_required(field)}
    ranges = {
        key: (rule.allowed.low, rule.allowed.high, rule.allowed.above)
        for key, rule in rules.items() if rule.form == NUMBER and rule.allowed is not None
    }
    lists = {
        key: (rule.allowed.low, rule.allowed.high, rule.length) for key, rule in rules.items()
        if rule.form == NUMBERS and rule.allowed is not None and not rule.allowed.above
    }
    free = {key for key, rule in rules.items() if rule.form == TEXT and rule.known is None and rule.expression is None}
    free_lists = {key for key, rule in rules.items() if rule.form == TEXTS and rule.known is None}
    # Of texts with rules of their own many items have the same: what a key took once, it takes again.
    taken: dict[str, set[str]] = {key: set() for key, rule in rules.items() if rule.form == TEXT and key not in free}
    set_value = object.__setattr__
    items = []
    for number, table in enumerate(value, start=1):
        values: dict[str, Any] = {}
        for key, given in table.items():
            if type(given) is float:
                low, high, above = ranges.get(key, (inf, -inf, True))
                if low <= given <= high and not (above and given == low):
                    values[key] = given
                    continue
            elif type(given) is str:
                if given in taken.get(key, ()) or key in free and given and given.isprintable():
                    values[key] = given
                    continue
            elif type(given) is list and key in lists and set(map(type, given)) == {float}:
                low, high, length = lists[key]
                # Of no number, wherever it stands, the sum tells.
                if low <= min(given) and max(given) <= high and isfinite(sum(given)) and length in (None, len(given)):
                    values[key] = given.copy()
                    continue
            elif type(given) is list and key in free_lists and set(map(type, given)) == {str}:
                values[key] = given.copy()
                continue
            field = fields.get(key)
            if field is None:
                raise UnknownKey(key, item=where(section, table, number), **suggestion(key, list(fields)))
            convert: Any = field.converter  # attrs gives it a type of its own, by its version
            converted = given if convert is None else convert(given)
            try:
                rules[key].check(key, converted)
                if key == "name" and not given:
                    raise NotAllowed(key, given, code="empty_string")
            except NotAllowed as refused:
                refused.value = given
                refused.item = where(section, table, number)
                raise
            values[key] = converted
            if type(given) is str and key in taken and converted is given:
                taken[key].add(given)
        for key in needed:
            if key not in table:
                raise MissingKey(key, rules[key].needs(), item=where(section, table, number),
                                 allowed=rules[key].allowed)
        item = model.__new__(model)
        # One by one and always in one order: then all items share the names of their keys, in a third of the memory.
        for key in fields:
            set_value(item, key, values[key] if key in values else default_of(optional[key]))
        items.append(item)
    return items
