# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures for the answers on a truss: the truss with magnified jumps, and the ranking of its joints."""
from __future__ import annotations

from math import floor, log10
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from statejump.core.figures import Constrained, Drawing, panels, style
from statejump.kinds.truss.answers.contributions import Contributions
from statejump.kinds.truss.answers.jumps import node_jumps, rounding_m
from statejump.kinds.truss.answers.outputs import Output
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath

JUMPS = colormaps["cividis_r"]  # small is light, large is dark: readable in grey and for colour-blind eyes
BLUE, ORANGE, DRAWN = "#0072B2", "#D55E00", "0.72"
SHOWN = 0.12  # drawn size of the largest jump, as a fraction of the truss' size
MARKED = 5  # joints
MOST_BARS = 15
_UNITS = ((1e-3, "mm", 1e3), (1e-6, "µm", 1e6), (0.0, "nm", 1e9))


def readable(value: float, unit: str) -> tuple[float, str]:
    """Return factor and unit that make a value readable."""
    if unit == "rad":
        return (1e3, "mrad") if abs(value) >= 1e-3 else (1e6, "µrad")
    return next((factor, name) for least, name, factor in _UNITS if abs(value) >= least)


def magnification(truss: ResolvedTruss, largest_jump_m: float) -> float:
    """Return a round factor that magnifies the largest jump to about SHOWN times the size of the truss."""
    if largest_jump_m == 0:
        return 1.0
    wanted = SHOWN * float(np.ptp(truss.nodes.position_m, axis=0).max()) / largest_jump_m
    power = 10.0 ** floor(log10(wanted))
    return power * max(step for step in (1, 2, 5) if step * power <= wanted * (1 + 1e-12))


def joint_places(truss: ResolvedTruss) -> np.ndarray:
    """Return the node of every joint, type by type."""
    return np.concatenate([joint.place_nodes(truss, truss.joints[joint.section]) for joint in JOINTS]).astype(int)


def jumps_figure(found: TrussPath, shares: Contributions | None, title: str) -> Figure:
    """Draw the truss in its reference configuration and with magnified jumps; number the first MARKED joints."""
    truss = found.truss
    jump = node_jumps(found)[-1]
    jump = np.where(np.linalg.norm(jump, axis=1, keepdims=True) > rounding_m(found), jump, 0.0)
    size = np.linalg.norm(jump, axis=1)
    factor, unit = readable(float(size.max()), "m")
    scale = magnification(truss, float(size.max()))
    drawn, moved = truss.nodes.position_m, truss.nodes.position_m + scale * jump
    lines = np.concatenate(truss.ends())
    colours = ScalarMappable(Normalize(0, float(size.max()) * factor or 1.0), JUMPS)
    flat = truss.dimension == 2
    axes = slice(0, truss.dimension)
    extent = np.ptp(np.concatenate((drawn, moved))[:, axes], axis=0)
    with style():
        if flat:
            shape = np.maximum(extent, 0.25 * extent.max())
            wide, tall = shape * min(7.0 / shape[0], 6.0 / shape[1])
            drawing = Drawing(figsize=(wide + 3.0, tall + 1.7), layout=Constrained())
            panel = drawing.add_subplot()
            collection: Any = LineCollection
        else:
            drawing = Drawing(figsize=(8.0, 6.6))
            panel = drawing.add_axes((0.0, 0.02, 0.86, 0.86), projection="3d", computed_zorder=False)
            collection = Line3DCollection
        add = panel.add_collection if flat else panel.add_collection3d
        add(collection(list(drawn[lines][..., axes]), colors=DRAWN, linewidths=1.0, zorder=1))
        add(collection(list(moved[lines][..., axes]), colors=colours.to_rgba(size[lines].mean(axis=1) * factor),
                       linewidths=1.8, zorder=2))
        panel.plot(*drawn[:, axes].T, "o", color=DRAWN, markersize=3, linestyle="none", zorder=1)
        dots = dict(c=size * factor, cmap=JUMPS, norm=colours.norm, s=22, zorder=3, edgecolors="0.2", linewidths=0.4)
        panel.scatter(*moved[:, axes].T, **dots)
        if shares is not None and shares.jump != 0:
            _mark(panel, truss, shares, moved[:, axes])
        panel.set_xlabel("x [m]", labelpad=4 if flat else 10)
        panel.set_ylabel("y [m]", labelpad=4 if flat else 10)
        if flat:
            panel.set_aspect("equal")
            reach = 0.58 * shape
        else:
            panel.set_zlabel("z [m]", labelpad=10)
            panel.tick_params(labelsize=8)
            reach = 0.54 * np.maximum(extent, 0.25 * extent.max())
            panel.set_box_aspect(tuple(reach), zoom=0.95)
            panel.view_init(elev=22, azim=-55)
        middle = (np.concatenate((drawn, moved)).max(axis=0) + np.concatenate((drawn, moved)).min(axis=0))[axes] / 2
        for axis, centre, half in zip("xyz", middle, reach):
            getattr(panel, f"set_{axis}lim")(centre - half, centre + half)
        drawing.colorbar(colours, ax=panel, label=f"Jump of a node [{unit}]", shrink=0.8 if flat else 0.6,
                         pad=0.02 if flat else 0.1)
        cycles = len(found.cycle_ends["time_s"]) - 1
        after = f"after {cycles} cycle{'s' if cycles > 1 else ''}"
        text = (f"Jumps {after}, {scale:g} times magnified; grey: as drawn" if size.any()
                else f"No node jumps {after}")
        if shares is not None and shares.jump != 0:
            text += "; numbers: rank of a joint"
        wrapped = fill(text, int(13 * drawing.get_figwidth()))
        drawing.suptitle(f"{title}\n{wrapped}", fontsize=10)
        return drawing


