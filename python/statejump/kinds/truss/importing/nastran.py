# SPDX-License-Identifier: GPL-3.0-or-later
"""Bulk data of Nastran: free fields, small fixed ones of 8 columns and large ones of 16, with continuations."""
from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import pi
from pathlib import Path

from statejump.core.reading import finite_number
from statejump.kinds.truss.importing.model import Bar, Deck, quoted, text_of

SMALL, LARGE = 8, 16
MOST_FIELDS = 100_000  # of a card with its continuations
DIRECTIONS = {"1": "x", "2": "y", "3": "z"}
# A number without the letter of its exponent: 7.+10, 2.3-5.
BARE_EXPONENT = re.compile(r"([0-9.])([+-][0-9]+)$")
ASIDE = {"PARAM": "no part of a truss", "EIGRL": "no part of a truss"}
SELECTED = {"SPC": "spc", "LOAD": "load", "TEMPERATURE(LOAD)": "temperature", "TEMP(LOAD)": "temperature",
            "TEMPERATURE": "temperature", "TEMP": "temperature", "TEMPERATURE(BOTH)": "temperature",
            "TEMP(BOTH)": "temperature"}


@dataclass
class _Material:
    young_modulus: float | None
    poisson_ratio: float | None
    density: float | None
    expansion: float | None
    reference: float


@dataclass
class _Reader:
    deck: Deck
    chosen: dict[str, str] = field(default_factory=dict)  # sets that the case control selects
    sets: dict[str, dict[str, int]] = field(default_factory=dict)  # kind -> set -> first line
    materials: dict[str, _Material] = field(default_factory=dict)
    properties: dict[str, tuple[str, float | None]] = field(default_factory=dict)  # material and area
    rods: list[tuple[int, Bar, str]] = field(default_factory=list)  # line, bar, property
    conrods: list[tuple[int, Bar, str]] = field(default_factory=list)  # line, bar, material
    names: set[str] = field(default_factory=set)
    default_temperature: float | None = None

    def number(self, line: int, text: str, default: float | None = None) -> float:
        """Return a real number of a field."""
        if not text and default is not None:
            return default
        value = finite_number(BARE_EXPONENT.sub(r"\1e\2", text.lower().replace("d", "e")))
        if value is None:
            raise self.deck.fail(line, f"{quoted(text)} is not a finite number")
        return value

    def optional(self, line: int, text: str) -> float | None:
        """Return a real number of a field that may be empty."""
        return self.number(line, text) if text else None

    def whole(self, line: int, text: str) -> str:
        """Return a whole number of a field as a name."""
        if not text.isdecimal() or not text.isascii() or len(text) > 12:
            raise self.deck.fail(line, f"{quoted(text)} is not a whole number above 0")
        return str(int(text))

    def node(self, line: int, text: str) -> str:
        """Return a node that is there."""
        name = self.whole(line, text)
        if name not in self.deck.nodes:
            raise self.deck.fail(line, f"there is no GRID {name}")
        return name

    def selected(self, line: int, kind: str, card: str, text: str) -> bool:
        """Whether the set of a card counts; which one is said by the case control, or there is only one."""
        name = self.whole(line, text)
        self.sets.setdefault(kind, {}).setdefault(name, line)
        if kind in self.chosen:
            if name != self.chosen[kind]:
                self.deck.leave(card, f"set {name}: the case control selects {self.chosen[kind]}", line)
                return False
        elif len(self.sets[kind]) > 1:
            first = next(iter(self.sets[kind]))
            raise self.deck.fail(line, f"{card} of set {name} beside set {first}",
                                 f"a case control with {kind.upper()} = must say which one counts")
        return True


Fields = list[str]


def read(path: Path) -> Deck:
    """Return what bulk data say. :raises Unreadable: one sentence with file and line"""
    deck = Deck(path)
    reader = _Reader(deck)
    later: list[tuple[int, str, Fields]] = []
    for line, card, fields in _cards(reader, text_of(path)):
        if card.startswith("INCLUDE"):
            raise deck.fail(line, "INCLUDE is not read", "the deck must be whole, without other files")
        if card == "GRID":
            _grid(reader, line, fields)
        elif card in _CARDS:
            later.append((line, card, fields))  # of nodes that may come below
        else:
            deck.leave(card, ASIDE.get(card, "not supported"), line)
    for line, card, fields in later:
        _CARDS[card](reader, line, card, fields)
    _finish(reader)
    return deck


