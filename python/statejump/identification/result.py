# SPDX-License-Identifier: GPL-3.0-or-later
"""Result of an identification: the joint, the intervals of its parameters, and the undetermined parameters."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump.core import libraries
from statejump.core.errors import NotAllowed, Range, located
from statejump.core.later import Later
from statejump.core.notes import Note
from statejump.core.tables import Shown, html_table, write_columns, write_csv, write_text
from statejump.core.units import plain
from statejump.identification import case_section
from statejump.identification.fit import Fit, Fits, Interval, intervals
from statejump.identification.loop import Loop, read_loop
from statejump.identification.models import MODELS, PARAMETERS
from statejump.identification.prediction import Prediction, predicted

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DRAWN, _SAVED = Later("statejump.identification.picture:drawn"), Later("statejump.core.figures:save")
AUTO = "auto"
CONFIDENCE = Range(0.5, 0.999)
# A difference of BIC below this is "not worth more than a bare mention" (Kass and Raftery, JASA 90, 1995).
BARE_MENTION = 2.0
# Number of standard deviations, 1/sqrt(n), of the correlation of independent residuals that count as chance.
CHANCE = 3.0
# Reasons why a loop does not determine a parameter of another joint.
ABSENT = {"no_stop": "the path meets no stop there", "never_slides": "the loop never slides",
          "no_friction": "the loop needs none"}
PARAMETER_COLUMNS = ("parameter", "unit", "estimate", "low", "high")
MODEL_COLUMNS = ("model", "parameters", "noise", "log_likelihood", "bic", "bic_difference")


@dataclass(frozen=True)
class Identification:
    """A joint identified from a loop.

    :param loop: the measured loop
    :param candidates: the fitted joints, sorted by BIC with the best first
    :param fit: fit of the joint that was chosen or requested
    :param intervals: confidence intervals of its parameters
    :param because: for each parameter that is not identified: the parameter at the end of its search range that causes
        this
    :param limits: for each parameter that the joint lacks: a larger joint that has it, and its interval
    :param confidence: confidence level of the intervals
    :param target: item of a case for the joint, one of case_section.TARGETS
    :param normal_force_N: normal force in the test [N]; None: unknown
    :param journal_radius_m: radius of the journal of a rotating joint [m]; None: unknown
    """

    loop: Loop
    candidates: tuple[Fit, ...]
    fit: Fit
    intervals: dict[str, Interval]
    because: dict[str, str]
    limits: dict[str, tuple[str, Interval]]
    confidence: float
    target: str
    normal_force_N: float | None
    journal_radius_m: float | None

    @property
    def model(self) -> str:
        """Name of the joint."""
        return self.fit.model.name

    @property
    def values(self) -> dict[str, float]:
        """Parameters by name, SI units."""
        return dict(self.fit.values)

    def answer(self) -> np.ndarray:
        """Return the fitted force in every row."""
        return self.fit.model.answer(self.fit.values, self.loop.displacement, self.loop.memory)

    def predict(self, displacement: np.ndarray) -> Prediction:
        """Return the predicted force and energy loss of another test of this joint, with intervals.

        :param displacement: path of the other test [m], or its rotations [rad]
        """
        return predicted(self, displacement)

    @property
    def entries(self) -> list[case_section.Entry]:
        """Keys of the case file."""
        return case_section.entries(self.target, self.fit.values, self.intervals, self.confidence,
                                    self.normal_force_N, self.journal_radius_m, self.loop.angular)

    def joint(self) -> str:
        """Return the section of a case file. Parameters that the loop does not determine become comments."""
        return "\n".join(case_section.section(self.target, self.entries, self.loop.name))

    def changes(self) -> dict[str, float]:
        """Return the argument for ``case.changed``: values by key, for the parameters that the loop determines."""
        before = case_section.TARGETS[self.target][1]
        return {f"{before}.{entry.key}": entry.value for entry in self.entries if entry.value is not None}

    def distributions(self) -> dict[str, dict[str, float | str]]:
        """Return the argument for ``sj.montecarlo``: independent distributions that describe the uncertainty of this
        joint's parameters. To estimate joint-to-joint scatter, test several joints."""
        return case_section.distributions(self.target, self.entries)

    @cached_property
    def notes(self) -> list[Note]:
        """Return notes on parameters that the loop does not determine, and on doubtful results."""
        return [*self._choice(), *self._unbounded(), *self._absent(), *self._laws(), *self._extrapolated(),
                *self._residuals()]

    def _choice(self) -> list[Note]:
        best = self.candidates[0]
        if self.fit.model.name != best.model.name:
            if best.bic < self.fit.bic - BARE_MENTION:
                return [Note("other_joint_fits_better", better=best.model.name, less=self.fit.bic - best.bic)]
            return []
        near = [each for each in self.candidates[1:] if each.bic - best.bic < BARE_MENTION]
        return [Note("joints_alike", best=best.model.name, other=each.model.name, difference=each.bic - best.bic)
                for each in near]

    def _unbounded(self) -> list[Note]:
        sentences: list[Note] = []
        for name, interval in self.intervals.items():
            if not interval.bounded:
                cause = self.because.get(name)
                why = f", it depends on {cause}, which reaches the end of its range" if cause else ""
                reason = "other_parameter" if cause else "unbounded"
                sentences.append(self._not_identifiable(name, interval, why, reason, depends_on=cause))
        return sentences

    def _laws(self) -> list[Note]:
        """What the section has no key for."""
        if self.target in ("slider", "spring_slider"):
            return [Note("play_carries_no_force")] if self.fit.values.get("play_ratio") else []
        return [Note("parameter_without_key", parameter=name, section=case_section.TARGETS[self.target][0])
                for name in ("play", "stop_stiffness") if name in self.fit.values]

    def _absent(self) -> list[Note]:
        sentences: list[Note] = []
        for name, (model, interval) in self.limits.items():
            reason = "never_slides" if self.model == "linear" else "no_friction"
            reason = reason if name == "friction" else "no_stop"
            why = f", {ABSENT[reason]} (joint {model})"
            sentences.append(self._not_identifiable(name, interval, why, reason, joint=model))
        if self.model == "linear":
            sentences.append(Note("clearance_not_crossed"))
        return sentences

    def _extrapolated(self) -> list[Note]:
        """Return a note that the friction limit is extrapolated, if a law of partial slip has no gross slip in the
        loop."""
        if self.fit.model.answer is MODELS["coulomb"].answer or "friction" not in self.fit.values:
            return []
        alone = {**self.fit.values, "preload": 0.0, "preload_stiffness": 0.0}
        reached = float(np.max(np.abs(self.fit.model.answer(alone, self.loop.displacement, self.loop.memory))))
        share = reached / self.fit.values["friction"]
        return [] if share > 1 - 1e-9 else [Note("friction_extrapolated", percent=100 * share)]

    def _not_identifiable(self, name: str, interval: Interval, why: str, reason: str, **more: str | None) -> Note:
        return Note("not_identifiable", parameter=name, why=why, bound=self._words(name, interval), reason=reason,
                    low=interval.low, high=interval.high, **more)

    def _words(self, name: str, interval: Interval) -> str:
        unit = self.loop.unit(PARAMETERS[name].dimension)
        low, high = plain(interval.low, unit, 4), plain(interval.high, unit, 4)
        level = f"at {100 * self.confidence:g} %"
        if interval.low > -np.inf:
            return f"at least {low} {level}"
        return f"at most {high} {level}" if interval.high < np.inf else "nothing bounds it"

    @property
    def correlation(self) -> float:
        """Correlation of the residuals of successive rows."""
        left = self.loop.force - self.answer()
        total = float(left @ left)
        return float(left[1:] @ left[:-1]) / total if total else 0.0

    def _residuals(self) -> list[Note]:
        if self.correlation * np.sqrt(self.fit.rows) <= CHANCE:
            return []
        return [Note("residuals_correlated", correlation=self.correlation, rows=self.fit.rows,
                     independent=self.fit.independent_rows)]

    def _rows_of_parameters(self) -> list[tuple[str, str, float, float, float]]:
        return [(name, self.loop.unit(PARAMETERS[name].dimension), self.fit.values[name], interval.low, interval.high)
                for name, interval in self.intervals.items()]

    def _rows_of_models(self) -> list[tuple[str, int, float, float, float, float]]:
        return [(each.model.name, len(each.values) + 1, each.noise, each.log_likelihood, each.bic,
                 each.bic - self.candidates[0].bic) for each in self.candidates]

    def frame(self, table: str = "parameters") -> pandas.DataFrame:
        """Return a table: ``parameters``, ``models``, or the ``rows`` of the fit."""
        if table == "parameters":
            return libraries.frame(self._rows_of_parameters(), columns=PARAMETER_COLUMNS)
        if table == "models":
            return libraries.frame(self._rows_of_models(), columns=MODEL_COLUMNS)
        if table == "rows":
            return libraries.frame(self._columns())
        raise NotAllowed("table", table, code="no_table_of_fit")

    def _columns(self) -> dict[str, np.ndarray]:
        displacement, force = self.loop.displacement, self.loop.force
        names = ("rotation_rad", "moment_N_m", "fitted_moment_N_m", "residual_N_m") if self.loop.angular else (
            "displacement_m", "force_N", "fitted_force_N", "residual_N")
        fitted = self.answer()
        return dict(zip(names, (displacement, force, fitted, force - fitted)))

    def plot(self, axes: tuple[Axes, Axes] | None = None) -> Figure:
        """Draw loop, fit and residual, into two given axes or into a new figure."""
        return _DRAWN(self, axes)

    def summary_lines(self) -> list[Shown | str]:
        """Return what the command prints."""
        force = self.loop.unit("force")
        models = Shown("joints, the best by BIC first", ("joint", "parameters", f"noise [{force}]", "BIC difference"),
                       [(name, f"{count}", f"{noise:.4g}", f"{more:.1f}")
                        for name, count, noise, _, _, more in self._rows_of_models()], left=("joint",))
        level = f"{100 * self.confidence:g} %"
        parameters = Shown(
            f"{self.model}, all {self.fit.rows} rows: {self.fit.model.formula}",
            ("parameter", "unit", "estimate", f"{level} from", "to", "what"),
            [(name, unit, f"{value:.6g}", _end(low), _end(high), PARAMETERS[name].meaning)
             for name, unit, value, low, high in self._rows_of_parameters()], left=("parameter", "unit", "what"))
        return [models, parameters, *(f"note: {note}" for note in self.notes)]

    def write(self, folder: Path) -> list[Path]:
        """Write tables, section of a case file, distributions and picture into a folder; return the paths."""
        rows = folder / "fit.csv"
        write_columns(self._columns(), rows)
        note = [f"# {note}" for note in self.notes]
        return [
            write_csv(folder / "parameters.csv", PARAMETER_COLUMNS, self._rows_of_parameters()),
            write_csv(folder / "models.csv", MODEL_COLUMNS, self._rows_of_models()), rows,
            write_text(folder / "joint.toml", [*self.joint().splitlines(), *note]),
            write_text(folder / "vary.toml", [f"# identified from {self.loop.name}: how well its loop knows this joint",
                                              *case_section.vary(self.distributions())]),
            *_SAVED(self.plot(), folder, "loop"),
        ]

    def __repr__(self) -> str:
        return f"Identification({self.loop.name!r}, {self.model}, {self.fit.rows:,} rows)"

    def _repr_html_(self) -> str:
        head, *parts = (part for part in self.summary_lines() if isinstance(part, Shown))
        tables = [f"<h4>{part.title}</h4>{html_table(part.header, part.rows)}" for part in (*parts, head)]
        return "".join(tables) + "".join(f"<p>{note}</p>" for note in self.notes)


