# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules of case files, on a made-up kind: every rule at its limits, with its error code and fields."""
from __future__ import annotations

import copy
import errno
import json
import os
import re
from math import inf, nan
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import conftest  # noqa: F401  where the built package is
from failures import Failure, failure
from statejump.core.errors import MissingKey, NotAllowed, Range, StatejumpError, Unreadable
from statejump.schema import json_schema, toml
from statejump.schema.fields import (
    Attached, Section, attached, attached_to_json, choice, default_of, definition, fields_of, numbers, optional_section,
    parameter, rule_of, section, switch, tables, text, texts, whole,
)
from statejump.schema.item_tables import BLOCK, ItemColumns, ItemTable, by_name, each, with_rows
from statejump.schema.items import Item
from statejump.schema.paths import attribute_of, filled, keys_of, set_value, value_of, with_keys_moved, with_values
from statejump.schema.rules import check_name, is_finite_number, suggestion
from statejump.schema.structure import structure


class Arrays(Attached):
    """What was read from elsewhere."""

    def to_json(self) -> dict[str, Any]:
        return {"rows": 3}


@definition
class Part(Section):
    """A part."""

    GOES_WITH = {"sort": {"late_s": ("two",), "word": ("two", "three")}}
    ONE_OF = {"sort": {"one": (("count", "on"), ("best",))}}

    size_m: float = parameter(..., "m", 0, 10, "how large", above=True)
    share: float = parameter(0.5, "-", 0, 1, "of all")
    late_s: float | None = parameter(None, "s", -5, 5, "when")
    count: int = whole(3, 1, 9, "how many")
    best: int | None = whole(None, 1, 9, "")
    on: bool = switch(True, "whether")
    word: str | None = text(None, "what", pattern="[a-z]+")
    sort: str = choice("one", ("one", "two", "three"), "which")
    place_m: list[float] = numbers([0.0, 1.0], "m", -1, 1, "where", length=2)
    bounds: list[float] | None = numbers(None, "-", -2, 2, "ends")
    tags: list[str] = texts([], "marks", ("red", "blue"))
    notes: list[str] = texts([], "anything")
    arrays: Any = attached("read elsewhere")


@definition
class Thing(Item):
    """A thing."""

    mass_kg: float = parameter(..., "kg", 0, 10, "its mass", above=True)
    load_N: float | None = parameter(None, "N", 0, 10, "on it")
    force_N: float = parameter(2.0, "N", 0, 10, "along it")
    ends_m: list[float] | None = numbers(None, "m", -1, 1, "where it ends", length=2)
    turns: int | None = whole(None, 1, 9, "how often")
    count: int = whole(1, 1, 9, "how many")
    sort: str = choice("near", ("near", "far"), "where")
    on: bool = switch(False, "whether")
    tags: list[str] = texts([], "marks", ("red", "blue"))


@definition
class Book(Section):
    """A file."""

    MOVED: ClassVar[dict[str, str]] = {"part.old_m": "part.size_m", "more.old_share": "part.share"}

    part: Part = section(Part, required=True)
    more: Part | None = optional_section(Part)
    thing: list[Thing] = tables(Thing, "things", required=True)
    other: list[Thing] = tables(Thing, "others")


PART: dict[str, Any] = {"size_m": 1.0}
THING: dict[str, Any] = {"name": "A", "mass_kg": 1.0}


def book(part: Any = None, **more: Any) -> Book:
    """A file with these values of its part, and these sections."""
    return structure(Book, {"part": {**PART, **(part or {})}, "thing": [dict(THING)], **more})


def refused(act: Any, *given: Any, **keys: Any) -> StatejumpError:
    with pytest.raises(StatejumpError) as found:
        act(*given, **keys)
    return found.value


TAKEN = [("size_m", 10), ("size_m", 1e-300), ("share", 0), ("share", 1), ("late_s", None), ("late_s", -5), ("count", 1),
         ("count", 9), ("best", None), ("on", False), ("word", None), ("word", "abc"), ("sort", "two"),
         ("place_m", [-1, 1]), ("place_m", (0.5, 0.25)), ("bounds", None), ("bounds", []), ("bounds", [-2.0, 0.0, 2.0]),
         ("tags", ["blue", "red"]), ("tags", ()), ("notes", ["a"]), ("arrays", None), ("arrays", Arrays())]
