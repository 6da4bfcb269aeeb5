# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of the cards of a Nastran deck: free, small and large fields, continuations, replication, INCLUDE."""
from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from statejump.core.reading import finite_number
from statejump.kinds.truss.importing.lines import Source
from statejump.kinds.truss.importing.model import Deck, quoted

SMALL, LARGE, DATA_END, LINE_END = 8, 16, 72, 80
FREE_COMMA = 10  # a line has free fields if its first comma is within this many columns
MOST_FIELDS = 100_000  # largest number of fields of a card with its continuations
NAME = re.compile(r"[A-Z][A-Z0-9]{0,7}$")
# Old meshers and textbooks write BEGIN_BULK and BEGING BULK.
BEGIN_BULK = re.compile(r"\s*BEGIN(G?[\s_]+BULK\b|\s*$)", re.IGNORECASE)
REPEAT = re.compile(r"=\(?(\d+)\)?$")
# Step of a replicated field, *(1) or *1, and its last value, %(8.).
STEP, LAST = re.compile(r"\*(?:\((\S+)\)|([^()]+))$"), re.compile(r"%\((\S+)\)$")
COUNTED = re.compile(r"(.*-)(\d+)$")  # continuation mark that counts up in replicated lines
# A comma, blanks or both separate free fields. COSMIC's Nastran places a value by its field number: 8)246, )+M1.
SEPARATOR = re.compile(r"\s*,\s*|\s+")
SPACED_MARK = re.compile(r"(^|,)\s*([+*])\s+(?=\w)")  # MSC's decks write a mark as "+ A"
PLACED = re.compile(r"(\d{0,2})\)(.*)$")
MARK_FIELD = 10
# A number without the letter of its exponent, for example 7.+10 or 2.3-5.
BARE_EXPONENT = re.compile(r"([0-9.])([+-][0-9]+)$")
INCLUDE = re.compile(r"\s*INCLUDE\s+(\S.*)$|\s*INCLUDE(['\"].*)$", re.IGNORECASE)


@dataclass
class Card:
    """A card: number of its first line, name, and the fields after the name, including those of continuation lines."""

    line: int
    name: str
    fields: list[str] = field(default_factory=list)
    rule: list[str] = field(default_factory=list)  # replication rule for repeating the card before it

    def __getitem__(self, place: int) -> str:
        return self.fields[place] if place < len(self.fields) else ""

    def rows(self) -> list[list[str]]:
        """Return the fields by lines of eight."""
        return [(self.fields[at:at + 8] + [""] * 8)[:8] for at in range(0, len(self.fields), 8)]


def included(lines: list[str], place: int) -> tuple[str, int] | None:
    """Return the file of an INCLUDE, and the number of lines of the statement; a quoted name may span several."""
    found = INCLUDE.match(lines[place])
    if found is None:
        return None
    text = (found[1] or found[2]).strip()
    quote = text[0]
    if quote not in "'\"":
        return text.split("$")[0].strip(), 1
    count = 1
    while quote not in text[1:] and count < 20 and place + count < len(lines):
        text += lines[place + count].strip()
        count += 1
    return text[1:].split(quote)[0].strip(), count


def split(deck: Deck) -> tuple[list[tuple[int, str]], list[Card]]:
    """Divide a deck: return the lines of executive and case control, and the cards of the bulk data."""
    source = Source(deck.path, lambda lines, place: _included(deck, source, lines, place))
    lines = list(source)
    begin = next((place for place, (_, line) in enumerate(lines) if BEGIN_BULK.match(line)), None)
    if begin is None:
        for number, line in lines:
            if line.strip().upper() == "CEND":
                raise deck.fail(number, "deck_bad_syntax", problem="a CEND without BEGIN BULK")
    control = [] if begin is None else lines[:begin]
    return ([(number, text) for number, line in control if (text := line.split("$")[0].strip())],
            cards_of(deck, lines[0 if begin is None else begin + 1:]))


def _included(deck: Deck, source: Source, lines: list[str], place: int) -> tuple[str, int] | None:
    """Return the file of an INCLUDE. In the executive control, a file of the computing centre is refused like a card,
    because the user may know that it has no influence."""
    found = included(lines, place)
    if found is None or not any(line.strip().upper() == "CEND" for line in lines[place:]):
        return found
    if source.has(found[0]):
        return found
    deck.refuse("INCLUDE", "executive_include", place + 1, included=quoted(found[0]))
    return None


