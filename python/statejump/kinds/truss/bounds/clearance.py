# SPDX-License-Identifier: GPL-3.0-or-later
"""A truss with clearance revolutes about its equilibrium without friction, every contact closed.

Each journal is displaced by d against its bearing. The contact force on the journal is q = −λ n + f t with n = d/|d|.
Elements and joints are linear about the equilibrium, contacts are exact:

    w = W (x − x0),   q = q0 + Q (x − x0),   x = (d of all revolutes, f of all revolutes, λ of other friction joints)
    |d| = c + (λ/K)^(2/3),   |f| <= μ λ,   d × q = |d| f
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix, vstack

from statejump import _engine
from statejump.core.engine_failures import EngineFailed
from statejump.core.errors import StatejumpError
from statejump.kinds.truss.bounds.sliding import Factors, Joint, check_stable
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.check_mechanism import check_at_rest
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import engine_items

NEAR = 1e-9  # relative distance of a closed contact from its clearance
CLOSED = 1e-9  # smallest force of a closed contact over the largest one


@dataclass(frozen=True)
class Clearances:
    """The linear truss between its contacts.

    :param by_state: W (dofs, 3 m + k)
    :param force_by_state: Q (2 m, 3 m + k)
    :param shift_m: d at the equilibrium (m, 2); ``force_N``: q there (m, 2)
    :param hertz_N_per_m15: K; inf: rigid
    :param limit_N: λ of the k other friction joints is at most this
    """

    truss: ResolvedTruss
    joints: Sequence[Joint]
    by_state: np.ndarray
    force_by_state: np.ndarray
    heating_N_per_K: Any  # G (dofs, elements), links first
    moments: Any  # (m, dofs): slides of the contacts by rotations
    slides: Any  # (k, dofs): slides of other friction joints
    of_nodes: Any
    displacement_m: np.ndarray
    shift_m: np.ndarray
    force_N: np.ndarray
    clearance_m: np.ndarray
    hertz_N_per_m15: np.ndarray
    friction_angle_rad: np.ndarray
    limit_N: np.ndarray
    solve: Factors  # of the truss whose journals are pinned to their bearings

    @property
    def count(self) -> int:
        """Number of revolutes."""
        return len(self.clearance_m)

    @property
    def start(self) -> np.ndarray:
        """The state x0 of the equilibrium without friction."""
        return np.concatenate((self.shift_m.ravel(), np.zeros(self.count + len(self.limit_N))))

    def respond(self, loads_N: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return dofs (dofs, k) and contact forces (2 m, k) by loads (dofs, k), with all d held."""
        whole = np.zeros((self.solve.size + self.solve.rows, loads_N.shape[1]))
        whole[:self.solve.size] = loads_N / self.solve.scale
        found = self.solve.factor.solve(whole)
        return found[:self.solve.size], -self.solve.scale * found[self.solve.size + self.solve.rows - 2 * self.count:]

    def with_forces(self, rows: Any, most_N: np.ndarray) -> Clearances:
        """Return the truss with forces along rows (k, dofs) as further joints with limits."""
        moved, force = self.respond(rows.T.toarray())
        return replace(self, by_state=np.hstack((self.by_state, moved)), limit_N=np.append(self.limit_N, most_N),
                       force_by_state=np.hstack((self.force_by_state, force)))

    def heated(self, of_elements: np.ndarray, lowest_K: np.ndarray, highest_K: np.ndarray) -> Clearances:
        """Return the truss with temperatures T in intervals, each as a further force about the middle of its interval.

        :param of_elements: ΔT of elements by T (elements, variables)
        """
        moved, force = self.respond(self.heating_N_per_K @ of_elements)
        middle = 0.5 * (lowest_K + highest_K)
        return replace(self, by_state=np.hstack((self.by_state, moved)),
                       limit_N=np.append(self.limit_N, 0.5 * (highest_K - lowest_K)),
                       force_N=self.force_N + (force @ middle).reshape(-1, 2),
                       force_by_state=np.hstack((self.force_by_state, force)))

    def depth_m(self, normal_N: np.ndarray) -> np.ndarray:
        """Return the depths at normal forces, joint by joint."""
        return np.asarray((np.maximum(normal_N, 0.0) / self.hertz_N_per_m15) ** (2 / 3))

    def forces(self, state: np.ndarray) -> np.ndarray:
        """Return q (m, 2) at a state."""
        return self.force_N + (self.force_by_state @ (state - self.start)).reshape(-1, 2)


