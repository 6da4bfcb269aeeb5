# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists of tables, stored as columns: one array per key for many items, from table files or from arrays of a program.

A million items take gigabytes as objects, but much less as arrays. The input is an :class:`ItemTable` instead of a list
of dicts. A case stores :class:`ItemColumns` instead of a list of items.
"""
from __future__ import annotations

from collections import namedtuple
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import repeat, starmap
from typing import Any, Generic, TypeVar, overload

import attrs
import numpy as np

from statejump.core.errors import MissingKey, NotAllowed, UnknownKey
from statejump.schema.fields import Section, default_of, fields_of, is_required, rule_of
from statejump.schema.rules import NUMBER, NUMBERS, TEXT, TEXTS, WHOLE, Rule, suggestion
from statejump.schema.texts import BLOCK, Texts, TextPool, coded

ItemType = TypeVar("ItemType", bound=Section)


def _plain(values: np.ndarray | Texts) -> list[Any]:
    """Return the elements of a column in the form that documents have; missing elements are None."""
    if isinstance(values, Texts):
        return values.plain()
    found: list[Any] = values.tolist()
    if values.dtype.kind == "f":
        none = np.isnan(values)
        none = none.all(axis=1) if values.ndim == 2 else none
        return [None if skip else value for skip, value in zip(none.tolist(), found)] if none.any() else found
    return [[text for text in row if text] for row in found] if values.ndim == 2 else found


def once(values: np.ndarray) -> np.ndarray:
    """Return numbers by rows. If all rows are equal to the last bit, only one row is kept in memory."""
    if len(values) < 2 or values.dtype.kind not in "fiub" or values.dtype.itemsize > 8:
        return values
    # As integers, bits decide: NaN equals itself and differs from other NaN, +0 differs from -0.
    bits = values.view(f"i{values.dtype.itemsize}")
    if any((bits[places] != bits[0]).any() for places in (slice(1, BLOCK), slice(BLOCK, None))):
        return values
    return np.broadcast_to(values[0].copy(), values.shape)


def _as_column(values: Any) -> np.ndarray | Texts:
    if isinstance(values, Texts):
        return values
    made = np.asarray(values)
    if made.dtype.kind not in "fO":
        made = made.astype(object if made.dtype.kind in "USTb" else float)
    return once(made) if made.ndim else made


class ItemTable:
    """Columns of equal length, one per key, that hold items.

    :param columns: column of each key: numbers (n,) or vectors (n, k), NaN if missing; texts (n,), None if missing;
        lists of texts (n, k), "" or None after their end; texts also as :class:`Texts`
    :raises NotAllowed: the columns have different lengths
    """

    def __init__(self, **columns: Any) -> None:
        self.columns: dict[str, np.ndarray | Texts] = {key: _as_column(values) for key, values in columns.items()}
        lengths = {key: values.shape[0] if values.ndim else 0 for key, values in self.columns.items()}
        for key, length in lengths.items():
            if length != max(lengths.values()) or self.columns[key].ndim not in (1, 2):
                raise NotAllowed(key, length, code="columns_not_of_one_length", rows=max(lengths.values()))
        self.length = max(lengths.values(), default=0)

    def __len__(self) -> int:
        return self.length

    def rows(self) -> list[dict[str, Any]]:
        """Return the items one by one, as in a case file."""
        listed = [_plain(values) for values in self.columns.values()]
        return [{key: value for key, value in zip(self.columns, row) if value is not None} for row in zip(*listed)]

    def row(self, place: int) -> dict[str, Any]:
        """Return one item as in a case file."""
        found = {key: _plain(values[place:place + 1])[0] for key, values in self.columns.items()}
        return {key: value for key, value in found.items() if value is not None}


def with_rows(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return a document in which lists of dicts replace every :class:`ItemTable`."""
    return {section: part.rows() if isinstance(part, ItemTable) else part for section, part in data.items()}


