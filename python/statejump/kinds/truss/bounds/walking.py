# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses with motions that friction alone holds: what may ratchet, and up to which temperatures nothing does.

Notation as in :mod:`statejump.kinds.truss.bounds.sliding`; V spans the mechanisms, K V = 0. Residual friction ρ of a
truss whose joints have slipped satisfies (B V)ᵀρ = 0. By Melan's theorem, joints settle if |λ0 + η θ(T) + ρ| <= f for
some ρ and η > 1, θ being the friction of joints that stick for ever.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, nan
from typing import Any

import numpy as np
from scipy.linalg import null_space

from statejump import _engine
from statejump.core.engine_failures import EngineFailed
from statejump.kinds.truss.bounds.outputs import Output, chosen
from statejump.kinds.truss.bounds.programs import Polytope
from statejump.kinds.truss.bounds.ranges import Temperatures, Verdict
from statejump.kinds.truss.bounds.result import Bound, Bounds
from statejump.kinds.truss.bounds.simulated import repeated, simulated
from statejump.kinds.truss.bounds.sliding import FREE, Joint, moved_nodes
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import engine_items

MOST_DOFS = 2000
ZERO = 1e-9  # relative size of sums that count as rounding
NEARLY = 1e-6  # of the factor


@dataclass(frozen=True)
class Walking:
    """Matrices of a truss about its start, where joints stick.

    :param load_N: r, carried by joints and guides at the start
    :param free: V (dofs, k)
    """

    truss: ResolvedTruss
    joints: Sequence[Joint]
    stiffness: np.ndarray
    guides: np.ndarray
    slides: np.ndarray
    heating_N_per_K: Any
    of_nodes: Any
    load_N: np.ndarray
    limit_N: np.ndarray
    sticking_N_per_m: np.ndarray
    displacement_m: np.ndarray
    free: np.ndarray

    @cached_property
    def slid(self) -> np.ndarray:
        """B V (joints, k): slides of unit mechanisms, each of the size 1."""
        found = self.slides @ self.free
        return np.asarray(found / np.linalg.norm(found, axis=0))

    def start_N(self) -> np.ndarray | None:
        """Return the friction at the start; None: statics does not determine it."""
        matrix = np.hstack((self.slides.T, self.guides.T))
        held = np.linalg.matrix_rank(self.guides) if len(self.guides) else 0
        if np.linalg.matrix_rank(matrix) - held < len(self.slides):
            return None
        return np.asarray(np.linalg.lstsq(matrix, self.load_N, rcond=None)[0][:len(self.slides)])

    def stuck(self) -> np.ndarray:
        """Return the friction of joints that stick for ever by ΔT of the elements (joints, elements) [N/K]."""
        size, joints, guides = len(self.stiffness), len(self.slides), len(self.guides)
        scale = np.abs(np.diag(self.stiffness)).max()
        whole = np.zeros((size + joints + guides,) * 2)
        whole[:size, :size] = self.stiffness / scale
        whole[size:, :size] = np.vstack((self.slides, self.guides))
        whole[:size, size:] = whole[size:, :size].T
        index = size + np.arange(joints)
        whole[index, index] = -scale / self.sticking_N_per_m
        right = np.vstack((self.heating_N_per_K.toarray() / scale, np.zeros((joints + guides,
                                                                            self.heating_N_per_K.shape[1]))))
        found = np.linalg.lstsq(whole, right, rcond=None)[0]
        return np.asarray(scale * found[size:size + joints])

    def gains(self, rows: np.ndarray) -> np.ndarray:
        """Return E K⁺Bᵀ (m, joints) of outputs that mechanisms do not move."""
        size, guides, free = len(self.stiffness), self.guides, self.free
        scale = np.abs(np.diag(self.stiffness)).max()
        more = np.vstack((guides, free.T))
        whole = np.block([[self.stiffness / scale, more.T], [more, np.zeros((len(more),) * 2)]])
        right = np.vstack((self.slides.T / scale, np.zeros((len(more), len(self.slides)))))
        return np.asarray(rows @ np.linalg.lstsq(whole, right, rcond=None)[0][:size])


