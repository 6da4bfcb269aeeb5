# SPDX-License-Identifier: GPL-3.0-or-later
"""What a kind of case is: one object with everything that knows the kind.

A kind is a subclass of :class:`Kind` that has a name, a class of cases and capabilities. A capability is a protocol of
one method, or of methods that belong together. A kind that lacks one leaves its methods out, and what needs it refuses
the case with one sentence. Capabilities of the layers on the right are :mod:`statejump.control.capabilities` (design)
and :mod:`statejump.report.capabilities` (text, figures, page).

A kind of the package names the functions of its methods by their places (:class:`.Later`), so that a command loads no
more than it needs; a kind of one's own may have plain methods.
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
# What a message calls a capability: the command that needs it.
_COMMANDS: dict[type, str] = {}
_OTHERS = Later("statejump.kinds:names_of_kinds_with")


def capability(command: str) -> Callable[[type[Capability]], type[Capability]]:
    """Declare a protocol as a capability of kinds.

    :param command: that needs it, for the message that refuses other kinds
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
    """The reduced model; ``on_progress`` takes the finished share."""

    def reduced(self, case: Any, on_progress: OnProgress) -> Run: ...


@capability("reduced --trace")
class TracedModel(Protocol):
    """The reduced model with a record of each iteration of its solver.

    ``trace`` is a CSV file, or a function that takes each row."""

    def traced(self, case: Any, on_progress: OnProgress, trace: Path | Callable[[tuple[Any, ...]], object]) -> Run: ...


@capability("reduced --quasi-static")
class QuasiStaticModel(Protocol):
    """Paths of infinitely slow heating, of a kind whose reduced model has inertia."""

    def quasi_static(self, case: Any) -> Any: ...


@capability("reduced --dynamic")
class DynamicModel(Protocol):
    """The reduced model with inertia, of a kind whose reduced model has none."""

    def dynamic(self, case: Any, on_progress: OnProgress) -> Run: ...


@capability("dem")
class DemInput(Protocol):
    """What the scene in YADE needs, as plain values."""

    def dem_input(self, case: Any) -> dict[str, Any]: ...


@capability("dem --keep-input")
class DemValues(Protocol):
    """The data that the script in YADE reads; :class:`Kind` makes it of the input."""

    def dem_values(self, case: Any) -> dict[str, Any]: ...


@capability("dem run")
class DemResult(Protocol):
    """A finished or interrupted DEM run of the columns that YADE wrote."""

    def dem_run(self, case: Any, columns: Columns, about: Mapping[str, Any]) -> Run: ...


@capability("dem")
class DemModel(Protocol):
    """The DEM as a whole; :class:`Kind` makes it of input and result."""

    def dem(self, case: Any, on_progress: OnProgress) -> Run: ...

    def check_dem(self, case: Any) -> None: ...


@capability("compare")
class ModelComparison(Protocol):
    """Both models beside each other."""

    def compare(self, case: Any, reduced: Run, dem: Run) -> Comparison: ...


@capability("difference")
class RunDifference(Protocol):
    """Two runs of one model, at the same times."""

    def difference(self, case: Any, first: Run, second: Run) -> list[Quantity]: ...


@capability("names")
class ItemNames(Protocol):
    """Names of the items of columns."""

    def names(self, case: Any) -> dict[str, list[str]]: ...


@capability("scene")
class SceneDescription(Protocol):
    """What to draw of its parts, see :mod:`statejump.results.scene`."""

    def scene(self, case: Any) -> dict[str, Any]: ...


@capability("sweep")
class Outcomes(Protocol):
    """What a campaign records of a run, by the names of ``Kind.OUTCOMES``."""

    def outcomes(self, case: Any, run: Run) -> dict[str, float]: ...


@capability("quick")
class QuickModel(Protocol):
    """The reduced model with as few samples as its outcomes need."""

    def quick(self, case: Any) -> Run: ...


@capability("laws")
class JointOfLaws(Protocol):
    """The joint as the curves of the contact laws need it."""

    def laws(self, case: Any) -> Any: ...


