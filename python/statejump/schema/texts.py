# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of texts by which items refer to each other. Every different text is stored once; a use is its index.

A million texts as Python objects take ten times the memory of their bytes. This module stores them as consecutive
bytes, and creates an object only when a text is accessed.
"""
from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, overload

import numpy as np

BLOCK = 4096  # texts or items that are converted to objects at a time
SHORT = (1 << 32) - 1  # size of texts below which 4 bytes are enough for an index
# UTF-8, and unchanged bytes for Python texts that UTF-8 does not allow.
_AS_IT_IS = "surrogatepass"


class TextPool:
    """Texts by number, stored as UTF-8. Number 0 means a missing text.

    :param texts: the texts with the numbers 1, 2, ...
    """

    def __init__(self, texts: Iterable[str] = ()) -> None:
        self._bytes = bytearray()
        self._begins = array("I", (0, 0))  # begin of every word, and of the next one
        self.unprintable: list[int] = []  # numbers of words with unprintable characters
        self.add([text.encode(errors=_AS_IT_IS) for text in texts], _AS_IT_IS)

    def add(self, texts: Sequence[bytes], errors: str = "strict") -> None:
        """Append texts, which get the next numbers.

        :param errors: how to treat invalid UTF-8, as for bytes.decode()
        :raises UnicodeDecodeError: a text is not valid UTF-8; none of the texts is appended
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


class Numbering:
    """Assigns numbers to texts while files are read; a new text gets a new number. Not needed after that."""

    def __init__(self) -> None:
        self.words = TextPool()
        self._numbers = {b"": 0}

    def numbers(self, texts: Sequence[bytes]) -> np.ndarray:
        """Return the numbers of texts. Empty texts have the number 0.

        :raises UnicodeDecodeError: a text is not UTF-8
        """
        known, first = self._numbers, len(self.words)
        new = [text for text in dict.fromkeys(texts) if text not in known]
        self.words.add(new)
        known.update(zip(new, range(first, len(self.words))))
        return np.fromiter(map(known.__getitem__, texts), np.int32, len(texts))


@dataclass(frozen=True, eq=False)
class Texts:
    """A column of texts.

    :param numbers: indices in ``words`` (n,), or (n, k) for lists; index 0 means a missing text
    :param words: the different texts
    :param none: text that replaces a missing one, the default of the key
    """

    numbers: np.ndarray
    words: TextPool
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
        """Return the texts or lists as in a document."""
        used, which = np.unique(self.numbers, return_inverse=True)
        word = self.words.listed(used)  # one object per text, for any number of uses
        listed = [word[place] for place in which.reshape(-1).tolist()]
        if self.ndim == 2:
            ends = self.numbers.shape[1] * np.arange(1 + len(self))
            return [[text for text in listed[begin:end] if text is not None] for begin, end in zip(ends, ends[1:])]
        return listed if self.none is None else [self.none if text is None else text for text in listed]

    def given(self) -> np.ndarray:
        """Return which entries exist, with the shape of ``numbers``."""
        return np.asarray(self.numbers != 0)

    def has(self, text: str) -> np.ndarray:
        """Return for each row (n,) whether it equals a text or, for lists, contains it."""
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
        """Return the indices of the texts that are used, in ascending order, without the missing text."""
        found = np.zeros(len(self.words), dtype=bool)
        found[self.numbers] = True
        found[0] = False
        return np.flatnonzero(found)


def coded(values: np.ndarray) -> Texts:
    """Convert a column of objects to a column of texts. None and, in lists, "" mean a missing text."""
    words: dict[Any, int] = {None: 0}
    flat = [text if text or values.ndim == 1 else None for text in values.reshape(-1).tolist()]
    numbers = np.fromiter((words.setdefault(text, len(words)) for text in flat), np.int32, len(flat))
    return Texts(numbers.reshape(values.shape), TextPool(text for text in words if text is not None))


class Names(Sequence[str]):
    """Names of items; a name becomes an object on access.

    :param texts: column of the names; no name is missing
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
    """Names for access in ascending order of their indices. Only one block of names at a time is held as objects."""

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
