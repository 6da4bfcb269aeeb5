# SPDX-License-Identifier: GPL-3.0-or-later
"""The probability of a rare event, and how it was computed."""
from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from statejump.campaign.plan import Plan
from statejump.campaign.rare.design_point import DesignPoint
from statejump.campaign.rare.estimate import Estimate, Index
from statejump.campaign.rare.model import METHODS, Event, Model, items_of
from statejump.core.tables import Shown, write_json

FACTOR = 3.0  # between FORM and importance sampling; a larger one means that the limit is far from flat


@dataclass(frozen=True)
class Rare:
    """The probability of an event.

    :param method: ``form`` or ``subset``
    :param design: the design point; None with subset simulation
    :param sobol: Sobol indices of every random variable, if requested
    """

    plan: Plan
    event: Event
    method: str
    estimate: Estimate
    design: DesignPoint | None
    sobol: tuple[Index, ...]
    runs: int
    failed: int
    without_value: int

    @property
    def probability(self) -> float:
        """Probability of the event."""
        return self.estimate.probability

    @property
    def interval(self) -> tuple[float, float]:
        """Its 95 % interval."""
        return self.estimate.low, self.estimate.high

    @property
    def form_is_valid(self) -> bool:
        """Whether FORM's probability is within FACTOR of the probability of importance sampling."""
        return self.design is not None and 1 / FACTOR < self.design.probability / self.probability < FACTOR

    def values(self) -> dict[str, float]:
        """Return the value of every random variable at the design point, by key."""
        if self.design is None:
            return {}
        return {item.keys[0]: item.at(one) for item, one in zip(items_of(self.plan), self.design.variates)}

    def record(self) -> dict[str, Any]:
        """Return the result for JSON."""
        return {
            "campaign": self.plan.name, "event": asdict(self.event), "method": self.method,
            "probability": self.probability, "interval_95": list(self.interval),
            "coefficient_of_variation": self.estimate.variation, "runs": self.runs, "failed": self.failed,
            "without_value": self.without_value, "seed": self.plan.seed, "key_sha256": self.plan.key,
            "form": None if self.design is None else {
                "probability": self.design.probability, "valid": self.form_is_valid,
                "reliability_index": self.design.index, "runs": self.design.runs, "runs_of_checks": self.design.checks,
                "design_point": self.values()},
            "sobol": {item.keys[0]: asdict(one) for item, one in zip(items_of(self.plan), self.sobol)},
        }

    def summary_lines(self) -> list[Shown | str]:
        """Return the tables and lines that a command prints."""
        found, design = self.estimate, self.design
        rows = [(METHODS[self.method].rpartition(" and ")[2], f"{found.probability:.3g}", f"{found.low:.3g}",
                 f"{found.high:.3g}", f"{found.variation:.2g}", str(found.runs))]
        if design is not None:
            rows.insert(0, ("FORM", f"{design.probability:.3g}", "", "", "", str(design.runs)))
        lines: list[Shown | str] = [Shown(
            f"{self.plan.title}: probability of {self.event}",
            ("method", "probability", "95 % from", "to", "coefficient of variation", "runs"), rows, left=("method",))]
        if design is not None:
            lines.append(f"design point: reliability index {design.index:.3f}, {design.checks} runs to check it")
            if not self.form_is_valid:
                lines.append("warning: FORM's probability differs from importance sampling by more than a factor of "
                             f"{FACTOR:g}; use importance sampling only")
        lines += [f"Sobol {item.keys[0]}: first {one.first:.3f}, total {one.total:.3f} "
                  f"({one.total_low:.3f} to {one.total_high:.3f})"
                  for item, one in zip(items_of(self.plan), self.sobol)]
        if self.failed:
            lines.append(f"warning: {self.failed} run(s) failed; the interval counts them once within and once beyond "
                         "the limit")
        if self.without_value:
            lines.append(f"note: {self.without_value} run(s) have no value of the outcome; they count as within the "
                         "limit")
        return lines

    def write(self, folder: Path) -> list[Path]:
        """Write ``rare.json`` and return its path."""
        return [write_json(folder / "rare.json", self.record())]


def made(model: Model, method: str, estimate: Estimate, design: DesignPoint | None, sobol: list[Index]) -> Rare:
    """Return the result of a model that has run."""
    return Rare(model.plan, model.event, method, estimate, design, tuple(sobol), model.runs, len(model.failures),
                model.without_value)
