# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact derivatives of the jump of a truss, for all parameters from one path.

The engine records the path and solves its adjoint equations once for an output (engine: statejump/truss/gradient.hpp).
It then gives the Lagrangian of a truss with changed parameters, a summand for each item. At fixed states the Lagrangian
is a smooth function without noise of a solver, and its derivative is that of the output. Here it is extrapolated from
central differences (C. J. F. Ridders, Adv. Eng. Softw. 4 (1982) 75-76). As the summand of an item depends on its own
parameters only, one change of a parameter in all items gives the derivative of each.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from statejump import _engine
from statejump.core.progress import OnProgress
from statejump.kinds.truss.answers.outputs import Output
from statejump.kinds.truss.answers.parameters import changed, parameters, part_of
from statejump.kinds.truss.body_points import displacements_m, point_names
from statejump.kinds.truss.check_mechanism import check_at_rest
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, engine_items, failing, path_from

# First relative changes of a parameter: the larger one is accurate for smooth functions, the smaller one does not
# leave the contact of stiff surfaces.
STEPS = (1e-3, 1e-5)
LEVELS = 6  # halvings of the change
EXACT = 1e-13  # estimated relative error at which the extrapolation ends
SEARCH = 1e-7  # the same for searches, which do not need more digits


@dataclass(frozen=True)
class Derivative:
    """Derivative of an output by the logarithm of a parameter.

    :param total: of all items together
    :param items: of each item, where the parameter belongs to items of a section
    :param error: estimate of the numerical error of ``total``
    """

    total: float
    items: np.ndarray
    error: float


class Gradient:
    """Derivatives of the jump of an output of a truss.

    :param found: the path
    :param output: the output
    :param jump: its jump over all cycles
    :param solutions: linear systems solved
    :param events: events whose time affects the output
    :param kinks: events at which two joints change at once: derivatives are one-sided there
    """

    def __init__(self, recorded: RecordedPath, output: Output) -> None:
        self.truss, self.found, self.output = recorded.found.truss, recorded.found, output
        self.jump = output.jump(recorded.found)
        self._adjoint = recorded.derivative(_covectors(recorded.found, output))
        self.solutions, self.events, self.kinks = (
            self._adjoint.solutions, self._adjoint.events, self._adjoint.kinks)

    def names(self, section: str) -> Sequence[str]:
        """Return the names of the items of a section."""
        found: Sequence[str] = part_of(self.truss, section).names
        return found

    def by_parameter(self, section: str, key: str, which: np.ndarray | None = None) -> Derivative:
        """Return the derivative of the jump by the logarithm of a parameter of some items of a section, or of all.

        :param which: the items (n,) bool; all that have a value other than 0 if it is missing
        """
        there = _with_value(self.truss, section, key)
        there = there if which is None else there & which

        def at(step: float) -> np.ndarray:
            given = self.summands(changed(self.truss, section, key, np.where(there, 1 + step, 1.0)))
            own = _of_section(given, section)
            return np.append(own, _sum(given))

        found, error = _extrapolated(at)
        return Derivative(float(found[-1]), found[:-1], float(error[-1]))

    def along(self, changed_by: Callable[[float], ResolvedTruss]) -> Derivative:
        """Return the derivative of the jump by a number on which the truss depends.

        :param changed_by: returns the truss after a change of the number; supports and items stay the same
        """
        found, error = _extrapolated(lambda step: np.array([_sum(self.summands(changed_by(step)))]))
        return Derivative(float(found[0]), found[:0], float(error[0]))

    def summands(self, truss: ResolvedTruss) -> dict[str, Any]:
        """Return the Lagrangian of a changed truss, a summand for each item."""
        made: dict[str, Any] = self._adjoint.summands(**engine_items(truss))
        return made


class RecordedPath:
    """The path of a truss, with all of its equilibria.

    :raises EngineFailed: there is no path
    """

    def __init__(self, truss: ResolvedTruss, increments_per_branch: int = 50,
                 on_progress: OnProgress = lambda share: None) -> None:
        check_at_rest(truss)
        with failing(truss):
            self._record = _engine.truss_recorded_path(
                **engine_items(truss), increments_per_branch=increments_per_branch,
                start_friction=truss.start_friction, progress=on_progress)
        self.found: TrussPath = path_from(truss, self._record.path)

    def derivative(self, covectors: np.ndarray) -> Any:
        """Return the adjoint solution for an output; ``covectors`` (cycle ends, nodes, 3) are its derivatives by the
        displacements."""
        with failing(self.found.truss):
            return self._record.derivative(covectors)


