# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the state jump of a ``spring_slider`` case: exact jumps, and the closed form where it is valid."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from statejump import _engine
from statejump.control.study import (
    DesignChoices, Line, Row, Study, Sweep, bisect, check_wanted, grid, highest, number, ranges_that_pass,
    refuse_choices, refuse_runs, with_notes,
)
from statejump.core.engine_failures import engine
from statejump.core.errors import StatejumpError
from statejump.core.notes import Note
from statejump.core.progress import OnProgress, one_of
from statejump.kinds import require
from statejump.kinds.protocol import DemModel
from statejump.kinds.spring_slider import reduced
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.kinds.spring_slider.stable_step import link_stiffness
from statejump.schema.paths import with_values

POINTS = 49
PRELOAD = "joint.preload_stiffness_N_per_m"
RESULTS = {"jump_m": "|jump| [µm]", "closed_form_m": "closed form [µm]"}
LINES: dict[str, Line] = {
    "jump_m": ("exact model", dict(color="#E69F00", linewidth=4.0, solid_capstyle="round")),
    "closed_form_m": (
        "closed form f/(k + k_p),\nwhere the cycle ends sliding",
        dict(color="#000000", linewidth=1.2, linestyle=(0, (5, 2))),
    ),
}
MEASURE = (
    "exact quasi-static path of the reduced model; closed form f/(k + k_p), without preload "
    "f l0/(E A), valid for a cycle that ends sliding at ΔT = 0"
)


@dataclass(frozen=True)
class Jump:
    """State jump of one design."""

    size_m: float
    closed_form_m: float | None  # None: the cycle does not end sliding at ΔT = 0, or starts or ends at a stop
    slips: bool


def jump_of(case: SpringSliderCase) -> Jump:
    """Return the jump of a case. :raises StatejumpError: a value of the case is out of range"""
    with engine():
        path = reduced.solve(case, np.array([0.0]))
    # If the block does not slide in the first cycle, the second cycle is equal to the first.
    slips = any(segment.motion == "slide" for segment in path.segments)
    last = path.segments[-1]
    start = path.segments[0].start_displacement_m
    free = all(-case.joint.clearance_minus_m < place < case.joint.clearance_plus_m
               for place in (start, last.end_displacement_m))
    closed = free and last.motion == "slide" and last.end_temperature_change_K == 0
    return Jump(abs(path.state_jump_m), closed_form_m(path) if closed else None, slips)


def closed_form_m(path: _engine.SpringSliderPath) -> float:
    """Return the jump [m] in closed form. It holds if the path ends sliding at ΔT = 0 and did not start at a stop."""
    return abs(path.model.state_jump_after_slide_m(path.segments[-1].direction))


def closed_force_N(case: SpringSliderCase) -> float:
    """Return the closed-form jump times k + k_p [N]: friction limit f, or change of friction from start to end."""
    with engine():
        path = reduced.solve(case, np.array([0.0]))
    direction = path.segments[-1].direction or -1
    return abs(path.model.start_load_N - direction * path.model.friction_force_N)


@dataclass(frozen=True)
class Spring:
    """The softest preload spring that keeps the jump at or below a value."""

    stiffness_N_per_m: float
    jump_m: float  # solved with the spring
    by: str  # "none", "closed form" or "bisection"


def smallest_preload(case: SpringSliderCase, wanted_m: float) -> Spring | None:
    """Return the softest spring with a jump of at most ``wanted_m``; None if the stiffest allowed spring is too soft.

    Without a preload force against a stop, the jump never grows with k_p: the block slides less far and returns
    earlier. With such a force, the jump grows until the stop is unloaded, then falls. If the jump without a spring
    exceeds a value, the jump therefore crosses it exactly once.
    """

    def solved(stiffness: float) -> Jump:
        return jump_of(with_values(case, {PRELOAD: stiffness}))

    def passes(stiffness: float) -> bool:
        return solved(stiffness).size_m <= wanted_m

    if passes(0.0):
        return Spring(0.0, solved(0.0).size_m, "none")
    largest = highest(case, PRELOAD)
    closed = closed_force_N(case) / wanted_m - link_stiffness(case)
    if 0 < closed <= largest and solved(closed).closed_form_m is not None:
        # Increase the stiffness by up to 8 rounding steps, until the solved jump does not exceed the wanted one.
        stiffness = closed
        for _ in range(8):
            if passes(stiffness):
                return Spring(stiffness, solved(stiffness).size_m, "closed form")
            stiffness = float(np.nextafter(stiffness, np.inf)) + 1e-16 * link_stiffness(case)
    upper = 1e-6 * link_stiffness(case)
    while not passes(upper):
        if upper == largest:
            return None
        upper = min(10 * upper, largest)
    stiffness = bisect(passes, 0.0, upper, 1e-13)[1]
    return Spring(stiffness, solved(stiffness).size_m, "bisection")


def _changes(case: SpringSliderCase, parameter: str, value: float) -> dict[str, Any]:
    if parameter == "joint.clearance_plus_m":  # both sides by the same factor
        other = case.joint.clearance_minus_m * (value / case.joint.clearance_plus_m)
        return {parameter: value, "joint.clearance_minus_m": other}
    return {parameter: value}


def _row(case: SpringSliderCase, parameter: str, value: float) -> Row:
    try:
        jump = jump_of(with_values(case, _changes(case, parameter, value)))
    except StatejumpError as problem:
        return Row(value, {}, str(problem))
    note = "" if jump.closed_form_m is not None else (
        "cycle does not end sliding" if jump.slips else "no slip: no jump"
    )
    return Row(value, {"jump_m": jump.size_m, "closed_form_m": jump.closed_form_m}, note)


