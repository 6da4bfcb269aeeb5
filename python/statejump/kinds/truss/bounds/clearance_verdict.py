# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether joints of a truss with clearance revolutes slip or settle within a temperature range: an estimate.

About the start of the case, where all joints stick, contact forces λ and friction f are linear in the temperatures T
and in the slips p. By Melan's program, joints settle up to the factor

    η = max {η : |f| <= μ λ for all T, (λ, f) = (λ0, f0) + η (N, F) T + M p}.

With friction limits that depend on contact forces this is necessary, not sufficient (Klarbring, Ciavarella, Barber,
Int. J. Solids Struct. 44 (2007) 8355). With the least contact forces of all states, μ λ_min, it is sufficient in the
linear truss. Neither is ever called certified.
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, nan
from typing import Any

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import block_diag, bmat, diags, vstack
from scipy.sparse.linalg import lsqr, splu

from statejump import _engine
from statejump.core.engine_failures import EngineFailed
from statejump.kinds.truss.bounds.clearance import pins_of
from statejump.kinds.truss.bounds.ranges import Temperatures, Verdict
from statejump.kinds.truss.bounds.simulated import Repeated
from statejump.kinds.truss.bounds.sliding import Joint
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import engine_items

BALANCED = 1e-6  # relative residual of the forces at the start
MOST = 1e6  # of the factor
ESTIMATE = "estimate, not certified: contact forces and friction are coupled"


