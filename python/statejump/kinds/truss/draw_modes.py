# SPDX-License-Identifier: GPL-3.0-or-later
"""Picture of mode shapes: the reference configuration in grey, and the displaced structure on top of it."""
from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from statejump.core.figures import Constrained, Drawing, style
from statejump.kinds.truss.draw_symbols import styled_lines
from statejump.kinds.truss.resolved import ResolvedTruss

REST, MOVED = "0.7", "#0072B2"
MOST_PANELS = 6
COLUMNS = 3
AMPLITUDE = 0.12  # largest displacement over the size of the structure
SHARE = np.linspace(0, 1, 13)[:, None]  # points of the curve of a beam, as fractions of its length


def draw_modes(truss: ResolvedTruss, frequency_Hz: np.ndarray, displacement: np.ndarray,
               rotation_per_m: np.ndarray) -> Figure:
    """Return a figure of the first modes.

    :param displacement: (modes, nodes, 3), the largest of a mode is 1
    :param rotation_per_m: rotation vectors (modes, nodes, 3) per metre of the largest displacement
    """
    count = min(len(frequency_Hz), MOST_PANELS)
    columns = min(count, COLUMNS)
    rows = -(-count // columns)
    spatial = truss.dimension == 3
    scale = AMPLITUDE * float(np.ptp(truss.nodes.position_m, axis=0).max())
    with style():
        figure = Drawing(figsize=(3.4 * columns, 2.9 * rows + 0.4), layout=Constrained())
        for number in range(count):
            axes: Any = figure.add_subplot(rows, columns, number + 1, projection="3d" if spatial else None)
            rest = _curves(truss, np.zeros_like(displacement[number]), np.zeros_like(rotation_per_m[number]))
            moved = _curves(truss, scale * displacement[number], scale * rotation_per_m[number])
            for lines, colour, width in ((rest, REST, 1.0), (moved, MOVED, 1.6)):
                _add(axes, lines, colour, width, spatial)
            _frame(axes, np.concatenate(rest + moved), spatial)
            axes.set_title(f"mode {number + 1}: {frequency_Hz[number]:.4g} Hz", fontsize=10)
        figure.suptitle(f"Modes of {truss.name}, every joint held; the displacement has no scale", fontsize=11)
    return figure


def _curves(truss: ResolvedTruss, moved_m: np.ndarray, rotation: np.ndarray) -> list[np.ndarray]:
    """Return the lines (points, 3) of links and elements; beams are cubics with the rotations of their nodes."""
    position = truss.nodes.position_m + moved_m
    ends = [truss.links.nodes, *(pairs for pairs, _ in styled_lines(truss, bent=False))]
    made = [position[pair] for pairs in ends for pair in pairs]
    beams = truss.elements["beam"]
    offsets, released = (beams.offset_first_m, beams.offset_second_m), (beams.released_first, beams.released_second)
    for index, nodes in enumerate(beams.nodes):
        arms = [offset[index] for offset in offsets]
        first, second = (position[node] + arm + np.cross(rotation[node], arm) for node, arm in zip(nodes, arms))
        along = truss.nodes.position_m[nodes[1]] + arms[1] - truss.nodes.position_m[nodes[0]] - arms[0]
        # An end that releases a moment has its own rotation; the chord stands for it.
        start, end = (second - first if of[index, 1:].any() else along + np.cross(rotation[node], along)
                      for node, of in zip(nodes, released))
        made.append((1 + 2 * SHARE) * (1 - SHARE) ** 2 * first + SHARE * (1 - SHARE) ** 2 * start
                    + SHARE**2 * (3 - 2 * SHARE) * second - SHARE**2 * (1 - SHARE) * end)
    return made


def _add(axes: Any, lines: list[np.ndarray], colour: str, width: float, spatial: bool) -> None:
    if spatial:
        axes.add_collection3d(Line3DCollection(lines, colors=colour, linewidths=width))
    else:
        axes.add_collection(LineCollection([line[:, :2] for line in lines], colors=colour, linewidths=width))


def _frame(axes: Any, points: np.ndarray, spatial: bool) -> None:
    """Set equal scales and labels."""
    low, high = points.min(axis=0), points.max(axis=0)
    room = 0.04 * float((high - low).max())
    axes.set_xlim(low[0] - room, high[0] + room)
    axes.set_ylim(low[1] - room, high[1] + room)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    if spatial:
        axes.set_zlim(low[2] - room, high[2] + room)
        axes.set_zlabel("z [m]")
        axes.set_box_aspect(np.maximum(high - low + 2 * room, 0.2 * float((high - low).max())))
        axes.tick_params(labelsize=7)
    else:
        axes.set_aspect("equal", adjustable="datalim")
