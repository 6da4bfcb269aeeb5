# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments on nodes. Nodes of a truss do not rotate, so a moment matters only if it would bend a beam."""
from __future__ import annotations

import numpy as np

from statejump.kinds.truss.importing.model import Deck
from statejump.kinds.truss.importing.springs import ALONG


class Turning:
    """The beams that rotate with a node, also through rigid bodies."""

    def __init__(self, deck: Deck) -> None:
        self.deck = deck
        self.beams: dict[str, list[str]] = {}
        self.bodies: dict[str, list[list[str]]] = {}
        for first, second in (bar.nodes for bar in deck.bars if bar.bends):
            self.beams.setdefault(first, []).append(second)
            self.beams.setdefault(second, []).append(first)
        for body in deck.rigid:
            for node in body.nodes:
                self.bodies.setdefault(node, []).append(body.nodes)
        self.places = dict(deck.nodes)

    def bends(self, node: str, moment: np.ndarray) -> bool:
        """Return whether a moment bends a beam.

        Rods carry only moments about their own axis, and torsion of straight bars does not move their ends. In beams a
        moment causes torsion only if all beams at the node are parallel to it.
        """
        reached, waiting = {node}, [node]
        while waiting:
            here = waiting.pop()
            turned = self.beams.get(here, [])
            for other in turned:
                way = np.subtract(self.places[other], self.places[here])
                if np.linalg.norm(np.cross(way, moment)) > ALONG * np.linalg.norm(way) * np.linalg.norm(moment):
                    return True
            fresh = {*turned, *(one for body in self.bodies.get(here, ()) for one in body)} - reached
            reached |= fresh
            waiting += fresh
        return False

    def take(self, line: int, card: str, node: str, moment: np.ndarray, waiver: str | None = None) -> None:
        """Omit a moment that moves no node; refuse one that bends a beam."""
        if not np.any(moment):
            self.deck.leave(card, "it is 0", line)
        elif self.bends(node, moment):
            self.deck.refuse(card, "bending_moment", line, waiver)
        else:
            self.deck.leave(card, "a moment that only twists bars moves no node", line)
