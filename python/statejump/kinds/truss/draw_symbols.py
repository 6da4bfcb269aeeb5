# SPDX-License-Identifier: GPL-3.0-or-later
"""Symbols of drawn trusses: sizes and legend."""
from __future__ import annotations

from collections.abc import Sequence
from math import atan2, pi
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.lines import Line2D
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path as Outline
from matplotlib.transforms import Affine2D
from scipy.spatial import cKDTree

from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.elements.protocol import Lines
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.protocol import Strokes, Symbol, scaled
from statejump.kinds.truss.resolved import ResolvedTruss

# Cold is pale, hot is dark red. The colours differ in grey and for colour-blind eyes too. The palest ones are invisible
# on white and omitted.
COLOURS = ListedColormap(colormaps["YlOrRd"](np.linspace(0.2, 1.0, 256)))
LINK, LOAD, SURFACE = "#0072B2", "#D55E00", "#E69F00"
DASHES = (0, (5, 2))
FRACTION = "Temperature fraction of a link [-]"
MOST_NAMED = 24  # largest number of nodes that are named by default; more names would cover the drawing


def _outline(*strokes: Sequence[tuple[float, float]]) -> Outline:
    vertices, codes = [], []
    for stroke in strokes:
        vertices += list(stroke)
        codes += [Outline.MOVETO] + [Outline.LINETO] * (len(stroke) - 1)
    return Outline(vertices, codes)


# Symbols in units of their size, the node at (0, 0), the ground below.
PIN: Strokes = (((0, 0), (-0.55, -0.8), (0.55, -0.8), (0, 0)), ((-0.9, -0.8), (0.9, -0.8)),
                *(((x, -0.8), (x - 0.2, -1.0)) for x in (-0.6, -0.2, 0.2, 0.6)))
ROLLER: Strokes = (((0, 0), (-0.5, -0.7), (0.5, -0.7), (0, 0)), ((-0.9, -0.95), (0.9, -0.95)))


def gap_m(truss: ResolvedTruss) -> float:
    """Return a typical distance of neighbouring positions [m]. Symbols of a few nearer positions may overlap."""
    places = np.unique(np.round(truss.nodes.position_m, 9), axis=0)
    return float(np.quantile(cKDTree(places).query(places, k=2)[0][:, 1], 0.1))


def symbol_size(gap_pt: float) -> float:
    """Return the size of symbols [pt] for a given distance of positions in the drawing [pt]."""
    return float(np.clip(0.6 * gap_pt, 2.0, 13.0))


def link_colours(truss: ResolvedTruss) -> tuple[Any, ScalarMappable | None]:
    fraction = truss.links.shown_fraction
    if not len(fraction) or np.ptp(fraction) < 1e-9:
        return LINK, None
    scale = ScalarMappable(Normalize(min(0.0, fraction.min()), fraction.max()), COLOURS)
    return scale.to_rgba(fraction), scale


def legend(truss: ResolvedTruss) -> list[Line2D]:
    """Return the meaning of each symbol, with the numbers that the drawing cannot show."""

    def entry(label: str, **style: Any) -> Line2D:
        return Line2D([], [], **{"linestyle": "none", "markersize": 9, **style}, label=label)

    fraction = truss.links.shown_fraction
    uniform = not len(fraction) or np.ptp(fraction) < 1e-9
    text = "link" if (fraction == 1).all() else f"link, {scaled(fraction, 1.0, 'of ΔT')}"
    if not uniform:
        text = "link, coloured by temperature fraction"
    found = []
    if len(fraction):
        found.append(entry(text, linestyle="-", linewidth=2, color=LINK if uniform else COLOURS(0.6)))
    symbol: dict[str, Any] = dict(color="0.25", markerfacecolor="white")
    if truss.dimension == 2:
        if truss.nodes.fixed[:, :2].all(axis=1).any():
            found.append(entry("fixed", marker=marker(PIN), **symbol))
        if guided(truss).any():
            found.append(entry("held in one direction", marker=marker(ROLLER), **symbol))
    else:
        found.append(entry("fixed", marker="^", **symbol))
        if truss.nodes.guide_normal.any():
            found.append(entry("stays in a plane, its normal", linestyle="-", linewidth=1, color="0.45"))
    for joint in JOINTS:
        joints = truss.joints[joint.section]
        if len(joints.names):
            first = joint.symbols(truss, joints)[0]
            found.append(entry(joint.legend(joints), marker=marker(first.marker), color=first.colour,
                               markerfacecolor=first.face, markeredgewidth=1.2))
    for ends, style in styled_lines(truss):
        if len(ends):
            found.append(entry(style.legend, color=style.colour, linestyle=DASHES if style.dashed else "-",
                               linewidth=style.width or 1))
    for element in ELEMENTS:
        elements = truss.elements[element.section]
        for one in element.symbols(truss, elements)[:1] if len(elements.names) else ():
            found.append(entry(element.legend(elements), marker=marker(one.marker), color=one.colour, markersize=12,
                               markeredgewidth=0.8, markerfacecolor=one.face))
    forces = np.linalg.norm(truss.nodes.force_N, axis=1)
    if forces.any():
        found.append(entry(f"load, {scaled(forces[forces > 0], 1.0, 'N')}", marker=r"$\rightarrow$", color=LOAD))
    if truss.reflector is not None:
        found.append(entry("reflecting surface", marker="D", color=SURFACE, markerfacecolor="none"))
    return found


