# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys of the columns of a table, and conversion of their numbers to the unit of the key.

A key ends with its unit: ``force_N``. A column may use another unit of the same quantity, and other spellings:
``force_kN``, ``Force [kN]``, ``Force (kN)``, ``Force / kN``, ``Force kN``. For a unit other than that of the key, the
module loads the library pint, which takes some time.
"""
from __future__ import annotations

import re
from typing import Any
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from statejump.core.errors import StatejumpError, UnknownKey
from statejump.core.units import SAME, Conversion, split_unit

# Accepted spellings that an error message lists, by unit of a key.
EXAMPLES = {"m": ("mm", "in"), "N": ("kN", "lbf"), "s": ("min", "h"), "K": ("°C",), "rad": ("deg", "mrad"),
            "N m": ("N mm", "lbf in"), "Pa": ("MPa", "psi"), "m2": ("mm2",), "N/m": ("N/mm",), "kg/m3": ("g/cm3",)}
QUANTITIES = {"m": "length", "N": "force", "s": "time", "K": "temperature", "rad": "angle", "N m": "moment",
              "Pa": "pressure", "m2": "area", "N/m": "stiffness", "kg/m3": "density", "kg": "mass"}
_BRACKETS = (re.compile(r"(.*?)\s*\[([^\[\]]*)\]"), re.compile(r"(.*?)\s*\(([^()]*)\)"))
_SLASH = re.compile(r"(.*?)\s*/\s*(.+)")
# In brackets these are temperatures. Behind a blank they are names: "Sensor C".
IN_BRACKETS = {"C": "°C", "F": "°F"}
NO_UNIT = ("", "-", "1")
# Names of a column of times.
TIMES = ("t", "timestamp", "time stamp", "datetime", "date", "date/time", "Zeit", "Datum/Zeit")


@dataclass(frozen=True)
class Column:
    """A column of a table.

    :param name: name in the table
    :param key: key
    :param converted: function that converts the column's numbers to the unit of the key
    :param iso: whether cells are ISO times
    """

    name: str
    key: str
    converted: Conversion = SAME
    iso: bool = False


def matched(header: Sequence[str], known: Sequence[str], words: Mapping[str, Sequence[str]] | None = None
            ) -> list[Column]:
    """Match the columns of a table to keys.

    :param known: keys that end with their units
    :param words: other names of the quantity of a key, by key
    :raises StatejumpError: a column is unknown, has no unit or a unit of another quantity, or two columns match one key
    """
    bases = {_plain(split_unit(key)[0]): key for key in known}
    for key, more in (words or {}).items():
        bases.update({_plain(word): key for word in more})
    found: dict[str, Column] = {}
    for name in header:
        column = Column(name, name) if name in known else _column(name, known, bases)
        if column.key in found:
            raise StatejumpError(code="columns_of_one_key", column=name, other=found[column.key].name,
                                 key_of_both=column.key)
        found[column.key] = column
    return list(found.values())


def _column(name: str, known: Sequence[str], bases: Mapping[str, str]) -> Column:
    key = bases.get(_plain(name))  # first, because a name may have several words: "Time stamp"
    for base, unit in splits(name) if key is None else ():
        of = bases.get(_plain(base))
        if of is not None:
            return Column(name, of, _converted(name, base, unit, of))
    if key is None:
        near = get_close_matches(name, known, 1)
        raise UnknownKey(name, section=f"column {name!r}", **(
            {"code": "misspelt_key", "meant": near[0]} if near else {"code": "no_such_key", "known": ", ".join(known)}))
    wanted = split_unit(key)[1]
    if key == "time_s":
        return Column(name, key, iso=True)
    if wanted != "-":
        raise StatejumpError(code="column_without_unit", **accepted(name, key, wanted), column=name)
    return Column(name, key)


def _plain(base: str) -> str:
    """Return a column name in one spelling: separators as ``_`` and small letters. A single letter keeps its case."""
    found = re.sub(r"[\s_\-.:]+", "_", base.strip()).strip("_")
    return found if len(found) == 1 else found.lower()


def splits(name: str) -> Iterator[tuple[str, str]]:
    """Return all possible divisions of a column name into name and unit."""
    for pattern in (*_BRACKETS, _SLASH):
        if bracket := pattern.fullmatch(name.strip()):
            unit = bracket[2].strip()
            yield bracket[1], IN_BRACKETS.get(unit, unit)
    for found in re.finditer(r"_|\s+|,\s*", name):
        if name[:found.start()].strip() and name[found.end():].strip():
            yield name[:found.start()], name[found.end():].strip()


def _converted(name: str, base: str, unit: str, key: str) -> Conversion:
    wanted = split_unit(key)[1]
    if unit in NO_UNIT:
        if wanted in ("-", "rad") and unit != "" or wanted == "-":
            return SAME
        raise StatejumpError(code="column_without_unit", **accepted(base, key, wanted), column=name)
    found = conversion(unit, wanted, change="change" in key)
    if found is None:
        quantity = f"of {QUANTITIES[wanted]}" if wanted in QUANTITIES else f"like {wanted}"
        raise StatejumpError(code="column_of_other_unit", **accepted(base, key, wanted), column=name, unit=unit,
                             quantity=quantity)
    return found


def accepted(base: str, key: str, wanted: str) -> dict[str, Any]:
    """Return the remedy of an error about a column name: its accepted spellings, as text and as a tuple."""
    shown = [f"{base.strip()} [{unit}]" for unit in (wanted, *EXAMPLES.get(wanted, ()))] if wanted != "-" else [key]
    names = tuple(dict.fromkeys((key, *shown)))
    return {"remedy": f"accepted are {', '.join(names)}", "accepted": names}


def conversion(unit: str, wanted: str, change: bool = False) -> Conversion | None:
    """Return the conversion from one unit to another; None if they are units of different quantities.

    :param change: whether the value is a temperature difference
    """
    if unit == wanted:
        return SAME
    from statejump.core import unit_library  # pint, 0.3 s; few tables need it

    return unit_library.conversion(unit, wanted, change)