def _cards(reader: _Reader, lines: list[str]) -> Iterator[tuple[int, str, Fields]]:
    """Yield every card with its line and its fields behind the name."""
    deck = reader.deck
    control = any(line.split("$")[0].split() == ["BEGIN", "BULK"] or line.upper().strip().startswith("BEGIN BULK")
                  for line in lines)
    current: tuple[int, str, Fields] | None = None
    for number, raw in enumerate(lines, start=1):
        line = raw.split("$")[0].rstrip().expandtabs(SMALL)
        if not line:
            continue
        if control:
            words = line.upper().split()
            if words[:2] == ["BEGIN", "BULK"]:
                control = False
            else:
                _control(reader, number, line)
            continue
        name, fields = _fields(line)
        if name.upper() == "ENDDATA":
            break
        if name in ("", "*") or name.startswith("+") or (name.startswith("*") and len(name) > 1):
            if current is None:
                raise deck.fail(number, "a continuation of nothing")
            if len(current[2]) > MOST_FIELDS:
                raise deck.fail(number, f"a card of more than {MOST_FIELDS} fields")
            current[2].extend(fields)
            continue
        if current is not None:
            yield current
        current = (number, name.upper().rstrip("*").strip(), fields)
        if not current[1].isprintable() or len(current[1]) > SMALL:
            raise deck.fail(number, f"{quoted(name)} is not the name of a card")
        deck.room(number, number)
    if current is not None:
        yield current


def _fields(line: str) -> tuple[str, Fields]:
    """Return the first field of a line and those with data, 8 of a line in small or free form, 4 in large."""
    if "," in line:
        words = [word.strip() for word in line.split(",")]
        count = 4 if words[0].endswith("*") else 8
        return words[0], (words[1:count + 1] + [""] * count)[:count]
    head = line[:SMALL].strip()
    width = LARGE if head.endswith("*") or head.startswith("*") else SMALL
    data = line[SMALL:SMALL + 64]
    return head, [data[at:at + width].strip() for at in range(0, 64, width)]


def _control(reader: _Reader, line: int, text: str) -> None:
    key, equal, value = text.partition("=")
    name = SELECTED.get("".join(key.upper().split()))
    if not equal or name is None or not value.strip().isdecimal():
        return
    if reader.chosen.setdefault(name, reader.whole(line, value.strip())) != reader.whole(line, value.strip()):
        reader.deck.leave("SUBCASE", f"{name} of a further subcase: the first one is taken", line)


def _padded(fields: Fields, count: int) -> Fields:
    return fields + [""] * (count - len(fields))


def _grid(reader: _Reader, line: int, fields: Fields) -> None:
    deck = reader.deck
    name, system, x, y, z, moved, held = _padded(fields, 7)[:7]
    for text, what in ((system, "CP"), (moved, "CD")):
        if text and text != "0":
            raise deck.fail(line, f"GRID {quoted(name)} has {what} = {quoted(text)}",
                            "only the basic coordinate system is read")
    name = reader.whole(line, name)
    deck.add_node(line, name, (reader.number(line, x, 0.0), reader.number(line, y, 0.0), reader.number(line, z, 0.0)))
    deck.take("GRID", "node")
    if held:
        _fix(reader, line, "GRID", held, [name])


def _fix(reader: _Reader, line: int, card: str, components: str, nodes: list[str]) -> None:
    if not set(components) <= set("123456"):
        raise reader.deck.fail(line, f"{card}: components {quoted(components)}", "must be of the digits 1 to 6")
    directions = "".join(DIRECTIONS[one] for one in components if one in DIRECTIONS)
    if set(components) & set("456"):
        reader.deck.leave(card, "components 4 to 6: ends of links turn freely", line)
    if directions:
        for node in nodes:
            reader.deck.fix(node, directions)
        reader.deck.take(card, "directions without motion")


def _element(reader: _Reader, line: int, name: str, ends: tuple[str, str], card: str) -> Bar:
    name = reader.whole(line, name)
    if name in reader.names:
        raise reader.deck.fail(line, f"element {name} is there twice")
    reader.names.add(name)
    reader.deck.room(line, len(reader.names))
    what = "link" if "ROD" in card else "link: it carries axial force only, its bending is left out"
    reader.deck.take(card, what)
    return Bar(name, (reader.node(line, ends[0]), reader.node(line, ends[1])), card)


def _crod(reader: _Reader, line: int, card: str, fields: Fields) -> None:
    name, part, first, second = _padded(fields, 4)[:4]
    if any(text and reader.number(line, text) for text in fields[10:16]):
        reader.deck.leave(card, "offsets of its ends", line)
    reader.rods.append((line, _element(reader, line, name, (first, second), card), part or name))


def _conrod(reader: _Reader, line: int, card: str, fields: Fields) -> None:
    name, first, second, material, area, twist, _, extra = _padded(fields, 8)[:8]
    bar = _element(reader, line, name, (first, second), card)
    bar.area = reader.number(line, area)
    if twist and reader.number(line, twist):
        reader.deck.leave(card, "torsional constant: links carry axial force only", line)
    if extra and reader.number(line, extra):
        reader.deck.leave(card, "non-structural mass", line)
    reader.conrods.append((line, bar, reader.whole(line, material)))


def _property(reader: _Reader, line: int, card: str, fields: Fields) -> None:
    name, material, area = _padded(fields, 3)[:3]
    name = reader.whole(line, name)
    reader.properties[name] = (reader.whole(line, material), reader.optional(line, area))
    reader.deck.take(card, "cross-section area of links")


