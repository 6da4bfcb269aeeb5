# SPDX-License-Identifier: GPL-3.0-or-later
"""Text columns of tables: every distinct text is stored once and has a number; a column stores these numbers."""
from __future__ import annotations

import random

import numpy as np
import pytest

from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import generate
from statejump.schema import texts as module
from statejump.schema.item_tables import ItemTable, once
from statejump.schema.texts import InBlocks, Names, Numbering, Texts, TextPool, coded


def test_numbers_are_those_of_the_order_of_appearance() -> None:
    chance = random.Random(1)
    known: dict[bytes, int] = {b"": 0}
    numbering = Numbering()
    for many in (0, 1, 700, 30, 1500):
        given = ["".join(chance.choices(["a", "b", "ä", "梁", "\0"], k=chance.randrange(6))).encode() for _ in range(many)]
        expected = [known.setdefault(text, len(known)) for text in given]
        assert numbering.numbers(given).tolist() == expected
    words = numbering.words
    assert len(words) == len(known) > 512 and words[0] is None
    assert words.listed(np.arange(1, len(words))) == [text.decode() for text in known if text]


@pytest.mark.parametrize("wrong", [[b"\xff"], [b"\xc3", b"\xa4"], [b"a", b"\xed\xa0\x80"]])
def test_every_text_by_itself_is_utf8(wrong: list[bytes]) -> None:
    numbering = Numbering()
    assert numbering.numbers([b"one", "zwölf".encode()]).tolist() == [1, 2]
    with pytest.raises(UnicodeDecodeError):
        numbering.numbers(wrong)
    assert numbering.numbers([b"three", b"one"]).tolist() == [3, 1]


def test_places_of_many_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "SHORT", 9)
    numbering = Numbering()
    for text in (b"12345", b"6789", b"abcdefgh", b"6789", b"ij"):
        numbering.numbers([text])
    assert numbering.words.listed(np.array([4, 3, 2, 1, 0])) == ["ij", "abcdefgh", "6789", "12345", None]
    assert [numbering.words[number] for number in range(5)] == [None, "12345", "6789", "abcdefgh", "ij"]


def test_texts_that_are_not_printed_are_known() -> None:
    words = TextPool(["a", "b\x1b", "ä", "\n"])
    words.add([b"c", b"d\x7f"])
    assert words.unprintable == [2, 4, 6]


@pytest.mark.parametrize("names", [Names(coded(np.array(["A", "Träger", "", "A"], dtype=object))),
                                   InBlocks(("A", "Träger", "", "A"))])
def test_names_are_a_sequence(names: Names | InBlocks, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "BLOCK", 3)
    expected = ("A", "Träger", "", "A")
    assert tuple(names) == expected and len(names) == 4
    assert [names[place] for place in range(4)] == list(expected) and tuple(names[1:3]) == expected[1:3]
    assert names.index("") == 2 and "B" not in names and names[np.int64(1)] == "Träger"
    with pytest.raises(IndexError):
        names[4]
    if isinstance(names, Names):
        assert names == expected and expected == names and names[-1] == "A" and names != expected[:3]


def test_texts_that_are_not_given() -> None:
    words = TextPool(["x", "y"])
    one = Texts(np.array([2, 0, 1]), words, "none")
    assert one.plain() == ["y", "none", "x"] and one.has("none").tolist() == [False, True, False]
    rows = Texts(np.array([[1, 0, 2], [0, 0, 0]]), words)
    assert rows.plain() == [["x", "y"], []] and rows.has("y").tolist() == [True, False]
    assert Texts(np.zeros((2, 0), int), words).plain() == [[], []]


@pytest.mark.parametrize("values, rows", [
    (np.full(5000, 0.3), 1), (np.full((5000, 2), [1.0, np.nan]), 1), (np.full(7, np.nan), 1),
    (np.array([0.0, -0.0]), 2), (np.arange(3), 3), (np.append(np.ones(4999), 2.0), 5000),
    (np.array([True, True]), 1), (np.array([None, None]), 2),
])
def test_rows_that_are_one_are_in_memory_once(values: np.ndarray, rows: int) -> None:
    found = once(values)
    assert found.dtype == values.dtype and found.shape == values.shape and found.tobytes() == values.tobytes()
    assert (len(found) if found.strides[0] else 1) == rows


@pytest.mark.parametrize("ends", [["N0", "\ud800"], ["N0", "Nö"], ["N0", "梁"], ["N0", "N11"]])
def test_the_same_sentence_on_a_name_that_is_not_there(ends: list[str]) -> None:
    document = generate.chain(3)
    names = [node["name"] for node in document["node"]]
    document["link"][1]["nodes"] = [names[0], *ends[1:]]
    with pytest.raises(StatejumpError) as one:
        parse_case(document)
    table = {section: ItemTable(**{key: [item[key] for item in document[section]] for key in keys}) for section, keys in
             (("link", [key for key in document["link"][0] if key != "nodes"]),)}["link"]
    table.columns["nodes"] = coded(np.array([link["nodes"] for link in document["link"]], dtype=object))
    with pytest.raises(StatejumpError) as other:
        parse_case({**document, "link": table})
    assert repr(str(other.value)) == repr(str(one.value)) and one.value.code.endswith("_reference")
