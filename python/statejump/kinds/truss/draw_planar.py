# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawing of a planar truss. A truss with many nodes in a small area gets an enlarged detail."""
from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from statejump.core.figures import Constrained, Drawing
from statejump.kinds.truss.draw_symbols import (
    DASHES, FRACTION, LOAD, MOST_NAMED, PIN, ROLLER, SURFACE, covered, gap_m, guided, legend, link_colours, marker,
    names, styled_lines, symbol_size, symbols,
)
from statejump.kinds.truss.joints.protocol import Symbol
from statejump.kinds.truss.resolved import ResolvedTruss

MOST_ZIGZAGS = 60
LEAST_LEGIBLE = 4.5  # size of symbols [pt] below which a detail is drawn as well
DETAIL_GAPS = 8  # number of node spacings along the detail's shorter side, or along half of the longer one
WIDTH_IN, HEIGHT_IN = 8.0, 7.0  # largest size of the panel


def _bowed(truss: ResolvedTruss) -> list[np.ndarray]:
    """Return the lines (k, 2) of the links. Links that would lie on top of each other become arcs."""
    positions, links = truss.nodes.position_m[:, :2], truss.links
    start, end = positions[links.nodes[:, 0]], positions[links.nodes[:, 1]]
    groups: dict[tuple[Any, ...], list[int]] = {}
    for index, (a, b) in enumerate(zip(start, end)):
        for origin, other in ((a, b), (b, a)):
            direction = (other - origin) / np.linalg.norm(other - origin)
            groups.setdefault((*np.round(origin, 9), *np.round(direction, 6)), []).append(index)
    height = np.zeros(len(links.names))
    for members in groups.values():
        for rank, index in enumerate(members[1:], start=1):
            height[index] = max(height[index], rank / (len(members) - 1))
    lines = []
    for a, b, bow in zip(start, end, height):
        if bow == 0:
            lines.append(np.stack((a, b)))
            continue
        t = np.linspace(0, 1, 25)[:, None]
        across = np.array([-(b - a)[1], (b - a)[0]])
        lines.append(a + t * (b - a) + 0.9 * bow * t * (1 - t) * across)
    return lines


def _zigzag(a: np.ndarray, b: np.ndarray, height: float) -> np.ndarray:
    along, turns = (b - a), 7
    across = np.array([-along[1], along[0]]) / np.linalg.norm(along) * height
    t = np.array([0, 0.3, *(0.3 + 0.4 * (np.arange(2 * turns) + 0.5) / (2 * turns)), 0.7, 1])
    side = np.array([0, 0, *np.where(np.arange(2 * turns) % 2 == 0, 1, -1), 0, 0])
    return a + t[:, None] * along + side[:, None] * across


