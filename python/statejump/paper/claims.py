# SPDX-License-Identifier: GPL-3.0-or-later
"""What the paper says of its Figures 13 to 16, held against runs of both models.

Every verdict follows from the numbers by a rule that is printed beside it.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Sequence

import numpy as np
from scipy import stats

SIGNIFICANCE = 0.01
HOLDS, IN_THE_MEAN, IN_PART = "holds", "holds in the mean", "holds in part"
FAILS, UNTESTED = "does not hold", "not tested"
NEARLY_EVERY_RUN = 0.95  # chance that a run at the next value lies on the claimed side
CHAOTIC = 1e6  # growth of a small difference beyond which no run can be repeated by another code
NEGLIGIBLE = 0.1  # a jump below this part of another is no jump
NEAR_STATIC = 0.05  # of the static value
MRAD = 1e3


RULES_CHANGED = (
    "Two rules were changed after a first look at numbers of cases/umbrella.toml. With ten times the spread as the "
    "threshold of rule 1 the first statement *holds in the mean*; with a monotone fall asked for instead of rule 7 "
    "torsion springs do not pass either."
)


@dataclass(frozen=True)
class Groups:
    """One quantity of every run, by the value of the parameter that was varied."""

    values: tuple[float, ...]  # rising
    runs: tuple[np.ndarray, ...]

    def mean(self) -> np.ndarray:
        """Mean at every value."""
        return np.array([np.mean(group) for group in self.runs])

    def standard_error(self) -> np.ndarray:
        """Standard error of the mean at every value; 0 of a single run."""
        return np.array(
            [np.std(group, ddof=1) / np.sqrt(len(group)) if len(group) > 1 else 0.0 for group in self.runs]
        )

    def at(self, value: float) -> np.ndarray:
        """Runs at a value."""
        return self.runs[self.values.index(value)]

    def absolute(self) -> "Groups":
        """The same of the absolute values."""
        return Groups(self.values, tuple(np.abs(group) for group in self.runs))

    def text(self, unit: str = "mrad", scale: float = MRAD, value_scale: float = 1.0) -> str:
        """Mean ± standard error at every value."""
        parts = [
            f"{mean * scale:.3f} ± {error * scale:.3f} at {value * value_scale:g}"
            for value, mean, error in zip(self.values, self.mean(), self.standard_error())
        ]
        return f"{', '.join(parts)} [{unit}]"


@dataclass(frozen=True)
class Trend:
    """How a quantity goes with a parameter, measured against a claimed direction."""

    verdict: str
    rank_correlation: float  # Spearman's, of all runs
    p: float  # one-sided, of the claimed direction
    slope: float  # least squares
    slope_error: float
    against: tuple[tuple[float, float, float], ...]  # steps significantly the other way: from, to, p


def _one_sided_welch(first: np.ndarray, second: np.ndarray, rising: bool) -> float:
    """p of "the second mean is above (rising) or below the first"; 1 where nothing varies."""
    if np.ptp(first) == 0 and np.ptp(second) == 0:
        step = np.mean(second) - np.mean(first)
        return 0.0 if (step > 0 if rising else step < 0) else 1.0
    side = "greater" if rising else "less"
    p = stats.ttest_ind(second, first, equal_var=False, alternative=side).pvalue
    return 1.0 if np.isnan(p) else float(p)


def _chance(first: np.ndarray, second: np.ndarray, rising: bool) -> float:
    """Chance that a run of the second group lies on the claimed side of one of the first."""
    difference = second[:, None] - first[None, :]
    return float(np.mean(difference > 0 if rising else difference < 0))


def trend(groups: Groups, rising: bool) -> Trend:
    """Verdict on "the quantity rises (falls) with the parameter"; the rule is ``TREND_RULE``."""
    abscissa = np.concatenate([np.full(len(runs), value) for value, runs in zip(groups.values, groups.runs)])
    ordinate = np.concatenate(groups.runs)
    if np.ptp(ordinate) == 0 or np.ptp(abscissa) == 0:
        return Trend(FAILS, 0.0, 1.0, 0.0, 0.0, ())
    rank = stats.spearmanr(abscissa, ordinate, alternative="greater" if rising else "less")
    line = stats.linregress(abscissa, ordinate)
    steps = list(zip(groups.values, groups.runs, groups.values[1:], groups.runs[1:]))
    against = tuple(
        (from_, to, p)
        for from_, first, to, second in steps
        if (p := _one_sided_welch(first, second, not rising)) < SIGNIFICANCE
    )
    if all(_chance(first, second, rising) >= NEARLY_EVERY_RUN for _, first, _, second in steps):
        verdict = HOLDS
    elif rank.pvalue < SIGNIFICANCE and not against:
        verdict = IN_THE_MEAN
    else:
        verdict = FAILS
    return Trend(verdict, float(rank.correlation), float(rank.pvalue), line.slope, line.stderr, against)


TREND_RULE = (
    f"*{HOLDS}*: at every step of the parameter a run of the next value lies on the claimed side with a "
    f"chance of at least {NEARLY_EVERY_RUN:g}; *{IN_THE_MEAN}*: else, if Spearman's rank test of all runs "
    f"gives the claimed direction at {SIGNIFICANCE:g} and no step of the means goes the other way at "
    f"{SIGNIFICANCE:g} (Welch); *{FAILS}*: else"
)


@dataclass(frozen=True)
class TwoSampleTest:
    """The two models' ensembles of one quantity."""

    quantity: str
    reduced_mean: float
    reduced_sd: float
    dem_mean: float
    dem_sd: float
    p_distribution: float  # Kolmogorov-Smirnov
    p_mean: float  # Welch
    p_spread: float  # Brown-Forsythe

    @property
    def agree(self) -> bool:
        """No test tells the models apart."""
        return min(self.p_distribution, self.p_mean, self.p_spread) >= SIGNIFICANCE


