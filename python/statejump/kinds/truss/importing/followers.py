# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that follow the best fit to the motion of other nodes, as means or equations of a case.

The best fit is the rigid motion of the node that minimises the sum of weights times squared differences to the other
nodes, in the components in which these count. Weights of rotations are multiplied by the square of the mean distance of
the nodes. If all nodes count by their three displacements, the node becomes a mean; else its motion becomes equations.
"""
from __future__ import annotations

import numpy as np

from statejump.kinds.truss.importing.model import Deck, Equation, Follower, Mean
from statejump.kinds.truss.importing.supports import SAME, basis_of, held_directions, is_held
from statejump.kinds.truss.means import ALL


def drop_idle(deck: Deck) -> None:
    """Leave out nodes that follow others but on which nothing acts. Rigid bodies must not have been taken yet."""
    acting = {end for bar in deck.bars for end in bar.nodes} | {end for one in deck.hinges for end in one.nodes}
    acting |= {end for spring in deck.springs for end in (spring.first, spring.second) if end}
    acting |= {end for arm in deck.arms for end in (arm.master, arm.node)}
    acting |= {node for body in deck.rigid for node in body.nodes} | {moment.node for moment in deck.moments}
    acting |= {node for one in deck.equations for node in one.nodes()}
    acting |= {node for node, force in deck.force.items() if any(force)} | deck.moment.keys()
    acting |= {node for node, mass in deck.mass.items() if mass}
    acting |= {node for node in (*deck.fixed, *deck.held) if len(held_directions(deck, node))}
    waiting = list(deck.followers)
    kept: list[Follower] = []
    while taken := [one for one in waiting if one.node in acting]:
        kept += taken
        waiting = [one for one in waiting if one not in taken]
        acting |= {node for one in taken for node, _, _ in one.others}
    for one in waiting:
        deck.leave(one.card, "nothing acts on its node, which follows the others", one.line)
    deck.followers[:] = [one for one in deck.followers if one in kept]
    ends = {end for bar in deck.bars if bar.bending for end in bar.nodes}
    ends |= {end for arm in deck.arms for end in (arm.master, arm.node)}
    ends |= {node for hinge in deck.hinges for node in hinge.nodes}
    ends |= {node for body in deck.rigid for node in body.nodes} | deck.held_rotations.keys()
    ends |= {moment.node for moment in deck.moments} | {node for one in deck.equations for node, _, _ in one.turns}
    ends |= {node for one in kept for node, _, ways in one.others if ways[:, 3:].any()}
    for one in deck.followers:
        if one.node not in ends:  # nothing acts on its rotation
            one.follows = one.follows[~one.follows[:, 3:].any(axis=1)]


def take_followers(deck: Deck) -> None:
    """Convert nodes that follow others to means or equations. Rigid bodies must have been taken."""
    turned = {moment.node for moment in deck.moments}
    waiting, deck.followers[:] = list(deck.followers), []
    bent = deck.bent()
    for one in waiting:
        for name in one.unsupported:
            deck.refuse(f"{one.card}.{name}", "mean_expands", one.line)
        if not all(node in deck.nodes for node in one.nodes()):
            deck.refuse(one.card, "node_on_rigid_arm", one.line)
        elif one.node in turned and not one.turns() and one.node not in bent:
            deck.refuse(one.card, "load_distribution", one.line)
        elif not len(one.follows):
            deck.leave(one.card, "only rotations follow, which nothing uses", one.line)
        elif one.node in (node for node, _, _ in one.others):
            deck.refuse(one.card, "load_distribution", one.line)
        else:
            _take(deck, one, bent)


def _take(deck: Deck, one: Follower, bent: set[str]) -> None:
    size = mean_distance(deck, one)
    fit = _normal_matrix(deck, one, size)
    scaled = one.follows / np.array([1.0, 1.0, 1.0, size, size, size])
    inverse = np.linalg.pinv(fit, rcond=SAME**2, hermitian=True)
    beside = np.linalg.norm(scaled - scaled @ inverse @ fit, axis=1)
    if np.any(beside > SAME * np.linalg.norm(scaled, axis=1)):
        deck.refuse(one.card, "mean_undetermined", one.line)
        return
    directions = [direction for direction, row in zip(ALL, np.eye(6)) if np.any(np.abs(one.follows @ row) > 1 - SAME)]
    by_displacements = all(not ways[:, 3:].any() and len(basis_of(ways[:, :3])) == 3 for _, _, ways in one.others)
    if by_displacements and len(directions) == len(one.follows):
        weights: dict[str, float] = {}
        for node, weight, _ in one.others:
            weights[node] = weights.get(node, 0.0) + weight
        deck.means.append(Mean(one.node, weights, directions))
        deck.take(one.card, "mean")
        return
    turned = {one.node} if one.turns() else set()
    turned |= {node for node, _, ways in one.others if ways[:, 3:].any()}
    if loose := sorted(turned - bent):
        deck.refuse(one.card, "mean_of_rotations", one.line, node=loose[0])
        return
    deck.equations += [_equation(deck, one, row, inverse, size) for row in one.follows]


def mean_distance(deck: Deck, one: Follower) -> float:
    """Return the mean distance of the nodes of a follower; 1 if all are at one position."""
    ways = [np.subtract(deck.nodes[node], deck.nodes[one.node]) for node, _, _ in one.others]
    return float(np.mean([np.linalg.norm(way) for way in ways])) or 1.0


def _rates(deck: Deck, one: Follower, node: str, ways: np.ndarray, size: float) -> np.ndarray:
    """Return the motion along directions (m, 6) of a node, per motion of the follower: displacements, then rotations
    times a size. Rotations of the node count times the size too."""
    arm = np.subtract(deck.nodes[node], deck.nodes[one.node])
    return np.asarray(np.hstack((ways[:, :3], (np.cross(arm, ways[:, :3]) + size * ways[:, 3:]) / size)))


def _normal_matrix(deck: Deck, one: Follower, size: float) -> np.ndarray:
    """Return the matrix of the best fit, for displacements and rotations times a size (6, 6), with weights of sum 1."""
    whole = sum(weight for _, weight, _ in one.others)
    found = np.zeros((6, 6))
    for node, weight, ways in one.others:
        rates = _rates(deck, one, node, ways, size)
        found += weight / whole * rates.T @ rates
    return found


def _equation(deck: Deck, one: Follower, row: np.ndarray, inverse: np.ndarray, size: float) -> Equation:
    """Return the equation of one displacement or rotation of a follower."""
    made = Equation(one.line, one.card, [], [])
    whole = sum(weight for _, weight, _ in one.others)
    (made.turns if row[3:].any() else made.terms).append((one.node, row[3:] if row[3:].any() else row[:3], 1.0))
    back = inverse @ (row / np.array([1.0, 1.0, 1.0, size, size, size]))
    for node, weight, ways in one.others:
        factors = weight / whole * _rates(deck, one, node, ways, size) @ back
        turns = ways[:, 3:].any(axis=1)
        for terms, share in ((made.terms, factors[~turns] @ ways[~turns, :3]),
                             (made.turns, size * factors[turns] @ ways[turns, 3:])):
            if (length := float(np.linalg.norm(share))) > 0:
                terms.append((node, share / length, -length))
    return made


def hold_references(deck: Deck) -> None:
    """Hold nodes of means at which nothing ends in the directions that do not follow."""
    moved = deck.equation_directions()
    others = {end for bar in deck.bars for end in bar.nodes} | {
        end for spring in deck.springs for end in (spring.first, spring.second) if end}
    others |= {end for arm in deck.arms for end in (arm.master, arm.node)}
    others |= {end for hinge in deck.hinges for end in hinge.nodes}
    others |= {node for one in deck.means for node in one.weights}
    for one in deck.means:
        if one.node in others:
            continue
        ways = [axis for direction, axis in zip(ALL, np.eye(3)) if direction in one.directions]
        basis = basis_of(np.array([*ways, *moved.get(one.node, [])]).reshape(-1, 3))
        rest = np.eye(3) - basis.T @ basis
        force = np.array(deck.force.get(one.node, [0.0] * 3))
        if np.linalg.norm(rest @ force) > SAME * np.linalg.norm(force):
            line, card = deck.force_line.get(one.node, (0, "force"))
            deck.refuse(card, "force_without_stiffness", line, f"{card.lstrip('*')}.UNUSED", node=one.node)
        for direction in basis_of(rest):
            if not is_held(deck, one.node, direction):
                deck.hold(one.node, [float(part) for part in direction])
