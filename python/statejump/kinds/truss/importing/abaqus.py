# SPDX-License-Identifier: GPL-3.0-or-later
"""Decks of CalculiX and Abaqus: keywords with parameters, data lines below them."""
from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import pi
from pathlib import Path

from statejump.core.reading import finite_number
from statejump.kinds.truss.importing.model import Bar, Deck, quoted, text_of

BARS = {"T2D2": "bar", "T3D2": "bar", "B31": "beam", "B21": "beam", "B32": "", "B32R": "", "T3D3": ""}
DIRECTIONS = "xyz"
# Keywords that say nothing of the truss itself.
ASIDE = {
    "HEADING": "a title", "STEP": "a step: what it says holds at the peak of the program", "END STEP": "a step",
    "STATIC": "how a program goes through a step", "NODE PRINT": "output", "EL PRINT": "output", "NODE FILE": "output",
    "EL FILE": "output", "NODE OUTPUT": "output", "ELEMENT OUTPUT": "output", "OUTPUT": "output", "RESTART": "output",
    "PREPRINT": "output", "ECHO": "output",
}
NESTED = ("PART", "INSTANCE", "ASSEMBLY", "INCLUDE")


@dataclass
class _Material:
    young_modulus: float | None = None
    poisson_ratio: float | None = None
    expansion: float | None = None
    density: float | None = None


@dataclass
class _Reader:
    deck: Deck
    node_sets: dict[str, list[str]] = field(default_factory=dict)
    element_sets: dict[str, list[str]] = field(default_factory=dict)
    elements: dict[str, Bar] = field(default_factory=dict)
    others: set[str] = field(default_factory=set)  # elements that became nothing
    materials: dict[str, _Material] = field(default_factory=dict)
    material: _Material | None = None
    set_items: int = 0

    def number(self, line: int, text: str) -> float:
        """Return a number of a data line."""
        value = finite_number(text.lower().replace("d", "e"))
        if value is None:
            raise self.deck.fail(line, f"{quoted(text)} is not a finite number")
        return value

    def whole(self, line: int, text: str) -> str:
        """Return the number of a node or element as its name."""
        if not text.isdecimal() or not text.isascii() or len(text) > 12:
            raise self.deck.fail(line, f"{quoted(text)} is not a number of a node or element")
        return str(int(text))

    def add(self, line: int, sets: dict[str, list[str]], name: str, items: Iterable[str]) -> None:
        """Add items to a set."""
        have = sets.setdefault(name.upper(), [])
        for item in items:
            have.append(item)
            self.set_items += 1
        self.deck.room(line, self.set_items)

    def nodes_of(self, line: int, word: str) -> list[str]:
        """Return the nodes that a number or a set names."""
        if word.upper() in self.node_sets:
            return self.node_sets[word.upper()]
        if not word.isdecimal():
            raise self.deck.fail(line, f"there is no set of nodes {quoted(word)}")
        name = self.whole(line, word)
        if name not in self.deck.nodes:
            raise self.deck.fail(line, f"there is no node {name}")
        return [name]

    def bars_of(self, line: int, word: str) -> list[Bar]:
        """Return the bars that a set names."""
        if word.upper() not in self.element_sets:
            raise self.deck.fail(line, f"there is no set of elements {quoted(word)}")
        return [self.elements[name] for name in self.element_sets[word.upper()] if name in self.elements]


Data = list[tuple[int, list[str]]]
Parameters = dict[str, str]


def read(path: Path) -> Deck:
    """Return what a deck says. :raises Unreadable: one sentence with file and line"""
    deck = Deck(path)
    reader = _Reader(deck)
    assigned: list[tuple[int, Parameters, Data, str]] = []
    steps = 0
    for line, keyword, parameters, data in _blocks(deck, text_of(path)):
        steps += keyword == "STEP"
        if keyword in NESTED:
            raise deck.fail(line, f"*{keyword} is not read", "the deck must be flat and whole, without other files")
        if keyword in ("SOLID SECTION", "BEAM SECTION"):
            assigned.append((line, parameters, data, keyword))
        elif keyword in _CARDS:
            _CARDS[keyword](reader, line, parameters, data)
        elif keyword in ASIDE:
            deck.leave(f"*{keyword}", ASIDE[keyword], line)
        else:
            deck.leave(f"*{keyword}", "not supported", line)
    if steps > 1:
        deck.leave("*STEP", "several steps: of what they say the last holds, loads of all add up", 0)
    for line, parameters, data, keyword in assigned:
        _section(reader, line, parameters, data, keyword)
    deck.bars = list(reader.elements.values())
    return deck