def two_sample_test(quantity: str, reduced: np.ndarray, dem: np.ndarray) -> TwoSampleTest:
    """Test whether two ensembles may be of one distribution. NaN, of too few runs, counts as 1."""

    def p(result: object) -> float:
        value = float(result.pvalue)  # type: ignore[attr-defined]
        return 1.0 if np.isnan(value) else value

    few = min(len(reduced), len(dem)) < 2
    return TwoSampleTest(
        quantity,
        float(np.mean(reduced)), float(np.std(reduced, ddof=1)) if not few else 0.0,
        float(np.mean(dem)), float(np.std(dem, ddof=1)) if not few else 0.0,
        p(stats.ks_2samp(reduced, dem)),
        1.0 if few else p(stats.ttest_ind(reduced, dem, equal_var=False)),
        1.0 if few else p(stats.levene(reduced, dem, center="median")),
    )


@dataclass(frozen=True)
class FirstContact:
    """ΔT [K] of first contact at one clearance, links without ringing at the start; None: never."""

    clearance_m: float
    closed_form_K: Optional[float]
    reduced_K: Optional[float]
    dem_K: Optional[float]
    reduced_ringing_K: Optional[float] = None  # of the paper's start from rest
    dem_ringing_K: Optional[float] = None


@dataclass(frozen=True)
class Envelope:
    """θ2 of all runs of one kind against all that the play allows at the same temperature."""

    runs: str
    count: int
    largest_excess_rad: float  # beyond rigid links with |d| = c; negative: distance to it
    margin_m: float  # of |d|, for the stretch of the links and the depth of the contact
    beyond_margin: int  # samples outside of that


@dataclass(frozen=True)
class Amplification:
    """Two runs of the reduced model from starts that differ in the direction of AB."""

    start_rad: float
    at_largest_temperature_rad: float
    at_end_rad: float


