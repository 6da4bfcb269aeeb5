# SPDX-License-Identifier: GPL-3.0-or-later
"""Generated or copied nodes and elements: ``*NGEN``, ``*NFILL``, ``*NCOPY``, ``*ELGEN``, ``*ELCOPY``."""
from __future__ import annotations

from math import atan2, degrees

import numpy as np

from statejump.kinds.truss.importing.abaqus.keywords import Block
from statejump.kinds.truss.importing.abaqus.mesh import add_element, add_node
from statejump.kinds.truss.importing.abaqus.model import Model, Scope
from statejump.kinds.truss.importing.coordinates import rotated
from statejump.kinds.truss.importing.model import MOST_ITEMS, quoted


def _place(model: Model, line: int, name: str) -> np.ndarray:
    if name not in model.deck.nodes:
        raise model.deck.fail(line, "deck_undefined", what_it_is="node", name=name)
    return np.array(model.deck.nodes[name])


def _shifted(model: Model, line: int, name: str, shift: int) -> str:
    """Return the name of a node or element with its number increased by ``shift``."""
    prefix, stop, number = name.rpartition(".")
    return f"{prefix}{stop}{int(number) + shift}"


def ngen(model: Model, block: Block, scope: Scope) -> None:
    """Generate nodes between two given nodes, on a straight line or on an arc about a point."""
    line_kind = block.parameters.get("LINE", "").upper()
    if line_kind not in ("", "C"):
        model.deck.refuse("*NGEN, LINE", "parabola", block.line, "NGEN.LINE")
        return
    made: list[str] = []
    for line, words in block.data:
        ends = [model.name(line, word, scope) for word in (words + ["", ""])[:2]]
        first, last = (int(name.rpartition(".")[2]) for name in ends)
        step = model.whole(line, words[2]) if len(words) > 2 and words[2] else 1
        if step == 0 or (last - first) % step:
            raise model.deck.fail(line, "deck_bad_value", "*NGEN",
                                  problem=f"steps of {step} do not lead from {first} to {last}")
        start, end = (_place(model, line, name) for name in ends)
        count = abs(last - first) // step
        model.deck.room(line, len(model.deck.nodes) + count)
        arc = _arc(model, line, words, scope, start, end) if line_kind else None
        made.append(ends[0])
        for number in range(1, count):
            name = f"{scope.prefix}{first + (step if last > first else -step) * number}"
            part = number / count
            point = start + (end - start) * part if arc is None else rotated(start, arc[0], arc[1], arc[2] * part)
            add_node(model, line, name, [float(value) for value in point])
            made.append(name)
        made.append(ends[1])
    if group := block.parameters.get("NSET"):
        model.add(block.line, model.node_sets, scope.prefix + group.upper(), made)
    model.deck.take("*NGEN", "nodes", len(made))


def _arc(model: Model, line: int, words: list[str], scope: Scope, start: np.ndarray, end: np.ndarray) -> tuple[
        np.ndarray, np.ndarray, float]:
    """Return the centre of an arc, a second point of its axis, and its angle [°]."""
    if len(words) > 3 and words[3]:
        centre = _place(model, line, model.name(line, words[3], scope))
    else:
        centre = np.array((model.numbers(line, words[4:7]) + [0.0] * 3)[:3])
        if scope.move is not None:
            centre = scope.move(centre)
    normal = np.array(model.numbers(line, words[7:10])) if len(words) > 9 else np.cross(start - centre, end - centre)
    size = np.linalg.norm(normal)
    if size == 0:
        raise model.deck.fail(line, "deck_bad_geometry", "*NGEN", problem="the arc has no plane")
    normal = normal / size
    first, second = start - centre, end - centre
    angle = degrees(atan2(float(normal @ np.cross(first, second)), float(first @ second)))
    return centre, centre + normal, angle if angle > 0 else angle + 360


def nfill(model: Model, block: Block, scope: Scope) -> None:
    """Generate nodes on straight lines between the nodes of two sets."""
    made: list[str] = []
    for line, words in block.data:
        if len(words) < 3:
            raise model.deck.fail(line, "deck_incomplete", "*NFILL", needed="two sets and the number of intervals")
        first, last = (model.nodes_of(line, word, scope) for word in words[:2])
        count, step = model.whole(line, words[2]), model.whole(line, words[3]) if len(words) > 3 and words[3] else 1
        if len(first) != len(last) or count < 1:
            raise model.deck.fail(line, "deck_bad_value", "*NFILL",
                                  problem="the sets differ in size, or there is no interval")
        model.deck.room(line, len(model.deck.nodes) + count * len(first))
        for start, end in zip(first, last):
            begin, way = _place(model, line, start), _place(model, line, end) - _place(model, line, start)
            made.append(start)
            for number in range(1, count):
                name = _shifted(model, line, start, step * number)
                add_node(model, line, name, [float(value) for value in begin + way * (number / count)])
                made.append(name)
            made.append(end)
    if group := block.parameters.get("NSET"):
        model.add(block.line, model.node_sets, scope.prefix + group.upper(), made)
    model.deck.take("*NFILL", "nodes", len(made))


