# SPDX-License-Identifier: GPL-3.0-or-later
"""Verdicts on the paper's statements about its Figures 13 to 16."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan

import numpy as np

from studies.paper.claims.findings import Findings, FirstContact
from studies.paper.claims.reasons import Reasons, also, because
from studies.paper.claims.statistics import (
    FAILS, HOLDS, IN_THE_MEAN, MRAD, SIGNIFICANCE, TREND_RULE, UNTESTED, Trend, chance, one_sided_welch, trend,
)

NEGLIGIBLE = 0.1  # ratio to another jump below which a jump counts as zero
NEAR_STATIC = 0.05  # of the static value


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, with the observation, the verdict, its reason as far as known, and the rule."""

    statement: str
    found: str
    verdict: str
    why: Reasons
    rule: str


def jump_verdict(f: Findings, least_m: float) -> str:
    """Return the verdict on "a state jump occurs": how many runs end more than ``least_m`` [m] from their start."""
    share = float(np.mean(np.concatenate([f.end_shift_reduced_m, f.end_shift_dem_m]) > least_m))
    return HOLDS if share == 1 else IN_THE_MEAN if share > 0.5 else FAILS


def state_jump_occurs(f: Findings) -> Claim:
    """Judge "relative positions differ although the temperature has returned"."""
    least = f.start_spread_m
    shifts = np.concatenate([f.end_shift_reduced_m, f.end_shift_dem_m])
    verdict = jump_verdict(f, least)
    near = int(np.sum(shifts <= least))
    if verdict == FAILS:
        why = because(
            ends_at_start=f"{near} of {len(shifts)} runs end where they began, to the spread of the starts")
    else:
        why = because(
            position_undetermined="without a torsion spring statics does not determine the position of the journal in "
                                  "the play",
        ) if f.spring_stiffness_N_m_per_rad == 0 else because(
            rotation_in_play="the torsion spring determines the flare angle only; both links together can still rotate "
                             f"by c/|AC| = {f.free_turn_rad * MRAD:.2f} mrad within the play")
        if not f.damped:
            why = also(why, undamped="the speed after the first contact does not decay, because nothing damps links "
                                     "and pins")
        if f.amplification.is_chaotic:
            why = also(why, chaotic="runs with almost equal starts end far apart")
        if near:
            why = also(why, ends_at_start=f"{near} of {len(shifts)} runs end where they began")
    return Claim(
        "Relative positions change though the temperature returns: a state jump occurs (Fig. 13)",
        f"journal in the play moved by {np.mean(f.end_shift_reduced_m) * 1e6:.1f} µm (reduced, mean of "
        f"{len(f.end_shift_reduced_m)}) and {np.mean(f.end_shift_dem_m) * 1e6:.1f} µm (DEM, mean of "
        f"{len(f.end_shift_dem_m)}); smallest {np.min(shifts) * 1e6:.2f} µm",
        verdict, why,
        f"*{HOLDS}*: every run of both models ends farther from its start than the spread of the starts, "
        f"{least * 1e6:g} µm; *{IN_THE_MEAN}*: more than half of the runs do; *{FAILS}*: otherwise",
    )


def _meets(contact: FirstContact, f: Findings) -> bool:
    if contact.closed_form_K is None or contact.reduced_K is None or contact.dem_K is None:
        return contact.closed_form_K is contact.reduced_K is contact.dem_K is None
    return (
        abs(contact.reduced_K - contact.closed_form_K) <= f.tolerance_reduced_K
        and abs(contact.dem_K - contact.closed_form_K) <= f.tolerance_dem_K
    )


def kelvin(value: float | None, digits: int = 4) -> str:
    """Return a temperature as text; ``none`` for None and for values that are not finite."""
    return "none" if value is None or not np.isfinite(value) else f"{value:.{digits}f} K"


def _rises(values: Sequence[float | None]) -> bool:
    given = [np.inf if value is None else value for value in values]
    return all(b > a or a == b == np.inf for a, b in zip(given, given[1:]))