@dataclass(frozen=True)
class Findings:
    """Everything that the verdicts are computed from."""

    start_spread_m: float
    end_shift_reduced_m: np.ndarray  # of the journal in the play, start to end, every run
    end_shift_dem_m: np.ndarray
    first_contacts: tuple[FirstContact, ...]
    tolerance_reduced_K: float
    tolerance_dem_K: float
    onset_K: Groups  # by clearance, from the paper's start; inf: θ2 never moves
    onset_dem_K: tuple[float, ...]
    clearance_limit_m: float  # play that the expansion of the links just uses up; nan: no closed form
    range_by_friction: Groups
    jump_by_friction: Groups
    friction_coefficient: float  # of the case
    largest_by_spring: Groups
    jump_by_spring: Groups
    static_rigid_rad: Optional[float]
    static_elastic_rad: tuple[Optional[float], ...]  # by stiffness of the spring
    jump_by_stiffness: Groups  # section of the links, over that of the case
    free_turn_rad: float  # c/|AC|
    spring_bias_rad: float
    tests: tuple[TwoSampleTest, ...]
    envelopes: tuple[Envelope, ...]
    amplification: Amplification


@dataclass(frozen=True)
class Claim:
    """A statement, what was found, what follows, and by which rule."""

    statement: str
    found: str
    verdict: str
    why: str
    rule: str


def state_jump_occurs(f: Findings) -> Claim:
    """Relative positions differ though the temperature has returned."""
    least = f.start_spread_m
    shifts = np.concatenate([f.end_shift_reduced_m, f.end_shift_dem_m])
    share = float(np.mean(shifts > least))
    verdict = HOLDS if share == 1 else IN_THE_MEAN if share > 0.5 else FAILS
    return Claim(
        "Relative positions change though the temperature returns: a state jump occurs (Fig. 13)",
        f"journal in the play moved by {np.mean(f.end_shift_reduced_m) * 1e6:.1f} µm (reduced, mean of "
        f"{len(f.end_shift_reduced_m)}) and {np.mean(f.end_shift_dem_m) * 1e6:.1f} µm (DEM, mean of "
        f"{len(f.end_shift_dem_m)}); smallest {np.min(shifts) * 1e6:.2f} µm",
        verdict,
        "without a torsion spring statics leaves the place in the play open, and what speed the first contact "
        "gives stays: starts that differ by next to nothing end far apart",
        f"*{HOLDS}*: every run of both models ends farther from where it began than starts are spread, "
        f"{least * 1e6:g} µm; *{IN_THE_MEAN}*: more than half of them; *{FAILS}*: else",
    )


def _meets(contact: FirstContact, f: Findings) -> bool:
    if contact.closed_form_K is None or contact.reduced_K is None or contact.dem_K is None:
        return contact.closed_form_K is contact.reduced_K is contact.dem_K is None
    return (
        abs(contact.reduced_K - contact.closed_form_K) <= f.tolerance_reduced_K
        and abs(contact.dem_K - contact.closed_form_K) <= f.tolerance_dem_K
    )


def _kelvin(value: Optional[float], digits: int = 4) -> str:
    return "none" if value is None or not np.isfinite(value) else f"{value:.{digits}f} K"


def smaller_clearance_earlier(f: Findings) -> Claim:
    """The smaller the clearance, the earlier the deflection."""
    met = all(_meets(contact, f) for contact in f.first_contacts)

    def rises(values: Sequence[Optional[float]]) -> bool:
        given = [np.inf if value is None else value for value in values]
        return all(b > a or a == b == np.inf for a, b in zip(given, given[1:]))

    each = all(
        rises([getattr(contact, name) for contact in f.first_contacts]) for name in ("reduced_K", "dem_K")
    ) and rises(f.onset_dem_K)
    runs_apart = all(
        np.max(earlier) < np.min(later) or np.all(np.isinf(earlier))
        for earlier, later in zip(f.onset_K.runs, f.onset_K.runs[1:])
    )
    in_mean = rises([float(np.median(onset)) for onset in f.onset_K.runs])
    verdict = HOLDS if each and runs_apart and met else IN_THE_MEAN if each and in_mean else FAILS
    found = "; ".join(
        f"c = {contact.clearance_m * 1e3:g} mm: {_kelvin(float(np.median(onset)), 2)} (DEM {_kelvin(dem, 2)})"
        for contact, onset, dem in zip(f.first_contacts, f.onset_K.runs, f.onset_dem_K)
    )
    return Claim(
        "The smaller the clearance, the earlier the deflection (Fig. 14)",
        f"deflection begins at, median of the reduced runs: {found}",
        verdict,
        "before contact the centres part along AC by α ΔT |AC|, whatever the stiffness: contact at "
        "ΔT_c = c/(α |AC|), met by both models to the tolerances of the table below"
        if met else "first contact of a model is off the closed form c/(α |AC|) by more than its tolerance",
        f"*{HOLDS}*: first contacts of both models, and where the DEM runs begin to deflect, rise with c; the "
        f"contacts meet the closed form to {f.tolerance_reduced_K:g} K (reduced) and {f.tolerance_dem_K:g} K (DEM); "
        f"every reduced run at one c begins to deflect before every run at the next. *{IN_THE_MEAN}*: they rise, "
        f"and so does the median of the reduced runs; *{FAILS}*: else",
    )


