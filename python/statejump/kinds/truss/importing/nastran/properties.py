# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials and sections."""
from __future__ import annotations

from dataclasses import replace
from math import pi

from statejump.core.reading import finite_number
from statejump.kinds.truss.importing import profiles
from statejump.kinds.truss.importing.bending import Section
from statejump.kinds.truss.importing.model import quoted
from statejump.kinds.truss.importing.nastran.cards import Card
from statejump.kinds.truss.importing.nastran.reader import Material, Property, Reader

STATIONS = ("YES", "YESA", "NO")
Station = tuple[float, Section | None, float]  # fraction of the length, section, non-structural mass per length
# Element types of each property: properties of different types may have the same number.
ELEMENTS = {"PROD": "CROD", "PTUBE": "CTUBE", "PBAR": "CBAR", "PBARL": "CBAR", "PBEAM": "CBEAM", "PBEAML": "CBEAM"}


def mat1(reader: Reader, card: Card) -> None:
    """Read a material (MAT1). Any two of E, G and Poisson's ratio determine the third."""
    modulus, shear, ratio = (reader.optional(card, at) for at in (1, 2, 3))
    given_shear = shear
    if shear is None and modulus is not None and ratio is not None and ratio > -1:
        given_shear = modulus / (2 * (1 + ratio))
    if modulus is None and shear is not None:
        modulus = 2 * (1 + (ratio or 0.0)) * shear
    elif ratio is None and modulus is not None and shear:
        ratio = modulus / (2 * shear) - 1
    if ratio is not None and not -0.99 <= ratio <= 0.49:
        # Only joints in the DEM use Poisson's ratio, and some decks have E = G. Beams have G itself.
        reader.deck.leave("MAT1", f"Poisson's ratio {ratio:g}: outside of -0.99 to 0.49", card.line)
        ratio = None
    reader.materials[reader.whole(card, 0)] = Material(
        modulus, given_shear, ratio, reader.optional(card, 4), reader.optional(card, 5), reader.optional(card, 6))
    reader.deck.take(card.name, "properties of links")


def simple(reader: Reader, card: Card) -> None:
    """Read PROD and PBAR, which give the area in a field."""
    more = reader.number(card, 5 if card.name == "PROD" else 6, 0.0)
    area = reader.optional(card, 2)
    stations: tuple[tuple[float, Section], ...] = ()
    if card.name == "PROD":
        stations = ((0.0, Section(area or 0.0, (0.0, 0.0), reader.number(card, 3, 0.0))),)
    else:
        first, second, torsion, for_y, for_z, product = (reader.number(card, at, 0.0) for at in (3, 4, 5, 16, 17, 18))
        stations = ((0.0, Section(area or 0.0, (second, first), torsion, (for_y, for_z), product)),)
    _add(reader, card, Property(reader.whole(card, 1), area, "it has no area", more=more, stations=stations))


def ptube(reader: Reader, card: Card) -> None:
    """Read a tube (PTUBE) from outer diameter and wall thickness. Thickness 0 means a solid rod."""
    outer, wall = reader.number(card, 2), reader.number(card, 3, 0.0)
    second = reader.number(card, 5, 0.0) or outer
    areas = [pi * ((wall or size / 2) * (size - (wall or size / 2))) for size in (outer, second)]
    if min(areas) <= 0:
        raise reader.fail(card, "deck_bad_value", problem="outer diameter and wall make no section")
    area, mean = profiles.taper([(0.0, areas[0]), (1.0, areas[1])])
    inner = outer / 2 - wall if wall else 0.0
    section = replace(profiles.ring(outer / 2, inner), moments=(0.0, 0.0))  # its bending does not act
    _add(reader, card, Property(reader.whole(card, 1), area, mass_area=mean, more=reader.number(card, 4, 0.0),
                                stations=((0.0, section),)))


def pbarl(reader: Reader, card: Card) -> None:
    """A section by shape and dimensions."""
    shape, sizes = _shape(reader, card)
    count = profiles.NASTRAN.get(shape, (0, None))[0]
    given = [reader.number(card, 8 + at) for at in range(count) if card[8 + at]]
    more = reader.number(card, 8 + count, 0.0) if count else 0.0
    if count and any(card.fields[9 + count:]):
        raise reader.fail(card, "deck_bad_value", problem=f"a section {shape} has {count} dimensions")
    made = profiles.nastran(shape, given) if len(given) == count else None
    # The neutral axis and the shear centre of CBAR coincide.
    stations = () if made is None else ((0.0, replace(made, eccentric=False)),)
    _add(reader, card, Property(reader.whole(card, 1), made.area if made else None, sizes, more=more,
                                stations=stations))


