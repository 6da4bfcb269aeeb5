# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of a campaign: every outcome, what it follows, and what failed."""
from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any, Optional

import numpy as np
from scipy.stats import rankdata

from statejump import __version__
from statejump.core.output import write_atomically
from statejump.campaign.campaign_file import Campaign
from statejump.campaign.sampling import Independent
from statejump.campaign.tables import Table

QUANTILES = (0.05, 0.5, 0.95)
# A decimal number where sentences have what was sampled or when it happened, not an allowed range.
SAMPLED = re.compile(
    r"(?<![\w.])-?\d+(?:\.\d+(?:e[+-]?\d+)?|e[+-]?\d+)(?![\w.])(?= is not allowed| s\b| K\b|,)"
)


def statistics(values: np.ndarray) -> dict[str, Optional[float]]:
    """Mean, standard deviation, quantiles and extremes of the values that are there."""
    there = values[np.isfinite(values)]
    names = ("mean", "standard_deviation", "minimum", "quantile_5", "median", "quantile_95", "maximum")
    if not len(there):
        return {"count": 0, **dict.fromkeys(names)}
    low, middle, high = (float(value) for value in np.quantile(there, QUANTILES))
    numbers = (
        float(np.mean(there)), float(np.std(there, ddof=1)) if len(there) > 1 else None,
        float(np.min(there)), low, middle, high, float(np.max(there)),
    )
    return {"count": len(there), **dict(zip(names, numbers))}


def spearman(parameter: np.ndarray, outcome: np.ndarray) -> Optional[float]:
    """Rank correlation over the samples that have the outcome; None: one of the two is constant."""
    there = np.isfinite(outcome)
    if np.count_nonzero(there) < 3:
        return None
    ranks = [rankdata(values[there]) for values in (parameter, outcome)]
    if any(np.ptp(values) == 0 for values in ranks):
        return None
    return float(np.corrcoef(*ranks)[0, 1])


def sentence_kind(error: str) -> str:
    """An error without the sampled numbers, so that errors of one kind count together."""
    return SAMPLED.sub("…", error)


def summary(campaign: Campaign, table: Table) -> dict[str, Any]:
    """Everything that ``summary.json`` holds."""
    failures = Counter(sentence_kind(error) for error in table.error if error)
    examples: dict[str, tuple[int, str]] = {}
    for index, error in enumerate(table.error):
        if error:
            examples.setdefault(sentence_kind(error), (index, error))
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
        "key_sha256": campaign.key,
        "statejump_version": __version__,
    }


def write_summary(campaign: Campaign, found: dict[str, Any], folder: Path) -> None:
    """Write ``summary.json`` and ``summary.md``."""
    with write_atomically(folder / "summary.json") as stream:
        stream.write(json.dumps(found, indent=2, ensure_ascii=False) + "\n")
    with write_atomically(folder / "summary.md") as stream:
        stream.write(_markdown(campaign, found))


def shown(value: Optional[float]) -> str:
    """A number for a table."""
    return "–" if value is None else f"{value:.6g}"


COLUMNS = {
    "count": "count", "mean": "mean", "standard_deviation": "standard deviation", "quantile_5": "5 %",
    "median": "50 %", "quantile_95": "95 %",
}


def _rows(entries: dict[str, dict[str, Optional[float]]]) -> str:
    lines = [f"| | {' | '.join(COLUMNS.values())} |", "|---|" + "--:|" * len(COLUMNS)]
    for name, entry in entries.items():
        lines.append(f"| `{name}` | " + " | ".join(shown(entry[key]) for key in COLUMNS) + " |")
    return "\n".join(lines)


def _markdown(campaign: Campaign, found: dict[str, Any]) -> str:
    drawn = f", seed {found['seed']}" if found["seed"] is not None else ""
    failures = "None.\n"
    if found["failures"]:
        failures = "| samples | sentence | first |\n|--:|---|---|\n" + "".join(
            f"| {entry['samples']} | {entry['sentence']} | sample {entry['first_sample']}: "
            f"{entry['first_sentence']} |\n"
            for entry in found["failures"]
        )
    parameters = list(found["parameters"])
    every = ""
    if any(isinstance(parameter, Independent) for parameter in campaign.vary):
        every = "\nKeys with `*`: every item is drawn on its own, shown is the mean over the items of a sample."
    ranks = "| | " + " | ".join(f"`{name}`" for name in parameters) + " |\n|---|" + "--:|" * len(parameters) + "\n"
    for name, entry in found["spearman"].items():
        cells = ("–" if entry[key] is None else f"{entry[key]:.3f}" for key in parameters)
        ranks += f"| `{name}` | " + " | ".join(cells) + " |\n"
    return f"""# {campaign.title}

Case `{found['case']}`, {found['model']} model, {found['samples']:,} samples{drawn}, {found['failed']:,} failed.
Units are in the names; count is the number of samples that have the value.{every}

## Outcomes

{_rows(found['outcomes'])}

## Varied parameters

{_rows(found['parameters'])}

## Rank correlation (Spearman)

{ranks}
## Failed samples

{failures}"""
