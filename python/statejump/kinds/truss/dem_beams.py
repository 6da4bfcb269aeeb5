# SPDX-License-Identifier: GPL-3.0-or-later
"""Beams in the DEM: rotary inertia of bodies, stable step, and what the DEM refuses.

At rest the rotary inertia has no effect, so it is chosen for the time step: with m l²/12 of half of each beam, bending
is not stiffer than tension in slender beams.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from statejump import _engine
from statejump.kinds.truss.masses import beam_mass_kg, lumped_mass_kg
from statejump.kinds.truss.resolved import Course, ResolvedTruss

LARGEST_ROTATION_RAD = 3.0  # rotation vectors of the DEM are below π
ACROSS_RAD = 1e-6  # rotation across the axis of a moment that is neglected


def rotary_inertia_kg_m2(truss: ResolvedTruss) -> np.ndarray:
    """Return the moment of inertia of every node [kg m²], equal about all axes; 0 where no beam ends."""
    beams, found = truss.elements["beam"], np.zeros(len(truss.nodes.names))
    half = beam_mass_kg(truss) / 2
    np.add.at(found, beams.nodes, (half * beams.stress_free_length_m**2 / 12)[:, None])
    return found


def free_rotations(truss: ResolvedTruss) -> np.ndarray:
    """Return the axes (n, 3) about which the bodies of nodes rotate."""
    return np.asarray(truss.nodes.rotates[:, None] & ~truss.nodes.fixed_rotations)


@dataclass(frozen=True)
class Modes:
    """Stiffnesses (or dashpots) of the modes of beams: stretch, symmetric and antisymmetric bending, twist."""

    axial: np.ndarray  # (k,)
    symmetric: np.ndarray  # (k, 2)
    antisymmetric: np.ndarray  # (k, 2)
    torsional: np.ndarray  # (k,)
    across: np.ndarray  # (k,) of the chord under tension against rotation


def largest_rate(modes: Modes, length_m: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the largest eigenvalue (k,) of the modes of every beam between two free ends.

    Axial and torsional modes and those of each plane do not share motions. In a plane, symmetric and antisymmetric
    bending share rotations if the moments of inertia of the ends differ.

    :param ends: inverse mass [1/kg] and inverse moment of inertia [1/(kg m²)] (k, 2 ends, 2)
    """
    moves, turns = ends.sum(axis=1).T
    between = 0.25 * (ends[:, 0, 1] - ends[:, 1, 1])
    largest = np.maximum(modes.axial * moves, modes.torsional * turns)
    for axis in range(2):
        s, a = modes.symmetric[:, axis], modes.antisymmetric[:, axis]
        one, other = 0.25 * s * turns, a * (moves / length_m**2 + 0.25 * turns)
        root = np.hypot(0.5 * (one - other), np.sqrt(s * a) * between)
        largest = np.maximum(largest, 0.5 * (one + other) + root + modes.across * moves)
    return np.asarray(largest)


def _stiffness(truss: ResolvedTruss, length_m: np.ndarray, tension_N: np.ndarray) -> Modes:
    beams = truss.elements["beam"]
    bending, length = beams.bending_stiffness_N_m2, length_m[:, None]
    shear = 1 + 12 * bending / (beams.shear_stiffness_N[:, ::-1] * length**2)  # bending about y shears along z
    pulled = tension_N[:, None] * length
    return Modes(beams.axial_stiffness_N / length_m, 4 * bending / length + pulled / 3,
                 12 * bending / (length * shear) + pulled / (5 * shear**2), beams.torsional_stiffness_N_m2 / length_m,
                 tension_N / length_m)


def _damping(ratio: float, modes: Modes, length_m: np.ndarray, ends: np.ndarray) -> Modes:
    """Return the dashpots 2 ζ √(k m) of modes."""
    moves, turns = ends.sum(axis=1).T

    def of(stiffness: np.ndarray, mobility: np.ndarray) -> np.ndarray:
        return np.asarray(2 * ratio * np.sqrt(np.divide(stiffness, mobility, out=np.zeros_like(stiffness),
                                                        where=mobility > 0)))

    both = np.broadcast_to(turns[:, None] / 4, modes.symmetric.shape)
    across = np.broadcast_to((moves / length_m**2 + turns / 4)[:, None], both.shape)
    return Modes(of(modes.axial, moves), of(modes.symmetric, both), of(modes.antisymmetric, across),
                 of(modes.torsional, turns), np.zeros_like(moves))


@dataclass(frozen=True)
class Rates:
    """Bounds of the eigenvalues of stiffness [1/s²] and damping [1/s]: sums at every node, and the largest of a beam
    whose ends have their shares of the nodes' masses."""

    stiffness: np.ndarray  # (n,)
    damping: np.ndarray  # (n,)
    shared_stiffness: float
    shared_damping: float