def smaller_clearance_earlier(f: Findings) -> Claim:
    """Judge "the smaller the clearance, the earlier the deflection"."""
    met = all(_meets(contact, f) for contact in f.first_contacts)
    each = all(
        _rises([getattr(contact, name) for contact in f.first_contacts]) for name in ("reduced_K", "dem_K")
    ) and _rises(f.onset_dem_K)
    runs_apart = all(
        np.max(earlier) < np.min(later) or np.all(np.isinf(earlier))
        for earlier, later in zip(f.onset_K.runs, f.onset_K.runs[1:])
    )
    in_mean = _rises([float(np.median(onset)) for onset in f.onset_K.runs])
    verdict = HOLDS if each and runs_apart and met else IN_THE_MEAN if each and in_mean else FAILS
    if isnan(f.clearance_limit_m):
        why = because(no_closed_form="this case has no closed form of the first contact")
    elif not met:
        why = because(
            off_closed_form="first contact of a model is off the closed form c/(α |AC|) by more than its tolerance")
    else:
        why = because(
            meets_closed_form="before contact the distance of the centres along AC is α ΔT |AC| for every stiffness; "
                              "contact is at ΔT_c = c/(α |AC|), met by both models to the tolerances of the table "
                              "below")
    if not runs_apart:
        why = also(why, overlapping="runs at neighbouring clearances begin to deflect at overlapping temperatures")
    if not (each and in_mean):
        why = also(why, not_always="a larger clearance does not always deflect later")
    found = "; ".join(
        f"c = {contact.clearance_m * 1e3:g} mm: {kelvin(float(np.median(onset)), 2)} (DEM {kelvin(dem, 2)})"
        for contact, onset, dem in zip(f.first_contacts, f.onset_K.runs, f.onset_dem_K)
    )
    return Claim(
        "The smaller the clearance, the earlier the deflection (Fig. 14)",
        f"start of the deflection, median of the reduced runs: {found}",
        verdict, why,
        f"*{HOLDS}*: with c, the temperature of the first contact rises in both models, and so does that at which DEM "
        f"runs begin to deflect; the contacts agree with the closed form to {f.tolerance_reduced_K:g} K (reduced) and "
        f"{f.tolerance_dem_K:g} K (DEM); every reduced run at one c begins to deflect before every run at the next. "
        f"*{IN_THE_MEAN}*: these temperatures rise, and so does the median of the reduced runs; *{FAILS}*: otherwise",
    )


def large_clearance_never_touches(f: Findings) -> Claim:
    """Judge "above the clearance limit there is no contact". The rule also requires contact in all runs below the
    limit."""
    above = [value > f.clearance_limit_m for value in f.onset_K.values]
    right = [
        bool(np.all(np.isinf(onset) if beyond else np.isfinite(onset)))
        and np.isinf(dem) == beyond
        and (contact.reduced_K is None) == beyond and (contact.dem_K is None) == beyond
        for beyond, onset, dem, contact in zip(above, f.onset_K.runs, f.onset_dem_K, f.first_contacts)
    ]
    if isnan(f.clearance_limit_m):
        verdict, limit = UNTESTED, "no limit known"
        why = because(no_closed_form="this case has no closed form of the limit")
    else:
        limit = f"limit α ΔTmax |AC| = {f.clearance_limit_m * 1e3:.3f} mm"
        wrong = ", ".join(f"{value * 1e3:g} mm" for value, is_right in zip(f.onset_K.values, right) if not is_right)
        if not any(above):
            verdict, why = UNTESTED, because(no_clearance_above="no clearance of the study lies above the limit")
        elif wrong:
            verdict, why = FAILS, because(
                against_limit=f"against the distance of the centres α ΔT |AC|: runs at c = {wrong}")
        else:
            verdict, why = HOLDS, because(ends_at_limit="the distance of the centres, α ΔT |AC|, ends at the limit")
    moved = ", ".join(
        f"{np.sum(np.isfinite(onset))}/{len(onset)} and {int(np.isfinite(dem))}/1 at c = {value * 1e3:g} mm"
        for value, onset, dem in zip(f.onset_K.values, f.onset_K.runs, f.onset_dem_K)
    )
    return Claim(
        "A clearance above the largest thermal deformation is never used up: no contact (Fig. 14)",
        f"{limit}; runs that deflect, reduced and DEM: {moved}",
        verdict, why,
        f"*{HOLDS}*: above the limit no run of either model deflects or touches, below it every run does; "
        f"*{FAILS}*: otherwise",
    )


def _steps_against(t: Trend) -> str:
    return "; ".join(f"{a:g} to {b:g}: p = {p:.1e}" for a, b, p in t.against)


def _trend_text(t: Trend) -> str:
    text = f"Spearman {t.rank_correlation:+.2f}, one-sided p = {t.p:.1e}"
    return text + (f"; against it, {_steps_against(t)}" if t.against else "")


def _trend_why(t: Trend, holds: Reasons) -> Reasons:
    """Return the reason of a trend's verdict; ``holds`` is the reason to return if the claimed direction is confirmed.
    """
    if t.verdict == HOLDS:
        return holds
    scatter = ("two runs at neighbouring values have the claimed order with a probability as low as "
               f"{t.least_chance:.2f}")
    if t.verdict == IN_THE_MEAN:
        return also(holds, scatter=f"the scatter of the runs is as large as a step: {scatter}; one run per value, as "
                                   "in the paper, can therefore give either order")
    against = because(other_way="the means go the other way at some step") if t.against else because(
        not_shown="the ensembles do not show it")
    return also(against, order_by_chance=scatter)


def more_friction_larger_range(f: Findings) -> Claim:
    """Judge "the larger μ, the larger the range of θ2"."""
    t = trend(f.range_by_friction, rising=True)
    first, *_, last = f.range_by_friction.runs
    return Claim(
        "Generally, the larger μ, the larger the range of the deflection angle (Fig. 15)",
        f"range of θ2: {f.range_by_friction.text()}; slope {t.slope * MRAD:+.2f} ± {t.slope_error * MRAD:.2f} mrad "
        f"per unit of μ; {_trend_text(t)}; a run at the largest μ exceeds one at the smallest with the probability "
        f"{chance(first, last, rising=True):.2f}",
        t.verdict, _trend_why(t, because(friction_carries="the more friction, the farther AB is carried")), TREND_RULE,
    )


