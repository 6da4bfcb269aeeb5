# SPDX-License-Identifier: GPL-3.0-or-later
"""From a deck to a condensed body.

CalculiX stores the matrices of the free mesh and computes the free thermal displacements. It prints these with seven
digits. A second run gives seven more: equations make dummy nodes move by SCALE (u - u'), where u' is what was printed.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import attrs
import numpy as np
from numpy.typing import NDArray

from statejump.bodies.body import CondensedBody, Mesh, Points, from_arrays
from statejump.bodies.condense import ccx
from statejump.bodies.condense.deck import BodyDeck, corners_of, read, with_density
from statejump.bodies.condense.patches import patch
from statejump.bodies.condense.patterns import Pattern, of_names, pattern
from statejump.bodies.condense.reduce import Reduced, balanced, reduce, rigid_columns
from statejump.bodies.mesh_deck import MOST_TEXT, MeshDeck
from statejump.core import libraries
from statejump.core.errors import FailedRun, NotAllowed, StatejumpError, located
from statejump.core.scratch import scratch
from statejump.kinds.truss.importing.to_case import Units

Matrix = NDArray[np.float64]
KINDS = ("mean", "expanding", "rigid", "node")
SCALE = 1e6  # of the part of displacements that a second run prints
MOST_ROWS_OF_MESH = 4_000_000  # numbers of the recovery rows of the surface; without rows, drawings move it rigidly
INNER = 0.5  # radius of the support over that of the body
ALL, DUMMIES = "STATEJUMPALL", "STATEJUMPDIGITS"


@attrs.frozen
class Interface:
    """An interface node.

    :param nodes: nodes of its patch
    :param about: its position, in the units of the deck
    :param rows: rows (dofs, 3k) that give its motion from displacements of the nodes
    """

    name: str
    kind: str
    nodes: tuple[int, ...]
    about: Matrix
    rows: Matrix

    @property
    def dofs(self) -> int:
        """Its number of dofs."""
        return 3 if self.kind == "node" else 6


@attrs.define
class _Mesh:
    """Matrices of the free mesh.

    :param rows: of each node, rows (3, levels) of its dofs in the matrices; shells have several levels
    """

    deck: BodyDeck
    units: Units
    stiffness: Any
    mass: Any
    rows: dict[int, NDArray[np.int64]]

    def picks(self, nodes: Sequence[int]) -> Any:
        """Return the sparse rows (3k, size) that pick the displacements of nodes: the mean of both faces of shells."""
        sparse = libraries.sparse()

        places, columns, values = [], [], []
        beams = self.deck.beam_nodes
        for place, node in enumerate(nodes):
            if node in beams:
                raise StatejumpError(code="condense_beam_node", file=self.deck.path, node=node)
            if node not in self.rows:
                raise StatejumpError(code="condense_dependent", file=self.deck.path, node=node)
            for direction, levels in enumerate(self.rows[node]):
                for level in {int(levels[0]), int(levels[-1])}:
                    places.append(3 * place + direction)
                    columns.append(level)
                    values.append(1.0 if levels[0] == levels[-1] else 0.5)
        return sparse.csr_matrix((values, (places, columns)), (3 * len(nodes), self.stiffness.shape[0]))

    @property
    def plain(self) -> bool:
        """Whether each node has exactly its own three rows."""
        return all(levels.shape == (3, 1) for levels in self.rows.values())


def condense(
    path: str | Path, interfaces: Sequence[str], patterns: Sequence[str] = ("uniform",), *, modes: int = 0,
    points: str | None = None, at: dict[str, Sequence[float]] | None = None, units: Units = Units(),
    reference_temperature_K: float | None = None, on_progress: Callable[[float], None] = lambda done: None,
) -> CondensedBody:
    """Return the body of a deck of CalculiX (or Abaqus), reduced to the motions of patches of nodes.

    :param interfaces: ``NSET`` or ``NSET=KIND``: the patch moves by its ``mean`` motion (default), or as a rigid patch
        that expands (``expanding``) or does not (``rigid``); ``node`` is a set of one node with three dofs
    :param patterns: temperature patterns, see :func:`statejump.bodies.condense.patterns.pattern`
    :param modes: number of fixed-interface modes, for motion
    :param points: set of nodes whose displacements are recovered
    :param at: positions of interface nodes by set, in the units of the deck; default: the mean of the patch
    :param units: units of the deck
    :raises StatejumpError: the deck is unsupported, or CalculiX fails
    """
    ccx.program()
    deck = read(Path(path))
    faces = deck.faces()
    chosen = [_interface(deck, text, at or {}, faces) for text in interfaces]
    if not chosen:
        raise NotAllowed("interface", code="condense_no_interface")
    given = tuple(pattern(deck, text, units.length_m) for text in patterns)
    names = of_names(given)
    if modes and not deck.has_density:
        raise NotAllowed("modes", modes, code="condense_no_density")
    with located(file=deck.path), scratch() as folder:
        mesh = _stored(deck, units, folder)
        on_progress(0.2)
        reduced = _reduced(mesh, chosen, modes)
        on_progress(0.6)
        free = _free(mesh, given, chosen, points, folder)
        on_progress(0.9)
        return _body(mesh, chosen, names, given, reduced, free, points, reference_temperature_K)


def _interface(deck: BodyDeck, text: str, at: dict[str, Sequence[float]], faces: Sequence[tuple[int, ...]]
               ) -> Interface:
    name, _, kind = text.partition("=")
    kind = kind or "mean"
    if kind not in KINDS:
        raise NotAllowed("interface", text, code="condense_kind", kinds=", ".join(KINDS))
    nodes = deck.nodes_of(name)
    places = np.array([deck.positions[node] for node in nodes])
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    if kind == "node":
        if len(nodes) != 1:
            raise NotAllowed("interface", text, code="condense_one_node", count=len(nodes))
        return Interface(name, kind, tuple(nodes), places[0], np.eye(3))
    if len(nodes) < 3 or spread[1] < 1e-6 * spread[0]:
        raise NotAllowed("interface", text, code="condense_patch_line")
    about = None if name not in at else np.asarray(at[name], dtype=float)
    return Interface(name, kind, tuple(nodes), *patch(nodes, deck.positions, faces, about))


def _stored(deck: BodyDeck, units: Units, folder: Path) -> _Mesh:
    """Return the matrices that CalculiX stores, in its units."""
    ccx.run(folder, "free", [*with_density(deck), "*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "*END STEP"])
    labels = ccx.labels(folder / "free.dof")
    by_node: dict[int, list[list[int]]] = {}
    for row, (node, direction) in enumerate(labels):
        if 1 <= direction <= 3:
            by_node.setdefault(node, [[], [], []])[direction - 1].append(row)
    rows = {node: np.array(several) for node, several in by_node.items()
            if len(several[0]) == len(several[1]) == len(several[2])}
    stiffness = balanced(ccx.matrix(folder / "free.sti", len(labels)), list(rows.values()))
    mass = ccx.matrix(folder / "free.mas", len(labels)) if deck.has_density else None
    return _Mesh(deck, units, stiffness, mass, rows)


def _reduced(mesh: _Mesh, interfaces: Sequence[Interface], modes: int) -> Reduced:
    """Return the reduced matrices. A rigid patch is replaced by its six motions before the reduction."""
    sparse = libraries.sparse()

    size = mesh.stiffness.shape[0]
    tied = [node for one in interfaces if one.kind in ("rigid", "expanding") for node in one.nodes]
    if tied and not mesh.plain:
        raise StatejumpError(code="condense_rigid_shell")
    if len(set(tied)) < len(tied):
        raise StatejumpError(code="condense_patches_overlap")
    held = np.zeros(size, dtype=bool)
    for node in tied:
        held[mesh.rows[node]] = True
    kept = np.flatnonzero(~held)
    columns = [sparse.csc_matrix((np.ones(len(kept)), (kept, np.arange(len(kept)))), (size, len(kept)))]
    count = len(kept)
    rows = []
    for one in interfaces:
        if one.kind in ("rigid", "expanding"):
            places = np.array([mesh.deck.positions[node] for node in one.nodes])
            columns.append(mesh.picks(one.nodes).T @ sparse.csr_matrix(rigid_columns(places, one.about)))
            rows.append(("own", count))
            count += 6
        else:
            rows.append(("rows", sparse.csr_matrix(one.rows) @ mesh.picks(one.nodes)))
    to_mesh = sparse.hstack(columns, format="csc")
    found = []
    for what, value in rows:
        if what == "own":
            found.append(sparse.csr_matrix((np.ones(6), (np.arange(6), np.arange(value, value + 6))), (6, count)))
        else:
            found.append(value @ to_mesh)
    mass = None if mesh.mass is None else to_mesh.T @ mesh.mass @ to_mesh
    reduced = reduce((to_mesh.T @ mesh.stiffness @ to_mesh).tocsc(), mass, sparse.vstack(found, format="csr"), modes)
    return attrs.evolve(reduced, shapes=to_mesh @ reduced.shapes)


def _free(mesh: _Mesh, patterns: Sequence[Pattern], interfaces: Sequence[Interface], points: str | None, folder: Path
          ) -> dict[int, Matrix]:
    """Return the free thermal displacements (p, 3) by node, in the units of the deck."""
    if not patterns:
        return {}
    deck = mesh.deck
    used = sorted({node for _, nodes in deck.elements for node in nodes})
    support = _support(mesh, used)
    exact = sorted({node for one in interfaces for node in one.nodes}
                   | set(deck.nodes_of(points) if points is not None else ()))
    first = _printed(folder, "thermal", [*deck.lines, *_thermal_steps(deck, patterns, used, support, {})], ALL)
    given = {node: np.array([step[node] for step in first]) for node in used}
    free = max(deck.positions) + 1
    dummies = {node: (free + 2 * place, free + 2 * place + 1) for place, node in enumerate(exact)}
    lines = ["*NODE", *(f"{dummy},0.,0.,0." for pair in dummies.values() for dummy in pair),
             f"*NSET,NSET={DUMMIES}", *(f"{moved}," for moved, _ in dummies.values()), "*EQUATION"]
    for node, (moved, known) in dummies.items():
        for direction in (1, 2, 3):
            lines += ["3", f"{moved},{direction},1.,{node},{direction},{-SCALE:g},{known},{direction},{SCALE:g}"]
    prescribed = {dummies[node][1]: given[node] for node in exact}
    second = _printed(folder, "digits", [
        *deck.lines, *lines, *_thermal_steps(deck, patterns, used, support, prescribed)], DUMMIES)
    for node, (moved, _) in dummies.items():
        given[node] = given[node] + np.array([step[moved] for step in second]) / SCALE
    return given


def _printed(folder: Path, job: str, lines: Sequence[str], name: str) -> list[dict[int, Matrix]]:
    ccx.run(folder, job, lines)
    found = ccx.displacements(folder / f"{job}.dat", name)
    if not found:
        raise FailedRun(code="condense_no_displacements")
    return found


def _thermal_steps(deck: BodyDeck, patterns: Sequence[Pattern], used: Sequence[int], support: Sequence[tuple[int, int]],
                   prescribed: dict[int, Matrix]) -> list[str]:
    """Return the part of a deck with supports and one step for each pattern.

    :param prescribed: displacements (p, 3) of dummy nodes
    """
    initial = deck.reference or 0.0
    lines = [f"*NSET,NSET={ALL}", *(f"{node}," for node in used),
             "*INITIAL CONDITIONS,TYPE=TEMPERATURE", *(f"{node},{ccx.number(initial)}" for node in used)]
    lines += ["*BOUNDARY", *(f"{node},{direction + 1},{direction + 1}" for node, direction in support)]
    for number, one in enumerate(patterns):
        lines += ["*STEP", "*STATIC"]
        if prescribed:
            lines.append("*BOUNDARY")
            for node, values in prescribed.items():
                lines += [f"{node},{k + 1},{k + 1},{ccx.number(value)}" for k, value in enumerate(values[number])]
        more = f",{ccx.number(one.gradient)}" if deck.shells else ""
        lines += ["*TEMPERATURE,OP=NEW", *(f"{node},{ccx.number(initial + one.nodes[node])}{more}" for node in used)]
        lines += [f"*NODE PRINT,NSET={DUMMIES if prescribed else ALL}", "U", "*END STEP"]
    return lines


def _support(mesh: _Mesh, used: Sequence[int]) -> list[tuple[int, int]]:
    """Return six dofs of three nodes that hold the body without constraint. The nodes surround the centre at half the
    radius of the body: displacements and, with them, their rounding are then small."""
    beams = mesh.deck.beam_nodes
    nodes = [node for node in used if node in mesh.rows and node not in beams]
    places = np.array([mesh.deck.positions[node] for node in nodes])
    far = np.linalg.norm(places - places.mean(axis=0), axis=1)
    inner = far <= INNER * far.max()
    near = places[inner]
    if len(near) > 2 and np.asarray(np.linalg.svd(near - near.mean(axis=0), compute_uv=False))[1] > 1e-3 * far.max():
        nodes = [node for node, kept in zip(nodes, inner) if kept]
        places = near
    first = int(np.linalg.norm(places - places.mean(axis=0), axis=1).argmax())
    second = int(np.linalg.norm(places - places[first], axis=1).argmax())
    along = (places[second] - places[first]) / np.linalg.norm(places[second] - places[first])
    aside = places - places[first]
    third = int(np.linalg.norm(aside - np.outer(aside @ along, along), axis=1).argmax())
    corners = [first, second, third]
    size = float(np.linalg.norm(places[second] - places[first]))
    motions = rigid_columns(places[corners], places[first]) / np.array([1, 1, 1, size, size, size])
    order = libraries.scipy("linalg").qr(motions.T, pivoting=True, mode="r")[1][:6]
    return [(nodes[corners[int(place) // 3]], int(place) % 3) for place in sorted(order)]


def _body(mesh: _Mesh, interfaces: Sequence[Interface], names: Sequence[str], patterns: Sequence[Pattern],
          reduced: Reduced, free: dict[int, Matrix], points: str | None, reference_K: float | None) -> CondensedBody:
    """Return the body in SI units."""
    deck, units = mesh.deck, mesh.units
    dofs = np.concatenate([[units.length_m] * 3 + [1.0] * (one.dofs - 3) for one in interfaces])
    modes = len(reduced.stiffness) - len(dofs)
    unit = np.concatenate([dofs, np.ones(modes)])  # of each dof; the unit of a mode is arbitrary
    energy = units.force_N * units.length_m
    shapes = _free_shapes(mesh, interfaces, patterns, reduced, free) if patterns else np.zeros((0, len(unit)))
    recovery = _Recovery(mesh, reduced, free, shapes, unit)
    body_points = None
    if points is not None:
        nodes = deck.nodes_of(points)
        rows, moved = recovery.of(nodes)
        body_points = Points(tuple(map(str, nodes)), recovery.positions(nodes), rows, moved)
    mass = None
    if reduced.mass is not None:
        mass = reduced.mass * energy / np.outer(unit, unit) * units.mass * units.length_m / units.force_N
    kinds = {one.kind for one in interfaces} - {"node"}
    return from_arrays(
        [one.name for one in interfaces], np.array([one.about for one in interfaces]) * units.length_m,
        reduced.stiffness * energy / np.outer(unit, unit), node_freedoms=[one.dofs for one in interfaces],
        pattern_names=names, free_shapes=shapes * unit, mass=mass, points=body_points, mesh=recovery.surface(),
        reference_temperature_K=reference_K, source=f"CalculiX, {deck.path.name}",
        patch=kinds.pop() if len(kinds) == 1 else "", deck=_stored_deck(mesh, interfaces, patterns))


def _stored_deck(mesh: _Mesh, interfaces: Sequence[Interface], patterns: Sequence[Pattern]) -> MeshDeck | None:
    """Return the deck for the file of the body; None: it is too long."""
    deck = mesh.deck
    text = "\n".join(deck.lines) + "\n"
    if len(text) > MOST_TEXT:
        return None
    used = sorted({node for _, nodes in deck.elements for node in nodes})
    return MeshDeck(text, tuple(one.kind for one in interfaces), np.array(used, dtype=np.int64),
                    np.array([[one.nodes[node] for node in used] for one in patterns]).reshape(-1, len(used)),
                    np.array([one.gradient for one in patterns]), mesh.units.length_m, mesh.units.force_N)


def _free_shapes(mesh: _Mesh, interfaces: Sequence[Interface], patterns: Sequence[Pattern], reduced: Reduced,
                 free: dict[int, Matrix]) -> Matrix:
    """Return the free shapes (p, N): mean motions of the free displacements. A rigid patch resists what of the free
    displacements is no rigid motion of it."""
    shapes = np.zeros((len(patterns), len(reduced.stiffness)))
    resisted = np.zeros((mesh.stiffness.shape[0], len(patterns)))
    at = 0
    for one in interfaces:
        moved = np.stack([free[node] for node in one.nodes], axis=1).reshape(len(patterns), -1)
        motion = moved @ one.rows.T
        shapes[:, at:at + one.dofs] = motion
        if one.kind == "rigid":
            places = np.array([mesh.deck.positions[node] for node in one.nodes])
            left = moved - motion @ rigid_columns(places, one.about).T
            for node, values in zip(one.nodes, left.reshape(len(patterns), -1, 3).transpose(1, 2, 0)):
                resisted[mesh.rows[node][:, 0]] = values
        at += one.dofs
    if resisted.any():
        loads = (mesh.stiffness @ reduced.shapes).T @ resisted
        values, vectors = np.linalg.eigh(reduced.stiffness)
        kept = values > 1e-11 * values[-1]
        shapes += (vectors[:, kept] / values[kept] @ (vectors[:, kept].T @ loads)).T
    return shapes


@attrs.define
class _Recovery:
    """Displacements of nodes of the mesh."""

    mesh: _Mesh
    reduced: Reduced
    free: dict[int, Matrix]
    shapes: Matrix
    unit: Matrix

    def positions(self, nodes: Sequence[int]) -> Matrix:
        """Return positions [m]."""
        return np.array([self.mesh.deck.positions[node] for node in nodes]) * self.mesh.units.length_m

    def of(self, nodes: Sequence[int]) -> tuple[Matrix, Matrix]:
        """Return the recovery rows of nodes, and their displacements per pattern at q = 0."""
        rows = self.mesh.picks(nodes) @ self.reduced.shapes
        length = self.mesh.units.length_m
        if not len(self.shapes):
            return rows * length / self.unit, np.zeros((0, 3 * len(nodes)))
        moved = np.stack([self.free[node] for node in nodes], axis=1).reshape(len(self.shapes), -1)
        return rows * length / self.unit, (moved - self.shapes @ rows.T) * length

    def surface(self) -> Mesh:
        """Return the surface, with rows if they are not too many."""
        faces = [corners_of(face) for face in self.mesh.deck.faces()]
        beams = self.mesh.deck.beam_nodes
        nodes = sorted({node for face in faces for node in face if node in self.mesh.rows and node not in beams})
        places = {node: place for place, node in enumerate(nodes)}
        cells = np.array([[places[node] for node in (*face, face[-1])[:4]] for face in faces
                          if all(node in places for node in face)], dtype=np.int64).reshape(-1, 4)
        if 3 * len(nodes) * len(self.unit) > MOST_ROWS_OF_MESH:
            return Mesh(self.positions(nodes), cells)
        return Mesh(self.positions(nodes), cells, *self.of(nodes))
