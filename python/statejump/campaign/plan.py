# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan of a campaign: a case, its varied keys with their distributions or values, and the model."""
from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from statejump._version import __version__
from statejump.campaign import outputs
from statejump.campaign.sampling import Random, Values, Varied, montecarlo_draws, montecarlo_values, sweep_values
from statejump.core.case import Case
from statejump.kinds import of, registered
from statejump.schema.fields import attached_to_json, rule_of
from statejump.schema.paths import attribute_of, filled

MONTECARLO, SWEEP = "montecarlo", "sweep"
MOST_SAMPLES = 10_000_000


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """The data with which a worker runs samples.

    :param command: ``montecarlo`` or ``sweep``
    :param model: ``reduced`` or ``dem``
    :param case_data: sections and keys of the case as in its file, without defaults
    :param vary: varied parameters
    :param seed: seed of the random numbers; None in a sweep
    :param outcomes: names of the recorded values in the order of the table, outputs last
    :param outputs: those names that are outputs, see :mod:`statejump.campaign.outputs`
    :param kinds: Python modules of kinds of cases that the user has registered
    """

    command: str
    model: str
    case_data: Mapping[str, Any]
    vary: tuple[Varied, ...]
    seed: int | None
    outcomes: tuple[str, ...]
    kinds: tuple[str, ...]
    outputs: tuple[str, ...] = ()

    def _random(self) -> tuple[tuple[Random, ...], int]:
        assert self.seed is not None
        return tuple(item for item in self.vary if not isinstance(item, Values)), self.seed

    def _grid(self) -> tuple[Values, ...]:
        return tuple(item for item in self.vary if isinstance(item, Values))

    def values(self, index: int) -> list[float]:
        """Return the values of sample ``index``, one per varied parameter."""
        if self.command == SWEEP:
            return sweep_values(self._grid(), index)
        return montecarlo_values(*self._random(), index)

    def data(self, index: int) -> dict[str, Any]:
        """Return the case file of sample ``index``, parsed but not checked."""
        pairs: list[tuple[Any, float]]
        if self.command == SWEEP:
            pairs = list(zip(self._grid(), self.values(index)))
        else:
            pairs = list(montecarlo_draws(*self._random(), index))
        return filled(self.case_data, [(path, value) for item, value in pairs for path in item.keys])


@dataclass(frozen=True, kw_only=True)
class Plan(Recipe):
    """A checked campaign.

    :param name: name of the campaign and of its results folder
    :param title: title of figures, one line
    :param case: the case without variation
    :param samples: number of samples
    :param file: the campaign file; None: the campaign was made in Python
    :param text: text of the campaign file
    """

    name: str
    title: str
    case: Case
    samples: int
    file: Path | None = None
    text: str = ""

    @property
    def recipe(self) -> Recipe:
        """The part of the plan that is sent to workers, without the case object."""
        return Recipe(**{item.name: getattr(self, item.name) for item in fields(Recipe)})

    @property
    def units(self) -> dict[str, str]:
        """Unit of every outcome, in the order of the table."""
        return {name: outputs.unit(name) for name in self.outcomes}

    def unit_of(self, path: str) -> str:
        """Return the unit of a varied key."""
        return rule_of(attribute_of(type(self.case), path)).unit or "-"

    @property
    def key(self) -> str:
        """SHA-256 of all data that a sample depends on. Name, title and number of samples are excluded, so that a
        campaign can be extended."""
        resolved = {
            "version": __version__, "command": self.command, "model": self.model, "seed": self.seed,
            "case": self.case.with_defaults(), "vary": [asdict(parameter) for parameter in self.vary],
        }
        return hashlib.sha256(json.dumps(resolved, sort_keys=True, default=attached_to_json).encode()).hexdigest()


def plan_of(
    case: Case, *, command: str, model: str, vary: tuple[Varied, ...], samples: int, seed: int | None, name: str,
    title: str = "", file: Path | None = None, text: str = "", asked: tuple[str, ...] = (),
) -> Plan:
    """Make the plan of a campaign from parts that have been checked.

    :param asked: outputs that the user requests, besides the outcomes of the kind of case
    """
    at_end = () if case.ending is None else of(case).AT_PROGRAM_END
    return Plan(
        command=command, model=model, case_data=case.origin.document, vary=vary, seed=seed,
        outcomes=(*of(case).outcome_names(case), *at_end, *asked), outputs=asked,
        kinds=tuple(registered()), name=name,
        title=title or name, case=case, samples=samples, file=file, text=text,
    )
