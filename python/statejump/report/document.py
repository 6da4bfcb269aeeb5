# SPDX-License-Identifier: GPL-3.0-or-later
"""Page of one result: texts and tables, and data for charts and replay.

Only this module uses both the reader of result files and the page. The data for the page's script are plain JSON, see
:func:`Document.payload`. A column is a number, or base64 of little-endian float32 (``f``) or uint8 (``u``).
"""
from __future__ import annotations

import base64
import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.case import Case
from statejump.core.charts import PageSection
from statejump.core.comparison import Quantity, sides
from statejump.core.errors import StatejumpError, located
from statejump.core.run import Event, Run
from statejump.core.units import scale_of, text, unit_of
from statejump.kinds import has, require
from statejump.report import charts, labels
from statejump.report.capabilities import EventReasons, PagePart
from statejump.report.decimation import errors, kept_samples
from statejump.report.drawing import Drawing
from statejump.report.energy import Account, account
from statejump.report.inputs import sections_of
from statejump.results.contents import Result
from statejump.results.read import read

TOLERANCE = 2e-4  # allowed error of decimation, as a fraction of a column's range
MOST_SAMPLES = 4000  # samples of a model on a page
FEWEST_SAMPLES = 200
BYTES_PER_VALUE = 16 / 3  # float32 as base64
MOST_GUIDES = 200  # number of columns that determine the kept samples; the error is that of all columns
MOST_EVENTS = 60  # rows of the table
SAME_EVENT = 0.05  # fraction of a cycle within which events of two models count as one
MARKED_EVENTS = ("first_contact", "first_slip", "stop_reached", "stop_left")


@dataclass(frozen=True)
class Kept:
    """How a model's history was thinned out."""

    model: str
    samples: int
    kept: int
    error: float  # as a fraction of a column's range


