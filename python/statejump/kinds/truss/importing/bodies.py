# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid bodies and equations between displacements.

A rigid body at which bars and springs end at only one position becomes one node, which gets the forces and masses of
the body's other nodes. Other rigid bodies become rigid arms, see ``arms.py``. An equation that
holds a node becomes a support. If equations make all displacements of two nodes at one position equal, they become one
node. If an equation determines the motion of a node without bars, the loads of that node move to the other nodes. All
other equations become constraints of the case. Nodes that follow others become means, see ``followers.py``.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from statejump.kinds.truss.importing.arms import LooseArms
from statejump.kinds.truss.importing.followers import drop_idle, hold_references, take_followers
from statejump.kinds.truss.importing.model import Arm, Deck, Equation, Moment, RigidBody, carriers
from statejump.kinds.truss.importing.supports import (
    ALONG, SAME, basis_of, held_directions, is_held, is_rotation_held,
)

# Nodes nearer than this fraction of the truss size coincide, because decks have eight digits.
ONE_PLACE = 1e-9


def settle_bodies(deck: Deck) -> None:
    """Process moments, rigid bodies and equations, after supports, loads, bars and springs are read."""
    drop_idle(deck)
    turning = Turning(deck)
    bodies = _Bodies(deck, turning)
    for moment in deck.moments:
        turning.take(moment)
    if not (deck.rigid or deck.followers or deck.equations):
        return
    bodies.take()
    take_followers(deck)
    _follow_joined(deck, bodies.one)
    _take_equations(deck, bodies.near)
    _hold_loose(deck)
    hold_references(deck)


def named_nodes(deck: Deck) -> set[str]:
    """Return the nodes that bars, springs or equations name."""
    return carriers(deck) | {node for equation in deck.equations for node in equation.nodes()}