def _blocks(deck: Deck, lines: list[str]) -> Iterable[tuple[int, str, Parameters, Data]]:
    """Yield every keyword with its line, parameters and data lines."""
    current: tuple[int, str, Parameters, Data] | None = None
    joined, begun = "", 0
    for number, line in enumerate(lines, start=1):
        text = line.strip()
        if not text or text.startswith("**"):
            continue
        if joined or text.startswith("*"):
            begun = begun or number
            joined += text
            if joined.endswith(","):
                continue
            if current is not None:
                yield current
            words = [word.strip() for word in joined[1:].split(",")]
            parameters = {}
            for word in words[1:]:
                key, _, value = word.partition("=")
                parameters[key.strip().upper()] = value.strip()
            current = (begun, " ".join(words[0].upper().split()), parameters, [])
            joined, begun = "", 0
            continue
        if current is None:
            raise deck.fail(number, "data before the first keyword")
        current[3].append((number, [word.strip() for word in text.rstrip(",").split(",")]))
    if current is not None:
        yield current


def _needed(reader: _Reader, line: int, parameters: Parameters, key: str, keyword: str) -> str:
    if not parameters.get(key):
        raise reader.deck.fail(line, f"*{keyword} has no {key}=")
    return parameters[key]


def _node(reader: _Reader, line: int, parameters: Parameters, data: Data) -> None:
    for at, words in data:
        name = reader.whole(at, words[0])
        position = [reader.number(at, word) for word in words[1:4] if word]
        x, y, z = (*position, 0.0, 0.0, 0.0)[:3]
        reader.deck.add_node(at, name, (x, y, z))
        reader.deck.take("*NODE", "node")
        for group in {parameters.get("NSET", "").upper() or "NALL", "NALL"}:
            reader.add(at, reader.node_sets, group, [name])


def _element(reader: _Reader, line: int, parameters: Parameters, data: Data) -> None:
    kind = _needed(reader, line, parameters, "TYPE", "ELEMENT").upper()
    for at, words in data:
        name = reader.whole(at, words[0])
        if name in reader.elements or name in reader.others:
            raise reader.deck.fail(at, f"element {name} is there twice")
        reader.deck.room(at, len(reader.elements) + len(reader.others) + 1)
        if BARS.get(kind):
            if len(words) < 3:
                raise reader.deck.fail(at, f"element {name} has not two nodes")
            ends = (reader.whole(at, words[1]), reader.whole(at, words[2]))
            for end in ends:
                if end not in reader.deck.nodes:
                    raise reader.deck.fail(at, f"element {name}: there is no node {end}")
            reader.elements[name] = Bar(name, ends, f"*ELEMENT, TYPE={kind}")
            what = "link" if BARS[kind] == "bar" else "link: it carries axial force only, its bending is left out"
            reader.deck.take(f"*ELEMENT, TYPE={kind}", what)
        else:
            reader.others.add(name)
            reader.deck.leave(f"*ELEMENT, TYPE={printable_kind(kind)}", "not a straight bar of two nodes", at)
        for group in {parameters.get("ELSET", "").upper() or "EALL", "EALL"}:
            reader.add(at, reader.element_sets, group, [name])


def printable_kind(kind: str) -> str:
    """Return a word of the deck that goes into a table."""
    return quoted(kind)[1:-1]


