#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the trace of a rib around the first slip of its joint: docs/howto/trace.png.

    PYTHONPATH=build/python /usr/bin/python3 studies/docs/make_trace.py
"""
from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd
import statejump as sj
from statejump.core import figures
from statejump.kinds.truss.trace import COLUMNS

REPOSITORY = Path(__file__).resolve().parents[2]
INCREMENTS = (19, 23)  # increments of 2 K each; the joint slips at 42 K
STEPS = {"done": ("o", "#009E73", "step done"), "event_inside": ("x", "#D55E00", "step rejected: event inside")}
DECISIONS = {
    "step": ("o", "#0072B2", "Newton step"),
    "status_change": ("^", "#D55E00", "change of status"),
    "event_ahead": ("x", "#D55E00", "event ahead"),
    "converged": ("s", "#009E73", "converged"),
}


def main() -> None:
    """Run and draw."""
    found: list[tuple[Any, ...]] = []
    sj.truss.umbrella(1).reduced(trace=found.append)
    rows = pd.DataFrame(found, columns=COLUMNS)
    rows = rows[(rows["branch"] == 1) & rows["increment"].between(*INCREMENTS)].reset_index(drop=True)
    with figures.style():
        figure, (above, below) = figures.panels(2, 1, (8.0, 6.5))
        above.plot(rows.index, rows["temperature_change_K"], color="0.7", linewidth=0.8, drawstyle="steps-mid")
        for end, (marker, color, label) in STEPS.items():
            chosen = rows[rows["step_end"] == end]
            above.plot(chosen.index, chosen["temperature_change_K"], marker, color=color, label=label)
        above.set_ylabel("Temperature change [K]")
        smallest_N = 1e-17  # zero has no place on the axis
        for _, solved in rows.groupby("solve"):
            below.plot(solved.index, solved["node_residual_N"].clip(smallest_N), color="0.7", linewidth=0.8)
        for decision, (marker, color, label) in DECISIONS.items():
            chosen = rows[rows["decision"] == decision]
            below.plot(chosen.index, chosen["node_residual_N"].clip(smallest_N), marker, color=color, label=label)
        below.set_yscale("log")
        below.set_ylim(1e-18, 1e4)  # room for the legend
        below.set_ylabel("Residual of the nodes [N]")
        for axes in (above, below):
            axes.set_xlabel("Iteration")
        above.legend(loc="upper left")
        below.legend(loc="lower center", ncol=len(DECISIONS))
        figure.suptitle("Trace of a rib around the first slip of its joint")
        figure.savefig(REPOSITORY / "docs" / "howto" / "trace.png", dpi=110)


if __name__ == "__main__":
    main()
