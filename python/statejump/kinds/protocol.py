# SPDX-License-Identifier: GPL-3.0-or-later
"""What a kind of case is: one object with everything that knows the kind.

A kind is a subclass of :class:`Kind` that has a name, a class of cases and the abilities below as methods. An
ability that it lacks is not there, and what needs it refuses the case with one sentence.

==================  =====================================================================================
``reduced``         ``(case, tell) -> Run``: the reduced model; ``tell`` takes the finished share
``quasi_static``    ``(case)``: paths of infinitely slow heating, of a kind whose ``reduced`` has inertia
``dynamic``         ``(case, tell) -> Run``: the reduced model with inertia, of a kind whose ``reduced`` has none
``dem_input``       ``(case) -> dict``: what the scene in YADE needs, as plain values
``dem_run``         ``(case, columns, about) -> Run``: a finished or interrupted DEM run
``compare``         ``(case, reduced, dem) -> Comparison``
``difference``      ``(case, first, second) -> list[Quantity]``: two runs of one model, at the same times
``sheet``           ``(case, runs) -> Sheet``: figure of one run, or of two on top of each other
``scene``           ``(case) -> dict``: what to draw of its parts, see :mod:`statejump.results.scene`
``names``           ``(case) -> dict``: names of the items of columns
``describe``        ``(case) -> list[str]``: the case in sentences
``charts``          ``(case) -> list[Chart]``: curves on the page of ``statejump report``
``event_reason``    ``(case, event, model, runs) -> str``: why only that model has an event; "": it is not known
``page``            ``(result, case) -> Part | None``: a part of that page that only this kind has
``outcomes``        ``(case, run) -> dict[str, float]``: what a campaign records of a run, by the names of ``OUTCOMES``
``quick``           ``(case) -> Run``: the reduced model with as few samples as ``outcomes`` needs; else ``reduced``
``told``            ``(case, runs) -> list``: what a command prints of runs, tables and lines
``control``         ``(case, **settings) -> Study``: what makes the state jump smaller, :mod:`statejump.control`
==================  =====================================================================================

Further abilities are those of single commands and have their names: ``statics``, ``answers``, ``creak``,
``convergence``, ``fe``, ``hold``, ``slow``, ``energy``, ``figures``, ``laws``, ``contact_problems``.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from statejump.core.case import Case as Definition
from statejump.core.errors import NotAllowed
from statejump.core.progress import Tell
from statejump.core.run import Run


CaseType = TypeVar("CaseType", bound=Definition)


class Kind(Generic[CaseType]):
    """A kind of case; see the module.

    ``Case`` is the class of its definitions: keys with unit, range, default and source.
    """

    name: ClassVar[str]
    Case: ClassVar[type[Definition]]
    # Columns of one value a sample in the order of the CSV files, of either model.
    COLUMNS: ClassVar[tuple[str, ...]] = ()
    # Words of this kind for report and figures: of columns, contacts, links, stages, by their keys; with "stage "
    # in front of its name what a stage means.
    WORDS: ClassVar[Mapping[str, str]] = {}
    # Names of what a campaign records of a run, in the order of its table; each ends in its unit.
    OUTCOMES: ClassVar[tuple[str, ...]] = ()
    # Numbers of a run's summary that stand for where a program ends that does not end at the reference temperature.
    AT_PROGRAM_END: ClassVar[tuple[str, ...]] = ()
    # Models whose runs ``outcomes`` can measure.
    OUTCOMES_OF: ClassVar[tuple[str, ...]] = ("reduced", "dem")
    # Module that builds the scene in YADE, or the path of its file; by default scene_NAME beside the runner.
    SCENE: ClassVar[str] = ""

    def can(self, ability: str) -> bool:
        """Whether the kind has an ability."""
        return callable(getattr(self, ability, None))

    def ability(self, name: str, case: Definition) -> Callable[..., Any]:
        """Return an ability. :raises NotAllowed: the kind lacks it; the sentence says which kinds have it"""
        if self.can(name):
            found: Callable[..., Any] = getattr(self, name)
            return found
        raise self.refusal(name, case)

    def refusal(self, name: str, case: Definition) -> NotAllowed:
        """Return why a case of this kind is refused by what needs an ability."""
        from statejump.kinds import kinds_that_can

        others = " and ".join(repr(other) for other in kinds_that_can(name))
        command = COMMANDS.get(name, name.replace("_", " "))
        return NotAllowed("case.kind", self.name, f"'statejump {command}' is for {others or 'no kind of case'}",
                          file=case.origin.file)

    def dem(self, case: CaseType, tell: Tell) -> Run:
        """Run a case in YADE. A kind whose scene needs more than the case itself has its own."""
        from statejump.core import yade_process

        return yade_process.run(case, self.dem_values(case), self.ability("dem_run", case), tell)

    def check_dem(self, case: CaseType) -> None:
        """Raise StatejumpError where the DEM cannot run a case, as far as that is known before anything is solved. A
        kind whose scene needs a solution has its own."""
        from statejump.core.yade_process import find_yade

        self.dem_values(case)
        find_yade()

    def dem_values(self, case: CaseType) -> dict[str, Any]:
        """Return what the script in YADE reads."""
        return {"scene": self.scene_module(), **self.ability("dem_input", case)(case)}

    def has_model(self, model: str) -> bool:
        """Return whether cases of this kind can be run in a model: ``reduced`` or ``dem``."""
        return self.can({"reduced": "reduced", "dem": "dem_run"}[model])

    def campaign_models(self) -> tuple[str, ...]:
        """Return the models that campaigns run."""
        return tuple(model for model in self.OUTCOMES_OF if self.has_model(model))

    def outcome_names(self, case: CaseType) -> tuple[str, ...]:
        """Return the names of ``OUTCOMES`` that a case can have."""
        return self.OUTCOMES

    def recorded(self, case: CaseType, run: Run) -> dict[str, float]:
        """Return the outcomes of a run, and where its program ends if that is not at the reference temperature."""
        found: dict[str, float] = self.ability("outcomes", case)(case, run)
        return found if case.ending is None else {**found, **{name: run.summary[name] for name in self.AT_PROGRAM_END}}

    def samples(self, case: CaseType, model: str) -> int:
        """Return how many samples a run of a model has."""
        return case.samples_per_cycle * case.thermal.cycles + 1

    def scene_module(self) -> str:
        """Return the module that builds the scene in YADE."""
        return self.SCENE or f"scene_{self.name}"

    def case_from(self, data: Mapping[str, Any]) -> Definition:
        """Return the case of a parsed document. :raises StatejumpError: one failure, without the file's name"""
        from statejump.core import thermal
        from statejump.schema.structure import structure

        for section in self.Case.NOT_IN_FILE:
            if section in data:
                raise NotAllowed(f"section [{section}]", cause=self.Case.NOT_IN_FILE[section])
        made = structure(self.Case, data)
        thermal.check(made.thermal, returns=made.ending is not None)
        made.check_cycles()
        made.check()
        return made


# Commands whose name is not that of the ability.
COMMANDS = {"dem_input": "dem", "dynamic": "reduced --dynamic", "quasi_static": "reduced --quasi-static",
            "answers": "truss answers", "creak": "truss creak", "draw": "truss draw", "surface": "truss surface",
            "contact_problems": "fclib write", "outcomes": "sweep", "sheet": "plot"}
Columns = Mapping[str, np.ndarray]
