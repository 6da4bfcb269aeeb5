# SPDX-License-Identifier: GPL-3.0-or-later
"""Equations between displacements."""
from __future__ import annotations

from statejump.kinds.truss.importing.abaqus.keywords import Block
from statejump.kinds.truss.importing.abaqus.model import Model, Scope
from statejump.kinds.truss.importing.model import Equation


def equation(model: Model, block: Block, scope: Scope) -> None:
    """Read the equations of one block: number of terms, then node, direction and factor of each term."""
    rest = [(line, words) for line, words in block.data]
    while rest:
        begun, words = rest.pop(0)
        count = model.whole(begun, words[0])
        parts: list[str] = []
        while rest and len(parts) < 3 * count:
            parts += [word for word in rest.pop(0)[1] if word]
        if len(parts) != 3 * count:
            raise model.deck.fail(begun, "deck_incomplete", "*EQUATION", needed=f"{count} terms")
        _add(model, begun, [parts[at:at + 3] for at in range(0, 3 * count, 3)], scope)


def _add(model: Model, line: int, parts: list[list[str]], scope: Scope) -> None:
    terms = []
    for word, direction, factor in parts:
        nodes = model.nodes_of(line, word, scope)
        at, value = model.whole(line, direction), model.number(line, factor)
        if len(nodes) != 1 or not 1 <= at <= 3:
            model.deck.refuse("*EQUATION", "node_sets" if len(nodes) != 1 else "rotation", line, "EQUATION")
            return
        for node in nodes:
            if value:
                terms.append((node, model.frame(node).directions(model.deck.nodes[node])[at - 1], value))
    model.deck.equations.append(Equation(line, "*EQUATION", terms))
