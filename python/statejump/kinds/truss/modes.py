# SPDX-License-Identifier: GPL-3.0-or-later
"""Natural frequencies and mode shapes of a truss about the equilibrium in which its path begins, every joint held."""
from __future__ import annotations

from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import eigh, null_space
from scipy.sparse import bmat, csr_matrix, identity, vstack
from scipy.sparse.linalg import LinearOperator, eigsh, lsqr, splu

from statejump import _engine
from statejump.core.engine_failures import EngineFailed
from statejump.core.errors import Range, StatejumpError
from statejump.core.figures import save
from statejump.core.tables import Shown, write_csv
from statejump.kinds.truss.body_modes import with_modes
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.draw_modes import draw_modes
from statejump.kinds.truss.free_motion import held
from statejump.kinds.truss.motion import inertia
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import engine_items
from statejump.schema.rules import WHOLE, Rule

AXES = "xyz"
COUNT = Rule(WHOLE, allowed=Range(1, 1000))
# The stiffness of a slender truss is nearly singular. This fraction of the mean stiffness over the mean mass keeps the
# factors regular; it is subtracted from the squares of the frequencies found, so that they do not depend on it.
SHIFT = 1e-9
COMPLIANCE = 1e-12
TWIST = 1e-9  # displacement over rotation times size below which a mode is torsion only
SUPPORT = 1e-6  # fraction of the largest coefficient of a constraint, for a rigid motion that it prevents
DENSE = 300  # dofs up to which all modes are computed


@dataclass(frozen=True)
class Modes:
    """Modes of a truss, in ascending frequency.

    :param frequency_Hz: (modes,)
    :param displacement: displacements of nodes (modes, nodes, 3), the largest of a mode is 1; about 0 in torsion, whose
        largest rotation is 1
    :param rotation_per_m: rotation vectors [rad] of nodes per metre of the largest displacement (modes, nodes, 3)
    :param effective_mass_kg: mass (modes, 3) that a mode moves with the ground along x, y, z; sums to the moving mass
    :param mass_kg: moving mass along x, y, z
    """

    truss: ResolvedTruss
    frequency_Hz: np.ndarray
    displacement: np.ndarray
    rotation_per_m: np.ndarray
    effective_mass_kg: np.ndarray
    mass_kg: np.ndarray

    def summary_lines(self) -> list[Shown | str]:
        """Return the table of the modes."""
        dimension = self.truss.dimension
        rows = []
        for number, frequency in enumerate(self.frequency_Hz):
            share = self.effective_mass_kg[number] / np.where(self.mass_kg > 0, self.mass_kg, 1.0)
            node = int(np.linalg.norm(self.displacement[number], axis=1).argmax())
            rows.append([str(number + 1), f"{frequency:.6g}", self.truss.nodes.names[node],
                         *(f"{100 * value:.1f}" for value in share[:dimension])])
        header = ["mode", "frequency [Hz]", "most moved node", *(f"mass along {axis} [%]" for axis in AXES[:dimension])]
        return [Shown(f"modes of {self.truss.name}, every joint held", header, rows, left=("most moved node",))]

    def write(self, folder: Path) -> list[Path]:
        """Write the frequencies, the shapes and a picture of the first modes; return the paths."""
        axes = AXES[: self.truss.dimension]
        table = write_csv(
            folder / "modes.csv", ("mode", "frequency_Hz", *(f"effective_mass_{axis}_kg" for axis in axes)),
            ((number + 1, frequency, *masses[: len(axes)])
             for number, (frequency, masses) in enumerate(zip(self.frequency_Hz, self.effective_mass_kg))))
        shapes = write_csv(
            folder / "mode_shapes.csv", ("mode", "node", *(f"displacement_{axis}" for axis in AXES),
                                         *(f"rotation_{axis}_rad_per_m" for axis in AXES)),
            ((number + 1, name, *moved, *turned)
             for number, shape in enumerate(zip(self.displacement, self.rotation_per_m))
             for name, moved, turned in zip(self.truss.nodes.names, *shape)))
        figure = draw_modes(self.truss, self.frequency_Hz, self.displacement, self.rotation_per_m)
        return [table, shapes, *save(figure, folder, "modes")]


def modes(case: TrussCase, count: int = 6) -> Modes:
    """Return the lowest modes of a truss.

    :param count: number of modes; all, if the truss has fewer
    :raises StatejumpError: no part has a mass
    :raises EngineFailed: the truss has no equilibrium
    """
    COUNT.check("count", count)
    truss = case.resolve()
    supported = held(case)
    found = _linearised(supported.case)
    stiffness, mass = found["stiffness_N_per_m"].tocsc(), found["mass_kg"].tocsc()
    size, moving = stiffness.shape[0], int(np.count_nonzero(mass.diagonal()))
    if moving == 0:
        raise StatejumpError(code="no_moving_mass", case=truss.name)
    scale = stiffness.diagonal().sum() / mass.diagonal().sum()
    nodes, all_nodes = len(truss.nodes.names), len(supported.case.node)
    of_nodes = found["of_nodes"].tocsr()
    if len(supported.motions):
        squares, shapes = _lowest_free(found, min(count, moving), SHIFT * scale, supported.motions)
    else:
        squares, shapes = _lowest(found, min(count, moving), SHIFT * scale)
    frequency = np.sqrt(np.maximum(squares, 0.0)) / (2 * pi)
    moved = (of_nodes @ shapes).T.reshape(len(squares), -1, 3)
    displacement = moved[:, :nodes]
    rotation = moved[:, all_nodes:all_nodes + nodes] if moved.shape[1] > all_nodes else np.zeros_like(displacement)
    largest = np.abs(displacement).max(axis=(1, 2), keepdims=True)
    turned = np.abs(rotation).max(axis=(1, 2), keepdims=True)  # of torsion about the line of all nodes
    largest = np.where(largest > TWIST * turned * np.ptp(truss.nodes.position_m), largest, turned)
    effective, total = np.zeros((len(squares), 3)), np.zeros(3)
    for axis in range(3):
        rigid = _rigid(of_nodes[: 3 * all_nodes], axis, size)
        effective[:, axis] = (shapes.T @ (mass @ rigid)) ** 2
        total[axis] = rigid @ (mass @ rigid)
    return Modes(truss, frequency, displacement / largest, rotation / largest, effective, total)


