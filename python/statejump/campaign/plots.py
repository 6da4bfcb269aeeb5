# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of a campaign: for random samples distributions and rank correlations, for a sweep outcomes over the grid."""
from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from statejump.campaign.outputs import in_words
from statejump.campaign.plan import SWEEP, Plan
from statejump.campaign.sampling import Values
from statejump.campaign.summary import spearman
from statejump.campaign.tables import Table
from statejump.core.figures import panels as new_panels, style
from statejump.core.units import split_unit

BLUE, ORANGE, DARK = "#0072B2", "#D55E00", "#000000"
LINES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
MOST_POINTS = 2000  # of one scatter panel
MOST_LINES = 7
MOST_WHOLE = 60


def figures(campaign: Plan, table: Table) -> dict[str, Figure]:
    """Return the figures by file name; empty if every sample failed."""
    if bool(np.all(table.failed)):
        return {}
    with style():
        if campaign.command == SWEEP:
            return {"sweep": _sweep(campaign, table)}
        return {"distributions": _distributions(campaign, table), "correlations": _scatter(campaign, table)}


def _label(name: str, unit: str) -> str:
    """Name without its unit, then the unit."""
    output = in_words(name)
    if output is not None:
        return output + ("" if unit == "-" else f" [{unit}]")
    section, _, key = split_unit(name)[0].rpartition(".")
    words = key.replace("_", " ").replace("temperature change", "ΔT")
    # If a key varies for every item, the column has the mean of the items.
    every = "every " if section.endswith(".*") else ""
    section = section.removesuffix(".*").replace("_", " ")
    return words + (f" of {every}{section}" if section else "") + ("" if unit == "-" else f" [{unit}]")


def _wrapped(text: str, width: int = 26) -> str:
    lines = [""]
    for word in text.split(" "):
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append(word)
        else:
            lines[-1] = f"{lines[-1]} {word}".strip()
    return "\n".join(lines)


def _small(panel: Axes) -> None:
    panel.ticklabel_format(axis="both", style="sci", scilimits=(-3, 4), useMathText=True)
    panel.xaxis.get_offset_text().set_fontsize(7)
    panel.yaxis.get_offset_text().set_fontsize(7)
    panel.tick_params(labelsize=7)