@dataclass(frozen=True)
class Stuck:
    """Contact forces and friction of a truss whose joints stick, revolutes first.

    :param normal_N: λ0 (m,); ``friction_N``: f0 (m + k,)
    :param normal_by_K: N (m, variables); ``friction_by_K``: F (m + k, variables)
    :param normal_by_slip: rows of M (m, m + k); ``friction_by_slip``: rows of M (m + k, m + k)
    """

    joints: list[Joint]
    coefficient: np.ndarray
    limit_N: np.ndarray
    normal_N: np.ndarray
    friction_N: np.ndarray
    normal_by_K: np.ndarray
    friction_by_K: np.ndarray
    normal_by_slip: np.ndarray
    friction_by_slip: np.ndarray

    def rows(self, least_N: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return g0, g by T and g by p of |f| − μ λ, twice for each joint: slip is excluded if all g <= 0.

        :param least_N: contact forces in place of λ
        """
        count, others = len(self.coefficient), len(self.limit_N)
        made = []
        for sign in (1.0, -1.0):
            start, heat, slip = sign * self.friction_N, sign * self.friction_by_K, sign * self.friction_by_slip
            if least_N is None:
                start[:count] -= self.coefficient * self.normal_N
                heat[:count] -= self.coefficient[:, None] * self.normal_by_K
                slip[:count] -= self.coefficient[:, None] * self.normal_by_slip
            else:
                start[:count] -= self.coefficient * least_N
            start[count:count + others] -= self.limit_N
            made.append((start, heat, slip))
        return tuple(np.concatenate(one) for one in zip(*made))  # type: ignore[return-value]


def stuck(case: TrussCase, temperatures: Temperatures) -> Stuck | str:
    """Return the linear truss about the start of a case; text: why there is none."""
    truss = case.resolve()
    named = [Joint(section, name) for section in _engine.truss_joints() for name in truss.joints[section].names]
    try:
        found = _engine.truss_friction_free(**engine_items(truss), start_friction=truss.start_friction)
    except _engine.EngineFailure as failure:
        raise EngineFailed(failure, case=truss.name, place=truss.name) from None
    revolutes = [index for index, joint in enumerate(named) if joint.section == "revolute"]
    others = [index for index, joint in enumerate(named) if joint.section not in ("revolute", "rigid")]
    joint_of, guides, slides = found["guide_joint"], found["guides"].tocsr(), found["slides"].tocsr()
    count, size = len(revolutes), found["stiffness_N_per_m"].shape[0]
    along = [np.flatnonzero(joint_of == index)[1] for index in revolutes]
    rest = guides[~np.isin(np.arange(guides.shape[0]), along)]
    rest = rest[np.diff(rest.indptr) > 0]
    rows = vstack([slides[revolutes], guides[along], slides[others], rest]).tocsc()
    start = lsqr(rows.T, found["load_N"], atol=1e-14, btol=1e-14)[0]
    off = np.abs(rows.T @ start - found["load_N"]).max(initial=0.0)
    if off > BALANCED * np.abs(found["load_N"]).max(initial=1e-300):
        return "the contact forces of the start are not determined"
    normal = start[:count]
    if np.any(normal <= 0):
        return f"{named[revolutes[int(normal.argmin())]]} is open at the start"
    compliance = np.concatenate((*_contacts(truss, normal), 1 / found["sticking_stiffness_N_per_m"][others],
                                 np.zeros(rest.shape[0])))
    stiffness = found["stiffness_N_per_m"] + _rolling(truss, found, normal)
    scale = np.abs(stiffness.diagonal()).max()
    whole = bmat([[stiffness / scale, rows.T], [rows, -scale * diags(compliance + 1e-13 / scale)]],
                 format="csc")
    slips, joints = count + len(others), rows.shape[0]
    right = np.zeros((size + joints, temperatures.of_elements.shape[1] + slips))
    right[:size, :-slips] = found["heating_N_per_K"] @ temperatures.of_elements / scale
    right[size + count + np.arange(slips), right.shape[1] - slips + np.arange(slips)] = 1.0
    by = scale * splu(whole).solve(right)[size:size + count + slips]
    return Stuck([named[index] for index in (*revolutes, *others)], np.asarray(truss.revolutes.friction_coefficient),
                 found["friction_limit_N"][others], normal, start[count:count + slips], by[:count, :-slips],
                 by[count:, :-slips], by[:count, -slips:], by[count:, -slips:])


def _rolling(truss: ResolvedTruss, found: Any, normal_N: np.ndarray) -> Any:
    """Return the stiffness of contact forces that change their direction as contacts move around their bearings."""
    pins, shift = pins_of(truss, found)
    size = np.linalg.norm(shift, axis=1)
    left = np.stack((-shift[:, 1], shift[:, 0]), axis=1) / size[:, None]
    across = block_diag(list(left[:, None])) @ pins
    return across.T @ diags(normal_N / size) @ across


def _contacts(truss: ResolvedTruss, normal_N: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the compliances [m/N] of revolutes along and across their normals."""
    (kind,) = (joint for joint in JOINTS if joint.section == "revolute")
    arrays = kind.engine_arrays(truss, truss.revolutes)
    hertz, mindlin = (np.asarray(arrays[f"{name}_stiffness_N_per_m15"]) for name in ("hertz", "mindlin"))
    depth = (normal_N / hertz) ** (2 / 3)
    along = np.where(np.isinf(hertz), 0.0, 2 / 3 * depth / normal_N)
    across = np.divide(1.0, mindlin * np.sqrt(depth), out=np.zeros_like(depth), where=np.isfinite(mindlin))
    return along, across


def settling(of: Stuck, temperatures: Temperatures, least_N: np.ndarray | None = None, slips: bool = True
             ) -> tuple[float, str]:
    """Return the factor η on the temperature range, and the joint that limits it.

    :param least_N: contact forces in place of λ; ``slips``: whether joints may slip first
    """
    start, heat, slip = of.rows(least_N)
    need = np.maximum(heat * temperatures.lowest_K, heat * temperatures.highest_K).sum(axis=1)
    rest = np.zeros(len(start))
    if slips:
        size = np.abs(slip).max(initial=1e-300)
        found = linprog(np.append(-1.0, np.zeros(slip.shape[1])), A_ub=np.column_stack((need, slip / size)) / (
            np.abs(start).max(initial=1e-300)), b_ub=-start / np.abs(start).max(initial=1e-300),
            bounds=[(0.0, MOST), *[(None, None)] * slip.shape[1]], method="highs")
        if found.status != 0:
            return 0.0, str(of.joints[int((start + need).argmax()) % len(of.joints)])
        rest = slip @ found.x[1:] / size
    room = -start - rest
    factors = np.divide(room, need, out=np.full(len(room), inf), where=need > 1e-12 * np.abs(need).max(initial=1e-300))
    worst = int(factors.argmin())
    return max(0.0, float(factors[worst])), str(of.joints[worst % len(of.joints)])


def verdict_of_clearance(case: TrussCase, temperatures: Temperatures, least_N: np.ndarray | None,
                         repeated: Repeated | None) -> Verdict:
    """Return the estimate of whether joints slip within a temperature range.

    :param least_N: least contact forces over all states of the range; None: not known
    :param repeated: cycles of the case, simulated
    """
    of = stuck(case, temperatures)
    seen = "" if repeated is None else f"; {repeated.text}"
    drift = nan if repeated is None else repeated.drift_m
    if isinstance(of, str):
        return Verdict("unknown", f"not certified: {of}{seen}", drift_m=drift, certified=False)
    return replace(judged(of, temperatures, least_N, seen), drift_m=drift)


def judged(of: Stuck, temperatures: Temperatures, least_N: np.ndarray | None, seen: str = "") -> Verdict:
    """Return the verdict on joints that stick at the start. ``seen``: what a simulation shows."""
    count = len(of.joints)
    holds, first = settling(of, temperatures, slips=False)
    if holds >= 1:
        return Verdict("never_slips", f"never slips ({ESTIMATE}); factor {holds:.4g} to the first slip, set by {first}"
                       f"{seen}", holds, first, np.zeros(count, dtype=bool), certified=False)
    factor, limiting = settling(of, temperatures)
    said = f"factor {factor:.4g} to the limit of settling, set by {limiting}"
    if factor < 1:
        return Verdict("repeats", f"rubs in every cycle ({ESTIMATE}); {said}{seen}", factor, limiting,
                       certified=False)
    if least_N is not None and settling(of, temperatures, least_N)[0] >= 1:
        return Verdict("settles", f"settles ({ESTIMATE}), also with the least contact forces; {said}{seen}", factor,
                       limiting, certified=False)
    return Verdict("unknown", f"not certified: a settled state exists, but some starts may slip for ever; {said}{seen}",
                   factor, limiting, certified=False)
