# SPDX-License-Identifier: GPL-3.0-or-later
"""Random frictional contact problems of piles of rigid bodies, as in granular and masonry mechanics.

With W = H M^-1 H^T and q = H v, the contact velocity u = 0 is possible, so a solution exists (Acary and Cadoux 2013).
If contacts outnumber the degrees of freedom, W is rank-deficient.
"""
from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np
from numpy.typing import NDArray

from statejump.fclib import Problem

Array = NDArray[np.float64]
Random = np.random.Generator
GROUND = -1


class Pile:
    """Rigid bodies and the contacts between them, in the plane (axes x and z) or in space.

    :param dimension: 2 or 3
    """

    def __init__(self, dimension: int) -> None:
        self.dimension = dimension
        self.centres: list[Array] = []
        self.masses: list[Array] = []  # one for each degree of freedom
        self.contacts: list[tuple[int, int, Array, Array]] = []

    def body(self, centre: Array, mass: float, inertias: Array) -> int:
        """Add a body and return its number."""
        self.centres.append(centre)
        self.masses.append(np.concatenate([np.full(self.dimension, mass), inertias]))
        return len(self.centres) - 1

    def contact(self, below: int, above: int, point: Array, normal: Array) -> None:
        """Add a contact; the normal points from ``below`` to ``above``."""
        self.contacts.append((below, above, point, normal))

    def rows(self) -> Array:
        """Return the matrix H, which maps velocities of bodies to relative velocities at contacts."""
        freedoms = 3 if self.dimension == 2 else 6
        h = np.zeros((self.dimension * len(self.contacts), freedoms * len(self.centres)))
        for k, (below, above, point, normal) in enumerate(self.contacts):
            frame = _frame(normal)
            for body, sign in ((below, -1.0), (above, 1.0)):
                if body == GROUND:
                    continue
                arm = point - self.centres[body]
                if self.dimension == 2:
                    motion = np.column_stack([np.eye(2), [-arm[1], arm[0]]])
                else:
                    x, y, z = arm
                    motion = np.column_stack([np.eye(3), [[0, z, -y], [-z, 0, x], [y, -x, 0]]])
                h[self.dimension * k: self.dimension * (k + 1), freedoms * body: freedoms * (body + 1)] = \
                    sign * frame @ motion
        return h

    def problem(self, random: Random, kick: float) -> tuple[Problem, int]:
        """Return the contact problem of a step under gravity, and its degrees of freedom. Velocities before the step
        are random with the size ``kick``."""
        h = self.rows()
        masses = np.concatenate(self.masses)
        velocity = kick * random.normal(size=masses.size)
        freedoms = masses.size // len(self.centres)
        velocity[self.dimension - 1:: freedoms] -= 1.0
        problem = Problem((h / masses) @ h.T, h @ velocity, friction(random, len(self.contacts)), self.dimension)
        return problem, masses.size


def _frame(normal: Array) -> Array:
    normal = normal / np.linalg.norm(normal)
    if normal.size == 2:
        return np.array([normal, [-normal[1], normal[0]]])
    side = np.eye(3)[np.argmin(np.abs(normal))]
    first = np.cross(normal, side)
    first /= np.linalg.norm(first)
    return np.array([normal, first, np.cross(normal, first)])


def friction(random: Random, contacts: int) -> Array:
    """Return friction coefficients up to 1: equal everywhere, different at each contact, or zero."""
    kind = random.random()
    if kind < 0.1:
        return np.zeros(contacts)
    if kind < 0.4:
        return random.uniform(0.0, 1.0, contacts)
    return np.full(contacts, random.uniform(0.0, 1.0))


def random_bodies(dimension: int, contacts: int, random: Random) -> tuple[Problem, int]:
    """Return a problem of bodies with random masses that touch each other or the ground at random points."""
    pile = Pile(dimension)
    freedoms = 3 if dimension == 2 else 6
    bodies = max(1, round(random.uniform(0.3, 1.5) * contacts * dimension / freedoms))
    for _ in range(bodies):
        mass = 10 ** random.uniform(-1.0, 1.0)
        pile.body(random.normal(size=dimension), mass, mass * random.uniform(0.05, 0.4, freedoms - dimension))
    for _ in range(contacts):
        above = int(random.integers(bodies))
        below = int(random.integers(-1, bodies))
        pile.contact(GROUND if below == above else below, above, random.normal(size=dimension),
                     random.normal(size=dimension))
    return pile.problem(random, 1.0)


def random_rows(dimension: int, contacts: int, random: Random) -> tuple[Problem, int]:
    """Return a problem whose matrix H has independent random entries, so that every contact affects every other."""
    size = contacts * dimension
    h = random.normal(size=(size, max(1, round(random.uniform(0.2, 1.5) * size))))
    problem = Problem(h @ h.T, h @ random.normal(size=h.shape[1]), friction(random, contacts), dimension)
    return problem, h.shape[1]


