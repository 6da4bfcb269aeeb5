# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns from Python: ``statejump.sweep`` and ``statejump.montecarlo``."""
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
    """Run a case on a grid of its parameters.

    :param values: values by key. Keys are ``section.key``, ``section.item.key`` of one item of a list, or
        ``section.*.key`` or ``section.joint*.key`` of all matching items. A value is a list, or the fields of a
        ``[[vary]]`` table: ``{"start": 0.1, "stop": 1, "count": 10, "spacing": "log"}``
    :param model: ``reduced`` or ``dem``
    :param workers: number of processes; None: one for each core, or just this process if the grid is small
    :param outputs: further outputs to record, for example ``jump:displacement_m[P].x``: end, jump, max, min or range of
        a column of the run at one item; see :mod:`statejump.campaign.outputs`
    :raises StatejumpError: a key is unknown, or campaigns do not support this kind of case
    """
    tables: dict[str, dict[str, Any]] = {
        key: {"key": key, **plain(wanted)} if isinstance(wanted, Mapping) else {"key": key, "values": _values(wanted)}
        for key, wanted in values.items()
    }
    return _run(case, SWEEP, tables, model, None, None, workers, progress, outputs)


def montecarlo(
    case: Case, distributions: Mapping[str, Mapping[str, Any]], *, samples: int = 1000, seed: int = 1,
    model: str = "reduced", workers: int | None = None, progress: Progress = False, outputs: Sequence[str] = (),
) -> Campaign:
    """Run a case with random parameters.

    :param distributions: for each key the fields of a ``[[vary]]`` table, for example ``{"distribution": "normal",
        "relative": 0.1}``
    :param samples: number of samples
    :param seed: seed of the random numbers; the same seed gives the same samples
    :param model: ``reduced`` or ``dem``
    :param workers: as for :func:`sweep`
    :param outputs: as for :func:`sweep`
    :raises StatejumpError: a key or distribution is unknown
    """
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
