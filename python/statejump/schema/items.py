# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists of tables in case files, such as [[node]]: items with a name, checked one by one."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, isfinite
from typing import Any, Generic, TypeVar

from statejump.core.errors import ABSENT, MissingKey, NotAllowed, StatejumpError, UnknownKey
from statejump.schema.fields import Section, default_of, definition, fields_of, is_required, rule_of, text
from statejump.schema.item_tables import ItemColumns, ItemTable, where
from statejump.schema.rules import NUMBER, NUMBERS, TEXT, TEXTS, suggestion

ItemType = TypeVar("ItemType", bound=Section)


@definition
class Item(Section):
    """One table of a list of tables. Messages use its name."""

    name: str = text(..., "by which other tables and messages call it")

    def __attrs_post_init__(self) -> None:
        if not self.name:
            raise NotAllowed("name", self.name, code="empty_string")


def read_tables(model: type[ItemType], section: str, value: Any) -> Sequence[ItemType]:
    """Return the items of a list of tables, as objects or in columns, as they are given.

    A truss of 10 000 joints has some 100 000 items. Numbers are therefore checked by direct comparisons with their
    range, and items are created without a second check by their class.

    :param model: class of an item
    :param section: name of the list
    :param value: list that tomllib returned, or an :class:`~statejump.schema.item_tables.ItemTable`
    :raises StatejumpError: the first failure, without the file's name
    """
    if isinstance(value, ItemTable):
        return ItemColumns(model, section, value)
    if not isinstance(value, list) or not value or not all(isinstance(table, dict) for table in value):
        given = ABSENT if isinstance(value, (list, dict)) else value
        raise NotAllowed(section, given, code="not_table_list", table=section)
    quick = _Quick(model)
    ranges, lists, free, free_lists, taken = quick.ranges, quick.lists, quick.free, quick.free_lists, quick.taken
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
                # The sum is not finite if any element is not.
                if low <= min(given) and max(given) <= high and isfinite(sum(given)) and length in (None, len(given)):
                    values[key] = given.copy()
                    continue
            elif type(given) is list and key in free_lists and set(map(type, given)) == {str}:
                values[key] = given.copy()
                continue
            try:
                values[key] = quick.checked(key, given)
            except StatejumpError as refused:
                refused.item = where(section, table, number)
                raise
        for key in quick.needed:
            if key not in table:
                rule = quick.rules[key]
                raise MissingKey(key, rule.needs(), item=where(section, table, number), allowed=rule.allowed)
        items.append(quick.made(values))
    return items


class _Quick(Generic[ItemType]):
    """Fast checks that accept a value without its rule: a number in its range, a text without constraints, or a text
    that passed an earlier check.

    :param model: class of an item
    """

    def __init__(self, model: type[ItemType]) -> None:
        self.model = model
        self.fields = fields_of(model)
        self.rules = {key: rule_of(field) for key, field in self.fields.items()}
        self.needed = [key for key, field in self.fields.items() if is_required(field)]
        self.optional = {key: field for key, field in self.fields.items() if not is_required(field)}
        ranged = {key: (rule, rule.allowed) for key, rule in self.rules.items() if rule.allowed is not None}
        self.ranges = {key: (allowed.low, allowed.high, allowed.above)
                       for key, (rule, allowed) in ranged.items() if rule.form == NUMBER}
        self.lists = {key: (allowed.low, allowed.high, rule.length)
                      for key, (rule, allowed) in ranged.items() if rule.form == NUMBERS and not allowed.above}
        unruled = [key for key, rule in self.rules.items() if rule.known is None and rule.expression is None]
        self.free = {key for key in unruled if self.rules[key].form == TEXT}
        self.free_lists = {key for key, rule in self.rules.items() if rule.form == TEXTS and rule.known is None}
        # Many items have the same text. A text that the rule of a key accepted once is accepted again.
        self.taken: dict[str, set[str]] = {
            key: set() for key, rule in self.rules.items() if rule.form == TEXT and key not in self.free}

    def checked(self, key: str, given: Any) -> Any:
        """Return a value in the form in which its key stores it. :raises StatejumpError: the key is unknown, or refuses
        the value"""
        field = self.fields.get(key)
        if field is None:
            raise UnknownKey(key, **suggestion(key, list(self.fields)))
        convert: Any = field.converter  # attrs returns it with a type of its own, depending on its version
        converted = given if convert is None else convert(given)
        try:
            self.rules[key].check(key, converted)
            if key == "name" and not given:
                raise NotAllowed(key, given, code="empty_string")
        except NotAllowed as refused:
            refused.value = given
            raise
        if type(given) is str and key in self.taken and converted is given:
            self.taken[key].add(given)
        return converted

    def made(self, values: Mapping[str, Any]) -> ItemType:
        """Return the item with checked values, and defaults for the others."""
        item = self.model.__new__(self.model)
        # Assigned one by one in a fixed order, so that items share the names of their keys and need a third of the
        # memory.
        for key in self.fields:
            object.__setattr__(item, key, values[key] if key in values else default_of(self.optional[key]))
        return item