def _distributions(campaign: Plan, table: Table) -> Figure:
    """Histogram and cumulated distribution of every outcome."""
    columns = 3
    rows = -(-len(table.outcomes) // columns)
    drawing, panels = new_panels(rows, columns, (10.5, 3.0 * rows), squeeze=False)
    for panel in panels.flat[len(table.outcomes):]:
        panel.set_axis_off()
    for panel, (name, values) in zip(panels.flat, table.outcomes.items()):
        there = np.sort(values[np.isfinite(values)])
        panel.set_xlabel(_wrapped(_label(name, campaign.units[name]), 40), fontsize=8)
        _small(panel)
        lost = len(values) - int(np.count_nonzero(table.failed)) - len(there)
        panel.set_title(f"In {len(there):,} of {len(there) + lost:,} samples", fontsize=8)
        if not len(there):
            continue
        panel.hist(there, bins=_bins(there), color=BLUE, alpha=0.55)
        panel.set_ylabel("samples in the bar", color=BLUE)
        other = panel.twinx()
        other.plot(np.append(there[:1], there), np.arange(len(there) + 1) / len(there), color=ORANGE, linewidth=1.4,
                   drawstyle="steps-post")
        for level in (0.05, 0.5, 0.95):
            other.axvline(float(np.quantile(there, level)), color=DARK, linewidth=0.7, linestyle=(0, (4, 3)))
        other.set_ylim(0, 1.02)
        other.grid(False)
        other.tick_params(labelsize=7)
        other.set_ylabel("cumulated share", color=ORANGE)
    drawing.suptitle(f"{campaign.title}: outcomes; dashed: 5, 50 and 95 %", fontsize=11)
    return drawing


def _bins(there: np.ndarray) -> np.ndarray:
    count = int(np.clip(np.sqrt(len(there)), 8, 60))
    low, high = float(there[0]), float(there[-1])
    if high - low <= 1e-12 * max(abs(low), abs(high)):  # one value
        half = 0.5 * abs(low) or 0.5
        low, high = low - half, high + half
    elif high - low <= MOST_WHOLE and bool(np.all(there == np.round(there))):  # integers: one bar each
        return np.arange(low - 0.5, high + 1.0)
    return np.linspace(low, high, count + 1)


def _scatter(campaign: Plan, table: Table) -> Figure:
    """Return scatter plots of every outcome over every varied parameter, with the rank correlation."""
    rows, columns = len(table.outcomes), len(table.parameters)
    size = (max(4.5, 2.25 * columns + 0.6), 1.75 * rows + 0.8)
    drawing, panels = new_panels(rows, columns, size, squeeze=False, sharex="col")
    for row, (name, values) in enumerate(table.outcomes.items()):
        there = np.isfinite(values)
        for column, (parameter, varied) in enumerate(table.parameters.items()):
            panel = panels[row, column]
            shown = np.flatnonzero(there)[:MOST_POINTS]  # samples are independent, so the first ones represent all
            thin = float(np.clip(100 / max(1, len(shown)), 0.0, 1.0))  # few points are large and opaque
            panel.plot(varied[shown], values[shown], ".", color=BLUE, markersize=2.5 + 4.5 * thin,
                       alpha=0.35 + 0.5 * thin, markeredgewidth=0, rasterized=True)
            rank = spearman(varied, values)
            text = "ρ: one value only" if rank is None else f"ρ = {round(rank, 2) + 0.0:.2f}"  # no -0.00
            panel.set_title(text, fontsize=8,
                            color=ORANGE if rank is not None and abs(rank) >= 0.3 else "0.35", pad=3)
            _small(panel)
            if column == 0:
                panel.set_ylabel(_wrapped(_label(name, campaign.units[name]), 20), fontsize=7.5)
            else:
                panel.tick_params(labelleft=False)
                panel.yaxis.get_offset_text().set_visible(False)
                panel.sharey(panels[row, 0])
            if row == rows - 1:
                panel.set_xlabel(_wrapped(_label(parameter, campaign.unit_of(parameter)), 24), fontsize=8)
    drawing.suptitle(f"{campaign.title}: outcomes against what varies, ρ: Spearman", fontsize=11)
    return drawing


def _sweep(campaign: Plan, table: Table) -> Figure:
    """Draw outcomes over the first varied parameter, with a line for every combination of the other parameters."""
    first, *others = campaign.vary
    along = table.parameters[first.keys[0]]
    rest = [table.parameters[parameter.keys[0]] for parameter in others]
    combinations = sorted(set(zip(*rest))) if rest else [()]
    columns = 3
    rows = -(-len(table.outcomes) // columns)
    drawing, panels = new_panels(rows, columns, (10.5, 3.0 * rows + 0.3), squeeze=False)
    for panel in panels.flat[len(table.outcomes):]:
        panel.set_axis_off()
    few = len(combinations) <= MOST_LINES
    for panel, (name, values) in zip(panels.flat, table.outcomes.items()):
        for number, combination in enumerate(combinations):
            here = np.ones(len(along), dtype=bool)
            for column, wanted in zip(rest, combination):
                here &= column == wanted
            order = np.argsort(along[here], kind="stable")
            text = ", ".join(
                f"{parameter.keys[0]} = {value:g}" for parameter, value in zip(others, combination)
            )
            colour = LINES[number] if few else colormaps["viridis"](number / (len(combinations) - 1))
            # Later lines are thinner, so that lines below them remain visible.
            width = 1.2 + (1.3 * (len(combinations) - 1 - number) if few else 0.0)
            panel.plot(along[here][order], values[here][order], "o-", color=colour, markersize=1.8 + width,
                       linewidth=width, label=text or None)
        panel.set_xlabel(_label(first.keys[0], campaign.unit_of(first.keys[0])))
        panel.set_ylabel(_wrapped(_label(name, campaign.units[name]), 30), fontsize=8)
        _small(panel)
        if isinstance(first, Values) and first.spacing == "log":
            panel.set_xscale("log")
        if not np.any(np.isfinite(values)):
            panel.set_title("In no sample", fontsize=8)
    title = campaign.title
    if others and few:
        panels[0, 0].legend(loc="best", fontsize=7, framealpha=1)
    elif others:
        title += f"; {len(combinations)} lines, dark to light: {', '.join(p.keys[0] for p in others)} rising"
    drawing.suptitle(title, fontsize=11)
    return drawing