def cards_of(deck: Deck, lines: Iterable[tuple[int, str]]) -> list[Card]:
    """Return the cards. A continuation belongs to the card with the matching mark, else to the previous card."""
    cards: list[Card] = []
    marks = _Marks()
    orphans: list[tuple[int, str, list[str]]] = []
    last_mark, last_fields = "", [""] * 8
    continued = ""  # mark of the previous line, if it is a continuation
    for number, raw in lines:
        line = raw.split("$")[0].rstrip().expandtabs(SMALL)
        if not line.strip():
            continue
        if BEGIN_BULK.match(line):
            continue
        if line.upper().split()[0] == "BEGIN":
            raise deck.fail(number, "deck_several_models")
        head, fields, mark = _fields(deck, number, line)
        if head.upper().startswith("ENDDATA"):
            break
        if head.startswith("=") and _counted(continued):
            _repeat_continuations(deck, number, head, fields, last_fields, continued, marks)
            continue
        if head.startswith("=") and cards:
            _repeat(deck, number, head, fields, cards, marks, last_mark)
            card, continued = cards[-1], ""
        elif not head or head[0] in "+*)":
            own = last_mark if head == ")" else head[1:].strip(" +*")
            continued = own
            if {"=", "=="} & set(fields):
                fields = _repeated(deck, number, fields, last_fields)
            last_fields = fields
            if marked := marks.take(own):
                card = marked
            elif cards and not (own and last_mark):
                card = cards[-1]
            elif own and last_mark and own != last_mark:
                orphans.append((number, own, fields))
                continue
            else:
                raise deck.fail(number, "deck_bad_syntax", problem="a continuation of nothing")
            _extend(deck, number, card, fields)
        else:
            name = head.rstrip("*").strip().upper()
            if not NAME.match(name):
                raise deck.fail(number, "deck_bad_syntax", problem=f"{quoted(head)} is not the name of a card")
            card, continued = Card(number, name, fields), ""
            cards.append(card)
            deck.room(number, len(cards))
        if mark:
            marks.add(mark, card)
        last_mark = mark
    for number, own, fields in orphans:  # continuations that precede their card
        marked = marks.take(own)
        if marked is None:
            raise deck.fail(number, "deck_bad_syntax", problem=f"no card has the continuation mark {quoted(own)}")
        _extend(deck, number, marked, fields)
    return cards


class _Marks:
    """Finds cards by the continuation mark at the end of their last line. A continuation line repeats columns 2 to 8 of
    the mark. Its first column may be any character: +EG continues the mark PEG."""

    def __init__(self) -> None:
        self._cards: dict[str, Card] = {}
        self._whole: dict[str, str] = {}

    def add(self, mark: str, card: Card) -> None:
        """Note the mark of a card."""
        self._cards[mark] = card
        self._whole[mark[1:]] = mark

    def take(self, own: str) -> Card | None:
        """Return the card to which a continuation belongs; None if no card has its mark."""
        if not own:
            return None
        return self._cards.pop(own, None) or self._cards.pop(self._whole.get(own, ""), None)


def _repeat(deck: Deck, number: int, head: str, fields: list[str], cards: list[Card], marks: _Marks, mark: str) -> None:
    """Add cards that repeat the last card with changes.

    ``=`` repeats a field, ``*(x)`` or ``*x`` adds x to it, ``%(x)`` ends at x, ``==`` repeats all further fields.
    ``=(n)`` repeats the card n times, by the next fields or the previous replication line.
    """
    last = cards[-1]
    count = REPEAT.match(head)
    if count and any(fields):
        last.rule = _steps(deck, number, fields, last.fields, int(count[1]))
    if count is None:
        last = Card(number, last.name, _repeated(deck, number, fields, last.fields))
        last.rule = fields
        cards.append(last)
        return
    if not last.rule:
        raise deck.fail(number, "deck_bad_syntax", problem=f"{quoted(head)} repeats nothing")
    for _ in range(int(count[1])):
        deck.room(number, len(cards))
        following = Card(number, last.name, _repeated(deck, number, last.rule, last.fields))
        following.rule = last.rule
        cards.append(following)
        mark = _counted(mark)
        if mark:
            marks.add(mark, following)
        last = following


def _repeat_continuations(deck: Deck, number: int, head: str, rule: list[str], fields: list[str], mark: str,
                          marks: _Marks) -> None:
    """Add continuations that repeat the last one with changes, to the cards whose marks count up."""
    count = REPEAT.match(head)
    if count is None:
        raise deck.fail(number, "deck_bad_syntax", problem=f"{quoted(head)} repeats a continuation without a number")
    rule = _steps(deck, number, rule, fields, int(count[1]))
    for _ in range(int(count[1])):
        mark = _counted(mark)
        card = marks.take(mark)
        if card is None:
            raise deck.fail(number, "deck_bad_syntax", problem=f"no card has the continuation mark {quoted(mark)}")
        fields = _repeated(deck, number, rule, fields)
        _extend(deck, number, card, fields)


