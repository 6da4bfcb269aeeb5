# SPDX-License-Identifier: GPL-3.0-or-later
"""Probable cause if rigid motions of a condensed body cause forces: what the null space of its stiffness shows.

A free body has six motions without force. At each node they are, relative to the first node, a rotation of axes Q and
an arm d. Q other than 1 shows rotated axes; d other than the difference of the positions shows wrong rows, wrong units
or rotations about another point.
"""
from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]

GAP = 100.0  # the softest elastic motion is at least so many times stiffer than motions without force
ALIKE = 1e-3  # of directions and, relative to the size of the body, of positions
MOST_ORDERS = 7  # nodes whose orders are all tried
UNITS = {1000.0: "millimetres", 0.001: "metres instead of millimetres", 39.37007874: "inches", 3.280839895: "feet",
         100.0: "centimetres", 0.01745329252: "degrees for rotations", 57.29577951: "degrees for rotations"}


def cause_of(stiffness: Matrix, names: Sequence[str], positions_m: Matrix, freedoms: NDArray[np.int64]
             ) -> tuple[str, dict[str, Any]]:
    """Return the code of the probable cause, and its details."""
    size = int(freedoms.sum())
    inner = stiffness[:size, :size]
    scale = np.sqrt(np.maximum(np.abs(np.diag(inner)), 1e-300))
    values, vectors = np.linalg.eigh(inner / np.outer(scale, scale))
    if values[0] < -1e-3 * values[-1]:
        return "body_indefinite_rows", {}
    if len(values) > 6 and values[5] * GAP > values[6] and values[0] * GAP > values[-1] * 1e-3:
        return "body_held", {}
    if (freedoms == freedoms[0]).all():
        order = _interleaved(inner, positions_m, int(freedoms[0]))
        if order:
            return "body_dof_order", {"order": order}
    found = _of_motions(inner, names, positions_m, freedoms)
    if found:
        return found
    if len(names) <= MOST_ORDERS and (freedoms == 3).all() and _permuted(inner, positions_m, freedoms):
        return "body_row_order", {}
    return "body_not_free", {}


def _of_motions(stiffness: Matrix, names: Sequence[str], positions_m: Matrix, freedoms: NDArray[np.int64]
                ) -> tuple[str, dict[str, Any]] | None:
    """Return the cause that motions without force show; None: there are more or less than six, or they show nothing."""
    used = np.abs(stiffness).max(axis=1) > 1e-12 * np.abs(stiffness).max()
    starts = np.concatenate([[0], np.cumsum(freedoms)]).tolist()
    dofs = [int(used[start:end].sum()) for start, end in zip(starts, starts[1:])]
    whole = all(used[start:start + count].all() for start, count in zip(starts, dofs))
    if not whole or not set(dofs) <= {3, 6} or 6 not in dofs:
        return None
    kept = np.flatnonzero(used)
    inner = stiffness[np.ix_(kept, kept)]
    scale = np.sqrt(np.abs(np.diag(inner)))
    values, vectors = np.linalg.eigh(inner / np.outer(scale, scale))
    if len(values) > 6 and abs(values[5]) * GAP > values[6]:
        return None
    motions = (vectors / scale[:, None])[:, :6]
    at = np.concatenate([[0], np.cumsum(dofs)]).tolist()
    base = dofs.index(6)
    first = motions[at[base]:at[base] + 6]
    if np.linalg.cond(first) > 1e12:
        return None
    relative = motions @ np.linalg.inv(first)
    return _by_nodes(np.stack([relative[start:start + 3] for start in at[:-1]]), names, positions_m, base)


def _is_free(stiffness: Matrix, positions_m: Matrix, freedoms: Sequence[int]) -> bool:
    motions = []
    for (x, y, z), dofs in zip(positions_m - positions_m.mean(axis=0), freedoms):
        motions.append(np.hstack([np.eye(6)[:dofs, :3], np.vstack([
            [[0, z, -y], [-z, 0, x], [y, -x, 0]], np.eye(3)])[:dofs]]))
    forces = stiffness @ np.vstack(motions)
    bound = np.abs(stiffness) @ np.abs(np.vstack(motions))
    return bool((np.abs(forces) <= ALIKE * bound.max(axis=0)).all())


