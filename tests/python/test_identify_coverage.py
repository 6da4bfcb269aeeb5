# SPDX-License-Identifier: GPL-3.0-or-later
"""Confidence intervals of identified joints: how often they contain the true values, over repetitions with new noise.
"""
from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from loops import JOINT, measured
import statejump as sj
from statejump.identification.fit import Fits, intervals
from statejump.identification.loop import read_loop
from statejump.identification.models import MODELS


def test_intervals_cover() -> None:
    """20 repetitions of six intervals at 95 %: 114 of 120 should contain the true value, sd 2.4 (4 with correlation).
    Intervals of half the width would contain 81. docs/validation/identification.md has 500 repetitions of each joint.
    """
    inside = 0
    for seed in range(20):
        found = sj.identify(measured("coulomb_clearance_spring", JOINT, seed=seed), start="cycled",
                            model="coulomb_clearance_spring")
        inside += sum(found.intervals[name].low <= value <= found.intervals[name].high
                      for name, value in JOINT.items() if name in found.intervals)
    assert 114 - 4 * 4 < inside <= 120


def correlated(count: int, correlation: float, seed: int) -> np.ndarray:
    """Return noise of variance 1 whose neighbours are correlated."""
    drawn = np.random.default_rng(seed).normal(size=count + 500)
    return np.asarray(lfilter([np.sqrt(1 - correlation**2)], [1, -correlation], drawn)[500:])


def test_intervals_cover_with_correlated_noise() -> None:
    """20 repetitions of four intervals at 95 %: 76 of 80 should contain the true value, sd 2. If 600 rows with a noise
    correlation of 0.9 counted as independent, intervals would be a fourth as wide and contain half of the values."""
    path = 1e-3 * np.sin(np.linspace(0, 8 * np.pi, 600))
    joint = {name: JOINT[name] for name in MODELS["coulomb_play"].parameters}
    loop = read_loop({"displacement_m": path, "force_N": path}, "cycled")
    force, inside = MODELS["coulomb_play"].answer(joint, path, loop.memory), 0
    for seed in range(20):
        fits = Fits(read_loop({"displacement_m": path, "force_N": force + 3 * correlated(600, 0.9, seed)}, "cycled"))
        found = intervals(fits, "coulomb_play", 0.95)[1].of
        inside += sum(found[name].low <= value <= found[name].high for name, value in joint.items())
    assert 76 - 4 * 2 < inside <= 80
