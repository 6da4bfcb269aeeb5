# SPDX-License-Identifier: GPL-3.0-or-later
"""Contract of a kind of case: one object defines everything that other modules use of the kind.

A kind is a subclass of :class:`Kind` with a name, a class of cases and capabilities. A capability is a protocol of one
or several related methods. A kind that lacks a capability does not define its methods, and commands that need the
capability reject its cases. :mod:`statejump.control.capabilities` (design) and :mod:`statejump.report.capabilities`
(text, figures, page) declare the capabilities of later layers.

A kind of the package refers to the functions of its methods by name (:class:`.Later`), so that a command imports only
what it needs. A user's kind may have plain methods.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ClassVar, Generic, Protocol, TypeVar, cast

import numpy as np

from statejump.core import thermal, yade_process
from statejump.core.case import Case as Definition
from statejump.core.comparison import Comparison, Quantity
from statejump.core.errors import NotAllowed
from statejump.core.later import Later
from statejump.core.progress import OnProgress
from statejump.core.run import Columns, Run
from statejump.schema.structure import structure

Capability = TypeVar("Capability")
# Command that needs a capability, for messages.
_COMMANDS: dict[type, str] = {}
_OTHERS = Later("statejump.kinds:names_of_kinds_with")


def capability(command: str) -> Callable[[type[Capability]], type[Capability]]:
    """Declare a protocol as a capability of kinds of cases.

    :param command: the command that needs the capability, for the message that rejects other kinds
    """
    def declared(protocol: type[Capability]) -> type[Capability]:
        _COMMANDS[protocol] = command
        return protocol

    return declared


def methods_of(protocol: type) -> list[str]:
    """Return the names of the methods of a capability."""
    return [name for name, value in vars(protocol).items() if not name.startswith("_") and callable(value)]


@capability("reduced")
class ReducedModel(Protocol):
    """The reduced model; ``on_progress`` receives the finished fraction, 0 to 1."""

    def reduced(self, case: Any, on_progress: OnProgress) -> Run: ...


@capability("reduced --trace")
class TracedModel(Protocol):
    """The reduced model with a record of each iteration of its solver.

    ``trace`` is a CSV file, or a function that receives each row.
    """

    def traced(self, case: Any, on_progress: OnProgress, trace: Path | Callable[[tuple[Any, ...]], object]) -> Run: ...


@capability("reduced --quasi-static")
class QuasiStaticModel(Protocol):
    """Paths under infinitely slow heating, for a kind whose reduced model has inertia."""

    def quasi_static(self, case: Any) -> Any: ...


@capability("reduced --dynamic")
class DynamicModel(Protocol):
    """The reduced model with inertia, for a kind whose reduced model has none."""

    def dynamic(self, case: Any, on_progress: OnProgress) -> Run: ...


@capability("dem")
class DemInput(Protocol):
    """Input of the scene in YADE, as plain values."""

    def dem_input(self, case: Any) -> dict[str, Any]: ...


@capability("dem --keep-input")
class DemValues(Protocol):
    """Data for the script in YADE. :class:`Kind` makes them from the input of the DEM's scene."""

    def dem_values(self, case: Any) -> dict[str, Any]: ...


@capability("dem run")
class DemResult(Protocol):
    """Makes a DEM run, finished or interrupted, from the columns that YADE wrote."""

    def dem_run(self, case: Any, columns: Columns, about: Mapping[str, Any]) -> Run: ...


@capability("dem")
class DemModel(Protocol):
    """The whole DEM run; :class:`Kind` composes it from input and result."""

    def dem(self, case: Any, on_progress: OnProgress) -> Run: ...

    def check_dem(self, case: Any) -> None: ...


@capability("compare")
class ModelComparison(Protocol):
    """Both models beside each other."""

    def compare(self, case: Any, reduced: Run, dem: Run) -> Comparison: ...


@capability("difference")
class RunDifference(Protocol):
    """Comparison of two runs of one model at the same times."""

    def difference(self, case: Any, first: Run, second: Run) -> list[Quantity]: ...


@capability("names")
class ItemNames(Protocol):
    """Names of the items of columns."""

    def names(self, case: Any) -> dict[str, list[str]]: ...


@capability("scene")
class SceneDescription(Protocol):
    """Parts of a case for drawings, see :mod:`statejump.results.scene`."""

    def scene(self, case: Any) -> dict[str, Any]: ...


@capability("sweep")
class Outcomes(Protocol):
    """Numbers that a campaign records for every run, under the names in ``Kind.OUTCOMES``."""

    def outcomes(self, case: Any, run: Run) -> dict[str, float]: ...


@capability("quick")
class QuickModel(Protocol):
    """The reduced model for campaigns, with only as many samples as its outcomes need."""

    def quick(self, case: Any) -> Run: ...


@capability("laws")
class JointOfLaws(Protocol):
    """The joint of a case as input of the contact-law curves."""

    def laws(self, case: Any) -> Any: ...


