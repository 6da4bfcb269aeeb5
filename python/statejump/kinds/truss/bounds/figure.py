# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of bounds: bars of each output, spread over the temperature range, rest states in a plane."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from statejump.core.figures import panels, style
from statejump.kinds.truss.answers.figure import JUMPS, MARKED, joint_places, readable
from statejump.kinds.truss.bounds.outputs import Output
from statejump.kinds.truss.bounds.sliding import AXES
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss

BARS = (("spread", "bound, any history", "#0072B2"), ("range_spread", "bound within the range", "#56B4E9"),
        ("attained", "attained by a history", "#009E73"), ("simulated", "simulated jump of the case", "#E69F00"))

MOST_SECTORS = 24  # revolutes in the picture of contact directions


def bars(name: str, bounds: Sequence[Any]) -> Any:
    """Draw the bars of outputs (:class:`~statejump.kinds.truss.bounds.result.Bound`), one panel for each unit."""
    units = [unit for unit in ("m", "rad") if any(bound.output.unit == unit for bound in bounds)]
    with style():
        figure, axes = panels(len(units), 1, (7.0, 0.3 + 0.9 * len(units) + 0.85 * len(bounds)))
        for unit, one in zip(units, np.atleast_1d(axes)):
            _bars(one, unit, [bound for bound in bounds if bound.output.unit == unit])
        figure.suptitle(f"{name}: how far the truss may come back", fontsize=10)
    return figure


def _bars(axes: Axes, unit: str, bounds: Sequence[Any]) -> None:
    values = np.array([[getattr(bound, what) for what, _, _ in BARS] for bound in bounds], dtype=float)
    values[np.isinf(values)] = np.nan
    largest = float(np.nanmax(values, initial=0.0))
    factor, shown = readable(largest, unit)
    height = 0.8 / len(BARS)
    for kind, (_, label, colour) in enumerate(BARS):
        if np.isnan(values[:, kind]).all():
            continue
        place = np.arange(len(bounds)) + (kind - 1.5) * height
        drawn = axes.barh(place, np.nan_to_num(values[:, kind]) * factor, height, color=colour, label=label)
        axes.bar_label(drawn, ["" if np.isnan(value) else f"{value * factor:.4g}" for value in values[:, kind]],
                       padding=3)
    axes.set_yticks(np.arange(len(bounds)), [bound.output.name for bound in bounds])
    axes.invert_yaxis()
    axes.set_xlim(0, 1.15 * (largest or 1e-9) * factor)
    axes.set_xlabel(f"difference between two rest states [{shown}]")
    axes.grid(False, axis="y")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.45 / len(bounds)), ncols=2, frameon=False)


def staircase(name: str, output: Output, bound: float, highest_K: float, lowest_K: float, factors: np.ndarray,
              spread: np.ndarray) -> Any:
    """Draw the spread of an output over the width of the temperature range.

    :param bound: spread over any history
    :param highest_K: highest ΔT of the range of factor 1; ``lowest_K``: its lowest ΔT
    """
    factor, unit = readable(bound, output.unit)
    with style():
        figure, axes = panels(1, 1, (6.4, 3.6))
        width = (highest_K - lowest_K) * factors
        axes.plot(width, spread * factor, "o-", color=BARS[1][2], markersize=3.5, label=BARS[1][1])
        axes.axhline(bound * factor, color=BARS[0][2], linestyle=(0, (5, 2)), label=BARS[0][1])
        axes.axvline(highest_K - lowest_K, color="0.4", linewidth=1, linestyle=":", label="range of the command")
        axes.set_xscale("log")
        axes.set_ylim(0, 1.1 * bound * factor)
        axes.set_xlabel("width of the temperature range [K]")
        axes.set_ylabel(f"spread of {output.name} [{unit}]")
        axes.legend(loc="upper left", bbox_to_anchor=(0.0, 0.9), frameon=False)
        figure.suptitle(f"{name}: {output.name} over the temperature range", fontsize=10)
    return figure