def spheres(dimension: int, contacts: int, random: Random) -> tuple[Problem, int]:
    """Return a problem of equal balls in a close packing on the ground."""
    pile = Pile(dimension)
    # About three contacts per ball in the plane, six in space.
    side = max(1, round((contacts / (2.5 if dimension == 2 else 4.5)) ** (1.0 / dimension)))
    places = {}
    for cell in product(range(side), repeat=dimension):
        if dimension == 2:
            centre = np.array([cell[0] + 0.5 * cell[1], 0.75 ** 0.5 * cell[1] + 0.5])
        else:
            centre = np.array([cell[0] + 0.5 * cell[1] + 0.5 * cell[2],
                               0.75 ** 0.5 * cell[1] + 0.75 ** 0.5 / 3 * cell[2], (2 / 3) ** 0.5 * cell[2] + 0.5])
        mass = random.uniform(0.5, 2.0)
        places[cell] = pile.body(centre, mass, np.full(1 if dimension == 2 else 3, 0.1 * mass))
        if cell[-1] == 0:
            pile.contact(GROUND, places[cell], centre - 0.5 * np.eye(dimension)[-1], np.eye(dimension)[-1])
    bodies = list(places.values())
    for i, below in enumerate(bodies):
        for above in bodies[i + 1:]:
            normal = pile.centres[above] - pile.centres[below]
            if np.linalg.norm(normal) < 1.001 and len(pile.contacts) < contacts:
                pile.contact(below, above, pile.centres[below] + 0.5 * normal, normal)
    return pile.problem(random, random.choice([0.0, 0.1, 1.0]))


def _face(pile: Pile, below: int, above: int, low: Array, high: Array, height: float) -> None:
    """Add contacts at the corners of a horizontal rectangle (in space) or at the ends of a line (in the plane)."""
    for corner in product(*zip(low, high)):
        pile.contact(below, above, np.array([*corner, height]), np.eye(pile.dimension)[-1])


def bricks(dimension: int, contacts: int, random: Random) -> tuple[Problem, int]:
    """Return a problem of a brick wall in bond. Each face has four contacts, so contact forces are not unique."""
    pile = Pile(dimension)
    per_face = 2 if dimension == 2 else 4
    courses = max(1, round((contacts / per_face / 2.0) ** 0.5))
    rows: list[list[tuple[int, float]]] = []
    for course in range(courses):
        row = []
        for k in range(max(1, contacts // (2 * per_face * courses)) + course % 2):
            left = k - 0.5 * (course % 2)
            depth = [0.0] * (dimension - 2)
            mass = random.uniform(0.5, 2.0)
            row.append((pile.body(np.array([left + 0.5, *depth, course + 0.5]), mass,
                                  np.full(1 if dimension == 2 else 3, mass / 6.0)), left))
        for body, left in row:
            for under, other in (rows[-1] if rows else [(GROUND, left)]):
                low, high = max(left, other), min(left, other) + 1.0
                if high - low > 0.1 and len(pile.contacts) + per_face <= max(contacts, per_face):
                    _face(pile, under, body, np.array([low, -0.3][:dimension - 1]),
                          np.array([high, 0.3][:dimension - 1]), float(course))
        rows.append(row)
    return pile.problem(random, random.choice([0.0, 0.1, 1.0]))


def tower(dimension: int, contacts: int, random: Random) -> tuple[Problem, int]:
    """Return a problem of a tower: in space crosswise planks, two per level; in the plane a column of blocks."""
    pile = Pile(dimension)
    if dimension == 2:
        below = GROUND
        for level in range(max(1, contacts // 2)):
            body = pile.body(np.array([0.0, level + 0.5]), 1.0, np.array([1.0 / 6.0]))
            _face(pile, below, body, np.array([-0.5]), np.array([0.5]), float(level))
            below = body
        return pile.problem(random, random.choice([0.0, 0.1, 1.0]))
    before = [GROUND]
    for level in range(max(1, contacts // 16)):
        planks = []
        for side in (-1.0, 1.0):
            along = level % 2
            centre = np.array([0.0, 0.0, 0.2 * level + 0.1])
            centre[1 - along] = side
            planks.append(pile.body(centre, 1.0, np.array([0.5, 0.5, 0.9])))
            for under in before:
                middle = centre[:2].copy()
                if under != GROUND:
                    middle[along] = pile.centres[under][along]
                _face(pile, under, planks[-1], middle - 0.2, middle + 0.2, 0.2 * level)
        before = planks
    return pile.problem(random, random.choice([0.0, 0.1, 1.0]))


def chain(dimension: int, contacts: int, random: Random) -> tuple[Problem, int]:
    """Return a problem of a row of balls, pressed between two walls and hit in the middle."""
    pile = Pile(dimension)
    axis = np.eye(dimension)[0]
    below = GROUND
    for k in range(max(1, contacts - 1)):
        body = pile.body(k * axis, random.uniform(0.5, 2.0), np.full(1 if dimension == 2 else 3, 0.1))
        pile.contact(below, body, (k - 0.5) * axis, axis)
        below = body
    pile.contact(below, GROUND, (len(pile.centres) - 0.5) * axis, axis)
    return pile.problem(random, 1.0)


FAMILIES: dict[str, Callable[[int, int, Random], tuple[Problem, int]]] = {
    "random rows": random_rows, "random bodies": random_bodies, "balls": spheres, "bricks": bricks, "tower": tower,
    "chain": chain,
}
