# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the state jump of a rib whose joint moves freely in its clearance: statistics of an ensemble."""
from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from math import acos, floor, lgamma, log, log10
from typing import Any

import numpy as np

from statejump.control.study import Line, Row, Study, Sweep, bisect, grid, number, ranges_that_pass
from statejump.core.errors import StatejumpError
from statejump.core.progress import OnProgress
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.schema.paths import with_values
from studies.paper import ensembles
from studies.rib_control.parameters import AREA, CLEARANCE, DAMPING, FRICTION, SPRING, changes

QUANTILE = 0.95
CONFIDENCE = 0.95
BISECTIONS = 5  # finer than the scatter of a quantile
CHECK = 5  # factor on the number of runs with which a spring is checked, from other initial states

ENSEMBLE_RESULTS = {
    "jump_mean_rad": "mean |jump| [mrad]",
    "jump_quantile_rad": "95 % |jump| [mrad]",
    "deflection_mean_rad": "mean largest |deflection| [mrad]",
    "deflection_quantile_rad": "95 % largest |deflection| [mrad]",
}

LINES: dict[str, Line] = {
    "deflection_quantile_rad": (
        "largest |deflection|, 95 %", dict(color="#E69F00", linewidth=2.6, marker="o", markersize=4)
    ),
    "deflection_mean_rad": (
        "largest |deflection|, mean", dict(color="#E69F00", linewidth=1.2, linestyle=(0, (5, 2)))
    ),
    "jump_quantile_rad": ("|jump|, 95 %", dict(color="#0072B2", linewidth=2.2, marker="s", markersize=4)),
    "jump_mean_rad": ("|jump|, mean", dict(color="#0072B2", linewidth=1.2, linestyle=(0, (5, 2)))),
}


def quantile(values: np.ndarray) -> float:
    """Return the 95 % quantile: the smallest value that at least 95 % of the values do not exceed."""
    return float(np.quantile(np.abs(values), QUANTILE, method="higher"))


def upper_bound(values: np.ndarray) -> float:
    """Return an upper bound of the 95 % quantile with 95 % confidence, for any distribution.

    The bound is the r-th of n sorted values. r is the smallest number for which at most r − 1 of n values are below the
    quantile with a probability of 95 %. For n < 59 the bound is the largest value.
    """
    count = len(values)
    logarithms = [
        lgamma(count + 1) - lgamma(k + 1) - lgamma(count - k + 1) + k * log(QUANTILE) + (count - k) * log(1 - QUANTILE)
        for k in range(count)
    ]
    rank = int(np.searchsorted(np.cumsum(np.exp(logarithms)), CONFIDENCE))
    return float(np.sort(np.abs(values))[min(rank, count - 1)])


def ensemble_measure(
    case: UmbrellaCase, runs: int, progress: Callable[[], None] = lambda: None
) -> dict[str, float]:
    """Return mean, 95 % quantile and its upper bound, for |jump| and for the largest |deflection| of θ2 [rad].

    The initial states depend only on the seed of the case, so the result is reproducible.
    """
    together = ensembles.ensemble(case, runs, progress)
    jump, deflection = np.abs(together.jump_rad), np.max(np.abs(together.deflection_rad), axis=1)
    return {
        "jump_mean_rad": float(np.mean(jump)),
        "jump_quantile_rad": quantile(jump),
        "jump_largest_rad": float(jump.max()),
        "jump_largest_run": float(jump.argmax() + 1),
        "deflection_mean_rad": float(np.mean(deflection)),
        "deflection_quantile_rad": quantile(deflection),
        "jump_bound_rad": upper_bound(jump),
        "deflection_bound_rad": upper_bound(deflection),
    }


def static_deflection_rad(case: UmbrellaCase) -> float:
    """Return the largest static |θ2 − θ2(0)| [rad] under the torsion spring, for rigid links and contact on AC.

    The links form a triangle whose base differs from |AC| by the clearance c. The base is |AC| + c if the free flare
    angle needs a longer one, |AC| − c if it needs a shorter one.
    """
    largest, frame = 0.0, case.frame.length_m
    for change in case.temperature_range_K:
        ab, bc = (
            link.stress_free_length_m * (1 + link.thermal_expansion_per_K * change)
            for link in (case.link_ab, case.link_bc)
        )
        play = case.clearance_m(change)
        free = np.sqrt(ab**2 + bc**2 - 2 * ab * bc * np.cos(case.free_flare_angle_rad))
        base = min(max(free, frame - play), frame + play)
        angle = acos((base**2 + ab**2 - bc**2) / (2 * base * ab))
        largest = max(largest, abs(angle - case.theta2_rad))
    return largest


