# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of sets of the case control, forces, gravity and temperatures."""
from __future__ import annotations

from dataclasses import replace

import numpy as np

from statejump.kinds.truss.importing.bending import Load, across, nodal_loads, shear_parameters, triad
from statejump.kinds.truss.importing.model import Bar, Moment, quoted
from statejump.kinds.truss.importing.nastran.cards import Card
from statejump.kinds.truss.importing.nastran.control import FREE_SOLUTIONS, Control
from statejump.kinds.truss.importing.nastran.reader import Reader
from statejump.kinds.truss.importing.nastran.table import CARDS, DYNAMIC, HEAT
from statejump.kinds.truss.importing.supports import ALONG

COMBINED = {"spc": "SPCADD", "mpc": "MPCADD"}


def select(reader: Reader, control: Control) -> None:
    """Find the active sets, and the factor of each."""
    for kind in ("spc", "mpc", "load", "temperature", "initial", "deform", "nsm", "suport"):
        chosen = control.chosen.get(kind)
        if chosen is None and not control.given and kind != "initial":
            chosen = _only(reader, kind)
        reader.sets[kind] = {} if chosen is None else _expanded(reader, kind, chosen)
    chosen = control.chosen.get("load")
    if chosen is not None and not any(card[0] == chosen for name, cards in reader.cards.items() if _is_load(name)
                                      for card in cards):
        if control.solves(FREE_SOLUTIONS):
            reader.deck.leave("LOAD", f"set {chosen} is not in the deck, and this solution has no static loads", 0)
        else:
            reader.deck.refuse("LOAD", "missing_set", 0, "LOAD.SET", set_name=chosen)


def _is_load(name: str) -> bool:
    """Return whether LOAD = can select a card. This is also true for cards of heat transfer and for unknown cards."""
    known = CARDS.get(name)
    return known is None or known.sets == "load" or known.what in (HEAT, DYNAMIC) or name in ("LOAD", "LOADADD")


def _only(reader: Reader, kind: str) -> str | None:
    """Return the only set of a kind in a deck without case control. :raises Unreadable: there are several sets"""
    first: dict[str, Card] = {}
    if kind == "load":
        combined = [card for name in ("LOAD", "LOADADD") for card in reader.cards.get(name, [])]
    else:
        combined = reader.cards.get(COMBINED.get(kind, ""), [])
    plain = [card for name, cards in reader.cards.items() if name in CARDS and CARDS[name].sets == kind
             for card in cards]
    for card in combined or plain:
        first.setdefault(reader.whole(card, 0), card)
    if kind == "temperature":
        for card in reader.cards.get("TEMPD", []):
            for text in filter(None, card.fields[::2]):
                first.setdefault(reader.name(card.line, text), card)
    if len(first) > 1:
        (one, _), (two, card) = list(first.items())[:2]
        raise reader.fail(card, "deck_ambiguous_set", first=one, second=two, command=kind.upper())
    return next(iter(first), None)


def _expanded(reader: Reader, kind: str, chosen: str) -> dict[str, float]:
    """Return the sets to which a combined set (such as LOAD) refers, with their factors."""
    found: dict[str, float] = {}
    if kind == "load":
        for name in ("LOAD", "LOADADD"):
            for card in reader.cards.get(name, []):
                if reader.whole(card, 0) == chosen:
                    common = reader.number(card, 1, 1.0)
                    for place in range(2, len(card.fields), 2):
                        if card[place + 1]:
                            part = reader.whole(card, place + 1)
                            found[part] = found.get(part, 0.0) + common * reader.number(card, place, 1.0)
                    reader.deck.take(name, "sets of loads with factors")
    for card in reader.cards.get(COMBINED.get(kind, ""), []):
        if reader.whole(card, 0) == chosen:
            found.update({reader.name(card.line, text): 1.0 for text in card.fields[1:] if text})
            reader.deck.take(card.name, "sets of supports")
    found.setdefault(chosen, 1.0)
    return found


def force(reader: Reader, card: Card) -> None:
    """FORCE, FORCE1 and FORCE2."""
    node, vector = _vector(reader, card)
    reader.deck.load(node, [float(part) for part in vector], card.line, card.name)
    reader.deck.take(card.name, "dead load")


def moment(reader: Reader, card: Card) -> None:
    """MOMENT, MOMENT1 and MOMENT2."""
    node, vector = _vector(reader, card)
    reader.deck.moments.append(Moment(card.line, card.name, node, vector))


