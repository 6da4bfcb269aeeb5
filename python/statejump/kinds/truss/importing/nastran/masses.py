# SPDX-License-Identifier: GPL-3.0-or-later
"""Masses of single components of nodes."""
from __future__ import annotations

from statejump.kinds.truss.importing.nastran.cards import Card
from statejump.kinds.truss.importing.nastran.elements import element, weigh
from statejump.kinds.truss.importing.nastran.reader import Reader
from statejump.kinds.truss.importing.supports import is_held


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
    """Convert component masses to nodal masses; they must be equal in all directions that are not held."""
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