def ncopy(model: Model, block: Block, scope: Scope) -> None:
    """Copy the nodes of a set, shifted and rotated, once or repeatedly."""
    step = model.whole(block.line, model.needed(block, "CHANGE NUMBER"))
    source = list(model.nodes_of(block.line, model.needed(block, "OLD SET"), scope))
    times = model.whole(block.line, block.parameters.get("MULTIPLE") or "1")
    if "SHIFT" not in block.parameters or not block.data:
        raise model.deck.fail(block.line, "deck_incomplete", "*NCOPY", needed="SHIFT")
    line, words = block.data[0]
    shift = np.array((model.numbers(line, words) + [0.0] * 3)[:3])
    turn = model.numbers(*block.data[1]) if len(block.data) > 1 else []
    if turn and len(turn) != 7:
        raise model.deck.fail(block.data[1][0], "deck_incomplete", "*NCOPY", needed="two points and an angle")
    model.deck.room(line, len(model.deck.nodes) + times * len(source))
    made: list[str] = []
    for number in range(1, times + 1):
        for name in source:
            point = _place(model, line, name) + shift * number
            if turn:
                point = rotated(point, np.array(turn[:3]), np.array(turn[3:6]), turn[6] * number)
            other = _shifted(model, line, name, step * number)
            add_node(model, line, other, [float(value) for value in point])
            made.append(other)
    if group := block.parameters.get("NEW SET"):
        model.add(block.line, model.node_sets, scope.prefix + group.upper(), made)
    model.deck.take("*NCOPY", "nodes", len(made))


def elgen(model: Model, block: Block, scope: Scope) -> None:
    """Generate elements in rows, columns and layers from one element."""
    made: list[str] = []
    for line, words in block.data:
        master = model.name(line, words[0], scope)
        if master not in model.elements:
            raise model.deck.fail(line, "deck_undefined", what_it_is="element", name=master)
        given = [model.whole(line, word) if word else 1 for word in words[1:]]
        rows = [((given[at:at + 3] + [1, 1, 1])[:3]) for at in (0, 3, 6)]
        made.append(master)
        copies = [(0, 0)]
        for count, node_step, element_step in rows:
            if count * len(copies) > MOST_ITEMS:
                raise model.deck.fail(line, "deck_too_many_items", most=MOST_ITEMS)
            copies = [(nodes + node_step * number, elements + element_step * number)
                      for number in range(max(count, 1)) for nodes, elements in copies]
        _copies(model, line, master, copies[1:], made)
    if group := block.parameters.get("ELSET"):
        model.add(block.line, model.element_sets, scope.prefix + group.upper(), made)
    model.deck.take("*ELGEN", "elements", len(made))


def _copies(model: Model, line: int, master: str, shifts: list[tuple[int, int]], made: list[str]) -> None:
    of = model.elements[master]
    for node_shift, element_shift in shifts:
        name = _shifted(model, line, master, element_shift)
        add_element(model, line, name, of.family, of.kind,
                    [_shifted(model, line, end, node_shift) for end in of.nodes])
        made.append(name)


def elcopy(model: Model, block: Block, scope: Scope) -> None:
    """Copy the elements of a set with shifted numbers and nodes."""
    element_step, node_step = (model.whole(block.line, model.needed(block, key))
                               for key in ("ELEMENT SHIFT", "SHIFT NODES"))
    made: list[str] = []
    old = model.needed(block, "OLD SET")
    for one in model.elements_of(block.line, old, scope):
        _copies(model, block.line, one.name, [(node_step, element_step)], made)
    if not made:
        raise model.deck.fail(block.line, "deck_undefined", what_it_is="element in set", name=quoted(old))
    if group := block.parameters.get("NEW SET"):
        model.add(block.line, model.element_sets, scope.prefix + group.upper(), made)
    model.deck.take("*ELCOPY", "elements", len(made))
