# SPDX-License-Identifier: GPL-3.0-or-later
"""Bars, springs and masses."""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from statejump.kinds.truss.importing.bending import Bending, Section, across, triad
from statejump.kinds.truss.importing.bushes import Bush, add_bush
from statejump.kinds.truss.importing.model import Bar, quoted
from statejump.kinds.truss.importing.nastran.cards import Card
from statejump.kinds.truss.importing.nastran.reader import Ends, Material, Property, Reader
from statejump.kinds.truss.importing.supports import add_spring, is_held

SAME = 1e-6  # relative tolerance of offsets: cards have seven digits


def element(reader: Reader, card: Card, kind: str = "") -> str:
    """Return the name of an element. A mass and a bar may have the same number, as in decks that come with Nastran."""
    name = reader.whole(card, 0)
    if kind + name in reader.elements:
        raise reader.deck.fail(card.line, "deck_duplicate", what_it_is="element", name=name)
    reader.elements.add(kind + name)
    reader.deck.room(card.line, len(reader.elements))
    return name


def rods(reader: Reader, card: Card) -> None:
    """Read CROD and CTUBE. A card has one element, in COSMIC's Nastran also two."""
    for fields in (card.fields[:4], card.fields[4:]):
        if any(fields):
            bar(reader, Card(card.line, card.name, fields))


def bar(reader: Reader, card: Card) -> None:
    """CBAR, CBEAM, and one CROD or CTUBE."""
    name = element(reader, card)
    beam = card.name in ("CBAR", "CBEAM")
    default = name
    for other in reader.cards.get({"CBAR": "BAROR", "CBEAM": "BEAMOR"}.get(card.name, ""), []):
        default = other[1] or name
    ends = (reader.node(card, 2), reader.node(card, 3))
    made = Bar(name, ends, card.name, bends=beam)
    bends = beam and reader.bends()
    if bends:
        reader.axes_y[name] = _axis_y(reader, card, ends[0])
        reader.ends[name] = _ends(reader, card, ends)
    elif beam:
        if any(card.fields[10:16]):
            made.lengthened = _lengthened(reader, card, ends)
        made.released = (_releases(reader, card, 8), _releases(reader, card, 9))
    if bends:
        reader.deck.take(card.name, "beam")
    elif any(made.released):
        reader.deck.take(card.name, "masses of both ends: a pin flag releases the axial force")
    else:
        reader.deck.take(card.name, "link: it carries axial force only, its bending is left out" if beam else "link")
    reader.bars[name] = (card.line, made, reader.whole(card, 1, default))


RELEASES = {"1": "Fx", "4": "Rx", "5": "Ry", "6": "Rz"}  # by pin flag


def _ends(reader: Reader, card: Card, ends: tuple[str, str]) -> Ends:
    """Return what the ends of a beam do not transmit, and their offsets from the nodes."""
    found = []
    for place, field in ((8, "PA"), (9, "PB")):
        flags = _flags(reader, card, place)
        if flags & {"2", "3"}:
            reader.deck.refuse(f"{card.name}.{field}", "released_shear", card.line)
        found.append(frozenset(RELEASES[flag] for flag in flags if flag in RELEASES))
    # A force or torsion that one end releases is zero, so the other end need not release it.
    return (found[0], found[1] - (found[0] & {"Fx", "Rx"})), _offsets(reader, card, ends)


def _axis_y(reader: Reader, card: Card, first: str) -> np.ndarray:
    """Return the direction of axis y of a beam's section; zero if the deck does not give it."""
    given, kind = card.fields[4:7], card[7]
    default = (reader.cards.get({"CBAR": "BAROR", "CBEAM": "BEAMOR"}.get(card.name, "")) or [Card(0, "")])[0]
    if not any(given):
        given, kind = default.fields[4:7], kind or default[7]
    if not any(given):
        return np.zeros(3)
    of = Card(card.line, card.name, given)
    if not any(given[1:]) and given[0].isdecimal():
        return np.subtract(reader.deck.nodes[reader.node(of, 0)], reader.deck.nodes[first])
    vector = np.array([reader.number(of, at, 0.0) for at in range(3)])
    frame = reader.frames["0" if kind.upper().startswith("B") else reader.displacement_frame[first]]
    return np.asarray(vector @ frame.directions(reader.deck.nodes[first]))


def _flags(reader: Reader, card: Card, place: int) -> set[str]:
    """Return the pin flags of an end."""
    flags = card[place].replace(" ", "")
    if set(flags) - set("0123456"):
        raise reader.deck.fail(card.line, "deck_bad_number", text=quoted(flags), wanted="pin flags of 1 to 6")
    return set(flags) - {"0"}


