# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of a deck and of its included files."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from statejump.core.errors import Unreadable, printable, size
from statejump.core.reading import is_file

LARGEST_BYTES = 1 << 26  # of a deck with all its included files
DEEPEST = 10  # depth of included files


class Line(int):
    """A line number in a deck. If the line is in an included file, it also has the name of the file."""

    file: str | None = None

    @classmethod
    def of(cls, number: int, file: str | None) -> int:
        """Return a line number with the name of its file, if it is in an included file (not None)."""
        if file is None:
            return number
        line = cls(number)
        line.file = file
        return line

    def __str__(self) -> str:
        return f"{int(self)} of {self.file}"

    def __format__(self, how: str) -> str:
        return str(self)


def text_of(path: Path, most: int = LARGEST_BYTES) -> list[str]:
    """Return the lines of a text file. :raises Unreadable: the file does not exist, is too large, or is not text"""
    if not is_file(path):
        raise Unreadable(code="file_not_found", file=path)
    try:
        with path.open("rb") as stream:
            content = stream.read(most + 1)
        if len(content) > most:
            raise Unreadable(code="file_too_large", file=path, largest=size(LARGEST_BYTES))
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Comments may be in any encoding; names and numbers are ASCII.
        text = content.decode("latin-1")
        if "\x00" in text:
            raise Unreadable(code="not_text_file", file=path) from None
    except OSError as failure:
        raise Unreadable(code="read_failed", cause=failure.strerror, file=path) from None
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


class Source:
    """Reads a deck and its included files, which must be inside its folder.

    :param path: the deck
    :param included: function that returns the file named at a line, and how many lines name it; None: no INCLUDE
    """

    def __init__(self, path: Path, included: Callable[[list[str], int], tuple[str, int] | None]) -> None:
        self.path, self.included = path, included
        self.folder = path.resolve().parent
        self.bytes = 0

    def __iter__(self) -> Iterator[tuple[int, str]]:
        return self._lines(self.path, None, 0)

    def _lines(self, path: Path, name: str | None, depth: int) -> Iterator[tuple[int, str]]:
        lines = text_of(path, LARGEST_BYTES - self.bytes)
        self.bytes += sum(map(len, lines))
        skip = 0
        for place, line in enumerate(lines):
            if skip:
                skip -= 1
                continue
            found = self.included(lines, place)
            if found is None:
                yield Line.of(place + 1, name), line
                continue
            given, count = found
            skip = count - 1
            yield from self._lines(self._inside(Line.of(place + 1, name), given, depth), given, depth + 1)

    def has(self, given: str) -> bool:
        """Return whether a named file exists inside the folder of the deck."""
        path = self._path(given)
        return path is not None and path.is_relative_to(self.folder) and is_file(path)

    def _path(self, given: str) -> Path | None:
        try:
            return (self.folder / given).resolve()
        except (OSError, RuntimeError, ValueError):
            return None

    def _inside(self, line: int, given: str, depth: int) -> Path:
        shown = repr(printable(given))[:60]
        if depth >= DEEPEST:
            raise Unreadable(code="includes_too_deep", file=self.path, line=line, deepest=DEEPEST)
        path = self._path(given)
        if path is None:
            raise Unreadable(code="no_file_name", file=self.path, line=line, included=shown)
        if not path.is_relative_to(self.folder):
            raise Unreadable(code="include_outside", file=self.path, line=line, included=shown)
        if not is_file(path):
            raise Unreadable(code="included_file_not_found", file=self.path, line=line, included=shown)
        return path
