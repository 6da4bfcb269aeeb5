# SPDX-License-Identifier: GPL-3.0-or-later
"""Figure of the positions at which friction holds the block."""
from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from statejump.core.figures import panels, style
from statejump.kinds.spring_slider.statics import DENSE, RestSets, rest_sets


def drawn(found: RestSets, axes: Axes | None = None) -> Figure:
    """Draw the positions over the temperature; into given axes, or into a new figure."""
    with style():
        if axes is None:
            _, axes = panels(1, 1, (5.5, 4.2))
        dense = rest_sets(found.case, found.friction_force_N, DENSE).segments
        change = [part.temperature_change_K for part in dense]
        axes.fill_between(change, [part.from_m * 1e3 for part in dense], [part.to_m * 1e3 for part in dense],
                          color="#E69F00", alpha=0.6, linewidth=0, label="held by friction or a stop")
        for ends in ("from_m", "to_m"):  # at a stop the band shrinks to a line
            axes.plot(change, [getattr(part, ends) * 1e3 for part in dense], color="#E69F00", linewidth=2)
        axes.plot(change, [part.zero_force_m * 1e3 for part in dense], color="#000000", linewidth=1,
                  linestyle=(0, (5, 2)), label="no force")
        axes.set_xlabel("Temperature change [K]")
        axes.set_ylabel("Place of the slider [mm]")
        axes.legend(loc="best", framealpha=1)
    figure: Figure = axes.figure
    return figure