def zonogon_figure(name: str, bound: Any) -> Any:
    """Draw the rest states of an output with two components, and where the case starts and ends."""
    corners = bound.corners
    factor, unit = readable(0.5 * bound.spread, bound.output.unit)
    with style():
        figure, axes = panels(1, 1, (5.0, 4.8))
        axes.fill(*(factor * corners.T), facecolor="#56B4E9", alpha=0.35, edgecolor=BARS[0][2], label="rest states")
        if len(bound.path):
            ends = factor * bound.path[[0, -1]]
            axes.plot(*ends.T, ":", color=BARS[3][2], linewidth=1)
            axes.plot(*ends[0], "o", color="0.3", markersize=4, label="start of the case")
            axes.plot(*ends[-1], "o", color=BARS[3][2], markersize=5, label="its end")
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_xlabel(f"first component [{unit}]")
        axes.set_ylabel(f"second component [{unit}]")
        axes.legend(loc="best", frameon=False)
        figure.suptitle(f"{name}: {bound.output.name} from the state without friction", fontsize=10)
    return figure


def coloured(truss: ResolvedTruss, joints: Sequence[str], bound: Any) -> Any:
    """Draw the truss with a circle at every joint, whose area and colour are its contribution to a bound."""
    node_of = {f"{section} '{name}'": node for section, name, node in _joints(truss)}
    place = truss.nodes.position_m[[node_of[joint] for joint in joints]]
    seen = np.sort(np.argsort(-np.ptp(truss.nodes.position_m, axis=0), kind="stable")[:2])
    percent = 100 * bound.fraction
    with style():
        figure, axes = panels(1, 1, (6.4, 4.4))
        lines = truss.nodes.position_m[np.concatenate(truss.ends()).astype(int)][..., seen]
        axes.add_collection(LineCollection(list(lines), colors="0.72", linewidths=1, zorder=1))
        drawn = axes.scatter(*place[:, seen].T, s=20 + 3 * percent, c=percent, cmap=JUMPS, vmin=0, zorder=2,
                             edgecolors="0.2", linewidths=0.5)
        figure.colorbar(drawn, ax=axes, label="contribution of the joint [%]")
        for index in np.argsort(-percent, kind="stable")[:MARKED]:
            axes.annotate(joints[index].partition("'")[2].rstrip("'"), place[index, seen], xytext=(5, 5),
                          textcoords="offset points", fontsize=8)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_xlabel(f"{AXES[seen[0]]} [m]")
        axes.set_ylabel(f"{AXES[seen[1]]} [m]")
        figure.suptitle(f"{truss.name}: contributions to {bound.output.name}", fontsize=10)
    return figure


def _joints(truss: ResolvedTruss) -> list[tuple[str, str, int]]:
    names = [(joint.section, name) for joint in JOINTS for name in truss.joints[joint.section].names]
    return [(section, name, int(node)) for (section, name), node in zip(names, joint_places(truss))]


def sectors_figure(name: str, contacts: Any) -> Any:
    """Draw the bearings of revolutes with the sector of all contacts, the contact without friction and its force.

    :param contacts: :class:`~statejump.kinds.truss.bounds.contacts.Contacts`
    """
    of, at = contacts.wide.of, contacts.wide.at
    shown = min(of.count, MOST_SECTORS)
    across = min(shown, 4)
    down = -(-shown // across)
    with style():
        figure, axes = panels(down, across, (1.9 * across + 0.4, 2.1 * down + 0.5))
        for index, panel in enumerate(np.atleast_1d(axes).ravel()):
            panel.set_axis_off()
            if index >= shown:
                continue
            angle = np.linspace(0, 2 * np.pi, 200)
            panel.plot(np.cos(angle), np.sin(angle), color="0.6", linewidth=1)
            within = np.linspace(at.least_rad[index], at.most_rad[index], 60)
            panel.fill([0, *np.cos(within)], [0, *np.sin(within)], facecolor=BARS[1][2], alpha=0.5)
            way = of.shift_m[index] / np.linalg.norm(of.shift_m[index])
            panel.plot([0, way[0]], [0, way[1]], color=BARS[0][2], linewidth=1.5)
            panel.set_aspect("equal")
            panel.set_title(f"{of.joints[index].name}\n± {np.rad2deg(at.half_rad[index]):.1f}°", fontsize=8)
        figure.suptitle(f"{name}: directions of contacts; line: without friction", fontsize=10)
    return figure
