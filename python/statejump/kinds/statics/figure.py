# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of rest sets: positions of the centre of a component, with the forces that hold the component there."""
from __future__ import annotations

from collections.abc import Sequence
from math import atan, atan2, cos, degrees, hypot, pi, sin
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Wedge
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from statejump.core.figures import Constrained, Drawing, style
from statejump.kinds.statics.case import StaticsCase
from statejump.kinds.statics.solve import Statics

COLOURS = ("#E69F00", "#0072B2", "#009E73", "#CC79A7", "#D55E00", "#56B4E9")
EVERY = "#000000"
MOST_DRAWN = len(COLOURS)  # with more forces, only union and intersection are drawn
SURFACE, HELD, HELD_BY_ALL = "#C9CED3", "#E69F00", "#0072B2"
MICRO = 1e6


def drawn(statics: Statics, axes: Axes | None = None) -> Figure:
    """Return the picture of rest sets, or draw them into given axes."""
    if axes is None:
        return planar([statics]) if statics.case.is_planar else spatial(statics)
    if statics.case.is_planar:
        _panel(axes, statics)
    else:
        _space(axes, statics)
    figure = axes.figure
    assert isinstance(figure, Figure)
    return figure


def planar(solutions: Sequence[Statics]) -> Figure:
    """Draw positions on a curve, with one panel for each friction coefficient of a case."""
    case, count = solutions[0].case, len(solutions)
    slot = case.joint.type == "slot"
    with style():
        if slot:
            drawing = Drawing(figsize=(7.0, 1.2 + 2.6 * count), layout=Constrained())
            grid = drawing.add_gridspec(count + 1, 1, height_ratios=[1.0] * count + [0.16])
            panels = [drawing.add_subplot(grid[row, 0]) for row in range(count)]
            below = drawing.add_subplot(grid[count, 0])
        else:
            drawing = Drawing(figsize=(max(5.0, 3.7 * count), 4.6), layout=Constrained())
            grid = drawing.add_gridspec(2, count, height_ratios=[1.0, 0.1])
            panels = [drawing.add_subplot(grid[0, column]) for column in range(count)]
            below = drawing.add_subplot(grid[1, :])
        for panel, statics in zip(panels, solutions):
            _panel(panel, statics)
        for panel in [] if slot else panels[1:]:
            panel.set_ylabel("")
        for panel in panels[:-1] if slot else []:
            panel.set_xlabel("")
        below.axis("off")
        below.legend(handles=_legend(case, solutions[0]), loc="center", ncol=3 if slot or count < 3 else 5,
                     fontsize=8, framealpha=1)
        drawing.suptitle(case.title, fontsize=11)
    return drawing


def _panel(panel: Axes, statics: Statics) -> None:
    """Draw positions on a curve into axes."""
    slot = statics.case.joint.type == "slot"
    (_slot if slot else _ring)(panel, statics.case, statics)
    panel.set_title(_title(statics), fontsize=9)
    panel.set_ylabel("normal to the slot [µm]" if slot else "y of the centre [µm]")
    panel.set_xlabel("position of the centre [µm]" if slot else "x of the centre [µm]")


def _title(statics: Statics) -> str:
    found = statics.any
    parts = len(found["parts"])
    return (
        f"μ = {statics.friction_coefficient:g}: {parts} part{'s' if parts != 1 else ''}, "
        f"largest jump {found['diameter_m'] * MICRO:.4g} µm"
    )


def _legend(case: StaticsCase, statics: Statics) -> list[Any]:
    handles: list[Any] = [
        Line2D([], [], color="0.55", linestyle=(0, (4, 3)), label="positions of the centre in contact"),
    ]
    loads = statics.loads
    if len(loads) <= MOST_DRAWN:
        for colour, load in zip(COLOURS, loads):
            size = hypot(*load.force_N)
            handles.append(Line2D([], [], color=colour, linewidth=4, marker="o", markersize=5,
                                  label=f"at rest under {load.name}, {size:.4g} N"))
    else:
        handles.append(Line2D([], [], color=COLOURS[0], linewidth=4, label=f"at rest under one of {len(loads)} forces"))
    if len(loads) > 1:
        handles.append(Line2D([], [], color=EVERY, linewidth=2.5, label="at rest under every force"))
    if len(loads) == 1 or case.joint.type == "slot":
        handles.append(Patch(facecolor="0.5", alpha=0.25, label="friction cone of the reaction"))
    return handles


def _drawn(statics: Statics) -> list[tuple[str, dict[str, Any]]]:
    if len(statics.loads) > MOST_DRAWN:
        return [(COLOURS[0], statics.any)]
    return list(zip(COLOURS, statics.each))