class _Bodies:
    """Processes the rigid bodies of a deck. Complete rigid bodies that share nodes are merged. A body becomes one node
    if bars end at one position of it only, else rigid arms."""

    def __init__(self, deck: Deck, turning: Turning) -> None:
        self.deck, self.turning = deck, turning
        self.places, self.bent = dict(deck.nodes), deck.bent()
        self.size = float(np.ptp(np.array(list(deck.nodes.values())), axis=0).max()) if deck.nodes else 0.0
        self.one: dict[str, str] = {}  # nodes that were merged into another one
        # Where no beam bends, rotations of the nodes of a body do not act.
        self.partial = [body for body in deck.rigid if self.bent and (body.pinned or body.directions != "xyz")]
        self.bodies = self._united([body for body in deck.rigid if not any(body is one for one in self.partial)])
        self.followers = {node for body in self.partial for node in body.nodes[1:]}
        self.tied = self.followers | {body.nodes[0] for body in self.partial}
        self.tied |= {node for one in deck.equations for node in one.nodes()}
        self.tied |= {node for one in deck.followers for node in one.nodes()}
        self.ends = carriers(deck)
        self.turned = [body for body in self.bodies if self._turns(body)]
        for body in self.turned:
            turning.bent |= set(body.nodes)

    def near(self, first: str, second: str) -> bool:
        """Whether two nodes are at one place."""
        start, end = (self.places.get(node) or self.deck.nodes[node] for node in (first, second))
        way = np.subtract(end, start)
        return bool(np.linalg.norm(way) <= ONE_PLACE * self.size)

    def take(self) -> None:
        """Take all bodies."""
        for body in self.bodies:
            if any(body is one for one in self.turned):
                self._merge(body)
            else:
                self._take(body)
        join(self.deck, self.one)
        self.ends = carriers(self.deck)
        for body in self.turned:
            self._make_arms(body)
        arms = LooseArms(self.deck, self.near)
        for body in self.partial:
            body.nodes[:] = [self.one.get(node, node) for node in body.nodes]
            arms.take(body)

    def _united(self, bodies: Sequence[RigidBody]) -> list[RigidBody]:
        joined: dict[str, RigidBody] = {}
        for body in bodies:
            whole = RigidBody(body.line, body.card, [])
            for node in body.nodes:
                whole.nodes += joined[node].nodes if node in joined else [node]
            whole.nodes = list(dict.fromkeys(whole.nodes))
            joined.update({node: whole for node in whole.nodes})
        return list({id(body): body for body in joined.values()}.values())

    def _turns(self, body: RigidBody) -> bool:
        """Return whether the rotation of a body acts: something ends at several positions of it."""
        rotates = bool(set(body.nodes) & (self.bent | self.tied))
        acting = [node for node in body.nodes
                  if node in self.ends or rotates and self.bent and (node in self.tied or _acts(self.deck, node))]
        return any(not self.near(acting[0], node) for node in acting)

    def _merge(self, body: RigidBody) -> None:
        """Merge the nodes of a body that are at one position."""
        deck, kept = self.deck, list[str]()
        for node in sorted(body.nodes, key=self._rank):
            same = next((one for one in kept if self.near(one, node)), None)
            if same is None:
                kept.append(node)
            elif {node, same} <= self.ends and any(
                    of.get(same) != of.get(node) for of in (deck.temperature, deck.initial)):
                deck.refuse(body.card, "unequal_temperatures", body.line)
            else:
                self.one[node] = same
        body.nodes[:] = kept

    def _rank(self, node: str) -> int:
        """Return the rank of a node as master of its body: partial bodies and supports constrain masters best."""
        orders = (node in self.followers, len(held_directions(self.deck, node)) > 0, node in self.bent,
                  node in self.ends, True)
        return orders.index(True)

    def _make_arms(self, body: RigidBody) -> None:
        """Connect the nodes of a body by arms. Nodes on which only loads act pass these to the master."""
        deck, master = self.deck, body.nodes[0]
        clamped = _clamped(deck, master)
        for node in body.nodes[1:]:
            if clamped and all(is_held(deck, node, axis) for axis in np.eye(3)):
                for axis in np.eye(3):
                    deck.hold_rotation(node, axis)
            elif node in self.ends or node in self.tied or _acts(deck, node):
                deck.arms.append(Arm(body.card, master, node))
            else:
                self._move_by_lever(body, master, node)
        deck.take(body.card, "rigid body")

    def _take(self, body: RigidBody) -> None:
        deck = self.deck
        borne = [node for node in body.nodes if node in self.ends or self.bent and node in self.tied]
        if not borne:
            deck.leave(body.card, "no bar ends at its nodes", body.line)
            return
        kept = borne[0]
        others = [node for node in body.nodes if node != kept]
        far = [node for node in others if not self.near(kept, node)]
        if any(len(held_directions(deck, node)) for node in far):
            deck.refuse(body.card, "support_off_bar_ends", body.line)
        elif any(of.get(kept) != of.get(node) for node in borne for of in (deck.temperature, deck.initial)):
            deck.refuse(body.card, "unequal_temperatures", body.line)
        else:
            for node in far:
                self._move_by_lever(body, kept, node)
            self.one.update({node: kept for node in others if node not in far})
            deck.take(body.card, "nodes at one place made one; forces and masses of its other nodes act there")

    def _move_by_lever(self, body: RigidBody, kept: str, gone: str) -> None:
        """Move a node's force and mass to the position of the rigid body at which bars end. A force on a lever arm
        causes a moment on the body; under gravity, so does a mass."""
        deck = self.deck
        lever = np.subtract(self.places[gone], self.places[kept])
        for weight, lines, force in (
                (False, deck.force_line, np.array(deck.force.get(gone, [0.0] * 3))),
                (True, deck.mass_line, deck.mass.get(gone, 0.0) * np.array(deck.gravity))):
            moment = np.cross(lever, force)
            if np.linalg.norm(moment) > ALONG * np.linalg.norm(lever) * np.linalg.norm(force):
                line, card = lines.get(gone, (body.line, body.card))
                self.turning.take(Moment(line, card, kept, moment, f"{card.lstrip('*')}.LEVER", weight))
        _move(deck, kept, gone)
        del deck.nodes[gone]
        deck.leave(f"node {gone}", f"a rigid arm of node {kept}", 0)


