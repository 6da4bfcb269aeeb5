# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawing of a spatial truss."""
from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from statejump.core.figures import Drawing
from statejump.kinds.truss.draw_symbols import (
    DASHES, FRACTION, LOAD, MOST_NAMED, SURFACE, covered, gap_m, legend, link_colours, marker, names, styled_lines,
    symbol_size, symbols,
)
from statejump.kinds.truss.joints.protocol import Symbol
from statejump.kinds.truss.resolved import ResolvedTruss

MOST_TICKS = 8  # ticks of the longest axis


def spatial(truss: ResolvedTruss, most_named: int = MOST_NAMED) -> Figure:
    """Return the drawing of a spatial truss as a new figure with its legend below.

    :param most_named: largest number of nodes for which names are written; with more nodes, no name is written
    """
    handles = legend(truss)
    below_in = 0.3 + 0.22 * -(-len(handles) // 2)
    drawing = Drawing(figsize=(7.4, 6.2 + below_in))
    below = below_in / (6.2 + below_in)
    axes = drawing.add_axes((0.02, below, 0.9, 0.9 - below), projection="3d", computed_zorder=False)
    colours, colour_scale = link_colours(truss)
    if colour_scale is not None:
        drawing.colorbar(colour_scale, ax=axes, label=FRACTION, shrink=0.6, pad=0.1)
    draw_spatial(truss, axes, most_named)
    _fit(drawing, axes, below)
    drawing.legend(handles=handles, loc="lower center", ncol=2, fontsize=8, framealpha=1)
    return drawing


def _fit(drawing: Figure, axes: Axes3D, below: float) -> None:
    """Scale the drawing to the space above the legend and centre it. In three dimensions, labels and edges may extend
    beyond their axes."""
    room = axes.get_position()
    for _ in range(2):  # two passes: labels do not scale with the axes, so the second pass uses the remaining room
        drawing.canvas.draw()  # only now the positions in the axes are known
        drawn = axes.get_tightbbox(drawing.canvas.get_renderer()).transformed(drawing.transFigure.inverted())
        share = min(room.width / drawn.width, room.height / drawn.height)
        place = axes.get_position()
        axes.set_position((0.5 * (room.x0 + room.x1) - share * (0.5 * (drawn.x0 + drawn.x1) - place.x0),
                           0.5 * (room.y0 + room.y1) - share * (0.5 * (drawn.y0 + drawn.y1) - place.y0),
                           share * place.width, share * place.height))


def draw_spatial(truss: ResolvedTruss, axes: Axes3D, most_named: int = MOST_NAMED) -> None:
    """Draw a spatial truss into axes of projection ``3d``."""
    positions = truss.nodes.position_m
    low, high = positions.min(axis=0), positions.max(axis=0)
    span = float((high - low).max())
    # The picture is some 250 pt wide.
    size = symbol_size(gap_m(truss) / span * 250.0)
    _lines(axes, truss, size, span)
    _points(axes, truss, size, span)
    _name(axes, truss, (low + high) / 2, span, most_named)
    shape = np.maximum((high - low) / span, 0.25)
    for setter, centre, part in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), (low + high) / 2, shape):
        setter(centre - 0.54 * span * part, centre + 0.54 * span * part)
    for axis, part in zip((axes.xaxis, axes.yaxis, axes.zaxis), shape):
        axis.set_major_locator(MaxNLocator(nbins=max(2, round(MOST_TICKS * part))))
    axes.set_box_aspect(tuple(shape), zoom=1.1)
    axes.view_init(elev=22, azim=-55)
    axes.set_xlabel("x [m]", labelpad=8)
    axes.set_ylabel("y [m]", labelpad=8)
    axes.set_zlabel("z [m]", labelpad=8)


def _lines(axes: Axes3D, truss: ResolvedTruss, size: float, span: float) -> None:
    """Draw links, elements, and the normals of guided nodes."""
    nodes, positions = truss.nodes, truss.nodes.position_m
    colours, _ = link_colours(truss)
    ends = positions[truss.links.nodes]
    axes.add_collection3d(Line3DCollection(list(ends), colors=colours, linewidths=float(np.clip(size / 5, 0.8, 2.2)),
                                           zorder=2))
    for pairs, style in styled_lines(truss):
        if len(pairs):
            axes.add_collection3d(Line3DCollection(list(positions[pairs]), colors=style.colour,
                                                   linewidths=style.width or 1.0,
                                                   linestyles=[DASHES if style.dashed else "-"], zorder=1.5))
    guided = nodes.guide_normal.any(axis=1)
    if guided.any():
        tick = 0.07 * span * nodes.guide_normal[guided]
        axes.add_collection3d(Line3DCollection(
            list(np.stack((positions[guided] - tick, positions[guided] + tick), axis=1)), colors="0.45", linewidths=1,
            zorder=3))


def _points(axes: Axes3D, truss: ResolvedTruss, size: float, span: float) -> None:
    """Draw supports, joints, nodes, torsion springs, loads and the nodes of the surface."""
    nodes, positions = truss.nodes, truss.nodes.position_m
    dots = dict(linestyle="none", markeredgewidth=max(0.4, size / 12))
    held = np.asarray(nodes.fixed.any(axis=1))
    axes.plot(*positions[held].T, marker="^", color="0.25", markerfacecolor="white", markersize=0.8 * size, zorder=4,
              **dots)
    bare = ~held
    bare[covered(truss)] = False
    for symbol in symbols(truss):
        _draw_symbol(axes, symbol, size, span)
    axes.plot(*positions[bare].T, "o", color="0.2", markersize=0.35 * size, zorder=4, linestyle="none")
    forces = np.linalg.norm(nodes.force_N, axis=1)
    if forces.any():
        arrows = 0.15 * span * nodes.force_N / forces.max()
        loaded = forces > 0
        axes.quiver(*(positions[loaded] - arrows[loaded]).T, *arrows[loaded].T, color=LOAD, linewidth=1.4, zorder=7)
    if truss.reflector is not None:
        axes.plot(*positions[truss.reflector.nodes].T, marker="D", color=SURFACE, markerfacecolor="none",
                  markersize=1.1 * size, zorder=6, **dots)


def _draw_symbol(axes: Axes3D, symbol: Symbol, size: float, span: float) -> None:
    if not symbol.size_in_space or not len(symbol.places):
        return
    edge = 0 if symbol.face == symbol.colour else max(0.4, size / 12)
    axes.plot(*symbol.places.T, marker=marker(symbol.marker_in_space or symbol.marker), linestyle="none",
              color=symbol.colour, markerfacecolor=symbol.face, markersize=symbol.size_in_space * size,
              markeredgewidth=edge, zorder=symbol.order)
    if symbol.line_in_space is not None:
        reach = 0.05 * span * symbol.line_in_space
        axes.add_collection3d(Line3DCollection(
            list(np.stack((symbol.places - reach, symbol.places + reach), axis=1)), colors=symbol.colour,
            linewidths=1, zorder=3))


def _name(axes: Axes3D, truss: ResolvedTruss, middle: np.ndarray, span: float, most_named: int) -> None:
    named = names(truss)
    if len(named) <= most_named:
        for place, text, _ in named:
            # If many ribs end at one position, only the first name is written.
            short = text if text.count(",") < 2 else text.split(",")[0] + ", ..."
            away = place - middle
            away = away / max(float(np.linalg.norm(away)), 1e-12) * 0.06 * span
            axes.text(*(place + away), short, fontsize=8, ha="center", va="center", zorder=8,
                      bbox=dict(boxstyle="round,pad=0.1", facecolor="white", edgecolor="none", alpha=0.7))
