# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of Nastran bulk data. A table declares how each card is used; the readers follow the table."""
from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from statejump.core.reading import finite_number
from statejump.kinds.truss.importing.beams import split_tapered
from statejump.kinds.truss.importing.bodies import settle_bodies
from statejump.kinds.truss.importing.contract import IDLE, REFUSED
from statejump.kinds.truss.importing.model import Deck, Options
from statejump.kinds.truss.importing.nastran import bodies, control, elements, loads, nodes, properties
from statejump.kinds.truss.importing.nastran.cards import Card, number_of, split
from statejump.kinds.truss.importing.nastran.reader import Reader
from statejump.kinds.truss.importing.nastran.table import CARDS, PARAMS

# In the order of reading: each reader needs the results of those before it.
READERS: dict[str, Callable[[Reader, Card], None]] = {
    "MAT1": properties.mat1, "PROD": properties.simple, "PBAR": properties.simple, "PTUBE": properties.ptube,
    "PBARL": properties.pbarl, "PBEAM": properties.pbeam, "PBEAML": properties.pbeaml, "PELAS": properties.pelas,
    "CROD": elements.rods, "CTUBE": elements.rods, "CBAR": elements.bar, "CBEAM": elements.bar,
    "CONROD": elements.conrod,
    "SPC": nodes.spc, "SPC1": nodes.spc1, "CELAS1": elements.celas, "CELAS2": elements.celas, "CBUSH": elements.cbush,
    "PMASS": properties.pmass, "CMASS1": elements.cmass, "CMASS2": elements.cmass, "CONM1": elements.conm1,
    "CONM2": elements.conm2, "FORCE": loads.force, "FORCE1": loads.force, "FORCE2": loads.force, "MOMENT": loads.moment,
    "MOMENT1": loads.moment, "MOMENT2": loads.moment, "PLOAD1": loads.pload1, "GRAV": loads.gravity,
    "DEFORM": elements.deform, "TEMPRB": loads.beam_temperatures,
    "RBAR": bodies.rbar, "RBAR1": bodies.rbar, "RBE2": bodies.rbe2, "RBE3": bodies.rbe3, "RROD": bodies.rrod,
    "MPC": bodies.mpc,
}
# Cards that functions outside of READERS read together.
TOGETHER = ("GRID", "GRDSET", "CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S", "BAROR", "BEAMOR", "PBUSH",
            "SPCADD", "MPCADD", "LOAD", "LOADADD", "TEMP", "TEMPD", "PARAM")


def read(path: Path, options: Options | None = None) -> Deck:
    """Return the content of bulk data. :raises StatejumpError: one sentence with file and line"""
    deck = Deck(path, options or Options())
    lines, cards = split(deck)
    chosen = control.read(deck, lines)
    by_name: dict[str, list[Card]] = {}
    for card in cards:
        by_name.setdefault(card.name, []).append(card)
    deck.modal = chosen.solves(control.FREE_SOLUTIONS)
    reader = Reader(deck, by_name)
    loads.select(reader, chosen)
    for card in cards:
        if card.name == "SPCD" and chosen.solves(control.DYNAMIC_SOLUTIONS):
            deck.leave(card.name, "given motion of a dynamic solution", card.line)
        elif card.name in ("SUPORT", "SUPORT1") and chosen.solves(control.FREE_SOLUTIONS):
            deck.leave(card.name, "reference of rigid-body modes: it holds nothing in this solution", card.line)
            deck.free = True
        else:
            _check(reader, card, chosen)
    deck.settle()
    nodes.read_nodes(reader)
    for name, read_card in READERS.items():
        for card in by_name.get(name, []):
            if name not in deck.options.ignored and _counts(reader, card):
                read_card(reader, card)
    elements.take_components(reader)
    _take_together(reader)
    loads.temperatures(reader)
    elements.finish_bars(reader)
    loads.finish(reader)
    settle_bodies(deck)
    if chosen.autospc:
        nodes.hold_singular(reader)
    split_tapered(deck)
    if chosen.solution.startswith("106"):  # in this solution TREF belongs to the coefficient of expansion only
        for bar in deck.bars:
            bar.reference_temperature = None
    deck.settle()
    return deck


def _counts(reader: Reader, card: Card) -> bool:
    """Return whether the case control selects the set of a card."""
    kind = CARDS[card.name].sets
    return not kind or card.name == "TEMP" or reader.factor(card, kind) is not None


def _check(reader: Reader, card: Card, given: control.Control) -> None:
    """Refuse unsupported cards and fields; record those without influence."""
    deck, known = reader.deck, CARDS.get(card.name)
    if known is None:
        deck.refuse(card.name, "unknown_card", card.line)
    elif known.sets and not _counts(reader, card):
        deck.leave(card.name, f"set {reader.whole(card, 0)} is not selected", card.line)
    elif card.name == "PARAM":
        _param(reader, card, given)
    elif known.use == REFUSED:
        deck.refuse(card.name, known.what, card.line)
    elif known.use == IDLE:
        deck.leave(card.name, known.what, card.line)
    elif card.name in deck.options.ignored:
        deck.waived.add(card.name)
        deck.leave(card.name, "left out by --ignore", card.line)
    else:
        if not known.own:
            _check_fields(reader, card)


def _check_fields(reader: Reader, card: Card) -> None:
    known = CARDS[card.name]
    for place, text in enumerate(card.fields):
        if not text:
            continue
        field = known.field(place)
        if field is None:
            raise reader.fail(card, "deck_bad_syntax", problem=f"it has no field {place + 2}")
        if field.use == REFUSED and number_of(text) != 0:
            name = field.name if field.name != "-" else f"field {place + 2}"
            reader.deck.refuse(f"{card.name}.{name}", field.why, card.line)


def _param(reader: Reader, card: Card, given: control.Control) -> None:
    name = card[0].upper()
    known = PARAMS.get(name)
    if name == "WTMASS":
        reader.deck.mass_scale = reader.number(card, 1)
    elif name == "AUTOSPC":
        given.autospc = card[1].upper() != "NO"
    elif name == "ART_MASS":  # Y or N, mass of translations, of rotations
        if card[1].upper() == "Y" and reader.number(card, 2, 1.0) != 0:
            reader.deck.refuse(f"PARAM.{name}", "mass_at_every_node", card.line)
        else:
            reader.deck.leave(f"PARAM {name}", "it adds no mass to translations", card.line)
    elif known is None:
        reader.deck.refuse(f"PARAM.{name}", "unknown_parameter", card.line)
    elif known.use == REFUSED:
        value = finite_number(card[1].lower())
        if card[1].upper() != "NO" and value not in ({0.0} if name in ("INREL", "HEATSTAT") else {1.0}):
            reader.deck.refuse(f"PARAM.{name}", known.what, card.line)
    else:
        reader.deck.leave(f"PARAM {name}", known.what, card.line)


def _take_together(reader: Reader) -> None:
    """Record the cards that are read together."""
    for name in ("GRDSET", "BAROR", "BEAMOR", "PBUSH", "PARAM"):
        for card in reader.cards.get(name, []):
            if name != "PARAM" or card[0].upper() in ("WTMASS", "AUTOSPC"):
                reader.deck.take(name, CARDS[name].what)
    for name in ("SPCADD", "MPCADD", "LOAD", "LOADADD"):
        for card in reader.cards.get(name, []):
            if (name, "sets of loads with factors") not in reader.deck.taken and \
                    (name, "sets of supports") not in reader.deck.taken:
                reader.deck.leave(name, f"set {reader.whole(card, 0)} is not selected", card.line)