def _vector(reader: Reader, card: Card) -> tuple[str, np.ndarray]:
    """Return the node of a load card, and its force or moment multiplied by the factor of its set."""
    factor = reader.factor(card, "load") or 0.0
    node = reader.node(card, 1)
    if card.name in ("FORCE", "MOMENT"):
        size = reader.number(card, 3)
        given = np.array([reader.number(card, place, 0.0) for place in (4, 5, 6)])
        vector = given @ reader.frame(card, 2).directions(reader.deck.nodes[node]) * size
    else:
        corners = [np.array(reader.deck.nodes[reader.node(card, place)])
                   for place in range(3, 5 if card.name.endswith("1") else 7)]
        way = corners[1] - corners[0]
        if card.name.endswith("2"):
            way = np.cross(way, corners[3] - corners[2])
        length = np.linalg.norm(way)
        if length == 0:
            raise reader.fail(card, "deck_bad_geometry", problem="its nodes give no direction")
        vector = way / length * reader.number(card, 2)
    return node, vector * factor


def gravity(reader: Reader, card: Card) -> None:
    """GRAV: an acceleration of all masses."""
    frame = reader.frame(card, 1)
    if frame.kind != "R":
        reader.deck.refuse(card.name, "curvilinear_direction", card.line)
        return
    given = np.array([reader.number(card, place, 0.0) for place in (3, 4, 5)])
    vector = given @ frame.axes * reader.number(card, 2) * (reader.factor(card, "load") or 0.0)
    for axis in range(3):
        reader.deck.gravity[axis] += float(vector[axis])
    reader.deck.take(card.name, "gravity")


PLOAD1_AXES = {"X": np.eye(3)[0], "Y": np.eye(3)[1], "Z": np.eye(3)[2]}


def pload1(reader: Reader, card: Card) -> None:
    """Read a load on a bar or a beam (PLOAD1). It becomes loads of both ends after sections are known."""
    name, kind, scale = reader.whole(card, 1), card[2].upper(), card[3].upper()
    if name not in reader.bars:
        raise reader.fail(card, "deck_undefined", what_it_is="bar", name=name)
    if scale not in ("LE", "FR", "LEPR", "FRPR") or kind[:1] not in ("F", "M") or kind[1:2] not in PLOAD1_AXES:
        reader.deck.refuse(card.name, "load_scale", card.line, scale=quoted(f"{kind} {scale}")[1:-1])
        return
    ends = reader.bars[name][1].nodes
    first, second = (np.array(reader.deck.nodes[end]) for end in ends)
    length = float(np.linalg.norm(second - first))
    if not length:
        raise reader.fail(card, "deck_bad_geometry", problem="its bar has no length")
    if kind.endswith("E"):
        axes = triad(first, second, reader.axes_y.get(name, across(first, second)))
        if axes is None:
            axes = triad(first, second, across(first, second))
        assert axes is not None
        direction = axes["XYZ".index(kind[1])]
    else:
        direction = PLOAD1_AXES[kind[1]]
    start, low = reader.number(card, 4), reader.number(card, 5)
    end = reader.number(card, 6) if card[6] else start
    high = reader.number(card, 7) if card[7] else low
    if scale.startswith("LE"):
        start, end = start / length, end / length
    factor = reader.factor(card, "load") or 0.0
    if scale.endswith("PR") and end != start:  # per length of the projection across the load
        factor *= float(np.linalg.norm(np.cross(direction, (second - first) / length)))
    reader.beam_loads.append((card, name, Load(start, end, direction * low * factor, direction * high * factor,
                                               kind.startswith("M"))))


def finish(reader: Reader) -> None:
    """Convert loads on beams and weights of masses beside their nodes to loads of nodes."""
    deck = reader.deck
    for card, name, load in reader.beam_loads:
        (_load_beam if reader.bars[name][1].bending else _load_bar)(reader, card, reader.bars[name][1], load)
    gravity, bent = np.array(deck.gravity), deck.bent()
    for card, node, mass, arm in reader.mass_arms:
        moment_vector = np.cross(arm, mass * gravity)
        if not reader.bends():
            deck.leave(card.name, "offset of a mass: nodes of a truss do not rotate", card.line)
        elif np.any(moment_vector):
            deck.moments.append(Moment(card.line, card.name, node, moment_vector, "CONM2.X1-X3", True))
        elif node in bent:
            deck.take(card.name, "offset of a mass: no gravity acts on it")


def _load_beam(reader: Reader, card: Card, of: Bar, load: Load) -> None:
    """Load the nodes of a beam so that they move as under the load on the beam."""
    deck, bending = reader.deck, of.bending
    assert bending is not None
    if len(bending.stations) > 1:
        deck.refuse(card.name, "load_on_tapered_beam", card.line)
        return
    if any(bending.released) or bending.offsets.any():
        deck.refuse(card.name, "load_on_released_beam", card.line)
        return
    first, second = deck.ends_of(of)
    section, _, axes = bending.principal(first, second)
    if axes is None or of.young_modulus is None:
        return  # the error of the beam is reported elsewhere
    length = float(np.linalg.norm(second - first))
    shear = shear_parameters(replace(bending, section=section), of.young_modulus, length)
    found = nodal_loads(load, length, axes, shear)
    for node, force_vector, moment_vector in zip(of.nodes, found[::2], found[1::2]):
        deck.load(node, [float(part) for part in force_vector], card.line, card.name)
        deck.turn(node, moment_vector)
    deck.take(card.name, "forces and moments of both ends; section forces exclude those of the clamped beam")


