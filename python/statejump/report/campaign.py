# SPDX-License-Identifier: GPL-3.0-or-later
"""Page of a campaign: distributions of outcomes or, for a grid, their curves, and their correlation with the varied
parameters. The data are the campaign's table of samples."""
from __future__ import annotations

import json
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from statejump.core.errors import Unreadable
from statejump.core.hdf5 import is_ours, objects, opened
from statejump.core.units import scale_of, text
from statejump.report import labels

BARS = 60  # number of bars of a histogram, as in figures of the commands
QUANTILES = ("quantile_5", "median", "quantile_95")
FEWEST_MANY_POINTS = 2000  # number of points of a sweep above which the page omits points


def _one(place: str, value: Any) -> Any:
    """Return the value of an HDF5 attribute: a single text or number. :raises ValueError: it is something else"""
    if not isinstance(value, (str, int, float, np.integer, np.floating)):
        raise ValueError(f"{place} is not one text or number")
    return value


@dataclass(frozen=True)
class Variable:
    """A column of the table of samples."""

    name: str
    unit: str
    values: np.ndarray  # NaN: the sample has no such value
    title: str  # the name in words

    @property
    def shown(self) -> tuple[float, str]:
        """Factor and unit in which values are shown."""
        there = self.values[np.isfinite(self.values)]
        return scale_of(self.unit, float(np.median(np.abs(there))) if len(there) else 0.0)

    @property
    def label(self) -> str:
        """Name with unit, for an axis."""
        unit = self.shown[1]
        return f"{self.title} [{unit}]" if unit else self.title


def is_campaign(path: Path) -> bool:
    """Return whether a file is the table of samples of a campaign."""
    if not is_ours(path):
        return False
    with opened(path) as file:
        return "campaign" in file.attrs and "outcomes" in file