def friction_is_the_reason(f: Findings) -> Claim:
    """Conclusion a: without friction no jump."""
    statement = "Friction is a basic reason for the state jump (conclusion a)"
    rule = (
        f"*{HOLDS}*: mean |jump| at μ = 0 below {NEGLIGIBLE:g} of that at the case's μ; *{IN_THE_MEAN}*: smaller "
        f"at {SIGNIFICANCE:g} (Welch, one-sided); *{FAILS}*: otherwise"
    )
    jump = f.jump_by_friction.absolute()
    if f.friction_coefficient == 0:
        return Claim(statement, f"mean |jump| of θ2: {jump.text()}", UNTESTED,
                     because(no_friction="the case has no friction"), rule)
    free, full = jump.at(0.0), jump.at(f.friction_coefficient)
    ratio = float(np.mean(free) / np.mean(full)) if np.mean(full) > 0 else np.inf
    p = one_sided_welch(full, free, rising=False)
    verdict = HOLDS if ratio < NEGLIGIBLE else IN_THE_MEAN if p < SIGNIFICANCE else FAILS
    inertia = {} if f.damped else {
        "undamped": "nothing else dissipates the energy of the impacts, so the links still move at the end of the "
                    "cycle"}
    if verdict == HOLDS:
        why = because(closed="the curves close without friction")
    elif verdict == IN_THE_MEAN:
        why = because(part_remains=f"a part of {ratio:.2f} of the jump remains without friction", **inertia)
    elif not np.isfinite(ratio):
        why = because(no_jump="with the friction of the case there is no jump")
    else:
        why = because(open="the curves do not close at μ = 0 either", **inertia)
    return Claim(
        statement,
        f"mean |jump| of θ2 without friction is {ratio:.2f} of that at μ = {f.friction_coefficient:g}: {jump.text()}",
        verdict, why, rule,
    )


def spring_reduces_deflection(f: Findings) -> Claim:
    """The deflection falls with K_M."""
    t = trend(f.largest_by_spring, rising=False)
    return Claim(
        "The deflection decreases with the torsion spring K_M (Fig. 16)",
        f"largest deflection: {f.largest_by_spring.text()}; K_M in N m/rad; {_trend_text(t)}",
        t.verdict, _trend_why(t, because(spring_holds="the spring holds the flare angle")), TREND_RULE,
    )


def spring_ends_at_static(f: Findings) -> Claim:
    """... until the static value is reached."""
    statement = "… in a certain range: until the static value is reached (Fig. 16)"
    rule = (
        f"*{HOLDS}*: at the stiffest spring the mean of the largest deflection is within {NEAR_STATIC:g} of the "
        f"static value for rigid links; *{FAILS}*: otherwise"
    )
    if f.spring_bias_rad != 0:
        return Claim(statement, f"the spring of this case is free {f.spring_bias_rad:g} rad off the ideal position",
                     UNTESTED, because(not_free="the static value is that of a spring that is free there"), rule)
    if f.static_rigid_rad is None or f.static_rigid_rad == 0:
        return Claim(statement, "no contact at the largest temperature change", UNTESTED,
                     because(no_static_deflection="there is no static deflection"), rule)
    means = f.largest_by_spring.mean()
    ratio = float(means[-1] / abs(f.static_rigid_rad))
    known = [
        (stiffness, value) for stiffness, value in zip(f.largest_by_spring.values, f.static_elastic_rad)
        if value is not None
    ]
    elastic = ", ".join(f"{value * MRAD:.4f} at {stiffness:g}" for stiffness, value in known)
    verdict = HOLDS if abs(ratio - 1) <= NEAR_STATIC else FAILS
    why = because(angles_fixed="contact at ΔTmax with |d| = c along AC fixes both angles")
    rest = f"the rest, {(ratio - 1) * 100:.1f} %, is the swing of the links"
    if ratio > 1 and f.damped:
        why = also(why, swing=rest)
    elif ratio > 1:
        why = also(why, undamped_swing=f"{rest}, which nothing damps")
    elif ratio < 1:
        why = also(why, below=f"the runs stay {(1 - ratio) * 100:.1f} % below it")
    if known:
        taken = [abs(f.static_rigid_rad) - abs(value) for _, value in known]
        grows = all(later > earlier for earlier, later in zip(taken, taken[1:]))
        why = also(why, elastic_links=f"elastic links reduce the angle by {taken[-1] * MRAD:.4f} mrad at the stiffest "
                                      "spring" + (", and by less at softer ones" if grows and len(taken) > 1 else ""))
    return Claim(
        statement,
        f"static value at ΔTmax, contact without friction, rigid links: {f.static_rigid_rad * MRAD:.4f} mrad "
        f"for every K_M; elastic links: {elastic} [mrad]; mean of the runs over the rigid value: {ratio:.3f} at "
        "the stiffest",
        verdict, why, rule,
    )
