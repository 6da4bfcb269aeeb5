# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of a condensed body as for Craig–Bampton models: rigid motions, mass, frequencies, free expansion."""
from __future__ import annotations

from typing import Any

import attrs
import numpy as np
from numpy.typing import NDArray

from statejump.bodies.body import CondensedBody
from statejump.bodies.checks import scales
from statejump.core import libraries
from statejump.core.tables import Shown

Matrix = NDArray[np.float64]

FREQUENCIES = 10  # number of frequencies that are listed
RIGID_HZ = 1e-3  # largest ratio of a rigid frequency to the first elastic one


@attrs.frozen
class Row:
    """A quantity of a body.

    :param bound: largest allowed magnitude; None: the quantity is information
    """

    name: str
    value: float
    unit: str
    bound: float | None = None

    @property
    def passed(self) -> bool:
        """Whether the magnitude is within the bound."""
        return self.bound is None or abs(self.value) <= self.bound


@attrs.frozen(eq=False)
class BodyCheck:
    """Quantities of a body.

    :param free_Hz: frequencies of the free body; the rigid ones first
    :param free_shapes: dofs (N, modes) of its elastic modes
    :param fixed_Hz: frequencies with held interface nodes
    """

    body: CondensedBody
    rows: tuple[Row, ...]
    free_Hz: Matrix
    free_shapes: Matrix
    fixed_Hz: Matrix

    @property
    def passed(self) -> bool:
        """Whether all quantities are within their bounds."""
        return all(row.passed for row in self.rows)

    def frame(self) -> Any:
        """Return the quantities as a table of pandas."""
        return libraries.frame([(row.name, row.value, row.unit, row.bound, row.passed) for row in self.rows],
                               ["quantity", "value", "unit", "bound", "passed"])

    def tables(self) -> list[Shown]:
        """Return tables for people."""
        rows = [(row.name, f"{row.value:.6g}", row.unit, "" if row.bound is None else f"{row.bound:g}",
                 "" if row.bound is None else "pass" if row.passed else "MISSED") for row in self.rows]
        found = [Shown(f"Body of {len(self.body.node_names)} nodes, {self.body.interface_dofs} dofs, "
                       f"{self.body.modes} modes", ("quantity", "value", "unit", "bound", ""), rows,
                       ("quantity", "unit", ""))]
        if len(self.free_Hz) or len(self.fixed_Hz):
            count = min(FREQUENCIES, max(len(self.free_Hz), len(self.fixed_Hz)))
            lines = [(str(k + 1), *(f"{given[k]:.6g}" if k < len(given) else ""
                                    for given in (self.free_Hz, self.fixed_Hz))) for k in range(count)]
            found.append(Shown("Frequencies [Hz]", ("number", "free", "nodes held"), lines))
        return found


def check(body: CondensedBody) -> BodyCheck:
    """Return the checks of a body."""
    measured = body.measured
    rows = [Row("asymmetry of the stiffness", measured.asymmetry, "-", 1e-9),
            Row("force of rigid motions", measured.rigid_error, "-", 1e-9),
            Row("digits of the stiffness", measured.digits, "-"),
            Row("lowest eigenvalue / largest", measured.lowest_eigenvalue, "-", 1e-12)]
    if measured.softest is not None:
        rows.append(Row("softest elastic eigenvalue / largest", measured.softest, "-"))
    rows.append(Row("motions without stiffness beside rigid ones", measured.free_motions, "-", 0.0))
    if measured.load_resultant is not None:
        rows.append(Row("resultant of thermal loads", measured.load_resultant, "-", 1e-9))
    frequencies, shapes, fixed = np.zeros(0), np.zeros((len(body.stiffness), 0)), np.zeros(0)
    if body.mass is not None:
        rows += _mass_rows(body)
        frequencies, shapes, rigid = _free(body)
        fixed = _fixed(body)
        if len(frequencies) > rigid:
            rows.append(Row("largest rigid frequency / first elastic",
                            float(frequencies[:rigid].max(initial=0.0) / frequencies[rigid]), "-", RIGID_HZ))
        shapes = shapes[:, rigid:]
    for place, name in enumerate(body.pattern_names):
        rows += _expansion_rows(body, name, body.free_shapes[place])
    return BodyCheck(body, tuple(rows), frequencies, shapes, fixed)