def _sweeps(case: SpringSliderCase) -> list[Sweep]:
    joint, link = case.joint, case.link
    rigidity = link.young_modulus_Pa * link.cross_section_area_m2
    friction = joint.friction_coefficient or 0.3
    most_friction = 0.99 * min(10.0, rigidity / joint.normal_force_N)
    least_area = 1.01 * case.friction_force_N / link.young_modulus_Pa
    clearance, k = joint.clearance_plus_m, link_stiffness(case)
    far = min(100.0, 0.99 * link.stress_free_length_m / joint.clearance_minus_m)
    area = link.cross_section_area_m2
    plan = (
        ("joint.friction_coefficient", f"Friction coefficient μ (force {joint.normal_force_N:g} N × μ)", "-", 1.0,
         joint.friction_coefficient, min(friction / 30, most_friction / 900),
         min(30 * friction, most_friction), False),
        ("link.cross_section_area_m2", "Section of the link; E acts alike", "mm²", 1e6, area,
         max(area / 30, least_area), 30 * area, False),
        (PRELOAD, "Preload spring k_p", "N/m", 1.0, joint.preload_stiffness_N_per_m, 1e-3 * k, 1e3 * k, True),
        ("joint.clearance_plus_m", "Clearance c⁺, c⁻ with it", "mm", 1e3, clearance, clearance / 100,
         far * clearance, False),
    )
    return [
        Sweep(key, label, unit, scale, own,
              [_row(case, key, value) for value in grid(own, low, high, POINTS, zero)])
        for key, label, unit, scale, own, low, high, zero in plan
    ]


@with_notes
def control(
    case: SpringSliderCase, jump_below: float | None = None, runs: int | None = None, with_dem: bool = False,
    on_progress: OnProgress = lambda share: None, choices: DesignChoices = DesignChoices(),
) -> Study:
    """Sweep the parameters, search for the softest sufficient preload spring and, if requested, check it with the DEM.

    :param jump_below: largest allowed jump [m]; None: half of the jump of the case
    :param runs: must be None, because there is one exact path
    :param choices: must be empty, because the case has only one jump
    :raises StatejumpError: invalid input, or a run failed
    """
    check_wanted(jump_below, "m")
    refuse_choices(choices, case)
    refuse_runs(runs, case)
    wanted = jump_below
    now = jump_of(case)
    if wanted is None and now.size_m > 0:
        wanted = now.size_m / 2
    result = Study(MEASURE, "m", "µm", 1e6, RESULTS, now.size_m, wanted, "|State jump| [µm]", LINES)
    result.sweeps = _sweeps(case)
    if wanted is None:
        result.sentences.append(Note("nothing_to_control", what="The case has no jump"))
    else:
        for sweep in result.sweeps:
            _find_ranges(case, sweep, wanted)
        _recommend(case, result, wanted)
    result.remarks += [*reduced.buckling(reduced.solve(case, np.array([0.0]))), *reduced.warnings(case)]
    if with_dem:
        _check_by_dem(case, result, on_progress)
    return result


def _find_ranges(case: SpringSliderCase, sweep: Sweep, wanted: float) -> None:
    def passes(value: float) -> bool:
        size = _row(case, sweep.parameter, value).results.get("jump_m")
        return size is not None and size <= wanted

    values = [row.value for row in sweep.rows]
    sweep.meets = ranges_that_pass(values, [passes(value) for value in values], passes)


def _recommend(case: SpringSliderCase, result: Study, wanted: float) -> None:
    spring = smallest_preload(case, wanted)
    asked = f"{number(wanted * 1e6)} µm"
    if spring is None:
        largest = highest(case, PRELOAD)
        result.recommendation["preload_stiffness_N_per_m"] = None
        result.sentences.append(Note("no_preload", largest_N_per_m=largest, wanted=asked, wanted_m=wanted))
        return
    result.recommendation.update(
        preload_stiffness_N_per_m=spring.stiffness_N_per_m, jump_with_it_m=spring.jump_m, found_by=spring.by
    )
    sweep = result.sweep(PRELOAD)
    sweep.recommended = spring.stiffness_N_per_m
    sweep.insert(_row(case, PRELOAD, spring.stiffness_N_per_m))
    if spring.by == "none":
        result.sentences.append(Note("no_preload_needed", jump=f"{number(spring.jump_m * 1e6)} µm", wanted=asked))
        return
    how = {
        "closed form": "closed form f/jump − k",
        "bisection": "bisection, for the cycle does not end sliding and the closed form does not hold",
    }[spring.by]
    result.sentences.append(Note("smallest_preload", wanted=asked, stiffness_N_per_m=spring.stiffness_N_per_m, how=how,
                                 jump=f"{spring.jump_m * 1e6:.6g} µm"))


def _check_by_dem(case: SpringSliderCase, result: Study, on_progress: OnProgress) -> None:
    preload = result.sweep(PRELOAD)
    wanted = {preload.own, preload.own if preload.recommended is None else preload.recommended}
    for done, stiffness in enumerate(sorted(wanted)):
        design = with_values(case, {PRELOAD: stiffness})
        run = require(case, DemModel).dem(design, one_of(on_progress, done, len(wanted)))
        jump, exact = abs(run.summary["state_jump_m"]), jump_of(design).size_m
        result.dem.append({PRELOAD: stiffness, "reduced_jump_m": exact, "dem_jump_m": jump})
        preload.row(stiffness).dem_jump = jump
        result.remarks.append(
            f"DEM with k_p = {stiffness:.6g} N/m: jump {jump * 1e6:.5g} µm, reduced model {exact * 1e6:.5g} µm"
        )
        if stiffness == preload.own:
            for sweep in result.sweeps:
                sweep.row(sweep.own).dem_jump = jump
