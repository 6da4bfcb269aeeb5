# SPDX-License-Identifier: GPL-3.0-or-later
"""Search for the change of a truss at which the jump of a node reaches a bound.

The path of every changed truss is solved; the search assumes nothing about the jump. It scans values, locates every
crossing of the bound between scanned values, and reports whether the scanned jumps are monotone.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from math import copysign, exp, log
from typing import Any

import numpy as np
from scipy.optimize import brentq

from statejump.control.study import Row, Sweep, bisect, ranges_that_pass
from statejump.core.errors import Interrupted, StatejumpError
from statejump.core.progress import OnProgress, counted
from statejump.kinds.truss.answers.jumps import node_jumps, quick_path
from statejump.kinds.truss.answers.outputs import node_output
from statejump.kinds.truss.answers.sensitivity import differences, histories_of
from statejump.kinds.truss.control.candidates import Candidate
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath

NARROW = 1e-9  # relative accuracy of a value; events are located within 1e-9 of a branch
LEAP = 1e-6  # fraction of the wanted jump: a jump that is lower by more at the value found is discontinuous there
ROUNDING = 1e-9  # fraction of the largest jump: smaller reversals of the curve are rounding


@dataclass(frozen=True)
class Jump:
    """Jump of a node, with the path that gives the sequence of statuses of every joint."""

    size_m: float
    path: TrussPath

    @property
    def histories(self) -> dict[tuple[str, str], list[str]]:
        """Sequences of statuses by kind and name of a joint."""
        return histories_of(self.path)


def jump_of(truss: ResolvedTruss, node: int, increments: int) -> Jump:
    """Solve a truss; return the jump of a node over all cycles. :raises FailedRun: the truss has no path"""
    found = quick_path(truss, increments, cycle_ends_only=True)
    return Jump(float(np.linalg.norm(node_jumps(found)[-1, node])), found)


@dataclass
class Search:
    """One candidate: a scan of its values, and the search for the limit.

    :param value: the smallest change that keeps the jump at or below the bound; None if no scanned value does
    """

    candidate: Candidate
    sweep: Sweep
    node: int
    increments: int
    value: float | None = None
    found: dict[str, Any] = field(default_factory=dict)  # results about the value, by name
    sentence: str = ""
    turns: list[float] = field(default_factory=list)  # values at which the jump reverses its slope along the scan
    ways: set[str] = field(default_factory=set)  # methods that found the ends of ranges

    def jump(self, value: float) -> Jump:
        """Return the jump with a value."""
        return jump_of(self.candidate.truss(value), self.node, self.increments)

    def row(self, value: float) -> Row:
        """Return the row with the jump for a value; it has no jump if the truss has no path."""
        try:
            return Row(value, {"jump_m": self.jump(value).size_m})
        except Interrupted:
            raise
        except StatejumpError as problem:
            return Row(value, {}, str(problem))

    def scan(self, on_progress: OnProgress) -> None:
        """Solve the truss for all values of the candidate, and find where the jump is not monotone."""
        done = counted(on_progress, len(self.candidate.values))
        for value in self.candidate.values:
            self.sweep.rows.append(self.row(value))
            done()
        jumps = self.sweep.column("jump_m")
        there = np.flatnonzero(np.isfinite(jumps))
        steps = np.diff(jumps[there])
        real = np.flatnonzero(np.abs(steps) > ROUNDING * np.max(jumps[there], initial=0.0))
        turning = [place for place, next_one in zip(real, real[1:]) if steps[place] * steps[next_one] < 0]
        self.turns = [self.candidate.values[there[place + 1]] for place in turning]

    def narrow(self, wanted: float) -> None:
        """Find all ranges of values with jumps of at most ``wanted``, and the smallest change in these ranges."""
        jumps, values = self.sweep.column("jump_m"), self.candidate.values
        self.sweep.meets = ranges_that_pass(values, list(jumps <= wanted),
                                            narrow=lambda bad, good: self._end(bad, good, wanted))
        ends = [self._nearest(low, high) for low, high in self.sweep.meets]
        if ends:
            self.value = self.sweep.recommended = min(ends, key=self.candidate.size)

    def _nearest(self, low: float, high: float) -> float:
        """Return the value within a range that changes the truss least."""
        return min(max(low, self.candidate.own), high)

    def _end(self, bad: float, good: float, wanted: float) -> float:
        """Return the value at which the jump crosses ``wanted`` between ``bad`` and ``good``, on the side of the
        smaller jump."""
        def excess(exponent: float) -> float:
            return self.jump(exp(exponent)).size_m - wanted

        def passes(value: float) -> bool:
            size = self.row(value).results.get("jump_m")
            return size is not None and size <= wanted

        if bad > 0 and good > 0:
            try:
                root = float(brentq(excess, log(bad), log(good), xtol=NARROW, rtol=NARROW))
                step = copysign(NARROW, good - bad)
                for times in (0, 1, 2, 4, 8):
                    value = exp(root + times * step)
                    if passes(value):
                        self.ways.add("Brent's method")
                        return value
            except Interrupted:
                raise
            except (StatejumpError, ValueError):
                pass  # a truss has no path, or an end was not solved: bisection needs signs only
        self.ways.add("bisection")
        return bisect(passes, bad, good, NARROW)[1]

    def tell_value(self, now: Jump, wanted: float, node: str) -> None:
        """Solve the truss with the resulting value, also with twice the increments; check the differentiability."""
        assert self.value is not None
        candidate, with_it = self.candidate, self.jump(self.value)
        finer = jump_of(candidate.truss(self.value), self.node, 2 * self.increments)
        self.sweep.insert(Row(self.value, {"jump_m": with_it.size_m}))
        self.found = {
            "parameter": candidate.parameter, "value": self.value, "unit": candidate.unit,
            "jump_with_it_m": with_it.size_m, "jump_with_twice_the_increments_m": finer.size_m,
            "found_by": " and ".join(sorted(self.ways)) if self.ways else "none needed",
            "leaps": bool(self.ways) and with_it.size_m < (1 - LEAP) * wanted,
            "joints_go_as_in_the_case": with_it.histories == now.histories,
            "monotone": not self.turns,
        }
        if self.value == candidate.own:
            return
        changed = candidate.truss(self.value)
        output = node_output(with_it.path, node)
        try:
            slope, _, verdict = differences(changed, candidate.section, candidate.key, candidate.which(changed), output,
                                            output.jump(with_it.path))
            self.found |= {"elasticity": slope / with_it.size_m if with_it.size_m else None, "verdict": verdict}
        except Interrupted:
            raise
        except StatejumpError as problem:
            self.found |= {"elasticity": None, "verdict": f"failed: {problem}"}