class Document:
    """A result for a page.

    :param result: contents of the result file
    :param source: name of the file as the page shows it
    :param identifier: prefix of the HTML anchors of this result, unique on the page
    :param budget_bytes: largest size of the histories [bytes]
    """

    template = "run.html"

    def __init__(self, result: Result, source: str, identifier: str, budget_bytes: float) -> None:
        self.result, self.source, self.identifier = result, source, identifier
        self._values: dict[str, Any] = json.loads(result.case_json)
        self._labels = labels.of_kind(result.kind)
        self._run = next(iter(result.models.values()))
        case = _case_of(result)
        self.accounts: dict[str, Account] = {
            model: account(run, self._labels) for model, run in result.models.items()
        }
        self._drawing = Drawing(result, self._labels)
        self.sentences = [] if case is None else labels.described(case)
        self._case = case
        self._cycles = 1 if case is None else case.thermal.cycles
        self.part: PageSection | None = None
        if case is not None and has(case, PagePart):
            self.part = require(case, PagePart).page(result, case)
        self._charts = charts.charts_of(case, self._run, self._labels) if self.part is None else self.part.charts()
        self._columns = {model: self._full_columns(model, run) for model, run in result.models.items()}
        self._units = {name: column.unit for name, column in self._run.history.items()}
        self._units |= dict(self.part.units if self.part else {})
        self._charts = charts.with_thin_loops(self._charts, self._columns, self._units, self._labels)
        self.kept: list[Kept] = []
        self._thin: dict[str, dict[str, np.ndarray]] = {}
        for model in result.models:
            self._thin_out(model, budget_bytes / len(result.models))

    @property
    def title(self) -> str:
        """Heading of the run."""
        return self.result.title or self.result.name

    @property
    def kind(self) -> str:
        """Kind of the case."""
        return self.result.kind

    @property
    def case_name(self) -> str:
        """Name of the case."""
        return self.result.name

    @property
    def command_line(self) -> str:
        """Return the command that made the file, without the case."""
        return f"statejump {self.result.command}"

    @property
    def verdict(self) -> tuple[str, str]:
        """Class (pass, fail, none) and sentence."""
        rows = self.result.rows
        if not self.result.complete:
            return "fail", "The run was interrupted: this is what there was of it."
        if self.part is not None and self.part.verdict:
            return "none", self.part.verdict
        if rows is None:
            only = " and ".join(labels.MODELS[model] for model in self.result.models)
            return "none", f"{only}: one model alone, nothing is compared."
        missed = [row for row in rows if not row.passed]
        if missed:
            return "fail", f"{len(missed)} of {len(rows)} compared quantities miss their tolerance."
        if len(rows) == 1:
            return "pass", "Both models agree: the compared quantity is within tolerance."
        return "pass", f"Both models agree: all {len(rows)} compared quantities are within tolerance."

    def cards(self) -> list[dict[str, Any]]:
        """Return numbers for the top of the page: first state jumps of all models, then the first contact or slip."""
        models = self.result.models
        names = dict.fromkeys(name for run in models.values() for name, value in run.summary.items()
                              if ("jump" in name or "at_program_end" in name) and math.isfinite(value))
        cards = [] if self.part is None else self.part.cards()
        cards += [
            {
                "label": self._labels.plain(name),
                "values": [
                    (labels.MODELS[model], text(run.summary[name], unit_of(name)))
                    for model, run in models.items() if name in run.summary
                ],
            }
            for name in names
        ]
        for kind in ("first_contact", "first_slip"):
            found = {model: run.events.first(kind) for model, run in models.items()}
            if any(found.values()):
                cards.append({
                    "label": labels.EVENTS[kind].capitalize() + " at ΔT",
                    "values": [
                        (labels.MODELS[model], text(event.temperature_change_K if event else None, "K"))
                        for model, event in found.items()
                    ],
                })
                break
        return cards

    def inputs(self) -> list[tuple[str, list[tuple[str, str]]]]:
        """Return the sections of the case with all defaults: keys and values as pairs of texts."""
        return sections_of(self._values)

    @property
    def sides(self) -> list[str]:
        """Return the sources of the compared values, in the order of the table's columns."""
        return sides(self.result.rows or ())

    def comparison(self) -> list[dict[str, Any]]:
        """Rows of the table of comparisons."""
        return [self._compared(row) for row in self.result.rows or ()]

    def _compared(self, row: Quantity) -> dict[str, Any]:
        name, _, rest = row.name.partition(", ")
        return {
            "name": self._labels.plain(name) + (f", {rest}" if rest else ""),
            "values": [text(row.values[side], row.unit) if side in row.values else "" for side in self.sides],
            "difference": text(row.difference, row.unit, 3), "tolerance": text(row.tolerance, row.unit, 3),
            # Used fraction of the tolerance, drawn as a bar in the table.
            "used": min(1.0, abs(row.difference) / row.tolerance) if row.difference is not None and row.tolerance
            else None,
            "passed": row.passed,
        }

    def events(self) -> tuple[list[dict[str, Any]], int]:
        """Return the rows of the table of events in order of time, and the number of omitted rows. Events of several
        models share a row if they have the same kind and contact, and nearly the same time."""
        near = SAME_EVENT * self._cycle_s
        rows: list[dict[str, Any]] = []
        for model, run in self.result.models.items():
            open_rows = [row for row in rows if model not in row["at"]]
            for event in run.events:
                same = [
                    row for row in open_rows
                    if row["key"] == (event.kind, event.joint) and abs(row["time_s"] - event.time_s) <= near
                ]
                row = min(same, key=lambda found: abs(found["time_s"] - event.time_s), default=None)
                if row is None:
                    rows.append(row := self._event_row(event))
                else:
                    open_rows.remove(row)
                row["at"][model] = {
                    "temperature": text(event.temperature_change_K, "K"), "time": text(event.time_s, "s"),
                    **_uncertainty(event, run),
                }
                row["event"] = event
        rows.sort(key=lambda row: row["time_s"])
        for row in rows[:MOST_EVENTS]:
            row["reason"] = self._reason(row["event"], set(row["at"]))
        return rows[:MOST_EVENTS], max(0, len(rows) - MOST_EVENTS)

    def _event_row(self, event: Event) -> dict[str, Any]:
        return {
            "key": (event.kind, event.joint), "kind": labels.EVENTS.get(event.kind, self._labels.plain(event.kind)),
            "joint": self._labels.named(event.joint) if event.joint else "", "time_s": event.time_s, "at": {},
        }

    def _reason(self, event: Event, having: set[str]) -> str:
        """Return the reason why only some models report an event, if the kind of case knows it."""
        case, models = self._case, self.result.models
        if case is None or having == set(models) or not has(case, EventReasons):
            return ""
        reason: str = require(case, EventReasons).event_reason(case, event, next(iter(having)), models)
        return reason

    @property
    def _cycle_s(self) -> float:
        """Duration of a cycle [s]; if the case has no cycle, that of the whole run."""
        end = max((float(run.time_s[-1]) for run in self.result.models.values()), default=0.0)
        return end / self._cycles

    def stages(self) -> list[dict[str, Any]]:
        """Return the stages of the first model that has stages: name, meaning, begin and end of each."""
        for run in self.result.models.values():
            column = run.history.get("stage")
            if column is None or not column.labels:
                continue
            values, times = column.values, run.time_s
            change = run.history["temperature_change_K"].values
            starts = np.append(0, np.flatnonzero(values[1:] != values[:-1]) + 1)
            ends = np.append(starts[1:], len(values) - 1)
            named = [self._labels.stage(label) for label in column.labels]
            return [
                {
                    **dict(zip(("name", "meaning"), named[int(values[start])])),
                    "start_s": float(times[start]), "end_s": float(times[end]),
                    "start_K": text(float(change[start]), "K", 4), "end_K": text(float(change[end]), "K", 4),
                }
                for start, end in zip(map(int, starts), map(int, ends))
            ]
        return []

    def provenance(self) -> list[tuple[str, str]]:
        """What computed the result."""
        rows = [(self._labels.plain(key), str(value)) for key, value in self.result.provenance.items() if value != ""]
        return [("Result file", self.source), ("Command", self.command_line), *rows]

    def payload(self) -> dict[str, Any]:
        """Data for the page's script."""
        run, part = self._run, self.part
        marks = [
            {"time_s": event.time_s, "label": labels.EVENTS[kind], "value": text(event.temperature_change_K, "K", 4),
             "role": "event"}
            for kind in MARKED_EVENTS if (event := run.events.first(kind)) is not None
        ]
        jumps = [value for name, value in run.summary.items() if "jump" in name]
        if jumps and jumps[0] and math.isfinite(jumps[0]):
            marks.append({"time_s": float(run.time_s[-1]), "label": "state jump", "role": "jump", "value": ""})
        shown = [
            made for chart in self._charts
            if (made := charts.shown(chart, self._columns, self._units, marks, self._labels)) is not None
        ]
        return {
            "id": self.identifier,
            "title": self.title,
            "models": [
                {
                    "key": model, "label": labels.MODELS[model],
                    "columns": {name: _encoded(values) for name, values in columns.items()},
                }
                for model, columns in self._thin.items()
            ],
            "charts": shown,
            "energy": self._energy_chart(),
            "stages": self.stages(),
            "readouts": self._readouts(shown),
            "truss": None if part is None else part.payload(_encoded),
            "scene": {**self._drawing.scene, "parts": [_packed(part) for part in self._drawing.scene["parts"]]},
        }

    def _full_columns(self, model: str, run: Run) -> dict[str, np.ndarray]:
        names = {"time_s", "temperature_change_K"}
        names.update(axis.column for chart in self._charts for axis in (chart.x, chart.y))
        history = {
            name: run.history[name].values for name in sorted(names)
            if name in run.history and run.history[name].values.ndim == 1
        }
        curves = {} if self.part is None else self.part.columns[model]
        return {**history, **curves, **self.accounts[model].columns, **self._drawing.columns[model]}

    def _thin_out(self, model: str, budget_bytes: float) -> None:
        columns = self._columns[model]
        moving = [values for values in columns.values() if np.ptp(np.nan_to_num(values)) > 0]
        affordable = int(budget_bytes / (BYTES_PER_VALUE * max(1, len(moving))))
        most = min(MOST_SAMPLES, max(FEWEST_SAMPLES, affordable))
        time_s = columns["time_s"]
        # A state cannot be interpolated, so both samples at a change are kept if there is room.
        states = [values for values in moving if values.dtype == np.uint8]
        turned = np.any([np.diff(values) != 0 for values in states], axis=0) if states else np.zeros(0, bool)
        turns = np.flatnonzero(turned)
        always = np.unique(np.concatenate((turns, turns + 1)))
        chosen, guides = always if len(always) <= most else always[:0], moving[:: math.ceil(len(moving) / MOST_GUIDES)]
        for _ in range(2):  # the second pass uses the columns with the largest errors of the first
            chosen = kept_samples(time_s, np.stack(guides, axis=1).astype(float), most, TOLERANCE, map(int, chosen))
            missed = errors(time_s, moving, chosen)
            if missed.max(initial=0.0) <= TOLERANCE or len(chosen) >= most:
                break
            guides = [moving[place] for place in np.argsort(-missed)[:MOST_GUIDES]]
        error = float(missed.max(initial=0.0))
        self._thin[model] = {name: values[chosen] for name, values in columns.items()}
        self.kept.append(Kept(labels.MODELS[model], len(time_s), len(chosen), error))

    def _energy_chart(self) -> dict[str, Any] | None:
        size = max((found.turnover_J for found in self.accounts.values()), default=0.0)
        if size == 0:
            return None
        scale, unit = scale_of("J", size)
        roles = {"supplied_J": "supplied", "stored_J": "stored", "friction_J": "friction", "damping_J": "damping"}
        return {
            "title": "Energy over time", "equal": False, "stages": False, "marks": [], "rings": [],
            "x": {"column": "time_s", "label": "Time [s]", "unit": "s", "scale": 1.0, "start": 0.0},
            "y": {"column": "supplied_J", "label": f"Energy [{unit}]", "unit": unit, "scale": scale, "start": 0.0},
            "series": [
                {"model": model, "x": "time_s", "y": column, "style": role}
                for model in self.result.models for column, role in roles.items()
                if np.ptp(self.accounts[model].columns[column]) > 0
            ],
        }

    @staticmethod
    def _readouts(shown: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """Return the quantities to show beside the replay: the quantities of the charts over temperature and time."""
        axes = {chart["y"]["column"]: chart["y"] for chart in shown
                if not chart["equal"] and not chart["y"]["column"].endswith(charts.LEFT)}
        return [
            {**axis, "label": axis["label"].partition(" [")[0]} for axis in axes.values()
        ]


def _uncertainty(event: Event, run: Run) -> dict[str, str]:
    """Return the uncertainty of time and temperature of an event between two samples; "" for a located event."""
    if not event.time_uncertainty_s:
        return {"uncertainty": "", "uncertainty_K": ""}
    around = event.time_s + event.time_uncertainty_s * np.array([-1, 1])
    change = np.interp(around, run.time_s, run["temperature_change_K"])
    return {"uncertainty": text(event.time_uncertainty_s, "s", 2),
            "uncertainty_K": text(float(np.ptp(change) / 2), "K", 2)}


def of_file(path: Path, source: str, identifier: str, budget_bytes: float) -> Document:
    """Return the page of a result file. :raises Unreadable: the file or a part of it cannot be read"""
    result = read(path)
    with located(file=path):
        return Document(result, source, identifier, budget_bytes)


def _case_of(result: Result) -> Case | None:
    """Return the case in a file; None if this version cannot read it. The page then omits its description."""
    try:
        return result.definition
    except StatejumpError:
        return None


def _encoded(values: np.ndarray) -> Any:
    """Return a column in the page's encoding. A constant column becomes a single number."""
    if values.dtype == np.uint8:
        return {"u": base64.b64encode(values.tobytes()).decode("ascii")}
    values = np.nan_to_num(values.astype("<f4"))
    if np.ptp(values) == 0:
        return float(values[0])
    return {"f": base64.b64encode(values.tobytes()).decode("ascii")}


def _packed(part: dict[str, Any]) -> dict[str, Any]:
    return {key: _encoded(value) if isinstance(value, np.ndarray) else value for key, value in part.items()}
