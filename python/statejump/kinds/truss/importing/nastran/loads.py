# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of sets of the case control, forces, gravity and temperatures."""
from __future__ import annotations

import numpy as np

from statejump.kinds.truss.importing.model import Moment, quoted
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


def pload1(reader: Reader, card: Card) -> None:
    """Convert a load along a bar (PLOAD1) to forces on its ends; refuse a load across the bar, which bends it."""
    factor, name = reader.factor(card, "load") or 0.0, reader.whole(card, 1)
    if name not in reader.bars:
        raise reader.fail(card, "deck_undefined", what_it_is="bar", name=name)
    ends, released = reader.bars[name][1].nodes, reader.bars[name][1].released
    first, second = (np.array(reader.deck.nodes[end]) for end in ends)
    length = float(np.linalg.norm(second - first))
    axis = (second - first) / length if length else np.zeros(3)
    kind, scale = card[2].upper(), card[3].upper()
    directions = {"FX": np.eye(3)[0], "FY": np.eye(3)[1], "FZ": np.eye(3)[2], "FXE": axis}
    along = directions.get(kind)
    if along is None or np.linalg.norm(np.cross(along, axis)) > ALONG:
        reader.deck.refuse(card.name, "lateral_load", card.line)
        return
    if scale not in ("LE", "FR"):
        reader.deck.refuse(card.name, "load_scale", card.line, scale=quoted(card[3])[1:-1])
        return
    start, low = reader.number(card, 4), reader.number(card, 5)
    end = reader.number(card, 6) if card[6] else start
    high = reader.number(card, 7) if card[7] else low
    start, end = (value / (length if scale == "LE" and length else 1.0) for value in (start, end))
    if end == start:  # a force
        shares = (low * (1 - start), low * start)
    else:
        span, rise = end - start, high - low
        total = span * length * (low + high) / 2
        # Integral of load times position along the bar, as a fraction of its length.
        second_share = span * length * (low * start + low * span / 2 + rise * start / 2 + rise * span / 3)
        shares = (total - second_share, second_share)
    if all(released):
        reader.deck.refuse(card.name, "released_bar", card.line)
        return
    if any(released):  # the other end carries the whole load
        shares = (0.0, sum(shares)) if released[0] else (sum(shares), 0.0)
    for node, share in zip(ends, shares):
        reader.deck.load(node, [float(part) * share * factor for part in along], card.line, card.name)
    reader.deck.take(card.name, "dead loads of both ends")


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
        if reader.sets[kind] and not found:
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