REFUSED: list[tuple[str, Any, Failure]] = [
    ("size_m", 0, failure("out_of_range", allowed=Range(0, 10, "m", above=True))),
    ("size_m", 10.5, failure("out_of_range", allowed=Range(0, 10, "m", above=True))),
    ("size_m", None, failure("wrong_type", type="a number", allowed=Range(0, 10, "m", above=True))),
    ("size_m", "1", failure("wrong_type", type="a number", allowed=Range(0, 10, "m", above=True))),
    ("size_m", True, failure("wrong_type", type="a number", allowed=Range(0, 10, "m", above=True))),
    ("size_m", nan, failure("number_not_finite", allowed=Range(0, 10, "m", above=True))),
    ("size_m", inf, failure("number_not_finite", allowed=Range(0, 10, "m", above=True))),
    ("size_m", 10**400, failure("out_of_range", allowed=Range(0, 10, "m", above=True))),
    ("share", -1e-9, failure("out_of_range", allowed=Range(0, 1, "-"))),
    ("share", None, failure("wrong_type", type="a number", allowed=Range(0, 1, "-"))),
    ("late_s", -5.1, failure("out_of_range", allowed=Range(-5, 5, "s"))),
    ("count", 0, failure("out_of_range", allowed=Range(1, 9, "-"))),
    ("count", 10, failure("out_of_range", allowed=Range(1, 9, "-"))),
    ("count", 2.0, failure("wrong_type", type="a whole number", allowed=Range(1, 9, "-"))),
    ("count", True, failure("wrong_type", type="a whole number", allowed=Range(1, 9, "-"))),
    ("count", None, failure("wrong_type", type="a whole number", allowed=Range(1, 9, "-"))),
    ("best", 0, failure("out_of_range", allowed=Range(1, 9, "-"))),
    ("on", 1, failure("not_boolean")),
    ("on", None, failure("not_boolean")),
    ("word", 3, failure("not_string")),
    ("word", "ab1", failure("no_folder_name")),
    ("word", "a\x07", failure("control_characters")),
    ("sort", None, failure("not_string")),
    ("sort", "tow", failure("misspelt_name", allowed=("one", "two", "three"), meant="two")),
    ("sort", "x", failure("unknown_name", allowed=("one", "two", "three"))),
    ("place_m", 3, failure("not_number_list", unit="m")),
    ("place_m", None, failure("not_number_list", unit="m")),
    ("place_m", [1], failure("wrong_list_length", unit="m", length=2)),
    ("place_m", [0, 1.5], failure("out_of_range", allowed=Range(-1, 1, "m"))),
    ("place_m", [0, "a"], failure("wrong_type", type="a number", allowed=Range(-1, 1, "m"))),
    ("bounds", [nan], failure("number_not_finite", allowed=Range(-2, 2, "-"))),
    ("tags", "red", failure("not_string_list")),
    ("tags", ["red", 1], failure("not_string_list")),
    ("tags", ["red", "bleu"], failure("unknown_name", allowed=("red", "blue"))),
    ("arrays", [1.0], failure("not_from_file", cause="read elsewhere")),
]


@pytest.mark.parametrize("key, value", TAKEN)
def test_what_a_key_takes(key: str, value: Any) -> None:
    made = getattr(book({key: value}).part, key)
    assert made == (list(value) if isinstance(value, tuple) and key == "place_m" else value)
    if key in ("size_m", "share"):
        assert type(made) is float
    assert getattr(Part(**{**PART, key: value}), key) == made


@pytest.mark.parametrize("key, value, why", REFUSED)
def test_what_a_key_refuses(key: str, value: Any, why: Failure) -> None:
    found = refused(book, {key: value})
    given = str(value).lower() if isinstance(value, bool) else repr(value)
    assert found == why.at(key=f"part.{key}") and f"part.{key} = {given} " in str(found)  # as the file has it
    assert refused(Part, **{**PART, key: value}) == why.at(key=key)


def test_what_is_refused_says_what_is_allowed() -> None:
    for key, value, names in (("sort", "x", ("one", "two", "three")), ("tags", ["x"], ("red", "blue"))):
        with pytest.raises(NotAllowed) as found:
            book({key: value})
        assert (found.value.key, found.value.value, found.value.allowed) == (f"part.{key}", value, names)
    with pytest.raises(NotAllowed) as found:
        book({"place_m": [0, 2]})
    allowed = found.value.allowed
    assert (found.value.value, allowed.low, allowed.high, allowed.unit) == ([0, 2], -1, 1, "m")  # type: ignore


def test_a_control_character_is_not_what_cannot_be_seen() -> None:
    assert Thing(**{**THING, "name": "a\N{NO-BREAK SPACE}b"}).name == "a\N{NO-BREAK SPACE}b"