def _mass_rows(body: CondensedBody) -> list[Row]:
    assert body.mass is not None
    motions = body.rigid_motions
    block = motions.T @ body.mass @ motions
    mass = float(np.trace(block[:3, :3])) / 3
    if mass <= 0:
        return [Row("mass", mass, "kg")]
    # Coupling of translations and rotations is m times the cross matrix of the centre.
    centre = np.array([block[2, 4] - block[1, 5], block[0, 5] - block[2, 3], block[1, 3] - block[0, 4]]) / (-2 * mass)
    inertia = block[3:, 3:] - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    found = [Row("mass", mass, "kg"),
             Row("difference of mass between directions", body.measured.mass_error or 0.0, "-", 1e-6)]
    found += [Row(f"centre of mass {axis}", float(value), "m") for axis, value in zip("xyz", centre)]
    found += [Row(f"moment of inertia {axis}{axis} about it", float(inertia[k, k]), "kg m2")
              for k, axis in enumerate("xyz")]
    if body.modes:
        first = body.interface_dofs
        coupling = body.mass[first:] @ motions[:, :3] / np.sqrt(np.diag(body.mass)[first:, None])
        effective = (coupling**2).sum(axis=0) / mass
        found += [Row(f"effective mass of the modes {axis} / mass", float(value), "-")
                  for axis, value in zip("xyz", effective)]
    return found


def _eigen(stiffness: Matrix, mass: Matrix) -> tuple[Matrix, Matrix]:
    """Return frequencies [Hz] and shapes of dofs that have mass. Dofs without mass follow statically."""
    scale = 1 / np.sqrt(np.maximum(np.diag(stiffness), 1e-12 * np.diag(stiffness).max(initial=1.0)))
    values, vectors = np.linalg.eigh(mass * np.outer(scale, scale))
    massive = vectors[:, values > 1e-14 * values[-1]] * scale[:, None]
    light = vectors[:, values <= 1e-14 * values[-1]] * scale[:, None]
    if light.shape[1]:
        follow = np.linalg.lstsq(light.T @ stiffness @ light, light.T @ stiffness @ massive, rcond=None)[0]
        massive = massive - light @ follow
    squares, shapes = libraries.scipy("linalg").eigh(massive.T @ stiffness @ massive, massive.T @ mass @ massive)
    return np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi), massive @ shapes


def _free(body: CondensedBody) -> tuple[Matrix, Matrix, int]:
    """Return frequencies and shapes of the free body, and the number of rigid motions."""
    assert body.mass is not None
    frequencies, shapes = _eigen(body.stiffness, body.mass)
    motions = body.rigid_motions / scales(body.node_positions_m, body.node_freedoms, body.stiffness)[:, None]
    rank = int(np.linalg.matrix_rank(motions, 1e-9 * np.abs(motions).max()))
    return frequencies, shapes, min(rank + body.measured.free_motions, len(frequencies))


def _fixed(body: CondensedBody) -> Matrix:
    assert body.mass is not None
    first = body.interface_dofs
    if not body.modes:
        return np.zeros(0)
    return _eigen(body.stiffness[first:, first:], body.mass[first:, first:])[0]


def _expansion_rows(body: CondensedBody, name: str, shape: Matrix) -> list[Row]:
    """Return the apparent expansion of a free shape, what is no expansion, and the force of the free body."""
    force = np.abs(body.stiffness @ (body.rigid_motions @ np.linalg.lstsq(body.rigid_motions, shape, rcond=None)[0]))
    held = np.abs((body.stiffness @ shape) * scales(body.node_positions_m, body.node_freedoms, body.stiffness))
    arms = body.node_positions_m - body.node_positions_m.mean(axis=0)
    grown = np.concatenate([np.concatenate([arm, np.zeros(dofs - 3)]) for arm, dofs in zip(arms, body.node_freedoms)])
    columns = np.column_stack([body.rigid_motions[:body.interface_dofs], grown])
    factors = np.linalg.lstsq(columns, shape[:body.interface_dofs], rcond=None)[0]
    left = shape[:body.interface_dofs] - columns @ factors
    moved = np.concatenate([left[start:start + 3] for start in body.node_starts])
    return [Row(f"{name}: apparent expansion", float(factors[-1]), "1/K"),
            Row(f"{name}: largest other displacement", float(np.abs(moved).max()), "m/K"),
            Row(f"{name}: largest force of the held body", float(held.max(initial=0.0)), "N/K"),
            Row(f"{name}: largest force of its rigid part", float(force.max(initial=0.0)), "N/K", 1e-6)]
