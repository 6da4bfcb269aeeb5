# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings of trusses: what the case file says, before anything is solved.

Symbols have the size that the number of nodes leaves, not that of the parts: a clearance is written in
the legend.
"""
from __future__ import annotations

from math import atan2, pi
from pathlib import Path
from typing import Any, Optional, Sequence

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path as Outline
from matplotlib.transforms import Affine2D
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from scipy.spatial import cKDTree

from statejump.kinds.spring_slider import figure as plot
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.spring_slider.figure import plt
from statejump.kinds.truss.resolved import GROUND, ResolvedTruss

COLOURS = plt.get_cmap("cividis_r")  # cold light, hot dark: reads in grey and for colour-blind eyes
LINK, SPRING, CABLE, LOAD, JOINT, TORSION, SURFACE = (
    "#0072B2", "#009E73", "#D55E00", "#D55E00", "#000000", "#CC79A7", "#E69F00",
)
MOST_NAMED = 24  # nodes; of more the names would cover the drawing
MOST_ZIGZAGS = 60
LEAST_LEGIBLE = 4.5  # size of symbols [pt] below which a detail is drawn as well
DETAIL_GAPS = 8  # places along the detail's shorter side, or along half of the longer
WIDTH_IN, HEIGHT_IN = 8.0, 7.0  # of the panel, at most


def _outline(*strokes: Sequence[tuple[float, float]]) -> Outline:
    vertices, codes = [], []
    for stroke in strokes:
        vertices += list(stroke)
        codes += [Outline.MOVETO] + [Outline.LINETO] * (len(stroke) - 1)
    return Outline(vertices, codes)


# Symbols in units of their size, the node at (0, 0), the ground below.
PIN = _outline([(0, 0), (-0.55, -0.8), (0.55, -0.8), (0, 0)], [(-0.9, -0.8), (0.9, -0.8)],
               *[[(x, -0.8), (x - 0.2, -1.0)] for x in (-0.6, -0.2, 0.2, 0.6)])
ROLLER = _outline([(0, 0), (-0.5, -0.7), (0.5, -0.7), (0, 0)], [(-0.9, -0.95), (0.9, -0.95)])
BLOCK = _outline([(-0.75, -0.45), (0.75, -0.45), (0.75, 0.45), (-0.75, 0.45), (-0.75, -0.45)],
                 [(-1.0, -0.55), (1.0, -0.55)], *[[(x, -0.55), (x - 0.2, -0.75)] for x in (-0.7, -0.3, 0.1, 0.5, 0.9)])
STOPS = _outline([(-1.0, -0.55), (-1.0, 0.45)], [(1.0, -0.55), (1.0, 0.45)])
SPIRAL = Outline([(0.28 * t * np.cos(5.2 * t), 0.28 * t * np.sin(5.2 * t)) for t in np.linspace(0.4, 3.6, 60)])


def _turned(outline: Outline, direction: np.ndarray) -> MarkerStyle:
    """Return the symbol turned so that its ground lies against a direction (up: as drawn)."""
    angle = atan2(direction[1], direction[0]) - pi / 2
    return MarkerStyle(outline.transformed(Affine2D().rotate(angle)))


def figure(case: TrussCase, folder: Path) -> list[Path]:
    """Write ``<case>.png`` and ``.svg`` into the folder and return their paths."""
    truss = case.resolve()
    with plt.rc_context(plot.STYLE):
        drawing = (_planar if truss.dimension == 2 else _spatial)(truss)
        drawing.suptitle(case.title, fontsize=11)
        return plot.save(drawing, folder, f"{case.name}_truss")


def _gap_m(truss: ResolvedTruss) -> float:
    """Distance of neighbouring places [m]. A few that are nearer may touch: not all symbols shall be tiny."""
    places = np.unique(np.round(truss.nodes.position_m, 9), axis=0)
    return float(np.quantile(cKDTree(places).query(places, k=2)[0][:, 1], 0.1))


def _symbol_size(gap_pt: float) -> float:
    """Size of symbols [pt] for places that far apart on the drawing [pt]."""
    return float(np.clip(0.6 * gap_pt, 2.0, 13.0))


def _spread(values: np.ndarray, scale: float, unit: str) -> str:
    """Return one value or the range of several."""
    low, high = values.min() * scale, values.max() * scale
    return f"{low:.4g} {unit}" if high - low <= 1e-9 * abs(high) else f"{low:.3g} to {high:.3g} {unit}"


def _link_colours(truss: ResolvedTruss) -> tuple[Any, Optional[plt.cm.ScalarMappable]]:
    fraction = truss.links.temperature_fraction
    if np.ptp(fraction) < 1e-9:
        return LINK, None
    scale = plt.cm.ScalarMappable(plt.Normalize(min(0.0, fraction.min()), fraction.max()), COLOURS)
    return scale.to_rgba(fraction), scale


def _legend(truss: ResolvedTruss) -> list[Line2D]:
    """Return what each symbol means, with the numbers that the drawing cannot show."""

    def entry(label: str, **style: Any) -> Line2D:
        return Line2D([], [], **{"linestyle": "none", "markersize": 9, **style}, label=label)

    sliders, revolutes, springs = truss.sliders, truss.revolutes, truss.springs
    fraction = truss.links.temperature_fraction
    uniform = np.ptp(fraction) < 1e-9
    text = "link" if (fraction == 1).all() else f"link, {_spread(fraction, 1.0, 'of ΔT')}"
    if not uniform:
        text = "link, coloured by temperature fraction"
    found = [entry(text, linestyle="-", linewidth=2, color=LINK if uniform else COLOURS(0.6))]
    symbol: dict[str, Any] = dict(color="0.25", markerfacecolor="white")
    if truss.dimension == 2:
        if truss.nodes.fixed[:, :2].all(axis=1).any():
            found.append(entry("fixed", marker=MarkerStyle(PIN), **symbol))
        if _guided(truss).any():
            found.append(entry("held in one direction", marker=MarkerStyle(ROLLER), **symbol))
    else:
        found.append(entry("fixed", marker="^", **symbol))
        if truss.nodes.guide_normal.any():
            found.append(entry("stays in a plane, its normal", linestyle="-", linewidth=1, color="0.45"))
    if len(sliders.names):
        limit = sliders.friction_coefficient * sliders.normal_force_N
        text = f"slider, friction {_spread(limit, 1.0, 'N')}"
        stops = np.concatenate((sliders.clearance_minus_m, sliders.clearance_plus_m))
        if np.isfinite(stops).any():
            text += f", stops at {_spread(stops[np.isfinite(stops)], 1e3, 'mm')}"
        found.append(entry(text, marker=MarkerStyle(BLOCK), color=JOINT, markerfacecolor="white"))
    if len(revolutes.names):
        found.append(entry(
            f"clearance joint, c = {_spread(revolutes.radial_clearance_m, 1e3, 'mm')}, "
            f"μ = {_spread(revolutes.friction_coefficient, 1.0, '').strip()}",
            marker="o", color=JOINT, markerfacecolor="white", markeredgewidth=1.4))
    for what, mask, style in (("spring", ~springs.cable, dict(color=SPRING, linestyle="-", linewidth=1)),
                              ("cable", springs.cable, dict(color=CABLE, linestyle=(0, (5, 2)), linewidth=1))):
        if mask.any():
            found.append(entry(f"{what}, preload {_spread(springs.preload_N[mask], 1.0, 'N')}", **style))
    if len(truss.torsion_springs.names):
        stiffness = _spread(truss.torsion_springs.stiffness_N_m_per_rad, 1.0, "N m/rad")
        found.append(entry(f"torsion spring, {stiffness}", marker=MarkerStyle(SPIRAL), color=TORSION, markersize=12,
                           markeredgewidth=0.8, markerfacecolor="none"))
    forces = np.linalg.norm(truss.nodes.force_N, axis=1)
    if forces.any():
        found.append(entry(f"load, {_spread(forces[forces > 0], 1.0, 'N')}", marker=r"$\rightarrow$", color=LOAD))
    if truss.reflector is not None:
        found.append(entry("reflecting surface", marker="D", color=SURFACE, markerfacecolor="none"))
    return found


def _guided(truss: ResolvedTruss) -> np.ndarray:
    """Which nodes (n,) of a planar truss are held in one direction and carry no slider on ground."""
    nodes = truss.nodes
    held = (nodes.fixed[:, :2].sum(axis=1) == 1) | (
        ~nodes.fixed[:, :2].any(axis=1) & nodes.guide_normal.any(axis=1))
    held[truss.sliders.nodes[truss.sliders.nodes[:, 1] == GROUND, 0]] = False
    return held


def _bowed(truss: ResolvedTruss) -> list[np.ndarray]:
    """Return the lines (k, 2) of the links; those that would cover each other are bows."""
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
    t = np.concatenate(([0, 0.3], 0.3 + 0.4 * (np.arange(2 * turns) + 0.5) / (2 * turns), [0.7, 1]))
    side = np.concatenate(([0, 0], np.where(np.arange(2 * turns) % 2 == 0, 1, -1), [0, 0]))
    return a + t[:, None] * along + side[:, None] * across


def _torsion_places(truss: ResolvedTruss) -> np.ndarray:
    """Where torsion springs are drawn (t, 3): the nearest ends of their links, else a link's first node."""
    positions, links = truss.nodes.position_m, truss.links
    places = []
    for one, two in truss.torsion_springs.links:
        first = links.nodes[one]
        if two == GROUND:
            places.append(positions[first[0]])
            continue
        pairs = [(np.linalg.norm(positions[a] - positions[b]), a) for a in first for b in links.nodes[two]]
        places.append(positions[min(pairs)[1]])
    return np.array(places).reshape(-1, 3)


