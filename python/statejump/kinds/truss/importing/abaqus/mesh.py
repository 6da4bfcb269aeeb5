# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes, elements and sets."""
from __future__ import annotations

import re

import numpy as np

from statejump.kinds.truss.importing.abaqus.keywords import Block
from statejump.kinds.truss.importing.abaqus.model import Element, Model, Scope
from statejump.kinds.truss.importing.abaqus.table import ELEMENTS
from statejump.kinds.truss.importing.coordinates import BASIC, Frame, by_axis
from statejump.kinds.truss.importing.model import quoted

# Number of nodes of an element that is no bar: the last number of its type, for example C3D20R.
NODES = re.compile(r"[A-Z]+(?:3D|2D)?(\d+)[A-Z]*$")


def system(model: Model, block: Block, scope: Scope) -> None:
    """Read the coordinate system of the nodes that follow. Without data lines it is the basic system."""
    if not block.data:
        model.system = BASIC
        return
    line, first = block.data[0]
    values = model.numbers(line, first)
    origin = np.array((values + [0.0] * 3)[:3])
    if len(values) < 6:
        model.system = Frame("R", origin, np.eye(3))
        return
    on_x = np.array(values[3:6])
    if len(block.data) > 1:
        in_xy = np.array((model.numbers(*block.data[1]) + [0.0] * 3)[:3])
    else:  # z stays
        on_x[2] = origin[2]
        in_xy = origin + np.cross([0.0, 0.0, 1.0], on_x - origin)
    found = by_axis("R", origin, on_x, in_xy)
    if found is None:
        raise model.deck.fail(block.line, "deck_bad_geometry", "*SYSTEM", problem="its points span no plane")
    model.system = found


def node(model: Model, block: Block, scope: Scope) -> None:
    """Nodes in rectangular or cylindrical coordinates."""
    kind = block.parameters.get("SYSTEM", "R").upper()[:1] or "R"
    if kind not in ("R", "C"):
        model.deck.refuse("*NODE, SYSTEM", "spherical_coordinates", block.line, "NODE.SYSTEM")
    frame = Frame(kind, model.system.origin, model.system.axes)
    plain = kind == "R" and model.system is BASIC and scope.move is None
    made = []
    for line, words in block.data:
        name = model.name(line, words[0], scope)
        values = (model.numbers(line, words[1:4]) + [0.0] * 3)[:3]
        if not plain:
            point = frame.point(values)
            values = [float(part) for part in (point if scope.move is None else scope.move(point))]
        add_node(model, line, name, values)
        made.append(name)
    group = block.parameters.get("NSET", "")
    if group:
        model.add(block.line, model.node_sets, scope.prefix + group.upper(), made)
    model.deck.take("*NODE", "node", len(made))


def add_node(model: Model, line: int, name: str, values: list[float]) -> None:
    """Add a node. A repeated node must have the same position."""
    x, y, z = values
    if model.deck.nodes.get(name) == (x, y, z):
        return
    model.deck.add_node(line, name, (x, y, z))


def element(model: Model, block: Block, scope: Scope) -> None:
    """Read the elements of one type. Each element extends over as many lines as its nodes need."""
    kind = model.needed(block, "TYPE").upper()
    known = ELEMENTS.get(kind)
    found = NODES.match(kind)
    count = known[1] if known else int(found[1]) if found else 0
    made: list[str] = []
    pending: list[str] = []
    begun = 0
    for line, words in block.data:
        begun = begun or line
        pending += words
        if len(pending) <= count:
            continue
        _add_element(model, begun, kind, pending[:count + 1] if count else pending, scope, made)
        pending, begun = [], 0
    if pending:
        raise model.deck.fail(begun, "deck_incomplete", f"element {quoted(pending[0])[1:-1]}", needed=f"{count} nodes")
    if group := block.parameters.get("ELSET"):
        model.add(block.line, model.element_sets, scope.prefix + group.upper(), made)


def _add_element(model: Model, line: int, kind: str, words: list[str], scope: Scope, made: list[str]) -> None:
    name = model.name(line, words[0], scope)
    family = ELEMENTS[kind][0] if kind in ELEMENTS else ""
    nodes = [model.name(line, word, scope) for word in words[1:]] if family else []
    add_element(model, line, name, family, kind, nodes)
    made.append(name)


def add_element(model: Model, line: int, name: str, family: str, kind: str, nodes: list[str]) -> None:
    """Add an element whose nodes are there."""
    if name in model.elements:
        raise model.deck.fail(line, "deck_duplicate", what_it_is="element", name=name)
    model.deck.room(line, len(model.elements) + 1)
    for end in nodes:
        if end not in model.deck.nodes:
            raise model.deck.fail(line, "deck_undefined", f"element {name}", what_it_is="node", name=end)
    model.elements[name] = Element(name, family, kind, nodes, line)


def check_type(model: Model, block: Block) -> None:
    """Refuse elements that a truss does not support."""
    kind = model.needed(block, "TYPE").upper()
    known = ELEMENTS.get(kind)
    card = f"*ELEMENT, TYPE={quoted(kind)[1:-1]}"
    if known is None:
        model.deck.refuse(card, "not_a_straight_bar", block.line, kind)


def node_set(model: Model, block: Block, scope: Scope) -> None:
    """Read a set of nodes, given by numbers, by other sets, or as the nodes of elements."""
    _set(model, block, scope, True)


def element_set(model: Model, block: Block, scope: Scope) -> None:
    """A set of elements."""
    _set(model, block, scope, False)


def _set(model: Model, block: Block, scope: Scope, nodes: bool) -> None:
    key = "NSET" if nodes else "ELSET"
    sets = model.node_sets if nodes else model.element_sets
    name = scope.prefix + model.needed(block, key).upper()
    of = scope
    if instance := block.parameters.get("INSTANCE"):
        of = Scope(f"{instance.upper()}.")
    model.add(block.line, sets, name, [])
    if nodes and "ELSET" in block.parameters:
        found = {end: None for one in model.elements_of(block.line, block.parameters["ELSET"], of) for end in one.nodes}
        model.add(block.line, sets, name, found)
    known = model.deck.nodes.keys() if nodes else model.elements.keys()
    for line, words in block.data:
        words = [word for word in words if word]
        if "GENERATE" in block.parameters:
            if len(words) not in (2, 3):
                raise model.deck.fail(line, "deck_incomplete", "GENERATE", needed="first, last and step")
            first, last, step = (model.whole(line, word) for word in [*words, "1"][:3])
            if step == 0:
                raise model.deck.fail(line, "deck_bad_value", "GENERATE", problem="its step is 0")
            model.add(line, sets, name, model.range(nodes, of.prefix, first, last, step))
            continue
        for word in words:
            other = model.group(nodes, word, of)
            if other is not None:
                model.add(line, sets, name, other)
                continue
            item = model.name(line, word, of)
            if item not in known:
                raise model.deck.fail(line, "deck_undefined", what_it_is="node" if nodes else "element", name=item)
            model.add(line, sets, name, [item])
    model.deck.take(f"*{key}", "names")