def join(deck: Deck, one: Mapping[str, str]) -> None:
    """Merge nodes that are at one position.

    :param one: name of the remaining node, by the name of each removed node
    """
    for bar in deck.bars:
        first, second = (one.get(end, end) for end in bar.nodes)
        bar.nodes = (first, second)
    springs = []
    for spring in deck.springs:
        second_end = None if spring.second is None else one.get(spring.second, spring.second)
        spring = replace(spring, first=one.get(spring.first, spring.first), second=second_end)
        if spring.first == spring.second:
            deck.leave(spring.kind, "its two nodes are one", spring.line)
        else:
            springs.append(spring)
    deck.springs[:] = springs
    for arm in deck.arms:
        arm.master, arm.node = one.get(arm.master, arm.master), one.get(arm.node, arm.node)
    for hinge in deck.hinges:
        hinge.nodes = (one.get(hinge.nodes[0], hinge.nodes[0]), one.get(hinge.nodes[1], hinge.nodes[1]))
    for follower in deck.followers:
        follower.follow(one)
    for mean in deck.means:
        mean.node = one.get(mean.node, mean.node)
        weights: dict[str, float] = {}
        for node, weight in mean.weights.items():
            weights[one.get(node, node)] = weights.get(one.get(node, node), 0.0) + weight
        mean.weights = weights
    for gone, kept in one.items():
        deck.fix(kept, "".join(deck.fixed.pop(gone, ())))
        for direction in deck.held.pop(gone, ()):
            deck.hold(kept, direction)
        for axis in deck.held_rotations.pop(gone, ()):
            deck.hold_rotation(kept, axis)
        _move(deck, kept, gone)
        del deck.nodes[gone]
        deck.leave(f"node {gone}", f"it is one with node {kept}", 0)


def _move(deck: Deck, kept: str, gone: str) -> None:
    """Move force, moment and mass from one node to another."""
    for weight, of in enumerate((deck.moment, deck.weight_moment)):
        if (moment := of.pop(gone, None)) is not None:
            deck.turn(kept, moment, bool(weight))
    if force := deck.force.pop(gone, None):
        deck.load(kept, force, *deck.force_line.pop(gone, (0, "force")))
    if mass := deck.mass.pop(gone, None):
        deck.weigh(kept, mass, *deck.mass_line.pop(gone, (0, "mass")))


def _acts(deck: Deck, node: str) -> bool:
    """Return whether a node of a body has a mass or a support."""
    return bool(deck.mass.get(node) or len(held_directions(deck, node)) or deck.held_rotations.get(node))


def _clamped(deck: Deck, node: str) -> bool:
    """Return whether supports hold all displacements and rotations of a node."""
    held = np.array(deck.held_rotations.get(node, [])).reshape(-1, 3)
    return all(is_held(deck, node, axis) for axis in np.eye(3)) and len(basis_of(held)) == 3


def _follow_joined(deck: Deck, joined: Mapping[str, str]) -> None:
    """Rewrite equations after nodes were merged. Refuse an equation with a node that a rigid arm replaced."""
    kept = []
    for one in deck.equations:
        one.follow(joined)
        if all(node in deck.nodes for node in one.nodes()):
            kept.append(one)
        else:
            deck.refuse(one.card, "node_on_rigid_arm", one.line, one.card.lstrip("*"))
    deck.equations[:] = kept


