# SPDX-License-Identifier: GPL-3.0-or-later
"""Charts of a page, with the names and scales of their axes."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from statejump.core import units
from statejump.core.case import Case
from statejump.core.charts import TEMPERATURE, Axis, Chart, straight_part
from statejump.core.run import Run
from statejump.kinds import has, require
from statejump.report.capabilities import PageCharts
from statejump.report.labels import Labels

# Columns about the run of a model, not about the structure.
NOT_SHOWN = {"time_s", "temperature_change_K", "slipping", "stop_contact", "stage"}
MOST_OTHER_LOOPS = 4
STATE_UNITS = {"m", "rad"}  # units of displacements; quantities with other units, such as forces, have no state jump


def charts_of(case: Case | None, run: Run, labels: Labels) -> list[Chart]:
    """Return the charts of a run: the charts of its kind, or loops of its first plain columns.

    :param case: the case; None: the installed version cannot read it from the file
    """
    if case is not None and has(case, PageCharts):
        found: list[Chart] = require(case, PageCharts).charts(case)
        return found
    return [
        Chart(TEMPERATURE, Axis(name), f"{labels.plain(name)} over temperature", marks=True)
        for name in _plain_columns(run)[:MOST_OTHER_LOOPS]
    ]


def _plain_columns(run: Run) -> list[str]:
    return [
        name for name, column in run.history.items()
        if name not in NOT_SHOWN and column.values.ndim == 1 and not column.labels and np.ptp(column.values) > 0
    ]


Columns = Mapping[str, Mapping[str, np.ndarray]]
LEFT = " less its straight part"  # suffix of the name of a column


def with_thin_loops(
    given: Sequence[Chart], columns: Mapping[str, dict[str, np.ndarray]], units_of: dict[str, str], labels: Labels
) -> list[Chart]:
    """Insert a second chart after each chart of a thin loop. It shows the loop without its reversible part, a straight
    line fitted to the first model. Its column is added to ``columns`` and ``units_of``."""
    found = []
    for chart in given:
        found.append(chart)
        x, y = chart.x.column, chart.y.column
        having = [values for values in columns.values() if {x, y} <= set(values)]
        line = straight_part(having[0][x], having[0][y]) if having and chart.marks and x == TEMPERATURE.column else None
        if line is None:
            continue
        for values in having:
            values[y + LEFT] = line.taken_off(values[x], values[y])
        units_of[y + LEFT] = unit = units_of.get(y, "-")
        scale, written = units.scale_of(unit, abs(line.slope))
        slope = f"{line.slope * scale:.5g} {written}/K".replace("-", "−", 1)
        # A short label, because the height of the chart limits its length.
        found.append(replace(chart, y=Axis(y + LEFT, chart.y.label or labels.plain(y)),
                             title=f"{chart.title},{LEFT} of {slope}"))
    return found


def _shown_axis(axis: Axis, columns: Columns, unit_of: Mapping[str, str], labels: Labels) -> dict[str, Any]:
    """Return an axis for the page: offset and factor of its values, and label with unit."""
    found = [values[axis.column] for values in columns.values() if axis.column in values]
    start = float(found[0][0]) if axis.from_start else 0.0
    size = max(float(np.nanmax(np.abs(values - start))) for values in found)
    scale, unit = units.scale_of(unit_of.get(axis.column, "-"), size)
    label = axis.label or labels.plain(axis.column)
    return {"column": axis.column, "label": f"{label} [{unit}]" if unit else label, "unit": unit, "scale": scale,
            "start": start}


def shown(
    chart: Chart, columns: Columns, unit_of: Mapping[str, str], marks: Sequence[dict[str, Any]], labels: Labels
) -> dict[str, Any] | None:
    """Return a chart for the page; None if no model has the columns of the chart.

    :param columns: columns by model and name
    :param unit_of: unit of every column
    :param marks: events to mark, with ``time_s``, ``label``, ``value``, ``role``. The value of a ``jump`` is replaced
        by the jump of the chart's own quantity
    """
    models = [model for model, values in columns.items() if {chart.x.column, chart.y.column} <= set(values)]
    if not models:
        return None
    x, y = (_shown_axis(axis, columns, unit_of, labels) for axis in (chart.x, chart.y))
    if chart.equal:  # one unit for both
        larger = min(x, y, key=lambda axis: float(axis["scale"]))
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
