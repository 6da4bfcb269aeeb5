# SPDX-License-Identifier: GPL-3.0-or-later
"""Conclusion c of the paper: effect of each control measure on the state jump."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from studies.paper.claims.findings import Findings
from studies.paper.claims.reasons import Reasons, because
from studies.paper.claims.statistics import (
    FAILS, HOLDS, IN_PART, MRAD, SIGNIFICANCE, UNTESTED, Groups, one_sided_welch, trend,
)
from studies.paper.claims.verdicts import (
    Claim, friction_is_the_reason, large_clearance_never_touches, more_friction_larger_range, smaller_clearance_earlier,
    spring_ends_at_static, spring_reduces_deflection, state_jump_occurs,
)


def _taken(jump: Groups, without: float, larger: bool) -> list[np.ndarray]:
    """Return the runs with the measure."""
    return [runs for value, runs in zip(jump.values, jump.runs) if (value > without) == larger and value != without]


def measure(jump: Groups, without: float, larger: bool) -> str:
    """Return the verdict on "the measure reduces the jump"; the rule is ``MEASURE_RULE``.

    :param without: parameter value without the measure
    :param larger: whether the measure increases the parameter
    """
    taken = _taken(jump, without, larger)
    before = jump.at(without)
    less = [one_sided_welch(before, runs, rising=False) < SIGNIFICANCE for runs in taken]
    more = [one_sided_welch(before, runs, rising=True) < SIGNIFICANCE for runs in taken]
    if not taken:
        return UNTESTED
    return HOLDS if all(less) else IN_PART if any(less) and not any(more) else FAILS


MEASURE_RULE = (
    f"*{HOLDS}*: at every value on the side of the measure the mean |jump| is smaller than without it, at "
    f"{SIGNIFICANCE:g} (Welch, one-sided); *{IN_PART}*: smaller at some of them and larger at none; "
    f"*{FAILS}*: otherwise"
)


@dataclass(frozen=True)
class Measure:
    """One measure and its effect on the jump.

    :param without: parameter value without the measure
    :param larger: whether the measure increases the parameter
    :param label: label of the parameter
    :param reduces: reason to print if the measure reduces the jump
    :param fails: reason to print if it does not: a function of the mean jumps [rad] with and without it
    """

    name: str
    jump: Groups
    without: float
    larger: bool
    label: str
    reduces: Reasons
    fails: Callable[[list[float], float], Reasons]


def _change(means: list[float], before: float) -> str:
    spread = " to ".join(f"{mean * MRAD:.3f}" for mean in sorted({min(means), max(means)}))
    return f"mean |jump| {before * MRAD:.3f} mrad without it, {spread} with it"


def measures(f: Findings) -> tuple[Measure, ...]:
    """Return the measures that the runs can test."""
    turn = f"both links together can still rotate by c/|AC| = {f.free_turn_rad * MRAD:.2f} mrad within the play"

    def friction_fails(means: list[float], before: float) -> Reasons:
        if max(means) > before and not f.damped:
            return because(speed_stays="friction dissipates energy; without it the speed of the impacts stays and "
                                       "moves the joint farther")
        return because(not_always="less friction does not always give a smaller jump")

    def stiffness_fails(means: list[float], before: float) -> Reasons:
        share = before / f.free_turn_rad
        return because(play_stays=f"the jump is {share:.2g} times c/|AC|, the rotation that the play allows, and links "
                                  "do not change the play")

    return (
        Measure("reducing friction", f.jump_by_friction, f.friction_coefficient, False, "μ",
                because(less_force="less friction leaves less force that holds the joint where it slid"),
                friction_fails),
        Measure("stiffer components", f.jump_by_stiffness, 1.0, True, "section over that of the case",
                because(stiffer="stiffer links give less under the forces of contact"), stiffness_fails),
        Measure("pre-stressed torsion springs" if f.spring_bias_rad else "torsion springs", f.jump_by_spring,
                f.jump_by_spring.values[0], True, "K_M in N m/rad",
                because(angle_held=f"a spring between the links holds the flare angle; {turn}, which does not load the "
                                   "spring"),
                lambda means, before: because(rotation_in_play="a spring between the links holds the flare angle, but "
                                                               f"{turn}, which does not load the spring")),
    )


def _why(m: Measure, verdict: str, size: Groups) -> Reasons:
    if verdict == UNTESTED:
        return because(no_value="no value of the study lies on the side of the measure")
    means = [float(np.mean(runs)) for runs in _taken(size, m.without, m.larger)]
    before = float(np.mean(size.at(m.without)))
    reason = m.reduces if verdict == HOLDS else m.fails(means, before)
    some = because(some_values="the measure has an effect at some of its values only")
    parts, codes = ([some, reason], some.codes + reason.codes) if verdict == IN_PART else ([reason], reason.codes)
    return Reasons(f"{_change(means, before)}: {'; '.join(parts)}", codes)


def control(f: Findings) -> list[Claim]:
    """Return the effect of each measure on the jump."""
    claims = []
    for m in measures(f):
        size = m.jump.absolute()
        verdict = measure(size, m.without, m.larger)
        again = trend(size, rising=not m.larger).against
        text = "; ".join(f"{a:g} to {b:g}, p = {p:.1e}" for a, b, p in again)
        claims.append(Claim(
            f"The state jump is controlled by {m.name} (conclusion c)",
            f"|jump| of θ2: {size.text()}; {m.label}, {m.without:g} without the measure"
            + (f"; steps against it: {text}" if again else ""),
            verdict, _why(m, verdict, size), MEASURE_RULE,
        ))
    if f.spring_bias_rad == 0:
        claims.append(Claim(
            "The state jump is controlled by pre-stressed springs (conclusion c)",
            "the spring of this case is free at the ideal position, as the paper's: it is not pre-stressed",
            UNTESTED,
            because(no_bias="needs torsion_spring.bias_rad, which makes the path unique"),
            f"*{UNTESTED}* unless the case has a bias",
        ))
    return claims


def all_claims(f: Findings) -> list[Claim]:
    """Return all statements of section 4.3 of the paper, and those of its conclusions that the runs can test."""
    return [
        state_jump_occurs(f),
        smaller_clearance_earlier(f),
        large_clearance_never_touches(f),
        more_friction_larger_range(f),
        friction_is_the_reason(f),
        spring_reduces_deflection(f),
        spring_ends_at_static(f),
        *control(f),
    ]