def _linearised(case: TrussCase) -> dict[str, Any]:
    """Return stiffness, masses and constraints about the start. :raises EngineFailed: there is no equilibrium"""
    truss = case.resolve()
    try:
        found = dict(_engine.truss_linearised(**engine_items(truss), inertia=inertia(case),
                                              start_friction=truss.start_friction))
    except _engine.EngineFailure as failure:
        raise EngineFailed(failure, case=truss.name, place=truss.name) from None
    return with_modes(found, truss)


def _lowest_free(found: dict[str, Any], count: int, shift: float,
                 motions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the same of a free truss without its added supports, which are the constraints that prevent its rigid
    motions. These are its first modes; the momentum of the others in them is zero.

    :param motions: of the nodes, see :class:`~statejump.kinds.truss.free_motion.HeldTruss`
    """
    of_nodes, mass = found["of_nodes"], found["mass_kg"]
    fields = np.moveaxis(motions, 2, 1).reshape(len(motions), -1)[:, : of_nodes.shape[0]]
    rigid = np.stack([lsqr(of_nodes, field, atol=1e-14, btol=1e-14)[0] for field in fields], axis=1)
    own = found["constraints"].tocsr()
    prevents = np.abs(own @ rigid).max(axis=1) > SUPPORT * np.abs(own).max(axis=1).toarray().ravel()
    sizes, axes = eigh(rigid.T @ (mass @ rigid))
    rigid = rigid @ (axes / np.sqrt(sizes))
    constraints = vstack([own[~prevents], csr_matrix((mass @ rigid).T)])
    left = min(count, mass.shape[0]) - len(motions)
    zero = np.zeros(min(count, len(motions)))
    if left <= 0:
        return zero, rigid[:, :count]
    squares, shapes = _lowest({**found, "constraints": constraints}, left, shift)
    return np.append(zero, squares), np.hstack((rigid, shapes))


def _lowest(found: Any, count: int, shift: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest squares of angular frequencies [1/s²], ascending, and their shapes with unit modal mass."""
    stiffness, mass, constraints = found["stiffness_N_per_m"], found["mass_kg"], found["constraints"].tocsr()
    constraints = constraints[np.diff(constraints.indptr) > 0]
    size = stiffness.shape[0]
    if size <= DENSE:
        # Also for a singular mass matrix: M x = μ (K + shift M) x with μ = 1/(ω² + shift).
        free = null_space(constraints.toarray()) if constraints.shape[0] else np.eye(size)
        inverse, shapes = eigh(free.T @ mass @ free, free.T @ (stiffness + shift * mass) @ free)
        some = inverse > np.finfo(float).eps * inverse[-1]
        squares, shapes = 1 / inverse[some][::-1] - shift, free @ shapes[:, some][:, ::-1]
        return squares[:count], shapes[:, :count] / np.sqrt(_modal(shapes, mass)[:count])
    factors = _Constrained(stiffness + shift * mass, constraints)
    start = factors(np.random.default_rng(0).standard_normal(size))
    squares, shapes = eigsh(stiffness, k=count, M=mass, sigma=-shift, which="LM", v0=start,
                            OPinv=LinearOperator((size, size), matvec=factors, dtype=float))
    order = np.argsort(squares)
    shapes = shapes[:, order]
    return squares[order], shapes / np.sqrt(_modal(shapes, mass))


def _modal(shapes: np.ndarray, mass: Any) -> np.ndarray:
    return np.asarray(np.einsum("im,im->m", shapes, mass @ shapes))


class _Constrained:
    """Solves K x + Cᵀλ = b, C x = 0 for many b.

    A constraint that depends on others has a compliance of COMPLIANCE over the mean stiffness in place of zero.
    """

    def __init__(self, stiffness: Any, constraints: Any) -> None:
        self.size, scale = stiffness.shape[0], stiffness.diagonal().mean()
        rows = constraints.shape[0]
        self.factor = splu(bmat([[stiffness / scale, constraints.T],
                                 [constraints, -COMPLIANCE * identity(rows)]], format="csc") if rows
                           else (stiffness / scale).tocsc())
        self.scale, self.rows = scale, rows

    def __call__(self, right: np.ndarray) -> np.ndarray:
        whole = np.concatenate((right.ravel() / self.scale, np.zeros(self.rows)))
        return np.asarray(self.factor.solve(whole)[: self.size])


def _rigid(of_nodes: Any, axis: int, size: int) -> np.ndarray:
    """Return the dofs whose displacements are closest to a translation of all nodes along an axis by 1."""
    wanted = np.zeros(of_nodes.shape[0])
    wanted[axis::3] = 1.0
    return np.asarray(lsqr(of_nodes, wanted, atol=1e-14, btol=1e-14)[0]) if size else np.zeros(0)