def test_what_a_file_lacks_or_has_too_much() -> None:
    part, things = dict(PART), [dict(THING)]
    assert refused(structure, Book, {"part": part, "thing": things, "mroe": {}}) == (
        failure("misspelt_key", section="section [mroe]", meant="[more]"))
    assert refused(structure, Book, {"part": part, "thing": things, "zzz": {}}) == (
        failure("no_such_key", section="section [zzz]", known=", ".join(("part", "more", "thing", "other"))))
    # What is unknown comes before what is missing, of any section.
    assert refused(structure, Book, {"more": {"siez_m": 1}, "thing": things}) == (
        failure("misspelt_key", key="more.siez_m", meant="more.size_m"))
    assert refused(structure, Book, {"thing": things}) == failure("missing_key", section="section [part]")
    assert refused(structure, Book, {"part": part}) == failure("missing_key", section="section [[thing]]")
    assert refused(structure, Book, {"part": {}, "thing": things}) == (
        failure("missing_key", key="part.size_m", allowed=Range(0, 10, "m", above=True)))
    assert refused(structure, Book, {"part": part, "more": {"share": 1}, "thing": things}) == failure("missing_key", key="more.size_m")
    assert refused(structure, Book, {"part": 3, "thing": things}) == failure("not_section", key="part", value=3, wanted="part")
    assert refused(structure, Book, {"part": None, "thing": things}) == failure("not_section", key="part", wanted="part")
    assert refused(structure, Book, {"part": part, "more": [1], "thing": things}) == failure("not_section", key="more", wanted="more")
    made = structure(Book, {"part": part, "more": None, "thing": things})
    assert made.more is None and made.other == [] and made.part.place_m == [0, 1]


def test_needs_of_every_form() -> None:
    needs = {key: rule_of(field).needs() for key, field in fields_of(Part).items()}
    ranges = {"size_m": Range(0, 10, "m", above=True), "share": Range(0, 1), "late_s": Range(-5, 5, "s"),
              "count": Range(1, 9), "best": Range(1, 9)}
    assert {key: needs.pop(key) for key in ranges} == {key: str(allowed) for key, allowed in ranges.items()}
    assert needs.pop("sort") == "must be 'one' or 'two' or 'three'"
    named = {"on": "false", "word": "text", "place_m": "numbers [m]", "bounds": "numbers [-]", "tags": "texts",
             "notes": "texts", "arrays": "text"}
    assert set(needs) == set(named) and all(re.search(rf"{re.escape(word)}(?!\w)", needs[key]) for key, word in named.items())
    assert rule_of(fields_of(Part)["on"]).unit is None and rule_of(fields_of(Part)["notes"]).names == ()


def test_plain_values() -> None:
    made = book({"tags": ["red"]}, more={**PART, "word": "ab"})
    found = made.to_dict()
    assert list(found) == ["part", "more", "thing", "other"]
    assert found["part"]["tags"] == ["red"] and found["more"]["word"] == "ab" and found["other"] == []
    assert found["thing"] == [{"name": "A", "mass_kg": 1.0, "load_N": None, "force_N": 2.0, "ends_m": None,
                               "turns": None, "count": 1, "sort": "near", "on": False, "tags": []}]
    assert attached_to_json(Arrays()) == {"rows": 3}
    with pytest.raises(TypeError, match="dict"):
        attached_to_json({})
    # A default that is a list is nobody's own.
    first = Part(**PART)
    first.place_m.append(3.0)
    assert Part(**PART).place_m == [0, 1] == default_of(fields_of(Part)["place_m"])


def test_numbers_names_suggestions() -> None:
    assert [is_finite_number(value) for value in (1, 1.5, True, nan, inf, -inf, 10**400, "1", None, 1.7976931348623157e308)
            ] == [True, True, False, False, False, False, False, False, False, True]
    assert check_name("key", "one", ("one", "two")) == "one"
    assert refused(check_name, "key", None, ("one",)) == failure("unknown_name", key="key", allowed=("one",))
    assert refused(check_name, "key", 1, ("one",)) == failure("unknown_name", key="key", value=1, allowed=("one",))
    assert suggestion("siez", ["size", "share"], "part.", "]") == {"code": "misspelt_key", "meant": "part.size]"}
    assert suggestion("zzz", ["size", "share"]) == {"code": "no_such_key", "known": "size, share"}
    assert suggestion(1, ["a"]) == {"code": "no_such_key", "known": "a"}  # type: ignore[arg-type]


