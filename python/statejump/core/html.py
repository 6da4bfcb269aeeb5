# SPDX-License-Identifier: GPL-3.0-or-later
"""HTML of cases, runs and comparisons for notebooks."""
from __future__ import annotations

from html import escape

from statejump.core.case import Case
from statejump.core.comparison import Comparison, sides
from statejump.core.errors import StatejumpError
from statejump.core.run import MODELS, Run
from statejump.core.tables import html_table
from statejump.core.units import text, unit_of
from statejump.kinds import has, require
from statejump.report.capabilities import CaseText

MOST_EVENTS = 12


def _title(run: Run) -> str:
    try:
        return run.definition.title
    except (StatejumpError, ValueError):  # the case of a file that this version does not support any more
        return ""


def case_html(case: Case) -> str:
    """Return a case in words, as HTML."""
    sentences = require(case, CaseText).describe(case) if has(case, CaseText) else []
    return f"<h4>{escape(case.title)}</h4><p>{escape(' '.join(sentences))}</p>"


def run_html(run: Run) -> str:
    """Return a summary of a run as HTML."""
    rows = [(name, text(value, unit_of(name))) for name, value in sorted(run.summary.items())]
    events = [
        (event.kind, event.joint, text(event.temperature_change_K, "K"), text(event.time_s, "s"))
        for event in run.events[:MOST_EVENTS]
    ]
    parts = [f"<h4>{escape(_title(run))}: {escape(MODELS.get(run.model, run.model))}, {len(run):,} samples</h4>",
             html_table(("quantity", "value"), rows)]
    if events:
        more = len(run.events) - len(events)
        parts += [html_table(("event", "joint", "ΔT", "time"), events), f"<p>and {more:,} more</p>" if more else ""]
    parts += [f"<p>warning: {escape(warning)}</p>" for warning in run.warnings]
    if not run.complete:
        parts.append("<p>warning: the run was interrupted, this is what there is of it</p>")
    return "".join(parts)


def comparison_html(comparison: Comparison) -> str:
    """Return the rows of a comparison and the verdict, as HTML."""
    known = sides(comparison.rows)
    rows = [
        (row.name, *(text(row.values[side], row.unit) if side in row.values else "" for side in known),
         text(row.difference, row.unit), text(row.tolerance, row.unit), "pass" if row.passed else "MISSED")
        for row in comparison.rows
    ]
    verdict = "passed" if comparison.passed else "a tolerance is missed"
    head = ("quantity", *(side.replace("_", " ") for side in known), "difference", "tolerance", "")
    return f"<h4>{escape(comparison.case.title)}: {verdict}</h4>{html_table(head, rows)}"
