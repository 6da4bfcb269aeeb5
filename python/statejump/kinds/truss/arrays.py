# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the items of a truss, which refer to each other by name, to arrays.

Vectors have three components; the third is 0 in planar trusses. Items are numbered as in the file. Index -1 means the
ground.
"""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any, TypeVar

import numpy as np

from statejump.schema.fields import fields_of, rule_of
from statejump.schema.item_tables import ItemColumns, ItemIndex, once
from statejump.schema.items import Item
from statejump.schema.rules import NUMBERS, SWITCH, TEXT, TEXTS, WHOLE
from statejump.schema.texts import BLOCK, Names

ArraysType = TypeVar("ArraysType")

GROUND = -1
# Directions count as equal below this difference: far above rounding, far below any intended difference.
SAME_DIRECTION = 1e-6


def none_of(joints: Any) -> Any:
    """Return arrays of the same type without any item."""
    return type(joints)(**{key: value[:0] for key, value in vars(joints).items()})


def column(items: Sequence[Item], key: str) -> np.ndarray:
    """Return one number of every item; NaN if it is missing."""
    if isinstance(items, ItemColumns):
        return items.numbers(key)
    return np.array([getattr(item, key) for item in items], dtype=float)


def values(items: Sequence[Any], key: str) -> Iterable[Any]:
    """Return a key of every item, None if it is missing."""
    return items.values(key) if isinstance(items, ItemColumns) else (getattr(item, key) for item in items)


def columns(items: Sequence[Item], *keys: str) -> dict[str, np.ndarray]:
    """Return one number of every item by key; see :func:`column`."""
    return {key: column(items, key) for key in keys}


def texts(items: Sequence[Item], key: str) -> Sequence[str]:
    """Return a text of every item."""
    return Names(items.texts(key)) if isinstance(items, ItemColumns) else tuple(getattr(item, key) for item in items)


def names(items: Sequence[Item]) -> Sequence[str]:
    """Return the names of the items."""
    return texts(items, "name")


def given_or(given: np.ndarray, other: np.ndarray | float) -> np.ndarray:
    """Return numbers of items in which missing numbers (NaN) are replaced. The result may be the argument itself, so do
    not write to it."""
    none = np.isnan(given)
    if none.all():
        return np.broadcast_to(other, given.shape)
    return np.where(none, other, given) if none.any() else given


def said(items: Sequence[Any], key: str) -> np.ndarray:
    """Return for every item (n,) whether it has a number or a vector for a key."""
    if not isinstance(items, ItemColumns):
        return np.array([getattr(item, key) is not None for item in items], dtype=bool)
    given = ~np.isnan(items.numbers(key))
    return given if given.ndim == 1 else np.asarray(given.any(axis=1))


def having(items: Sequence[Any], key: str, text: str) -> np.ndarray:
    """Return for every item (n,) whether a key has this text, or is a list that contains it."""
    if isinstance(items, ItemColumns):
        return items.texts(key).has(text)
    return np.array([text == value if isinstance(value, str) else text in (value or ())
                     for value in values(items, key)], dtype=bool)


def vectors(items: Sequence[Item], key: str, dimension: int) -> np.ndarray:
    """Return vectors (n, 3) of items from 2 or 3 numbers each; a missing vector is zero. Do not write to the result."""
    if isinstance(items, ItemColumns):
        given = items.numbers(key)
        none = np.isnan(given)
        if none.all():
            return np.broadcast_to(0.0, (len(items), 3))
        if dimension == 3 and not none.any():
            return given
        given = np.nan_to_num(given)
    else:
        zero = (0.0,) * dimension
        given = np.array([zero if value is None else value for value in values(items, key)],
                         dtype=float).reshape(-1, dimension)
    found = np.zeros((len(items), 3))
    found[:, :dimension] = given
    return found


def in_space(given: Sequence[float] | None, dimension: int) -> np.ndarray:
    """Return a vector (3,) from 2 or 3 numbers; a missing vector becomes zero."""
    return np.array([*(given or (0.0,) * dimension), *(0.0,) * (3 - dimension)])


def unit(given: np.ndarray) -> np.ndarray:
    """Return vectors (n, 3) of length 1; a zero vector stays zero."""
    if not given.any():
        return given
    lengths = np.linalg.norm(given, axis=-1, keepdims=True)
    return given / np.where(lengths > 0, lengths, 1.0)


def distances(position_m: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Return the distances [m] between the nodes of each pair."""
    found = np.empty(len(pairs))
    for start in range(0, len(pairs), BLOCK):
        first, second = pairs[start:start + BLOCK].T
        found[start:start + BLOCK] = np.linalg.norm(position_m[second] - position_m[first], axis=1)
    return found


