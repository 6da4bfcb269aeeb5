# SPDX-License-Identifier: GPL-3.0-or-later
"""A condensed body: interface nodes, reduced stiffness, free thermal shapes and, optionally, mass and recovery rows."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import attrs
import numpy as np
from numpy.typing import ArrayLike, NDArray

from statejump.bodies.checks import (
    Measured, as_loads, checked_mass, checked_stiffness, free_shapes_of_loads, rigid_motions,
)
from statejump.bodies.mesh_deck import MeshDeck, checked
from statejump.core.errors import NotAllowed
from statejump.core.later import Later
from statejump.core.notes import Note
from statejump.schema.fields import Attached

Matrix = NDArray[np.float64]
_TO_JSON, _drawn = (Later(f"statejump.bodies.{name}") for name in ("case_files:to_json", "figure:drawn"))

__all__ = ["PATCHES", "CondensedBody", "Measured", "Mesh", "Points", "from_arrays"]

# How an interface node of a condensed body follows the nodes of its patch; "": unknown, or nodes of the mesh itself.
PATCHES = ("", "mean", "rigid", "expanding")


@attrs.frozen(eq=False)
class Points:
    """Points of a body that are no interface nodes. Their displacements are rows q + patterns^T T.

    :param names: names of the points
    :param positions_m: positions (k, 3) in the frame of the body [m]
    :param rows: recovery rows (3k, N) [m per unit of the dof]
    :param patterns: displacements (p, 3k) per kelvin of each pattern at q = 0 [m/K]
    """

    names: tuple[str, ...]
    positions_m: Matrix
    rows: Matrix
    patterns: Matrix


@attrs.frozen(eq=False)
class Mesh:
    """Surface of a body, for drawings only.

    :param points_m: positions (k, 3) in the frame of the body [m]
    :param cells: indices (c, 2), (c, 3) or (c, 4) of the points of lines, triangles or quadrilaterals
    :param rows: recovery rows (3k, N) of the points; None: drawings move the mesh rigidly
    :param patterns: displacements (p, 3k) per kelvin of each pattern at q = 0 [m/K]
    """

    points_m: Matrix
    cells: NDArray[np.int64]
    rows: Matrix | None = None
    patterns: Matrix | None = None


@attrs.frozen(eq=False)
class CondensedBody(Attached):
    """A condensed body. All arrays are in SI units and in one frame, that of the body.

    The N dofs are, node by node, ux uy uz and, for a node of six dofs, rx ry rz; then m modes.

    :param node_names: names of the n interface nodes
    :param node_positions_m: positions (n, 3) [m]
    :param node_freedoms: dofs (n) of each node: 3 or 6
    :param stiffness: stiffness (N, N), symmetric; rigid motions cause no force
    :param pattern_names: names of the p temperature patterns
    :param free_shapes: dofs (p, N) of the unloaded body per kelvin of each pattern
    :param mass: mass (N, N); None: unknown
    :param points: recovery of points that are no interface nodes
    :param mesh: surface for drawings
    :param reference_temperature_K: temperature at which the body has the given positions [K]; None: unknown
    :param source: program and file that the matrices come from
    :param patch: how interface nodes follow their patches, one of ``PATCHES``
    :param measured: errors of the given matrices, before they were symmetrised and projected
    :param deck: the deck that the body was condensed from; None: unknown
    """

    node_names: tuple[str, ...]
    node_positions_m: Matrix
    node_freedoms: NDArray[np.int64]
    stiffness: Matrix
    pattern_names: tuple[str, ...]
    free_shapes: Matrix
    mass: Matrix | None
    points: Points | None
    mesh: Mesh | None
    reference_temperature_K: float | None
    source: str
    patch: str
    measured: Measured
    deck: MeshDeck | None = None

    @property
    def interface_dofs(self) -> int:
        """Number of dofs of the interface nodes; the modes follow."""
        return int(self.node_freedoms.sum())

    @property
    def modes(self) -> int:
        """Number of modes."""
        return len(self.stiffness) - self.interface_dofs

    @property
    def node_starts(self) -> NDArray[np.int64]:
        """First dof of each node."""
        return np.asarray(np.concatenate([[0], np.cumsum(self.node_freedoms)[:-1]]), dtype=np.int64)

    @property
    def rigid_motions(self) -> Matrix:
        """Dofs (N, 6) of unit translations along, and unit rotations about, the axes of the body."""
        return rigid_motions(self.node_positions_m, self.node_freedoms, self.modes)

    def __deepcopy__(self, memo: dict[int, Any]) -> CondensedBody:
        return self

    def to_json(self) -> dict[str, Any]:
        made: dict[str, Any] = _TO_JSON(self)
        return made

    def plot(self) -> Any:
        """Return a figure of the body, its free thermal shapes and its modes."""
        return _drawn(self)

    @property
    def notes(self) -> tuple[Note, ...]:
        """Warnings of the checks."""
        return self.measured.notes


def from_arrays(
    node_names: Sequence[str], node_positions_m: ArrayLike, stiffness: ArrayLike, *,
    node_freedoms: ArrayLike | None = None, pattern_names: Sequence[str] = (), free_shapes: ArrayLike | None = None,
    loads: ArrayLike | None = None, mass: ArrayLike | None = None, points: Points | None = None,
    mesh: Mesh | None = None, reference_temperature_K: float | None = None, source: str = "arrays", patch: str = "",
    deck: MeshDeck | None = None,
) -> CondensedBody:
    """Return a condensed body, checked, symmetrised and with rigid motions projected out.

    :param node_freedoms: dofs of each node, 3 or 6; default: six for each node
    :param loads: thermal loads (p, N) of the body held at its nodes, per kelvin; instead of ``free_shapes``
    :raises StatejumpError: the arrays belong to no free linear body; the message states the probable cause
    """
    names = _names("node/name", node_names)
    positions = _array("node/position_m", node_positions_m, (len(names), 3))
    freedoms = _freedoms(names, node_freedoms)
    given = _array("stiffness", stiffness, None)
    interface = int(freedoms.sum())
    if given.ndim != 2 or given.shape[0] != given.shape[1] or len(given) < interface:
        raise NotAllowed("stiffness", code="body_stiffness_shape", shape=list(given.shape), dofs=interface)
    size = len(given)
    patterns = _names("pattern/name", pattern_names)
    kept, measured = checked_stiffness(given, names, positions, freedoms)
    if loads is not None and free_shapes is not None:
        raise NotAllowed("pattern/load", code="body_loads_and_shapes")
    if loads is not None:
        forces = _array("pattern/load", loads, (len(patterns), size))
        forces, measured = as_loads(forces, patterns, positions, freedoms, measured)
        shapes = free_shapes_of_loads(kept, forces, positions, freedoms)
    elif patterns and free_shapes is None:
        raise NotAllowed("pattern/free_shape", code="body_shapes_missing", patterns=len(patterns))
    else:
        given_shapes = np.zeros((0, size)) if free_shapes is None else free_shapes
        shapes = _array("pattern/free_shape", given_shapes, (len(patterns), size))
    masses = None
    if mass is not None:
        masses, measured = checked_mass(_array("mass", mass, (size, size)), positions, freedoms, measured)
    if patch not in PATCHES:
        raise NotAllowed("patch", patch, code="body_patch", patches=", ".join(PATCHES[1:]))
    return CondensedBody(
        names, _locked(positions), _locked(freedoms), _locked(kept), patterns, _locked(shapes),
        None if masses is None else _locked(masses), _points(points, len(patterns), size),
        _mesh(mesh, len(patterns), size), reference_temperature_K, source, patch, measured,
        checked(deck, len(names), len(patterns)))


def _locked(values: Any) -> Any:
    values = np.ascontiguousarray(values)
    values.setflags(write=False)
    return values


def _names(key: str, given: Sequence[str]) -> tuple[str, ...]:
    names = tuple(str(one) for one in given)
    double = next((name for place, name in enumerate(names) if not name or name in names[:place]), None)
    if double is not None or key == "node/name" and not names:
        raise NotAllowed(key, *(() if double is None else (double,)), code="body_names")
    return names


def _freedoms(names: Sequence[str], given: ArrayLike | None) -> NDArray[np.int64]:
    freedoms = np.full(len(names), 6) if given is None else np.atleast_1d(np.asarray(given))
    if freedoms.shape != (len(names),) or not np.isin(freedoms, (3, 6)).all():
        raise NotAllowed("node/freedoms", code="body_freedoms", nodes_=len(names))
    return freedoms.astype(np.int64)


def _array(key: str, given: ArrayLike, shape: tuple[int, ...] | None) -> Matrix:
    try:
        values = np.array(given, dtype=float)
    except (TypeError, ValueError):
        raise NotAllowed(key, code="body_not_numbers") from None
    if shape is not None and values.shape != shape:
        raise NotAllowed(key, code="body_shape", shape=list(values.shape), wanted=list(shape))
    if not np.isfinite(values).all():
        raise NotAllowed(key, code="body_not_finite")
    return values


def _points(given: Points | None, patterns: int, size: int) -> Points | None:
    if given is None:
        return None
    names = _names("point/name", given.names)
    return Points(
        names, _locked(_array("point/position_m", given.positions_m, (len(names), 3))),
        _locked(_array("point/rows", given.rows, (3 * len(names), size))),
        _locked(_array("point/pattern", given.patterns, (patterns, 3 * len(names)))))


def _mesh(given: Mesh | None, patterns: int, size: int) -> Mesh | None:
    if given is None:
        return None
    positions = _array("mesh/point_m", given.points_m, None)
    cells = np.asarray(given.cells)
    whole = cells.dtype.kind in "iu" and cells.ndim == 2 and cells.shape[1] in (2, 3, 4)
    if positions.ndim != 2 or positions.shape[1] != 3 or not whole \
            or cells.size and not (0 <= cells.min() and cells.max() < len(positions)):
        raise NotAllowed("mesh/cells", code="body_mesh")
    rows = None if given.rows is None else _locked(_array("mesh/rows", given.rows, (3 * len(positions), size)))
    moved = None if given.patterns is None else _locked(
        _array("mesh/pattern", given.patterns, (patterns, 3 * len(positions))))
    return Mesh(_locked(positions), _locked(cells.astype(np.int64)), rows, moved)
