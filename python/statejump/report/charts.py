# SPDX-License-Identifier: GPL-3.0-or-later
"""Which curves a page shows for a kind of case, and how their axes are called and scaled."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np

from statejump.core import units
from statejump.results import Result
from statejump.report import words


@dataclass(frozen=True)
class Axis:
    """An axis of a chart: which column, what it is called."""

    column: str
    label: str = ""
    from_start: bool = False  # shows the change since the first sample


@dataclass(frozen=True)
class Chart:
    """Curves of all models over each other."""

    x: Axis
    y: Axis
    title: str
    equal: bool = False  # same scale on both axes
    rings_m: tuple[float, ...] = field(default=())  # circles about the origin
    stages: bool = False
    marks: bool = False  # events and jump


TEMPERATURE = Axis("temperature_change_K", "Temperature change")
TIME = Axis("time_s", "Time")
NOT_SHOWN = {"time_s", "temperature_change_K", "slipping", "stop_contact", "stage"}
MOST_OTHER_LOOPS = 4
STATE_UNITS = {"m", "rad"}  # of places: forces have no state jump


def charts_of(result: Result) -> list[Chart]:
    """Return the charts of a run, loops first."""
    if result.kind == "spring_slider":
        x = Axis("displacement_m")
        force = Axis("axial_force_N")
        return [
            Chart(TEMPERATURE, x, "Displacement-temperature loop", marks=True),
            Chart(TEMPERATURE, force, "Force-temperature loop", marks=True),
            Chart(TIME, x, "Displacement over time", stages=True),
            Chart(TIME, force, "Axial force over time", stages=True),
        ]
    if result.kind == "umbrella":
        theta2 = Axis("theta2_rad", "Deflection of AB, θ2 − θ2(0)", from_start=True)
        theta4 = Axis("theta4_rad", "Deflection of BC, θ4 − θ4(0)", from_start=True)
        return [
            Chart(TEMPERATURE, theta2, "Deflection-temperature loop", marks=True),
            Chart(TEMPERATURE, theta4, "Deflection-temperature loop of BC", marks=True),
            Chart(
                Axis("eccentricity_x_m", "Journal − bearing centre, along AC"), Axis("eccentricity_y_m", "across AC"),
                "Journal in its clearance", equal=True, rings_m=(result.scene["smallest_clearance_m"],),
            ),
            Chart(TIME, Axis("normal_force_N", "Normal force at the samples"), "Contact force over time"),
        ]
    return [
        Chart(TEMPERATURE, Axis(name), f"{words.column(name)} over temperature", marks=True)
        for name in _plain_columns(result)[:MOST_OTHER_LOOPS]
    ]


def _plain_columns(result: Result) -> list[str]:
    run = next(iter(result.models.values()))
    return [
        name for name, column in run.history.items()
        if name not in NOT_SHOWN and column.values.ndim == 1 and not column.labels and np.ptp(column.values) > 0
    ]


def _shown_axis(axis: Axis, columns: dict[str, dict[str, np.ndarray]], unit_of: dict[str, str]) -> dict[str, Any]:
    """Return an axis for the page: offset and factor of the values, label with unit."""
    found = [values[axis.column] for values in columns.values() if axis.column in values]
    start = float(found[0][0]) if axis.from_start else 0.0
    size = max(float(np.nanmax(np.abs(values - start))) for values in found)
    scale, unit = units.scale_of(unit_of.get(axis.column, "-"), size)
    label = axis.label or words.column(axis.column)
    return {"column": axis.column, "label": f"{label} [{unit}]" if unit else label, "unit": unit, "scale": scale,
            "start": start}


def shown(
    chart: Chart, columns: dict[str, dict[str, np.ndarray]], unit_of: dict[str, str], marks: list[dict[str, Any]]
) -> Optional[dict[str, Any]]:
    """Return a chart for the page; None if no model has its columns.

    :param columns: by model and name
    :param unit_of: unit of every column
    :param marks: events to mark: ``time_s``, ``label``, ``value``, ``role``; the value of a ``jump`` is
        that of the chart's own quantity
    """
    models = [model for model, values in columns.items() if {chart.x.column, chart.y.column} <= set(values)]
    if not models:
        return None
    x, y = (_shown_axis(axis, columns, unit_of) for axis in (chart.x, chart.y))
    if chart.equal:  # one unit for both
        larger = min(x, y, key=lambda axis: axis["scale"])
        for axis in (x, y):
            axis.update(
                label=axis["label"].replace(f"[{axis['unit']}]", f"[{larger['unit']}]"), unit=larger["unit"],
                scale=larger["scale"],
            )
    placed = []
    if chart.marks:
        values = columns[models[0]]
        ends = values[chart.y.column][[0, -1]]
        for mark in marks:
            if mark["role"] == "jump":
                if unit_of.get(chart.y.column) not in STATE_UNITS:
                    continue
                mark = {**mark, "value": units.text(float(ends[1] - ends[0]), unit_of[chart.y.column], 4)}
            at = [np.interp(mark["time_s"], values["time_s"], values[axis["column"]]) for axis in (x, y)]
            shown_at = [float((value - axis["start"]) * axis["scale"]) for value, axis in zip(at, (x, y))]
            placed.append({**mark, "x": shown_at[0], "y": shown_at[1]})
    return {
        "title": chart.title, "x": x, "y": y, "equal": chart.equal, "stages": chart.stages, "marks": placed,
        "rings": [radius * x["scale"] for radius in chart.rings_m],
        "series": [{"model": model, "x": x["column"], "y": y["column"], "style": model} for model in models],
    }