class _Ensembles:
    """Ensemble measures of changed cases. Each is computed once, with progress."""

    def __init__(self, case: UmbrellaCase, runs: int, on_progress: OnProgress) -> None:
        self.case, self.runs = case, runs
        self.known: dict[tuple[Any, ...], dict[str, float]] = {}
        self.expected, self.done, self.on_progress = 1, 0, on_progress

    def check(self, values: dict[str, Any]) -> dict[str, float]:
        """Return the statistics of a larger ensemble from other initial states. :raises StatejumpError: a run failed"""
        return self({**values, "ensemble.seed": self.case.ensemble.seed + 1}, CHECK * self.runs)

    def __call__(self, values: dict[str, Any], runs: int | None = None) -> dict[str, float]:
        """:raises StatejumpError: a run failed"""
        runs = runs or self.runs
        # A change to the value of the case is no change, so the case is run once.
        real = {
            path: value for path, value in values.items()
            if self.case[path] != value
        }
        key = (runs, *sorted(real.items()))
        if key not in self.known:
            self.known[key] = ensemble_measure(with_values(self.case, real), runs, self._step)
        return self.known[key]

    def _step(self) -> None:
        self.done += 1
        self.on_progress(min(1.0, self.done / (self.expected * self.runs)))


def _ensemble_plan(case: UmbrellaCase) -> list[tuple[Any, ...]]:
    joint, area = case.joint, case.link_ab.cross_section_area_m2
    friction, clearance = joint.friction_coefficient, joint.radial_clearance_m
    # A link rotated against its own axial stiffness gives the largest torsion stiffness of the rib.
    decade = floor(log10(case.link_ab.young_modulus_Pa * area * case.link_ab.stress_free_length_m))
    stiffness, damping = case.torsion_spring.stiffness_N_m_per_rad, case.damping.axial_damping_ratio
    springs = sorted({0.0, stiffness, *(10.0 ** (decade - 6 + half / 2) for half in range(11))})
    frictions = sorted({0.0, friction, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0})
    dampings = sorted({0.0, damping, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3})
    least = max(clearance / 10, case.ensemble.start_spread_m, case.start.eccentricity_m)
    return [
        (FRICTION, "Friction coefficient μ", "-", 1.0, friction, frictions, "linear"),
        (SPRING, "Torsion spring K_M", "N m/rad", 1.0, stiffness, springs, "log"),
        (AREA, "Section of AB, BC with it; E acts alike", "mm²", 1e6, area,
         grid(area, area / 10, 10 * area, 9), "log"),
        (CLEARANCE, "Radial clearance c", "mm", 1e3, clearance,
         grid(clearance, least, 4 * clearance, 9), "log"),
        (DAMPING, "Axial damping ratio ζ", "-", 1.0, damping, dampings, "log"),
    ]


def _jump_quantile_rad(row: Row) -> float:
    """Return the 95 % quantile of |jump| in a row of a scan, infinite for a failed row."""
    found = row.results.get("jump_quantile_rad")
    return np.inf if found is None else found


