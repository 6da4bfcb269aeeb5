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
    lines = list(Source(deck.path, included))
    begin = next((place for place, (_, line) in enumerate(lines) if BEGIN_BULK.match(line)), None)
    if begin is None:
        for number, line in lines:
            if line.strip().upper() == "CEND":
                raise deck.fail(number, "deck_bad_syntax", problem="a CEND without BEGIN BULK")
    control = [] if begin is None else lines[:begin]
    return ([(number, text) for number, line in control if (text := line.split("$")[0].strip())],
            _cards(deck, lines[0 if begin is None else begin + 1:]))


def _cards(deck: Deck, lines: Iterable[tuple[int, str]]) -> list[Card]:
    """Return the cards. A continuation belongs to the card with the matching mark, else to the previous card."""
    cards: list[Card] = []
    marks = _Marks()
    orphans: list[tuple[int, str, list[str]]] = []
    last_mark, last_fields = "", [""] * 8
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
        if head.startswith("=") and cards:
            _repeat(deck, number, head, fields, cards)
            card = cards[-1]
        elif not head or head[0] in "+*":
            own = head[1:].strip(" +*")
            if {"=", "=="} & set(fields):
                fields = _repeated(deck, number, fields, Card(number, head, last_fields))
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
            card = Card(number, name, fields)
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


def _repeat(deck: Deck, number: int, head: str, fields: list[str], cards: list[Card]) -> None:
    """Add cards that repeat the last card with changes. ``=`` repeats a field, ``*(x)`` adds x to it, ``==`` repeats
    all further fields. ``=(n)`` repeats the card n times, by the next fields or the previous replication line."""
    last = cards[-1]
    count = REPEAT.match(head)
    if count and any(fields):
        last.rule = fields
    if count is None:
        last = Card(number, last.name, _repeated(deck, number, fields, last))
        last.rule = fields
        cards.append(last)
        return
    if not last.rule:
        raise deck.fail(number, "deck_bad_syntax", problem=f"{quoted(head)} repeats nothing")
    for _ in range(int(count[1])):
        deck.room(number, len(cards))
        following = Card(number, last.name, _repeated(deck, number, last.rule, last))
        following.rule = last.rule
        cards.append(following)
        last = following


def _repeated(deck: Deck, number: int, rule: list[str], last: Card) -> list[str]:
    made = last.fields + [""] * (len(rule) - len(last.fields))
    for place, text in enumerate(rule):
        if text == "==":
            break
        if text.startswith("*("):
            step, value = finite_number(text[2:].rstrip(")")), finite_number(made[place] or "0")
            if step is None or value is None:
                raise deck.fail(number, "deck_bad_syntax",
                                problem=f"{quoted(text)} cannot be added to {quoted(made[place])}")
            whole = (made[place] or "0").isdecimal() and step == int(step)
            made[place] = str(int(value + step)) if whole else repr(value + step)
        elif text != "=":
            made[place] = text
    return made


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
        words = [word.strip() for word in line.split(",")]
        count = 4 if words[0].endswith("*") or words[0].startswith("*") else 8
        beyond = words[count + 1:]
        if beyond and beyond[0] and beyond[0][0] not in "+*" and (any(beyond[1:]) or _is_number(beyond[0])):
            return words[0], words[1:], ""  # continues without a mark, because a mark is never a number
        if any(beyond[1:]):
            raise deck.fail(number, "deck_bad_syntax", problem=f"a line of more than {count + 2} free fields")
        mark = words[count + 1] if len(words) > count + 1 else ""
        return words[0], (words[1:count + 1] + [""] * count)[:count], mark.strip(" +*")
    head = line[:SMALL].strip()
    width = LARGE if head.endswith("*") or head.startswith("*") else SMALL
    fields = [line[at:at + width].strip() for at in range(SMALL, DATA_END, width)]
    return head, fields, line[DATA_END:LINE_END].strip(" +*")


def _is_number(text: str) -> bool:
    return finite_number(BARE_EXPONENT.sub(r"\1e\2", text.lower().replace("d", "e"))) is not None