def _arrow(panel: Axes, start: np.ndarray, end: np.ndarray, colour: str) -> None:
    panel.annotate("", xy=tuple(end), xytext=tuple(start), zorder=6,
                   arrowprops=dict(arrowstyle="-|>", color=colour, linewidth=1.6, shrinkA=0, shrinkB=0,
                                   mutation_scale=13))


def _name(panel: Axes, text: str, place: np.ndarray) -> None:
    panel.annotate(text, tuple(place), ha="center", va="center", fontsize=8, color="0.15", zorder=7,
                   bbox=dict(boxstyle="round,pad=0.1", facecolor="white", edgecolor="none", alpha=0.8))


def _cone(panel: Axes, apex: np.ndarray, axis: np.ndarray, mu: float, size: float, colour: str = "0.5") -> None:
    """Draw a friction cone: possible reactions of the surface, or possible directions to the contact."""
    if mu == 0:
        return
    middle, half = degrees(atan2(axis[1], axis[0])), degrees(atan(mu))
    panel.add_patch(Wedge(tuple(apex), size, middle - half, middle + half, facecolor=colour, alpha=0.25,
                          edgecolor="none", zorder=2))
    panel.plot(*np.transpose([apex, apex + size * axis]), color="0.4", linewidth=0.9, linestyle="-.", zorder=2.5)


def _ring(panel: Axes, case: StaticsCase, statics: Statics) -> None:
    """Draw a journal: the curve of its centre, rest arcs, forces, and a friction cone at the end of an arc."""
    assert case.joint.clearance_m is not None
    c = case.joint.clearance_m * MICRO
    if statics.curve is None:
        angle = np.linspace(0, 2 * pi, 361)
        outline = c * np.stack((np.cos(angle), np.sin(angle)), axis=1)
        normals = -outline / c
    else:
        outline, normals = statics.curve.nodes_m * MICRO, statics.curve.normals
        outline, normals = np.vstack((outline, outline[:1])), np.vstack((normals, normals[:1]))

    def normal_at(point: np.ndarray) -> np.ndarray:
        return normals[np.argmin(np.linalg.norm(outline - point, axis=1))]

    panel.plot(*outline.T, color="0.55", linewidth=1.2, linestyle=(0, (4, 3)), zorder=1.5)
    panel.plot([0], [0], "+", color="0.3", markersize=7)
    panel.annotate("$O_{II}$", (0, 0), xytext=(-4, -4), textcoords="offset points", fontsize=8, ha="right", va="top")
    several = len(statics.loads) > 1
    for number, (colour, found) in enumerate(_drawn(statics)):
        away = c * (0.07 + 0.06 * number) if several else 0.0
        for part in found["parts"]:
            points = part["points_m"][:, :2] * MICRO
            shifted = points - away * np.array([normal_at(point) for point in points])
            panel.plot(*shifted.T, color=colour, linewidth=4.5, solid_capstyle="butt", zorder=4)
            panel.plot(*shifted[[0, -1]].T, "o", color=colour, markersize=6, zorder=5)
    if several:
        for part in statics.all["parts"]:
            points = part["points_m"][:, :2] * MICRO
            panel.plot(*points.T, color=EVERY, linewidth=3.0, zorder=4.5)
            if len(points) == 1:
                panel.plot(*points.T, "o", color=EVERY, markersize=6, zorder=5)
    if len(statics.loads) <= MOST_DRAWN:
        for colour, load in zip(COLOURS, statics.loads):
            force = np.array(load.force_N[:2]) / hypot(*load.force_N)
            if several and statics.curve is None:
                _cone(panel, np.zeros(2), force, statics.friction_coefficient, c, colour)
            _arrow(panel, np.zeros(2), 0.5 * c * force, colour)
            _name(panel, load.name, 0.6 * c * force)
        if not several and statics.any["parts"]:
            # At the end of a part the reaction is on the boundary of the cone.
            longest = max(statics.any["parts"], key=lambda part: part["length_m"])
            apex = longest["points_m"][-1, :2] * MICRO
            force = np.array(statics.loads[0].force_N[:2]) / hypot(*statics.loads[0].force_N)
            _cone(panel, apex, normal_at(apex), statics.friction_coefficient, 0.6 * c)
            _arrow(panel, apex, apex - 0.5 * c * force, "0.25")
            _name(panel, "−F", apex - 0.6 * c * force)
    reach = 1.1 * np.abs(outline).max() + (0.07 * c + 0.06 * c * len(_drawn(statics)) if several else 0.0)
    panel.set_xlim(-reach, reach)
    panel.set_ylim(-reach, reach)
    panel.set_aspect("equal")