def study(
    case: UmbrellaCase, wanted: float | None, runs: int, with_dem: bool, on_progress: OnProgress
) -> Study:
    """Study a joint that moves freely in its clearance."""
    plan = _ensemble_plan(case)
    measured = _Ensembles(case, runs, (lambda part: on_progress(0.7 * part)) if with_dem else on_progress)
    # Estimate, because the number of checked springs is known only at the end.
    measured.expected = sum(len(entry[5]) - 1 for entry in plan) + 1 + (10 + BISECTIONS) * CHECK
    now = measured({})
    if wanted is None and now["jump_quantile_rad"] > 0:
        wanted = now["jump_quantile_rad"] / 2
    result = Study(
        "no biased spring loads the joint from the start, so one run means nothing: statistics of "
        f"{runs} runs of the reduced dynamics from starts within {case.ensemble.start_spread_m:g} m "
        f"(seed {case.ensemble.seed}); jump and largest deflection are those of theta2, the 95 % "
        "quantile is a value that occurred",
        "rad", "mrad", 1e3, ENSEMBLE_RESULTS, now["jump_quantile_rad"], wanted, "|θ2 − θ2(0)| [mrad]", LINES,
    )
    result.floor = (SPRING, "static deflection, rigid links", static_deflection_rad(case))
    for key, label, unit, scale, own, values, axis in plan:
        rows = []
        for value in values:
            try:
                rows.append(Row(value, dict(measured(changes(case, key, value)))))
            except StatejumpError as problem:
                rows.append(Row(value, {}, str(problem)))
        result.sweeps.append(Sweep(key, label, unit, scale, own, rows, axis))
    if wanted is None:
        result.sentences.append("The case has no jump: there is nothing to control.")
    else:
        for sweep in result.sweeps:
            sweep.meets = ranges_that_pass(
                [row.value for row in sweep.rows],
                [_jump_quantile_rad(row) <= wanted for row in sweep.rows],
            )
        _ensemble_springs(measured, result, wanted)
    result.remarks.append(
        f"the largest |jump| of the case is {number(1e3 * now['jump_largest_rad'])} mrad, in run "
        f"{now['jump_largest_run']:.0f} of {runs}")
    result.remarks.append(
        f"a 95 % quantile of {runs} runs scatters; with a recommended spring its upper bound from {CHECK} times "
        "more runs is below the wanted value too; the ranges that meet the wanted jump end at scanned values"
    )
    if with_dem:
        dem_runs = min(runs, case.ensemble.dem_runs)
        _ensemble_dem(case, result, dem_runs, lambda part: on_progress(0.7 + 0.3 * part))
    return result


@dataclass(frozen=True)
class SpringFound:
    """Smallest spring that passes on a given ensemble."""

    stiffness: float
    below: float | None  # a failing spring just below it; None: it is the smallest scanned spring
    up_to: float  # every scanned spring from it up to this stiffness passes
    passes_all_stiffer: bool


def smallest_spring(
    passes: Callable[[float], bool], scanned: Iterable[float]
) -> SpringFound | None:
    """Scan spring stiffnesses, then bisect below the first one that passes the limit; None: no spring passes.

    A statistic of chaotic runs need not decrease with the stiffness, so the result is the edge below the first scanned
    spring that passes.
    """
    springs = sorted(scanned)
    flags = [passes(spring) for spring in springs]
    if True not in flags:
        return None
    first = flags.index(True)
    last = first
    while last + 1 < len(springs) and flags[last + 1]:
        last += 1
    all_stiffer = last == len(springs) - 1
    if first == 0:
        return SpringFound(springs[0], None, springs[last], all_stiffer)
    below = springs[first - 1] or springs[first] * 1e-3  # geometric from above zero
    if passes(below):
        return SpringFound(below, 0.0, springs[last], all_stiffer)
    below, stiffness = bisect(passes, below, springs[first], 0.0, BISECTIONS)
    return SpringFound(stiffness, below, springs[last], all_stiffer)


