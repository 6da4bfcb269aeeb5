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
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.45 / len(rows)), ncols=2, frameon=False)
        figure.suptitle(f"{name}: how far the truss may come back", fontsize=10)
    return figure


def staircase(name: str, output: str, bound_m: float, highest_K: float, lowest_K: float, factors: np.ndarray,
              spread_m: np.ndarray) -> Any:
    """Draw the spread of an output over the width of the temperature range.

    :param bound_m: spread over any history
    :param highest_K: highest ΔT of the range of factor 1; ``lowest_K``: its lowest ΔT
    """
    factor, unit = readable(bound_m, "m")
    with style():
        figure, axes = panels(1, 1, (6.4, 3.6))
        width = (highest_K - lowest_K) * factors
        axes.plot(width, spread_m * factor, "o-", color=BARS[1][1], markersize=3.5, label=BARS[1][0])
        axes.axhline(bound_m * factor, color=BARS[0][1], linestyle=(0, (5, 2)), label=BARS[0][0])
        axes.axvline(highest_K - lowest_K, color="0.4", linewidth=1, linestyle=":", label="range of the command")
        axes.set_xscale("log")
        axes.set_ylim(0, 1.1 * bound_m * factor)
        axes.set_xlabel("width of the temperature range [K]")
        axes.set_ylabel(f"spread of {output} [{unit}]")
        axes.legend(loc="upper left", bbox_to_anchor=(0.0, 0.9), frameon=False)
        figure.suptitle(f"{name}: {output} over the temperature range", fontsize=10)
    return figure
