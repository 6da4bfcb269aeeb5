# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of rigid bodies and kinematic couplings."""
from __future__ import annotations

import numpy as np

from statejump.kinds.truss.importing.abaqus.keywords import Block
from statejump.kinds.truss.importing.abaqus.model import Model, Scope
from statejump.kinds.truss.importing.abaqus.table import COUPLING
from statejump.kinds.truss.importing.coupling import ALL, MOVES, couple
from statejump.kinds.truss.importing.model import Follower, Moment, quoted
from statejump.kinds.truss.importing.supports import SAME, held_directions


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
    model.surfaces[name] = {node: model.number(line, words[1]) if len(words) > 1 and words[1] else 1.0
                            for line, words in block.data for node in model.nodes_of(line, words[0], scope)}
    model.deck.take("*SURFACE", "nodes of couplings")


def coupling(model: Model, block: Block, scope: Scope) -> None:
    """Read the master and the surface of a coupling; ``*KINEMATIC`` or ``*DISTRIBUTING`` follows."""
    name = model.needed(block, "SURFACE").upper()
    nodes = model.surfaces.get(scope.prefix + name, model.surfaces.get(name))
    if nodes is None:
        model.deck.refuse("*COUPLING, SURFACE", "surface_of_elements", block.line, "COUPLING.SURFACE")
        nodes = {}
    model.coupling = (_master(model, block, scope), nodes)


def kinematic(model: Model, block: Block, scope: Scope) -> None:
    """Read the components of the coupling before it."""
    if model.coupling is None:
        raise model.deck.fail(block.line, "deck_incomplete", "*KINEMATIC", needed="*COUPLING")
    (master, nodes), model.coupling = model.coupling, None
    components = frozenset[str]().union(*(_components(model, line, words) for line, words in block.data)) or ALL
    _couple(model, block, master, list(nodes), components)


def distributing(model: Model, block: Block, scope: Scope) -> None:
    """Read the components of the coupling before it, whose node follows the mean of the surface."""
    if model.coupling is None:
        raise model.deck.fail(block.line, "deck_incomplete", "*DISTRIBUTING", needed="*COUPLING")
    (reference, nodes), model.coupling = model.coupling, None
    for key, usual in (("COUPLING", "CONTINUUM"), ("WEIGHTING METHOD", "UNIFORM")):
        if block.parameters.get(key, usual).upper() != usual:
            model.deck.refuse(f"*DISTRIBUTING, {key}", "mean_weighting", block.line, f"DISTRIBUTING.{key}")
    components = frozenset[str]().union(*(_components(model, line, words) for line, words in block.data)) or ALL
    if not components >= MOVES:
        model.deck.refuse("*DISTRIBUTING", "partial_coupling", block.line)
    elif nodes:
        _follow(model, block, reference, nodes, components)


def distributing_coupling(model: Model, block: Block, scope: Scope) -> None:
    """Read nodes with weights, whose mean the node of a coupling element follows."""
    name = model.needed(block, "ELSET")
    elements = model.elements_of(block.line, name, scope)
    if len(elements) != 1 or elements[0].family != COUPLING:
        raise model.deck.fail(block.line, "deck_bad_value", "*DISTRIBUTING COUPLING",
                              problem=f"ELSET={quoted(name)[1:-1]} is not one element DCOUP3D or DCOUP2D")
    (reference,) = elements[0].nodes
    weights: dict[str, float] = {}
    for line, words in block.data:
        for node in model.nodes_of(line, words[0], scope):
            weights[node] = weights.get(node, 0.0) + (model.number(line, words[1]) if len(words) > 1 else 1.0)
    places = np.array([model.deck.nodes[node] for node in weights])
    centre = np.array(list(weights.values())) @ places / (sum(weights.values()) or 1.0)
    if np.linalg.norm(centre - model.deck.nodes[reference]) > SAME * float(np.ptp(places, axis=0).max(initial=0.0)):
        model.deck.refuse("*DISTRIBUTING COUPLING", "mean_reference_aside", block.line)
    else:
        _follow(model, block, reference, weights, ALL)


def _follow(model: Model, block: Block, reference: str, weights: dict[str, float], components: frozenset[str]) -> None:
    if not weights or not min(weights.values()) > 0:
        raise model.deck.fail(block.line, "deck_bad_value", f"*{block.name}", problem="weights must be above 0")
    displacements = np.eye(6)[:3]
    follows = np.eye(6)[[int(one) - 1 for one in sorted(components)]]
    model.deck.followers.append(Follower(block.line, f"*{block.name}", reference, follows,
                                         [(node, weight, displacements) for node, weight in weights.items()]))


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