@capability("fclib write")
class ContactProblems(Protocol):
    """Frictional contact problems of steps along the path."""

    def contact_problems(self, case: Any, number: int, on_progress: OnProgress) -> list[Any]: ...


@capability("truss surface")
class ReflectorSurface(Protocol):
    """The surface of a reflector in the reference configuration, and the positions of its nodes (k, 3) [m]."""

    def surface(self, case: Any) -> tuple[Any, np.ndarray]: ...


CaseType = TypeVar("CaseType", bound=Definition)


class Kind(Generic[CaseType]):
    """A kind of case; the module describes the contract.

    ``Case`` is the class of its cases, with unit, range, default and source of every key.
    """

    name: ClassVar[str]
    Case: ClassVar[type[Definition]]
    # Columns with one value per sample, in the order of the CSV files; for both models.
    COLUMNS: ClassVar[tuple[str, ...]] = ()
    # Labels for report and figures by key: columns, contacts, links, stages. The key ``stage NAME`` has the meaning of
    # a stage.
    LABELS: ClassVar[Mapping[str, str]] = {}
    # Names of the numbers that a campaign records of a run, in the order of its table; each ends in its unit.
    OUTCOMES: ClassVar[tuple[str, ...]] = ()
    # Summary numbers at the end of a program that does not end at the reference temperature.
    AT_PROGRAM_END: ClassVar[tuple[str, ...]] = ()
    # Models whose runs ``outcomes`` can measure.
    OUTCOMES_OF: ClassVar[tuple[str, ...]] = ("reduced", "dem")
    # Module that builds the scene in YADE, or the path of its file; default: scene_NAME beside the runner.
    SCENE: ClassVar[str] = ""

    def dem(self, case: CaseType, on_progress: OnProgress) -> Run:
        """Run a case in YADE. A kind overrides this method if its scene needs more data than the case."""
        return yade_process.run(case, self.dem_values(case), needed(self, DemResult, case).dem_run, on_progress)

    def check_dem(self, case: CaseType) -> None:
        """Raise StatejumpError if the DEM cannot run a case, as far as this is known without solving it. A kind whose
        scene needs a solution overrides this method."""
        self.dem_values(case)
        yade_process.find_yade()

    def dem_values(self, case: CaseType) -> dict[str, Any]:
        """Return what the script in YADE reads."""
        return {"scene": self.scene_module(), **needed(self, DemInput, case).dem_input(case)}

    def has_model(self, model: str) -> bool:
        """Return whether a model, ``reduced`` or ``dem``, can run cases of this kind."""
        return supports(self, {"reduced": ReducedModel, "dem": DemResult}[model])

    def campaign_models(self) -> tuple[str, ...]:
        """Return the models that campaigns run."""
        return tuple(model for model in self.OUTCOMES_OF if self.has_model(model))

    def outcome_names(self, case: CaseType) -> tuple[str, ...]:
        """Return the names in ``OUTCOMES`` that apply to a case."""
        return self.OUTCOMES

    def recorded(self, case: CaseType, run: Run) -> dict[str, float]:
        """Return the outcomes of a run, and ``AT_PROGRAM_END`` if the program does not end at its initial
        temperature."""
        found = needed(self, Outcomes, case).outcomes(case, run)
        return found if case.ending is None else {**found, **{name: run.summary[name] for name in self.AT_PROGRAM_END}}

    def samples(self, case: CaseType, model: str) -> int:
        """Return the number of samples of a run."""
        return case.samples_per_cycle * case.thermal.cycles + 1

    def scene_module(self) -> str:
        """Return the module that builds the scene in YADE."""
        return self.SCENE or f"scene_{self.name}"

    def case_from(self, data: Mapping[str, Any]) -> Definition:
        """Return the case of a parsed case file. :raises StatejumpError: the first failure, without the file's name"""
        for section in self.Case.NOT_IN_FILE:
            if section in data:
                raise NotAllowed(f"section [{section}]", code="not_from_file", cause=self.Case.NOT_IN_FILE[section])
        made = structure(self.Case, data)
        thermal.check(made.thermal, returns=made.ending is not None)
        made.check_cycles()
        made.check()
        return made


def supports(kind: Kind[Any], protocol: type) -> bool:
    """Whether a kind has a capability."""
    return all(callable(getattr(type(kind), name, None)) for name in methods_of(protocol))


def needed(kind: Kind[Any], protocol: type[Capability], case: Definition) -> Capability:
    """Return a kind, typed as the given capability.

    :raises NotAllowed: the kind lacks the capability; the message names the kinds that have it
    """
    if supports(kind, protocol):
        return cast(Capability, kind)
    others = " and ".join(repr(other) for other in _OTHERS(protocol))
    raise NotAllowed("case.kind", kind.name, code="command_not_for_kind", file=case.origin.file,
                     command=_COMMANDS[protocol], kinds=others or "no kind of case")