def _ensemble_springs(measured: _Ensembles, result: Study, wanted: float) -> None:
    sweep = result.sweep(SPRING)
    # Springs whose row failed have no result and are not scanned.
    scanned = [row.value for row in sweep.rows if row.results]
    static = result.floor[2] if result.floor is not None else 0.0
    asked = f"{number(wanted * 1e3)} mrad"
    beyond = (
        f"the 95 % quantile of the largest |deflection| less its static value {number(static * 1e3)} mrad "
        "(contact on AC)"
    )
    result.recommendation["static_deflection_rad"] = static
    for name, what, rest in (("jump", "the 95 % quantile of |jump|", 0.0), ("deflection", beyond, static)):

        def value_of(spring: float, name: str = name, rest: float = rest) -> float:
            return measured({SPRING: spring})[f"{name}_quantile_rad"] - rest

        def checked(spring: float, name: str = name, rest: float = rest) -> float:
            return measured.check({SPRING: spring})[f"{name}_bound_rad"] - rest

        found = smallest_spring(
            lambda spring: value_of(spring) <= wanted and checked(spring) <= wanted, scanned
        )
        entry: dict[str, Any] = {"stiffness_N_m_per_rad": None}
        result.recommendation[f"for_{name}"] = entry
        if found is None:
            best = min(scanned, key=value_of)
            entry.update(best_stiffness_N_m_per_rad=best, best_value_rad=value_of(best))
            result.sentences.append(
                f"No torsion spring from {number(scanned[0])} to {number(scanned[-1])} N m/rad brings "
                f"{what} to or below {asked}: the best, {number(best)} N m/rad, leaves "
                f"{number(value_of(best) * 1e3)} mrad in {measured.runs} runs."
            )
            continue
        entry.update(
            stiffness_N_m_per_rad=found.stiffness,
            value_with_it_rad=value_of(found.stiffness),
            next_smaller_that_fails_N_m_per_rad=found.below,
            every_scanned_passes_up_to_N_m_per_rad=found.up_to,
        )
        if found.stiffness == 0:
            result.sentences.append(
                f"No torsion spring is needed: without one {what} is {number(value_of(0.0) * 1e3)} mrad, "
                f"not above {asked}."
            )
            continue
        again = checked(found.stiffness)
        entry.update(bound_on_check_ensemble_rad=again, check_ensemble_runs=CHECK * measured.runs)
        sentence = (
            f"The smallest torsion spring that brings {what} to or below {asked} has "
            f"{number(found.stiffness)} N m/rad: {number(value_of(found.stiffness) * 1e3)} mrad, and "
            f"by {CHECK * measured.runs} runs from other starts below {number(again * 1e3)} mrad with "
            f"{100 * min(CONFIDENCE, 1 - QUANTILE ** (CHECK * measured.runs)):.0f} % confidence"
        )
        if not found.passes_all_stiffer:
            sentence += f"; stiffer is not always better, beyond {number(found.up_to)} N m/rad it fails again"
        result.sentences.append(sentence + ".")
        sweep.insert(Row(found.stiffness, dict(measured({SPRING: found.stiffness}))))
        if name == "jump":
            sweep.recommended = found.stiffness


def _ensemble_dem(case: UmbrellaCase, result: Study, runs: int, on_progress: OnProgress) -> None:
    spring = result.sweep(SPRING)
    points = sorted({spring.own, spring.own if spring.recommended is None else spring.recommended})
    done = [0]

    def step() -> None:
        done[0] += 1
        on_progress(done[0] / (runs * len(points)))

    wanted = result.wanted or 0.0
    for stiffness in points:
        together = ensembles.dem_ensemble(with_values(case, {SPRING: stiffness}), runs, step)
        deflection = np.max(np.abs(together.deflection_rad), axis=1)
        jump = quantile(together.jump_rad)
        reduced = spring.row(stiffness).results
        reduced_mean, reduced_quantile = reduced["jump_mean_rad"], reduced["jump_quantile_rad"]
        assert reduced_mean is not None and reduced_quantile is not None  # ensembles have statistics
        result.dem.append({
            SPRING: stiffness, "runs": runs,
            "reduced_jump_mean_rad": reduced_mean,
            "dem_jump_mean_rad": float(np.mean(np.abs(together.jump_rad))),
            "reduced_jump_quantile_rad": reduced_quantile, "dem_jump_quantile_rad": jump,
            "reduced_deflection_quantile_rad": reduced["deflection_quantile_rad"],
            "dem_deflection_quantile_rad": quantile(deflection),
        })
        for sweep in result.sweeps if stiffness == spring.own else [spring]:
            sweep.row(stiffness if sweep is spring else sweep.own).dem_jump = jump
        result.remarks.append(
            f"DEM, {runs} runs, {number(stiffness)} N m/rad: 95 % quantile of |jump| {number(jump * 1e3)} mrad "
            f"({'not ' if jump <= wanted else ''}above the wanted value), mean "
            f"{number(float(np.mean(np.abs(together.jump_rad))) * 1e3)} mrad; reduced model "
            f"{number(reduced_quantile * 1e3)} and {number(reduced_mean * 1e3)} mrad"
        )
