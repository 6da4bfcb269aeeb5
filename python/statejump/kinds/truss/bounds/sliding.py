# SPDX-License-Identifier: GPL-3.0-or-later
"""A truss about its equilibrium without friction, every friction joint free to slide.

Notation: K q + Hᵀμ = G T − Bᵀλ, H q = 0, s = s0 + B q, |λ| <= f, see engine/include/statejump/truss/friction_free.hpp.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import bmat, csc_matrix, identity, vstack
from scipy.sparse.linalg import lsqr, splu

from statejump import _engine
from statejump.core.engine_failures import EngineFailed
from statejump.core.errors import StatejumpError
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.check_mechanism import check_at_rest
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import engine_items

AXES = "xyz"
COMPLIANCE = 1e-13  # of guides over the mean stiffness: dependent guides are permitted
SOFTER = 1e-6  # likewise, where pivots stay on the diagonal: their signs are those of the eigenvalues
FREE = 1e-13  # stiffness of a mode over that of the stiffest dof, below which the mode is free
ROUNDS = 5  # of inverse iteration
ROUNDED = 1e-10  # of the largest displacement by a unit force: rounding, 2e-16, times the condition number


@dataclass(frozen=True)
class Joint:
    """A friction joint: its section in the case, and its name."""

    section: str
    name: str

    def __str__(self) -> str:
        return f"{self.section} '{self.name}'"


class Factors:
    """Solves K q + Hᵀμ = b, H q = 0 for many b."""

    def __init__(self, stiffness: Any, guides: Any, compliance: float = COMPLIANCE, **options: Any) -> None:
        guides = guides.tocsr()
        guides = guides[np.diff(guides.indptr) > 0]
        self.size, self.rows, self.scale = stiffness.shape[0], guides.shape[0], np.abs(stiffness.diagonal()).mean()
        whole = (bmat([[stiffness / self.scale, guides.T], [guides, -compliance * identity(self.rows)]], format="csc")
                 if self.rows else csc_matrix(stiffness / self.scale))
        self.factor = splu(whole, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}, **options)

    @property
    def stable(self) -> bool:
        """Whether the stiffness is positive definite where guides permit motion (Sylvester's law of inertia)."""
        return int((self.factor.U.diagonal() < 0).sum()) <= self.rows

    def __call__(self, right: np.ndarray) -> np.ndarray:
        """Return the dofs for forces (n,) or (n, k)."""
        whole = np.zeros((self.size + self.rows, *right.shape[1:]))
        whole[:self.size] = right / self.scale
        return np.asarray(self.factor.solve(whole)[:self.size])


@dataclass(frozen=True)
class Sliding:
    """Matrices of a truss whose joints slide without friction.

    :param slides: B (joints, dofs)
    :param heating_N_per_K: G (dofs, elements), links first
    :param limit_N: f
    :param slide_m: s0, slides from the reference configuration
    :param sticking_N_per_m: stiffness with which joints begin to stick; inf: rigid
    :param full_slip_m: slide from zero friction to f without earlier slip
    :param radius_m: slide of a rotation by 1 rad
    :param displacement_m: displacements (nodes, 3) from the reference configuration
    :param load_N: r, carried by stops and guides
    """

    truss: ResolvedTruss
    joints: Sequence[Joint]
    stiffness: Any
    slides: Any
    heating_N_per_K: Any
    of_nodes: Any
    limit_N: np.ndarray
    slide_m: np.ndarray
    sticking_N_per_m: np.ndarray
    full_slip_m: np.ndarray
    radius_m: np.ndarray
    displacement_m: np.ndarray
    load_N: np.ndarray
    guides: Any
    solve: Factors

    def carried_N(self, which: Sequence[int]) -> np.ndarray:
        """Return the forces of the closed stops of joints at the equilibrium, against the slides."""
        rows = vstack([self.slides[list(which)], self.guides])
        return np.asarray(lsqr(rows.T, self.load_N, atol=1e-14, btol=1e-14)[0][:len(which)])

    @cached_property
    def by_friction(self) -> np.ndarray:
        """K⁻¹Bᵀ (dofs, joints), dense [m/N]."""
        return self.solve(self.slides.T.toarray())

    @cached_property
    def compliance(self) -> np.ndarray:
        """C = B K⁻¹Bᵀ (joints, joints) [m/N]."""
        found = self.slides @ self.by_friction
        return np.asarray(0.5 * (found + found.T))

    def gains_of(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return E K⁻¹Bᵀ (m, joints) [m/N] and E K⁻¹G (m, elements) [m/K] of an output E q, with rows (m, dofs).

        Gains by temperature that are rounding of the solution are 0.
        """
        adjoint = self.solve(rows.T)
        thermal = np.asarray((self.heating_N_per_K.T @ adjoint).T)
        largest = np.asarray(abs(self.heating_N_per_K).sum(axis=0)).ravel()
        thermal[np.abs(thermal) < ROUNDED * np.outer(np.abs(adjoint).max(axis=0, initial=0.0), largest)] = 0.0
        return np.asarray((self.slides @ adjoint).T), thermal


def sliding(case: TrussCase) -> Sliding:
    """Return the matrices of a case.

    :raises StatejumpError: a link is driven, a joint has clearance, or only friction holds nodes
    :raises EngineFailed: the truss has no equilibrium without friction
    """
    truss = case.resolve()
    check_at_rest(truss)
    named = [Joint(section, name) for section in _engine.truss_joints() for name in truss.joints[section].names]
    try:
        found = _engine.truss_friction_free(**engine_items(truss))
    except _engine.EngineFailure as failure:
        raise EngineFailed(failure, case=truss.name, place=truss.name) from None
    friction = [index for index, joint in enumerate(named) if joint.section != "rigid"]
    limits = found["friction_limit_N"]
    for index in friction:
        if np.isnan(limits[index]):
            (kind,) = (joint for joint in JOINTS if joint.section == named[index].section)
            code = kind.bounds_code or "bounds_of_clearance"
            raise StatejumpError(code=code, place=truss.name, case=truss.name, joint_with_clearance=str(named[index]))
    stiffness, guides = _stiffness(truss, named, found), found["guides"]
    check_stable(truss, stiffness, guides, found["of_nodes"].tocsr())
    of_joints = {key: found[name][friction] for key, name in (
        ("limit_N", "friction_limit_N"), ("slide_m", "slide_m"), ("full_slip_m", "full_slip_m"),
        ("sticking_N_per_m", "sticking_stiffness_N_per_m"), ("radius_m", "radius_m"))}
    return Sliding(
        truss=truss, joints=[named[index] for index in friction], stiffness=stiffness,
        slides=found["slides"].tocsr()[friction], heating_N_per_K=found["heating_N_per_K"].tocsc(),
        of_nodes=found["of_nodes"].tocsr(), displacement_m=found["displacement_m"], load_N=found["load_N"],
        guides=guides,
        solve=Factors(stiffness, guides), **of_joints)


def _stiffness(truss: ResolvedTruss, named: Sequence[Joint], found: dict[str, Any]) -> Any:
    """Return K without the plays of sliders, which the engine models by a negative stiffness about their middles.

    This also takes the forces of these springs off the friction limits in ``found``.
    """
    stiffness = found["stiffness_N_per_m"].tocsc()
    which = [index for index, joint in enumerate(named) if joint.section == "slider"]
    for number in np.flatnonzero(truss.sliders.play_m > 0):
        row = found["slides"].tocsr()[which[number]]
        stiffness = stiffness + found["sticking_stiffness_N_per_m"][which[number]] * (row.T @ row)
        found["friction_limit_N"][which[number]] = truss.sliders.friction_limit_N[number]
    return stiffness.tocsc()


def check_stable(truss: ResolvedTruss, stiffness: Any, guides: Any, of_nodes: Any) -> None:
    """Raise StatejumpError if a truss has a mechanism, or a negative stiffness, where guides permit motion."""
    _refuse_mechanism(truss, stiffness, guides, of_nodes)
    if not Factors(stiffness, guides, SOFTER, diag_pivot_thresh=0.0).stable:
        raise StatejumpError(code="bounds_of_unstable", place=truss.name, case=truss.name)


def _refuse_mechanism(truss: ResolvedTruss, stiffness: Any, guides: Any, of_nodes: Any) -> None:
    """Raise StatejumpError if a motion of the truss without friction has no stiffness."""
    size = stiffness.shape[0]
    if size == 0:
        raise StatejumpError(code="no_free_dof", place=truss.name, case=truss.name)
    stiffest = float(stiffness.diagonal().max())
    shifted = Factors(stiffness + 0.05 * FREE * stiffest * identity(size), guides)
    shape = np.random.default_rng(0).standard_normal(size)
    for _ in range(ROUNDS):
        shape = shifted(shape)
        shape /= np.linalg.norm(shape)
    if abs(shape @ (stiffness @ shape)) > FREE * stiffest:
        return
    nodes, mode = moved_nodes(truss, of_nodes, shape)
    raise StatejumpError(code="bounds_of_mechanism", place=truss.name, case=truss.name, nodes=nodes, mode=mode)


def moved_nodes(truss: ResolvedTruss, of_nodes: Any, shape: np.ndarray) -> tuple[list[str], str]:
    """Return the names of the nodes that a motion moves most, and the motion as text."""
    moved = (of_nodes @ shape)[:3 * len(truss.nodes.names)].reshape(-1, 3)
    most = np.argsort(-np.linalg.norm(moved, axis=1), kind="stable")[:3]
    nodes = [truss.nodes.names[node] for node in most if np.linalg.norm(moved[node]) > 0.1 * np.abs(moved).max()]
    return nodes, ", ".join(f"{truss.nodes.names[node]} ({AXES[int(np.abs(moved[node]).argmax())]})"
                            for node in most if truss.nodes.names[node] in nodes)