def _releases(reader: Reader, card: Card, place: int) -> bool:
    """Return whether a pin flag releases the axial force. The other flags release what a pin-jointed bar does not have:
    2 and 3 shear forces, 4 to 6 moments."""
    return "1" in _flags(reader, card, place)


def _offsets(reader: Reader, card: Card, ends: tuple[str, str]) -> np.ndarray:
    """Return the vectors (2, 3) from the nodes to the ends of a bar, in the basic system."""
    found, kinds = [], (card[7].upper() or "GGG").ljust(3, "G")[1:]
    for place, end, kind in zip((10, 13), ends, kinds):
        given = np.array([reader.number(card, at, 0.0) for at in range(place, place + 3)])
        if kind == "O" and given.any():
            reader.deck.refuse(f"{card.name}.W1A-W3B", "offset_in_element", card.line)
        frame = reader.frames[reader.displacement_frame[end] if kind == "G" else "0"]
        found.append(given @ frame.directions(reader.deck.nodes[end]))
    return np.array(found)


def _lengthened(reader: Reader, card: Card, ends: tuple[str, str]) -> float:
    """Return the ratio of the length of a bar with offsets to the distance of its nodes. Offsets that rotate the bar
    are refused. Equal offsets shift the bar, which has no effect on nodes without rotations."""
    kinds = (card[7].upper() or "GGG").ljust(3, "G")[1:]
    offsets = _offsets(reader, card, ends)
    between = np.subtract(reader.deck.nodes[ends[1]], reader.deck.nodes[ends[0]])
    longer, distance = offsets[1] - offsets[0], np.linalg.norm(between)
    if kinds[0] == kinds[1] and np.linalg.norm(longer) <= SAME * np.linalg.norm(offsets):
        if np.any(offsets):
            reader.deck.leave(card.name, "equal offsets of both ends: nodes of a truss do not rotate", card.line)
        return 1.0
    along = longer @ between / distance**2 if distance else -1.0
    if kinds != "GG" or along <= -1 or np.linalg.norm(longer - along * between) > SAME * np.linalg.norm(offsets):
        reader.deck.refuse(f"{card.name}.W1A-W3B", "unequal_offsets", card.line)
        return 1.0
    reader.deck.take(card.name, "offsets along the bar: modulus, expansion and density of a bar of another length")
    return float(1 + along)


def conrod(reader: Reader, card: Card) -> None:
    """A bar with its own section."""
    name = element(reader, card)
    made = Bar(name, (reader.node(card, 1), reader.node(card, 2)), card.name)
    made.area = reader.number(card, 4)
    reader.torsion[name] = reader.number(card, 5, 0.0)
    made.more_mass = reader.number(card, 7, 0.0)
    reader.deck.take(card.name, "link")
    reader.conrods[name] = (card.line, made, reader.whole(card, 3))


def deform(reader: Reader, card: Card) -> None:
    """Read the elongations of bars without stress (DEFORM)."""
    for place in (1, 3, 5):
        if card[place]:
            name = reader.whole(card, place)
            found = reader.bars.get(name) or reader.conrods.get(name)
            if found is None:
                raise reader.fail(card, "deck_undefined", what_it_is="bar", name=name)
            found[1].elongation += reader.number(card, place + 1)
            reader.deck.take(card.name, "stress-free length of a link")


def celas(reader: Reader, card: Card) -> None:
    """Read a spring between components of two nodes (CELAS1, CELAS2). An empty component means the ground."""
    name = element(reader, card)
    if card.name == "CELAS2":
        stiffness = reader.number(card, 1, 0.0)
    else:
        stiffness = reader.springs.get(reader.whole(card, 1, name), np.nan)
        if np.isnan(stiffness):
            raise reader.fail(card, "deck_undefined", what_it_is="PELAS", name=reader.whole(card, 1, name))
    components = [card[place + 1] or "0" for place in (2, 4) if card[place] and card[place] != "0"]
    if components and set(components) <= set("456"):
        if reader.bends() and stiffness:
            _rotational(reader, card, name, stiffness)
            return
        reader.deck.leave(card.name, "a spring of rotations: ends of bars turn freely", card.line)
        return
    if not set(components) <= set("123"):
        reader.deck.refuse(card.name, "scalar_point" if "0" in components else "rotation", card.line)
        return
    ends = []
    for place in (2, 4):
        if card[place] and card[place] != "0":
            node = reader.node(card, place)
            frame = reader.frames[reader.displacement_frame[node]]
            ends.append((node, frame.directions(reader.deck.nodes[node])[int(card[place + 1]) - 1]))
    add_spring(reader.deck, card.line, card.name, name, stiffness, ends)