def large_clearance_never_touches(f: Findings) -> Claim:
    """Above the limit there is no contact at all, below it there always is."""
    above = [value > f.clearance_limit_m for value in f.onset_K.values]
    if not any(above):
        verdict = UNTESTED
    else:
        right = [
            bool(np.all(np.isinf(onset) if beyond else np.isfinite(onset)))
            and np.isinf(dem) == beyond
            and (contact.reduced_K is None) == beyond and (contact.dem_K is None) == beyond
            for beyond, onset, dem, contact in zip(above, f.onset_K.runs, f.onset_dem_K, f.first_contacts)
        ]
        verdict = HOLDS if all(right) else FAILS
    moved = ", ".join(
        f"{np.sum(np.isfinite(onset))}/{len(onset)} and {int(np.isfinite(dem))}/1 at c = {value * 1e3:g} mm"
        for value, onset, dem in zip(f.onset_K.values, f.onset_K.runs, f.onset_dem_K)
    )
    return Claim(
        "A clearance above the largest thermal deformation is never used up: no contact (Fig. 14)",
        f"limit α ΔTmax |AC| = {f.clearance_limit_m * 1e3:.3f} mm; runs that deflect, reduced and DEM: {moved}",
        verdict,
        "the parting of the centres, α ΔT |AC|, ends at the limit",
        f"*{HOLDS}*: no run of either model above the limit deflects or touches, every run below does; "
        f"*{FAILS}*: else",
    )


def _steps_against(t: Trend) -> str:
    return "; ".join(f"{a:g} to {b:g}: p = {p:.1e}" for a, b, p in t.against)


def _trend_text(t: Trend) -> str:
    text = f"Spearman {t.rank_correlation:+.2f}, one-sided p = {t.p:.1e}"
    return text + (f"; against it, {_steps_against(t)}" if t.against else "")


def more_friction_larger_range(f: Findings) -> Claim:
    """The larger μ, the larger the range of θ2."""
    t = trend(f.range_by_friction, rising=True)
    first, *_, last = f.range_by_friction.runs
    chance = _chance(first, last, rising=True)
    why = {
        HOLDS: "friction sets how far AB is carried",
        IN_THE_MEAN: "the scatter of the runs is as large as the effect: one run per μ, as the paper shows, "
                     "can give either order",
        FAILS: "the ensembles do not show it",
    }[t.verdict]
    return Claim(
        "Generally, the larger μ, the larger the range of the deflection angle (Fig. 15)",
        f"range of θ2: {f.range_by_friction.text()}; slope {t.slope * MRAD:+.2f} ± {t.slope_error * MRAD:.2f} mrad "
        f"per unit of μ; {_trend_text(t)}; a run at the largest μ exceeds one at the smallest with a chance of "
        f"{chance:.2f}",
        t.verdict, why, TREND_RULE,
    )