def _load_bar(reader: Reader, card: Card, of: Bar, load: Load) -> None:
    """Load the ends of a pin-jointed bar; refuse a load that would bend it."""
    deck = reader.deck
    first, second = (np.array(deck.nodes[end]) for end in of.nodes)
    length = float(np.linalg.norm(second - first))
    axis = (second - first) / length
    # A load varies linearly, so its direction is that of its larger end.
    larger = max(load.first, load.last, key=lambda one: float(np.linalg.norm(one)))
    size = float(np.linalg.norm(larger))
    if load.moment or np.linalg.norm(np.cross(larger, axis)) > ALONG * size:
        deck.refuse(card.name, "lateral_load", card.line)
        return
    if all(of.released):
        deck.refuse(card.name, "released_bar", card.line)
        return
    found = nodal_loads(load, length, np.array([axis, axis, axis]) * np.array([[1.0], [0.0], [0.0]]), (0.0, 0.0))
    shares = [found[0], found[2]]
    if any(of.released):  # the other end carries the whole load
        shares = [np.zeros(3), shares[0] + shares[1]] if of.released[0] else [shares[0] + shares[1], np.zeros(3)]
    for node, share in zip(of.nodes, shares):
        deck.load(node, [float(part) for part in share], card.line, card.name)
    deck.take(card.name, "dead loads of both ends")


def beam_temperatures(reader: Reader, card: Card) -> None:
    """Read temperatures and gradients of beams (TEMPRB). Temperatures at points of the section only print stress."""
    names = [reader.whole(card, 1)]
    rest = [text for text in card.fields[16:] if text]
    while rest:
        if len(rest) > 2 and rest[1].upper() == "THRU":
            step = int(reader.name(card.line, rest[4])) if len(rest) > 4 and rest[3].upper() == "BY" else 1
            low, high = (int(reader.name(card.line, rest[at])) for at in (0, 2))
            names += [name for name in reader.bars if low <= int(name) <= high and (int(name) - low) % step == 0]
            rest = rest[5:] if step != 1 or len(rest) > 4 and rest[3].upper() == "BY" else rest[3:]
        else:
            names.append(reader.name(card.line, rest.pop(0)))
    first, second = reader.number(card, 2, 0.0), reader.number(card, 3, 0.0)
    gradients = [reader.number(card, at, 0.0) for at in range(4, 8)]
    if gradients[0] != gradients[1] or gradients[2] != gradients[3]:
        reader.deck.refuse(card.name, "temperature_gradient_varies", card.line)
        return
    for name in names:
        if name not in reader.bars:
            raise reader.fail(card, "deck_undefined", what_it_is="bar", name=name)
        reader.beam_temperature[name] = (card, (first + second) / 2, (gradients[0], gradients[2]))
    reader.deck.take(card.name, "temperature and gradients of beams", len(names))


def temperatures(reader: Reader) -> None:
    """Read TEMP and TEMPD cards of the load set and of the set with the stress-free temperatures."""
    for kind, found in (("temperature", reader.deck.temperature), ("initial", reader.deck.initial)):
        default = None
        for card in reader.cards.get("TEMP", []):
            if reader.factor(card, kind) is not None:
                for place in (1, 3, 5):
                    if card[place]:
                        found[reader.node(card, place)] = reader.number(card, place + 1)
                        reader.deck.take(card.name, "temperature of links")
        for card in reader.cards.get("TEMPD", []):
            for place in range(0, 8, 2):
                if card[place] and reader.whole(card, place) in reader.sets[kind]:
                    default = reader.number(card, place + 1)
                    reader.deck.take(card.name, "temperature of links")
        if default is not None:
            for name in reader.deck.nodes:
                found.setdefault(name, default)
        if reader.sets[kind] and not found and not any(
                reader.factor(card, kind) is not None for card in reader.cards.get("TEMPRB", [])):
            reader.deck.refuse("TEMPERATURE", "missing_set", 0, set_name=next(iter(reader.sets[kind])))
    _left(reader)


def _left(reader: Reader) -> None:
    for card in reader.cards.get("TEMP", []):
        if reader.factor(card, "temperature") is None and reader.factor(card, "initial") is None:
            reader.deck.leave("TEMP", f"set {reader.whole(card, 0)} is not selected", card.line)
    for card in reader.cards.get("TEMPD", []):
        for text in filter(None, card.fields[::2]):
            name = reader.name(card.line, text)
            if name not in reader.sets["temperature"] and name not in reader.sets["initial"]:
                reader.deck.leave("TEMPD", f"set {name} is not selected", card.line)