def _set(reader: _Reader, line: int, parameters: Parameters, data: Data, of_nodes: bool) -> None:
    key = "NSET" if of_nodes else "ELSET"
    name = _needed(reader, line, parameters, key, key)
    sets = reader.node_sets if of_nodes else reader.element_sets
    known = set(reader.deck.nodes) if of_nodes else set(reader.elements) | reader.others
    for at, words in data:
        words = [word for word in words if word]
        if "GENERATE" in parameters:
            if len(words) not in (2, 3):
                raise reader.deck.fail(at, "GENERATE needs first, last and step")
            first, last, step = (int(reader.whole(at, word)) for word in [*words, "1"][:3])
            items = [one for one in sorted(known, key=int)
                     if first <= int(one) <= last and step and (int(one) - first) % step == 0]
            reader.add(at, sets, name, items)
            continue
        for word in words:
            if word.upper() in sets:
                reader.add(at, sets, name, list(sets[word.upper()]))
            else:
                item = reader.whole(at, word)
                if item not in known:
                    raise reader.deck.fail(at, f"there is no {'node' if of_nodes else 'element'} {item}")
                reader.add(at, sets, name, [item])
    reader.deck.take(f"*{key}", "names")


def _material(reader: _Reader, line: int, parameters: Parameters, data: Data) -> None:
    name = _needed(reader, line, parameters, "NAME", "MATERIAL").upper()
    reader.material = reader.materials.setdefault(name, _Material())
    reader.deck.take("*MATERIAL", "properties of links")


def _of_material(reader: _Reader, line: int, keyword: str, data: Data) -> tuple[_Material, list[float]]:
    if reader.material is None:
        raise reader.deck.fail(line, f"*{keyword} before any *MATERIAL")
    if not data:
        raise reader.deck.fail(line, f"*{keyword} has no data")
    if len(data) > 1:
        reader.deck.leave(f"*{keyword}", "its dependence on temperature: the first line holds", data[1][0])
    at, words = data[0]
    reader.deck.take(f"*{keyword}", "properties of links")
    return reader.material, [reader.number(at, word) for word in words if word]


def _elastic(reader: _Reader, line: int, parameters: Parameters, data: Data) -> None:
    if parameters.get("TYPE", "ISO").upper() not in ("ISO", "ISOTROPIC"):
        reader.deck.leave("*ELASTIC", "not isotropic", line)
        return
    material, values = _of_material(reader, line, "ELASTIC", data)
    material.young_modulus = values[0] if values else None
    material.poisson_ratio = values[1] if len(values) > 1 else None


def _expansion(reader: _Reader, line: int, parameters: Parameters, data: Data) -> None:
    if parameters.get("TYPE", "ISO").upper() not in ("ISO", "ISOTROPIC"):
        reader.deck.leave("*EXPANSION", "not isotropic", line)
        return
    material, values = _of_material(reader, line, "EXPANSION", data)
    material.expansion = values[0] if values else None
    if parameters.get("ZERO"):
        # What a bar expands by since its initial temperature does not depend on it while the coefficient is constant.
        reader.deck.leave("*EXPANSION", "ZERO=: bars are free of stress at their initial temperature", line)


def _density(reader: _Reader, line: int, parameters: Parameters, data: Data) -> None:
    material, values = _of_material(reader, line, "DENSITY", data)
    material.density = values[0] if values else None


def _section(reader: _Reader, line: int, parameters: Parameters, data: Data, keyword: str) -> None:
    name = _needed(reader, line, parameters, "MATERIAL", keyword).upper()
    if name not in reader.materials:
        raise reader.deck.fail(line, f"there is no material {quoted(name)}")
    bars = reader.bars_of(line, _needed(reader, line, parameters, "ELSET", keyword))
    values = [reader.number(data[0][0], word) for word in data[0][1] if word] if data else []
    shape = "AREA" if keyword == "SOLID SECTION" else parameters.get("SECTION", "").upper()
    area = _area(shape, values)
    if area is None:
        reader.deck.leave(f"*{keyword}" + ("" if shape == "AREA" else f", SECTION={printable_kind(shape)}"),
                          "not a section whose area is known", line)
        return
    material = reader.materials[name]
    for bar in bars:
        bar.area, bar.young_modulus, bar.expansion = area, material.young_modulus, material.expansion
        bar.poisson_ratio, bar.density = material.poisson_ratio, material.density
    reader.deck.take(f"*{keyword}", "cross-section area of links")