def _pbarl(reader: _Reader, line: int, card: str, fields: Fields) -> None:
    name, material, _, shape = _padded(fields, 4)[:4]
    sizes = [reader.number(line, text) for text in fields[8:12] if text]
    area = None
    match shape.upper(), sizes:
        case "ROD", [radius, *_]:
            area = pi * radius**2
        case "TUBE", [outer, inner, *_]:
            area = pi * (outer**2 - inner**2)
        case "BAR", [width, height, *_]:
            area = width * height
    if area is None:
        reader.deck.leave(f"{card} {quoted(shape)[1:-1]}", "not a section whose area is known", line)
    else:
        reader.deck.take(card, "cross-section area of links")
    reader.properties[reader.whole(line, name)] = (reader.whole(line, material), area)


def _mat1(reader: _Reader, line: int, card: str, fields: Fields) -> None:
    name, young, shear, poisson, density, expansion, reference = _padded(fields, 7)[:7]
    modulus, ratio = reader.optional(line, young), reader.optional(line, poisson)
    if ratio is None and modulus is not None and shear and reader.number(line, shear) != 0:
        ratio = modulus / (2 * reader.number(line, shear)) - 1
    reader.materials[reader.whole(line, name)] = _Material(
        modulus, ratio, reader.optional(line, density), reader.optional(line, expansion),
        reader.number(line, reference, 0.0))
    reader.deck.take(card, "properties of links")


def _spc1(reader: _Reader, line: int, card: str, fields: Fields) -> None:
    if not reader.selected(line, "spc", card, _padded(fields, 1)[0]):
        return
    components, items = _padded(fields, 2)[1], [text for text in fields[2:] if text]
    if len(items) == 3 and items[1].upper() == "THRU":
        first, last = int(reader.whole(line, items[0])), int(reader.whole(line, items[2]))
        nodes = [name for name in reader.deck.nodes if first <= int(name) <= last]
    else:
        nodes = [reader.node(line, text) for text in items]
    _fix(reader, line, card, components, nodes)


def _spc(reader: _Reader, line: int, card: str, fields: Fields) -> None:
    if not reader.selected(line, "spc", card, _padded(fields, 1)[0]):
        return
    rest = _padded(fields[1:], 6)
    for node, components, value in (rest[:3], rest[3:6]):
        if not node:
            continue
        if value and reader.number(line, value) != 0:
            reader.deck.leave(card, "a given displacement that is not 0", line)
            continue
        _fix(reader, line, card, components, [reader.node(line, node)])


def _force(reader: _Reader, line: int, card: str, fields: Fields) -> None:
    if not reader.selected(line, "load", card, _padded(fields, 1)[0]):
        return
    _, node, system, size, x, y, z = _padded(fields, 7)[:7]
    if system and system != "0":
        raise reader.deck.fail(line, f"FORCE has CID = {quoted(system)}", "only the basic coordinate system is read")
    scale = reader.number(line, size)
    reader.deck.load(reader.node(line, node), (scale * reader.number(line, x, 0.0), scale * reader.number(line, y, 0.0),
                                               scale * reader.number(line, z, 0.0)))
    reader.deck.take(card, "dead load")


def _temp(reader: _Reader, line: int, card: str, fields: Fields) -> None:
    if not reader.selected(line, "temperature", card, _padded(fields, 1)[0]):
        return
    rest = fields[1:7]
    for node, value in zip(rest[::2], rest[1::2]):
        if node:
            reader.deck.temperature[reader.node(line, node)] = reader.number(line, value)
            reader.deck.take(card, "temperature of links")


def _tempd(reader: _Reader, line: int, card: str, fields: Fields) -> None:
    for name, value in zip(fields[::2], fields[1::2]):
        if name and reader.selected(line, "temperature", card, name):
            reader.default_temperature = reader.number(line, value)
            reader.deck.take(card, "temperature of links")


def _finish(reader: _Reader) -> None:
    """Give links what properties and materials say, nodes the temperature of those without one."""
    deck = reader.deck
    if reader.default_temperature is not None:
        for name in deck.nodes:
            deck.temperature.setdefault(name, reader.default_temperature)
    for line, bar, name in reader.rods:
        if name not in reader.properties:
            raise deck.fail(line, f"{bar.kind} {bar.name}: there is no property {quoted(name)} that is read")
        material, bar.area = reader.properties[name]
        reader.conrods.append((line, bar, material))
    for line, bar, name in sorted(reader.conrods, key=lambda item: item[0]):
        if name not in reader.materials:
            raise deck.fail(line, f"{bar.kind} {bar.name}: there is no MAT1 {name}")
        of = reader.materials[name]
        bar.young_modulus, bar.poisson_ratio, bar.density = of.young_modulus, of.poisson_ratio, of.density
        bar.expansion, bar.reference_temperature = of.expansion, of.reference
        deck.bars.append(bar)


_CARDS: dict[str, Callable[[_Reader, int, str, Fields], None]] = {
    "CROD": _crod, "CONROD": _conrod, "CBAR": _crod, "CBEAM": _crod, "PROD": _property, "PBAR": _property,
    "PBARL": _pbarl, "PBEAM": _property, "MAT1": _mat1, "SPC1": _spc1, "SPC": _spc, "FORCE": _force, "TEMP": _temp,
    "TEMPD": _tempd,
}