def item_derivatives(gradients: Sequence[Gradient], section: str, key: str, accuracy: float = SEARCH) -> np.ndarray:
    """Return the derivatives (outputs, items) of jumps by the logarithm of a parameter of each item of a section.

    :param gradients: of outputs of one path
    :param accuracy: relative error at which the extrapolation ends
    """
    truss = gradients[0].truss
    there = _with_value(truss, section, key)

    def at(step: float) -> np.ndarray:
        other = changed(truss, section, key, np.where(there, 1 + step, 1.0))
        return np.stack([_of_section(one.summands(other), section) for one in gradients])

    return _extrapolated(at, accuracy)[0]


def _with_value(truss: ResolvedTruss, section: str, key: str) -> np.ndarray:
    """Return the items (n,) bool of a section whose parameter has a value other than 0."""
    values = next(values for one, name, values in parameters(truss) if (one, name) == (section, key))
    there: np.ndarray = np.isfinite(values) & (values != 0)
    return there


def _covectors(found: TrussPath, output: Output) -> np.ndarray:
    """Return the derivative of the jump of an output by displacements of nodes and, with points of bodies, by their
    rotations, at the ends of cycles (ends, sites, 3)."""
    ends = found.cycle_ends
    states = [ends["displacement_m"]]
    if point_names(found.truss):
        states.append(ends["rotation_rad"])
    count = states[0].shape[1]
    moved = np.concatenate(states, axis=1)

    def value(sites: np.ndarray) -> float:
        state = {"displacement_m": sites[None, :count], "rotation_rad": sites[None, count:],
                 "time_s": ends["time_s"][:1]}
        return output.value(displacements_m(found.truss, state)[0])

    made = np.zeros_like(moved)
    steps = [np.abs(one).max(initial=0.0) for one in states]
    for end, sign in ((0, -1.0), (len(moved) - 1, 1.0)):
        for place in np.ndindex(*moved.shape[1:]):
            # Temperatures are those of the reference at both ends.
            made[(end, *place)] += sign * _difference(value, moved[end], place, steps[place[0] // count])
    return made


def _difference(value: Callable[[np.ndarray], float], moved: np.ndarray, place: tuple[int, ...], size: float) -> float:
    """Return the derivative of a function of displacements by one of them. Outputs are linear in displacements, to the
    order of displacements over the size of the truss, so one central difference is exact to the square of a tenth of
    that."""
    step = 0.1 * size if size > 0 else 1e-6
    other = moved.copy()
    other[place] += step
    plus = value(other)
    other[place] = moved[place] - step
    return (plus - value(other)) / (2 * step)


def _extrapolated(function: Callable[[float], np.ndarray], accuracy: float = EXACT
                  ) -> tuple[np.ndarray, np.ndarray]:
    """Return the derivatives at 0 of a vector function, and their estimated errors, each from the best step."""
    best: np.ndarray = np.array(0.0)
    error: np.ndarray = np.array(np.inf)
    for first in STEPS:
        found, estimate = _from_step(function, first, accuracy)
        better = estimate < error
        best, error = np.where(better, found, best), np.where(better, estimate, error)
        if (error <= accuracy * np.abs(best).max(initial=0.0)).all():
            break
    return best, error


def _from_step(function: Callable[[float], np.ndarray], step: float, accuracy: float
               ) -> tuple[np.ndarray, np.ndarray]:
    last: list[np.ndarray] = []
    best, error = np.array(0.0), np.array(np.inf)
    for level in range(LEVELS):
        now = [(function(step) - function(-step)) / (2 * step)]
        for order in range(level):
            factor = 4.0 ** (order + 1)
            now.append((factor * now[order] - last[order]) / (factor - 1))
            estimate = np.maximum(np.abs(now[-1] - now[-2]), np.abs(now[-1] - last[order]))
            better = estimate < error
            best, error = np.where(better, now[-1], best), np.where(better, estimate, error)
        if level and (error <= accuracy * np.abs(best).max(initial=0.0)).all():
            break
        last, step = now, 0.5 * step
    return best, error


def _of_section(summands: dict[str, Any], section: str) -> np.ndarray:
    tables = {element.section: element.items for element in ELEMENTS} | {"link": "links"}
    found: np.ndarray = (summands["elements"][tables[section]] if section in tables else summands["joints"][section])
    return found


def _sum(summands: dict[str, Any]) -> float:
    """Return the sum of all summands of a Lagrangian."""
    return float(summands["node"].sum() + sum(part.sum() for part in summands["elements"].values())
                 + sum(part.sum() for part in summands["joints"].values()))
