# SPDX-License-Identifier: GPL-3.0-or-later
"""Quasi-static path of a truss case: the reduced model."""
from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, overload

import numpy as np

from statejump import _engine
from statejump.core import thermal
from statejump.core.engine_failures import EngineFailed
from statejump.core.errors import Interrupted
from statejump.core.progress import OnProgress
from statejump.core.start import FRICTIONLESS
from statejump.core.thermal import MemberProgram, Thermal
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.check_mechanism import check_at_rest
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.protocol import JointType
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.texts import InBlocks

# Size of the states of a whole path [bytes] above which only the ends of cycles are kept.
LARGEST_PATH = 1 << 30


@dataclass(frozen=True)
class TrussEvent:
    """Change of the status of a joint, located between the times time_s - interval_s and time_s."""

    time_s: float
    interval_s: float
    temperature_change_K: float
    joint_kind: str  # section of its type: "slider", "revolute", ...
    name: str
    before: str
    after: str


@dataclass(frozen=True, eq=False)
class TrussEvents(Sequence[TrussEvent]):
    """The events of a path in order of time. They are stored as columns; event objects are made on access."""

    truss: ResolvedTruss
    time_s: np.ndarray
    interval_s: np.ndarray
    temperature_change_K: np.ndarray
    kind: np.ndarray  # indices in kinds
    joint: np.ndarray  # indices among the joints of the kind
    before: np.ndarray  # keys of statuses
    after: np.ndarray
    kinds: Sequence[str]
    statuses: Mapping[int, str]

    def __len__(self) -> int:
        return len(self.time_s)

    @overload
    def __getitem__(self, place: int) -> TrussEvent: ...

    @overload
    def __getitem__(self, place: slice) -> list[TrussEvent]: ...

    def __getitem__(self, place: int | slice) -> TrussEvent | list[TrussEvent]:
        if isinstance(place, slice):
            return [self[index] for index in range(*place.indices(len(self)))]
        kind = self.kinds[self.kind[place]]
        return TrussEvent(
            float(self.time_s[place]), float(self.interval_s[place]), float(self.temperature_change_K[place]), kind,
            self.truss.joints[kind].names[self.joint[place]], self.statuses[int(self.before[place])],
            self.statuses[int(self.after[place])],
        )


@dataclass(frozen=True)
class TrussPath:
    """Path that the engine returns. ``states`` and ``cycle_ends`` map a name with unit to an array whose first axis is
    the state: (states, nodes, 3), (states, links), ... Axial force is positive in compression."""

    truss: ResolvedTruss
    states: dict[str, np.ndarray]
    cycle_ends: dict[str, np.ndarray]
    events: TrussEvents
    complete: bool
    solves: int
    factorizations: int
    unknowns: int
    problems: list[dict[str, Any]]  # frictional contact problems at the requested times
    largest_force_residual: float
    largest_closure_residual_m: float
    notes: list[dict[str, Any]]  # warnings, as the engine's Path::notes

    @property
    def energy_residue_J(self) -> float:
        """Thermal work minus elastic energy, load potential and frictional heat [J], all since the start."""
        states = self.states
        stored = states["elastic_energy_J"] + states["load_potential_J"]
        return float((states["thermal_work_J"] - (stored - stored[0]) - heat_of_joints_J(states).sum(axis=1))[-1])


