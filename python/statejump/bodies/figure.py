# SPDX-License-Identifier: GPL-3.0-or-later
"""Picture of a condensed body: its surface and nodes, free thermal shapes and modes."""
from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import cm
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray

from statejump.bodies.body import CondensedBody
from statejump.bodies.quantities import BodyCheck, check
from statejump.core import libraries
from statejump.core.figures import Constrained, Drawing, style

Matrix = NDArray[np.float64]

AMPLITUDE = 0.12  # largest displacement over the size of the body
COLUMNS, MOST_SHAPES = 3, 6
NODES, PLAIN = "#D55E00", "0.8"


def drawn(body: CondensedBody, checked: BodyCheck | None = None) -> Figure:
    """Return a figure of the body, its free thermal shapes and its first free modes."""
    checked = checked or check(body)
    shapes: list[tuple[str, Matrix, int | None]] = [("body", np.zeros(len(body.stiffness)), None)]
    for place, name in enumerate(body.pattern_names[:MOST_SHAPES]):
        shapes.append((f"free shape, {name}", body.free_shapes[place], place))
    rigid = len(checked.free_Hz) - checked.free_shapes.shape[1]
    for number in range(min(checked.free_shapes.shape[1], MOST_SHAPES)):
        shapes.append((f"free mode {number + 1}, {checked.free_Hz[rigid + number]:.4g} Hz",
                       checked.free_shapes[:, number], None))
    columns = min(COLUMNS, len(shapes))
    rows = -(-len(shapes) // columns)
    with style():
        figure = Drawing(figsize=(3.6 * columns, 3.0 * rows + 0.4), layout=Constrained())
        for number, (title, dofs, pattern) in enumerate(shapes):
            axes = figure.add_subplot(rows, columns, number + 1, projection="3d")
            _draw(axes, body, dofs, pattern)
            axes.set_title(title, fontsize=10)
        figure.suptitle(f"{body.source}; displacements have no scale" if len(shapes) > 1 else body.source, fontsize=11)
    return figure


def _moved(body: CondensedBody, dofs: Matrix, pattern: int | None) -> tuple[Matrix, Matrix]:
    """Return the displacements of nodes and of the points of the surface, without rigid motion."""
    motions = body.rigid_motions
    dofs = dofs - motions @ np.linalg.lstsq(motions, dofs, rcond=None)[0]
    nodes = np.array([dofs[start:start + 3] for start in body.node_starts])
    if body.mesh is None:
        return nodes, nodes
    if body.mesh.rows is None:
        return nodes, np.zeros_like(body.mesh.points_m)
    moved = body.mesh.rows @ dofs
    if pattern is not None and body.mesh.patterns is not None:
        moved = moved + body.mesh.patterns[pattern]
    return nodes, moved.reshape(-1, 3)


def _cells(body: CondensedBody) -> tuple[Matrix, NDArray[np.int64]]:
    """Return points and faces: the mesh, or the hull of the nodes."""
    if body.mesh is not None:
        return body.mesh.points_m, body.mesh.cells
    points = body.node_positions_m
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if len(points) > 3 and spread[-1] > 1e-6 * spread[0]:
        return points, np.asarray(libraries.scipy("spatial").ConvexHull(points).simplices, dtype=np.int64)
    return points, np.arange(len(points))[None] if len(points) in (2, 3, 4) else np.zeros((0, 3), dtype=np.int64)


def _draw(axes: Any, body: CondensedBody, dofs: Matrix, pattern: int | None) -> None:
    points, cells = _cells(body)
    nodes, moved = _moved(body, dofs, pattern)
    size = float(np.ptp(np.vstack([points, body.node_positions_m]), axis=0).max()) or 1.0
    largest = max(float(np.linalg.norm(moved, axis=1).max(initial=0.0)), float(np.linalg.norm(nodes, axis=1).max()))
    factor = AMPLITUDE * size / largest if largest > 0 else 0.0
    places = points + factor * moved
    if len(cells):
        if largest > 0:
            amount = np.linalg.norm(moved, axis=1)[cells].mean(axis=1)
            colours = cm.viridis(Normalize(0, largest)(amount))
        else:
            colours = PLAIN
        axes.add_collection3d(Poly3DCollection(places[cells], facecolors=colours, edgecolors="0.35", linewidths=0.15))
    ends = body.node_positions_m + factor * nodes
    axes.scatter(*ends.T, color=NODES, s=14, depthshade=False)
    if largest == 0:
        for name, place in zip(body.node_names, ends):
            axes.text(*place, f" {name}", fontsize=8, color=NODES)
    every = np.vstack([places, ends])
    low, high = every.min(axis=0), every.max(axis=0)
    room = 0.04 * size
    for axis, start, end in zip("xyz", low, high):
        getattr(axes, f"set_{axis}lim")(start - room, end + room)
        getattr(axes, f"set_{axis}label")(f"{axis} [m]")
    axes.set_box_aspect(np.maximum(high - low + 2 * room, 0.2 * size))
    axes.tick_params(labelsize=6)
