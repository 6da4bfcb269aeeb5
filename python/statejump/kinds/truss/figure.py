# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure of a comparison of a ``truss`` case: loops of the nodes with the largest motion and jump, and joint forces. A
thin loop is drawn a second time without its reversible part."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from statejump.core.charts import straight_part
from statejump.core.errors import StatejumpError
from statejump.core.figures import DEM, REDUCED, Panel, Sheet, style
from statejump.core.run import Run
from statejump.core.units import scale_of, text
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.compare import jumps_m, reduced_name, scales_of
from statejump.kinds.truss.draw_planar import draw_planar, planar
from statejump.kinds.truss.draw_spatial import draw_spatial, spatial
from statejump.kinds.truss.draw_symbols import MOST_NAMED

REDUCED_RUN: dict[str, Any] = {**REDUCED, "linewidth": 3.6}
DEM_RUN = {**DEM, "linewidth": 1.1}


def _shown(case: TrussCase, run: Run) -> list[tuple[int, int]]:
    """Return node and axis of two displacements: of the largest jump, and of the largest motion of another node."""
    motion = np.ptp(run["displacement_m"], axis=0)
    jump = np.abs(jumps_m(run))
    first = np.unravel_index(np.argmax(jump if jump.max() > 1e-9 * motion.max() else motion), motion.shape)
    others = motion.copy()
    others[first[0]] = -1
    if others.max() < 0:
        return [(int(first[0]), int(first[1]))]
    # The neighbour in a row would show nearly the same curve. A node that moves about half as much shows more.
    half = np.abs(others - 0.5 * motion.max())
    half[others <= 0.01 * motion.max()] = np.inf
    second = np.unravel_index(np.argmin(half), motion.shape)
    return [(int(first[0]), int(first[1])), (int(second[0]), int(second[1]))]


def sheet(case: TrussCase, runs: Sequence[Run]) -> Sheet:
    """Return the panels: loops of two nodes, loop of the axial force with the largest range, work of friction over
    time. The first run determines the nodes and the link."""
    first = runs[0]
    shown = _shown(case, first)
    scale, unit = (1e3, "mm") if np.abs(first["displacement_m"]).max() > 2e-3 else (1e6, "µm")
    forces = np.ptp(first.links["axial_force_N"].values, axis=0)
    link = int(np.argmax(forces)) if len(forces) else None
    styled = [(run, {**REDUCED_RUN, "label": reduced_name(run)} if run.model == "reduced" else DEM_RUN) for run in runs]

    def loop(node: int, axis: int) -> Panel:
        def draw(axes: Axes) -> None:
            for run, line_style in styled:
                axes.plot(run["temperature_change_K"], run["displacement_m"][:, node, axis] * scale, **line_style)
            axes.set_xlabel("Temperature change [K]")
            axes.set_ylabel(f"Displacement of node {case.node[node].name} along {'xyz'[axis]} [{unit}]")
            _mark_jump(axes, case, first, node, axis, scale)

        return draw

    node, axis = shown[0]
    line = straight_part(first["temperature_change_K"], first["displacement_m"][:, node, axis])

    def without_line(axes: Axes) -> None:
        assert line is not None
        left = [line.taken_off(run["temperature_change_K"], run["displacement_m"][:, node, axis]) for run in runs]
        own_scale, own_unit = scale_of("m", float(np.abs(left[0]).max()))
        for (run, line_style), values in zip(styled, left):
            axes.plot(run["temperature_change_K"], values * own_scale, **line_style)
        axes.set_xlabel("Temperature change [K]")
        slope_scale, slope_unit = scale_of("m", abs(line.slope))
        axes.set_ylabel(f"The same less {line.slope * slope_scale:.5g} {slope_unit}/K [{own_unit}]")
        axes.plot(first["temperature_change_K"][-1], left[0][-1] * own_scale, "s", color="#D55E00", markersize=5,
                  zorder=6, label=_label(case, first, float(left[0][-1] - left[0][0])))
        axes.legend(loc="best", framealpha=1)

    def force(axes: Axes) -> None:
        assert link is not None
        for run, line_style in styled:
            axes.plot(run["temperature_change_K"], run.links["axial_force_N"].values[:, link], **line_style)
        axes.set_xlabel("Temperature change [K]")
        axes.set_ylabel(f"Axial force of {case.link[link].name}, compression positive [N]")

    def friction(axes: Axes) -> None:
        for run, line_style in styled:
            heat = run["friction_dissipation_J"]
            axes.plot(run.time_s, (heat - heat[0]) * 1e3, **line_style)
        axes.set_xlabel("Time [s]")
        axes.set_ylabel("Work of friction [mJ]")

    second = without_line if line is not None else loop(*shown[1]) if len(shown) > 1 else None
    return Sheet([loop(*shown[0]), second, None if link is None else force, friction], 2, (9.5, 7.0), case.title)


def _label(case: TrussCase, run: Run, jump_m: float) -> str:
    """Return the label of the mark at the end of a loop."""
    if not case.has_jump:
        return f"end of the program, {text(jump_m, 'm', 4)}"
    rounding = abs(jump_m) <= scales_of(case, run).rounding_m
    return "no state jump" if rounding else f"state jump {text(jump_m, 'm', 4)}"


def _mark_jump(axes: Axes, case: TrussCase, run: Run, node: int, axis: int, scale: float) -> None:
    values = run["displacement_m"][:, node, axis] * scale
    jump = run["displacement_m"][-1, node, axis] - run["displacement_m"][0, node, axis]
    axes.plot(run["temperature_change_K"][-1], values[-1], "s", color="#D55E00", markersize=5, zorder=6,
              label=_label(case, run, float(jump)))
    axes.legend(loc="best", framealpha=1)


def draw(case: TrussCase, axes: Axes | None = None, names: bool = False) -> Figure:
    """Return the drawing of a truss.

    :param names: whether to write the names of all nodes, even if they cover the drawing
    :param axes: axes to draw into, with projection ``3d`` for a spatial truss; None: a new figure
    :raises StatejumpError: the axes are not three-dimensional
    """
    truss = case.resolve()
    most_named = len(truss.nodes.names) if names else MOST_NAMED
    if axes is None:
        with style():
            drawing = (planar if truss.dimension == 2 else spatial)(truss, most_named)
            drawing.suptitle(case.title, fontsize=11)
        return drawing
    if truss.dimension == 2:
        draw_planar(truss, axes, most_named)
    elif isinstance(axes, Axes3D):
        draw_spatial(truss, axes, most_named)
    else:
        raise StatejumpError(code="spatial_axes_needed", key="axes")
    figure = axes.figure
    assert isinstance(figure, Figure)
    return figure
