# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of a campaign: outcomes, correlations, failures."""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from statejump._version import __version__
from statejump.campaign.plan import Plan
from statejump.campaign.sampling import Independent
from statejump.campaign.tables import Table
from statejump.core.tables import markdown, write_json, write_markdown

QUANTILES = (0.05, 0.5, 0.95, 0.99)


def statistics(values: np.ndarray) -> dict[str, float | None]:
    """Return mean, standard deviation, quantiles and extremes without NaN values, and the samples of the extremes."""
    is_there = np.isfinite(values)
    there = values[is_there]
    places = np.flatnonzero(is_there)
    names = ("mean", "standard_deviation", "minimum", "quantile_5", "median", "quantile_95", "quantile_99",
             "maximum", "minimum_sample", "maximum_sample")
    if not len(there):
        return {"count": 0, **dict.fromkeys(names)}
    low, middle, high, highest = (float(value) for value in np.quantile(there, QUANTILES))
    numbers = (
        float(np.mean(there)), float(np.std(there, ddof=1)) if len(there) > 1 else None,
        float(np.min(there)), low, middle, high, highest, float(np.max(there)),
        int(places[np.argmin(there)]), int(places[np.argmax(there)]),
    )
    return {"count": len(there), **dict(zip(names, numbers))}


def spearman(parameter: np.ndarray, outcome: np.ndarray) -> float | None:
    """Return the rank correlation over the samples with a finite outcome; None for fewer than three, or if parameter or
    outcome is constant."""
    from scipy.stats import rankdata  # 0.5 s; workers do without

    there = np.isfinite(outcome)
    if np.count_nonzero(there) < 3:
        return None
    ranks = [rankdata(values[there]) for values in (parameter, outcome)]
    if any(np.ptp(values) == 0 for values in ranks):
        return None
    return float(np.corrcoef(*ranks)[0, 1])


def summary(campaign: Plan, table: Table) -> dict[str, Any]:
    """Everything that ``summary.json`` holds."""
    failures = Counter(kind for kind in table.error_kind if kind)
    examples: dict[str, tuple[int, str]] = {}
    for index, (error, kind) in enumerate(zip(table.error, table.error_kind)):
        if error:
            examples.setdefault(kind, (index, error))
    return {
        "campaign": campaign.name,
        "command": campaign.command,
        "case": campaign.case.name,
        "model": campaign.model,
        "samples": campaign.samples,
        "seed": campaign.seed,
        "failed": int(np.count_nonzero(table.failed)),
        "failures": [
            {"sentence": sentence, "samples": count, "first_sample": examples[sentence][0],
             "first_sentence": examples[sentence][1]}
            for sentence, count in sorted(failures.items(), key=lambda item: (-item[1], item[0]))
        ],
        "parameters": {name: statistics(values) for name, values in table.parameters.items()},
        "outcomes": {name: statistics(values) for name, values in table.outcomes.items()},
        "spearman": {
            name: {parameter: spearman(values, outcome) for parameter, values in table.parameters.items()}
            for name, outcome in table.outcomes.items()
        },
        "notes": list(campaign.case.thermal_notes),
        "key_sha256": campaign.key,
        "statejump_version": __version__,
    }


def write_summary(campaign: Plan, found: Mapping[str, Any], folder: Path) -> list[Path]:
    """Write ``summary.md`` and ``summary.json`` and return their paths."""
    return [write_markdown(folder / "summary.md", _lines(campaign, found)), write_json(folder / "summary.json", found)]


def shown(value: float | None) -> str:
    """Return a number for a table."""
    return "–" if value is None else f"{value:,}" if isinstance(value, int) else f"{value:.6g}"


COLUMNS = {
    "count": "count", "mean": "mean", "standard_deviation": "standard deviation", "quantile_5": "5 %",
    "median": "50 %", "quantile_95": "95 %", "quantile_99": "99 %",
    "minimum": "smallest", "minimum_sample": "in sample", "maximum": "largest", "maximum_sample": "in sample",
}


def _rows(entries: Mapping[str, Mapping[str, float | None]]) -> list[str]:
    rows = [(f"`{name}`", *(shown(entry[key]) for key in COLUMNS)) for name, entry in entries.items()]
    return markdown(("", *COLUMNS.values()), rows, right=range(1, len(COLUMNS) + 1))


def _failures(found: Mapping[str, Any]) -> list[str]:
    if not found["failures"]:
        return ["None."]
    rows = [
        (entry["samples"], entry["sentence"], f"sample {entry['first_sample']}: {entry['first_sentence']}")
        for entry in found["failures"]
    ]
    return markdown(("samples", "sentence", "first"), rows, right=(0,))


def _ranks(found: Mapping[str, Any]) -> list[str]:
    parameters = list(found["parameters"])
    rows = [
        (f"`{name}`", *("–" if entry[key] is None else f"{entry[key]:.3f}" for key in parameters))
        for name, entry in found["spearman"].items()
    ]
    return markdown(("", *(f"`{name}`" for name in parameters)), rows, right=range(1, len(parameters) + 1))


def _lines(campaign: Plan, found: Mapping[str, Any]) -> list[str]:
    drawn = f", seed {found['seed']}" if found["seed"] is not None else ""
    lines = [
        f"# {campaign.title}", "",
        f"Case `{found['case']}`, {found['model']} model, {found['samples']:,} samples{drawn}, "
        f"{found['failed']:,} failed.",
        "Units are in the names; count is the number of samples that have the value.",
    ]
    lines += [f"Note: {note}." for note in found["notes"]]
    if any(isinstance(parameter, Independent) for parameter in campaign.vary):
        lines.append("Keys with `*`: every item is drawn on its own, shown is the mean over the items of a sample.")
    return [
        *lines,
        "", "## Outcomes", "", *_rows(found["outcomes"]),
        "", "## Varied parameters", "", *_rows(found["parameters"]),
        "", "## Rank correlation (Spearman)", "", *_ranks(found),
        "", "## Failed samples", "", *_failures(found),
    ]