class CampaignDocument:
    """A campaign for a page. The arguments are those of :class:`~.document.Document`.

    :raises Unreadable: the table is damaged
    """

    template = "campaign.html"

    def __init__(self, path: Path, identifier: str, source: str) -> None:
        from statejump.campaign import outputs, plan, summary  # Dask and SciPy, 0.3 s; not needed for a page of runs

        self.source, self.identifier = source, identifier
        try:
            with opened(path) as file:
                objects(file, path)
                attributes = {key: _one(key, value) for key, value in file.attrs.items()}
                header = json.loads(attributes["case"])["case"]
                self._labels = labels.of_kind(str(header["kind"]))
                self.case = str(header["name"])
                self.samples = len(file["sample"])
                self.parameters = self._variables(file["parameters"])
                self.outcomes = [replace(outcome, title=outputs.in_words(outcome.name) or outcome.title)
                                 for outcome in self._variables(file["outcomes"])]
                self.failed = [
                    (int(sample), bytes(error).decode("utf-8"))
                    for sample, error in zip(file["failed/sample"][()], file["failed/error"][()], strict=True)
                ]
            if not self.parameters or not self.outcomes:
                raise ValueError("/parameters and /outcomes need a column each")
            if not all(np.isfinite(parameter.values).all() for parameter in self.parameters):
                raise ValueError("/parameters has numbers that are not finite")
            self.text = str(attributes["campaign"])
            campaign = tomllib.loads(self.text)["campaign"]
            self.command, self.model = str(attributes["command"]), str(attributes["model"])
            if self.command not in (plan.MONTECARLO, plan.SWEEP) or self.model not in labels.MODELS:
                raise ValueError(f"no campaign is {self.command!r} of model {self.model!r}")
        except (KeyError, ValueError, TypeError, AttributeError) as error:
            raise Unreadable(code="damaged", cause=" ".join(str(error).split()), file=path, object="/") from None
        self.seed: Any | None = attributes.get("seed")
        self.title = str(campaign.get("title") or campaign.get("name"))
        self.attributes = {key: value for key, value in attributes.items() if key not in ("campaign", "case")}
        # What the campaign is about comes first.
        self.outcomes.sort(key=lambda outcome: "jump" not in outcome.name)
        self.statistics = {outcome.name: summary.statistics(outcome.values) for outcome in self.outcomes}

    def _variables(self, group: h5py.Group) -> list[Variable]:
        found = []
        for name, dataset in group.items():
            if dataset.dtype.kind not in "iuf" or dataset.shape != (self.samples,):
                raise ValueError(f"{dataset.name} is not a number for each of {self.samples} samples")
            found.append(Variable(name, _one(f"{dataset.name}@unit", dataset.attrs["unit"]), dataset[()].astype(float),
                                  self._labels.parameter(name)))
        return found

    @property
    def case_name(self) -> str:
        """Name of the case."""
        return self.case

    @property
    def command_line(self) -> str:
        """Return the command that made the file, without the campaign."""
        return f"statejump {self.command}"

    @property
    def kind(self) -> str:
        """Type of the campaign, for the list of runs on the page."""
        return "campaign"

    @property
    def verdict(self) -> tuple[str, str]:
        """Class and sentence."""
        if self.failed:
            return "fail", f"{_count(len(self.failed))} of {_count(self.samples)} samples failed."
        return "none", f"All {_count(self.samples)} samples ran; a campaign compares nothing."

    @property
    def sentences(self) -> list[str]:
        """The campaign in words."""
        drawn = "on a grid" if self.command == "sweep" else "drawn at random"
        seed = f" (seed {self.seed})" if self.seed is not None else ""
        names = [labels.inside(parameter.title) for parameter in self.parameters]
        varied = names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
        return [
            f"{_count(self.samples)} samples of case {self.case} in the {labels.inside(labels.MODELS[self.model])}, "
            f"{drawn}{seed}.",
            f"Varied: {varied}.",
        ]

    def cards(self) -> list[dict[str, Any]]:
        """Return numbers for the top of the page: median and spread of the first outcomes."""
        shown = {"median": "median", "quantile_5": "5 % are below", "quantile_95": "5 % are above",
                 "quantile_99": "1 % are above", "minimum": "smallest", "maximum": "largest"}
        if self.command == "sweep":  # a grid has no frequency distribution
            shown = {"minimum": "smallest", "maximum": "largest"}
        return [
            {"label": outcome.title, "values": [(label, self._text(outcome, key)) for key, label in shown.items()]}
            for outcome in self.outcomes[:3]
        ]

    def _text(self, outcome: Variable, key: str) -> str:
        """Return a number of the statistics as text; that of an extreme value includes the number of its sample."""
        found = self.statistics[outcome.name]
        said = text(found[key], outcome.unit, 4)
        sample = found.get(f"{key}_sample")
        return said if sample is None else f"{said} (sample {sample:g})"

    def table(self) -> list[dict[str, Any]]:
        """Rows of the table of outcomes."""
        return [
            {
                "name": outcome.title,
                "count": self.statistics[outcome.name]["count"],
                **{
                    key: self._text(outcome, key)
                    for key in ("mean", "standard_deviation", "minimum", *QUANTILES, "quantile_99", "maximum")
                },
            }
            for outcome in self.outcomes
        ]

    def provenance(self) -> list[tuple[str, str]]:
        """What computed the samples."""
        return [("Table of samples", self.source)] + [
            (self._labels.plain(key), str(value)) for key, value in self.attributes.items()
        ]

    def payload(self) -> dict[str, Any]:
        """Data for the page's script."""
        sweep = self.command == "sweep"
        return {
            "id": self.identifier,
            "histograms": [] if sweep else [self._histogram(outcome) for outcome in self.outcomes],
            "curves": [self._curve(outcome) for outcome in self.outcomes] if sweep else [],
            "ranks": [] if sweep else [self._ranks(outcome) for outcome in self.outcomes],
        }

    def _histogram(self, outcome: Variable) -> dict[str, Any]:
        scale, _ = outcome.shown
        there = outcome.values[np.isfinite(outcome.values)] * scale
        counts, edges = np.histogram(there, BARS) if len(there) else (np.zeros(0, int), np.zeros(1))
        found = self.statistics[outcome.name]
        return {
            "title": outcome.title, "label": outcome.label, "counts": counts.tolist(),
            "edges": edges.tolist(),
            "note": f"in {_count(len(there))} of {_count(self.samples)} samples" if len(there) < self.samples else "",
            "quantiles": [value * scale for key in QUANTILES if (value := found[key]) is not None],
        }

    def _ranks(self, outcome: Variable) -> dict[str, Any]:
        """Return the rank correlation of an outcome with each parameter, sorted by size with the largest first."""
        from statejump.campaign.summary import spearman  # as outputs

        bars = [
            {"parameter": parameter.title, "value": spearman(parameter.values, outcome.values)}
            for parameter in self.parameters
        ]
        known = [bar for bar in bars if bar["value"] is not None]
        return {"title": outcome.title, "bars": sorted(known, key=lambda bar: -abs(bar["value"]))}

    def _curve(self, outcome: Variable) -> dict[str, Any]:
        """Return the curves of an outcome over the first parameter, one for each value of the second parameter."""
        first, second = self.parameters[0], self.parameters[1] if len(self.parameters) > 1 else None
        if len(self.parameters) > 1 and len(np.unique(first.values)) < len(np.unique(self.parameters[1].values)):
            first, second = self.parameters[1], self.parameters[0]
        step = max(1, self.samples // FEWEST_MANY_POINTS)
        points = []
        for place in range(0, self.samples, step):
            y = outcome.values[place]
            if np.isfinite(y):
                points.append({
                    "x": float(first.values[place] * first.shown[0]), "y": float(y * outcome.shown[0]),
                    "z": text(float(second.values[place]), second.unit, 4) if second is not None else "",
                })
        return {
            "title": f"{outcome.title} over {labels.inside(first.title)}",
            "x": first.label, "y": outcome.label, "z": second.title if second is not None else "", "points": points,
        }


def _count(number: int) -> str:
    return f"{number:,}".replace(",", "\u202f")
