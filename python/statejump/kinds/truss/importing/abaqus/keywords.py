# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of a deck of CalculiX or Abaqus: keywords with parameters and data lines, and ``*INCLUDE``."""
from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from statejump.core.reading import finite_number
from statejump.kinds.truss.importing.lines import Source
from statejump.kinds.truss.importing.model import Deck, quoted

Data = tuple[int, list[str]]
_NAME = re.compile(r"<\s*(\w+)\s*>")


@dataclass
class Block:
    """A keyword of a deck: line number, name and parameters in capitals, and data lines as words."""

    line: int
    name: str
    parameters: dict[str, str] = field(default_factory=dict)
    data: list[Data] = field(default_factory=list)


def words(text: str) -> list[str]:
    """Return the words between commas, without surrounding blanks; a comma in quotes does not separate."""
    if '"' not in text:
        return [word.strip() for word in text.split(",")]
    found, quoted = [""], False
    for sign in text:
        if sign == '"':
            quoted = not quoted
        elif sign == "," and not quoted:
            found.append("")
            continue
        found[-1] += sign
    return [word.strip() for word in found]


def unquoted(word: str) -> str:
    """Return a name without its quotes."""
    return word[1:-1] if len(word) > 1 and word[0] == word[-1] == '"' else word


def _keyword(text: str) -> tuple[str, dict[str, str]]:
    first, *rest = words(text[1:])
    parameters = {}
    for word in rest:
        key, _, value = word.partition("=")
        if key.strip():
            parameters[" ".join(key.upper().split())] = unquoted(value.strip())
    return " ".join(first.upper().split()), parameters


def _parameter(deck: Deck, number: int, text: str) -> dict[str, str]:
    """Return the name and the value of a line of ``*PARAMETER``."""
    name, _, value = (part.strip() for part in text.partition("#")[0].partition("="))
    if name and finite_number(value) is None:
        raise deck.fail(number, "deck_bad_number", "*PARAMETER", text=quoted(value),
                        wanted="a finite number; write numbers in place of expressions")
    return {name: value} if name else {}


def included(lines: list[str], place: int) -> tuple[str, int] | None:
    """Return the file that an ``*INCLUDE`` names, and the number of lines of this statement."""
    text = lines[place].strip()
    if not text[:8].upper() == "*INCLUDE":
        return None
    count = 1
    while text.endswith(",") and place + count < len(lines):
        text += lines[place + count].strip()
        count += 1
    name, parameters = _keyword(text)
    return (parameters.get("INPUT", ""), count) if name == "INCLUDE" else None


def blocks(deck: Deck, path: Path) -> Iterator[Block]:
    """Yield every keyword with its data lines, without empty lines. The name of a ``*PARAMETER`` in angle brackets is
    replaced by the value."""
    current: Block | None = None
    joined, begun = "", 0
    values: dict[str, str] = {}
    for number, raw in Source(path, included):
        text = raw.strip()
        if not text or text.startswith("**"):
            continue
        if values and "<" in text:
            text = _NAME.sub(lambda found: values.get(found[1], found[0]), text)
        if joined or text.startswith("*"):
            begun = begun or number
            joined += text
            if joined.endswith(","):
                continue
            if current is not None:
                yield current
            current = Block(begun, *_keyword(joined))
            joined, begun = "", 0
            continue
        if current is None:
            raise deck.fail(number, "deck_bad_syntax", problem="data before the first keyword")
        if current.name == "PARAMETER":
            values.update(_parameter(deck, number, text))
            continue
        line = words(text)
        if line[-1] == "" and len(line) > 1:
            line.pop()
        if any(line):
            current.data.append((number, [unquoted(word) for word in line]))
    if current is not None:
        yield current
