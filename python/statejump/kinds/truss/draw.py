# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings of trusses in the reference configuration, without a solution.

The size of symbols depends on the number of nodes, not on the size of parts. The legend lists the clearances.
"""
from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from statejump.core.errors import StatejumpError
from statejump.core.figures import style
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.draw_planar import draw_planar, planar
from statejump.kinds.truss.draw_spatial import draw_spatial, spatial
from statejump.kinds.truss.draw_symbols import MOST_NAMED


def draw(case: TrussCase, axes: Axes | None = None, names: bool = False) -> Figure:
    """Return the drawing of a truss.

    :param names: write the names of all nodes, even if they cover the drawing
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