def friction_is_the_reason(f: Findings) -> Claim:
    """Conclusion a: without friction no jump."""
    jump = f.jump_by_friction.absolute()
    free, full = jump.at(0.0), jump.at(f.friction_coefficient)
    ratio = float(np.mean(free) / np.mean(full)) if np.mean(full) > 0 else np.inf
    p = _one_sided_welch(full, free, rising=False)
    verdict = HOLDS if ratio < NEGLIGIBLE else IN_THE_MEAN if p < SIGNIFICANCE else FAILS
    why = {
        HOLDS: "the curves close without friction",
        IN_THE_MEAN: "part of the jump is there without friction: inertia of the links",
        FAILS: "the curves do not close at μ = 0 either: nothing else takes up the energy of the impacts, and the "
               "end of the cycle finds the links in motion. Here the jump is inertia first",
    }[verdict]
    return Claim(
        "Friction is a basic reason for the state jump (conclusion a)",
        f"mean |jump| of θ2 without friction is {ratio:.2f} of that at μ = {f.friction_coefficient:g}: {jump.text()}",
        verdict, why,
        f"*{HOLDS}*: mean |jump| at μ = 0 below {NEGLIGIBLE:g} of that at the case's μ; *{IN_THE_MEAN}*: smaller "
        f"at {SIGNIFICANCE:g} (Welch, one-sided); *{FAILS}*: else",
    )


def spring_reduces_deflection(f: Findings) -> Claim:
    """The deflection falls with K_M."""
    t = trend(f.largest_by_spring, rising=False)
    why = {
        HOLDS: "the spring holds the flare angle",
        IN_THE_MEAN: "the spring holds the flare angle; once near the static value the steps are smaller than the "
                     "scatter",
        FAILS: "the ensembles do not show it",
    }[t.verdict]
    return Claim(
        "The deflection decreases with the torsion spring K_M (Fig. 16)",
        f"largest deflection: {f.largest_by_spring.text()}; K_M in N m/rad; {_trend_text(t)}",
        t.verdict, why, TREND_RULE,
    )


def spring_ends_at_static(f: Findings) -> Claim:
    """... until the static value is reached."""
    statement = "… in a certain range: until the static value is reached (Fig. 16)"
    rule = (
        f"*{HOLDS}*: at the stiffest spring the mean of the largest deflection is within {NEAR_STATIC:g} of the "
        f"static value for rigid links; *{FAILS}*: else"
    )
    if f.static_rigid_rad is None or f.static_rigid_rad == 0:
        return Claim(statement, "no contact at the largest temperature change", UNTESTED,
                     "there is no static deflection", rule)
    means = f.largest_by_spring.mean()
    ratio = float(means[-1] / abs(f.static_rigid_rad))
    elastic = ", ".join(
        f"{value * MRAD:.4f} at {stiffness:g}"
        for stiffness, value in zip(f.largest_by_spring.values, f.static_elastic_rad) if value is not None
    )
    return Claim(
        statement,
        f"static value at ΔTmax, contact without friction, rigid links: {f.static_rigid_rad * MRAD:.4f} mrad "
        f"whatever K_M; elastic links: {elastic} [mrad]; mean of the runs over it: {ratio:.3f} at the stiffest",
        HOLDS if abs(ratio - 1) <= NEAR_STATIC else FAILS,
        "contact at ΔTmax with |d| = c along AC fixes both angles; what is above it is the swing of undamped links, "
        "what elastic links take off grows with K_M",
        rule,
    )


def measure(jump: Groups, without: float, larger: bool) -> str:
    """Verdict on "the measure reduces the jump"; the rule is ``MEASURE_RULE``.

    :param without: value of the parameter without the measure
    :param larger: the measure makes the parameter larger, not smaller
    """
    taken = [runs for value, runs in zip(jump.values, jump.runs) if (value > without) == larger and value != without]
    before = jump.at(without)
    less = [_one_sided_welch(before, runs, rising=False) < SIGNIFICANCE for runs in taken]
    more = [_one_sided_welch(before, runs, rising=True) < SIGNIFICANCE for runs in taken]
    if not taken:
        return UNTESTED
    return HOLDS if all(less) else IN_PART if any(less) and not any(more) else FAILS