def _slot(panel: Axes, case: StaticsCase, statics: Statics) -> None:
    """Draw a block in a slot: positions of its centre between the stops, in the plane of axis and force."""
    assert case.joint.clearance_m is not None
    c = case.joint.clearance_m * MICRO
    panel.plot([-c, c], [0, 0], color="0.55", linewidth=1.2, linestyle=(0, (4, 3)), zorder=1.5)
    panel.axhspan(-0.6 * c, -0.12 * c, color="0.9", zorder=0)
    for side in (-1.0, 1.0):
        panel.plot([side * c] * 2, [-0.12 * c, 0.9 * c], color="0.45", linewidth=2)
        panel.annotate("stop", (side * c, 0.95 * c), ha="center", va="bottom", fontsize=8, color="0.3")
    several = len(statics.loads) > 1
    for number, (colour, found) in enumerate(_drawn(statics)):
        height = 0.05 * c * (number + 1) if several else 0.0
        for part in found["parts"]:
            x = part["points_m"][:, 0] * MICRO
            panel.plot(x, 0 * x + height, color=colour, linewidth=4.5, solid_capstyle="butt", zorder=4)
            panel.plot(x, 0 * x + height, "o", color=colour, markersize=7, zorder=5, clip_on=False)
    if several:
        for part in statics.all["parts"]:
            x = part["points_m"][:, 0] * MICRO
            panel.plot(x, 0 * x, color=EVERY, linewidth=3, marker="o", markersize=5, zorder=5)
    if len(statics.loads) <= MOST_DRAWN:
        for number, (colour, load, found) in enumerate(zip(COLOURS, statics.loads, statics.each)):
            across = hypot(*load.force_N[1:])
            force = np.array([load.force_N[0], -across]) / hypot(*load.force_N)
            apex = np.array([found["parts"][0]["representative_m"][0] * MICRO, 0.0])
            if number == 0 and across > 0:
                _cone(panel, apex, np.array([0.0, 1.0]), statics.friction_coefficient, 0.95 * c)
            _arrow(panel, apex, apex - 0.8 * c * force, "0.25" if not several else colour)
            name = "−F" if not several else f"−{load.name}"
            _name(panel, name, apex - 0.88 * c * force)
    panel.set_xlim(-1.9 * c, 1.9 * c)
    panel.set_ylim(-0.35 * c, 1.15 * c)
    panel.set_aspect("equal")
    panel.grid(False)


def spatial(statics: Statics) -> Figure:
    """Draw the shaded surface of possible positions in space with the rest sets on it."""
    with style():
        drawing = Drawing(figsize=(7.0, 6.4), dpi=160)  # resolution of the picture inside the SVG
        panel = drawing.add_axes((0.0, 0.08, 1.0, 0.84), projection="3d", computed_zorder=False)
        handles = _space(panel, statics)
        drawing.legend(handles=handles, loc="lower center", ncol=2, fontsize=8, framealpha=1)
        drawing.suptitle(f"{statics.case.title}, μ = {statics.friction_coefficient:g}", fontsize=11)
    return drawing


def _space(panel: Any, statics: Statics) -> list[Any]:
    """Draw possible positions in space into three-dimensional axes; return the entries of the legend."""
    polygons = [polygon * MICRO for polygon in statics.pieces["polygons_m"]]
    points = np.concatenate(polygons)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    reach = float(np.abs(points - middle).max())
    azimuth, rise = _viewpoint(statics, middle)
    view = np.array([cos(np.radians(rise)) * cos(np.radians(azimuth)),
                     cos(np.radians(rise)) * sin(np.radians(azimuth)), sin(np.radians(rise))])
    handles = [*_shaded_surface(panel, statics, polygons, view), *_rest_sets(panel, statics, middle, view),
               *_forces_around(panel, statics, middle, reach)]
    for setter, value in zip((panel.set_xlim, panel.set_ylim, panel.set_zlim), middle):
        setter(value - 1.15 * reach, value + 1.15 * reach)
    panel.set_box_aspect((1, 1, 1))
    panel.view_init(elev=rise, azim=azimuth)
    panel.set_xlabel("x [µm]")
    panel.set_ylabel("y [µm]")
    panel.set_zlabel("z [µm]")
    return handles