class ItemColumns(Sequence[ItemType], Generic[ItemType]):
    """The items of a list, stored as columns. An item object is created when it is accessed; it is immutable.

    :param model: class of an item
    :param section: name of the list
    :param table: columns of the list; a key without column has its default
    :raises StatejumpError: the first failure, without the file's name: an unknown key, a missing one, or an invalid
        value
    """

    def __init__(self, model: type[ItemType], section: str, table: ItemTable) -> None:
        self._model, self._length = model, len(table)
        self._fields = fields_of(model)
        if not self._length:
            raise NotAllowed(section, code="not_table_list", table=section)
        for key in table.columns:
            if key not in self._fields:
                raise UnknownKey(key, item=f"tables.{section}", **suggestion(key, list(self._fields)))
        for key, field in self._fields.items():
            if key not in table.columns and is_required(field):
                rule = rule_of(field)
                raise MissingKey(key, rule.needs(), item=f"tables.{section}", allowed=rule.allowed)
        self._given = {key: _checked(section, table, key, self._fields[key]) for key in table.columns}

    def __len__(self) -> int:
        return self._length

    @overload
    def __getitem__(self, place: int) -> ItemType: ...

    @overload
    def __getitem__(self, place: slice) -> list[ItemType]: ...

    def __getitem__(self, place: int | slice) -> ItemType | list[ItemType]:
        if isinstance(place, slice):
            return list(self._made(place))
        place = range(self._length)[place]
        return next(self._made(slice(place, place + 1)))

    def __iter__(self) -> Iterator[ItemType]:
        for start in range(0, self._length, BLOCK):
            yield from self._made(slice(start, start + BLOCK))

    def _made(self, places: slice) -> Iterator[ItemType]:
        """Create item objects. Their keys always have the same order, so that Python shares the names of the keys."""
        listed = [
            _plain(self._given[key][places]) if key in self._given else repeat(default_of(field))
            for key, field in self._fields.items()
        ]
        set_value = object.__setattr__
        for row in zip(*listed):
            item = self._model.__new__(self._model)
            for key, value in zip(self._fields, row):
                set_value(item, key, value)
            yield item

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and len(self) == len(other) and all(
            one == two for one, two in zip(self, other))

    __hash__ = None  # type: ignore[assignment]  # as of a list

    def numbers(self, key: str) -> np.ndarray:
        """Return the values of a key with numbers (n,) or vectors (n, k) for all items; missing values are NaN."""
        found = self._given.get(key)
        if found is None:
            default = default_of(self._fields[key])
            return np.broadcast_to(np.float64(np.nan if default is None else default), self._length)
        assert isinstance(found, np.ndarray)
        return found

    def texts(self, key: str) -> Texts:
        """Return the values of a key with texts (n,) or lists of texts (n, k) for all items."""
        found = self._given.get(key)
        if found is None:
            default = default_of(self._fields[key])
            if not isinstance(default, list):
                return Texts(np.broadcast_to(np.int32(0), self._length), TextPool(), default)
            row = np.arange(1, 1 + max(len(default), 1), dtype=np.int32) * bool(default)
            return Texts(np.broadcast_to(row, (self._length, len(row))), TextPool(default))
        assert isinstance(found, Texts)
        return found

    def value(self, key: str, place: int) -> Any:
        """Return the value of one key of one item; None if it is missing."""
        if key not in self._given:
            return default_of(self._fields[key])
        return _plain(self._given[key][place:place + 1])[0]

    def values(self, key: str) -> Iterator[Any]:
        """Yield the values of a key item by item; None if a value is missing."""
        if key not in self._given:
            return repeat(default_of(self._fields[key]), self._length)
        return (value for start in range(0, self._length, BLOCK)
                for value in _plain(self._given[key][start:start + BLOCK]))


class _Place:
    """An item that is stored in columns, given by its index. The value of a key is looked up when it is accessed."""

    def __init__(self, items: ItemColumns[Any], place: int) -> None:
        self._items, self._place = items, place

    def __getattr__(self, key: str) -> Any:
        try:
            return self._items.value(key, self._place)
        except KeyError:
            raise AttributeError(key) from None


class Named(Mapping[str, Any]):
    """Items of columns by their names."""

    def __init__(self, items: ItemColumns[Any]) -> None:
        self._items = items

    @cached_property
    def _place(self) -> dict[str, int]:
        """Indices of items by name, computed at the first look-up, because comparisons of arrays need none."""
        return {name: place for place, name in enumerate(self._items.values("name"))}

    def __getitem__(self, name: str) -> Any:
        return _Place(self._items, self._place[name])

    def __contains__(self, name: object) -> bool:
        return name in self._place

    def __iter__(self) -> Iterator[str]:
        return iter(self._place)

    def __len__(self) -> int:
        return len(self._items)


NONE, UNKNOWN = -1, -2  # indices of a missing value, and of an unknown name


