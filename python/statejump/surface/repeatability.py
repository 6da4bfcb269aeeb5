# SPDX-License-Identifier: GPL-3.0-or-later
"""Repeatability of a structure as hardware specifications state it: µm per metre at a quantile of all samples."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import binom

from statejump.core.errors import NotAllowed, StatejumpError


@dataclass(frozen=True)
class Repeatability:
    """A quantile of sampled changes of a length, divided by a reference length.

    :param um_per_m: the quantile [µm/m]
    :param low: lower end of its confidence interval (order statistics, for any distribution)
    :param high: upper end; infinite if there are too few samples
    :param share: fraction of the samples below the quantile
    :param samples: number of samples
    """

    um_per_m: float
    low: float
    high: float
    share: float
    samples: int


def repeatability(change_m: Any, length_m: float, share: float = 0.99, confidence: float = 0.95) -> Repeatability:
    """Return the repeatability of a structure from the changes of a length over many cycles.

    :param change_m: change of the length in each sample [m]; signs are ignored, failed samples (NaN) are omitted
    :param length_m: reference length, such as the diameter of the aperture [m]
    :raises StatejumpError: there is no sample, or the length or a fraction is invalid
    """
    if not 0 < length_m < np.inf:
        raise NotAllowed("length_m", length_m, code="not_positive", unit="m")
    for key, value in (("share", share), ("confidence", confidence)):
        if not 0 < value < 1:
            raise NotAllowed(key, value, code="not_a_fraction")
    found = np.abs(np.asarray(change_m, dtype=float))
    found = np.sort(found[np.isfinite(found)]) / length_m * 1e6
    if not len(found):
        raise StatejumpError(code="samples_without_value")
    count, tail = len(found), (1 - confidence) / 2
    first, last = int(binom.ppf(tail, count, share)), int(binom.ppf(1 - tail, count, share))
    return Repeatability(float(np.quantile(found, share)), float(found[max(first - 1, 0)]),
                         float(found[last]) if last < count else np.inf, share, count)