def planar(truss: ResolvedTruss, most_named: int = MOST_NAMED) -> Figure:
    """Return the drawing of a planar truss as a new figure with its legend below.

    :param most_named: largest number of nodes for which names are written; with more nodes, no name is written
    """
    lines = _bowed(truss)
    low, high = _corners(truss, lines)
    scale = min(WIDTH_IN / (high - low)[0], HEIGHT_IN / (high - low)[1])
    wide, tall = np.maximum((high - low) * scale, (3.2, 1.3))
    gap = gap_m(truss)
    size = symbol_size(gap * scale * 72)
    detail = size < LEAST_LEGIBLE
    beside = detail and wide < 2 * tall
    handles = legend(truss)
    colours, colour_scale = link_colours(truss)
    rows_in = [tall, *([tall] if detail and not beside else [])]
    columns_in = [wide, *([max(3.0, 0.6 * tall)] if beside else [])]
    columns = 3 if sum(columns_in) > 6.5 else 2
    below_in = 0.25 + 0.22 * -(-len(handles) // columns)
    drawing = Drawing(
        figsize=(max(sum(columns_in) + 0.9 * len(columns_in) + (0.9 if colour_scale else 0), 2.9 * columns),
                 sum(rows_in) + 0.9 * len(rows_in) + below_in),
        layout=Constrained())
    grid = drawing.add_gridspec(len(rows_in) + 1, len(columns_in), height_ratios=[*rows_in, below_in],
                                width_ratios=columns_in)
    panels = [drawing.add_subplot(grid[0, 0])]
    _draw(panels[0], truss, lines, colours, size, scale, most_named)
    _frame(panels[0], (low + high) / 2, np.array([wide, tall]) / scale)
    if detail:
        panels.append(drawing.add_subplot(grid[0, 1] if beside else grid[1, 0]))
        window = np.array([columns_in[-1], tall])
        closer = (min(window) if beside else max(window) / 2) / (DETAIL_GAPS * gap)
        _draw(panels[1], truss, lines, colours, symbol_size(gap * closer * 72), closer, most_named)
        middle, reach = _first_joint(truss)[:2], window / closer / 2
        _frame(panels[1], np.maximum(np.minimum(middle, high - reach), low + reach), 2 * reach)
        panels[1].set_title("Detail", fontsize=9)
    if colour_scale is not None:
        drawing.colorbar(colour_scale, ax=panels, label=FRACTION, fraction=0.05, pad=0.02)
    below = drawing.add_subplot(grid[-1, :])
    below.axis("off")
    below.legend(handles=handles, loc="center", ncol=columns, fontsize=8, framealpha=1)
    return drawing


def draw_planar(truss: ResolvedTruss, axes: Axes, most_named: int = MOST_NAMED) -> None:
    """Draw a planar truss into given axes. The size of the axes determines the size of the symbols."""
    lines = _bowed(truss)
    low, high = _corners(truss, lines)
    box = axes.get_window_extent()
    scale = min(np.array([box.width, box.height]) / axes.figure.dpi / (high - low))
    colours, _ = link_colours(truss)
    _draw(axes, truss, lines, colours, symbol_size(gap_m(truss) * scale * 72), scale, most_named)
    _frame(axes, (low + high) / 2, high - low)
    axes.legend(handles=legend(truss), loc="best", fontsize=8)


def _corners(truss: ResolvedTruss, lines: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return the lower left and the upper right corner [m] of a rectangle around the drawn items."""
    corners = np.concatenate((*lines, truss.nodes.position_m[:, :2]))
    low, high = corners.min(axis=0), corners.max(axis=0)
    # Arrows begin outside of the truss.
    pad = float((high - low).max()) * (0.12 if truss.nodes.force_N.any() else 0.07)
    return low - pad, high + pad


def _first_joint(truss: ResolvedTruss) -> np.ndarray:
    """Return the position of the first joint or, without joints, of the first node."""
    return truss.nodes.position_m[[*covered(truss), 0][0]]


def _frame(panel: Axes, middle: np.ndarray, extent: np.ndarray) -> None:
    panel.set_xlim(middle[0] - extent[0] / 2, middle[0] + extent[0] / 2)
    panel.set_ylim(middle[1] - extent[1] / 2, middle[1] + extent[1] / 2)
    panel.set_aspect("equal")
    panel.set_xlabel("x [m]")
    panel.set_ylabel("y [m]")


def _draw(panel: Axes, truss: ResolvedTruss, lines: list[np.ndarray], colours: Any, size: float,
          scale: float, most_named: int) -> None:
    """Draw a planar truss into a panel with a given scale [inch/m] and a given size of symbols [pt]."""
    nodes = truss.nodes
    panel.add_collection(LineCollection(lines, colors=colours, linewidths=float(np.clip(size / 5, 0.8, 2.4)), zorder=2,
                                        rasterized=len(lines) > 5000))
    _draw_springs(panel, truss, size / (scale * 72))
    _draw_supports(panel, truss, size)
    bare = np.ones(len(nodes.names), dtype=bool)
    bare[covered(truss)] = False
    for symbol in symbols(truss):
        _draw_symbol(panel, symbol, size)
    panel.plot(*nodes.position_m[bare, :2].T, "o", markersize=0.4 * size, color="0.2", zorder=5)
    _draw_loads(panel, truss, size)
    if truss.reflector is not None:
        panel.plot(*nodes.position_m[truss.reflector.nodes, :2].T, "D", color=SURFACE, markerfacecolor="none",
                   markersize=1.2 * size, zorder=6)
    if len(nodes.names) > most_named * 2:
        return
    named = names(truss)
    if len(named) <= most_named:
        for place, text, way in named:
            panel.annotate(text, tuple(place[:2]), xytext=tuple(way * (1.15 * size + 3)), textcoords="offset points",
                           fontsize=8, ha="center" if abs(way[0]) < 0.5 else ("left" if way[0] > 0 else "right"),
                           va="center" if abs(way[1]) < 0.5 else ("bottom" if way[1] > 0 else "top"), zorder=8)


def _draw_symbol(panel: Axes, symbol: Symbol, size: float) -> None:
    """Draw symbols; those with one direction are drawn in one call."""
    style = dict(linestyle="none", color=symbol.colour, markerfacecolor=symbol.face, markersize=symbol.size * size,
                 markeredgewidth=0 if symbol.face == symbol.colour else max(0.4, size / 10), zorder=symbol.order)
    if symbol.up is None:
        panel.plot(*symbol.places[:, :2].T, marker=marker(symbol.marker), **style)
        return
    ways, which = np.unique(np.round(symbol.up, 9), axis=0, return_inverse=True)
    for number, up in enumerate(ways):
        panel.plot(*symbol.places[which == number, :2].T, marker=marker(symbol.marker, up), **style)


def _draw_springs(panel: Axes, truss: ResolvedTruss, height: float) -> None:
    for ends, style in styled_lines(truss):
        drawn = truss.nodes.position_m[ends, :2]
        few = len(ends) <= MOST_ZIGZAGS
        look: dict[str, Any]
        if style.width:
            lines, look = list(drawn), {"linewidths": style.width}
        elif style.dashed:
            lines, look = list(drawn), {"linewidths": 1.0, "linestyles": [DASHES]}
        else:
            lines = [_zigzag(a, b, 0.4 * height) if few else np.stack((a, b)) for a, b in drawn]
            look = {"linewidths": 1.0 if few else 0.5}
        panel.add_collection(LineCollection(lines, colors=style.colour, zorder=1.5, **look))


def _draw_supports(panel: Axes, truss: ResolvedTruss, size: float) -> None:
    nodes = truss.nodes
    style = dict(linestyle="none", color="0.25", markerfacecolor="white", markersize=1.5 * size,
                 markeredgewidth=max(0.4, size / 12), zorder=3)
    pinned = nodes.fixed[:, :2].all(axis=1)
    panel.plot(*nodes.position_m[pinned, :2].T, marker=marker(PIN), **style)
    for index in np.flatnonzero(guided(truss)):
        if nodes.fixed[index, :2].any():
            normal = np.array([1.0, 0.0]) if nodes.fixed[index, 0] else np.array([0.0, 1.0])
        else:
            normal = nodes.guide_normal[index, :2]
        panel.plot(*nodes.position_m[index, :2], marker=marker(ROLLER, normal), **style)


def _draw_loads(panel: Axes, truss: ResolvedTruss, size: float) -> None:
    forces = truss.nodes.force_N[:, :2]
    sizes = np.linalg.norm(forces, axis=1)
    largest = sizes.max() if len(sizes) else 0.0
    for index in np.flatnonzero(sizes > 0):
        offset = forces[index] / largest * (2.6 * size)
        shortest = 1.3 * size  # shortest visible arrow
        if np.linalg.norm(offset) < shortest:
            offset *= shortest / np.linalg.norm(offset)
        # The arrow ends at the node, where the load acts.
        panel.annotate("", tuple(truss.nodes.position_m[index, :2]), xytext=tuple(-offset - 0.5 * size * offset
                       / np.linalg.norm(offset)), textcoords="offset points", zorder=7,
                       arrowprops=dict(arrowstyle="-|>", color=LOAD, linewidth=max(0.7, size / 8), shrinkA=0,
                                       shrinkB=0.5 * size, mutation_scale=max(5.0, size)))