def _shape(reader: Reader, card: Card) -> tuple[str, str]:
    """Return the shape of a section, and the reason to report if its area cannot be computed."""
    if card[2] and card[2].upper() not in ("MSCBML0", "MSCBMLO"):  # the second spelling is a common mistake
        return "", f"group {quoted(card[2])} has sections of its own"
    return card[3].upper(), f"section {quoted(card[3])[1:-1]}: no known shape with all its dimensions"


def pbeaml(reader: Reader, card: Card) -> None:
    """Read a beam section (PBEAML) from its shape and its dimensions at one or several stations."""
    shape, why = _shape(reader, card)
    count = profiles.NASTRAN.get(shape, (0, None))[0]
    stations: list[Station] = []
    rest = card.fields[8:]
    while rest and rest[-1] == "":
        rest.pop()
    at = 0.0
    while count and rest:
        sizes, rest = rest[:count], rest[count:]
        values = [finite_number(text) if text else None for text in sizes]
        if stations and not any(sizes):
            section = stations[0][1]
        else:
            section = profiles.nastran(shape, [one for one in values if one is not None])
        more = _number(reader, card, rest[0]) if rest and rest[0] else 0.0
        stations.append((at, section, more))
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
    place = 1 if len(rows) > 1 and rows[1][0].upper() in STATIONS else 2
    found = [(0.0, card.fields[:8])]
    while place < len(rows) and rows[place][0].upper() in STATIONS:
        row = rows[place]
        # An empty field is as at end A.
        found.append((_number(reader, card, row[1]), [
            "", "", *(one or first for one, first in zip(row[2:], [*found[0][1][2:], *6 * [""]]))]))
        # YES announces a line of stress recovery points, unless the next line is already a station.
        place += 2 if row[0].upper() == "YES" and place + 1 < len(rows) \
            and rows[place + 1][0].upper() not in STATIONS else 1
    if any(any(row) for row in rows[place + 2:]):
        raise reader.fail(card, "deck_bad_value", problem="it has more lines than stations, shear and warping need")
    shear, last = (Card(card.line, card.name, rows[at] if at < len(rows) else []) for at in (place, place + 1))
    factors = reader.number(shear, 0, 1.0), reader.number(shear, 1, 1.0)
    if reader.bends() and any(last[at] and reader.number(last, at) for at in (4, 5, 6, 7)):
        reader.deck.refuse("PBEAM.N1(A)-N2(B)", "neutral_axis", card.line)
    _add(reader, card, _tapered(reader, card, [_station(reader, card, at, row, factors) for at, row in found],
                                "it has no area"))


def _station(reader: Reader, card: Card, at: float, row: list[str], factors: tuple[float, float]) -> Station:
    """Return the section of a line of PBEAM, and its non-structural mass."""
    of = Card(card.line, card.name, row)
    area, first, second, product, torsion, more = (reader.number(of, place, 0.0) for place in range(2, 8))
    return at, Section(area, (second, first), torsion, factors, product) if of[2] else None, more


def _tapered(reader: Reader, card: Card, stations: list[Station], why: str) -> Property:
    material = reader.whole(card, 1)
    known = sorted(((at, section, more) for at, section, more in stations if section is not None),
                   key=lambda one: one[0])
    if len(known) < len(stations) or not known or any(section.area <= 0 for _, section, _ in known):
        return Property(material, None, why)
    if any(not 0 <= at <= 1 for at, _, _ in known) or known[0][0] != 0:
        raise reader.fail(card, "deck_bad_value", problem="stations are not between 0 and 1")
    if known[-1][0] < 1:  # as at end A
        known.append((1.0, known[0][1], known[0][2]))
    more = sum((end[0] - start[0]) * (start[2] + end[2]) / 2 for start, end in zip(known, known[1:]))
    area, mean = profiles.taper([(at, section.area) for at, section, _ in known])
    sections = tuple((at, section) for at, section, _ in known)
    if all(section == sections[0][1] for _, section in sections):
        sections = sections[:1]
    return Property(material, area, mass_area=mean, more=more, stations=sections)


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