# Lists of tables, one by one and by columns: the same items, the same sentences.
THINGS = [{"name": "A", "mass_kg": 1.0}, {"name": "B.b", "mass_kg": 10.0, "load_N": 0.0, "force_N": 3.0, "ends_m": [0.0, 1.0],
                                          "turns": 3, "count": 4, "sort": "far", "tags": ["red", "blue"]}]
COLUMNS: dict[str, Any] = {
    "name": ["A", "B.b"], "mass_kg": [1.0, 10.0], "load_N": [nan, 0.0], "force_N": [nan, 3.0],
    "ends_m": [[nan, nan], [0, 1]], "turns": [nan, 3.0], "count": [nan, 4], "sort": [None, "far"], "tags": [["", ""], ["red", "blue"]]}


def things_of(items: Any) -> Any:
    return book(thing=items).thing


def test_items_by_columns_are_those_one_by_one() -> None:
    table = ItemTable(**COLUMNS)
    listed, columns = things_of(THINGS), things_of(table)
    assert len(table) == len(columns) == 2 and columns == listed and listed == list(columns)
    assert columns != listed[:1] and columns != listed[::-1] and columns != 3
    assert [dict(item.to_dict()) for item in columns] == [dict(item.to_dict()) for item in listed]
    assert columns[-1] == columns[1] == listed[1] and columns[0:1] == listed[:1] and columns[1:] == listed[1:]
    with pytest.raises(IndexError):
        columns[2]
    assert table.row(0) == table.rows()[0] == {"name": "A", "mass_kg": 1.0, "tags": []}
    assert table.row(1) == table.rows()[1] == THINGS[1]
    assert with_rows({"thing": table, "part": PART}) == {"thing": table.rows(), "part": PART}
    for key in COLUMNS:
        assert [columns.value(key, place) for place in (0, 1)] == list(columns.values(key)) == [
            getattr(item, key) for item in listed]
    assert columns.value("on", 1) is False and list(columns.values("on")) == [False, False]
    # A default is there, what is not given is none.
    assert columns.numbers("force_N").tolist() == [2, 3] and np.isnan(columns.numbers("load_N")).tolist() == [True, False]
    bare = things_of(ItemTable(name=["A"], mass_kg=[1]))
    assert bare.numbers("force_N").tolist() == [2] and np.isnan(bare.numbers("load_N")).all() and bare.numbers("load_N").shape == (1,)
    named = by_name(columns)
    assert list(named) == ["A", "B.b"] and len(named) == 2 and "A" in named and "C" not in named
    assert named["B.b"].mass_kg == 10 and named["A"].force_N == 2 and by_name(listed)["A"] is listed[0]
    with pytest.raises(AttributeError):
        named["A"].colour
    assert [(one.name, one.load_N) for one in each(columns, "name", "load_N")] == [("A", None), ("B.b", 0.0)]
    assert each(listed, "name") is listed


def test_items_by_columns_are_made_block_by_block() -> None:
    count = 2 * BLOCK + 3
    columns = things_of(ItemTable(name=[f"N{place}" for place in range(count)], mass_kg=np.linspace(1, 2, count)))
    names = [item.name for item in columns]
    assert names == [f"N{place}" for place in range(count)] == list(columns.values("name"))
    assert columns[BLOCK + 1].name == f"N{BLOCK + 1}" and isinstance(columns, ItemColumns)


