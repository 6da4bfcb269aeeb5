# SPDX-License-Identifier: GPL-3.0-or-later
"""Rare events from Python: ``statejump.rare``."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from statejump.campaign.campaign_file import check_workers, plan_for
from statejump.campaign.plan import MONTECARLO, Plan
from statejump.campaign.rare import estimate
from statejump.campaign.rare.design_point import found_by
from statejump.campaign.rare.kept import Kept
from statejump.campaign.rare.model import METHODS, Event, Model
from statejump.campaign.rare.result import Rare, made
from statejump.core import libraries
from statejump.core.case import Case, Progress
from statejump.core.errors import NotAllowed
from statejump.core.progress import OnProgress, shown
from statejump.schema.paths import plain
from statejump.schema.rules import check_name

MOST_RUNS = 5000
VARIATION = 0.1


def rare(
    case: Case, distributions: Mapping[str, Mapping[str, Any]], *, outcome: str, above: float | None = None,
    below: float | None = None, method: str = "form", runs: int | None = None, variation: float = VARIATION,
    sobol: int = 0, seed: int = 1, progress: Progress = False, outputs: Sequence[str] = (),
    workers: int | None = None,
) -> Rare:
    """Compute the small probability that an outcome of random samples is beyond a limit.

    :param distributions: as for :func:`montecarlo`
    :param outcome: name of an outcome or of one of ``outputs``
    :param above: the limit, if values above it count
    :param below: the limit, if values below it count
    :param method: ``form``: FORM, then importance sampling at the design point; or ``subset``: subset simulation
    :param runs: most runs of importance sampling (default 5000), or runs per level of subset simulation (default 1000)
    :param variation: coefficient of variation at which importance sampling ends
    :param sobol: size of the sample for Sobol indices of the outcome, 0 for none
    :param seed: seed of the random numbers
    :param outputs: as for :func:`sweep`
    :param workers: processes for importance sampling; None: this process
    :raises StatejumpError: the outcome is unknown, or the method is invalid for this event
    """
    tables = [(f"distributions[{key!r}]", {"key": key, **plain(wanted)}) for key, wanted in distributions.items()]
    plan = plan_for(case, MONTECARLO, tables, samples=1, seed=seed, asked=outputs)
    with shown(progress, f"{plan.name}, {METHODS.get(method, method)}") as on_progress:
        return run(plan, event_of(plan, outcome, above, below), method, runs, variation, sobol, on_progress,
                   workers=workers)


def event_of(plan: Plan, outcome: str, above: float | None, below: float | None) -> Event:
    """Return the event after checking it. :raises NotAllowed: the outcome is unknown, or the limit is not unique"""
    check_name("outcome", outcome, plan.outcomes)
    if plan.model != "reduced":
        raise NotAllowed("model", plan.model, code="rare_needs_reduced")
    if above is not None and below is None:
        return Event(outcome, above, True)
    if below is not None and above is None:
        return Event(outcome, below, False)
    raise NotAllowed("above", above, code="rare_needs_limit", options="above and below")


def run(plan: Plan, event: Event, method: str, runs: int | None, variation: float, sobol: int,
        on_progress: OnProgress, kept: Kept | None = None, workers: int | None = None,
        scheduler: str | None = None) -> Rare:
    """Compute the probability of an event of a campaign; see :func:`rare`.

    :param kept: finished runs of an earlier command, to which this one adds its runs
    :param workers: processes for importance sampling; None: this process
    :param scheduler: address of a running Dask scheduler in place of these processes
    """
    check_workers("workers", workers)
    check_name("method", method, tuple(METHODS))
    for key, value, least in (("runs", runs, estimate.FEWEST_RUNS), ("sobol", sobol or None, 2)):
        if value is not None and value < least:
            raise NotAllowed(key, value, code="below_minimum", least=least)
    if not 0 < variation <= estimate.LARGEST_VARIATION:
        raise NotAllowed("variation", variation, code="wrong_type", type="a number",
                         range=f"above 0 and at most {estimate.LARGEST_VARIATION:g}")
    libraries.openturns()
    model = Model(plan, event, on_progress, 1, kept=kept or Kept(plan),
                  workers=workers, scheduler=scheduler)
    model.expected = sobol * (model.count + 2) + (600 if method == "form" else 4 * (runs or 1000))
    design = None
    if method == "form":
        design = found_by(model)
        probability = estimate.importance_sampling(model, design, runs or MOST_RUNS, variation)
    else:
        probability = estimate.subset(model, runs or 1000)
    return made(model, method, probability, design, estimate.sobol(model, sobol) if sobol else [])