def _take_equations(deck: Deck, near: Callable[[str, str], bool]) -> None:
    """Process equations until none can be processed any more; the remaining equations become constraints."""
    bent = deck.bent()
    waiting = [replace(one, terms=[term for term in one.terms if not is_held(deck, *term[:2])],
                       turns=[term for term in one.turns if not is_rotation_held(deck, *term[:2])])
               for one in deck.equations if _rotates(deck, one, bent)]
    taken: list[Equation] | None = waiting
    while waiting and taken:
        taken = _held_by(deck, waiting) or _made_one(deck, waiting, near) or _followed(deck, waiting)
        for one in taken or ():
            deck.take(one.card, "held, joined or loaded nodes")
        gone = {id(one) for one in taken or ()}
        waiting = [one for one in waiting if id(one) not in gone]
    for one in waiting:
        deck.take(one.card, "constraint")
    deck.equations[:] = waiting


def _rotates(deck: Deck, one: Equation, bent: set[str]) -> bool:
    """Return whether something rotates the nodes of all rotations of an equation. Otherwise the equation is left out,
    if it contains nothing else, or refused."""
    loose = [node for node, _, _ in one.turns if node not in bent]
    if loose and len(loose) == len(one.nodes()):
        deck.leave(one.card, "an equation of rotations: ends of bars turn freely", one.line)
    elif loose:
        deck.refuse(one.card, "rotation", one.line, one.card.lstrip("*"))
    return not loose


def _hold_loose(deck: Deck) -> None:
    """Hold nodes without bars in the directions in which no equation moves them, because stiffness is missing there."""
    ends = carriers(deck)
    for node, ways in deck.equation_directions().items():
        if node in ends:
            continue
        basis = basis_of(np.array(ways))
        rest = np.eye(3) - basis.T @ basis
        force = np.array(deck.force.get(node, [0.0] * 3))
        if np.linalg.norm(rest @ force) > SAME * np.linalg.norm(force):
            line, card = deck.force_line.get(node, (0, "force"))
            deck.refuse(card, "force_without_stiffness", line, f"{card.lstrip('*')}.UNUSED", node=node)
        for direction in basis_of(rest):
            if not is_held(deck, node, direction):
                deck.hold(node, [float(part) for part in direction])


def _held_by(deck: Deck, equations: list[Equation]) -> list[Equation]:
    """Convert equations that contain only one node to supports of this node, and drop equations without nodes."""
    found = [one for one in equations if len(set(one.nodes())) < 2 and not (one.terms and one.turns)]
    for one in found:
        if one.turns:
            axis = sum((direction * factor for _, direction, factor in one.turns), start=np.zeros(3))
            deck.hold_rotation(one.turns[0][0], axis / np.linalg.norm(axis))
        normal = sum((direction * factor for _, direction, factor in one.terms), start=np.zeros(3))
        if np.any(normal):
            deck.hold(one.terms[0][0], [float(part) for part in normal / np.linalg.norm(normal)])
    return found


def _equal(one: Equation) -> tuple[str, str] | None:
    """Return the two nodes of an equation that makes their displacements in one direction equal."""
    if len(one.terms) != 2 or one.turns:
        return None
    (first, along, factor), (second, other, opposite) = one.terms
    if first == second or np.linalg.norm(along * factor + other * opposite) > SAME * abs(factor):
        return None
    return first, second