def _names(truss: ResolvedTruss) -> list[tuple[np.ndarray, str, np.ndarray]]:
    """Place, names of the nodes there, and for planar trusses the direction (2,) that is farthest from
    links, springs and the ground of supports."""
    positions = truss.nodes.position_m
    places: dict[tuple[float, ...], list[int]] = {}
    for index, place in enumerate(positions):
        places.setdefault(tuple(np.round(place, 9)), []).append(index)
    ends = np.concatenate((truss.links.nodes, truss.springs.nodes))
    taken: dict[int, list[np.ndarray]] = {}
    for one, two in np.concatenate((ends, ends[:, ::-1])):
        taken.setdefault(int(one), []).append((positions[two] - positions[one])[:2])
    for index in np.flatnonzero(truss.nodes.fixed[:, :2].any(axis=1)):
        ground = [0.0, -1.0] if truss.nodes.fixed[index, 1] else [-1.0, 0.0]
        taken.setdefault(int(index), []).append(np.array(ground))
    for index in np.flatnonzero(truss.nodes.force_N.any(axis=1)):
        taken.setdefault(int(index), []).append(-truss.nodes.force_N[index, :2])
    for (node, _), axis in zip(truss.sliders.nodes, truss.sliders.axis):
        taken[int(node)] = [np.array([-axis[1], axis[0]])]  # below the block, where no link is
    angles = pi / 2 + np.arange(16) * pi / 8
    candidates = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    found = []
    for members in places.values():
        lines = [line / np.linalg.norm(line) for index in members for line in taken.get(index, []) if line.any()]
        free = np.array([max((float(line @ way) for line in lines), default=-1.0) for way in candidates])
        found.append((positions[members[0]], ", ".join(truss.nodes.names[index] for index in members),
                      candidates[int(np.argmin(np.round(free, 9)))]))
    return found