def _counted(mark: str) -> str:
    """Return the next mark, A-2 after A-1; empty if a mark does not count."""
    found = COUNTED.match(mark)
    return f"{found[1]}{int(found[2]) + 1}" if found else ""


def _steps(deck: Deck, number: int, rule: list[str], last: list[str], count: int) -> list[str]:
    """Return a rule with steps in place of last values."""
    made = list(rule)
    for place, text in enumerate(rule):
        if end := LAST.match(text):
            first = last[place] if place < len(last) else ""
            step = (_value(deck, number, end[1], first) - _value(deck, number, first or "0", text)) / max(count, 1)
            whole = end[1].isdecimal() and (first or "0").isdecimal()
            made[place] = f"*({round(step) if whole and step == round(step) else repr(step)})"
    return made


def _repeated(deck: Deck, number: int, rule: list[str], last: list[str]) -> list[str]:
    made = last + [""] * (len(rule) - len(last))
    for place, text in enumerate(rule):
        if text == "==":
            break
        if step := STEP.match(text):
            by = step[1] or step[2]
            more, value = _value(deck, number, by, made[place]), _value(deck, number, made[place] or "0", text)
            whole = (made[place] or "0").isdecimal() and more == int(more)
            made[place] = str(int(value + more)) if whole else repr(value + more)
        elif text != "=":
            made[place] = text
    return made


def number_of(text: str) -> float | None:
    """Return the number of a field, also with Fortran's exponents 1.d5 and 1.+5; None if it is none."""
    return finite_number(BARE_EXPONENT.sub(r"\1e\2", text.lower().replace("d", "e")))


def _value(deck: Deck, number: int, text: str, other: str) -> float:
    """Return a number of a replicated field. :raises Unreadable: it is none"""
    found = number_of(text)
    if found is None:
        raise deck.fail(number, "deck_bad_syntax", problem=f"{quoted(other)} and {quoted(text)} cannot be added")
    return found


def _extend(deck: Deck, number: int, card: Card, fields: list[str]) -> None:
    # The fields of a continuation begin at a multiple of eight; a half line of large fields is padded by the next line.
    if len(card.fields) > MOST_FIELDS:
        raise deck.fail(number, "deck_bad_syntax", problem=f"a card of more than {MOST_FIELDS} fields")
    if len(fields) == 8 and len(card.fields) % 8:
        card.fields += [""] * (8 - len(card.fields) % 8)
    card.fields += fields


def _fields(deck: Deck, number: int, line: str) -> tuple[str, list[str], str]:
    """Return the first field of a line, its data fields (8 in small or free form, 4 in large form), and its
    continuation mark."""
    if "," in line[:FREE_COMMA]:
        words = _words(deck, number, line)
        count = 4 if words[0].endswith("*") or words[0].startswith("*") else 8
        beyond = words[count + 1:]
        marked = bool(beyond) and beyond[0][:1] in ("+", "*")
        if beyond and not marked and (any(beyond[1:]) or number_of(beyond[0]) is not None):
            return words[0], words[1:], ""  # continues without a mark, because a mark is never a number
        if any(beyond[1:]):
            raise deck.fail(number, "deck_bad_syntax", problem=f"a line of more than {count + 2} free fields")
        mark = beyond[0] if beyond else ""
        return words[0], (words[1:count + 1] + [""] * count)[:count], mark.strip(" +*")
    head = line[:SMALL].strip()
    width = LARGE if head.endswith("*") or head.startswith("*") else SMALL
    fields = [line[at:at + width].strip() for at in range(SMALL, DATA_END, width)]
    return head, fields, line[DATA_END:LINE_END].strip(" +*")


def _words(deck: Deck, number: int, line: str) -> list[str]:
    """Return the free fields of a line; the first is empty in a continuation without a mark."""
    text = SPACED_MARK.sub(r"\1\2", line.strip())
    if line[0] in " ,":  # the first separator follows the empty field
        text = text[1:].lstrip() if text.startswith(",") else text
        given = ["", *SEPARATOR.split(text)]
    else:
        given = SEPARATOR.split(text)
    words: list[str] = []
    for word in given:
        placed = PLACED.match(word) if words else None
        if placed:
            place = int(placed[1] or MARK_FIELD) - 1
            if not len(words) <= place < MARK_FIELD:
                raise deck.fail(number, "deck_bad_syntax", problem=f"{quoted(word)} is behind its field")
            words += [""] * (place - len(words))
            word = placed[2]
            if not word:
                continue
        value = word.rstrip("/")
        if value or not word:
            words.append(value)
        words += [words[-1]] * (len(word) - len(value))  # slashes repeat the field before them
    return words
