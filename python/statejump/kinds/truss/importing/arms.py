# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid bodies whose nodes rotate freely about some axes, or follow their master in some directions only.

Each of their nodes becomes an arm, a hinge, or equations of displacements:

- at the position of the master: a hinge if it rotates freely about one axis, two in a row if about two, else equations
- beside the master: an arm; if it rotates freely about one or two axes, an arm to a further node, and hinges there
"""
from __future__ import annotations

from collections.abc import Callable

import numpy as np

from statejump.kinds.truss.importing.model import Arm, Deck, Equation, Hinge, RigidBody, carriers
from statejump.kinds.truss.importing.supports import held_directions


class LooseArms:
    """Makes arms, hinges and equations of bodies that do not hold all components of their nodes."""

    def __init__(self, deck: Deck, near: Callable[[str, str], bool]) -> None:
        self.deck, self.near = deck, near
        self.rotating, self.ends = deck.bent(), carriers(deck)
        self.ends |= {node for one in deck.equations for node in one.nodes()}
        self.ends |= {node for one in deck.followers for node in one.nodes()}
        self.ends |= {body.nodes[0] for body in deck.rigid}
        self.master = {arm.node: arm.master for arm in deck.arms}

    def take(self, body: RigidBody) -> None:
        """Take a body whose nodes may have been merged."""
        deck, master = self.deck, body.nodes[0]
        for node in dict.fromkeys(body.nodes[1:]):
            if node == master:
                continue
            if not (node in self.ends or deck.mass.get(node) or any(deck.force.get(node, ())) or
                    len(held_directions(deck, node))):
                deck.leave(body.card, f"node {node}: nothing acts on it", body.line)
                continue
            free = body.free if node in self.rotating else tuple(np.eye(3))
            if not self.near(master, node):
                self._beside(body, master, node, free)
            elif len(free) == 3 or master not in self.rotating:
                self._equal(body, master, node)
            elif body.directions != "xyz":
                deck.refuse(body.card, "partial_coupling", body.line)
            else:
                self._hinges(master, node, free)
            deck.take(body.card, "rigid body, hinge or equal displacements")

    def _beside(self, body: RigidBody, master: str, node: str, free: tuple[np.ndarray, ...]) -> None:
        """Add an arm between nodes at different positions."""
        deck = self.deck
        carried = node in self.master or self._on(master, node)  # by another arm, or in a ring
        if not free or len(free) == 3:
            if carried and not free:
                deck.refuse(body.card, "partial_coupling", body.line)
                return
            end = self._further(node) if carried else node
            self._arm(Arm(body.card, master, end, body.directions, not free))
            if carried:
                self._equal(body, end, node)
        elif body.directions != "xyz":
            deck.refuse(body.card, "partial_coupling", body.line)
        else:
            end = self._further(node)
            self._arm(Arm(body.card, master, end))
            self._hinges(end, node, free)

    def _arm(self, arm: Arm) -> None:
        self.deck.arms.append(arm)
        self.master[arm.node] = arm.master
        self.rotating |= {arm.master} | ({arm.node} if arm.rotations else set())

    def _on(self, node: str, master: str) -> bool:
        """Return whether arms connect a node to a master."""
        while node in self.master and node != master:
            node = self.master[node]
        return node == master

    def _further(self, node: str) -> str:
        """Add a node at the position of another one."""
        name = self.deck.new_name(node)
        self.deck.add_node(0, name, self.deck.nodes[node])
        return name

    def _equal(self, body: RigidBody, master: str, node: str) -> None:
        """Make displacements of two nodes equal."""
        for direction in body.directions:
            axis = np.eye(3)["xyz".index(direction)]
            self.deck.equations.append(Equation(body.line, body.card, [(node, axis, 1.0), (master, axis, -1.0)]))

    def _hinges(self, first: str, last: str, free: tuple[np.ndarray, ...]) -> None:
        """Connect two nodes at one position by one hinge for each free axis, in a row."""
        nodes = [first, *(self._further(last) for _ in free[1:]), last]
        for start, end, axis in zip(nodes, nodes[1:], free):
            self.deck.hinges.append(Hinge(f"H{len(self.deck.hinges) + 1}", (start, end), axis))
            self.rotating |= {start, end}