def walking(case: TrussCase) -> Walking | None:
    """Return the matrices of a truss with mechanisms that friction holds; None: it has none, or is too large.

    :raises StatejumpError: a mechanism moves no joint with friction
    """
    truss = case.resolve()
    named = [Joint(section, name) for section in _engine.truss_joints() for name in truss.joints[section].names]
    try:
        found = _engine.truss_friction_free(**engine_items(truss), start_friction=truss.start_friction)
    except _engine.EngineFailure as failure:
        raise EngineFailed(failure, case=truss.name, place=truss.name) from None
    friction = [index for index, joint in enumerate(named) if joint.section != "rigid"]
    limits = found["friction_limit_N"][friction]
    size = found["stiffness_N_per_m"].shape[0]
    if size > MOST_DOFS or np.isnan(limits).any() or truss.sliders.have_stops.any():
        return None
    stiffness, guides = found["stiffness_N_per_m"].toarray(), found["guides"].toarray()
    guides = guides[np.abs(guides).max(axis=1, initial=0.0) > 0]
    inside = null_space(guides) if len(guides) else np.eye(size)
    value, vector = np.linalg.eigh(inside.T @ stiffness @ inside)
    small = FREE * np.abs(np.diag(stiffness)).max() * size
    if not (np.abs(value) <= small).any() or value[0] < -small:
        return None
    free = inside @ vector[:, np.abs(value) <= small]
    slides = found["slides"].toarray()[friction] * (limits > 0)[:, None]
    if np.linalg.matrix_rank(slides @ free, tol=ZERO) < free.shape[1]:
        return None
    return Walking(truss, [named[index] for index in friction], stiffness, guides, slides, found["heating_N_per_K"],
                   found["of_nodes"].tocsr(), found["load_N"], limits,
                   found["sticking_stiffness_N_per_m"][friction], found["displacement_m"], free)


@dataclass(frozen=True)
class Shakedown:
    """Melan's program.

    :param factor: η; a state with this factor exists
    :param bound: no larger factor exists
    :param load: multipliers of the upper less those of the lower limits of the joints
    """

    factor: float
    bound: float
    load: np.ndarray
    alternates: bool


def shakedown(of: Walking, start_N: np.ndarray, lowest_N: np.ndarray, highest_N: np.ndarray) -> Shakedown:
    """Return the largest factor on the temperature range at which joints settle.

    :param lowest_N: least friction of joints that stick for ever, by temperature alone; ``highest_N``: largest
    """
    limit, count = of.limit_N, len(of.limit_N)
    change = highest_N - lowest_N
    scale = np.abs(change).max(initial=0.0)
    if not scale > ZERO * limit.max():
        return Shakedown(inf, inf, np.zeros(count), False)
    most = float(np.min(2 * limit[change > 0] / change[change > 0]))
    # Variables: η/most, ρ/f.
    rows = np.vstack((np.column_stack((most * highest_N, np.diag(limit))),
                      np.column_stack((most * lowest_N, np.diag(limit))),
                      np.column_stack((np.zeros(of.slid.shape[1]), of.slid.T * limit))))
    none = np.zeros(of.slid.shape[1])
    polytope = Polytope(rows, np.concatenate((np.full(count, -inf), -limit - start_N, none)),
                        np.concatenate((limit - start_N, np.full(count, inf), none)),
                        np.append(0.0, -1 - start_N / limit), np.append(1.0, 1 - start_N / limit))
    found = polytope.solved(np.append(1.0, np.zeros(count)))
    upper, lower = np.maximum(found.dual[:count], 0.0), np.maximum(-found.dual[count:2 * count], 0.0)
    factor = 0.0
    if found.x is not None:
        rest = found.x[1:] * limit
        rest = rest - of.slid @ np.linalg.lstsq(of.slid, rest, rcond=None)[0]
        need = np.concatenate((highest_N, -lowest_N))
        needs = need > ZERO * scale
        for fraction in (1.0, 1 - 1e-7, 1 - 1e-4):  # any residual friction serves, so rounding is stepped back from
            room = np.concatenate((limit - start_N - fraction * rest, limit + start_N + fraction * rest))
            if room.min() >= 0:
                factor = float(np.min(room[needs] / need[needs]))
                break
    load = upper - lower
    alternates = np.abs(load).max() <= NEARLY * (upper + lower).max(initial=1e-300) or found.bound >= 1 - NEARLY
    return Shakedown(max(factor, 0.0), most * found.bound, load, bool(alternates))