def _area(shape: str, values: list[float]) -> float | None:
    match shape, values:
        case "AREA", [area, *_]:
            return area
        case "RECT", [first, second, *_]:
            return first * second
        case "CIRC", [radius, *_]:
            return pi * radius**2
        case "PIPE", [radius, thickness, *_]:
            return pi * (radius**2 - (radius - thickness) ** 2)
    return None


def _boundary(reader: _Reader, line: int, parameters: Parameters, data: Data) -> None:
    for at, words in data:
        nodes = reader.nodes_of(at, words[0])
        named = words[1].upper() if len(words) > 1 else ""
        if named in ("ENCASTRE", "PINNED"):
            first, last = 1, 3
        else:
            first = int(reader.whole(at, words[1])) if len(words) > 1 else 0
            last = int(reader.whole(at, words[2])) if len(words) > 2 and words[2] else first
        if len(words) > 3 and words[3] and reader.number(at, words[3]) != 0:
            reader.deck.leave("*BOUNDARY", "a given displacement that is not 0", at)
            continue
        if last > 3:
            reader.deck.leave("*BOUNDARY", "directions above 3: ends of links turn freely", at)
        directions = DIRECTIONS[max(first - 1, 0):last]
        if directions:
            for node in nodes:
                reader.deck.fix(node, directions)
            reader.deck.take("*BOUNDARY", "directions without motion")


def _cload(reader: _Reader, line: int, parameters: Parameters, data: Data) -> None:
    if "AMPLITUDE" in parameters:
        reader.deck.leave("*CLOAD", "AMPLITUDE=: dead loads act all the time", line)
    for at, words in data:
        if len(words) < 3:
            raise reader.deck.fail(at, "*CLOAD needs node, direction and force")
        direction = int(reader.whole(at, words[1]))
        if not 1 <= direction <= 3:
            reader.deck.leave("*CLOAD", "a moment", at)
            continue
        force = [0.0, 0.0, 0.0]
        force[direction - 1] = reader.number(at, words[2])
        for node in reader.nodes_of(at, words[0]):
            reader.deck.load(node, (force[0], force[1], force[2]))
        reader.deck.take("*CLOAD", "dead load")


def _temperature(reader: _Reader, line: int, parameters: Parameters, data: Data) -> None:
    _temperatures(reader, reader.deck.temperature, "*TEMPERATURE", data)


def _initial(reader: _Reader, line: int, parameters: Parameters, data: Data) -> None:
    kind = parameters.get("TYPE", "").upper()
    if kind != "TEMPERATURE":
        reader.deck.leave(f"*INITIAL CONDITIONS, TYPE={printable_kind(kind)}", "not supported", line)
        return
    _temperatures(reader, reader.deck.initial, "*INITIAL CONDITIONS", data)


def _temperatures(reader: _Reader, found: dict[str, float], card: str, data: Data) -> None:
    for at, words in data:
        if len(words) < 2:
            raise reader.deck.fail(at, f"{card} needs node and temperature")
        value = reader.number(at, words[1])
        for node in reader.nodes_of(at, words[0]):
            found[node] = value
        reader.deck.take(card, "temperature of links")


_CARDS: dict[str, Callable[[_Reader, int, Parameters, Data], None]] = {
    "NODE": _node, "ELEMENT": _element, "MATERIAL": _material, "ELASTIC": _elastic, "EXPANSION": _expansion,
    "DENSITY": _density, "BOUNDARY": _boundary, "CLOAD": _cload, "TEMPERATURE": _temperature,
    "INITIAL CONDITIONS": _initial,
    "NSET": lambda reader, line, parameters, data: _set(reader, line, parameters, data, True),
    "ELSET": lambda reader, line, parameters, data: _set(reader, line, parameters, data, False),
}
