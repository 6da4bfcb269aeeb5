# SPDX-License-Identifier: GPL-3.0-or-later
"""Groups of runs, and statistical tests: trends, effect of a measure, comparison of two ensembles."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

SIGNIFICANCE = 0.01
HOLDS, IN_THE_MEAN, IN_PART = "holds", "holds in the mean", "holds in part"
FAILS, UNTESTED = "does not hold", "not tested"
NEARLY_EVERY_RUN = 0.95  # probability that a run at the next value lies on the claimed side
MRAD = 1e3


@dataclass(frozen=True)
class Groups:
    """Values of one quantity in all runs, grouped by the value of the varied parameter."""

    values: tuple[float, ...]  # rising
    runs: tuple[np.ndarray, ...]

    def mean(self) -> np.ndarray:
        """Mean at every value."""
        return np.array([np.mean(group) for group in self.runs])

    def standard_error(self) -> np.ndarray:
        """Standard error of the mean at every parameter value; 0 for a single run."""
        return np.array(
            [np.std(group, ddof=1) / np.sqrt(len(group)) if len(group) > 1 else 0.0 for group in self.runs]
        )

    def at(self, value: float) -> np.ndarray:
        """Runs at a value."""
        return self.runs[self.values.index(value)]

    def absolute(self) -> Groups:
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
    """Trend of a quantity over a parameter, compared with a claimed direction."""

    verdict: str
    rank_correlation: float  # Spearman's, of all runs
    p: float  # one-sided, of the claimed direction
    slope: float  # least squares
    slope_error: float
    against: tuple[tuple[float, float, float], ...]  # significant steps against the claim: from, to, p
    least_chance: float  # smallest probability over the steps that a run at the next value lies on the claimed side


def one_sided_welch(first: np.ndarray, second: np.ndarray, rising: bool) -> float:
    """Return the p-value of "the second mean is above (rising) or below (falling) the first"; 1 if variances are zero.
    """
    if np.ptp(first) == 0 and np.ptp(second) == 0:
        step = np.mean(second) - np.mean(first)
        return 0.0 if (step > 0 if rising else step < 0) else 1.0
    side = "greater" if rising else "less"
    p = stats.ttest_ind(second, first, equal_var=False, alternative=side).pvalue
    return 1.0 if np.isnan(p) else float(p)


def chance(first: np.ndarray, second: np.ndarray, rising: bool) -> float:
    """Return the probability that a run of the second group differs from a run of the first in the claimed direction.
    """
    difference = second[:, None] - first[None, :]
    return float(np.mean(difference > 0 if rising else difference < 0))


def trend(groups: Groups, rising: bool) -> Trend:
    """Return the verdict on "the quantity rises (falls) with the parameter"; the rule is ``TREND_RULE``."""
    abscissa = np.concatenate([np.full(len(runs), value) for value, runs in zip(groups.values, groups.runs)])
    ordinate = np.concatenate(groups.runs)
    if np.ptp(ordinate) == 0 or np.ptp(abscissa) == 0:
        return Trend(FAILS, 0.0, 1.0, 0.0, 0.0, (), 0.0)
    rank = stats.spearmanr(abscissa, ordinate, alternative="greater" if rising else "less")
    line = stats.linregress(abscissa, ordinate)
    steps = list(zip(groups.values, groups.runs, groups.values[1:], groups.runs[1:]))
    against = tuple(
        (from_, to, p)
        for from_, first, to, second in steps
        if (p := one_sided_welch(first, second, not rising)) < SIGNIFICANCE
    )
    least = min((chance(first, second, rising) for _, first, _, second in steps), default=0.0)
    if least >= NEARLY_EVERY_RUN:
        verdict = HOLDS
    elif rank.pvalue < SIGNIFICANCE and not against:
        verdict = IN_THE_MEAN
    else:
        verdict = FAILS
    return Trend(verdict, float(rank.correlation), float(rank.pvalue), line.slope, line.stderr, against, least)


TREND_RULE = (
    f"*{HOLDS}*: at every step of the parameter a run of the next value lies on the claimed side with a "
    f"probability of at least {NEARLY_EVERY_RUN:g}; *{IN_THE_MEAN}*: otherwise, if Spearman's rank test of all runs "
    f"gives the claimed direction at {SIGNIFICANCE:g} and no step of the means goes the other way at "
    f"{SIGNIFICANCE:g} (Welch); *{FAILS}*: otherwise"
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
    """Test whether two ensembles may have the same distribution. With too few runs the test gives NaN; it becomes p =
    1."""

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