def _end(value: float) -> str:
    return f"{value:.6g}" if np.isfinite(value) else "none"


def identify(
    source: str | Path | Mapping[str, Any], *, model: str | Sequence[str] = AUTO, start: str = "unknown",
    confidence: float = 0.95, target: str | None = None, normal_force_N: float | None = None,
    journal_radius_m: float | None = None, ignored: Sequence[str] = (),
    columns: Sequence[str] = (),
) -> Identification:
    """Identify a joint from a measured loop.

    Least squares find the parameters; noise of the force may be correlated. Profile likelihood gives the intervals, and
    BIC selects the joint. Notes list the parameters that the loop does not determine.

    :param source: a table, or columns: ``displacement_m`` and ``force_N``, or ``rotation_rad`` and ``moment_N_m``, also
        in other units, with rows in the order of measurement. The force is positive if it resists a positive
        displacement
    :param model: one or several names of joints, or ``auto``: all of :data:`statejump.identification.models.MODELS`
    :param start: friction before the first row. ``fresh``: zero; ``cycled``: the path was traversed before;
        ``unknown``: it is a parameter
    :param confidence: confidence level of the intervals, 0.5 to 0.999
    :param target: item of a case for the joint: ``spring_slider`` (default), ``slider``, ``revolute``, ``umbrella``
        (default of rotations), ``torsion_spring``, ``iwan_joint``
    :param normal_force_N: normal force in the test [N]; it converts the friction force to a friction coefficient
    :param journal_radius_m: radius of the journal [m]; it converts the friction moment to a friction coefficient
    :param ignored: names of columns to omit from a table
    :param columns: names of the columns, for a table without a header or in place of its own
    :raises StatejumpError: the file is not a loop, or the joint is unknown
    """
    for key, given in (("normal_force_N", normal_force_N), ("journal_radius_m", journal_radius_m)):
        if given is not None and not 0 < given < float("inf"):
            raise NotAllowed(key, given, code="not_positive", unit="N" if key.endswith("_N") else "m")
    if not (isinstance(confidence, (int, float)) and confidence in CONFIDENCE):
        raise NotAllowed("confidence", confidence, code="out_of_range", allowed=CONFIDENCE)
    names = list(MODELS) if model == AUTO else [model] if isinstance(model, str) else list(model)
    for name in names:
        if name not in MODELS:
            raise NotAllowed("model", name, code="model_unknown", allowed=(AUTO, *MODELS), auto=AUTO,
                             models=", ".join(MODELS))
    if not names:
        raise NotAllowed("model", model, code="no_joint_model")
    loop = read_loop(source, start, ignored, columns)
    chosen_target = target or ("umbrella" if loop.angular else "spring_slider")
    case_section.check(chosen_target, loop.angular)
    with located(file=source if isinstance(source, (str, Path)) else None):
        fits = Fits(loop)
        chosen = fits.ranked(names)[0].model.name
        _, found = intervals(fits, chosen, confidence)
        limits = {}
        for name in ("friction", "clearance_minus", "clearance_plus"):
            larger = _larger(chosen, name)
            if larger is not None:
                limits[name] = (larger, intervals(fits, larger, confidence, [name])[1].of[name])
        candidates = fits.ranked(names)
    best = next(each for each in candidates if each.model.name == chosen)
    return Identification(loop, tuple(candidates), best, found.of, found.because, limits, confidence, chosen_target,
                          normal_force_N, journal_radius_m)


def _larger(name_of_best: str, name: str) -> str | None:
    """Return the smallest joint that has one given parameter more than a joint; None if there is no such joint."""
    model = MODELS[name_of_best]
    have = set(model.parameters)
    if name in have or model.name == "linear" and name != "friction":
        return None
    slides = MODELS["coulomb"].answer
    if model.answer is not slides and model.name != "linear":
        return None
    larger = [each for each in MODELS.values() if have | {name} <= set(each.parameters) and each.answer is slides]
    return min(larger, key=lambda each: len(each.parameters)).name if larger else None