def _rotational(reader: Reader, card: Card, name: str, stiffness: float) -> None:
    """Read a spring between one rotation of two nodes at one position, or of a node and the ground."""
    ends = [(reader.node(card, place), int(card[place + 1]) - 4) for place in (2, 4) if card[place] and
            card[place] != "0"]
    first = ends[0][0]
    second = ends[1][0] if len(ends) > 1 else None
    frames = [reader.frames[reader.displacement_frame[node]].directions(reader.deck.nodes[node]) for node, _ in ends]
    axis = frames[0][ends[0][1]]
    if second is not None and (first == second or reader.deck.nodes[first] != reader.deck.nodes[second] or
                               np.linalg.norm(axis - frames[1][ends[1][1]]) > SAME):
        reader.deck.refuse(card.name, "rotation_spring", card.line)
        return
    turns = tuple(stiffness if at == ends[0][1] else 0.0 for at in range(3))
    add_bush(reader.deck, Bush(card.line, card.name, name, first, second, np.array(reader.deck.nodes[first]),
                               np.asarray(frames[0]), (0.0, 0.0, 0.0), turns))


def cbush(reader: Reader, card: Card) -> None:
    """Read a spring (CBUSH): in up to three directions to the ground, or in its first direction along its own line."""
    name = element(reader, card)
    number = reader.whole(card, 1, name)
    found = [one for one in reader.cards.get("PBUSH", []) if reader.whole(one, 0) == number]
    if not found:
        raise reader.fail(card, "deck_undefined", what_it_is="PBUSH", name=number)
    stiffness = _bush(reader, found[0])
    if reader.bends() and _six(reader, card, stiffness):
        return
    if any(stiffness[3:]):
        reader.deck.leave("PBUSH", "K4 to K6, stiffness of rotations: ends of bars turn freely", found[0].line)
    first = reader.node(card, 2)
    second = reader.node(card, 3) if card[3] and card[3] != "0" else None
    if second is None and not card[7] and any(card.fields[4:7]):
        reader.deck.refuse(card.name, "missing_coordinate_system", card.line)
        return
    if card[7]:
        axes = reader.frame(card, 7).directions(reader.deck.nodes[first])
    elif second is None or reader.deck.nodes[first] == reader.deck.nodes[second]:
        axes = reader.frames["0"].axes
    else:
        way = np.subtract(reader.deck.nodes[second], reader.deck.nodes[first])
        axes = np.array([way / np.linalg.norm(way), *2 * [np.zeros(3)]])
    for place, value in enumerate(stiffness[:3]):
        if not value:
            continue
        if not axes[place].any():
            reader.deck.refuse(card.name, "lateral_stiffness", card.line)
            return
        ends = [(node, axes[place]) for node in (first, second) if node is not None]
        add_spring(reader.deck, card.line, card.name, name if place == 0 else f"{name}_{place + 1}", value, ends)


def _six(reader: Reader, card: Card, stiffness: list[float]) -> bool:
    """Read a CBUSH with springs of rotations, or with springs that are not on the line of its nodes. Return whether it
    is one."""
    deck, first = reader.deck, reader.node(card, 2)
    second = reader.node(card, 3) if card[3] and card[3] != "0" else None
    start = np.array(deck.nodes[first])
    way = np.zeros(3) if second is None else np.subtract(deck.nodes[second], start)
    length = float(np.linalg.norm(way))
    if not any(stiffness[3:]) and (second is None or length and not card[7] and not any(stiffness[1:])):
        return False
    if card[9] and card[9] != "-1":
        deck.refuse(card.name, "bush_offset", card.line)
        return True
    if card[7]:
        axes = np.asarray(reader.frame(card, 7).directions(deck.nodes[first]))
    elif not length:
        axes = np.asarray(reader.frames["0"].axes)
    else:
        own = triad(start, start + way, _axis_y(reader, card, first))
        if own is None and any(stiffness[at] for at in (1, 2, 4, 5)):
            deck.refuse(card.name, "missing_coordinate_system", card.line)
            return True
        found = own if own is not None else triad(start, start + way, across(start, start + way))
        assert found is not None
        axes = found
    centre = start + way * reader.number(card, 8, 0.5)
    add_bush(deck, Bush(card.line, card.name, f"{reader.whole(card, 0)}", first, second, centre, axes,
                        tuple(stiffness[:3]), tuple(stiffness[3:])))
    return True


