# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials and sections."""
from __future__ import annotations

from math import pi

from statejump.core.reading import finite_number
from statejump.kinds.truss.importing import profiles
from statejump.kinds.truss.importing.model import quoted
from statejump.kinds.truss.importing.nastran.cards import Card
from statejump.kinds.truss.importing.nastran.reader import Material, Property, Reader

STATIONS = ("YES", "YESA", "NO")
# Element types of each property: properties of different types may have the same number.
ELEMENTS = {"PROD": "CROD", "PTUBE": "CTUBE", "PBAR": "CBAR", "PBARL": "CBAR", "PBEAM": "CBEAM", "PBEAML": "CBEAM"}


def mat1(reader: Reader, card: Card) -> None:
    """Read a material (MAT1). Any two of E, G and Poisson's ratio determine the third."""
    modulus, shear, ratio = (reader.optional(card, at) for at in (1, 2, 3))
    if modulus is None and shear is not None:
        modulus = 2 * (1 + (ratio or 0.0)) * shear
    elif ratio is None and modulus is not None and shear:
        ratio = modulus / (2 * shear) - 1
    if ratio is not None and not -0.99 <= ratio <= 0.49:
        # Only joints in the DEM use Poisson's ratio, and some decks have E = G.
        reader.deck.leave("MAT1", f"Poisson's ratio {ratio:g}: outside of -0.99 to 0.49", card.line)
        ratio = None
    reader.materials[reader.whole(card, 0)] = Material(
        modulus, ratio, reader.optional(card, 4), reader.optional(card, 5), reader.optional(card, 6))
    reader.deck.take(card.name, "properties of links")


def simple(reader: Reader, card: Card) -> None:
    """Read PROD and PBAR, which give the area in a field."""
    more = reader.number(card, 5 if card.name == "PROD" else 6, 0.0)
    _add(reader, card, Property(reader.whole(card, 1), reader.optional(card, 2), "it has no area", more=more))


def ptube(reader: Reader, card: Card) -> None:
    """Read a tube (PTUBE) from outer diameter and wall thickness. Thickness 0 means a solid rod."""
    outer, wall = reader.number(card, 2), reader.number(card, 3, 0.0)
    second = reader.number(card, 5, 0.0) or outer
    areas = [pi * ((wall or size / 2) * (size - (wall or size / 2))) for size in (outer, second)]
    if min(areas) <= 0:
        raise reader.fail(card, "deck_bad_value", problem="outer diameter and wall make no section")
    area, mean = profiles.taper([(0.0, areas[0]), (1.0, areas[1])])
    _add(reader, card, Property(reader.whole(card, 1), area, mass_area=mean, more=reader.number(card, 4, 0.0)))


def pbarl(reader: Reader, card: Card) -> None:
    """A section by shape and dimensions."""
    shape, sizes = _shape(reader, card)
    count = profiles.NASTRAN.get(shape, (0, None))[0]
    given = [reader.number(card, 8 + at) for at in range(count) if card[8 + at]]
    more = reader.number(card, 8 + count, 0.0) if count else 0.0
    if count and any(card.fields[9 + count:]):
        raise reader.fail(card, "deck_bad_value", problem=f"a section {shape} has {count} dimensions")
    area = profiles.nastran(shape, given) if len(given) == count else None
    _add(reader, card, Property(reader.whole(card, 1), area, sizes, more=more))


def _shape(reader: Reader, card: Card) -> tuple[str, str]:
    """Return the shape of a section, and the reason to report if its area cannot be computed."""
    if card[2] and card[2].upper() not in ("MSCBML0", "MSCBMLO"):  # the second spelling is a common mistake
        return "", f"group {quoted(card[2])} has sections of its own"
    return card[3].upper(), f"section {quoted(card[3])[1:-1]}: no known shape with all its dimensions"


