# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns from Python, see :func:`statejump.sweep` and :func:`statejump.montecarlo`."""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from statejump.campaign.campaign_file import check_workers, plan_for
from statejump.campaign.plan import MONTECARLO, SWEEP
from statejump.campaign.result import Campaign, run
from statejump.core.case import Case, Progress
from statejump.core.errors import NotAllowed
from statejump.core.progress import shown
from statejump.schema.paths import plain


def sweep(
    case: Case, values: Mapping[str, float | Sequence[float] | Mapping[str, Any]], *, model: str = "reduced",
    workers: int | None = None, progress: Progress = False, outputs: Sequence[str] = (),
) -> Campaign:
    """Run a case on a grid of its parameters; see :func:`statejump.sweep`."""
    tables: dict[str, dict[str, Any]] = {
        key: {"key": key, **plain(wanted)} if isinstance(wanted, Mapping) else {"key": key, "values": _values(wanted)}
        for key, wanted in values.items()
    }
    return _run(case, SWEEP, tables, model, None, None, workers, progress, outputs)


def montecarlo(
    case: Case, distributions: Mapping[str, Mapping[str, Any]], *, samples: int = 1000, seed: int = 1,
    model: str = "reduced", workers: int | None = None, progress: Progress = False, outputs: Sequence[str] = (),
) -> Campaign:
    """Run a case whose parameters are random; see :func:`statejump.montecarlo`."""
    for key, wanted in distributions.items():
        if not isinstance(wanted, Mapping):
            raise NotAllowed(f"distributions[{key!r}]", wanted, code="distribution_not_dict")
    tables = {key: {"key": key, **plain(wanted)} for key, wanted in distributions.items()}
    return _run(case, MONTECARLO, tables, model, samples, seed, workers, progress, outputs)


def _values(values: Any) -> Any:
    """Return a list of Python numbers from a list, an array or a single number."""
    if isinstance(values, Iterable) and not isinstance(values, (str, np.ndarray)):
        values = list(values)
    found = plain(values)
    return found if isinstance(found, list) else [found]


def _run(
    case: Case, command: str, tables: Mapping[str, Mapping[str, Any]], model: str, samples: int | None,
    seed: int | None, workers: int | None, progress: Progress, outputs: Sequence[str],
) -> Campaign:
    check_workers("workers", workers)
    if isinstance(outputs, str):
        outputs = [outputs]
    plan = plan_for(case, command, ((f"vary[{key!r}]", table) for key, table in tables.items()), model=model,
                    samples=samples, seed=seed, asked=outputs)
    with shown(progress, f"{plan.name}, {plan.samples:,} samples") as on_progress:
        return run(plan, workers, on_progress)