MEASURE_RULE = (
    f"*{HOLDS}*: at every value on the side of the measure the mean |jump| is smaller than without it, at "
    f"{SIGNIFICANCE:g} (Welch, one-sided); *{IN_PART}*: at some of them, at none larger; *{FAILS}*: else"
)


def control(f: Findings) -> list[Claim]:
    """Conclusion c, measure by measure: what each does to the jump."""
    measures = (
        ("reducing friction", f.jump_by_friction, f.friction_coefficient, False, "μ",
         "friction takes energy out; without it the speed of the impacts stays and carries the joint farther"),
        ("stiffer components", f.jump_by_stiffness, 1.0, True, "section over that of the case",
         "the play sets the size of the jump, not the stretch of the links, which free impacts strain little"),
        ("torsion springs", f.jump_by_spring, f.jump_by_spring.values[0], True, "K_M in N m/rad",
         "a spring between the links holds the flare angle; both links together can still turn by c/|AC| = "
         f"{f.free_turn_rad * MRAD:.2f} mrad within the play, which it does not feel"),
    )
    claims = []
    for name, jump, without, larger, label, why in measures:
        size = jump.absolute()
        verdict = measure(size, without, larger)
        again = trend(size, rising=not larger).against
        text = "; ".join(f"{a:g} to {b:g}, p = {p:.1e}" for a, b, p in again)
        claims.append(Claim(
            f"The state jump is controlled by {name} (conclusion c)",
            f"|jump| of θ2: {size.text()}; {label}, {without:g} without the measure"
            + (f"; steps against it: {text}" if again else ""),
            verdict, why, MEASURE_RULE,
        ))
    if f.spring_bias_rad == 0:
        claims.append(Claim(
            "The state jump is controlled by pre-stressed springs (conclusion c)",
            "the spring of this case is free at the ideal position, as the paper's: it is not pre-stressed",
            UNTESTED,
            "needs torsion_spring.bias_rad, which makes the path unique",
            f"*{UNTESTED}* unless the case has a bias",
        ))
    return claims


def all_claims(f: Findings) -> list[Claim]:
    """Every statement of the paper's section 4.3, and of its conclusions as far as runs speak to it."""
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


CAPTIONS = (
    ("fig13", "Figure 13: paths of the two centres, and of one relative to the other"),
    ("fig14", "Figure 14: deflection of AB against the clearance"),
    ("fig15", "Figure 15: deflection of AB against the friction coefficient"),
    ("fig16", "Figure 16: deflection of AB against the stiffness of the torsion spring"),
)


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    def line(cells: Sequence[str]) -> str:
        return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"

    return [line(heads), f"|{'---|' * len(heads)}", *map(line, rows)]


def _certainty(f: Findings) -> list[str]:
    a = f.amplification
    if not a.at_end_rad > CHAOTIC * a.start_rad:
        return [f"That is below {CHAOTIC:g} times: single runs of this case can be compared point by point."]
    return [
        f"Beyond {CHAOTIC:g} times a motion is called chaotic here.", "",
        "- Deterministic: everything up to the first contact, and its temperature; the envelope of θ2; the static "
        "value with a spring; the statistics of an ensemble.",
        "- Chaotic: the course of a single run after the first contacts, and its jump. Links that start at rest "
        "ring: where in that ringing the first impact falls decides its speed, so a run can lie far from the mean of "
        f"an ensemble whose starts are spread over {f.start_spread_m * 1e6:g} µm. The paper's figures show single "
        "runs: two codes, even two compilers, draw two such figures.",
    ]


