# SPDX-License-Identifier: GPL-3.0-or-later
"""A local frictional contact problem, its merit and its solution."""
from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from statejump import _engine
from statejump.core.engine_failures import engine
from statejump.core.errors import StatejumpError

if TYPE_CHECKING:
    import scipy.sparse

Vector = NDArray[np.float64]

METHODS: tuple[str, ...] = _engine.FRICTION_METHODS


class NotSolved(StatejumpError):
    """No method reached the tolerance, although a solution may exist.

    :param solution: the best result that was found
    """

    exit_status = 1
    kind = "not_solved"

    def __init__(self, solution: Solution, tolerance: float, **more: Any) -> None:
        super().__init__(code="not_solved", merit=solution.merit.largest, effort=solution.effort, tolerance=tolerance,
                         **more)
        self.solution = solution


@dataclass(frozen=True)
class Merit:
    """Errors of reactions as a solution of a problem. Both are 0 for an exact solution.

    :param natural_map: norm of r - P_K(r - û), divided by the largest of |q|, |r| and |u|, in the problem's units
    :param scaled: norm of r - P_K(r - û) over |q|, with W divided by its mean diagonal and r multiplied by it
    """

    natural_map: float
    scaled: float

    @property
    def largest(self) -> float:
        """What a tolerance is compared with."""
        return max(self.natural_map, self.scaled)


@dataclass(frozen=True, eq=False)
class Stored:
    """Reactions stored in a file.

    :param name: path of the reactions in the file, for example ``solution`` or ``guesses/1``
    :param reactions: one number for each row of W
    """

    name: str
    reactions: Vector


@runtime_checkable
class _Sparse(Protocol):
    """A sparse matrix, recognised without importing SciPy, which a dense problem does not load."""

    def tocsc(self) -> Any: ...


@dataclass(frozen=True, eq=False)
class Problem:
    """A frictional contact problem u = W r + q with Coulomb's law. Each contact is a block, its normal component first.

    The caller chooses the units: r may be forces or impulses; u may be velocities, displacements or gap rates.

    :param delassus: W, a square array or a sparse matrix of scipy, with (contacts x dimension) rows
    :param q: velocities u for zero reactions
    :param mu: friction coefficient of each contact [-]
    :param dimension: number of components per contact, 2 or 3
    :param stored: solutions and guesses that the file of the problem contains
    :raises StatejumpError: sizes do not match, a number is not finite, or mu < 0
    """

    delassus: NDArray[np.float64] | scipy.sparse.spmatrix
    q: Vector
    mu: Vector
    dimension: int = 3
    title: str = ""
    description: str = ""
    stored: tuple[Stored, ...] = ()
    _problem: _engine.FrictionProblem = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("q", "mu"):
            values = np.asarray(getattr(self, name), dtype=float)
            if values.ndim != 1:
                raise StatejumpError(code="problem_no_list", name=name, shape=values.shape)
            object.__setattr__(self, name, values)
        with engine():
            object.__setattr__(self, "_problem", self._made())

    def _made(self) -> _engine.FrictionProblem:
        if not isinstance(self.delassus, _Sparse):
            dense = np.asarray(self.delassus, dtype=float)
            if dense.ndim != 2:
                raise StatejumpError(code="problem_not_square", shape=dense.shape)
            return _engine.FrictionProblem(self.dimension, dense, self.q, self.mu)
        columns = self.delassus.tocsc()
        if columns.shape != (self.q.size, self.q.size):
            raise StatejumpError(code="problem_shape", shape=columns.shape, entries=self.q.size)
        return _engine.FrictionProblem.of_columns(
            self.dimension, columns.indptr, columns.indices, columns.data.astype(float), self.q, self.mu
        )

    @property
    def contacts(self) -> int:
        """Number of contacts."""
        return int(self.mu.size)

    def velocities(self, reactions: ArrayLike) -> Vector:
        """Return u = W r + q."""
        with engine():
            return self._problem.velocities(reactions)


@dataclass(frozen=True, eq=False)
class Solution:
    """Result of :func:`solve`.

    :param reactions: the best reactions r that were found
    :param velocities: the velocities u = W r + q
    :param solved: whether the merit is within the tolerance
    :param method: the method that found the reactions
    :param iterations: number of Gauss-Seidel sweeps, linear systems (Newton, interior point) or Lemke pivots
    :param seconds: wall time [s]
    """

    reactions: Vector
    velocities: Vector
    merit: Merit
    solved: bool
    method: str
    iterations: Mapping[str, int]
    seconds: float

    @property
    def effort(self) -> str:
        """The iterations in words."""
        words = {"gauss_seidel": "sweeps", "newton": "Newton systems", "interior_point": "interior-point systems",
                 "pivots": "pivots"}
        return ", ".join(f"{self.iterations[name]} {text}" for name, text in words.items() if self.iterations[name]) \
            or "no iteration"


def merit(problem: Problem, reactions: ArrayLike) -> Merit:
    """Return the merit of given reactions as a solution of the problem.

    :raises StatejumpError: W has another number of rows
    """
    with engine():
        return Merit(**problem._problem.merit(reactions))


def solve(
    problem: Problem, *, tolerance: float = 1e-10, method: str = "automatic", most_sweeps: int = 5000,
    guess: ArrayLike | None = None, strict: bool = False, progress: Callable[[float], None] | None = None,
) -> Solution:
    """Solve a problem.

    :param tolerance: largest allowed value of both merits
    :param method: one of METHODS; ``automatic`` tries them in turn
    :param most_sweeps: largest number of Gauss-Seidel sweeps
    :param guess: initial reactions
    :param strict: whether to raise an error without solution, instead of returning ``solved`` = false
    :param progress: called at intervals with the best merit so far
    :raises NotSolved: no method reached the tolerance, and ``strict`` is true
    :raises StatejumpError: an argument is out of its range
    """
    start = time.perf_counter()
    with engine():
        found = problem._problem.solve(tolerance=tolerance, method=method, most_sweeps=most_sweeps, guess=guess,
                                       progress=progress)
    solution = Solution(
        reactions=found["reactions"], velocities=found["velocities"],
        merit=Merit(natural_map=found["natural_map"], scaled=found["scaled"]), solved=found["status"] == "solved",
        method=found["method"], iterations=found["iterations"], seconds=time.perf_counter() - start,
    )
    if strict and not solution.solved:
        raise NotSolved(solution, tolerance)
    return solution
