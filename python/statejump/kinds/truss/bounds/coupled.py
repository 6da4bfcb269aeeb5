# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear programs over the rest states of trusses with clearance revolutes.

Variables: d of each revolute along the middle of its sector and across it (n, t), f, λ of other joints, and both
products u = d_n q_t, v = d_t q_n. Rows: the sector, the range of q, the friction cone |f| <= sin φ |q|, the moment
|d| f = u − v, and McCormick's four inequalities of each product.
"""
from __future__ import annotations

import numpy as np

from statejump.kinds.truss.bounds.clearance import Clearances
from statejump.kinds.truss.bounds.programs import Polytope
from statejump.kinds.truss.bounds.sectors import Sectors, along, forces, narrowed

ROUNDS = 4  # of narrowing
GAIN = 0.02  # smallest reduction of widths that is worth a round
TANGENTS = 7
MOST_JOINTS = 60  # of programs for every joint; else one program per output


class Coupled:
    """The programs at given sectors."""

    def __init__(self, of: Clearances, at: Sectors) -> None:
        self.of, self.at = of, at
        self.seen = forces(of, at)
        count, others = of.count, len(of.limit_N)
        self.size = 5 * count + others
        middle = at.middle_rad
        normal = np.stack((np.cos(middle), np.sin(middle)), axis=1)
        self.frame = np.stack((normal, np.stack((-normal[:, 1], normal[:, 0]), axis=1)), axis=1)  # (m, 2, 2)
        # x as in Clearances by the variables without products.
        self.turn = np.eye(3 * count + others)
        for joint in range(count):
            two = slice(2 * joint, 2 * joint + 2)
            self.turn[two, two] = self.frame[joint].T
        blocks = of.force_by_state.reshape(count, 2, -1)
        centre = of.force_N - (of.force_by_state @ of.start).reshape(-1, 2)
        self.force_rows = np.einsum("mij,mjk->mik", self.frame, blocks) @ self.turn
        self.force_centre = np.einsum("mij,mj->mi", self.frame, centre)
        # Ranges of the components n and t of q.
        quarter = middle[:, None] + np.pi / 2 * np.arange(4)
        most = along(of, at, quarter)
        self.most_N, self.least_N = most[:, :2].copy(), -most[:, 2:].copy()
        self._box()
        self.rows: list[np.ndarray] = []
        self.least: list[float] = []
        self.most: list[float] = []
        for joint in range(count):
            self._sector(joint)
            self._force(joint)
            self._moment(joint)
        self.polytope = self._scaled()

    def _box(self) -> None:
        at, count = self.at, self.of.count
        across = at.outer_m * np.where(at.half_rad < np.pi / 2, np.sin(np.minimum(at.half_rad, np.pi / 2)), 1.0)
        cosine = np.cos(np.minimum(at.half_rad, np.pi))
        least = np.where(cosine > 0, at.inner_m, at.outer_m) * cosine
        self.shift_least = np.stack((least, -across), axis=1)
        self.shift_most = np.stack((at.outer_m, across), axis=1)
        product = np.stack([np.array([shift[:, axis] * force[:, 1 - axis]
                                      for shift in (self.shift_least, self.shift_most)
                                      for force in (self.least_N, self.most_N)]) for axis in range(2)])
        self.floor = np.concatenate((self.shift_least.ravel(), -at.friction_N, -self.of.limit_N,
                                     product.min(axis=1).T.ravel()))
        self.ceiling = np.concatenate((self.shift_most.ravel(), at.friction_N, self.of.limit_N,
                                       product.max(axis=1).T.ravel()))
        self.products = 3 * count + len(self.of.limit_N)

    def _add(self, row: np.ndarray, least: float, most: float) -> None:
        self.rows.append(row)
        self.least.append(least)
        self.most.append(most)

    def _unit(self, column: int, value: float = 1.0) -> np.ndarray:
        row = np.zeros(self.size)
        row[column] = value
        return row

    def _q(self, joint: int, way: np.ndarray) -> tuple[np.ndarray, float]:
        """Return the row and the constant of a component of q in the frame of a joint."""
        row = np.zeros(self.size)
        row[:self.products] = way @ self.force_rows[joint]
        return row, float(way @ self.force_centre[joint])

    def _sector(self, joint: int) -> None:
        half, outer, n, t = self.at.half_rad[joint], self.at.outer_m[joint], 2 * joint, 2 * joint + 1
        for angle in np.linspace(-min(half, np.pi), min(half, np.pi), TANGENTS):
            self._add(self._unit(n, np.cos(angle)) + self._unit(t, np.sin(angle)), -np.inf, outer)
        if half < np.pi / 2:
            for side in (-1.0, 1.0):
                self._add(self._unit(n, np.sin(half)) + self._unit(t, side * np.cos(half)), 0.0, np.inf)

    def _force(self, joint: int) -> None:
        for axis in range(2):
            row, centre = self._q(joint, np.eye(2)[axis])
            self._add(row, self.least_N[joint, axis] - centre, self.most_N[joint, axis] - centre)
        seen, middle = self.seen, self.at.middle_rad[joint]
        if not seen.least_N[joint] > 0:
            return
        # Both sides of the cone of q, and |q| <= −(a · q)/cos(half width) with a along its middle.
        low = seen.middle_rad[joint] - seen.below_rad[joint] - middle
        high = seen.middle_rad[joint] + seen.above_rad[joint] - middle
        for angle, side in ((low, -1.0), (high, 1.0)):
            row, centre = self._q(joint, side * np.array([-np.sin(angle), np.cos(angle)]))
            self._add(row, -np.inf, -centre)
        half, mid = 0.5 * (high - low), 0.5 * (high + low)
        if half < np.pi / 2:
            slope = np.sin(self.of.friction_angle_rad[joint]) / np.cos(half)
            row, centre = self._q(joint, np.array([np.cos(mid), np.sin(mid)]))
            for side in (-1.0, 1.0):
                self._add(self._unit(2 * self.of.count + joint, side) - slope * row, -np.inf, slope * centre)

    def _moment(self, joint: int) -> None:
        u, v = self.products + 2 * joint, self.products + 2 * joint + 1
        inner, outer = self.at.inner_m[joint], self.at.outer_m[joint]
        slack = 0.5 * (outer - inner) * self.at.friction_N[joint]
        row = self._unit(u) - self._unit(v) - self._unit(2 * self.of.count + joint, 0.5 * (inner + outer))
        self._add(row, -slack, slack)
        for axis, product in ((0, u), (1, v)):
            shift = 2 * joint + axis
            force, centre = self._q(joint, np.eye(2)[1 - axis])
            x, y = ((self.shift_least[joint, axis], self.shift_most[joint, axis]),
                    (self.least_N[joint, 1 - axis], self.most_N[joint, 1 - axis]))
            for a, b, side in ((x[0], y[0], 1.0), (x[1], y[1], 1.0), (x[0], y[1], -1.0), (x[1], y[0], -1.0)):
                # side (p − a y − b x + a b) >= 0 with y = row + centre
                row = side * (self._unit(product) - a * force - self._unit(shift, b))
                self._add(row, side * (a * centre - a * b), np.inf)

    def _scaled(self) -> Polytope:
        """Return the polytope in variables of the size 1."""
        middle, half = 0.5 * (self.floor + self.ceiling), 0.5 * (self.ceiling - self.floor)
        self.unit, self.zero = np.where(half > 0, half, 1.0), middle
        rows = np.array(self.rows)
        shift = rows @ middle
        return Polytope(rows * self.unit, np.array(self.least) - shift, np.array(self.most) - shift,
                        -(half > 0).astype(float), (half > 0).astype(float))

    def highest(self, cost: np.ndarray) -> float:
        """Return an upper bound of cost · variables."""
        return self.polytope.highest_value(cost * self.unit) + float(cost @ self.zero)

    def of_state(self, row: np.ndarray) -> float:
        """Return an upper bound of row · x, x as in Clearances."""
        cost = np.zeros(self.size)
        cost[:self.products] = row @ self.turn
        return self.highest(cost)

    def narrower(self) -> Sectors:
        """Return the sectors, narrowed by the programs of each joint."""
        at, count = self.at, self.of.count
        least, most, friction = at.least_rad.copy(), at.most_rad.copy(), at.friction_N.copy()
        outer, inner = at.outer_m.copy(), at.inner_m.copy()
        for joint in range(count):
            f = self._unit(2 * count + joint)
            friction[joint] = min(friction[joint], max(self.highest(f), self.highest(-f)))
            if at.half_rad[joint] < np.pi / 2 and inner[joint] > 0:
                t = self._unit(2 * joint + 1)
                for side, ends in ((1.0, most), (-1.0, least)):
                    # Along the arc, d_t = ρ sin α, and ρ is at least the inner radius.
                    reach = self.highest(side * t)
                    sine = reach / (inner[joint] if reach > 0 else outer[joint])
                    angle = np.arcsin(np.clip(sine, -1.0, 1.0)) if abs(sine) < 1 else np.pi / 2
                    ends[joint] = (min if side > 0 else max)(ends[joint], at.middle_rad[joint] + side * angle)
        return Sectors(least, np.maximum(most, least), inner, outer, friction)


def coupled(of: Clearances, at: Sectors) -> Coupled:
    """Return the programs at sectors that the programs themselves narrow."""
    found = Coupled(of, at)
    for _ in range(ROUNDS if of.count <= MOST_JOINTS else 0):
        before = found.at
        now = found.narrower()
        for _ in range(5):
            now = narrowed(of, now, forces(of, now))
        found = Coupled(of, now)
        if np.sum(now.half_rad) + np.sum(now.friction_N / before.friction_N.clip(1e-300)) > (1 - GAIN) * (
                np.sum(before.half_rad) + of.count):
            break
    return found