def rates(truss: ResolvedTruss, path: Course, ratio: float) -> Rates:
    """Return the bounds for the largest tensions of a path.

    :param ratio: damping ratio of beams
    """
    beams, count = truss.elements["beam"], len(truss.nodes.names)
    change = truss.temperature_ranges_K[beams.program] * beams.temperature_fraction[:, None]
    length = beams.stress_free_length_m * (1 + beams.thermal_expansion_per_K[:, None] * change).min(axis=1)
    length = np.minimum(length, beams.stress_free_length_m)
    tension = np.maximum(path.states["beam_force_second_N"][..., 0], 0).max(axis=0)
    masses = np.column_stack((lumped_mass_kg(truss), rotary_inertia_kg_m2(truss) * free_rotations(truss).any(axis=1)))
    inverse = np.divide(1, masses, out=np.zeros_like(masses), where=masses > 0)
    offsets = np.stack((beams.offset_first_m, beams.offset_second_m), axis=1)
    arms = np.linalg.norm(offsets, axis=2)

    def at_ends(bodies: np.ndarray) -> np.ndarray:
        """Return the mobility of the ends of beams; twice the sum bounds an end beside its body."""
        aside = arms > 0
        moves = bodies[..., 0] + 2 * arms**2 * bodies[..., 1]
        return np.stack((moves, np.where(aside, 2, 1) * bodies[..., 1]), axis=-1)

    ends = inverse[beams.nodes]
    stiffness = _stiffness(truss, length, tension)
    damping = _damping(ratio, _stiffness(truss, length, np.zeros_like(tension)), length, at_ends(ends))
    sums, one_sided = [], []
    for modes in (stiffness, damping):
        alone = np.stack([largest_rate(modes, length, at_ends(ends * keep[None, :, None]))
                          for keep in np.eye(2)], axis=1)
        total = np.zeros(count)
        np.add.at(total, beams.nodes, alone)
        sums.append(total)
        one_sided.append(alone)
    # Every beam gets a share of the masses of its nodes by its part of the sum of stiffness.
    total = sums[0][beams.nodes]
    share = np.divide(one_sided[0], total, out=np.ones_like(total), where=total > 0)
    shared = [float(largest_rate(modes, length, at_ends(ends / share[:, :, None])).max(initial=0.0))
              for modes in (stiffness, damping)]
    # The square of a mode is at most twice the sum of the squares of the parts of its ends.
    return Rates(2 * sums[0], 2 * sums[1], shared[0], shared[1])


def stable_time_step_s(stiffness: np.ndarray, damping: np.ndarray, beams: Rates) -> float:
    """Return a stable step [s] with beams, the larger of two bounds.

    :param stiffness: sums at nodes [1/s²] of everything but beams; the same for ``damping`` [1/s]
    """
    of_nodes = np.append(beams.stiffness, np.zeros(len(stiffness) - len(beams.stiffness)))
    damping_of_nodes = np.append(beams.damping, np.zeros(len(stiffness) - len(beams.stiffness)))
    by_node = np.min(_engine.critical_time_step_s(1.0, stiffness + of_nodes, damping + damping_of_nodes))
    by_beam = np.min(_engine.critical_time_step_s(1.0, stiffness + beams.shared_stiffness,
                                                  damping + beams.shared_damping))
    return float(max(by_node, by_beam))


def refused(truss: ResolvedTruss, touched: set[int]) -> tuple[str, str] | None:
    """Return a node that the DEM cannot rotate as the solver does, and the reason; None if there is none.

    :param touched: nodes with a part of a contact
    """
    nodes, free = truss.nodes, free_rotations(truss)
    for node in np.flatnonzero(nodes.rotates):
        if int(node) in touched:
            return nodes.names[node], "rotates with a beam and is part of a joint, the DEM has one or the other"
        if free[node].sum() == 2:
            return nodes.names[node], ("is free to rotate about two axes, then its rotation in the DEM depends on the "
                                       "order of rotations; fix one axis or free the third")
    return None


def refused_on_path(path: Course) -> tuple[str, str] | None:
    """Return a node whose rotation the DEM cannot follow, and the reason; None if there is none."""
    nodes, turned = path.truss.nodes, path.states.get("rotation_rad")
    if turned is None:
        return None
    angle = np.linalg.norm(turned, axis=2).max(axis=0)
    for node in np.flatnonzero(angle > LARGEST_ROTATION_RAD):
        return nodes.names[node], f"rotates by {angle[node]:.3g} rad, the DEM has rotations below π"
    size = np.linalg.norm(nodes.moment_N_m, axis=1)
    for node in np.flatnonzero(size > 0):
        across = np.linalg.norm(np.cross(turned[:, node], nodes.moment_N_m[node] / size[node]), axis=1).max()
        if across > ACROSS_RAD:
            return nodes.names[node], (f"rotates by {across:.3g} rad across the axis of its moment, the DEM has "
                                       "moments of fixed direction")
    return None


def start_rotation_rad(path: Course) -> np.ndarray:
    """Return the rotation vectors of nodes in the first state (n, 3) [rad]."""
    turned: Any = path.states.get("rotation_rad")
    return np.zeros_like(path.truss.nodes.position_m) if turned is None else np.asarray(turned[0])