def _interleaved(stiffness: Matrix, positions_m: Matrix, dofs: int) -> str:
    """Return the name of another usual order of dofs that makes the body free."""
    nodes = len(positions_m)
    by_dof = np.arange(dofs * nodes).reshape(dofs, nodes).T.ravel()
    orders = {"direction by direction": by_dof}
    if dofs == 6:
        halves = [[3 * node + k for k in range(3)] + [3 * (nodes + node) + k for k in range(3)]
                  for node in range(nodes)]
        orders["all translations first"] = np.ravel(halves)
        swapped = [[6 * node + (k + 3) % 6 for k in range(6)] for node in range(nodes)]
        orders["rotations before translations"] = np.ravel(swapped)
    for name, order in orders.items():
        if _is_free(stiffness[np.ix_(order, order)], positions_m, [dofs] * nodes):
            return name
    return ""


def _permuted(stiffness: Matrix, positions_m: Matrix, freedoms: NDArray[np.int64]) -> bool:
    """Return whether another order of the positions makes the body free."""
    for order in permutations(range(len(positions_m))):
        if (freedoms[list(order)] == freedoms).all() and \
                _is_free(stiffness, positions_m[list(order)], [int(one) for one in freedoms]):
            return True
    return False


def _by_nodes(relative: Matrix, names: Sequence[str], positions_m: Matrix, base: int
              ) -> tuple[str, dict[str, Any]] | None:
    """Return the cause from the translations (n, 3, 6) of all nodes per unit motion of the node ``base``."""
    turns = relative[:, :, :3]
    if np.abs(turns @ np.swapaxes(turns, 1, 2) - np.eye(3)).max() > ALIKE:
        return None
    groups: list[list[int]] = []  # nodes with equal axes
    for node, turn in enumerate(turns):
        group = next((one for one in groups if np.abs(turn - turns[one[0]]).max() <= ALIKE), None)
        if group is None:
            groups.append([node])
        else:
            group.append(node)
    if len(groups) > 1:
        groups.sort(key=lambda group: (-len(group), base not in group, group))
        mirrored = bool((np.linalg.det(turns) < 0).any())
        return "body_sign" if mirrored else "body_axes", {"node": names[groups[1][0]], "other": names[groups[0][0]]}
    arm = relative[:, :, 3:]
    arms = np.stack([arm[:, 1, 2], arm[:, 2, 0], arm[:, 0, 1]], axis=1)
    return _of_arms(arms, names, positions_m, base)


def _of_arms(arms: Matrix, names: Sequence[str], positions_m: Matrix, base: int) -> tuple[str, dict[str, Any]]:
    given = positions_m - positions_m[base]
    size = max(float(np.abs(given).max(initial=0.0)), 1e-300)
    spread = float(np.abs(arms).max(initial=0.0))
    factor = float((arms * given).sum() / max((given**2).sum(), 1e-300))
    if factor > 0 and np.abs(arms - factor * given).max() <= ALIKE * spread and abs(factor - 1) > ALIKE:
        unit = next((name for value, name in UNITS.items() if abs(factor / value - 1) < ALIKE), "another unit")
        return "body_units", {"factor": float(f"{factor:.6g}"), "unit": unit}
    for base in positions_m:
        near = np.linalg.norm((base + arms)[:, None] - positions_m[None], axis=2)
        order = near.argmin(axis=1)
        if near.min(axis=1).max() <= ALIKE * size and len(set(order.tolist())) == len(names):
            wrong = next(k for k, place in enumerate(order) if place != k)
            return "body_row_order_named", {"node": names[wrong], "other": names[int(order[wrong])]}
    off = np.linalg.norm(arms - given, axis=1)
    worst = int(off.argmax())
    digits = 6 - int(np.floor(np.log10(max(off[worst], 1e-300))))
    offset = (np.round((arms - given)[worst], digits) + 0.0).tolist()
    return "body_arm", {"node": names[worst], "offset_m": offset}