@pytest.mark.parametrize("columns, why", [
    ({"name": ["A", "B"], "mass_kg": [1.0]}, failure("columns_not_of_one_length", key="mass_kg", value=1, rows=2)),
    ({"name": ["A"], "mass_kg": 1.0}, failure("columns_not_of_one_length", key="mass_kg", value=0, rows=1)),
    ({"name": [[["A"]]]}, failure("columns_not_of_one_length", key="name", value=1, rows=1)),
    ({}, failure("not_table_list", key="thing", table="thing")),
    ({"name": [], "mass_kg": []}, failure("not_table_list", key="thing", table="thing")),
    ({"name": ["A"], "mas_kg": [1.0]}, failure("misspelt_key", item="tables.thing", key="mas_kg", meant="mass_kg")),
    ({"name": ["A"]}, failure("missing_key", item="tables.thing", key="mass_kg", allowed=Range(0, 10, "kg", above=True))),
    ({"mass_kg": [1.0]}, failure("missing_key", item="tables.thing", key="name")),
    ({"name": ["A", "B"], "mass_kg": [1.0, 0.0]}, failure("out_of_range", item="thing 'B'", key="mass_kg", value=0.0, allowed=Range(0, 10, "kg", above=True))),
    ({"name": ["A", "B"], "mass_kg": [1.0, nan]}, failure("missing_key", item="thing 'B'", key="mass_kg", allowed=Range(0, 10, "kg", above=True))),
    ({"name": ["A"], "mass_kg": [11.0]}, failure("out_of_range", item="thing 'A'", key="mass_kg", value=11.0, allowed=Range(0, 10, "kg", above=True))),
    ({"name": ["A"], "mass_kg": [inf]}, failure("number_not_finite", item="thing 'A'", key="mass_kg", value=inf, allowed=Range(0, 10, "kg", above=True))),
    ({"name": ["A"], "mass_kg": [[1.0, 2.0]]}, failure("wrong_type", item="thing 'A'", key="mass_kg", value=[1.0, 2.0], type="a number", allowed=Range(0, 10, "kg", above=True))),
    ({"name": ["A"], "mass_kg": [1.0], "load_N": [-1.0]}, failure("out_of_range", item="thing 'A'", key="load_N", value=-1.0, allowed=Range(0, 10, "N"))),
    ({"name": ["A"], "mass_kg": ["x"]}, failure("wrong_type", item="thing 'A'", key="mass_kg", value="x", type="a number", allowed=Range(0, 10, "kg", above=True))),
    ({"name": ["A"], "mass_kg": [1.0], "ends_m": [[0.0, 2.0]]}, failure("out_of_range", item="thing 'A'", key="ends_m", value=[0.0, 2.0], allowed=Range(-1, 1, "m"))),
    ({"name": ["A"], "mass_kg": [1.0], "ends_m": [[0.0, nan]]}, failure("number_not_finite", item="thing 'A'", key="ends_m", value=[0.0, nan], allowed=Range(-1, 1, "m"))),
    ({"name": ["A"], "mass_kg": [1.0], "ends_m": [1.0]}, failure("not_number_list", item="thing 'A'", key="ends_m", value=1.0, unit="m")),
    ({"name": ["A", "B"], "mass_kg": [1.0, 1.0], "sort": ["near", "fra"]}, failure("misspelt_name", item="thing 'B'", key="sort", value="fra", allowed=("near", "far"), meant="far")),
    ({"name": ["A"], "mass_kg": [1.0], "tags": [["red", "bleu"]]}, failure("unknown_name", item="thing 'A'", key="tags", value=["red", "bleu"], allowed=("red", "blue"))),
    ({"name": ["A"], "mass_kg": [1.0], "tags": ["green"]}, failure("unknown_name", item="thing 'A'", key="tags", value=["green"], allowed=("red", "blue"))),
    ({"name": ["A", None], "mass_kg": [1.0, 1.0]}, failure("missing_key", item="thing 2", key="name")),
    ({"name": ["A", ""], "mass_kg": [1.0, 1.0]}, failure("empty_string", item="thing 2", key="name", value="")),
    ({"name": ["A"], "mass_kg": [1.0], "turns": [2.5]}, failure("wrong_type", item="thing 'A'", key="turns", value=2.5, type="a whole number", allowed=Range(1, 9, "-"))),
    ({"name": ["A"], "mass_kg": [1.0], "turns": [10.0]}, failure("out_of_range", item="thing 'A'", key="turns", value=10, allowed=Range(1, 9, "-"))),
    ({"name": ["A"], "mass_kg": [1.0], "turns": [inf]}, failure("wrong_type", item="thing 'A'", key="turns", value=inf, type="a whole number", allowed=Range(1, 9, "-"))),
    ({"name": ["A"], "mass_kg": [1.0], "on": [1.0]}, failure("not_boolean", item="thing 'A'", key="on", value=1.0)),
])
def test_columns_that_are_refused(columns: dict[str, Any], why: Failure) -> None:
    found = refused(lambda: things_of(ItemTable(**columns)))
    assert found == why


def test_a_number_of_numpy_is_told_as_what_it_holds() -> None:
    for given, told in ((np.float64(1.5), "1.5"), (np.bool_(True), "true"), (np.array([1.0, 2.0]), "[1.0, 2.0]")):
        wrong = NotAllowed("turns", given, "why")
        assert str(wrong).startswith(f"turns = {told} is ") and str(wrong).endswith(": why")
        assert json.loads(json.dumps(wrong.fields()))["value"] == given.tolist()