def clearances(case: TrussCase) -> Clearances:
    """Return the matrices of a case with clearance revolutes.

    :raises StatejumpError: a joint or a contact of the truss is not covered
    :raises EngineFailed: the truss has no equilibrium without friction
    """
    truss = case.resolve()
    check_at_rest(truss)
    named = [Joint(section, name) for section in _engine.truss_joints() for name in truss.joints[section].names]
    _refuse_others(truss, named)
    try:
        found = _engine.truss_friction_free(**engine_items(truss))
    except _engine.EngineFailure as failure:
        raise EngineFailed(failure, case=truss.name, place=truss.name) from None
    revolutes = [index for index, joint in enumerate(named) if joint.section == "revolute"]
    others = [index for index, joint in enumerate(named) if joint.section not in ("revolute", "rigid")]
    pins, shift = pins_of(truss, found)
    open_ = np.linalg.norm(shift, axis=1) < truss.revolutes.radial_clearance_m * (1 - NEAR)
    for index in np.flatnonzero(open_)[:1]:
        raise _open_contact(truss, int(index))
    force, moments = _contacts(truss, found, revolutes, pins, shift)
    guides = found["guides"].tocsr()[~np.isin(found["guide_joint"], revolutes)]
    stiffness = found["stiffness_N_per_m"].tocsc()
    held = vstack([guides, pins]).tocsr()
    check_stable(truss, stiffness, held, found["of_nodes"].tocsr())
    solve = Factors(stiffness, held)
    slides = found["slides"].tocsr()[others]
    size, count = stiffness.shape[0], len(revolutes)
    loads = np.hstack((moments.T.toarray(), -slides.T.toarray()))
    # Columns: dislocations, then friction.
    whole = np.zeros((size + solve.rows, 2 * count + loads.shape[1]))
    whole[:size, 2 * count:] = loads / solve.scale
    whole[size + solve.rows - 2 * count:, :2 * count] = np.eye(2 * count)
    answer = solve.factor.solve(whole)
    joints = [named[index] for index in (*revolutes, *others)]
    parts = truss.revolutes
    (kind,) = (joint for joint in JOINTS if joint.section == "revolute")
    hertz = kind.engine_arrays(truss, parts)["hertz_stiffness_N_per_m15"]
    return Clearances(
        truss, joints, answer[:size], -solve.scale * answer[size + solve.rows - 2 * count:],
        found["heating_N_per_K"].tocsc(), moments, slides, found["of_nodes"].tocsr(),
        found["displacement_m"], shift, force, np.asarray(parts.radial_clearance_m), np.asarray(hertz),
        np.arctan(parts.friction_coefficient), found["friction_limit_N"][others], solve)


def _refuse_others(truss: ResolvedTruss, named: Sequence[Joint]) -> None:
    refused = {kind.section: kind.bounds_code for kind in JOINTS if kind.bounds_code}
    for joint in named:
        if code := refused.get(joint.section):
            raise StatejumpError(code=code, place=truss.name, case=truss.name, joint_with_clearance=str(joint))
    sliders = truss.sliders
    for index in np.flatnonzero(sliders.have_stops | (sliders.play_m > 0))[:1]:
        raise StatejumpError(code="bounds_of_stop", place=truss.name, case=truss.name, change="reach a stop",
                             part=f"slider '{sliders.names[index]}'")


def pins_of(truss: ResolvedTruss, found: Any) -> tuple[Any, np.ndarray]:
    """Return rows (2 m, dofs) of the displacements of journals against bearings, and d at the equilibrium."""
    parts, of_nodes = truss.revolutes, found["of_nodes"].tocsr()
    place = truss.nodes.position_m + found["displacement_m"]
    rows, shifts = [], []
    for journal, bearing, axis in zip(parts.journal_node, parts.bearing_node, parts.axis):
        first = np.cross(np.eye(3)[int(np.abs(axis).argmin())], axis)
        first /= np.linalg.norm(first)
        plane = np.stack((first, np.cross(axis, first)))
        relative = of_nodes[3 * journal:3 * journal + 3] - of_nodes[3 * bearing:3 * bearing + 3]
        rows.append(csr_matrix(plane) @ relative)
        shifts.append(plane @ (place[journal] - place[bearing]))
    return vstack(rows).tocsr(), np.array(shifts)


def _open_contact(truss: ResolvedTruss, index: int) -> StatejumpError:
    return StatejumpError(code="bounds_of_open_contact", place=truss.name, case=truss.name,
                          joint_with_clearance=f"revolute '{truss.revolutes.names[index]}'")


def _contacts(truss: ResolvedTruss, found: Any, revolutes: Sequence[int], pins: Any, shift: np.ndarray
              ) -> tuple[np.ndarray, Any]:
    """Return q (m, 2) at the equilibrium, and rows (m, dofs) of the moments of friction on both parts.

    :raises StatejumpError: a contact carries no force there, so that its direction is open
    """
    joint_of, guides = found["guide_joint"], found["guides"].tocsr()
    columns = vstack([pins, guides[~np.isin(joint_of, revolutes)]]).toarray().T
    # The contacts carry the load; without friction along the normals.
    force = np.linalg.lstsq(columns, -found["load_N"], rcond=None)[0][:2 * len(revolutes)].reshape(-1, 2)
    normal = shift / np.linalg.norm(shift, axis=1)[:, None]
    closed = -(force * normal).sum(axis=1)
    for index in np.flatnonzero(closed <= CLOSED * np.abs(closed).max())[:1]:
        raise _open_contact(truss, int(index))
    rows = []
    for index, joint in enumerate(revolutes):
        friction = guides[np.flatnonzero(joint_of == joint)[1]]
        left = np.array([-normal[index][1], normal[index][0]])
        rows.append(friction - csr_matrix(left[None]) @ pins[2 * index:2 * index + 2])
    return force, vstack(rows).tocsr()
