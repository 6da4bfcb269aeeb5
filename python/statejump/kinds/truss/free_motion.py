# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid motions of a truss that no support prevents, and statically determinate supports against them.

Modes need an equilibrium, which a free truss does not have. Rigid arms from a fixed node to some displacements give it
one. They change neither stiffness nor masses, because the solver has multipliers for them; the modes omit these.
"""
from __future__ import annotations

from dataclasses import dataclass

import attrs
import numpy as np
from scipy.linalg import null_space, qr

from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.joints.rigid import Rigid
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.sections import Node

# Fraction of the largest motion below which a motion is zero: positions have about eight digits.
LEAST = 1e-7
GROUND, ASIDE = "_ground", "_aside"  # names of added nodes


@dataclass(frozen=True)
class HeldTruss:
    """A free truss with supports.

    :param case: the case with arms against its rigid motions, and further nodes behind its own
    :param motions: displacements and rotations of its nodes (k, nodes, 2, 3) in its rigid motions
    """

    case: TrussCase
    motions: np.ndarray


def held(case: TrussCase) -> HeldTruss:
    """Return a case with supports against all rigid motions that its own supports permit. A truss that may not be free
    has none."""
    truss = case.resolve()
    if not truss.free:
        return HeldTruss(case, np.zeros((0, 1)))
    turning = truss.nodes.rotates
    rates = _Rates(truss.nodes.position_m)
    free = _free(truss, rates, turning)
    count = free.shape[1]
    if count == 0:
        return HeldTruss(case, np.zeros((0, 1)))
    rows = rates.displacements() @ free
    carried = {node for body in case.rigid for node in body.nodes}
    names, nodes, rigid = list(truss.nodes.names), list(case.node), list(case.rigid)
    may = np.array([name not in carried for name in names])
    if np.linalg.matrix_rank(rows[np.repeat(may, 3)], tol=LEAST) < count:
        # It spins about the line of its nodes: hold a node beside it.
        arm = int(np.flatnonzero(turning & may)[0])
        spin = (free @ null_space(rows[np.repeat(may, 3)], rcond=LEAST)[:, 0])[3:]
        aside = np.cross(spin, np.eye(3)[np.argmin(np.abs(spin))])
        position = truss.nodes.position_m[arm] + rates.size * aside / np.linalg.norm(aside)
        nodes.append(Node(name=ASIDE, position_m=[float(part) for part in position]))
        rigid.append(Rigid(name=ASIDE, master=ASIDE, nodes=[names[arm]]))
        names.append(ASIDE)
        may = np.append(np.where(np.arange(len(may)) == arm, False, may), True)
        rows = np.vstack((rows, rates.at(position) @ free))
    axes = list("xyz"[:truss.dimension])
    nodes.append(Node(name=GROUND, position_m=[0.0] * truss.dimension, fixed=axes,
                      fixed_rotations=axes if truss.dimension == 3 else ["z"]))
    for at, name in enumerate(names):
        if directions := [axes[pivot % 3] for pivot in _pivots(rows, may, count) if pivot // 3 == at]:
            rigid.append(Rigid(name=f"_{name}", master=GROUND, nodes=[name], directions=directions, rotations=[]))
    made = attrs.evolve(case, node=nodes, rigid=rigid)
    rows = np.vstack((rows, np.zeros((3, count))))
    moves = rows.reshape(-1, 3, count).transpose(2, 0, 1)
    turns = np.broadcast_to(free[3:].T[:, None] / rates.size, moves.shape).copy()
    turns[:, -1] = 0.0  # the ground
    return HeldTruss(made, np.stack((moves, turns), axis=2))


def _pivots(rows: np.ndarray, may: np.ndarray, count: int) -> list[int]:
    """Return the displacements, of nodes that may be held, that determine all motions best."""
    of = np.flatnonzero(np.repeat(may, 3))
    return sorted(int(of[pivot]) for pivot in qr(rows[of].T, mode="r", pivoting=True)[1][:count])


class _Rates:
    """Displacements of points in rigid motions: three translations, and three rotations times the size of the truss."""

    def __init__(self, positions: np.ndarray) -> None:
        self.positions, self.centre = positions, positions.mean(axis=0)
        self.size = float(np.ptp(positions, axis=0).max()) or 1.0

    def at(self, position: np.ndarray) -> np.ndarray:
        """Return the displacement (3, 6) of a point."""
        x, y, z = (position - self.centre) / self.size
        return np.hstack((np.eye(3), [[0, z, -y], [-z, 0, x], [y, -x, 0]]))

    def displacements(self) -> np.ndarray:
        """Return the displacements (3 n, 6) of all nodes."""
        return np.vstack([self.at(position) for position in self.positions])


def _free(truss: ResolvedTruss, rates: _Rates, turning: np.ndarray) -> np.ndarray:
    """Return the rigid motions (6, k) that supports permit and that move a node."""
    nodes, moves = truss.nodes, rates.displacements().reshape(-1, 3, 6)
    turns = np.hstack((np.zeros((3, 3)), np.eye(3)))
    rows = [moves[nodes.fixed], np.einsum("na,nak->nk", nodes.guide_normal, moves)]
    rows += [turns[fixed] for fixed in nodes.fixed_rotations[turning]]
    for which, turned, of in zip(truss.constraints.nodes, truss.constraints.turns, truss.constraints.coefficients):
        rate = np.where(turned[:, None, None], turns / rates.size, moves[which])
        size = np.abs(of * np.where(turned, 1 / rates.size, 1.0)[:, None]).max()
        rows.append(np.einsum("ta,tak->k", of, rate)[None] / size)
    free = null_space(np.vstack(rows), rcond=LEAST) if any(len(one) for one in rows) else np.eye(6)
    whole = np.vstack((moves.reshape(-1, 6), *(turns for _ in range(int(turning.any())))))
    _, sizes, motions = np.linalg.svd(whole @ free, full_matrices=False)
    return np.asarray(free @ motions[sizes > LEAST * sizes.max(initial=0.0)].T)