def test_columns_of_texts_and_of_truth() -> None:
    turned = things_of(ItemTable(name=["A", "B"], mass_kg=[1, 2], turns=[2, 3]))
    assert [(item.turns, type(item.turns)) for item in turned] == [(2, int), (3, int)]
    made = things_of(ItemTable(name=["A", "B"], mass_kg=[1, 2], on=[True, False], tags=["red", None], load_N=[10.0, 0.0]))
    assert [item.on for item in made] == [True, False] and [item.tags for item in made] == [["red"], []]
    assert [item.mass_kg for item in made] == [1, 2] and type(made[0].mass_kg) is float


@pytest.mark.parametrize("value, why", [
    (3, failure("not_table_list", key="thing", value=3, table="thing")),
    ([], failure("not_table_list", key="thing", table="thing")),
    ({}, failure("not_table_list", key="thing", table="thing")),
    ([dict(THING), 3], failure("not_table_list", key="thing", table="thing")),
    ([dict(THING), {"mass_kg": 1.0}], failure("missing_key", item="thing 2", key="name")),
    ([{"name": "A"}], failure("missing_key", item="thing 'A'", key="mass_kg", allowed=Range(0, 10, "kg", above=True))),
    ([{**THING, "mas_kg": 1.0}], failure("misspelt_key", item="thing 'A'", key="mas_kg", meant="mass_kg")),
    ([{**THING, "name": ""}], failure("empty_string", item="thing 1", key="name", value="")),
    ([{**THING, "name": 3}], failure("not_string", item="thing 1", key="name", value=3)),
    ([{**THING, "mass_kg": 0.0}], failure("out_of_range", item="thing 'A'", key="mass_kg", value=0.0, allowed=Range(0, 10, "kg", above=True))),
    ([{**THING, "mass_kg": 11}], failure("out_of_range", item="thing 'A'", key="mass_kg", value=11, allowed=Range(0, 10, "kg", above=True))),
    ([{**THING, "mass_kg": nan}], failure("number_not_finite", item="thing 'A'", key="mass_kg", value=nan, allowed=Range(0, 10, "kg", above=True))),
    ([{**THING, "load_N": -0.5}], failure("out_of_range", item="thing 'A'", key="load_N", value=-0.5, allowed=Range(0, 10, "N"))),
    ([{**THING, "ends_m": [0, 2]}], failure("out_of_range", item="thing 'A'", key="ends_m", value=[0, 2], allowed=Range(-1, 1, "m"))),
])
def test_items_that_are_refused(value: Any, why: Failure) -> None:
    assert refused(things_of, value) == why


def test_items_at_the_ends_of_their_ranges() -> None:
    made = things_of([{**THING, "mass_kg": 10.0, "load_N": 0.0, "force_N": 10}])[0]
    assert (made.mass_kg, made.load_N, made.force_N, type(made.force_N)) == (10, 0, 10, float)
    assert made == Thing(name="A", mass_kg=10, load_N=0, force_N=10)
    assert refused(Thing, name="", mass_kg=1) == failure("empty_string", key="name", value="")


# Keys by their path.
def test_keys_by_path() -> None:
    known = keys_of(Book)
    assert "part.arrays" not in known and "more.size_m" in known and "thing.*.mass_kg" in known and "thing.mass_kg" not in known
    assert attribute_of(Book, "thing.B.b.mass_kg").name == "mass_kg"
    assert refused(attribute_of, Book, "part.siez_m") == failure("misspelt_key", key="part.siez_m", meant="part.size_m")
    assert refused(attribute_of, Book, "part.old_m") == failure("key_renamed", key="part.old_m", now="part.size_m")


def test_values_are_set_by_path() -> None:
    data: dict[str, Any] = {"part": {"size_m": 1.0, "share": 1.0}, "thing": copy.deepcopy(THINGS)}
    set_value(Book, data, "part.size_m", 2.0)
    set_value(Book, data, "part.share", None)
    set_value(Book, data, "more.count", 4)
    set_value(Book, data, "thing.B.b.mass_kg", 7.0)
    set_value(Book, data, "thing.*.sort", "far")
    set_value(Book, data, "thing.A.load_N", None)
    assert data["part"] == {"size_m": 2.0} and data["more"] == {"count": 4}
    assert [(one["mass_kg"], one["sort"]) for one in data["thing"]] == [(1.0, "far"), (7.0, "far")]
    with pytest.warns(FutureWarning, match=r"^part.old_m\b.* part.size_m\b"):
        set_value(Book, data, "part.old_m", 3.0)
    assert data["part"] == {"size_m": 3.0}
    assert refused(set_value, Book, data, "part.zzzz", 1) == failure("misspelt_key", key="part.zzzz")
    assert refused(set_value, Book, data, "thing.Q.mass_kg", 1) == failure("no_such_key", key="thing.Q.mass_kg", known="A, B.b")
    assert refused(set_value, Book, data, "other.Q.mass_kg", 1) == failure("section_not_in_case", key="other.Q.mass_kg", table="other")


