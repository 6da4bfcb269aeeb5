# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of the matrices of a condensed body: symmetry, rigid motions, definiteness, resultants of loads.

All errors are relative to the largest entry. Rotations are scaled by the radius of the nodes about their centre, and
modes such that their stiffness is the largest stiffness of the interface.
"""
from __future__ import annotations

from collections.abc import Sequence

import attrs
import numpy as np
from numpy.typing import NDArray

from statejump.bodies.causes import cause_of
from statejump.core.errors import StatejumpError
from statejump.core.notes import Note

Matrix = NDArray[np.float64]

# Largest relative error of a matrix that is used: a wrong coordinate system gives 0.1, seven digits 1e-6.
REFUSED = 1e-5
NOTED = 1e-9  # relative error that is reported; matrices in double precision have 1e-12
ROUNDING = 1e-13


@attrs.frozen
class Measured:
    """Errors of given matrices, relative to the largest entry, before they are symmetrised and projected.

    :param asymmetry: of the stiffness
    :param rigid_error: forces of unit rigid motions
    :param lowest_eigenvalue: lowest eigenvalue of the projected stiffness, over the largest
    :param softest: lowest eigenvalue of an elastic motion, over the largest; None: the body has none
    :param free_motions: number of motions without stiffness, beside rigid motions
    :param load_resultant: resultant of thermal loads; None: none are given
    :param mass_asymmetry: of the mass; None: no mass is given
    :param mass_error: difference between the mass of translations and a multiple of the unit matrix
    :param mass_kg: mass of the body [kg]
    :param notes: warnings
    """

    asymmetry: float
    rigid_error: float
    lowest_eigenvalue: float
    softest: float | None
    free_motions: int
    load_resultant: float | None = None
    mass_asymmetry: float | None = None
    mass_error: float | None = None
    mass_kg: float | None = None
    notes: tuple[Note, ...] = ()

    @property
    def digits(self) -> float:
        """Number of correct digits of the stiffness, from its rigid-body error and asymmetry."""
        return float(-np.log10(max(self.asymmetry, self.rigid_error, 1e-16)))


def rigid_motions(positions_m: Matrix, freedoms: NDArray[np.int64], modes: int = 0,
                  about_m: Matrix | None = None) -> Matrix:
    """Return the dofs (N, 6) of unit translations along, and unit rotations about, the axes through a point."""
    arms = positions_m if about_m is None else positions_m - about_m
    blocks = []
    for (x, y, z), dofs in zip(arms, freedoms):
        block = np.eye(6)
        block[:3, 3:] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]
        blocks.append(block[:dofs])
    return np.vstack([*blocks, np.zeros((modes, 6))])


def radius(positions_m: Matrix) -> float:
    """Return the largest distance of nodes from their centre [m]; 1 if they coincide up to rounding."""
    found = float(np.linalg.norm(positions_m - positions_m.mean(axis=0), axis=1).max())
    return found if found > 1e-12 * float(np.abs(positions_m).max(initial=0.0)) else 1.0


def scales(positions_m: Matrix, freedoms: NDArray[np.int64], stiffness: Matrix) -> Matrix:
    """Return the factor (N) of each dof that makes dofs comparable."""
    length = radius(positions_m)
    nodes = [np.array([1.0] * 3 + [1 / length] * 3)[:dofs] for dofs in freedoms]
    found = np.concatenate(nodes)
    own = np.abs(np.diag(stiffness))
    largest = float((own[:len(found)] * found**2).max(initial=0.0)) or 1.0
    modal = np.where(own[len(found):] > 0, own[len(found):], largest)
    return np.concatenate([found, np.sqrt(largest / modal)])


def scaled_rigid_motions(positions_m: Matrix, freedoms: NDArray[np.int64], scale: Matrix) -> Matrix:
    """Return an orthonormal basis of the scaled rigid motions."""
    motions = rigid_motions(positions_m, freedoms, len(scale) - int(freedoms.sum()), positions_m.mean(axis=0))
    left, size, _ = np.linalg.svd(motions / scale[:, None] * _units(positions_m), full_matrices=False)
    return np.asarray(left[:, size > 1e-9 * size.max(initial=0.0)])


def without_rigid_forces(scaled: Matrix, basis: Matrix) -> Matrix:
    """Return a scaled stiffness, symmetric and with the motions of a basis projected out."""
    scaled = scaled - basis @ (basis.T @ scaled)
    scaled = scaled - (scaled @ basis) @ basis.T
    return np.asarray((scaled + scaled.T) / 2)


def _units(positions_m: Matrix) -> Matrix:
    return np.array([1.0] * 3 + [1 / radius(positions_m)] * 3)


def checked_stiffness(
    given: Matrix, names: Sequence[str], positions_m: Matrix, freedoms: NDArray[np.int64]
) -> tuple[Matrix, Measured]:
    """Return the stiffness, symmetric and without forces of rigid motions, and the errors that it had.

    :raises StatejumpError: it is not that of a free linear body
    """
    scale = scales(positions_m, freedoms, given)
    scaled = given * np.outer(scale, scale)
    largest = float(np.abs(scaled).max(initial=0.0))
    if largest == 0:
        rigid = scaled_rigid_motions(positions_m, freedoms, scale).shape[1]
        return given, Measured(0.0, 0.0, 0.0, None, len(given) - rigid)
    asymmetry = float(np.abs(scaled - scaled.T).max()) / largest
    if asymmetry > REFUSED:
        one = not np.triu(scaled, 1).any() or not np.tril(scaled, -1).any()
        raise StatejumpError(code="body_triangle" if one else "body_not_symmetric", error=asymmetry)
    scaled = (scaled + scaled.T) / 2
    motions = rigid_motions(positions_m, freedoms, len(given) - int(freedoms.sum()), positions_m.mean(axis=0))
    rigid_error = float(np.abs(scaled @ (motions / scale[:, None] * _units(positions_m))).max()) / largest
    if rigid_error > REFUSED:
        code, details = cause_of(scaled / np.outer(scale, scale), names, positions_m, freedoms)
        raise StatejumpError(code=code, error=rigid_error, **details)
    basis = scaled_rigid_motions(positions_m, freedoms, scale)
    scaled = without_rigid_forces(scaled, basis)
    measured = _definite(scaled, basis.shape[1], asymmetry, rigid_error, largest)
    return scaled / np.outer(scale, scale), attrs.evolve(measured, notes=_notes(positions_m, measured))


def _definite(scaled: Matrix, rigid: int, asymmetry: float, rigid_error: float, largest: float) -> Measured:
    values = np.linalg.eigvalsh(scaled)
    if values[-1] < NOTED * largest:
        raise StatejumpError(code="body_negative")
    bound = max(NOTED, 3 * asymmetry, 3 * rigid_error) * values[-1]
    if values[0] < -bound:
        raise StatejumpError(code="body_indefinite", eigenvalue=float(values[0] / values[-1]))
    free = int(np.sum(values <= ROUNDING * len(values) * values[-1]))
    elastic = values[max(free, rigid):]
    return Measured(asymmetry, rigid_error, float(values[0] / values[-1]),
                    float(elastic[0] / values[-1]) if elastic.size else None, max(0, free - rigid))


def _notes(positions_m: Matrix, measured: Measured) -> tuple[Note, ...]:
    found = []
    if max(measured.asymmetry, measured.rigid_error) > NOTED:
        found.append(Note("body_digits", asymmetry=measured.asymmetry, rigid_error=measured.rigid_error))
    if radius(positions_m) > 100:
        found.append(Note("body_large", radius_m=radius(positions_m)))
    return tuple(found)


def as_loads(
    loads: Matrix, names: Sequence[str], positions_m: Matrix, freedoms: NDArray[np.int64], measured: Measured
) -> tuple[Matrix, Measured]:
    """Return thermal loads without resultant, and the resultants that they had.

    :raises StatejumpError: a load has a resultant
    """
    modes = loads.shape[1] - int(freedoms.sum())
    scale = scales(positions_m, freedoms, np.eye(loads.shape[1]))
    basis = scaled_rigid_motions(positions_m, freedoms, scale)
    scaled = loads * scale
    size = np.abs(scaled[:, :loads.shape[1] - modes]).max(axis=1, initial=0.0)
    resultant = np.abs(scaled @ basis).max(axis=1, initial=0.0)
    errors = np.divide(resultant, size, out=np.zeros(len(loads)), where=size > 0)
    worst = float(errors.max(initial=0.0))
    if worst > REFUSED:
        raise StatejumpError(code="body_load_resultant", error=worst, pattern=names[int(errors.argmax())])
    notes = measured.notes + ((Note("body_load_digits", error=worst),) if worst > NOTED else ())
    return ((scaled - (scaled @ basis) @ basis.T) / scale,
            attrs.evolve(measured, load_resultant=worst, notes=notes))


def free_shapes_of_loads(
    stiffness: Matrix, loads: Matrix, positions_m: Matrix, freedoms: NDArray[np.int64]
) -> Matrix:
    """Return the free shapes (p, N) that belong to thermal loads, without rigid motion.

    :raises StatejumpError: the loads need a motion that has no stiffness
    """
    scale = scales(positions_m, freedoms, stiffness)
    scaled = stiffness * np.outer(scale, scale)
    values, vectors = np.linalg.eigh(scaled)
    kept = values > 1e-11 * values[-1]
    forces = loads * scale
    found = (forces @ vectors[:, kept] / values[kept]) @ vectors[:, kept].T
    left = np.abs(forces - found @ scaled).max(initial=0.0)
    if left > 10 * REFUSED * np.abs(forces).max(initial=0.0):
        raise StatejumpError(code="body_load_on_free")
    return np.asarray(found * scale)


def checked_mass(
    given: Matrix, positions_m: Matrix, freedoms: NDArray[np.int64], measured: Measured
) -> tuple[Matrix, Measured]:
    """Return the mass, symmetric, and the errors that it had.

    :raises StatejumpError: it is not symmetric, or a motion has a negative mass
    """
    scale = np.concatenate([scales(positions_m, freedoms, np.eye(int(freedoms.sum()))),
                            np.ones(len(given) - int(freedoms.sum()))])
    own = np.diag(given)[int(freedoms.sum()):]
    nodal = float(np.abs(np.diag(given) * scale**2)[:int(freedoms.sum())].max(initial=0.0)) or 1.0
    scale[int(freedoms.sum()):] = np.sqrt(nodal / np.where(own > 0, own, nodal))
    scaled = given * np.outer(scale, scale)
    largest = float(np.abs(scaled).max(initial=0.0)) or 1.0
    asymmetry = float(np.abs(scaled - scaled.T).max(initial=0.0)) / largest
    if asymmetry > REFUSED:
        raise StatejumpError(code="body_mass_not_symmetric", error=asymmetry)
    scaled = (scaled + scaled.T) / 2
    values = np.linalg.eigvalsh(scaled)
    if values[0] < -max(NOTED, 10 * asymmetry) * max(values[-1], 0.0) or values[-1] < 0:
        raise StatejumpError(code="body_mass_negative",
                             eigenvalue=float(values[0] / values[-1] if values[-1] > 0 else -1.0))
    kept = scaled / np.outer(scale, scale)
    moved = rigid_motions(positions_m, freedoms, len(given) - int(freedoms.sum()))[:, :3]
    block = moved.T @ kept @ moved
    mass = float(np.trace(block)) / 3
    error = float(np.abs(block - mass * np.eye(3)).max()) / mass if mass > 0 else 0.0
    notes = measured.notes + ((Note("body_mass_directions", error=error),) if error > REFUSED else ())
    return kept, attrs.evolve(measured, mass_asymmetry=asymmetry, mass_error=error, mass_kg=mass, notes=notes)
