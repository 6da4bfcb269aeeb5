# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts many C++ mutants into one build: the mutated statement is compiled beside the original and selected at run time.

One compilation serves all mutants, so that a mutant costs only a run of its tests. A mutant whose statement cannot be
duplicated (a declaration with deduced type, a constant expression) is compiled separately.
"""
from __future__ import annotations

import re
from dataclasses import dataclass

from operators import Mutant, blanked

VARIABLE = "STATEJUMP_MUTANT"
# Inserted before the first include of every source: number of the selected mutant.
SWITCH = f"""#pragma once
#include <cstdlib>
namespace statejump_mutation {{
inline const int chosen = std::getenv("{VARIABLE}") ? std::atoi(std::getenv("{VARIABLE}")) : 0;
}}
"""
CHOSEN = "statejump_mutation::chosen"

_BLOCK = re.compile(r"(?:\)|\belse|\bdo|\bconst|\bnoexcept|\boverride|\btry|->[^;{}()]*|\bnamespace\s*[\w:]*|"
                    r"\b(?:struct|class|enum)\b[^;{}()]*) $")
_CONTROL = re.compile(r"(?:else\s+)?(?:if|for|while)\s*\(|else\s+|"
                      r"(?:case\s[^;{}()]*?[^:]:(?!:)|default:|public:|private:)\s*")
_SCALAR = re.compile(r"(?:static\s+)?(?:const\s+)?(?:double|float|int|bool|std::size_t|Eigen::Index|std::u?int\d+_t)\s+"
                     r"\w+\s=\s(.*)$", re.S)
_TYPED = re.compile(r"(?:const\s+)?((?!auto\b|return\b|constexpr\b|static\b|using\b)[A-Za-z_][\w:]*(?:<[^=;]*>)?)"
                    r"\s+\w+\s=\s(.*)$", re.S)
_DECLARES = re.compile(r"(?:const\s|constexpr\s|static\s|auto\b|using\b|template\b|"
                       r"[\w:]+(?:<[^=;]*>)?[&*]*\s+[&*]*\w+\s*(?:[({=]|$))")


@dataclass(frozen=True)
class _Place:
    """Part ``text[start:end]`` of a source to duplicate; ``kind`` determines the form of the copy."""

    start: int
    end: int
    kind: str


def switched(text: str, numbered: dict[int, Mutant]) -> tuple[str, dict[int, tuple[int, int]]]:
    """Return a source that includes mutants, and the first and last line of each included mutant's statement. Line
    numbers do not change."""
    code, bare = blanked(text), blanked(text, strings=False)
    taken: list[tuple[_Place, int, Mutant]] = []
    for number, mutant in sorted(numbered.items(), key=lambda item: item[1]):
        place = _place(code, mutant)
        if place is not None and all(place.end <= other.start or other.end <= place.start for other, _, _ in taken):
            taken.append((place, number, mutant))
    lines = {}
    for place, number, mutant in sorted(taken, key=lambda item: -item[0].start):
        was = text[place.start: place.end]
        changed = bare[place.start: mutant.start] + mutant.replacement + bare[mutant.end: place.end]
        text = text[: place.start] + _doubled(place.kind, " ".join(changed.split()), was, number) + text[place.end:]
        first = code.count("\n", 0, place.start) + 1
        lines[number] = first, first + was.count("\n")
    return text, lines


def _doubled(kind: str, changed: str, was: str, number: int) -> str:
    on = f"{CHOSEN} == {number}"
    if kind == "condition":
        return f"({on}) ? static_cast<bool>({changed}) : static_cast<bool>({was})"
    if kind == "value":
        return f"({on}) ? ({changed}) : ({was})"
    if kind == "removed":
        return f"{{ if (!({on})) {{ {was} }} }}"  # braces, so that an else that follows does not belong to this if
    if kind == "return":
        return f"{{ if ({on}) {changed} {was} }}"
    if kind == "statement":
        return f"{{ if ({on}) {{ {changed} }} else {{ {was} }} }}"
    return f"[&]() -> {kind} {{ if ({on}) return {changed}; return {was}; }}()"


def _place(code: str, mutant: Mutant) -> _Place | None:
    """Return the part of the source to duplicate for a mutant; None: the mutant must be compiled separately."""
    if mutant.operator == "removed statement":
        return _Place(mutant.start, mutant.end, "removed")
    start = _start(code, mutant.start)
    if start is None:
        return None
    end = _end(code, mutant.end)
    while found := _CONTROL.match(code, start, end):
        if not found.group().endswith("("):
            start = found.end()
            continue
        close = _closing(code, found.end())
        if mutant.start < close:
            return _header(code, found.group(), found.end(), close, mutant)
        start = close + 1
        start += len(code[start:end]) - len(code[start:end].lstrip())
    return _statement(code, start, end, mutant)


def _statement(code: str, start: int, end: int, mutant: Mutant) -> _Place | None:
    whole = code[start:end]
    if code[end: end + 1] != ";" or "{" in whole and re.search(r"\]\s*(?:\([^)]*\))?\s*(?:->[^{]*)?\{", whole):
        return None  # a function within
    if whole.startswith("return"):
        return _Place(start, end + 1, "return")
    for pattern in (_SCALAR, _TYPED):
        found = pattern.match(whole)
        if found and "constexpr" not in whole:
            value = found.start(found.lastindex or 1)
            kind = "value" if pattern is _SCALAR else found.group(1)
            inside = mutant.start >= start + value
            return _Place(start + value, end, kind) if inside else None
    if _DECLARES.match(whole) or not re.match(r"[A-Za-z_*(+\-]", whole):
        return None
    return _Place(start, end + 1, "statement")


def _header(code: str, control: str, start: int, close: int, mutant: Mutant) -> _Place | None:
    parts, place = [], start
    for part in _split(code[start:close]):
        parts.append((place, place + len(part)))
        place += len(part) + 1
    if "for" in control:
        if len(parts) != 3:
            return None
        first, last = parts[1]
        if not first <= mutant.start < last:
            return None
    else:
        first, last = parts[-1]
        if not first <= mutant.start < last:
            return None
    blank = len(code[first:last]) - len(code[first:last].lstrip())
    if re.match(r"(?:const|auto|double|int)\b", code[first + blank: last]):
        return None
    return _Place(first + blank, last, "condition")


def _split(text: str) -> list[str]:
    """Split at semicolons outside brackets."""
    parts, depth, begin = [], 0, 0
    for place, letter in enumerate(text):
        depth += {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}.get(letter, 0)
        if letter == ";" and depth == 0:
            parts.append(text[begin:place])
            begin = place + 1
    return [*parts, text[begin:]]


def _closing(code: str, place: int) -> int:
    depth = 1
    while depth:
        depth += {"(": 1, ")": -1}.get(code[place], 0)
        place += 1
    return place - 1


def _start(code: str, place: int) -> int | None:
    """Return the beginning of the statement at a position."""
    depth = 0
    for at in range(place - 1, -1, -1):
        letter = code[at]
        if letter in ")]":
            depth += 1
        elif letter in "([":
            depth = max(depth - 1, 0)
        elif letter == "}" and depth == 0 and not re.match(r"\s*\n|\s*$|\s*else", code[at + 1: place]):
            return None  # a list of values, or a nested function
        elif depth == 0 and (letter in ";}" or letter == "{" and _BLOCK.search(code[max(0, at - 120): at])):
            if letter == ";" and _in_for(code, at):
                continue
            begin = at + 1
            return begin + len(code[begin:place]) - len(code[begin:place].lstrip())
        elif letter == "{" and depth == 0 and code[max(0, at - 1): at] == " " and not re.search(
                r"(?:return|=|,|\() $", code[max(0, at - 8): at]):
            return None
    return None


def _in_for(code: str, place: int) -> bool:
    """Return whether a semicolon belongs to the head of a for statement."""
    line = code.rfind("for (", 0, place)
    return line >= 0 and _closing_or_end(code, line + 5) > place


def _closing_or_end(code: str, place: int) -> int:
    try:
        return _closing(code, place)
    except IndexError:
        return len(code)


def _end(code: str, place: int) -> int:
    """Return the end position of a statement: its semicolon, or the closing bracket that encloses it."""
    depth = 0
    while place < len(code):
        letter = code[place]
        if letter in "({[":
            depth += 1
        elif letter in ")}]":
            depth -= 1
        elif letter == ";" and depth <= 0:
            return place
        elif letter == "{" and depth <= 0:
            return place
        place += 1
    return place
