# SPDX-License-Identifier: GPL-3.0-or-later
"""Rest states within a bounded temperature range: last-slip linear programs, and whether joints settle.

With A = B K⁻¹Bᵀ + diag(1/k_t) the slip of the joints is p = s0 + B K⁻¹G T − A λ. The running maximum of p_i is reached
while joint i slips at λ_i = +f_i. Ranges of p that contain the start and reproduce themselves hold at all times.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import inf, nan
from typing import Any, Protocol

import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.core.start import FRICTIONLESS
from statejump.kinds.truss.bounds.outputs import Linear
from statejump.kinds.truss.bounds.programs import Polytope
from statejump.kinds.truss.bounds.sliding import Sliding
from statejump.kinds.truss.joints import JOINTS

MOST_JOINTS = 100  # of linear programs
ROUNDS = 25
WIDER = 1.02  # growth of ranges that do not yet reproduce themselves
MOST_NARROWED, NARROWED = 5, 1e-3  # rounds that narrow ranges, and the smallest gain of a round
NEAR = 1e-7  # smallest half range over the slide that friction of the joint itself permits
SINGULAR = 1e-12
WAYS = 16  # directions of a half-circle in which the width of an output with two components is bounded


class Heated(Linear, Protocol):
    """A truss with loads by temperature."""

    @property
    def heating_N_per_K(self) -> Any:
        """G (dofs, elements)."""


@dataclass(frozen=True)
class Temperatures:
    """Independent temperature variables T, each in an interval that contains 0.

    :param of_elements: ΔT of elements (elements, variables) over T, in units of their programs
    """

    text: str
    of_elements: np.ndarray
    lowest_K: np.ndarray
    highest_K: np.ndarray

    @staticmethod
    def of_programs(of: Heated) -> Temperatures:
        """Return the programs of the case, each within its own range."""
        ranges = of.truss.temperature_ranges_K
        numbers, _ = _programs(of)
        made = np.zeros((len(numbers), len(ranges)))
        made[np.flatnonzero(numbers >= 0), numbers[numbers >= 0]] = 1.0
        low, high = np.minimum(ranges[:, 0], 0.0), np.maximum(ranges[:, 1], 0.0)
        return Temperatures(f"programs of the case, {low.min():g} to {high.max():g} K", made, low, high)

    @staticmethod
    def of_box(of: Heated, box: tuple[float, float]) -> Temperatures:
        """Return all elements that expand, each by itself within a range."""
        numbers, fractions = _programs(of)
        which = np.flatnonzero((np.diff(of.heating_N_per_K.indptr) > 0) & (fractions != 0))
        made = np.zeros((len(numbers), len(which)))
        made[which, np.arange(len(which))] = 1 / fractions[which]
        return Temperatures(f"every member between {box[0]:g} and {box[1]:g} K by itself", made,
                            np.full(len(which), box[0]), np.full(len(which), box[1]))

    def scaled(self, factor: float) -> Temperatures:
        """Return the variables in intervals that are wider by a factor."""
        return replace(self, lowest_K=factor * self.lowest_K, highest_K=factor * self.highest_K)

    def peak(self, gain: np.ndarray) -> tuple[float, float]:
        """Return the lowest and the highest value of gain (1, elements) · ΔT; of a vector, 0 and its norm."""
        if len(gain) > 1:
            most = np.maximum(np.abs(self.lowest_K), np.abs(self.highest_K))
            return 0.0, float(np.linalg.norm(gain @ self.of_elements, axis=0) @ most)
        by_variable = gain[0] @ self.of_elements
        ends = np.sort(np.array([by_variable * self.lowest_K, by_variable * self.highest_K]), axis=0)
        return float(ends[0].sum()), float(ends[1].sum())


def _programs(of: Heated) -> tuple[np.ndarray, np.ndarray]:
    """Return the program (-1: none) and the fraction of its ΔT of every element."""
    truss, count = of.truss, of.heating_N_per_K.shape[1]
    numbers, fractions = np.full(count, -1), np.ones(count)
    beams, bodies = truss.elements["beam"], truss.elements["body"]
    of_bodies = count - len(bodies.names)
    for index, (name, programs) in enumerate(zip(bodies.names, bodies.programs)):
        if len(set(programs.tolist())) > 1:
            raise StatejumpError(code="bounds_body", part=f"body {name!r}")
        numbers[of_bodies + index] = programs[0] if len(programs) else -1
    for start, part in ((0, truss.links), (of_bodies - len(beams.names), beams)):
        rows = slice(start, start + len(part.names))
        numbers[rows], fractions[rows] = part.program, part.temperature_fraction
    return numbers, fractions


def parsed_range(given: str | tuple[float, float]) -> tuple[float, float]:
    """Return a temperature range ``LOWEST:HIGHEST`` as two numbers [K].

    :raises NotAllowed: it is not a range that contains 0
    """
    try:
        low, high = map(float, given.split(":")) if isinstance(given, str) else given
    except ValueError:
        raise NotAllowed("range", given, code="bounds_bad_range") from None
    if not -inf < low <= 0 <= high < inf or low == high:
        raise NotAllowed("range", given, code="bounds_bad_range")
    return low, high


@dataclass(frozen=True)
class Verdict:
    """Whether joints slip within a temperature range.

    :param kind: "never_slips", "settles", "repeats", "bounded" (never ratchets), "may_ratchet" or "unknown"
    :param factor: η, the factor on the range up to which joints settle
    :param limiting: joint that limits η
    :param slips: of every joint, whether it may slip; None: unknown
    :param mechanism: motion that may ratchet
    :param drift_m: its drift per cycle of the case, simulated; NaN: not simulated
    :param certified: whether it is proved for the linear truss; an estimate otherwise
    """

    kind: str
    text: str
    factor: float = nan
    limiting: str = ""
    slips: np.ndarray | None = None
    mechanism: str = ""
    drift_m: float = nan
    certified: bool = True

    def record(self) -> dict[str, Any]:
        """Return the verdict as plain values."""
        return {"kind": self.kind, "certified": self.certified and self.kind != "unknown", "text": self.text,
                "limiting_joint": self.limiting,
                "factor": self.factor if np.isfinite(self.factor) else None, "mechanism": self.mechanism,
                "drift_m": None if np.isnan(self.drift_m) else self.drift_m,
                "slips": None if self.slips is None else [bool(one) for one in self.slips]}


@dataclass(frozen=True)
class WithinRange:
    """Rest states within a temperature range.

    :param start_N: friction at the start of the case; None: the joints slip there, or statics does not determine it
    """

    of: Sliding
    verdict: Verdict
    start_N: np.ndarray | None = None
    rest: Polytope | None = None  # λ/f of joints with friction
    rubbing: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))

    def extent(self, gains: np.ndarray, most: float) -> tuple[float, float]:
        """Return the spread of the output −gains λ within the range, and the largest jump from the start.

        :param gains: (m, joints)
        :param most: spread after any history
        """
        if self.rest is None or self.start_N is None:
            return nan, nan
        if self.verdict.kind == "never_slips":
            return 0.0, 0.0
        directions, factor = ways(gains * self.of.limit_N)
        found = np.array([self._width(way @ gains) for way in directions])
        if factor:
            spread, jump = factor * found.max(axis=0)
        else:
            spread, jump = np.linalg.norm(found, axis=0)
        return min(float(spread), most), min(float(jump), most)

    def _width(self, gain: np.ndarray) -> tuple[float, float]:
        assert self.rest is not None and self.start_N is not None
        cost = -(gain * self.of.limit_N)[self.rubbing]
        start = -float(gain @ self.start_N)
        high, low = self.rest.highest_value(cost), -self.rest.highest_value(-cost)
        return high - low, max(high - start, start - low)


def ways(columns: np.ndarray) -> tuple[np.ndarray, float]:
    """Return directions (k, m) whose widths bound the diameter of a set in the span of columns (m, n).

    The second result is the factor on the largest width; 0: the widths are those of a box.
    """
    left, size, _ = np.linalg.svd(columns, full_matrices=False)
    rank = max(1, int((size > SINGULAR * size.max(initial=0.0)).sum()))
    if rank != 2:
        return left[:, :rank].T, 1.0 if rank == 1 else 0.0
    angle = np.pi * np.arange(WAYS) / WAYS
    return np.stack((np.cos(angle), np.sin(angle)), axis=1) @ left[:, :2].T, 1 / np.cos(0.5 * np.pi / WAYS)


def within(of: Sliding, temperatures: Temperatures) -> WithinRange:
    """Return the rest states within a temperature range, and whether joints settle."""
    rubbing = np.flatnonzero(of.limit_N > 0)
    limit = of.limit_N[rubbing]
    in_part = {joint.section for joint in JOINTS if joint.slips_in_part}
    smooth = [str(of.joints[index]) for index in rubbing
              if of.joints[index].section in in_part or of.truss.sticking == "partial_slip"]
    if np.any(of.truss.sliders.play_m > 0):
        return WithinRange(of, Verdict("unknown", "no verdict is derived for plays of sliders"))
    if len(rubbing) > MOST_JOINTS:
        return WithinRange(of, Verdict("unknown", f"not computed for more than {MOST_JOINTS} joints with friction"))
    flexible = of.compliance[np.ix_(rubbing, rubbing)] + np.diag(1 / of.sticking_N_per_m[rubbing])
    if np.linalg.eigvalsh(flexible)[0] <= SINGULAR * np.trace(flexible):
        return WithinRange(of, Verdict("unknown", "statics does not determine how sticking joints share their force"))
    slide = of.slide_m[rubbing]
    begins = slide if of.truss.start_friction == FRICTIONLESS else np.zeros(len(rubbing))
    start = np.linalg.solve(flexible, slide - begins)
    if np.any(np.abs(start) > limit * (1 + 1e-9)):
        return WithinRange(of, Verdict("unknown", "joints slip under the loads of the start"))
    friction = np.zeros(len(of.limit_N))
    friction[rubbing] = start
    heating = of.slides[rubbing] @ of.solve(of.heating_N_per_K @ temperatures.of_elements)
    if smooth:
        text = f"repeats: {smooth[0]} slips partially in every cycle, the shape repeats"
        return WithinRange(of, Verdict("repeats", text), friction)
    problem = _LastSlip(flexible, heating, slide, begins, limit, temperatures)
    low, high = problem.ranges(start)
    slips = np.zeros(len(of.limit_N), dtype=bool)
    slips[rubbing] = problem.slips(low, high)
    verdict = _verdict(of, rubbing, problem, start, slips)
    rest = Polytope(-flexible * limit, low - slide, high - slide, -np.ones(len(limit)), np.ones(len(limit)))
    return WithinRange(of, verdict, friction, rest, rubbing)


def _verdict(of: Sliding, rubbing: np.ndarray, problem: _LastSlip, start: np.ndarray, slips: np.ndarray) -> Verdict:
    stuck = problem.stuck()
    size = np.abs(stuck) @ (problem.temperatures.highest_K - problem.temperatures.lowest_K)
    factors = np.divide(2 * problem.limit, size, out=np.full(len(size), inf), where=size > 0)
    worst = int(factors.argmin())
    factor, limiting = float(factors[worst]), str(of.joints[rubbing[worst]])
    said = f"factor {factor:.4g} to the limit, set by {limiting}"
    if problem.holds(start):
        return Verdict("never_slips", f"never slips, the jump is zero; {said}", factor, limiting, np.zeros_like(slips))
    if factor >= 1:
        return Verdict("settles", f"settles: in the end no joint slips; {said}", factor, limiting, slips)
    return Verdict("repeats", f"repeats: joints rub in every cycle, the shape repeats; {said}", factor, limiting, slips)


Slipped = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def ranges_that_hold(slipped: Slipped, begins: np.ndarray, near: np.ndarray, start_holds: bool
                     ) -> tuple[np.ndarray, np.ndarray]:
    """Return ranges of the slips p that hold at all times, however long the history.

    :param slipped: bounds of p that joints reach while they slip, if all p are within given ranges
    :param begins: p at the start; ``near``: smallest half ranges
    :param start_holds: whether no joint slips
    """
    low, high = begins - near, begins + near
    if start_holds:
        return low, high
    for _ in range(ROUNDS):
        lower, higher = slipped(low, high)
        if np.all(lower >= low) and np.all(higher <= high):
            return _narrowed(slipped, near, low, high)
        low = np.where(lower < low, begins + WIDER * (lower - begins) - near, low)
        high = np.where(higher > high, begins + WIDER * (higher - begins) + near, high)
    return _narrowed(slipped, near, np.full(len(near), -inf), np.full(len(near), inf))


def _narrowed(slipped: Slipped, near: np.ndarray, low: np.ndarray, high: np.ndarray
              ) -> tuple[np.ndarray, np.ndarray]:
    """Return narrower ranges, given ranges that hold at all times."""
    for _ in range(MOST_NARROWED):
        lower, higher = slipped(low, high)
        narrower = np.maximum(low, lower - near), np.minimum(high, higher + near)
        before = high - low
        low, high = narrower
        if np.all(before - (high - low) <= NARROWED * (high - low)):
            break
    return low, high


@dataclass(frozen=True)
class _LastSlip:
    """The last-slip programs. Variables: λ/f, then T over its largest magnitude."""

    flexible: np.ndarray
    heating: np.ndarray  # slides by T (joints, variables)
    slide: np.ndarray
    begins: np.ndarray  # p at the start
    limit: np.ndarray
    temperatures: Temperatures

    def stuck(self) -> np.ndarray:
        """Return the change of the friction of stuck joints by T (joints, variables)."""
        return np.linalg.solve(self.flexible, self.heating)

    def holds(self, start: np.ndarray) -> bool:
        """Whether no joint slips from the start at any temperature."""
        stuck = self.stuck()
        ends = np.sort(np.array([stuck * self.temperatures.lowest_K, stuck * self.temperatures.highest_K]), axis=0)
        low, high = ends.sum(axis=2) + start
        return bool(np.all(high <= self.limit) and np.all(low >= -self.limit))

    def slips(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return which joints may slip."""
        return np.asarray(np.maximum(high - self.begins, self.begins - low) > 2 * self._near())

    def _near(self) -> np.ndarray:
        return np.asarray(NEAR * np.diag(self.flexible) * self.limit)

    def ranges(self, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return ranges of the slips p that hold at all times, however long the history."""
        return ranges_that_hold(self._slipped, self.begins, self._near(), self.holds(start))

    def _slipped(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return bounds of p that joints reach while they slip, if all p are within ranges."""
        found = [self.begins.copy(), self.begins.copy()]
        for joint in range(len(self.limit)):
            for side, sign in enumerate((-1.0, 1.0)):
                reached = self._last(joint, sign, low, high)
                found[side][joint] += sign * max(0.0, reached - sign * self.begins[joint])
        return found[0], found[1]

    def _last(self, joint: int, sign: float, low: np.ndarray, high: np.ndarray) -> float:
        """Return the bound of sign · p of a joint while it slips with this sign; −inf: it cannot slip."""
        count = len(self.limit)
        size = np.maximum(np.maximum(-self.temperatures.lowest_K, self.temperatures.highest_K), 1e-300)
        rows = np.concatenate((-self.flexible * self.limit, self.heating * size), axis=1)
        lowest = np.concatenate((-np.ones(count), self.temperatures.lowest_K / size))
        highest = np.concatenate((np.ones(count), self.temperatures.highest_K / size))
        friction = np.zeros(len(lowest))
        friction[joint] = sign
        polytope = Polytope(rows, low - self.slide, high - self.slide, lowest, highest)
        if polytope.highest_value(friction) < 1 - 1e-9:
            return -inf
        lowest, highest = lowest.copy(), highest.copy()
        lowest[joint] = highest[joint] = sign
        least, most = low - self.slide, high - self.slide
        (most if sign > 0 else least)[joint] = sign * inf  # the range that is sought
        polytope = Polytope(rows, least, most, lowest, highest)
        return polytope.highest_value(sign * rows[joint]) + sign * float(self.slide[joint])