class ItemIndex:
    """The indices of items by their names. No two items have the same name.

    :param items: items as a list of objects or in columns
    """

    def __init__(self, items: Sequence[Any]) -> None:
        self._items = items

    def _names(self) -> Iterable[str]:
        items = self._items
        return items.values("name") if isinstance(items, ItemColumns) else (item.name for item in items)

    @cached_property
    def _place(self) -> dict[str, int]:
        return {name: place for place, name in enumerate(self._names())}

    def called(self, names: Sequence[str]) -> np.ndarray:
        """Return the indices of the items with these names; UNKNOWN if there is none. Other names are not stored."""
        wanted = set(names)
        found = {name: place for place, name in enumerate(self._names()) if name in wanted}
        return np.array([found.get(name, UNKNOWN) for name in names], dtype=int)

    @cached_property
    def _of_word(self) -> np.ndarray:
        """Return for each text in the column of names the index of the item with this name."""
        assert isinstance(self._items, ItemColumns)
        names = self._items.texts("name")
        found = np.full(len(names.words), UNKNOWN, np.int32)
        found[names.numbers] = np.arange(len(names), dtype=np.int32)
        found[0] = NONE
        return found

    def of(self, items: Sequence[Any], key: str) -> np.ndarray:
        """Return, for every item of a list, the index of the item that its key names (n,), or (n, k) for lists; NONE
        for a missing name, UNKNOWN for an unknown one. Lists have NONE after their end."""
        if not isinstance(items, ItemColumns):
            return self._of_each([getattr(item, key) for item in items])
        given = items.texts(key)
        if isinstance(self._items, ItemColumns) and self._items.texts("name").words is given.words:
            found = self._of_word[given.numbers]
        else:
            of_word = np.full(len(given.words), UNKNOWN, np.int32)
            used = given.used()
            of_word[used] = [self._place.get(str(word), UNKNOWN) for word in given.words.listed(used)]
            of_word[0] = NONE if given.none is None else self._place.get(given.none, UNKNOWN)
            found = of_word[given.numbers]
        if found.ndim == 2 and (gaps := (given.numbers[:, :-1] == 0) & (given.numbers[:, 1:] != 0)).any():
            rows = gaps.any(axis=1)
            order = np.argsort(given.numbers[rows] == 0, axis=1, kind="stable")
            found[rows] = np.take_along_axis(found[rows], order, axis=1)
        return np.asarray(found)

    def _of_each(self, named: list[Any]) -> np.ndarray:
        if not any(isinstance(value, (list, tuple)) for value in named):
            return np.array([NONE if name is None else self._place.get(name, UNKNOWN) for name in named],
                            dtype=np.int32)
        found = np.full((len(named), max(map(len, named))), NONE, dtype=np.int32)
        for row, listed in zip(found, named):
            row[:len(listed)] = [self._place.get(name, UNKNOWN) for name in listed]
        return found


def where_wrong(
    items: Sequence[ItemType], wrong: Callable[[ItemColumns[ItemType]], np.ndarray]
) -> Iterable[ItemType]:
    """Return the items to check one by one: all items of a list, or those in columns that may be invalid.

    :param wrong: function that returns which items of an :class:`ItemColumns` (n,) may be invalid; these must include
        all invalid items
    """
    if not isinstance(items, ItemColumns):
        return items
    return (items[place] for place in np.flatnonzero(wrong(items)).tolist())


def repeated_names(items: Sequence[Any]) -> bool:
    """Return whether names of items in columns are repeated. A list is checked item by item, so it returns True."""
    if not isinstance(items, ItemColumns):
        return True
    names = items.texts("name")
    return bool(len(names.used()) < len(items))


def each(items: Sequence[Any], *keys: str) -> Iterable[Any]:
    """Return the items of a list for access to given keys only. For items in columns, only these keys are created."""
    if not isinstance(items, ItemColumns):
        return items
    return starmap(namedtuple("_Item", keys), zip(*(items.values(key) for key in keys)))  # type: ignore[misc]


def by_name(items: Sequence[Any]) -> Mapping[str, Any]:
    """Return the items of a list by their names."""
    return Named(items) if isinstance(items, ItemColumns) else {item.name: item for item in items}