def test_many_values_are_filled_in_a_copy() -> None:
    data = {"part": dict(PART), "thing": copy.deepcopy(THINGS)}
    before = copy.deepcopy(data)
    made = filled(data, [("part.size_m", 2), ("more.count", 4), ("thing.B.b.mass_kg", 7), ("thing.*.load_N", 1),
                         ("thing.A.force_N", 9)])
    assert data == before and made["part"] == {"size_m": 2} and made["more"] == {"count": 4}
    assert [(one["mass_kg"], one["load_N"], one.get("force_N")) for one in made["thing"]] == [(1.0, 1, 9), (7, 1, 3.0)]


def test_values_are_read_by_path() -> None:
    made = book({"count": 5}, thing=copy.deepcopy(THINGS))
    assert value_of(made, "part.count") == 5 and value_of(made, "thing.B.b.mass_kg") == 10
    assert value_of(made, "thing.*.on") is False
    assert refused(value_of, made, "thing.*.mass_kg") == failure("several_values", key="thing.*.mass_kg", path="thing.*.mass_kg")
    assert refused(value_of, made, "thing.Q.mass_kg") == failure("no_such_key", key="thing.Q.mass_kg", known="A, B.b")
    with pytest.warns(FutureWarning, match=r"part.old_m\b.* part.size_m\b"):
        assert value_of(made, "part.old_m") == 1


def test_values_are_changed_without_the_case() -> None:
    made = book()
    changed = with_values(made, {"part.size_m": 2, "part.count": 4})
    assert (changed.part.size_m, changed.part.count, made.part.size_m) == (2, 4, 1)
    assert refused(with_values, made, {"part.size_m": 20}) == failure("out_of_range", key="part.size_m", value=20.0)


def test_keys_that_moved() -> None:
    data = {"part": {"old_m": 1.0, "count": 2}, "thing": [dict(THING)]}
    with pytest.warns(FutureWarning, match=r"^a.toml: part.old_m\b.* part.size_m\b"):
        moved = with_keys_moved(Book, data, "a.toml")
    assert moved == {"part": {"count": 2, "size_m": 1.0}, "thing": [dict(THING)]} and "old_m" in data["part"]
    with pytest.warns(FutureWarning):
        assert with_keys_moved(Book, {"more": {"old_share": 1}}) == {"more": {}, "part": {"share": 1}}
    with pytest.warns(FutureWarning):
        assert refused(with_keys_moved, Book, {"part": {"old_m": 1.0, "size_m": 2.0}}) == (
            failure("deprecated_key_duplicated", key="part.old_m", value=1.0, new_key="part.size_m", old_key="part.old_m"))
    with pytest.warns(FutureWarning):
        assert with_keys_moved(Book, {"more": {"old_share": 1}, "part": 3}) == {"more": {"old_share": 1}, "part": 3}
    for untouched in ({"part": 3}, {"part": {"size_m": 1}}, {}):
        assert with_keys_moved(Book, untouched) == untouched


