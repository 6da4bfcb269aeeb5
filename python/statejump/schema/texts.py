# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of texts, by which items call each other: every text once, and where each stands.

A million texts as objects take ten times the bytes that they have. Here they are bytes one behind the other, and
objects only while somebody looks at them.
"""
from __future__ import annotations

from array import array
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count
from typing import Any, overload

import numpy as np

BLOCK = 4096  # texts or items that are turned into objects at once
SHORT = (1 << 32) - 1  # bytes of texts whose places are numbers of 4 bytes
# UTF-8, and as it is what Python takes from elsewhere and UTF-8 has not.
_AS_IT_IS = "surrogatepass"


class Words:
    """Texts by number, as UTF-8. Number 0 is no text.

    :param texts: those of the numbers from 1 on
    """

    def __init__(self, texts: Iterable[str] = ()) -> None:
        self._bytes = bytearray()
        self._begins = array("I", (0, 0))  # of every word and of the next one
        self.unprintable: list[int] = []  # numbers of those that have characters which are not printed
        self.add([text.encode(errors=_AS_IT_IS) for text in texts], _AS_IT_IS)

    def add(self, texts: Sequence[bytes], errors: str = "strict") -> None:
        """Give texts the next numbers.

        :param errors: what is made of what is not UTF-8, as bytes.decode() takes it
        :raises UnicodeDecodeError: one is not UTF-8; none is added
        """
        joined = b"".join(texts)
        if not (joined.isascii() and joined.decode().isprintable()):
            shown = [text.decode(errors=errors).isprintable() for text in texts]
            self.unprintable += [number for number, good in enumerate(shown, start=len(self)) if not good]
        ends = np.cumsum(np.fromiter(map(len, texts), np.int64, len(texts))) + len(self._bytes)
        self._bytes += joined
        if len(self._bytes) > SHORT:
            self._begins = array("q", self._begins)
        self._begins.frombytes(ends.astype(self._begins.typecode).tobytes())

    def __len__(self) -> int:
        return len(self._begins) - 1

    def __getitem__(self, number: int) -> str | None:
        if not number:
            return None
        return self._bytes[self._begins[number]:self._begins[number + 1]].decode(errors=_AS_IT_IS)

    def listed(self, numbers: np.ndarray) -> list[str | None]:
        """Return the texts of numbers (n,)."""
        begins = np.asarray(self._begins)
        places = zip(numbers.tolist(), begins[:-1][numbers].tolist(), begins[1:][numbers].tolist())
        return [self._bytes[begin:end].decode(errors=_AS_IT_IS) if number else None for number, begin, end in places]

    def are(self, numbers: np.ndarray, texts: Sequence[bytes]) -> np.ndarray:
        """Return which numbers (n,) are of these texts, n of them and none empty."""
        begins = np.asarray(self._begins)
        length = np.fromiter(map(len, texts), np.int64, len(texts))
        found = np.asarray(begins[1:][numbers] - begins[numbers] == length)
        if not found.all():
            found[found] = self.are(numbers[found], [text for text, same in zip(texts, found) if same])
            return found
        ends = np.cumsum(length)
        where = np.repeat(begins[numbers] - (ends - length), length) + np.arange(length.sum())
        same = np.frombuffer(self._bytes, np.uint8)[where] == np.frombuffer(b"".join(texts), np.uint8)
        return found if same.all() else np.asarray(np.logical_and.reduceat(same, ends - length))


class Numbering:
    """Gives texts their numbers among words, new ones to those that are new: a table of hashes with open addresses,
    in arrays. It is let go when all texts are read.

    :param of: returns the hash of a text
    """

    def __init__(self, of: Any = hash) -> None:
        self.words = Words()
        self._of = of
        self._hash = array("I", (0,))  # of every word
        self._table = np.zeros(1 << 10, np.int32)  # numbers of words, from the place of their hash on; 0: free

    def numbers(self, texts: Sequence[bytes]) -> np.ndarray:
        """Return the numbers of texts, 0 of those that are empty.

        :raises UnicodeDecodeError: a text is not UTF-8
        """
        own: defaultdict[bytes, int] = defaultdict(count().__next__)
        places = np.fromiter(map(own.__getitem__, texts), np.int32, len(texts))
        return self._found(list(own))[places]

    def _found(self, texts: list[bytes]) -> np.ndarray:
        """Return the numbers of texts that are all different."""
        hashes = np.fromiter(map(self._of, texts), np.int64, len(texts)).astype(np.uint32)
        found = np.zeros(len(texts), np.int32)
        left = np.flatnonzero(np.fromiter(map(len, texts), np.int64, len(texts)))
        new = [left[:0]]
        place = self._place(hashes[left])
        while len(left):
            there = self._table[place]
            new.append(left[there == 0])
            left, place, there = (part[there != 0] for part in (left, place, there))
            same = np.frombuffer(self._hash, np.uint32)[there] == hashes[left]
            same[same] = self.words.are(there[same], [texts[text] for text in left[same]])
            found[left[same]] = there[same]
            left, place = left[~same], self._place(place[~same] + 1)
        added = np.sort(np.concatenate(new))
        first = len(self.words)
        self.words.add([texts[text] for text in added])
        self._hash.frombytes(hashes[added].tobytes())
        found[added] = np.arange(first, len(self.words))
        self._insert(found[added])
        return found

    def _place(self, hashes: np.ndarray) -> np.ndarray:
        return hashes & np.uint32(len(self._table) - 1)

    def _insert(self, numbers: np.ndarray) -> None:
        if 2 * len(self.words) > len(self._table):
            self._table = np.zeros(2 << len(self.words).bit_length(), np.int32)
            numbers = np.arange(1, len(self.words), dtype=np.int32)
        place = self._place(np.frombuffer(self._hash, np.uint32)[numbers])
        while len(numbers):
            free = self._table[place] == 0
            self._table[place[free]] = numbers[free]
            others = self._table[place] != numbers  # of several for one place the last has it
            numbers, place = numbers[others], self._place(place[others] + 1)


@dataclass(frozen=True, eq=False)
class Texts:
    """A column of texts.

    :param numbers: places in ``words`` (n,), or (n, k) of lists; 0: none
    :param words: the texts
    :param none: what stands for none, the default of the key
    """

    numbers: np.ndarray
    words: Words
    none: str | None = None

    @property
    def ndim(self) -> int:
        """1 for texts, 2 for lists of them."""
        return self.numbers.ndim

    @property
    def shape(self) -> tuple[int, ...]:
        """Of ``numbers``."""
        return self.numbers.shape

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, places: slice) -> Texts:
        return replace(self, numbers=self.numbers[places])

    def at(self, place: int) -> str | None:
        """Return one text of a column that is not of lists."""
        found = self.words[int(self.numbers[place])]
        return self.none if found is None else found

    def plain(self) -> list[Any]:
        """Return the texts or lists as a document has them."""
        used, which = np.unique(self.numbers, return_inverse=True)
        word = self.words.listed(used)  # one object of a text, however often it stands here
        listed = [word[place] for place in which.reshape(-1).tolist()]
        if self.ndim == 2:
            ends = self.numbers.shape[1] * np.arange(1 + len(self))
            return [[text for text in listed[begin:end] if text is not None] for begin, end in zip(ends, ends[1:])]
        return listed if self.none is None else [self.none if text is None else text for text in listed]

    def given(self) -> np.ndarray:
        """Return which are given, of the shape of ``numbers``."""
        return np.asarray(self.numbers != 0)

    def has(self, text: str) -> np.ndarray:
        """Return which rows (n,) are this text, or lists with it."""
        used = self.used()
        same = [word == text for start in range(0, len(used), BLOCK)
                for word in self.words.listed(used[start:start + BLOCK])]
        known = np.zeros(len(self.words), dtype=bool)
        known[used] = same
        found: np.ndarray = known[self.numbers]
        if self.ndim == 2:
            return np.asarray(found.any(axis=1))
        return np.asarray(found | (self.numbers == 0)) if self.none == text else found

    def used(self) -> np.ndarray:
        """Return the places of the words that stand in it, ascending; none is no word."""
        found = np.zeros(len(self.words), dtype=bool)
        found[self.numbers] = True
        found[0] = False
        return np.flatnonzero(found)


def coded(values: np.ndarray) -> Texts:
    """Return a column of texts as such; None and, in lists, "" stand for none."""
    words: dict[Any, int] = {None: 0}
    flat = [text if text or values.ndim == 1 else None for text in values.reshape(-1).tolist()]
    numbers = np.fromiter((words.setdefault(text, len(words)) for text in flat), np.int32, len(flat))
    return Texts(numbers.reshape(values.shape), Words(text for text in words if text is not None))


class Names(Sequence[str]):
    """Names of items, made when they are asked for.

    :param texts: one a row, none is missing
    """

    def __init__(self, texts: Texts) -> None:
        self._texts = texts

    def __len__(self) -> int:
        return len(self._texts)

    @overload
    def __getitem__(self, place: int) -> str: ...

    @overload
    def __getitem__(self, place: slice) -> Names: ...

    def __getitem__(self, place: int | slice) -> str | Names:
        if isinstance(place, slice):
            return Names(self._texts[place])
        return str(self._texts.at(place))

    def __iter__(self) -> Iterator[str]:
        for start in range(0, len(self), BLOCK):
            yield from self._texts[start:start + BLOCK].plain()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and len(self) == len(other) and all(
            one == two for one, two in zip(self, other))

    __hash__ = None  # type: ignore[assignment]  # as of a list

    def __repr__(self) -> str:
        return f"Names({len(self)})"


class InBlocks(Sequence[str]):
    """Names for whoever asks for one after the other by their places: some at a time are objects."""

    def __init__(self, names: Sequence[str]) -> None:
        self._names, self._start, self._block = names, -1, list[str]()

    def __len__(self) -> int:
        return len(self._names)

    @overload
    def __getitem__(self, place: int) -> str: ...

    @overload
    def __getitem__(self, place: slice) -> Sequence[str]: ...

    def __getitem__(self, place: int | slice) -> str | Sequence[str]:
        if isinstance(place, slice):
            return self._names[place]
        start = place - place % BLOCK
        if start != self._start:
            self._start, self._block = start, list(self._names[start:start + BLOCK])
        return self._block[place - start]
