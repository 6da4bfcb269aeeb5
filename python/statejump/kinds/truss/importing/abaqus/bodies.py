# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of rigid bodies and kinematic couplings."""
from __future__ import annotations

import numpy as np

from statejump.kinds.truss.importing.abaqus.keywords import Block
from statejump.kinds.truss.importing.abaqus.model import Model, Scope
from statejump.kinds.truss.importing.coupling import ALL, MOVES, couple
from statejump.kinds.truss.importing.model import Moment, quoted
from statejump.kinds.truss.importing.supports import held_directions


def rigid_body(model: Model, block: Block, scope: Scope) -> None:
    """Read a rigid body. Nodes of NSET, in CalculiX, and of PIN NSET follow by displacements, those of TIE NSET also by
    rotations."""
    master = _master(model, block, scope)
    found = False
    for key, components in (("NSET", MOVES), ("PIN NSET", MOVES), ("TIE NSET", ALL)):
        if name := block.parameters.get(key):
            found = True
            _couple(model, block, master, model.nodes_of(block.line, name, scope), components)
    if not found:
        raise model.deck.fail(block.line, "deck_incomplete", "*RIGID BODY", needed="NSET=, PIN NSET= or TIE NSET=")
    if name := block.parameters.get("ROT NODE"):
        for node in model.nodes_of(block.line, name, scope):
            _rotate(model, block, master, node)


def _rotate(model: Model, block: Block, master: str, node: str) -> None:
    """Pass supports and forces of the node of rotations, whose displacements are rotations, to the master."""
    deck = model.deck
    if node == master:
        deck.refuse("*RIGID BODY, ROT NODE", "same_node", block.line, "RIGID BODY.ROT NODE")
        return
    for way in held_directions(deck, node):
        deck.hold_rotation(master, way)
    deck.fixed.pop(node, None)
    deck.held.pop(node, None)
    if (force := deck.force.pop(node, None)) is not None:
        line, card = deck.force_line.pop(node, (block.line, "*CLOAD"))
        deck.moments.append(Moment(line, card, master, np.array(force)))


def kinematic_coupling(model: Model, block: Block, scope: Scope) -> None:
    """Read nodes, or sets of nodes, that follow a node in a range of components."""
    master = _master(model, block, scope)
    for line, words in block.data:
        _couple(model, block, master, model.nodes_of(line, words[0], scope), _components(model, line, words[1:]))


def surface(model: Model, block: Block, scope: Scope) -> None:
    """Read the nodes of a surface of nodes, for couplings."""
    name = scope.prefix + block.parameters.get("NAME", "").upper()
    if block.parameters.get("TYPE", "ELEMENT").upper() != "NODE":
        model.deck.leave("*SURFACE", "a surface of elements: only contacts and loads of solids use it", block.line)
        return
    nodes = [node for line, words in block.data for node in model.nodes_of(line, words[0], scope)]
    model.surfaces[name] = list(dict.fromkeys(nodes))
    model.deck.take("*SURFACE", "nodes of couplings")


def coupling(model: Model, block: Block, scope: Scope) -> None:
    """Read the master and the surface of a coupling; ``*KINEMATIC`` follows."""
    name = model.needed(block, "SURFACE").upper()
    nodes = model.surfaces.get(scope.prefix + name, model.surfaces.get(name))
    if nodes is None:
        model.deck.refuse("*COUPLING, SURFACE", "surface_of_elements", block.line, "COUPLING.SURFACE")
        nodes = []
    model.coupling = (_master(model, block, scope), nodes)


def kinematic(model: Model, block: Block, scope: Scope) -> None:
    """Read the components of the coupling before it."""
    if model.coupling is None:
        raise model.deck.fail(block.line, "deck_incomplete", "*KINEMATIC", needed="*COUPLING")
    (master, nodes), model.coupling = model.coupling, None
    components = frozenset[str]().union(*(_components(model, line, words) for line, words in block.data)) or ALL
    _couple(model, block, master, nodes, components)


def _components(model: Model, line: int, words: list[str]) -> frozenset[str]:
    """Return the components of a range; all if none is given."""
    given = [model.whole(line, word) for word in words[:2] if word]
    if not given:
        return ALL
    if not 1 <= given[0] <= given[-1] <= 6:
        raise model.deck.fail(line, "deck_bad_value", problem=f"{given[0]} to {given[-1]} are no components")
    return frozenset("123456"[given[0] - 1:given[-1]])


def _master(model: Model, block: Block, scope: Scope) -> str:
    nodes = model.nodes_of(block.line, model.needed(block, "REF NODE"), scope)
    if len(nodes) != 1:
        raise model.deck.fail(block.line, "deck_bad_value", f"*{block.name}",
                              problem=f"REF NODE={quoted(block.parameters['REF NODE'])[1:-1]} is not one node")
    return nodes[0]


def _couple(model: Model, block: Block, master: str, nodes: list[str], components: frozenset[str]) -> None:
    others = [node for node in nodes if node != master]
    if not components >= MOVES and any(node in model.frames for node in others):
        model.deck.refuse(f"*{block.name}", "partial_coupling", block.line)
    elif others:
        couple(model.deck, block.line, f"*{block.name}", master, others, components, lambda node: np.eye(3),
               model.bends())
