# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns: one case, many samples of its parameters, either model; the many on Dask's ``distributed``."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from statejump.campaign.result import Campaign
    from statejump.case import Progress
    from statejump.core.case import Case

__all__ = ["Campaign", "montecarlo", "sweep"]


def sweep(
    case: Case, values: Mapping[str, Sequence[float] | Mapping[str, Any]], *, model: str = "reduced",
    workers: int | None = None, progress: Progress = False, outputs: Sequence[str] = (),
) -> Campaign:
    """Run a case on a grid of its parameters; see :func:`statejump.sweep`."""
    from statejump.campaign.campaign_file import points_of
    from statejump.campaign.plan import SWEEP

    tables: dict[str, dict[str, Any]] = {
        key: {"key": key, **wanted} if isinstance(wanted, Mapping) else {"key": key, "values": _plain(wanted)}
        for key, wanted in values.items()
    }
    return _run(case, SWEEP, tables, model, points_of, None, workers, progress, outputs)


def montecarlo(
    case: Case, distributions: Mapping[str, Mapping[str, Any]], *, samples: int = 1000, seed: int = 1,
    model: str = "reduced", workers: int | None = None, progress: Progress = False, outputs: Sequence[str] = (),
) -> Campaign:
    """Run a case whose parameters are random; see :func:`statejump.montecarlo`."""
    from statejump.campaign.campaign_file import MonteCarloHeader
    from statejump.campaign.plan import MONTECARLO
    from statejump.schema.fields import fields_of, rule_of

    for name, value in (("samples", samples), ("seed", seed)):
        rule_of(fields_of(MonteCarloHeader)[name]).check(name, value)
    tables = {key: {"key": key, **wanted} for key, wanted in distributions.items()}
    return _run(case, MONTECARLO, tables, model, lambda vary: samples, seed, workers, progress, outputs)


def _plain(values: Any) -> list[Any]:
    """Return values as a list of Python's numbers, also of an array."""
    return list(values.tolist() if hasattr(values, "tolist") else values)


def _run(
    case: Case, command: str, tables: Mapping[str, Mapping[str, Any]], model: str, count: Any, seed: int | None,
    workers: int | None, progress: Progress, outputs: Sequence[str],
) -> Campaign:
    from statejump.campaign.campaign_file import check_campaign, check_workers, vary_of
    from statejump.campaign.outputs import checked
    from statejump.campaign.plan import plan_of
    from statejump.campaign.result import run
    from statejump.core.errors import MissingKey
    from statejump.core.progress import shown

    case.behaviour.ability("outcomes", case)
    check_campaign(case, model, case.name)
    check_workers("workers", workers)
    if not tables:
        raise MissingKey("what varies", "at least one key is needed")
    vary = vary_of(((f"vary[{key!r}]", table) for key, table in tables.items()), case, command)
    plan = plan_of(case, command=command, model=model, vary=vary, samples=count(vary), seed=seed,
                   name=f"{case.name}_{command}", title=case.title, asked=checked(outputs, case))
    with shown(progress, f"{plan.name}, {plan.samples:,} samples") as tell:
        return run(plan, workers, tell)


def __getattr__(name: str) -> Any:
    if name == "Campaign":
        from statejump.campaign.result import Campaign

        return Campaign
    raise AttributeError(f"module 'statejump.campaign' has no attribute {name!r}")
