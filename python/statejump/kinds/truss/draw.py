# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings of trusses: what the case file says, before anything is solved.

Symbols have the size that the number of nodes leaves, not that of the parts: a clearance is written in
the legend.
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


def draw(case: TrussCase, axes: Axes | None = None) -> Figure:
    """Return the drawing of a truss.

    :param axes: axes to draw into, of a spatial truss with projection ``3d``; None: a new figure
    :raises StatejumpError: the axes are not those of three dimensions
    """
    truss = case.resolve()
    if axes is None:
        with style():
            drawing = (planar if truss.dimension == 2 else spatial)(truss)
            drawing.suptitle(case.title, fontsize=11)
        return drawing
    if truss.dimension == 2:
        draw_planar(truss, axes)
    elif isinstance(axes, Axes3D):
        draw_spatial(truss, axes)
    else:
        raise StatejumpError("not drawn", cause="a spatial truss needs axes with projection='3d'", key="axes")
    figure = axes.figure
    assert isinstance(figure, Figure)
    return figure
