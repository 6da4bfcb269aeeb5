# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of a deck and the directions of their dofs, whatever else the deck contains."""
from __future__ import annotations

from pathlib import Path

import numpy as np

from statejump.kinds.truss.importing.abaqus import STAGES, assembly
from statejump.kinds.truss.importing.abaqus.keywords import blocks
from statejump.kinds.truss.importing.abaqus.model import Model
from statejump.kinds.truss.importing.model import Deck

KEYWORDS = ("SYSTEM", "NODE", "NSET", "NGEN", "NFILL", "NCOPY", "TRANSFORM")
PARTS = ("PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE")


def read_nodes(path: Path) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], dict[str, list[str]]]:
    """Return positions by node, axes of the dofs (rows) of the nodes of ``*TRANSFORM``, and sets of nodes.

    :raises StatejumpError: one sentence with file and line
    """
    deck = Deck(path)
    model = Model(deck)
    taken = []
    for block in blocks(deck, path):
        if block.name in KEYWORDS or block.name in PARTS:
            if block.name == "NSET" and "ELSET" in block.parameters:
                continue
            taken.append(block)
    given = list(assembly.flat(model, taken))
    for stage in STAGES[:5]:
        for block, scope in given:
            if block.name in stage and block.name in KEYWORDS:
                stage[block.name](model, block, scope)
    deck.settle()
    positions = {name: np.array(place) for name, place in deck.nodes.items()}
    axes = {name: frame.directions(deck.nodes[name]) for name, frame in model.frames.items() if name in deck.nodes}
    return positions, axes, {name: list(nodes) for name, nodes in model.node_sets.items()}