def _made_one(deck: Deck, equations: list[Equation], near: Callable[[str, str], bool]) -> list[Equation]:
    """Merge pairs of nodes if equations make their displacements equal in all directions that are not held."""
    pairs: dict[tuple[str, str], list[Equation]] = {}
    for one in equations:
        if pair := _equal(one):
            pairs.setdefault((min(pair), max(pair)), []).append(one)
    ends, bent, found = carriers(deck), deck.bent(), []
    armed = {end for arm in deck.arms for end in (arm.master, arm.node)}
    joined: dict[str, str] = {}
    stays: set[str] = set()
    for pair, several in pairs.items():
        kept, gone = pair if pair[0] in ends else pair[::-1]
        # A node removed here must be in no other pair of this round, because remaining nodes are removed only later.
        # Ends of two beams keep their own rotations.
        if kept not in ends or {kept, gone} <= bent or not near(kept, gone) or joined.keys() & {kept, gone} or \
                gone in stays | armed or any(of.get(kept) != of.get(gone) for of in (deck.temperature, deck.initial)):
            continue
        rows = [one.terms[0][1] for one in several]
        rows += [axis for axis in np.eye(3) if is_held(deck, kept, axis) and is_held(deck, gone, axis)]
        if np.linalg.matrix_rank(np.array(rows), tol=SAME) == 3:
            joined[gone] = kept
            stays.add(kept)
            found += several
    join(deck, joined)
    for one in equations:
        one.follow(joined)
    return found


def _followed(deck: Deck, equations: list[Equation]) -> list[Equation]:
    """Move the loads of nodes without bars to the nodes that determine their motion by equations."""
    ends = carriers(deck)
    of_node: dict[str, list[Equation]] = {}
    for one in equations:
        for node in dict.fromkeys(one.nodes()):
            of_node.setdefault(node, []).append(one)
    found: list[Equation] = []
    used: set[int] = set()
    for node, several in of_node.items():
        own = [[term for term in one.terms if term[0] == node] for one in several]
        if node in ends or len(held_directions(deck, node)) or deck.mass.get(node) or \
                any(len(terms) != 1 for terms in own) or any(one.turns or id(one) in used for one in several):
            continue
        rows = np.array([terms[0][1] for terms in own])
        force = np.array(deck.force.get(node, [0.0] * 3))
        rest = force - rows.T @ (rows @ force)
        if np.linalg.norm(rows @ rows.T - np.eye(len(rows))) > SAME or \
                np.linalg.norm(rest) > SAME * np.linalg.norm(force):
            continue
        line, card = deck.force_line.get(node, (several[0].line, several[0].card))
        for one, (mine,) in zip(several, own):
            for other, direction, factor in one.terms:
                if other != node:
                    share = -factor / mine[2] * float(force @ mine[1])
                    deck.load(other, [float(part) for part in share * direction], line, card)
        deck.force.pop(node, None)
        del deck.nodes[node]
        deck.leave(f"node {node}", "an equation gives its motion", 0)
        found += several
        used.update(id(one) for one in several)
    return found


class Turning:
    """The beams that rotate with a node, also through rigid bodies."""

    def __init__(self, deck: Deck) -> None:
        self.deck = deck
        self.beams: dict[str, list[str]] = {}
        self.bodies: dict[str, list[list[str]]] = {}
        self.bent = deck.bent()
        for first, second in (bar.nodes for bar in deck.bars if bar.bends and not bar.bending):
            self.beams.setdefault(first, []).append(second)
            self.beams.setdefault(second, []).append(first)
        for body in deck.rigid:
            for node in body.nodes:
                self.bodies.setdefault(node, []).append(body.nodes)
        self.places = dict(deck.nodes)

    def bends(self, node: str, moment: np.ndarray) -> bool:
        """Return whether a moment on a node bends a beam.

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

    def take(self, given: Moment) -> None:
        """Take a moment on a beam, also through a rigid body. Omit a moment that moves no node; refuse a moment on a
        beam that becomes a bar, if it bends this beam."""
        line, card, node, moment = given.line, given.card, given.node, given.vector
        if not np.any(moment):
            self.deck.leave(card, "it is 0", line)
        elif {node, *(one for body in self.bodies.get(node, ()) for one in body)} & self.bent:
            self.deck.turn(node, moment, given.weight)
            self.deck.take(card, "moment")
        elif self.bends(node, moment):
            self.deck.refuse(card, "bending_moment", line, given.waiver)
        else:
            self.deck.leave(card, "a moment that only twists bars moves no node", line)
