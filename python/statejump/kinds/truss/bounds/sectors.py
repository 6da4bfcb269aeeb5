# SPDX-License-Identifier: GPL-3.0-or-later
"""Ranges of contact directions, contact forces and friction of clearance revolutes over all rest states.

Any rest state lies in discs |d| <= c + depth. From ranges of d and f follow ranges of the forces q, and from these
narrower ranges of d and f: the normal n lies within the friction angle of −q.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.kinds.truss.bounds.clearance import Clearances

DIRECTIONS = 96
ROUNDS = 200
CONVERGED = 1e-5  # relative change of the widths in a round
HALVINGS = 40
LARGE = 1e3  # factor on forces from which the first bound of all forces is sought
WIDER = 1 + 1e-9


@dataclass
class Sectors:
    """Ranges over all rest states. ``d = ρ (cos α, sin α)`` of every revolute.

    :param least_rad: lowest α; ``most_rad``: highest α, at most 2 π more
    :param inner_m: smallest ρ; ``outer_m``: largest ρ
    :param friction_N: largest |f|
    """

    least_rad: np.ndarray
    most_rad: np.ndarray
    inner_m: np.ndarray
    outer_m: np.ndarray
    friction_N: np.ndarray

    @property
    def middle_rad(self) -> np.ndarray:
        """Middles of the ranges of α."""
        return np.asarray(0.5 * (self.least_rad + self.most_rad))

    @property
    def half_rad(self) -> np.ndarray:
        """Half widths of the ranges of α."""
        return np.asarray(0.5 * (self.most_rad - self.least_rad))

    def support(self, rows: np.ndarray) -> np.ndarray:
        """Return max Σ r_j · d_j over the sectors for rows (..., m, 2)."""
        size = np.hypot(rows[..., 0], rows[..., 1])
        away = np.arctan2(rows[..., 1], rows[..., 0]) - self.middle_rad
        away = np.abs((away + np.pi) % (2 * np.pi) - np.pi)
        cosine = np.cos(np.minimum(np.maximum(away - self.half_rad, 0.0), np.pi))
        found = (size * cosine * np.where(cosine > 0, self.outer_m, self.inner_m)).sum(axis=-1)
        return np.asarray(found)


def highest(of: Clearances, at: Sectors, rows: np.ndarray) -> np.ndarray:
    """Return upper bounds of rows (..., n) · x over all rest states, x as in :class:`Clearances`."""
    count = of.count
    parts = rows[..., :2 * count].reshape(*rows.shape[:-1], count, 2)
    return np.asarray(at.support(parts) + np.abs(rows[..., 2 * count:3 * count]) @ at.friction_N
                      + np.abs(rows[..., 3 * count:]) @ of.limit_N)


def first(of: Clearances) -> Sectors:
    """Return discs and limits of friction that hold in all rest states.

    With |q| <= F(|q|) for a monotone concave F, a vector b with F(b) < b bounds the forces.

    :raises StatejumpError: friction moments amplify themselves, so that no bound of the forces exists
    """
    count = of.count
    blocks = of.force_by_state.reshape(count, 2, -1)
    by_shift = np.linalg.norm(blocks[:, :, :2 * count].reshape(count, 2, count, 2), axis=(1, 3))
    by_friction = np.linalg.norm(blocks[:, :, 2 * count:3 * count], axis=1) * np.sin(of.friction_angle_rad)
    centre = np.linalg.norm(of.force_N - (of.force_by_state @ of.start).reshape(-1, 2), axis=1)
    centre = centre + np.linalg.norm(blocks[:, :, 3 * count:], axis=1) @ of.limit_N

    def largest(force: np.ndarray) -> np.ndarray:
        return np.asarray(centre + by_shift @ (of.clearance_m + of.depth_m(force)) + by_friction @ force)

    if np.abs(np.linalg.eigvals(by_friction)).max() >= 1:
        raise _amplified(of)
    force: np.ndarray = LARGE * np.linalg.solve(np.eye(count) - by_friction, largest(np.zeros(count)))
    for _ in range(ROUNDS):
        now = largest(force)
        if np.all(now < force):
            break
        force = 2 * np.maximum(now, force)
    else:
        raise _amplified(of)
    for _ in range(ROUNDS):
        now = np.minimum(force, largest(force) * WIDER)
        done = np.all(force - now <= CONVERGED * force)
        force = now
        if done:
            break
    depth = of.depth_m(force)
    return Sectors(np.full(count, -np.pi), np.full(count, np.pi), np.zeros(count), of.clearance_m + depth,
                   np.sin(of.friction_angle_rad) * force)


def _amplified(of: Clearances) -> StatejumpError:
    return StatejumpError(code="bounds_of_amplified_friction", place=of.truss.name, case=of.truss.name)


@dataclass(frozen=True)
class Forces:
    """Ranges of q: middle of their directions, half widths on both sides (π: any), and magnitudes."""

    middle_rad: np.ndarray
    below_rad: np.ndarray
    above_rad: np.ndarray
    least_N: np.ndarray
    most_N: np.ndarray


def forces(of: Clearances, at: Sectors) -> Forces:
    """Return the ranges of the contact forces."""
    angle = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    most = along(of, at, np.tile(angle, (of.count, 1)))
    least = -np.roll(most, DIRECTIONS // 2, axis=1)  # least q · a, from the largest one against a
    middle = angle[least.argmax(axis=1)]
    found = []
    for side in (-1.0, 1.0):
        open_, shut = np.zeros(of.count), np.full(of.count, np.pi / 2)
        for _ in range(HALVINGS):
            tried = 0.5 * (open_ + shut)
            apart = along(of, at, (middle + side * (np.pi / 2 + tried))[:, None])[:, 0] < 0
            shut, open_ = np.where(apart, tried, shut), np.where(apart, open_, tried)
        found.append(np.where(least.max(axis=1) > 0, shut, np.pi))
    return Forces(middle, found[0], found[1], np.maximum(least.max(axis=1), 0.0),
                  most.max(axis=1) / np.cos(np.pi / DIRECTIONS))


def along(of: Clearances, at: Sectors, angle_rad: np.ndarray) -> np.ndarray:
    """Return the largest components of q of each revolute along directions (m, k)."""
    way = np.stack((np.cos(angle_rad), np.sin(angle_rad)), axis=-1)
    blocks = of.force_by_state.reshape(of.count, 2, -1)
    centre = of.force_N - (of.force_by_state @ of.start).reshape(-1, 2)
    found = np.empty(angle_rad.shape)
    for joint in range(of.count):
        found[joint] = way[joint] @ centre[joint] + highest(of, at, way[joint] @ blocks[joint])
    return found


def narrowed(of: Clearances, at: Sectors, seen: Forces) -> Sectors:
    """Return the sectors that ranges of the forces permit."""
    within = of.friction_angle_rad
    certain = seen.least_N > 0
    # n lies within the friction angle of −q.
    middle = seen.middle_rad + np.pi
    middle = middle + 2 * np.pi * np.round((at.middle_rad - middle) / (2 * np.pi))
    least = np.where(certain, middle - seen.below_rad - within, -np.inf)
    most = np.where(certain, middle + seen.above_rad + within, np.inf)
    full = at.half_rad >= np.pi * (1 - 1e-12)
    least = np.where(full & certain, least, np.maximum(least, at.least_rad))
    most = np.where(full & certain, most, np.minimum(most, at.most_rad))
    wide = most - least >= 2 * np.pi
    least, most = np.where(wide, at.least_rad, least), np.where(wide, at.most_rad, most)
    normal = np.cos(within) * seen.least_N
    inner = np.where(certain, of.clearance_m + of.depth_m(normal), at.inner_m)
    outer = of.clearance_m + of.depth_m(seen.most_N)
    return Sectors(least, most, np.maximum(at.inner_m, inner), np.minimum(at.outer_m, outer),
                   np.minimum(at.friction_N, np.sin(within) * seen.most_N))


def propagated(of: Clearances) -> Sectors:
    """Return sectors that hold in all rest states."""
    at = first(of)
    for _ in range(ROUNDS):
        now = narrowed(of, at, forces(of, at))
        before, after = (np.concatenate((one.half_rad, one.outer_m, one.friction_N)) for one in (at, now))
        at = now
        if np.all(before - after <= CONVERGED * before):
            break
    return at