@dataclass(frozen=True)
class References:
    """Converts names in a case to indices. All names must exist, which ``checks`` verifies when a case is read."""

    dimension: int
    position_m: np.ndarray  # (n, 3) of the nodes
    node: ItemIndex
    link: ItemIndex
    program: ItemIndex  # indices in [[program]], which are one less than program indices: program 0 is the common one
    member: dict[str, int]  # program index of each member with a temperature history

    def programs_of(self, items: Sequence[Any]) -> np.ndarray:
        """Return the temperature program (items,) of items that may name one."""
        found = once(1 + self.program.of(items, "program"))
        if self.member:
            own = np.fromiter((self.member.get(name, 0) for name in values(items, "name")), int, len(items))
            return np.where(found == 0, own, found)
        return found

    def axes(self, items: Sequence[Any]) -> np.ndarray:
        """Return unit axes of rotation (items, 3); z in planar trusses."""
        if self.dimension == 2:
            return np.tile([0.0, 0.0, 1.0], (len(items), 1))
        return unit(vectors(items, "axis", self.dimension))


def indices(items: Sequence[Any], key: str, among: ItemIndex) -> np.ndarray:
    """Return, for every item, the index of the item that its key names (items,); GROUND if the key is missing."""
    return among.of(items, key)


def pairs(items: Sequence[Any], key: str, among: ItemIndex) -> np.ndarray:
    """Return, for every item, the indices of the one or two items that its key names (items, 2); GROUND for a missing
    second name."""
    found = np.full((len(items), 2), GROUND, dtype=np.int32)
    if len(items):
        given = among.of(items, key)[:, :2]
        found[:, :given.shape[1]] = given
    return found


def arrays_of(made: type[ArraysType], model: type[Item], items: Sequence[Any], known: References, **own: Any
              ) -> ArraysType:
    """Return items as a dataclass of arrays. Each field has the values of the key of its name; ``names`` has the names
    of the items.

    :param made: the dataclass
    :param model: class of the items
    :param own: arrays for fields that are not simply the values of a key
    """
    given = {field.name: names(items) if field.name == "names" else _of_key(field.name, model, items, known)
             for field in fields(made) if field.name not in own}  # type: ignore[arg-type]  # it is a dataclass
    return made(**given, **own)


def _of_key(key: str, model: type[Item], items: Sequence[Any], known: References) -> Any:
    """Return the values of a key: indices for names of nodes, links and programs; unit vectors for axes."""
    rule = rule_of(fields_of(model)[key])
    if key == "program":
        return known.programs_of(items)
    if key == "axis" and rule.form == NUMBERS:
        return known.axes(items) if rule.optional else unit(vectors(items, key, known.dimension))
    if rule.form == TEXTS:
        return pairs(items, key, {"nodes": known.node, "links": known.link}[key])
    if rule.form == TEXT:
        return indices(items, key, {"node": known.node, "link": known.link}[key.rpartition("_")[2]])
    if rule.form == SWITCH:
        return np.array(list(values(items, key)), dtype=bool)
    found = column(items, key)
    return found.astype(int) if rule.form == WHOLE else found
