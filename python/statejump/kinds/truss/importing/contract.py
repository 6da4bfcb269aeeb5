# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables that declare every card of a deck, and every field of a card, as used, without influence, or unsupported. The
import refuses cards by these tables, and the documentation is generated from them."""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

USED, IDLE, REFUSED = "used", "no influence", "not supported"
BLANK = "-"  # a position that must be empty


@dataclass(frozen=True)
class Field:
    """A field of a card or a parameter of a keyword.

    :param why: reason why the field has no influence or is not supported
    """

    name: str
    use: str = USED
    why: str = ""


@dataclass(frozen=True)
class Card:
    """A card of Nastran or a keyword of CalculiX and Abaqus.

    :param what: result of a used card, or reason why the card is not used
    :param fields: fields in the order of the card; those of keywords have no order
    :param repeats: number of fields at the end of the card that may repeat
    :param sets: kind of set by which the case control selects it
    :param own: whether its reader locates the fields itself, because their positions depend on values
    """

    name: str
    use: str
    what: str
    fields: tuple[Field, ...] = ()
    repeats: int = 0
    sets: str = ""
    own: bool = False

    def field(self, place: int) -> Field | None:
        """Return the field at a position after the name of the card; None if the card has no field there."""
        if place < len(self.fields):
            return self.fields[place]
        return self.fields[len(self.fields) - self.repeats + (place - len(self.fields)) % self.repeats] \
            if self.repeats else None

    def parameter(self, name: str) -> Field | None:
        """Return the parameter of a name."""
        return next((field for field in self.fields if field.name == name), None)


def used(name: str, what: str, layout: str = "", *, idle: Mapping[str, str] | None = None,
         refused: Mapping[str, str] | None = None, repeats: int = 0, sets: str = "", own: bool = False) -> Card:
    """Declare a card that the import uses.

    :param layout: names of all fields in their order, separated by blanks
    :param idle: reasons why fields have no influence, by field names separated by blanks
    :param refused: reasons why fields are unsupported, by field names separated by blanks
    :raises ValueError: a reason names a field that the layout lacks, or a field has two reasons
    """
    names = layout.split()
    reasons: dict[str, tuple[str, str]] = {}
    for use, given in ((IDLE, idle or {}), (REFUSED, refused or {})):
        for several, why in given.items():
            for one in several.split():
                if one in reasons or one not in names:
                    raise ValueError(f"field {one} of {name} is in no class or in two")
                reasons[one] = (use, why)
    if len(set(names) - {BLANK}) != len([one for one in names if one != BLANK]):
        raise ValueError(f"{name} has two fields of one name")
    fields = tuple(Field(one, REFUSED, "must be empty") if one == BLANK else Field(one, *reasons.get(one, (USED,)))
                   for one in names)
    return Card(name, USED, what, fields, repeats, sets, own)


def idle(names: str, why: str) -> Iterator[Card]:
    """Yield cards that have no influence for one common reason."""
    for name in names.split():
        yield Card(name, IDLE, why)


def refused(names: str, why: str, sets: str = "") -> Iterator[Card]:
    """Yield cards that are unsupported for one common reason."""
    for name in names.split():
        yield Card(name, REFUSED, why, sets=sets)


def table(*cards: Card | Iterator[Card]) -> dict[str, Card]:
    """Return cards by name. :raises ValueError: a card occurs twice"""
    found: dict[str, Card] = {}
    for item in cards:
        for card in [item] if isinstance(item, Card) else item:
            if card.name in found:
                raise ValueError(f"card {card.name} is in two classes")
            found[card.name] = card
    return found


def markdown(cards: Mapping[str, Card], heading: Sequence[str]) -> list[str]:
    """Return the tables for the documentation: first used cards with their fields, then the other cards by reason."""
    taken = sorted((card for card in cards.values() if card.use == USED), key=lambda one: one.name)
    fields = any(card.fields for card in taken)
    shown = (USED, IDLE, REFUSED) if fields else ()
    lines = [f"| {' | '.join([heading[0], 'becomes', *shown])} |", "|---" * (2 + len(shown)) + "|"]
    for card in taken:
        cells = [_code(card.name), card.what]
        for use in shown:
            cells.append("; ".join(_by_reason(field for field in card.fields
                                              if field.use == use and field.name != BLANK)))
        lines.append("| " + " | ".join(cells) + " |")
    for use in (IDLE, REFUSED):
        if not any(card.use == use for card in cards.values()):
            continue
        lines += ["", f"| {heading[0]}: {use} | reason |", "|---|---|"]
        reasons: dict[str, list[str]] = {}
        for card in cards.values():
            if card.use == use:
                reasons.setdefault(card.what, []).append(_code(card.name))
        lines += [f"| {', '.join(sorted(names))} | {why} |" for why, names in sorted(reasons.items())]
    return lines


def _code(name: str) -> str:
    return f"`{name.replace('_', ' ')}`"


def _by_reason(fields: Iterator[Field]) -> list[str]:
    reasons: dict[str, list[str]] = {}
    for field in fields:
        reasons.setdefault(field.why, []).append(field.name.replace("_", " "))
    return [", ".join(names) + (f": {why}" if why else "") for why, names in reasons.items()]