def heat_of_joints_J(states: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the frictional heat since the start [J] (states, joints) of all joints, type by type."""
    kinds = _engine.truss_joints()
    return np.concatenate([states[f"{kind}_dissipation_J"] for kind in kinds], axis=1)


def engine_program(program: Thermal | MemberProgram) -> _engine.ThermalProgram:
    """Return the engine's temperature program for a program of a truss."""
    return thermal.program(program, program.period_s)


def engine_programs(truss: ResolvedTruss) -> list[_engine.ThermalProgram]:
    """Return all temperature programs of a truss as engine objects, cached because a truss is immutable."""
    kept = vars(truss)
    if "_engine_programs" not in kept:
        kept["_engine_programs"] = [engine_program(program) for program in truss.programs]
    found: list[_engine.ThermalProgram] = kept["_engine_programs"]
    return found


def _table(part: Any, *keys: str, **more: Any) -> dict[str, Any]:
    return {"names": InBlocks(part.names), **{key: getattr(part, key) for key in keys}, **more}


def _joints(truss: ResolvedTruss, joint: JointType[Any, Any]) -> dict[str, Any]:
    """Return the joints of a type as arrays for the engine."""
    joints = truss.joints[joint.section]
    made = joint.engine_arrays(truss, joints)
    keys = [parameter["key"] for parameter in _engine.truss_joints()[joint.section]["parameters"]]
    return _table(joints, *(key for key in keys if key not in made), **made)


def _elements(truss: ResolvedTruss, table: str) -> dict[str, Any]:
    """Return the elements of a type as arrays for the engine."""
    keys = dict.fromkeys(parameter["key"] for parameter in _engine.truss_elements()[table]["parameters"])
    parts = {"links": truss.links} | {element.items: truss.elements[element.section] for element in ELEMENTS}
    own = {element.items: element.engine_arrays(truss.elements[element.section]) for element in ELEMENTS}
    return _table(parts[table], *keys, **own.get(table, {}))


def engine_items(truss: ResolvedTruss) -> dict[str, Any]:
    """Return the truss as tables and temperature programs of the engine."""
    return {
        "nodes": _table(truss.nodes, "position_m", "fixed", "guide_normal", "force_N",
                        *(("fixed_rotations", "moment_N_m") if truss.bending() else ())),
        "elements": {table: _elements(truss, table) for table in _engine.truss_elements()},
        "joints": {joint.section: _joints(truss, joint) for joint in JOINTS},
        "constraints": _table(truss.constraints, "coefficients",
                              nodes=truss.constraints.sites(len(truss.nodes.names))),
        "programs": engine_programs(truss),
    }


def path(
    truss: ResolvedTruss,
    *,
    increments_per_branch: int = 50,
    locate_events: bool = True,
    event_tolerance: float = 1e-9,
    energy_tolerance: float = 2.5e-11,
    cycle_ends_only: bool = False,
    problem_times: Sequence[float] = (),
    progress: Callable[[float], bool | None] | None = None,
    trace: Callable[[tuple[Any, ...]], object] | None = None,
) -> TrussPath:
    """Return the quasi-static path of a truss.

    :param increments_per_branch: number of points of the path per monotone branch of the temperature
    :param locate_events: whether to locate every change of a joint status, or only changes that affect the state
    :param event_tolerance: interval within which a change is located, as a fraction of a branch
    :param energy_tolerance: allowed energy error, as a fraction of the work of the temperature. If events are located,
        increments with a larger error are divided; 1: no increment is divided
    :param cycle_ends_only: whether to keep only the ends of cycles
    :param problem_times: ascending times [s] at which the contact problem of a step is stored
    :param progress: called with the finished fraction; returning False ends the path
    :param trace: called with each Newton iteration, see :data:`statejump.kinds.truss.trace.COLUMNS`
    :raises FailedRun: mechanism, unloaded joint or no equilibrium; the message has names and temperature
    :raises StatejumpError: a link is driven
    """
    check_at_rest(truss)
    with failing(truss):
        found = _engine.truss_path(
            **engine_items(truss), increments_per_branch=increments_per_branch, locate_events=locate_events,
            event_tolerance=event_tolerance, energy_tolerance=energy_tolerance, cycle_ends_only=cycle_ends_only,
            problem_times=problem_times, start_friction=truss.start_friction, progress=progress,
            trace=trace,
        )
    return path_from(truss, found)


def path_from(truss: ResolvedTruss, found: dict[str, Any]) -> TrussPath:
    """Return a path that the engine returned."""
    check_states(truss, found["states"])
    events = TrussEvents(truss, **found.pop("events"))
    return TrussPath(truss=truss, events=events, **found)


@contextmanager
def failing(truss: ResolvedTruss) -> Iterator[None]:
    """Raise failures of the engine as errors of the package, with a remedy if one is known."""
    try:
        yield
    except _engine.EngineFailure as failure:
        raise _failed(truss, failure) from None


def check_states(truss: ResolvedTruss, states: Mapping[str, np.ndarray]) -> None:
    """Raise an error if a joint leaves the range of its law in a state."""
    for joint in JOINTS:
        joint.check_states(truss, truss.joints[joint.section], states)


def whole_path(truss: ResolvedTruss, on_progress: OnProgress = lambda share: None, **options: Any) -> TrussPath:
    """Return the complete path; see :func:`path`.

    :param on_progress: called with the finished fraction, 0 to 1
    :raises Interrupted: Ctrl-C was pressed
    """
    def going_on(share: float) -> bool:
        on_progress(share)
        return True

    found = path(truss, progress=going_on, **options)
    if not found.complete:
        raise Interrupted()
    return found


def _failed(truss: ResolvedTruss, failure: _engine.EngineFailure) -> EngineFailed:
    """Return the error for a failure of the engine, with a remedy if one is known."""
    remedy = None
    if truss.start_friction == FRICTIONLESS and failure.time_s == 0:
        remedy = "set start.friction to 'stuck' if friction holds the truss at the start"
    return EngineFailed(failure, remedy=remedy, case=truss.name, place=truss.name)


def solve(case: TrussCase, on_progress: OnProgress = lambda fraction: None,
          trace: Callable[[tuple[Any, ...]], object] | None = None) -> TrussPath:
    """Return the path of a case with the settings in its [reduced]. The path of a case is computed once and cached,
    because the DEM starts from it. Only a trace causes a new solution.

    :param on_progress: called with the finished fraction, 0 to 1
    :param trace: as for :func:`path`
    :raises FailedRun: mechanism, unloaded joint or no equilibrium; the message has names and temperature
    :raises Interrupted: Ctrl-C was pressed
    """
    kept = vars(case)
    if trace is not None or "_path" not in kept:
        kept["_path"] = _solved(case, on_progress, trace)
    found: TrussPath = kept["_path"]
    return found


def _solved(case: TrussCase, on_progress: OnProgress, trace: Callable[[tuple[Any, ...]], object] | None) -> TrussPath:
    truss = case.resolve()
    items = 3 * len(truss.nodes.names) + len(truss.links.names) + 8 * len(truss.revolutes.names)
    branches = max(2, *(len(program.table_time_s or ()) for program in (case.thermal, *case.program)))
    states = branches * case.thermal.cycles * case.reduced_settings.increments_per_branch
    ends_only = 8 * items * states > LARGEST_PATH
    return whole_path(truss, on_progress, cycle_ends_only=ends_only, trace=trace, **settings(case))


def settings(case: TrussCase) -> dict[str, Any]:
    """Return the settings of [reduced] in a case as arguments of :func:`path`."""
    keys = "increments_per_branch", "locate_events", "event_tolerance", "energy_tolerance"
    return {key: getattr(case.reduced_settings, key) for key in keys}
