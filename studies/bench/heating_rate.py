#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Energies of creak and snap over the heating rate; writes results/motion/heating_rate.md, .csv and .png.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/heating_rate.py [--case NAME]

Two cases run with several periods and equal time steps: a chain of blocks that slip one after the other, and a shallow
arch of two bars with play that snaps through.
"""
from __future__ import annotations

from typing import Any

import numpy as np
import statejump as sj
from run import parse_cases, publish, start
from statejump.core import figures
from statejump.core.errors import StatejumpError

# By case: the observed node, periods [s], steps per second.
CASES: dict[str, tuple[str, tuple[float, ...], float]] = {
    "chain_10": ("N10", (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0), 20_000.0),
    "two_bar_snap": ("B", (0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0), 20_000.0),
}
COLUMNS = ("case", "node", "period_s", "rate_K_per_s", "slips", "peak_m_per_s2", "rms_m_per_s2", "heat_J",
           "largest_heat_J", "fastest_m_per_s", "at_K")
NAMES = {"chain_10": "chain of 10 blocks", "two_bar_snap": "two bars that snap through"}


def row(name: str, period_s: float) -> dict[str, Any]:
    """Return what one rate of heating does."""
    node, _, steps = CASES[name]
    case = sj.load(f"cases/trusses/{name}.toml").changed({
        "thermal.period_s": period_s, "motion.steps_per_cycle": int(steps * period_s),
        "output.samples_per_cycle": 2000, "reduced.sticking": "elastic"})
    found = sj.truss.creak(case, node)
    speed = np.linalg.norm(found.run["velocity_m_per_s"][:, found.run.names["nodes"].index(node)], axis=1)
    heats = [slip["heat_J"] for slip in found.slips]
    return {
        "case": name, "node": node, "period_s": period_s,
        "rate_K_per_s": 2 * float(found.run["temperature_change_K"].max()) / period_s, "slips": len(heats),
        "peak_m_per_s2": found.peak_m_per_s2, "rms_m_per_s2": found.rms_m_per_s2, "heat_J": sum(heats),
        "largest_heat_J": max(heats), "fastest_m_per_s": float(speed.max()),
        "at_K": float(found.run["temperature_change_K"][int(np.argmax(speed))]),
    }


def picture(rows: list[dict[str, Any]], path: Any) -> None:
    """Draw the quantities that decrease with the heating rate, and those that do not."""
    with figures.style():
        figure, places = figures.panels(1, 2, (10.0, 4.2))
        for (name, marker, color) in (("chain_10", "o-", "#0072B2"), ("two_bar_snap", "s--", "#D55E00")):
            of_case = [one for one in rows if one["case"] == name]
            rate = [one["rate_K_per_s"] for one in of_case]
            for axes, key in zip(places, ("peak_m_per_s2", "fastest_m_per_s")):
                axes.loglog(rate, [one[key] for one in of_case], marker, color=color, label=NAMES[name])
        places[0].set_ylabel("Peak acceleration [m/s²]")
        places[1].set_ylabel("Largest speed [m/s]")
        for axes in places:
            axes.set_xlabel("Rate of heating [K/s]")
            axes.legend()
        figure.suptitle("Creak falls with the rate of heating, a snap does not")
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=110)


def report(rows: list[dict[str, Any]]) -> str:
    """Return the table as Markdown."""
    table = "\n".join(
        f"| {one['case']}, {one['node']} | {one['period_s']:g} s | {one['rate_K_per_s']:.3g} | {one['slips']} | "
        f"{one['peak_m_per_s2']:.3g} | {one['rms_m_per_s2']:.3g} | {one['heat_J']:.4g} | "
        f"{one['largest_heat_J']:.3g} | "
        f"{one['fastest_m_per_s']:.4g} | {one['at_K']:.4g} |" for one in rows)
    heads = ("node", "period", "rate [K/s]", "slips", "peak [m/s²]", "RMS [m/s²]", "heat [J]", "largest [J]",
             "fastest [m/s]", "at [K]")
    return f"""# Creak and snap by the rate of heating

Trusses in motion with {CASES['chain_10'][2]:,.0f} steps per second, elastic sticking, and the dashpots of the cases.
The columns have the peak acceleration of the node, the heat of all slips and of the largest one, and the largest
speed with its temperature change. A slide that is slow enough to stop and begin again between two steps counts as
several slips.

| {' | '.join(heads)} |
|---{'|--:' * (len(heads) - 1)}|
{table}

![Peak acceleration and largest speed over the rate of heating](heating_rate.png)

Explanation: [Run a truss in motion](../../docs/howto/motion.md#creak-and-snap).

## Again

```
PYTHONPATH=build/python /usr/bin/python3 studies/bench/heating_rate.py [--case NAME]
```
"""


def main() -> None:
    """Measure and write."""
    arguments = parse_cases(__doc__.splitlines()[0], CASES)
    rows = []
    for name in arguments.case:
        for period_s in CASES[name][1]:
            rows.append(row(name, period_s))
            print(rows[-1], flush=True)
    picture(rows, arguments.output / "heating_rate.png")
    publish(arguments.output, "heating_rate", COLUMNS, rows, report(rows))


if __name__ == "__main__":
    start(main, StatejumpError)
