# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaign files: case, model, and varied parameters, checked as strictly as a case."""
from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import tomli_w

from statejump.campaign.outputs import PATTERN, parts, values
from statejump.campaign.plan import MONTECARLO, MOST_SAMPLES, SWEEP, Plan, plan_of
from statejump.campaign.sampling import Values, Varied, number_of_points
from statejump.campaign.vary import MonteCarloVary, SweepVary, check_apart, varied
from statejump.campaign.work import sampled
from statejump.core.case import Case
from statejump.core.errors import MissingKey, NotAllowed, StatejumpError, UnknownKey, located
from statejump.core.run import MODELS
from statejump.kinds import of, require
from statejump.kinds.loading import load_case
from statejump.kinds.protocol import Outcomes, supports
from statejump.schema.fields import (
    CHOICE, Section, choice, definition, fields_of, rule_of, section, tables, text, texts, whole,
)
from statejump.schema.rules import FOLDER_NAME
from statejump.schema.structure import structure
from statejump.schema.toml import read_toml

MODEL_NAMES = tuple(MODELS)


@definition
class SweepHeader(Section):
    """The [campaign] section of a sweep."""

    name: str = text(..., "name of the results folder", pattern=FOLDER_NAME)
    title: str = text("", "one line for figures")
    case: str = text(..., "case file, relative to the campaign file")
    model: str = choice("reduced", MODEL_NAMES, CHOICE + ": the fast one")
    outputs: list[str] = texts([], "more to record, HOW:COLUMN[ITEM].AXIS", pattern=PATTERN)


@definition
class MonteCarloHeader(SweepHeader):
    """The [campaign] section of a Monte Carlo campaign."""

    samples: int = whole(..., 1, MOST_SAMPLES, CHOICE)
    seed: int = whole(..., 0, 2**31 - 1, CHOICE)


def _as_given(name: str, value: Any) -> list[Any]:
    """Return ``[[vary]]`` unchecked: its rules depend on the case, see :func:`vary_of`."""
    return list(value) if isinstance(value, list) else []


@definition
class MonteCarloFile(Section):
    """A case whose parameters are random."""

    campaign: MonteCarloHeader = section(MonteCarloHeader, required=True)
    vary: list[Any] = tables(MonteCarloVary, "sections [[vary]]", required=True, read=_as_given)


@definition
class SweepFile(Section):
    """A case on a grid of its parameters."""

    campaign: SweepHeader = section(SweepHeader, required=True)
    vary: list[Any] = tables(SweepVary, "sections [[vary]]", required=True, read=_as_given)


FILES: dict[str, type[Section]] = {MONTECARLO: MonteCarloFile, SWEEP: SweepFile}


def load_campaign(path: Path, command: str) -> Plan:
    """Return the campaign of a TOML file after checking it.

    :param command: ``montecarlo`` or ``sweep``
    :raises StatejumpError: the first fault, with file, key, value and allowed values
    """
    text_read, data = read_toml(path, "campaign")
    with located(file=path):
        return _campaign(path, text_read, data, command)


def _campaign(path: Path, text_read: str, data: Mapping[str, Any], command: str) -> Plan:
    header_given = data.get("campaign")
    for key in ("samples", "seed"):
        if command == SWEEP and isinstance(header_given, Mapping) and key in header_given:
            raise NotAllowed(f"campaign.{key}", code="sweep_with_distribution")
    _check_sections(data)
    # The header is checked first, because the rules of ``[[vary]]`` depend on the case it names.
    found: Any = structure(FILES[command], {"vary": [{}], **data})
    header = found.campaign
    case = load_case(path.parent / header.case)
    check_campaign(case, header.model, header.case, "campaign.")
    tables_given = data.get("vary")
    if not isinstance(tables_given, list) or not tables_given or not all(
        isinstance(table, Mapping) for table in tables_given
    ):
        raise MissingKey("vary", code="campaign_without_vary", section="[[vary]]")
    try:
        asked = checked(header.outputs, case)
    except NotAllowed as refused:
        refused.key = f"campaign.{refused.key}" if refused.key == "outputs" else refused.key
        raise
    vary = vary_of(((f"vary[{number}]", table) for number, table in enumerate(tables_given, start=1)), case, command)
    return plan_of(
        case, command=command, model=header.model, vary=vary,
        samples=points_of(vary) if command == SWEEP else header.samples, seed=None if command == SWEEP else header.seed,
        name=header.name, title=header.title, file=path, text=text_read, asked=asked,
    )