@capability("fclib write")
class ContactProblems(Protocol):
    """Frictional contact problems of steps of the path."""

    def contact_problems(self, case: Any, number: int, on_progress: OnProgress) -> list[Any]: ...


@capability("truss surface")
class ReflectorSurface(Protocol):
    """The drawn surface of a reflector and the positions of its nodes (k, 3) [m]."""

    def surface(self, case: Any) -> tuple[Any, np.ndarray]: ...


CaseType = TypeVar("CaseType", bound=Definition)


class Kind(Generic[CaseType]):
    """A kind of case; see the module.

    ``Case`` is the class of its cases: keys with unit, range, default and source.
    """

    name: ClassVar[str]
    Case: ClassVar[type[Definition]]
    # Columns of one value a sample in the order of the CSV files, of either model.
    COLUMNS: ClassVar[tuple[str, ...]] = ()
    # Words of this kind for report and figures: of columns, contacts, links, stages, by their keys; with "stage "
    # in front of its name what a stage means.
    LABELS: ClassVar[Mapping[str, str]] = {}
    # Names of what a campaign records of a run, in the order of its table; each ends in its unit.
    OUTCOMES: ClassVar[tuple[str, ...]] = ()
    # Numbers of a run's summary that stand for where a program ends that does not end at the reference temperature.
    AT_PROGRAM_END: ClassVar[tuple[str, ...]] = ()
    # Models whose runs ``outcomes`` can measure.
    OUTCOMES_OF: ClassVar[tuple[str, ...]] = ("reduced", "dem")
    # Module that builds the scene in YADE, or the path of its file; by default scene_NAME beside the runner.
    SCENE: ClassVar[str] = ""

    def dem(self, case: CaseType, on_progress: OnProgress) -> Run:
        """Run a case in YADE. A kind whose scene needs more than the case itself has its own."""
        return yade_process.run(case, self.dem_values(case), needed(self, DemResult, case).dem_run, on_progress)

    def check_dem(self, case: CaseType) -> None:
        """Raise StatejumpError where the DEM cannot run a case, as far as that is known before anything is solved. A
        kind whose scene needs a solution has its own."""
        self.dem_values(case)
        yade_process.find_yade()

    def dem_values(self, case: CaseType) -> dict[str, Any]:
        """Return what the script in YADE reads."""
        return {"scene": self.scene_module(), **needed(self, DemInput, case).dem_input(case)}

    def has_model(self, model: str) -> bool:
        """Return whether cases of this kind can be run in a model: ``reduced`` or ``dem``."""
        return supports(self, {"reduced": ReducedModel, "dem": DemResult}[model])

    def campaign_models(self) -> tuple[str, ...]:
        """Return the models that campaigns run."""
        return tuple(model for model in self.OUTCOMES_OF if self.has_model(model))

    def outcome_names(self, case: CaseType) -> tuple[str, ...]:
        """Return the names of ``OUTCOMES`` that a case can have."""
        return self.OUTCOMES

    def recorded(self, case: CaseType, run: Run) -> dict[str, float]:
        """Return the outcomes of a run, and where its program ends if that is not at the reference temperature."""
        found = needed(self, Outcomes, case).outcomes(case, run)
        return found if case.ending is None else {**found, **{name: run.summary[name] for name in self.AT_PROGRAM_END}}

    def samples(self, case: CaseType, model: str) -> int:
        """Return how many samples a run of a model has."""
        return case.samples_per_cycle * case.thermal.cycles + 1

    def scene_module(self) -> str:
        """Return the module that builds the scene in YADE."""
        return self.SCENE or f"scene_{self.name}"

    def case_from(self, data: Mapping[str, Any]) -> Definition:
        """Return the case of a parsed document. :raises StatejumpError: one failure, without the file's name"""
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
    """Return a kind as what has a capability.

    :raises NotAllowed: it lacks the capability; the sentence names the kinds that have it
    """
    if supports(kind, protocol):
        return cast(Capability, kind)
    others = " and ".join(repr(other) for other in _OTHERS(protocol))
    raise NotAllowed("case.kind", kind.name, code="command_not_for_kind", file=case.origin.file,
                     command=_COMMANDS[protocol], kinds=others or "no kind of case")