# The schema that editors read.
def test_schema_of_every_form() -> None:
    def needs(key: str) -> str:
        needed = rule_of(fields_of(Part)[key]).needs()
        return needed[0].upper() + needed[1:]

    found = json_schema.section_schema(Part)
    keys = found["properties"]
    assert "arrays" not in keys and found["required"] == ["size_m"] and found["additionalProperties"] is False
    assert keys["size_m"] == {
        "type": "number", "exclusiveMinimum": 0, "maximum": 10, "x-unit": "m", "x-source": "how large",
        "description": f"{needs('size_m')}. Required (how large)."}
    assert keys["share"]["minimum"] == 0 and keys["share"]["default"] == 0.5
    assert keys["share"]["description"] == f"{needs('share')}. Default 0.5 (of all)."
    assert keys["count"]["type"] == "integer"
    assert keys["best"]["description"] == f"{needs('best')}. Optional." and "default" not in keys["best"]
    assert keys["on"] == {"type": "boolean", "default": True, "x-source": "whether",
                          "description": "True or false. Default true (whether)."}
    assert keys["word"] == {"type": "string", "pattern": "^[a-z]+$", "description": "Optional: what.", "x-source": "what"}
    assert keys["sort"]["enum"] == ["one", "two", "three"] and keys["sort"]["description"].startswith("Must be 'one' or ")
    assert (keys["place_m"]["type"], keys["place_m"]["minItems"], keys["place_m"]["maxItems"]) == ("array", 2, 2)
    assert keys["place_m"]["items"] == {"type": "number", "minimum": -1, "maximum": 1}
    assert "minItems" not in keys["bounds"] and keys["tags"]["items"] == {"type": "string", "enum": ["red", "blue"]}
    assert keys["notes"]["description"] == f"{needs('notes')}. Optional: anything."
    assert json_schema.section_schema(Thing)["properties"]["name"]["minLength"] == 1
    assert "allOf" not in json_schema.section_schema(Thing)
    if_one = {"properties": {"sort": {"const": "one"}}, "required": ["sort"]}
    conditions = [(one["if"]["properties"]["sort"]["const"], one["then"]) for one in found["allOf"]]
    assert found["allOf"][0]["if"] == if_one and found["allOf"][3]["if"] == if_one
    free = {"properties": {"count": False, "on": False, "best": False}}
    assert conditions == [
        ("one", {"properties": {"late_s": False, "word": False}}), ("two", {"required": ["late_s", "word"]}),
        ("three", {"required": ["word"], "properties": {"late_s": False}}),
        ("one", {"anyOf": [{"required": ["count", "on"]}, {"required": ["best"]}]}), ("two", free), ("three", free)]


def test_schemas_by_name(tmp_path: Path) -> None:
    assert refused(json_schema.schema, "trus") == (
        failure("misspelt_name", key="KIND", value="trus", meant="truss", allowed=tuple(json_schema.names())))
    written = json_schema.write_all(tmp_path)
    assert [path.name for path in written] == [f"{name}.schema.json" for name in json_schema.names()]
    for path in written:
        assert json.loads(path.read_text()) == json_schema.schema(path.name.partition(".")[0], alone=False)
    # What may stand in a file beside a case is not required in it.
    truss = json_schema.schema("truss")
    assert truss["required"] == ["case", "thermal", "truss"] and truss["properties"]["node"]["minItems"] == 1
    assert json_schema.head_line("truss", tmp_path / "a.toml").startswith("#:schema file://")
    inside = json_schema._paths.SCHEMA.parent / "cases/deep/a.toml"
    assert json_schema.head_line("truss", inside) == "#:schema ../../schema/truss.schema.json"


# TOML.
@pytest.mark.parametrize("content, why", [
    (b"a = [", failure("not_toml_at_line", line=1, cause="Invalid value")),
    (b"a = 1\nb = =\nc = 2\n", failure("not_toml_at_line", line=2, cause="Invalid value")),
    (b"a = 1\n\na = 2\n", failure("not_toml_at_line", line=3)),
    (b'a = """\n\n', failure("not_toml_at_line", line=2, cause="Unterminated string")),
    (b"a = '\xff'", failure("toml_not_utf8")),
    (b"a = " + 9000 * b"[", failure("toml_too_deep")),
    (b"a = " + 5000 * b"9", failure("not_toml")),
], ids=["list", "value", "twice", "open", "bytes", "deep", "digits"])
def test_what_is_no_toml(content: bytes, why: Failure, tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_bytes(content)
    assert refused(toml.read_toml, file, "case") == why.at(file=str(file))


def test_files_of_toml(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "a.toml"
    file.write_text("a = 1\n")
    assert toml.read_toml(file, "case") == ("a = 1\n", {"a": 1})
    assert refused(toml.read_toml, tmp_path / "b.toml", "campaign") == failure("case_file_not_found", of="campaign")
    assert refused(toml.read_toml, tmp_path, "case") == failure("read_failed", cause=os.strerror(errno.EISDIR))
    monkeypatch.setattr(toml, "LARGEST_BYTES", 6)
    assert toml.read_toml(file, "case")[1] == {"a": 1}
    monkeypatch.setattr(toml, "LARGEST_BYTES", 5)
    assert refused(toml.read_toml, file, "case") == failure("file_too_large", largest="5 bytes")


def test_errors_are_what_they_say() -> None:
    with pytest.raises(MissingKey) as missing:
        things_of([{"name": "A"}])
    assert missing.value.allowed.high == 10 and missing.value.item == "thing 'A'"  # type: ignore[union-attr]
    with pytest.raises(Unreadable):
        toml.read_toml("/nowhere/a.toml", "case")