def _viewpoint(statics: Statics, middle: np.ndarray) -> tuple[float, float]:
    """Return azimuth and elevation [°] of a view from outside, slightly to the side of the middle of the rest set."""
    forces = np.array([load.force_N for load in statics.loads])
    mean = (forces / np.linalg.norm(forces, axis=1)[:, None]).sum(axis=0)
    centre = np.mean([part["representative_m"] for part in statics.any["parts"]] or [mean], axis=0) * MICRO
    azimuth = degrees(atan2(centre[1] - middle[1], centre[0] - middle[0])) + 25
    rise = degrees(atan2(centre[2] - middle[2], hypot(*(centre[:2] - middle[:2]))))
    return azimuth, min(38.0, max(-38.0, rise + 12.0))


def _shaded_surface(panel: Any, statics: Statics, polygons: list[np.ndarray], view: np.ndarray) -> list[Any]:
    """Draw possible positions in space, coloured by the forces that hold them; return the entries of the legend."""
    counts = np.array(statics.pieces["polygon_forces"])
    every = len(statics.loads)
    colours = np.where((counts == 0)[:, None], _rgb(SURFACE), np.where(
        ((counts == every) & (every > 1))[:, None], _rgb(HELD_BY_ALL), _rgb(HELD)))
    outwards = np.array([_facing(polygon) for polygon in polygons])
    side = np.cross(view, (0.0, 0.0, 1.0))
    lamp = view + 0.5 * side / max(float(np.linalg.norm(side)), 1e-9) + np.array([0, 0, 0.5])
    light = 0.55 + 0.45 * np.abs(outwards @ (lamp / np.linalg.norm(lamp)))
    shaded = np.clip(colours * light[:, None], 0, 1)
    surface = Poly3DCollection(polygons, facecolors=shaded, edgecolors=shaded, linewidths=0.15, zorder=1)
    surface.set_rasterized(True)  # thousands of polygons
    panel.add_collection3d(surface)
    handles = [Patch(facecolor=SURFACE, label="positions of the centre in contact"),
               Patch(facecolor=HELD, label="at rest" if every == 1 else "at rest under at least one force")]
    if every > 1:
        handles.append(Patch(facecolor=HELD_BY_ALL, label="at rest under every force"))
    return handles


def _rest_sets(panel: Any, statics: Statics, middle: np.ndarray, view: np.ndarray) -> list[Any]:
    """Draw the outlines of the rest sets and the two positions farthest apart; return the entries of the legend."""
    for part in statics.any["parts"]:
        line = part["points_m"] * MICRO
        if len(line):
            panel.plot(*line.T, color=HELD, linewidth=3, marker="o" if len(line) == 1 else None, zorder=3)
        for rim in part["rims_m"]:
            facing = (rim * MICRO - middle) @ view > 0  # the surface hides the others
            line = np.where(facing[:, None], rim * MICRO, np.nan)
            panel.plot(*line.T, color=HELD, linewidth=3, zorder=3)
    if not statics.any["parts"]:
        return []
    ends = middle + 1.01 * (statics.any["farthest_m"] * MICRO - middle)
    panel.plot(*ends.T, "o", color="black", markersize=5, zorder=4)
    panel.plot(*ends.T, color="black", linewidth=1.2, linestyle=(0, (3, 2)), zorder=4)
    jump = statics.any["diameter_m"] * MICRO
    return [Line2D([], [], color="black", marker="o", markersize=4, linestyle=(0, (3, 2)),
                   label=f"farthest two, {jump:.4g} µm")]


def _forces_around(panel: Any, statics: Statics, middle: np.ndarray, reach: float) -> list[Any]:
    """Draw the forces as arrows outside the surface; return the entries of the legend."""
    every, handles = len(statics.loads), []
    shown = statics.loads if every <= MOST_DRAWN else [statics.loads[0], statics.loads[-1]]
    for index, load in enumerate(shown, start=1):
        force = np.array(load.force_N) / hypot(*load.force_N)
        start, end = middle + 1.08 * reach * force, middle + 1.5 * reach * force
        panel.quiver(*start, *(end - start), color="0.15", linewidth=1.6, arrow_length_ratio=0.25, zorder=5)
        text = load.name if every == 1 else str(index)
        panel.text(*(middle + 1.62 * reach * force), text, fontsize=9, ha="center", va="center", zorder=6,
                   bbox=dict(boxstyle="round,pad=0.15", facecolor="white", edgecolor="none", alpha=0.8))
        if every > 1:
            handles.append(Line2D([], [], color="0.15", marker=">", markersize=4, label=f"{index}: {load.name}"))
    return handles


def _rgb(colour: str) -> np.ndarray:
    return np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])


def _facing(polygon: np.ndarray) -> np.ndarray:
    """Unit normal of a polygon, sign unknown."""
    normal = sum(np.cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]) for i in range(1, len(polygon) - 1))
    return normal / max(float(np.linalg.norm(normal)), 1e-300)