def _bush(reader: Reader, card: Card) -> list[float]:
    """Return the six stiffnesses of PBUSH."""
    found = [0.0] * 6
    for row in card.rows():
        if row[1].upper() == "K":
            found = [reader.number(Card(card.line, card.name, row), place, 0.0) for place in range(2, 8)]
        elif row[1].upper() == "M" and any(row[2:]):
            reader.deck.refuse("PBUSH.M", "spring_mass", card.line)
    return found


def conm2(reader: Reader, card: Card) -> None:
    """Read a mass at a node (CONM2). Gravity on a mass beside its node is a moment, where beams end."""
    element(reader, card, "mass ")
    node = reader.node(card, 1)
    mass = reader.number(card, 3, 0.0)
    weigh(reader, card, node, mass)
    if not mass or not any(card.fields[4:7]):
        return
    offset = np.array([reader.number(card, at, 0.0) for at in (4, 5, 6)])
    if card[2] == "-1":  # a position in the basic system
        reader.mass_arms.append((card, node, mass, offset - reader.deck.nodes[node]))
    else:
        axes = reader.frame(card, 2).directions(reader.deck.nodes[node])
        reader.mass_arms.append((card, node, mass, offset @ axes))


def conm1(reader: Reader, card: Card) -> None:
    """Read a mass matrix (CONM1). It must represent the same mass in all directions."""
    element(reader, card, "mass ")
    node = reader.node(card, 1)
    first, second, third = (reader.number(card, place, 0.0) for place in (3, 5, 8))
    if not first == second == third:
        reader.deck.refuse(card.name, "anisotropic_mass", card.line)
        return
    weigh(reader, card, node, first)


def weigh(reader: Reader, card: Card, node: str, mass: float) -> None:
    """Add a mass to a node."""
    if mass < 0:
        raise reader.fail(card, "deck_bad_value", problem="a negative mass")
    if mass:
        reader.deck.weigh(node, mass, card.line, card.name)
        reader.deck.take(card.name, "mass of a node")
    else:
        reader.deck.leave(card.name, "its mass is 0", card.line)


def _section(reader: Reader, line: int, of: Bar, name: str) -> Property:
    """Return the property of a bar: the property for its element type, or the only property with this number."""
    found = reader.properties.get(name, {})
    if of.kind in found:
        return found[of.kind]
    if len(found) != 1:
        raise reader.deck.fail(line, "deck_undefined", f"{of.kind} {of.name}", what_it_is="supported property",
                               name=quoted(name))
    return next(iter(found.values()))


def finish_bars(reader: Reader) -> None:
    """Give bars what properties and materials say."""
    deck = reader.deck
    ready: list[tuple[int, Bar, str, float]] = []
    sections: dict[str, Property] = {}
    shear: dict[str, float | None] = {}
    for line, made, name in reader.bars.values():
        section = sections[made.name] = _section(reader, line, made, name)
        if section.area is None:
            made.why_no_area = section.why
        made.area, made.more_mass = section.area, section.more
        ready.append((line, made, section.material, section.mass_area or section.area or 0.0))
    ready += [(line, made, material, made.area or 0.0) for line, made, material in reader.conrods.values()]
    for line, made, name, mass_area in sorted(ready, key=lambda item: item[0]):
        if name not in reader.materials:
            raise deck.fail(line, "deck_undefined", f"{made.kind} {made.name}", what_it_is="MAT1", name=name)
        of = reader.materials[name]
        made.young_modulus, made.poisson_ratio, made.expansion = of.young_modulus, of.poisson_ratio, of.expansion
        made.reference_temperature = of.reference
        shear[made.name] = of.shear_modulus
        if made.name in reader.axes_y and made.area:
            _bend(reader, line, made, sections[made.name], of)
        _heat(reader, made)
        if of.density is not None and made.area:
            made.density = of.density * mass_area / made.area
        if made.more_mass and made.area:
            made.density = (made.density or 0.0) + made.more_mass / made.area
        if any(made.released):
            _weigh_ends(reader, line, made)
        else:
            deck.bars.append(made)
    _twist(reader, sections, shear)


def _twist(reader: Reader, sections: Mapping[str, Property], shear: Mapping[str, float | None]) -> None:
    """Give rods between ends of beams their stiffness in torsion. Elsewhere it acts on no rotation of a node."""
    bent = reader.deck.bent()
    for of in reader.deck.bars:
        section = sections.get(of.name)
        torsion = section.stations[0][1].torsion if section and section.stations else reader.torsion.get(of.name, 0.0)
        if of.bends or not torsion or not shear.get(of.name) or not set(of.nodes) <= bent or not of.area:
            continue
        first, second = (np.array(reader.deck.nodes[end]) for end in of.nodes)
        if np.any(first != second):
            of.bending = Bending(Section(of.area, (0.0, 0.0), torsion), across(first, second), shear[of.name])