def plan_for(
    case: Case, command: str, vary: Iterable[tuple[str, Mapping[str, Any]]], *, model: str = "reduced",
    samples: int | None = None, seed: int | None = None, asked: Sequence[str] = (),
) -> Plan:
    """Return the plan of a campaign without a campaign file.

    :param vary: ``[[vary]]`` tables, each with its name for messages
    :param samples: number of samples of a Monte Carlo campaign; None for a sweep, whose grid determines it
    :param seed: seed of a Monte Carlo campaign
    :param asked: further outputs that the user requests
    :raises StatejumpError: as for :func:`load_campaign`
    """
    require(case, Outcomes)
    check_campaign(case, model, case.name)
    if command == MONTECARLO:
        for name, value in (("samples", samples), ("seed", seed)):
            rule_of(fields_of(MonteCarloHeader)[name]).check(name, value)
    named = list(vary)
    found = vary_of(named, case, command)
    if not found:
        raise MissingKey("what varies", code="vary_without_key")
    name = f"{case.name}_{command}"
    header = {"name": name, "title": case.title, "case": str(case.origin.file or case.name), "model": model,
              "outputs": list(asked), "samples": samples, "seed": seed}
    said = {"campaign": {key: value for key, value in header.items() if value not in (None, [], "")},
            "vary": [dict(table) for _, table in named]}
    return plan_of(case, command=command, model=model, vary=found, seed=seed,
                   samples=points_of(found) if samples is None else samples, name=name,
                   title=case.title, text=tomli_w.dumps(said), asked=checked(asked, case))


def vary_tables(path: Path) -> list[tuple[str, Mapping[str, Any]]]:
    """Return the ``[[vary]]`` tables of a file that contains only such tables, as ``statejump identify`` writes it.

    :raises StatejumpError: the file does not exist, has other sections, or has no ``[[vary]]`` table
    """
    _, data = read_toml(path, "distributions")
    with located(file=path):
        _check_sections(data, ("vary",))
        tables_given = data.get("vary")
        if not isinstance(tables_given, list) or not all(isinstance(table, Mapping) for table in tables_given):
            raise MissingKey("vary", code="campaign_without_vary", section="[[vary]]")
    return [(f"{path.name}: vary[{number}]", table) for number, table in enumerate(tables_given, start=1)]


def _check_sections(data: Mapping[str, Any], known: Sequence[str] = ("campaign", "vary")) -> None:
    forms = {"campaign": "[campaign]", "vary": "[[vary]]"}
    for name in data:
        if name in known:
            continue
        match = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
        raise UnknownKey(name, section=f"section [{name}]", **(
            {"code": "misspelt_key", "meant": forms[match[0]]} if match else
            {"code": "no_such_key", "known": " and ".join(forms[one] for one in known)}))


def check_campaign(case: Case, model: str, named: str, before: str = "") -> None:
    """Raise NotAllowed unless campaigns support this kind of case in this model.

    :param named: the case as the caller named it
    :param before: prefix of the keys ``case`` and ``model`` in the message
    """
    behaviour = of(case)
    if not supports(behaviour, Outcomes):
        raise NotAllowed(f"{before}case", named, code="no_campaign_of_kind", kind=case.kind)
    rule_of(fields_of(SweepHeader)["model"]).check(f"{before}model", model)
    if model not in behaviour.campaign_models():
        others = " or ".join(f"model = {name!r}" for name in behaviour.campaign_models())
        raise NotAllowed(f"{before}model", model, code="model_not_of_kind", kind=case.kind, models=others)


def check_workers(key: str, workers: int | None) -> None:
    """Raise NotAllowed for an invalid number of workers."""
    if workers is not None and workers < 1:
        raise NotAllowed(key, workers, code="below_minimum", least=1)


def vary_of(given: Iterable[tuple[str, Mapping[str, Any]]], case: Case, command: str) -> tuple[Varied, ...]:
    """Return the varied parameters that ``[[vary]]`` tables define.

    :param given: tables, each with its name for messages
    :raises StatejumpError: a table is invalid
    """
    found: list[Varied] = []
    for item, table in given:
        try:
            found.append(varied(table, case, command))
            check_apart(found, case)
        except StatejumpError as failure:
            failure.item = item
            raise
    return tuple(found)


def points_of(vary: tuple[Varied, ...]) -> int:
    """Return the number of points of a sweep's grid. :raises NotAllowed: the grid has too many points"""
    points = number_of_points([axis for axis in vary if isinstance(axis, Values)])
    if points > MOST_SAMPLES:
        raise NotAllowed("[[vary]]", code="grid_too_large", points=points, most_samples=MOST_SAMPLES)
    return points


def checked(given: Sequence[str], case: Case) -> tuple[str, ...]:
    """Return the names of outputs after computing the outputs for a run of the reduced model.

    :raises NotAllowed: a name is repeated or invalid
    """
    names = tuple(given)
    for place, name in enumerate(names):
        parts(name)
        if name in names[:place]:
            raise NotAllowed("outputs", name, code="duplicate")
    if names:
        values(names, sampled(case, "reduced", names))
    return names
