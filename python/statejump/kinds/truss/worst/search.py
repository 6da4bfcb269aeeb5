# SPDX-License-Identifier: GPL-3.0-or-later
"""Search for the worst history: given histories first, then flips of single corners from the best one and from random
histories, at last random temperatures within the box."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from statejump.core.errors import Interrupted, StatejumpError
from statejump.core.progress import OnProgress
from statejump.kinds.truss.answers.jumps import quick_path
from statejump.kinds.truss.bounds.outputs import Output
from statejump.kinds.truss.solve import TrussPath
from statejump.kinds.truss.worst.histories import Histories

JUMP, PEAK = "residual jump", "peak"
QUANTITIES = (JUMP, PEAK)
INCREMENTS = 10  # per leg, during the search
BETTER = 1e-9  # relative gain that counts
INTERIOR = 0.2  # fraction of the paths for temperatures within the box
CLIMB = 0.4  # largest fraction of the paths of one start


@dataclass
class Best:
    """The worst history found so far for a quantity of an output."""

    value: float = 0.0
    corners_K: np.ndarray | None = None


def excursions(output: Output, path: TrussPath) -> np.ndarray:
    """Return the size of the change of an output since the start, in its unit, along a path."""
    values = output.vector(path.states["displacement_m"])
    return np.asarray(np.linalg.norm(values - values[0], axis=-1))


def jumps(output: Output, path: TrussPath, returns_s: np.ndarray) -> np.ndarray:
    """Return the size of the change of an output since the start at each return to ΔT = 0."""
    at = [int(np.abs(path.states["time_s"] - time).argmin()) for time in returns_s]
    return excursions(output, path)[at]


@dataclass
class Search:
    """A search over histories of a number of cycles.

    :param paths: number of paths that may be solved for each quantity of each output
    :param failed: messages of histories without a path
    """

    histories: Histories
    outputs: Sequence[Output]
    cycles: int
    paths: int
    rng: np.random.Generator
    on_progress: OnProgress
    best: dict[tuple[str, str], Best] = field(default_factory=dict)
    solved: int = 0
    failed: list[str] = field(default_factory=list)

    @property
    def total(self) -> int:
        """Number of paths of the whole search."""
        return self.paths * len(self.outputs) * len(QUANTITIES)

    def run(self, given: Iterable[np.ndarray]) -> None:
        """Search, beginning with given histories (cycles, CORNERS, variables)."""
        self.best = {(output.name, quantity): Best() for output in self.outputs for quantity in QUANTITIES}
        for corners in given:
            if self.solved < self.total // 2:
                self.value(corners, next(iter(self.best)))
        begun, left = self.solved, self.total - self.solved
        for number, target in enumerate(self.best):
            self._improve(target, begun + left * (number + 1) // len(self.best))

    def value(self, corners_K: np.ndarray, target: tuple[str, str]) -> float:
        """Return a quantity of a history; −1: it has no path. The best histories of all quantities are kept."""
        self.solved += 1
        self.on_progress(min(1.0, self.solved / self.total))
        try:
            path = quick_path(self.histories.truss(corners_K), INCREMENTS)
        except Interrupted:
            raise
        except StatejumpError as problem:
            self.failed.append(str(problem))
            return -1.0
        values: dict[tuple[str, str], float] = {}
        for output in self.outputs:
            sizes = jumps(output, path, self.histories.returns_s(len(corners_K)))
            last = int(sizes.argmax())
            values[output.name, JUMP] = self._keep((output.name, JUMP), float(sizes[last]), corners_K[:last + 1])
            peak = float(excursions(output, path).max())
            values[output.name, PEAK] = self._keep((output.name, PEAK), peak, corners_K)
        return values[target]

    def _keep(self, target: tuple[str, str], value: float, corners_K: np.ndarray) -> float:
        best = self.best[target]
        if best.corners_K is None or value > best.value * (1 + BETTER):
            best.value, best.corners_K = value, corners_K.copy()
        return value

    def _improve(self, target: tuple[str, str], until: int) -> None:
        """Solve paths for one quantity until a number of paths is reached."""
        budget = until - self.solved
        interior = until - int(INTERIOR * budget)
        most = max(1, int(CLIMB * budget))
        self._climb(self._best_of(target), target, min(interior, self.solved + most))
        while self.solved < interior:
            self._climb(self._random(), target, min(interior, self.solved + most))
        corners = self._best_of(target)
        value = self.best[target].value
        while self.solved < until:
            tried = corners.copy()
            which = self.rng.random(tried.shape) < max(1.0, 0.1 * tried.size) / tried.size
            tried[which] = self.rng.uniform(self.histories.low_K, self.histories.high_K, int(which.sum()))
            reached = self.value(tried, target)
            if reached > value:
                corners, value = tried, reached

    def _best_of(self, target: tuple[str, str]) -> np.ndarray:
        """Return the best history with the full number of cycles; the first cycle is repeated before it."""
        found = self.best[target].corners_K
        if found is None:
            return self._random()
        more = self.cycles - len(found)
        return np.concatenate((np.repeat(found[:1], more, axis=0), found))

    def _random(self) -> np.ndarray:
        """Return a history whose corners are at the ends of the range."""
        shape = self.cycles, 2, len(self.histories.variables)
        return np.where(self.rng.random(shape) < 0.5, self.histories.low_K, self.histories.high_K)

    def _climb(self, corners: np.ndarray, target: tuple[str, str], until: int) -> None:
        """Move single corners of variables, and whole corners, to the other end of the range while this helps."""
        if self.solved >= until:
            return
        low, high = self.histories.low_K, self.histories.high_K
        value = self.value(corners, target)
        moves = [*np.ndindex(corners.shape), *((*corner, slice(None)) for corner in np.ndindex(corners.shape[:2]))]
        since = 0
        while since < len(moves):
            for number in self.rng.permutation(len(moves)):
                if self.solved >= until or since >= len(moves):
                    return
                tried = corners.copy()
                tried[moves[number]] = np.where(tried[moves[number]] > 0.5 * (low + high), low, high)
                reached = self.value(tried, target)
                since += 1
                if reached > value * (1 + BETTER):
                    corners, value, since = tried, reached, 0