def verdict_of(of: Walking, case: TrussCase, temperatures: Temperatures, whole: bool) -> Verdict:
    """Return whether the truss settles, or may ratchet, within a temperature range."""
    partial = {joint.section for joint in JOINTS if joint.slips_in_part}
    for joint in of.joints:
        if joint.section in partial or of.truss.sticking == "partial_slip":
            return Verdict("unknown", f"{joint} slips partially in every cycle; whether the truss drifts is not known")
    start = of.start_N()
    if start is None:
        return Verdict("unknown", "statics does not determine how sticking joints share their force")
    stuck = of.stuck() @ temperatures.of_elements
    ends = np.sort(np.array([stuck * temperatures.lowest_K, stuck * temperatures.highest_K]), axis=0).sum(axis=2)
    if np.any(np.abs(start) > of.limit_N * (1 + ZERO)):
        return Verdict("unknown", "joints slip under the loads of the start")
    found = shakedown(of, np.clip(start, -of.limit_N, of.limit_N), *ends)
    way = of.free[:, 0]
    if not found.alternates:
        way = of.free @ np.linalg.lstsq(of.slides @ of.free, found.load, rcond=None)[0]
    _, mode = moved_nodes(of.truss, of.of_nodes, way)
    limiting = "" if not np.isfinite(found.factor) else str(of.joints[int(np.abs(found.load).argmax())])
    said = f"factor {found.factor:.4g} to the limit of settling"
    slips = None
    if np.all(ends[1] + start <= of.limit_N) and np.all(ends[0] + start >= -of.limit_N):
        return Verdict("never_slips", f"never slips; {said}", found.factor, limiting, np.zeros(len(start), dtype=bool))
    if found.factor >= 1:
        return Verdict("settles", f"settles: in the end no joint slips; {said}", found.factor, limiting, slips, mode)
    cycles = repeated(case) if whole else None
    drift = nan if cycles is None else cycles.drift_m
    shown = "" if np.isnan(drift) else f", {1e6 * drift:.6g} µm per cycle of the case, simulated"
    cause = " begins with alternating slip, which may not drift" if found.alternates else ""
    text = f"may ratchet: {mode} drifts{cause}{shown}; {said}"
    return Verdict("may_ratchet", text, found.factor, limiting, slips, mode, drift)


def bounds_of_walking(of: Walking, case: TrussCase, names: Sequence[str], temperatures: Temperatures,
                      simulate: bool | None) -> Bounds:
    """Return the bounds of a truss with mechanisms: infinite for outputs that they move."""
    count = len(of.truss.nodes.names)
    outputs = chosen(of, names, lambda: np.abs(of.of_nodes[:3 * count] @ of.free).sum(axis=1).reshape(count, 3))
    path = simulated(case, simulate)
    carried = (of.free.T @ of.load_N) / np.linalg.norm(of.slides @ of.free, axis=0)
    polytope = Polytope(of.slid.T * of.limit_N, carried, carried, -np.ones(len(of.limit_N)), np.ones(len(of.limit_N)))
    made = [_bound(of, output, polytope, path) for output in outputs]
    verdict = verdict_of(of, case, temperatures, len(path) > 1)
    why = "friction alone holds a motion; it is unbounded, other motions are bounded about the start of the case"
    return Bounds(of.truss, "A", "estimate", why, [], made, [str(joint) for joint in of.joints], of.limit_N, verdict,
                  temperatures, {})


def _bound(of: Walking, output: Output, polytope: Polytope, path_m: np.ndarray) -> Bound:
    rows = output.rows(of)
    simulated_ = nan if len(path_m) < 2 else output.change(path_m[0], path_m[-1])
    count = len(of.limit_N)
    if np.abs(rows @ of.free).max() > ZERO * np.abs(rows).max():
        return Bound(output, inf, inf, nan, inf, nan, nan, simulated_, nan, np.full(count, 1 / count), (nan, nan))
    gains = of.gains(rows) * of.limit_N
    widths = [polytope.highest_value(row) + polytope.highest_value(-row) for row in gains]
    spread = float(np.linalg.norm(widths))
    parts = np.abs(gains).sum(axis=0)
    return Bound(output, spread, spread if len(rows) == 1 else nan, nan, spread, nan, nan, simulated_, nan,
                 parts / (parts.sum() or 1.0), (nan, nan))