def _planar(truss: ResolvedTruss) -> plt.Figure:
    nodes = truss.nodes
    lines = _bowed(truss)
    corners = np.concatenate((*lines, nodes.position_m[:, :2]))
    low, high = corners.min(axis=0), corners.max(axis=0)
    span = float((high - low).max())
    pad = span * (0.12 if nodes.force_N.any() else 0.07)  # arrows begin outside of the truss
    low, high = low - pad, high + pad
    scale = min(WIDTH_IN / (high - low)[0], HEIGHT_IN / (high - low)[1])
    wide, tall = np.maximum((high - low) * scale, (3.2, 1.3))
    gap = _gap_m(truss)
    size = _symbol_size(gap * scale * 72)
    detail = size < LEAST_LEGIBLE
    beside = detail and wide < 2 * tall
    handles = _legend(truss)
    colours, colour_scale = _link_colours(truss)
    rows_in = [tall, *([tall] if detail and not beside else [])]
    columns_in = [wide, *([max(3.0, 0.6 * tall)] if beside else [])]
    columns = 3 if sum(columns_in) > 6.5 else 2
    below_in = 0.25 + 0.22 * -(-len(handles) // columns)
    drawing = plt.figure(
        figsize=(max(sum(columns_in) + 0.9 * len(columns_in) + (0.9 if colour_scale else 0), 2.9 * columns),
                 sum(rows_in) + 0.9 * len(rows_in) + below_in),
        constrained_layout=True)
    grid = drawing.add_gridspec(len(rows_in) + 1, len(columns_in), height_ratios=[*rows_in, below_in],
                                width_ratios=columns_in)
    panels = [drawing.add_subplot(grid[0, 0])]
    _draw(panels[0], truss, lines, colours, size, scale)
    _frame(panels[0], (low + high) / 2, np.array([wide, tall]) / scale)
    if detail:
        panels.append(drawing.add_subplot(grid[0, 1] if beside else grid[1, 0]))
        window = np.array([columns_in[-1], tall])
        closer = (min(window) if beside else max(window) / 2) / (DETAIL_GAPS * gap)
        _draw(panels[1], truss, lines, colours, _symbol_size(gap * closer * 72), closer)
        middle, reach = _first_joint(truss)[:2], window / closer / 2
        _frame(panels[1], np.maximum(np.minimum(middle, high - reach), low + reach), 2 * reach)
        panels[1].set_title("detail", fontsize=9)
    if colour_scale is not None:
        drawing.colorbar(colour_scale, ax=panels, label="Temperature fraction of a link [-]", fraction=0.05, pad=0.02)
    below = drawing.add_subplot(grid[-1, :])
    below.axis("off")
    below.legend(handles=handles, loc="center", ncol=columns, fontsize=8, framealpha=1)
    return drawing


def _first_joint(truss: ResolvedTruss) -> np.ndarray:
    """Where the first joint is, of a truss without any the first node."""
    carriers = [*truss.sliders.nodes[:1, 0], *truss.revolutes.bearing_node[:1], 0]
    return truss.nodes.position_m[carriers[0]]


def _frame(panel: plt.Axes, middle: np.ndarray, extent: np.ndarray) -> None:
    panel.set_xlim(middle[0] - extent[0] / 2, middle[0] + extent[0] / 2)
    panel.set_ylim(middle[1] - extent[1] / 2, middle[1] + extent[1] / 2)
    panel.set_aspect("equal")
    panel.set_xlabel("x [m]")
    panel.set_ylabel("y [m]")


def _draw(panel: plt.Axes, truss: ResolvedTruss, lines: list[np.ndarray], colours: Any, size: float,
          scale: float) -> None:
    """Draw a planar truss with symbols of that size [pt] on a panel of that scale [inch/m]."""
    nodes = truss.nodes
    panel.add_collection(LineCollection(lines, colors=colours, linewidths=float(np.clip(size / 5, 0.8, 2.4)), zorder=2,
                                        rasterized=len(lines) > 5000))
    _draw_springs(panel, truss, size / (scale * 72))
    _draw_supports(panel, truss, size)
    bare = np.ones(len(nodes.names), dtype=bool)
    _draw_sliders(panel, truss, size)
    bare[truss.sliders.nodes[:, 0]] = False
    if len(truss.revolutes.names):
        centres = nodes.position_m[truss.revolutes.bearing_node, :2].T
        panel.plot(*centres, marker="o", markersize=0.8 * size, markerfacecolor="white", zorder=5, linestyle="none",
                   color=JOINT, markeredgewidth=max(0.4, size / 10))
        panel.plot(*centres, marker="o", markersize=0.42 * size, zorder=6, linestyle="none", color=JOINT,
                   markeredgewidth=0)
        bare[truss.revolutes.bearing_node] = bare[truss.revolutes.journal_node] = False
    panel.plot(*nodes.position_m[bare, :2].T, "o", markersize=0.4 * size, color="0.2", zorder=5)
    if len(truss.torsion_springs.names):
        # A revolute has its own symbol in the middle: the spring stands around it.
        panel.plot(*_torsion_places(truss)[:, :2].T, marker=MarkerStyle(SPIRAL), linestyle="none", color=TORSION,
                   markerfacecolor="none", markersize=1.6 * size, markeredgewidth=max(0.5, size / 9), zorder=4.5)
    _draw_loads(panel, truss, size)
    if truss.reflector is not None:
        panel.plot(*nodes.position_m[truss.reflector.nodes, :2].T, "D", color=SURFACE, markerfacecolor="none",
                   markersize=1.2 * size, zorder=6)
    if len(nodes.names) > MOST_NAMED * 2:
        return
    named = _names(truss)
    if len(named) <= MOST_NAMED:
        for place, text, way in named:
            panel.annotate(text, tuple(place[:2]), xytext=tuple(way * (1.15 * size + 3)), textcoords="offset points",
                           fontsize=8, ha="center" if abs(way[0]) < 0.5 else ("left" if way[0] > 0 else "right"),
                           va="center" if abs(way[1]) < 0.5 else ("bottom" if way[1] > 0 else "top"), zorder=8)


def _draw_sliders(panel: plt.Axes, truss: ResolvedTruss, size: float) -> None:
    """Blocks, all of one axis at once, with stops where there are any."""
    sliders, places = truss.sliders, truss.nodes.position_m[truss.sliders.nodes[:, 0], :2]
    style = dict(linestyle="none", color=JOINT, markeredgewidth=max(0.4, size / 10), zorder=4)
    stopped = np.isfinite(np.minimum(sliders.clearance_minus_m, sliders.clearance_plus_m))
    axes, which = np.unique(np.round(sliders.axis, 9), axis=0, return_inverse=True)
    for number, axis in enumerate(axes):
        up = np.array([-axis[1], axis[0]])
        own = which == number
        panel.plot(*places[own].T, marker=_turned(BLOCK, up), markersize=1.4 * size, markerfacecolor="white", **style)
        panel.plot(*places[own & stopped].T, marker=_turned(STOPS, up), markersize=1.9 * size, **style)


def _draw_springs(panel: plt.Axes, truss: ResolvedTruss, height: float) -> None:
    springs, positions = truss.springs, truss.nodes.position_m[:, :2]
    ends = positions[springs.nodes]
    few = len(springs.names) <= MOST_ZIGZAGS
    lines = [_zigzag(a, b, 0.4 * height) if few else np.stack((a, b)) for a, b in ends[~springs.cable]]
    panel.add_collection(LineCollection(lines, colors=SPRING, linewidths=1.0 if few else 0.5, zorder=1.5))
    panel.add_collection(LineCollection(list(ends[springs.cable]), colors=CABLE, linewidths=1.0,
                                        linestyles=[(0, (5, 2))], zorder=1.5))


def _draw_supports(panel: plt.Axes, truss: ResolvedTruss, size: float) -> None:
    nodes = truss.nodes
    style = dict(linestyle="none", color="0.25", markerfacecolor="white", markersize=1.5 * size,
                 markeredgewidth=max(0.4, size / 12), zorder=3)
    pinned = nodes.fixed[:, :2].all(axis=1)
    panel.plot(*nodes.position_m[pinned, :2].T, marker=MarkerStyle(PIN), **style)
    for index in np.flatnonzero(_guided(truss)):
        if nodes.fixed[index, :2].any():
            normal = np.array([1.0, 0.0]) if nodes.fixed[index, 0] else np.array([0.0, 1.0])
        else:
            normal = nodes.guide_normal[index, :2]
        panel.plot(*nodes.position_m[index, :2], marker=_turned(ROLLER, normal), **style)


def _draw_loads(panel: plt.Axes, truss: ResolvedTruss, size: float) -> None:
    forces = truss.nodes.force_N[:, :2]
    sizes = np.linalg.norm(forces, axis=1)
    largest = sizes.max() if len(sizes) else 0.0
    for index in np.flatnonzero(sizes > 0):
        offset = forces[index] / largest * (2.6 * size)
        shortest = 1.3 * size  # an arrow that is still one
        if np.linalg.norm(offset) < shortest:
            offset *= shortest / np.linalg.norm(offset)
        # The arrow ends at the node, where the load acts.
        panel.annotate("", tuple(truss.nodes.position_m[index, :2]), xytext=tuple(-offset - 0.5 * size * offset
                       / np.linalg.norm(offset)), textcoords="offset points", zorder=7,
                       arrowprops=dict(arrowstyle="-|>", color=LOAD, linewidth=max(0.7, size / 8), shrinkA=0,
                                       shrinkB=0.5 * size, mutation_scale=max(5.0, size)))


def _spatial(truss: ResolvedTruss) -> plt.Figure:
    nodes = truss.nodes
    positions = nodes.position_m
    low, high = positions.min(axis=0), positions.max(axis=0)
    span = float((high - low).max())
    # The picture is some 250 pt wide.
    size = _symbol_size(_gap_m(truss) / span * 250.0)
    shape = np.maximum((high - low) / span, 0.25)
    middle = (low + high) / 2
    colours, colour_scale = _link_colours(truss)
    handles = _legend(truss)
    below_in = 0.3 + 0.22 * -(-len(handles) // 2)
    drawing = plt.figure(figsize=(7.4, 6.2 + below_in))
    below = below_in / (6.2 + below_in)
    panel = drawing.add_axes((0.02, below, 0.9, 0.9 - below), projection="3d", computed_zorder=False)
    ends = positions[truss.links.nodes]
    panel.add_collection3d(Line3DCollection(list(ends), colors=colours, linewidths=float(np.clip(size / 5, 0.8, 2.2)),
                                            zorder=2))
    if colour_scale is not None:
        drawing.colorbar(colour_scale, ax=panel, label="Temperature fraction of a link [-]", shrink=0.6, pad=0.1)
    springs = truss.springs
    for mask, colour, style in ((~springs.cable, SPRING, "-"), (springs.cable, CABLE, (0, (5, 2)))):
        if mask.any():
            panel.add_collection3d(Line3DCollection(list(positions[springs.nodes[mask]]), colors=colour, linewidths=1.0,
                                                    linestyles=[style], zorder=1.5))
    guided = nodes.guide_normal.any(axis=1)
    if guided.any():
        tick = 0.07 * span * nodes.guide_normal[guided]
        panel.add_collection3d(Line3DCollection(
            list(np.stack((positions[guided] - tick, positions[guided] + tick), axis=1)), colors="0.45", linewidths=1,
            zorder=3))
    dots = dict(linestyle="none", markeredgewidth=max(0.4, size / 12))
    held = nodes.fixed.any(axis=1)
    panel.plot(*positions[held].T, marker="^", color="0.25", markerfacecolor="white", markersize=0.8 * size, zorder=4,
               **dots)
    bare = ~held
    if len(truss.sliders.names):
        carriers = truss.sliders.nodes[:, 0]
        panel.plot(*positions[carriers].T, marker="s", color=JOINT, markerfacecolor="white", markersize=0.7 * size,
                   zorder=4, **dots)
        reach = 0.05 * span * truss.sliders.axis
        panel.add_collection3d(Line3DCollection(
            list(np.stack((positions[carriers] - reach, positions[carriers] + reach), axis=1)), colors=JOINT,
            linewidths=1, zorder=3))
        bare[carriers] = False
    if len(truss.revolutes.names):
        centres = positions[truss.revolutes.bearing_node].T
        panel.plot(*centres, marker="o", color=JOINT, markerfacecolor="white", markersize=0.7 * size, zorder=5, **dots)
        panel.plot(*centres, marker="o", color=JOINT, markersize=0.35 * size, zorder=6, linestyle="none",
                   markeredgewidth=0)
        bare[truss.revolutes.bearing_node] = bare[truss.revolutes.journal_node] = False
    panel.plot(*positions[bare].T, "o", color="0.2", markersize=0.35 * size, zorder=4, linestyle="none")
    if len(truss.torsion_springs.names):
        panel.plot(*_torsion_places(truss).T, marker=MarkerStyle(SPIRAL), color=TORSION, markerfacecolor="none",
                   markersize=1.3 * size, zorder=4.5, **dots)
    forces = np.linalg.norm(nodes.force_N, axis=1)
    if forces.any():
        arrows = 0.15 * span * nodes.force_N / forces.max()
        loaded = forces > 0
        panel.quiver(*(positions[loaded] - arrows[loaded]).T, *arrows[loaded].T, color=LOAD, linewidth=1.4, zorder=7)
    if truss.reflector is not None:
        panel.plot(*positions[truss.reflector.nodes].T, marker="D", color=SURFACE, markerfacecolor="none",
                   markersize=1.1 * size, zorder=6, **dots)
    named = _names(truss)
    if len(named) <= MOST_NAMED:
        for place, text, _ in named:
            # Many ribs end at one place: one name stands for all.
            short = text if text.count(",") < 2 else text.split(",")[0] + ", ..."
            away = place - middle
            away = away / max(float(np.linalg.norm(away)), 1e-12) * 0.06 * span
            panel.text(*(place + away), short, fontsize=8, ha="center", va="center", zorder=8,
                       bbox=dict(boxstyle="round,pad=0.1", facecolor="white", edgecolor="none", alpha=0.7))
    for setter, centre, part in zip((panel.set_xlim, panel.set_ylim, panel.set_zlim), middle, shape):
        setter(centre - 0.54 * span * part, centre + 0.54 * span * part)
    panel.set_box_aspect(tuple(shape), zoom=1.1)
    panel.view_init(elev=22, azim=-55)
    panel.set_xlabel("x [m]", labelpad=8)
    panel.set_ylabel("y [m]", labelpad=8)
    panel.set_zlabel("z [m]", labelpad=8)
    drawing.legend(handles=handles, loc="lower center", ncol=2, fontsize=8, framealpha=1)
    return drawing
