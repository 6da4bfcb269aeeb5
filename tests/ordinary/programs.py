# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature programs as in orbits: plateaus, shade, cooling first, several cycles, intervals of constant temperature.
"""
from __future__ import annotations

import numpy as np

from sketch import Document

Random = np.random.Generator
# Temperature change at equally spaced times, over its largest value.
TABLES: dict[str, list[float]] = {
    "plateau": [0, 1, 1, 0],
    "shade": [0, 0.9, 1, 0.95, -0.6, -0.7, -0.5, 0],
    "cold_first": [0, -0.8, -0.8, 0.6, 1, 0],
    "rests": [0, 0, 1, 0, 0, -0.5, 0, 0],
    "steps": [0, 0.3, 0.3, 0.7, 0.7, 1, 0.5, 0],
    "again": [0, 1, 0.5, 1, -0.2, 0.3, 0],
}


def table(kind: str, largest_K: float, period_s: float, cycles: int) -> Document:
    """Return a temperature program from table rows, with a given period."""
    values = TABLES[kind]
    times = np.linspace(0, period_s, len(values))
    return {
        "shape": "table", "cycles": cycles, "table_time_s": [float(time) for time in times],
        "table_temperature_change_K": [largest_K * value for value in values],
    }


def program(rng: Random) -> Document:
    """Return a temperature program."""
    largest = float(np.round(rng.uniform(15, 150), 1)) * (1 if rng.random() < 0.75 else -1)
    cycles = int(rng.choice([1, 1, 2, 3]))
    period = float(rng.choice([1.0, 60.0, 5400.0]))
    kind = str(rng.choice(["half_sine", "triangle", "sine", "table"], p=[0.3, 0.3, 0.1, 0.3]))
    if kind == "table":
        return table(str(rng.choice(list(TABLES))), largest, period, cycles)
    return {"shape": kind, "temperature_change_max_K": largest, "cycles": cycles, "period_s": period}


def of_others(rng: Random, common: Document) -> Document:
    """Return the program of shaded bars: the common duration, a smaller change, another shape."""
    table_s = common.get("table_time_s")
    period, cycles = table_s[-1] if table_s else common["period_s"], common["cycles"]
    largest = float(np.round(rng.uniform(5, 60), 1)) * (1 if rng.random() < 0.5 else -1)
    return {"name": "shade", **table(str(rng.choice(list(TABLES))), largest, period, cycles)}


def largest_K(thermal: Document) -> float:
    """Return the largest temperature change of a program."""
    if thermal["shape"] == "table":
        return float(np.abs(thermal["table_temperature_change_K"]).max())
    return float(abs(thermal["temperature_change_max_K"]))