def styled_lines(truss: ResolvedTruss, bent: bool = True) -> list[tuple[np.ndarray, Lines]]:
    """Return the end points (k, 2) of those elements that are drawn as lines, with the style of the lines.

    :param bent: whether elements that bend are among them
    """
    return [(element.ends(elements)[style.which], style)
            for element, elements in ((one, truss.elements[one.section]) for one in ELEMENTS)
            for style in element.lines(elements) if bent or not element.bends]


def guided(truss: ResolvedTruss) -> np.ndarray:
    """Return the nodes (n,) of a planar truss that are held in one direction, except those with a slider on ground."""
    nodes = truss.nodes
    held = (nodes.fixed[:, :2].sum(axis=1) == 1) | (
        ~nodes.fixed[:, :2].any(axis=1) & nodes.guide_normal.any(axis=1))
    for joint in JOINTS:
        held[joint.guided_nodes(truss.joints[joint.section])] = False
    return held


def marker(given: str | Strokes, up: np.ndarray | None = None) -> MarkerStyle:
    """Return a marker for matplotlib.

    :param up: direction (2,) of the top of the marker; None: the marker is not rotated
    """
    if isinstance(given, str):
        return MarkerStyle(given)
    outline = _outline(*given)
    turned = outline if up is None else outline.transformed(Affine2D().rotate(atan2(up[1], up[0]) - pi / 2))
    return MarkerStyle(turned)


def symbols(truss: ResolvedTruss) -> list[Symbol]:
    """Return the symbols of joints and elements."""
    found = [symbol for joint in JOINTS if len(truss.joints[joint.section].names)
             for symbol in joint.symbols(truss, truss.joints[joint.section])]
    return found + [symbol for element in ELEMENTS if len(truss.elements[element.section].names)
                    for symbol in element.symbols(truss, truss.elements[element.section])]


def covered(truss: ResolvedTruss) -> np.ndarray:
    """Return the nodes whose symbols are replaced by those of joints, the first node of each joint first."""
    return np.concatenate([joint.covered_nodes(truss.joints[joint.section]) for joint in JOINTS]).astype(int)


def names(truss: ResolvedTruss) -> list[tuple[np.ndarray, str, np.ndarray]]:
    """Return every occupied position with the names of its nodes and the direction in which to write them.

    In a planar truss the direction (2,) is the one farthest from links, elements and the ground of supports.
    """
    positions = truss.nodes.position_m
    places: dict[tuple[float, ...], list[int]] = {}
    for index, place in enumerate(positions):
        places.setdefault(tuple(np.round(place, 9)), []).append(index)
    ends = np.concatenate(truss.ends())
    taken: dict[int, list[np.ndarray]] = {}
    for one, two in np.concatenate((ends, ends[:, ::-1])):
        taken.setdefault(int(one), []).append((positions[two] - positions[one])[:2])
    for index in np.flatnonzero(truss.nodes.fixed[:, :2].any(axis=1)):
        ground = [0.0, -1.0] if truss.nodes.fixed[index, 1] else [-1.0, 0.0]
        taken.setdefault(int(index), []).append(np.array(ground))
    for index in np.flatnonzero(truss.nodes.force_N.any(axis=1)):
        taken.setdefault(int(index), []).append(-truss.nodes.force_N[index, :2])
    for joint in JOINTS:
        for node, up in joint.sides(truss.joints[joint.section]):
            taken[node] = [up]  # below the symbol, where no link is
    angles = pi / 2 + np.arange(16) * pi / 8
    candidates = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    found = []
    for members in places.values():
        lines = [line / np.linalg.norm(line) for index in members for line in taken.get(index, []) if line.any()]
        free = np.array([max((float(line @ way) for line in lines), default=-1.0) for way in candidates])
        found.append((positions[members[0]], ", ".join(truss.nodes.names[index] for index in members),
                      candidates[int(np.argmin(np.round(free, 9)))]))
    return found