def _bend(reader: Reader, line: int, of: Bar, section: Property, material: Material) -> None:
    """Give a beam its bending. A beam whose section has neither second moments nor torsion stays a link."""
    if not section.stations:
        return
    shear = material.shear_modulus
    stations = section.stations
    if not any((*stations[0][1].moments, stations[0][1].torsion)):
        reader.deck.leave(of.kind, "a beam without second moments and torsion constant is a link", line)
        return
    if any(one.eccentric for _, one in stations):
        reader.deck.refuse(f"{of.kind} {quoted('section')[1:-1]}", "neutral_axis", line, "PBEAML.NEUTRAL")
    axis, (released, offsets) = reader.axes_y[of.name], reader.ends[of.name]
    first, second = (np.array(reader.deck.nodes[end]) + offset for end, offset in zip(of.nodes, offsets))
    if len(stations) > 1 and (any(released) or offsets.any()):
        reader.deck.refuse(of.kind, "ends_of_tapered_beam", line, "TAPER")
    if triad(first, second, axis) is None and (
            np.any(axis) or stations[0][1].moments[0] != stations[0][1].moments[1]):
        raise reader.deck.fail(line, "deck_bad_geometry", f"{of.kind} {of.name}",
                               problem="its direction of axis y is missing or along the beam")
    of.bending = Bending(stations[0][1], axis if np.any(axis) else across(first, second), shear, stations,
                         released=released, offsets=offsets)


def _heat(reader: Reader, of: Bar) -> None:
    """Give a bar or a beam the temperature and the gradients of TEMPRB."""
    if of.name not in reader.beam_temperature:
        return
    card, mean, gradient = reader.beam_temperature[of.name]
    of.temperature = mean
    if of.bending:
        of.bending.gradient = gradient
    elif any(gradient):
        reader.deck.refuse(card.name, "gradient_on_link", card.line)


def _weigh_ends(reader: Reader, line: int, of: Bar) -> None:
    """Give half the mass of a bar without axial force to each end that is not held."""
    deck = reader.deck
    between = np.subtract(deck.nodes[of.nodes[1]], deck.nodes[of.nodes[0]])
    mass = float(np.linalg.norm(between)) * of.lengthened * (of.density or 0.0) * (of.area or 0.0)
    for node in of.nodes:
        if mass and not all(is_held(deck, node, axis) for axis in np.eye(3)):
            deck.weigh(node, mass / 2, line, of.kind)


def cmass(reader: Reader, card: Card) -> None:
    """Read a mass of one component of one node (CMASS1, CMASS2)."""
    name = element(reader, card, "mass ")
    if card.name == "CMASS2":
        mass = reader.number(card, 1, 0.0)
    elif (number := reader.whole(card, 1, name)) in reader.masses:
        mass = reader.masses[number]
    else:
        raise reader.fail(card, "deck_undefined", what_it_is="PMASS", name=number)
    ends = [place for place in (2, 4) if card[place] and card[place] != "0"]
    if len(ends) == 2:
        reader.deck.refuse(card.name, "mass_between_components", card.line)
    elif ends and card[ends[0] + 1] in ("4", "5", "6"):
        reader.deck.leave(card.name, "inertia of a rotation: nodes of a truss do not rotate", card.line)
    elif ends and card[ends[0] + 1] not in ("1", "2", "3"):
        reader.deck.refuse(card.name, "scalar_point", card.line)
    elif ends:
        node = reader.node(card, ends[0])
        masses = reader.component_masses.setdefault(node, [0.0] * 3)
        masses[int(card[ends[0] + 1]) - 1] += mass
        reader.component_cards.setdefault(node, card)
    else:
        reader.deck.leave(card.name, "it has no node", card.line)


def take_components(reader: Reader) -> None:
    """Convert masses of single components to nodal masses. Masses must be equal in all directions that are not held."""
    for node, masses in reader.component_masses.items():
        card = reader.component_cards[node]
        axes = reader.frames[reader.displacement_frame[node]].directions(reader.deck.nodes[node])
        free = {mass for mass, axis in zip(masses, axes) if not is_held(reader.deck, node, axis)}
        if len(free) > 1:
            reader.deck.refuse(card.name, "anisotropic_mass", card.line)
        elif free:
            weigh(reader, card, node, free.pop())
        else:
            reader.deck.leave(card.name, "its node is held", card.line)