def _mark(panel: Axes, truss: ResolvedTruss, shares: Contributions, places: np.ndarray) -> None:
    """Draw rank numbers beside the joints with the largest contributions, on the outside of the truss."""
    nodes, middle = joint_places(truss), places.mean(axis=0)
    extent = np.ptp(places, axis=0).max()
    for rank, joint in enumerate(shares.order[:MARKED], start=1):
        if shares.contribution[joint] == 0:
            return
        place = places[nodes[joint]]
        panel.plot(*np.array([place]).T, "o", markersize=11, markerfacecolor="none", markeredgecolor=ORANGE,
                   markeredgewidth=1.5, zorder=5, linestyle="none")
        away = place - middle
        away = away / max(float(np.linalg.norm(away)), 1e-12)
        if np.ptp(places[:, -1]) < 0.05 * extent and len(place) == 2:
            away = np.array([0.0, 1.0])  # all nodes on one line
        style = dict(fontsize=9, color=ORANGE, fontweight="bold", ha="center", va="center", zorder=6)
        if len(place) == 2:
            panel.annotate(str(rank), tuple(place), xytext=tuple(14 * away), textcoords="offset points", **style)
        else:
            panel.text(*(place + 0.07 * extent * away), str(rank), **style)


def ranking_figure(shares: Contributions, output: Output, title: str) -> Figure:
    """Draw bars for the largest contributions, for all other joints together, for the sum, and for the jump."""
    factor, unit = readable(shares.jump, output.unit)
    order = shares.order[np.abs(shares.contribution[shares.order]) > 0]
    shown, rest = order[:MOST_BARS], order[MOST_BARS:]
    labels = [shares.names[joint] for joint in shown]
    values = [shares.contribution[joint] for joint in shown]
    if len(rest):
        labels.append(f"{len(rest)} others")
        values.append(shares.contribution[rest].sum())
    with style():
        drawing, panel = panels(1, 1, (7.4, 1.6 + 0.27 * len(labels)))
        bars = np.array(values) * factor
        panel.barh(np.arange(len(bars)), bars, color=np.where(bars * np.sign(shares.jump) >= 0, BLUE, ORANGE), zorder=2)
        panel.set_yticks(np.arange(len(bars)), labels)
        panel.invert_yaxis()
        panel.axvline(0, color="black", linewidth=0.8)
        reach = max(np.abs(bars).max(), 1e-300)
        for place, bar in enumerate(bars):
            share = 100 * bar / (shares.jump * factor)
            panel.annotate(f"{share:.3g} %", (max(bar, 0.0), place), xytext=(3, 0), textcoords="offset points",
                           va="center", fontsize=8)
        panel.set_xlim(min(bars.min() * 1.05, 0), max(bars.max(), 0) + 0.16 * reach)
        panel.set_xlabel(f"Contribution to the jump [{unit}] (blue: with it, orange: against it)")
        panel.set_title(f"{output.text[:1].upper()}{output.text[1:]}: jump {shares.jump * factor:.5g} {unit}, "
                        f"sum of joints {shares.contribution.sum() * factor:.5g} {unit}", fontsize=8)
        drawing.suptitle(f"{title}: joints that hold the jump", fontsize=10)
        return drawing