def readme(title: str, command: str, f: Findings) -> str:
    """Text of README.md: verdicts first, then the numbers behind."""
    claims = all_claims(f)
    rules = list(dict.fromkeys(claim.rule for claim in claims))
    a = f.amplification
    lines = [
        f"# {title}: the paper's claims, tested", "",
        f"Made by `{command}`: text and verdicts from the numbers of the run. Figures 13 to 16 of Chen et al. (2021), "
        "DEM and reduced model on the same axes.", "",
        *_table(
            ("statement", "found", "verdict", "why", "rule"),
            [(c.statement, c.found, f"**{c.verdict}**", c.why, str(rules.index(c.rule) + 1)) for c in claims],
        ),
        "", "± is the standard error of the mean. Rules:", "",
        *(f"{number}. {rule}." for number, rule in enumerate(rules, start=1)),
        "", RULES_CHANGED,
        "", "## What is certain and what is chance", "",
        f"Two reduced runs whose AB differs by {a.start_rad:.1e} rad at the start differ by "
        f"{a.at_largest_temperature_rad:.1e} rad at the largest temperature and by {a.at_end_rad:.1e} rad at the end"
        + (f", {a.at_end_rad / a.start_rad:.1e} times as much." if a.start_rad > 0 else "."),
        "", *_certainty(f),
        "", "## First contact", "",
        "The middle columns are of links that follow their expansion from the start (`start.mode = \"matched\"`), so "
        "that they do not ring; the last ones of the figures' single runs.", "",
        *_table(
            ("clearance [mm]", "c/(α |AC|)", "reduced − closed form", "DEM − closed form", "figures: reduced",
             "figures: DEM"),
            [
                (
                    f"{contact.clearance_m * 1e3:g}", _kelvin(contact.closed_form_K),
                    _difference(contact.reduced_K, contact.closed_form_K),
                    _difference(contact.dem_K, contact.closed_form_K),
                    _kelvin(contact.reduced_ringing_K), _kelvin(contact.dem_ringing_K),
                )
                for contact in f.first_contacts
            ],
        ),
        "", "## DEM against reduced model, as ensembles", "",
        f"Kolmogorov-Smirnov for the distribution, Welch's t for the mean, Brown-Forsythe for the spread; "
        f"significance {SIGNIFICANCE:g}; {3 * len(f.tests)} such tests of equal models raise a false alarm with a "
        f"chance of at most {min(1.0, 3 * len(f.tests) * SIGNIFICANCE):.2g}.", "",
        *_table(
            ("quantity", f"reduced, {len(f.end_shift_reduced_m)} runs", f"DEM, {len(f.end_shift_dem_m)} runs",
             "p distribution", "p mean", "p spread", "told apart"),
            [
                (
                    test.quantity,
                    f"{test.reduced_mean * MRAD:.3f}, sd {test.reduced_sd * MRAD:.3f} mrad",
                    f"{test.dem_mean * MRAD:.3f}, sd {test.dem_sd * MRAD:.3f} mrad",
                    f"{test.p_distribution:.2g}", f"{test.p_mean:.2g}", f"{test.p_spread:.2g}",
                    "no" if test.agree else "**yes**",
                )
                for test in f.tests
            ],
        ),
        "", "## Envelope", "",
        "θ2 of every sample against the extremes of θ2 over all places of the journal in the play, rigid links, at "
        "its temperature. The margin, twice the largest depth plus stretch of both links in the single runs, widens "
        "the play.", "",
        *_table(
            ("runs", "number", "largest excess [µrad]", "margin [µm]", "samples beyond the margin"),
            [
                (e.runs, str(e.count), f"{e.largest_excess_rad * 1e6:.2f}", f"{e.margin_m * 1e6:.3f}",
                 str(e.beyond_margin))
                for e in f.envelopes
            ],
        ),
        "", "## Figures", "",
    ]
    for name, caption in CAPTIONS:
        lines += [f"![{caption}]({name}.png)", "", caption + ".", ""]
    lines += [
        "`ensembles.csv`: largest deflection, range, jump and end of every run; `curves.csv`: the curves of the "
        "figures; `ensembles.json`: everything on this page.",
    ]
    return "\n".join(lines) + "\n"


def _difference(value: Optional[float], exact: Optional[float]) -> str:
    if value is None or exact is None:
        return "none" if value is exact is None else "**one has none**"
    return f"{value - exact:+.1e} K"