def _checked(section: str, table: ItemTable, key: str, field: attrs.Attribute[Any]) -> np.ndarray | Texts:
    """Check every value of a column against the rule of its key. Return the column with defaults for missing values."""
    rule, values = rule_of(field), table.columns[key]
    default = None if is_required(field) else default_of(field)
    allowed = rule.allowed
    if isinstance(values, Texts):
        refused_row = _wrong_texts(key, rule, values, is_required(field))
        if refused_row is not None:
            _refuse(section, table, key, rule, refused_row)
        return values if values.ndim == 2 else replace(values, none=default)
    if rule.form in (NUMBER, NUMBERS) and values.dtype.kind == "f" and allowed is not None:
        none = np.isnan(values)
        if rule.form == NUMBERS:
            none = none.all(axis=-1) if values.ndim == 2 else none
        elif default is not None and none.any():
            values, none = np.where(none, default, values), np.zeros_like(none)
        with np.errstate(invalid="ignore"):
            right = (values <= allowed.high) & ((values > allowed.low) if allowed.above else (values >= allowed.low))
        right = right.all(axis=-1) if right.ndim == 2 else right
        wrong = ~right if is_required(field) else ~right & ~none
        if values.ndim != (2 if rule.form == NUMBERS else 1):
            wrong[:] = True
        if wrong.any():
            _refuse(section, table, key, rule, int(np.argmax(wrong)))
        return values
    if rule.form == WHOLE and values.dtype.kind == "f":
        values = _whole(values)
    if rule.form == TEXTS and values.ndim == 1:
        # One text each, or none.
        values = values.reshape(-1, 1)
    seen: set[Any] = set()
    plain = values.ndim == 1
    for place, value in enumerate(values):
        given = value if plain else tuple(value)
        if given in seen and key != "name":
            continue
        seen.add(given)
        if plain and given is None:
            if is_required(field):
                raise MissingKey(key, rule.needs(), item=_where(section, table, place), allowed=rule.allowed)
            continue
        try:
            rule.check(key, given if plain else [text for text in given if text])
            if key == "name" and not given:
                raise NotAllowed(key, given, code="empty_string")
        except NotAllowed as refused:
            refused.item = _where(section, table, place)
            raise
    if rule.form in (TEXT, TEXTS):
        return coded(values) if values.ndim == 2 else replace(coded(values), none=default)
    if plain and default is not None:
        values = np.array([default if value is None else value for value in values], dtype=object)
    return values


def _wrong_texts(key: str, rule: Rule, texts: Texts, required: bool) -> int | None:
    """Return the first row of a column of texts that violates the rule of its key; None if there is none."""
    wrong = np.zeros(len(texts.words), dtype=bool)
    wrong[0] = required and texts.ndim == 1
    if rule.form != (TEXT if texts.ndim == 1 else TEXTS):
        return 0
    used = texts.used()
    if rule.known is None and rule.pattern is None:
        # For a list of texts the only condition is that they are printable texts.
        used = np.intersect1d(used, texts.words.unprintable).astype(int) if rule.form == TEXT else used[:0]
    for start in range(0, len(used), BLOCK):
        numbers = used[start:start + BLOCK]
        for number, word in zip(numbers.tolist(), texts.words.listed(numbers)):
            try:
                rule.check(key, word if rule.form == TEXT else [word])
            except NotAllowed:
                wrong[number] = True
    refused = wrong[texts.numbers]
    refused = refused.any(axis=1) if refused.ndim == 2 else refused
    return int(np.argmax(refused)) if refused.any() else None


def _whole(values: np.ndarray) -> np.ndarray:
    """Return numbers as objects: integers as such, None for NaN. The rule of the key checks all other values."""
    found = np.empty(values.shape, dtype=object)
    for place, value in np.ndenumerate(values):
        found[place] = None if np.isnan(value) else int(value) if value.is_integer() else float(value)
    return found


def where(section: str, table: Any, number: int) -> str:
    """Return the name by which messages refer to an item: its name, or its number if it has no name."""
    name = table.get("name") if isinstance(table, dict) else None
    return f"{section} {name!r}" if isinstance(name, str) and name else f"{section} {number}"


def _where(section: str, table: ItemTable, place: int) -> str:
    return where(section, table.row(place), place + 1)


def _refuse(section: str, table: ItemTable, key: str, rule: Rule, place: int) -> None:
    given, item = table.row(place).get(key), _where(section, table, place)
    if given is None:
        raise MissingKey(key, rule.needs(), item=item, allowed=rule.allowed)
    try:
        rule.check(key, given)
    except NotAllowed as refused:
        refused.item = item
        raise
    raise NotAllowed(key, given, rule.needs(), code="wrong_value", item=item)
