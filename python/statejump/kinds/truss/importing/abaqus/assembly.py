# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts and instances of an assembly. Every instance repeats the blocks of its part, with its own scope."""
from __future__ import annotations

from collections.abc import Callable

import numpy as np

from statejump.kinds.truss.importing.abaqus.keywords import Block
from statejump.kinds.truss.importing.abaqus.model import Model, Scope
from statejump.kinds.truss.importing.coordinates import rotated
from statejump.kinds.truss.importing.model import quoted


def flat(model: Model, blocks: list[Block]) -> list[tuple[Block, Scope]]:
    """Return all blocks of a deck with their scopes. The blocks of a part follow each of its instances."""
    parts: dict[str, list[Block]] = {}
    found: list[tuple[Block, Scope]] = []
    part: list[Block] | None = None
    scope = Scope()
    for block in blocks:
        if block.name == "PART":
            part = parts.setdefault(model.needed(block, "NAME").upper(), [])
        elif block.name == "END PART":
            part = None
        elif block.name == "INSTANCE":
            scope = _scope(model, block)
            name = block.parameters.get("PART", "").upper()
            if name not in parts:
                raise model.deck.fail(block.line, "deck_undefined", what_it_is="part", name=quoted(name))
            found += [(one, scope) for one in parts[name]]
            model.deck.take("*INSTANCE", "a part, shifted and rotated")
            model.deck.room(block.line, len(found))
        elif block.name == "END INSTANCE":
            scope = Scope()
        elif part is not None:
            part.append(block)
            continue
        else:
            found.append((block, scope))
            continue
        model.deck.take(f"*{block.name}", "structure of the deck")
    return found


def _scope(model: Model, block: Block) -> Scope:
    prefix = f"{model.needed(block, 'NAME').upper()}."
    shift = np.zeros(3)
    turn: list[float] = []
    if block.data:
        shift = np.array((model.numbers(*block.data[0]) + [0.0] * 3)[:3])
    if len(block.data) > 1:
        turn = model.numbers(*block.data[1])
        if len(turn) != 7 or turn[:3] == turn[3:6]:
            raise model.deck.fail(block.data[1][0], "deck_incomplete", "*INSTANCE", needed="two points and an angle")
    if not shift.any() and not turn:
        return Scope(prefix)
    return Scope(prefix, _move(shift, turn))


def _move(shift: np.ndarray, turn: list[float]) -> Callable[[np.ndarray], np.ndarray]:
    def moved(point: np.ndarray) -> np.ndarray:
        """First shifted, then rotated."""
        point = point + shift
        return rotated(point, np.array(turn[:3]), np.array(turn[3:6]), turn[6]) if turn else point

    return moved
