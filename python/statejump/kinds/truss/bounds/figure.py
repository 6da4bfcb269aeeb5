# SPDX-License-Identifier: GPL-3.0-or-later
"""Picture of bounds: bars of each output."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from statejump.core.figures import panels, style
from statejump.kinds.truss.answers.figure import readable

BARS = (("bound, any history", "#0072B2"), ("bound within the range", "#56B4E9"), ("attained by a history", "#009E73"),
        ("simulated jump of the case", "#E69F00"))


def bars(name: str, rows: Sequence[tuple[str, float, float, float, float]]) -> Any:
    """Draw the bars of outputs.

    :param rows: output; spread, spread within the range, attained spread, simulated jump [m]; NaN: no bar
    """
    values = np.array([row[1:] for row in rows], dtype=float)
    factor, unit = readable(float(np.nanmax(values)), "m")
    with style():
        figure, axes = panels(1, 1, (7.0, 1.2 + 0.85 * len(rows)))
        height = 0.8 / len(BARS)
        for kind, (label, colour) in enumerate(BARS):
            if np.isnan(values[:, kind]).all():
                continue
            place = np.arange(len(rows)) + (kind - 1.5) * height
            drawn = axes.barh(place, np.nan_to_num(values[:, kind]) * factor, height, color=colour, label=label)
            axes.bar_label(drawn, ["" if np.isnan(value) else f"{value * factor:.4g}" for value in values[:, kind]],
                           padding=3)
        axes.set_yticks(np.arange(len(rows)), [row[0] for row in rows])
        axes.invert_yaxis()
        axes.set_xlim(0, 1.15 * float(np.nanmax(values)) * factor)
        axes.set_xlabel(f"difference between two rest states [{unit}]")
        axes.grid(False, axis="y")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.28), ncols=2, frameon=False)
        figure.suptitle(f"{name}: how far the truss may come back", fontsize=10)
    return figure
