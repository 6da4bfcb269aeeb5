# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of a design: the case, tables, a page of text and a picture."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.figures import panels, save, style
from statejump.core.tables import Shown, markdown, write_json, write_markdown, write_rows
from statejump.design.result import Design

ORANGE, BLUE, GREY = "#E69F00", "#0072B2", "0.6"
MOST_BARS = 60


def write(found: Design, folder: Path) -> list[Path]:
    """Write all files and return their paths."""
    return [found.case.save(folder / f"{found.case.name}.toml"), write_json(folder / "design.json", found.record()),
            write_rows(folder / "variables.csv", found.moved()), write_rows(folder / "requirements.csv", found.met()),
            write_markdown(folder / "design.md", _page(found)), *save(figure(found), folder, "design")]


def _page(found: Design) -> list[str]:
    lines = [f"# Design of {found.base.title}", "", *(f"- {one[0].upper()}{one[1:]}." for one in found.sentences), "",
             f"`{found.case.name}.toml` is the designed case.", "", "![Factors, friction and scatter](design.png)"]
    for part in found.summary_lines():
        if isinstance(part, Shown):
            lines += ["", f"## {part.title[0].upper()}{part.title[1:]}", "", *markdown(
                part.header, part.rows, [place for place, head in enumerate(part.header) if head not in part.left])]
    return lines


def figure(found: Design) -> Any:
    """Draw what moved, the values over friction, and the random samples."""
    with style():
        drawing, (moved, friction, scatter) = panels(1, 3, (12.0, 3.6))
        _moved(found, moved)
        _friction(found, friction)
        _scatter(found, scatter)
        drawing.suptitle(f"{found.base.title}: {found.verdict}, cost {found.cost:.5g}", fontsize=11)
    return drawing


def _moved(found: Design, axes: Any) -> None:
    groups = list(zip(found.groups, found.x))[:MOST_BARS]
    factors = np.array([group.factor(float(x)) for group, x in groups])
    start = np.array([0.0 if group.shifts else 1.0 for group, _ in groups])
    axes.barh(np.arange(len(groups)), factors - start, left=start, color=ORANGE)
    axes.set_yticks(np.arange(len(groups)), [group.label for group, _ in groups], fontsize=6)
    axes.invert_yaxis()
    if all(group.log for group, _ in groups):
        axes.set_xscale("log")
    axes.axvline(1.0 if start.all() else 0.0, color="black", linewidth=0.8)
    axes.set_xlabel("Factor or shift [m]")


def _friction(found: Design, axes: Any) -> None:
    if found.profile is None:
        axes.set_axis_off()
        return
    axes.plot(found.profile.factors, found.profile.before, color=GREY, label="unchanged case")
    axes.plot(found.profile.factors, found.profile.worst, color=BLUE, label="design")
    axes.axhline(1.0, color="black", linestyle="--", linewidth=0.8, label="limit")
    for one in sorted({row.setting.friction for row in found.rows if row.setting is not None}):
        axes.axvline(one, color=ORANGE, linewidth=0.6)
    axes.set_xscale("log")
    axes.set_xlabel("Factor on friction")
    axes.set_ylabel("Largest value over its limit")
    axes.legend(fontsize=7)


def _scatter(found: Design, axes: Any) -> None:
    if found.scatter is None or not np.isfinite(found.scatter.worst).any():
        axes.set_axis_off()
        return
    axes.hist(1 - found.scatter.worst[np.isfinite(found.scatter.worst)], bins=40, color=BLUE)
    axes.axvline(1.0, color="black", linestyle="--", linewidth=0.8)
    axes.set_xlabel("Largest value over its limit")
    axes.set_ylabel("Samples")