def pbeaml(reader: Reader, card: Card) -> None:
    """Read a beam section (PBEAML) from its shape and its dimensions at one or several stations."""
    shape, why = _shape(reader, card)
    count = profiles.NASTRAN.get(shape, (0, None))[0]
    stations: list[tuple[float, float | None, float]] = []
    rest = card.fields[8:]
    while rest and rest[-1] == "":
        rest.pop()
    at = 0.0
    while count and rest:
        sizes, rest = rest[:count], rest[count:]
        values = [finite_number(text) if text else None for text in sizes]
        if stations and not any(sizes):
            area = stations[0][1]
        else:
            area = profiles.nastran(shape, [one for one in values if one is not None])
        more = _number(reader, card, rest[0]) if rest and rest[0] else 0.0
        stations.append((at, area, more))
        if len(rest) < 3:
            break
        if rest[1].upper() not in (*STATIONS, ""):
            raise reader.fail(card, "deck_bad_value", problem=f"{quoted(rest[1])} is not YES or NO")
        at, rest = _number(reader, card, rest[2]) if rest[2] else 1.0, rest[3:]
        if not rest:
            stations.append((at, stations[0][1], stations[0][2]))
    _add(reader, card, _tapered(reader, card, stations, why))


def _number(reader: Reader, card: Card, text: str) -> float:
    return reader.number(Card(card.line, card.name, [text]), 0)


def pbeam(reader: Reader, card: Card) -> None:
    """Read a beam section (PBEAM): numbers at one or several stations, followed by lines of shear and warping."""
    rows = card.rows()
    stations = [(0.0, reader.optional(card, 2), reader.number(card, 7, 0.0))]
    place = 1 if len(rows) > 1 and rows[1][0].upper() in STATIONS else 2
    while place < len(rows) and rows[place][0].upper() in STATIONS:
        row = Card(card.line, card.name, rows[place])
        stations.append((reader.number(row, 1), reader.number(row, 2) if row[2] else stations[0][1],
                         reader.number(row, 7) if row[7] else stations[0][2]))
        # YES announces a line of stress recovery points, unless the next line is already a station.
        place += 2 if row[0].upper() == "YES" and place + 1 < len(rows) \
            and rows[place + 1][0].upper() not in STATIONS else 1
    if any(any(row) for row in rows[place + 2:]):
        raise reader.fail(card, "deck_bad_value", problem="it has more lines than stations, shear and warping need")
    _add(reader, card, _tapered(reader, card, stations, "it has no area"))


def _tapered(reader: Reader, card: Card, stations: list[tuple[float, float | None, float]], why: str) -> Property:
    material = reader.whole(card, 1)
    known = sorted((at, area, more) for at, area, more in stations if area is not None)
    if len(known) < len(stations) or not known or any(area <= 0 for _, area, _ in known):
        return Property(material, None, why)
    if any(not 0 <= at <= 1 for at, _, _ in known) or known[0][0] != 0:
        raise reader.fail(card, "deck_bad_value", problem="stations are not between 0 and 1")
    if known[-1][0] < 1:  # as at end A
        known.append((1.0, known[0][1], known[0][2]))
    more = sum((end[0] - start[0]) * (start[2] + end[2]) / 2 for start, end in zip(known, known[1:]))
    area, mean = profiles.taper([(at, area) for at, area, _ in known])
    return Property(material, area, mass_area=mean, more=more)


def _add(reader: Reader, card: Card, made: Property) -> None:
    name, elements = reader.whole(card, 0), ELEMENTS[card.name]
    of_number = reader.properties.setdefault(name, {})
    if of_number.setdefault(elements, made) != made:
        raise reader.fail(card, "deck_duplicate", what_it_is="property", name=name)
    reader.deck.take(card.name, "cross-section area of links")


def pelas(reader: Reader, card: Card) -> None:
    """Stiffnesses of springs, two on a card."""
    for place in (0, 4):
        if card[place]:
            reader.springs[reader.whole(card, place)] = reader.number(card, place + 1, 0.0)
            reader.deck.take(card.name, "stiffness of springs")


def pmass(reader: Reader, card: Card) -> None:
    """Masses, up to four on a card."""
    for place in range(0, 8, 2):
        if card[place]:
            reader.masses[reader.whole(card, place)] = reader.number(card, place + 1)
            reader.deck.take(card.name, "masses of CMASS1")
