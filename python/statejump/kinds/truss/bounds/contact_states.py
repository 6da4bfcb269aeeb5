# SPDX-License-Identifier: GPL-3.0-or-later
"""Rest states of trusses with clearance revolutes at given friction angles: values that bounds cannot fall below."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from statejump.kinds.truss.bounds.clearance import Clearances

NEWTON, CONVERGED = 40, 1e-11  # steps, residual over the largest force
SWEEPS = 8  # over all joints
PARTS = 4  # steps from no friction to given friction angles


@dataclass(frozen=True)
class RestState:
    """A rest state of the linear truss with exact contacts.

    :param state: x as in :class:`Clearances`
    """

    angle_rad: np.ndarray
    normal_N: np.ndarray
    state: np.ndarray


def state_of(of: Clearances, angle_rad: np.ndarray, normal_N: np.ndarray, share: np.ndarray,
             other_N: np.ndarray) -> np.ndarray:
    """Return x with f = λ tan ψ, ψ being the share of the friction angle."""
    radius = of.clearance_m + of.depth_m(normal_N)
    shift = radius[:, None] * np.stack((np.cos(angle_rad), np.sin(angle_rad)), axis=1)
    return np.concatenate((shift.ravel(), normal_N * np.tan(share * of.friction_angle_rad), other_N))


def rest_state(of: Clearances, share: np.ndarray, other_N: np.ndarray, start: RestState | None = None
               ) -> RestState | None:
    """Return the rest state with given friction; None: Newton's method finds none, or a contact opens.

    :param share: friction angle over its limit (m,), −1 to 1
    """
    angle = np.arctan2(of.shift_m[:, 1], of.shift_m[:, 0]) if start is None else start.angle_rad
    normal = -(of.force_N * np.stack((np.cos(angle), np.sin(angle)), axis=1)).sum(axis=1)
    normal = normal if start is None else start.normal_N
    scale = float(np.abs(of.force_N).max())
    for _ in range(NEWTON):
        residual, slope = balance(of, angle, normal, share, other_N)
        if np.abs(residual).max() <= CONVERGED * scale:
            return RestState(angle, normal, state_of(of, angle, normal, share, other_N))
        step = np.linalg.solve(slope, -residual)
        factor = min(1.0, 0.3 / max(np.abs(step[:of.count]).max(), 1e-300))
        change = step[of.count:]
        shrinks = change < 0
        if shrinks.any():
            factor = min(factor, float(np.min(0.8 * normal[shrinks] / -change[shrinks])))
        angle, normal = angle + factor * step[:of.count], normal + factor * change
        if np.any(normal <= 0):
            return None
    return None


def balance(of: Clearances, angle: np.ndarray, normal: np.ndarray, share: np.ndarray, other_N: np.ndarray
            ) -> tuple[np.ndarray, np.ndarray]:
    """Return q(x) + λ n − f t (2 m,) and its derivatives by angles and normal forces."""
    count = of.count
    tan = np.tan(share * of.friction_angle_rad)
    n = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    t = np.stack((-n[:, 1], n[:, 0]), axis=1)
    depth = of.depth_m(normal)
    radius = of.clearance_m + depth
    force = of.forces(state_of(of, angle, normal, share, other_N))
    residual = force + normal[:, None] * (n - tan[:, None] * t)
    by_shift, by_friction = of.force_by_state[:, :2 * count], of.force_by_state[:, 2 * count:3 * count]
    softer = 2 / 3 * depth / np.maximum(normal, 1e-300)
    slope = np.zeros((2 * count, 2 * count))
    for joint in range(count):
        two = slice(2 * joint, 2 * joint + 2)
        slope[:, joint] = by_shift[:, two] @ (radius[joint] * t[joint])
        slope[two, joint] += normal[joint] * (t[joint] + tan[joint] * n[joint])
        slope[:, count + joint] = by_shift[:, two] @ (softer[joint] * n[joint]) + by_friction[:, joint] * tan[joint]
        slope[two, count + joint] += n[joint] - tan[joint] * t[joint]
    return residual.ravel(), slope


def farthest_state(of: Clearances, row: np.ndarray) -> RestState | None:
    """Return a rest state with a large value of row · x: friction at its limits, improved joint by joint."""
    count = of.count
    free = rest_state(of, np.zeros(count), np.zeros(len(of.limit_N)))
    if free is None:
        return None
    best = free
    _, slope = balance(of, free.angle_rad, free.normal_N, np.zeros(count), np.zeros(len(of.limit_N)))
    share = np.sign(_gradient(of, free, row, slope))
    share[share == 0] = 1.0
    by_angles = np.linalg.solve(slope.T, _shift_rows(of, free, row))
    effect = np.asarray(row[3 * count:] - by_angles @ of.force_by_state[:, 3 * count:])
    other = np.sign(effect) * of.limit_N
    for part in np.linspace(1 / PARTS, 1, PARTS):
        now = rest_state(of, part * share, part * other, best)
        if now is None:
            return best
        best = now
    return _improved(of, row, share, other, best)


def _shift_rows(of: Clearances, at: RestState, row: np.ndarray) -> np.ndarray:
    """Return the derivatives of row · x by angles and normal forces at ψ = 0."""
    count = of.count
    n = np.stack((np.cos(at.angle_rad), np.sin(at.angle_rad)), axis=1)
    t = np.stack((-n[:, 1], n[:, 0]), axis=1)
    depth = of.depth_m(at.normal_N)
    shifts = row[:2 * count].reshape(count, 2)
    return np.concatenate(((of.clearance_m + depth) * (shifts * t).sum(axis=1),
                           2 / 3 * depth / at.normal_N * (shifts * n).sum(axis=1)))


def _gradient(of: Clearances, at: RestState, row: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Return the derivatives of row · x by the friction f of each revolute at ψ = 0."""
    count = of.count
    n = np.stack((np.cos(at.angle_rad), np.sin(at.angle_rad)), axis=1)
    t = np.stack((-n[:, 1], n[:, 0]), axis=1)
    residual = of.force_by_state[:, 2 * count:3 * count].copy()
    for joint in range(count):
        residual[2 * joint:2 * joint + 2, joint] -= t[joint]
    return np.asarray(row[2 * count:3 * count] - _shift_rows(of, at, row) @ np.linalg.solve(slope, residual))


def _improved(of: Clearances, row: np.ndarray, share: np.ndarray, other: np.ndarray, best: RestState) -> RestState:
    for _ in range(SWEEPS):
        before = float(row @ best.state)
        for joint in range(of.count):
            for value in (-1.0, 0.0, 1.0):
                if value == share[joint]:
                    continue
                tried = share.copy()
                tried[joint] = value
                now = rest_state(of, tried, other, best)
                if now is not None and row @ now.state > row @ best.state:
                    best, share = now, tried
        for joint in range(len(other)):
            flipped = other.copy()
            flipped[joint] = -flipped[joint]
            now = rest_state(of, share, flipped, best)
            if now is not None and row @ now.state > row @ best.state:
                best, other = now, flipped
        if row @ best.state - before <= 1e-9 * abs(before):
            break
    return best
