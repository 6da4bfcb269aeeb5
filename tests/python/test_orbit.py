# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperatures over an orbit: differential equation, closed forms, and the file for cases."""
from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Callable

import numpy as np
import pytest
from conftest import REPOSITORY, Outcome
from failures import failure

import statejump as sj
from statejump import orbit

SHADOW = [(1800.0, 3900.0)]
BARS = [orbit.Member("sun", 0.3, 0.8, 0.318, 2500.0), orbit.Member("shade", 0.9, 0.1, 0.05, 40_000.0)]


def test_the_equation_holds_between_all_times() -> None:
    found = orbit.temperatures(BARS, period_s=5400.0, shadow_s=SHADOW, samples_per_orbit=500, sink_K=100.0)
    lit = (found.time_s[1:] <= SHADOW[0][0]) | (found.time_s[:-1] >= SHADOW[0][1])
    for member, values in zip(BARS, found.temperature_K.T):
        middle = (values[1:] + values[:-1]) / 2
        sun = member.absorptivity * member.sun_view * orbit.SOLAR_CONSTANT_W_PER_M2 * lit
        loss = member.emissivity * orbit.STEFAN_BOLTZMANN_W_PER_M2_K4 * (middle**4 - 100.0**4)
        rate = (sun - loss) / member.heat_capacity_J_per_m2_K
        # The midpoint rule is second order in a step of 11 s over time constants of at least 300 s.
        assert np.diff(values) / np.diff(found.time_s) == pytest.approx(rate, rel=2e-3, abs=1e-6)
        assert values[0] == values[-1]


def test_in_the_dark_the_cube_of_the_temperature_falls_as_its_closed_form_says() -> None:
    found = orbit.temperatures(BARS[:1], period_s=5400.0, shadow_s=SHADOW, sink_K=0.0)
    dark = (found.time_s >= SHADOW[0][0]) & (found.time_s <= SHADOW[0][1])
    time_s, values = found.time_s[dark], found.temperature_K[dark, 0]
    passed = (values**-3 - values[0]**-3) * 2500.0 / (3 * 0.8 * orbit.STEFAN_BOLTZMANN_W_PER_M2_K4)
    assert passed == pytest.approx(time_s - time_s[0], rel=1e-9, abs=1e-6)


def test_without_shadow_sunlight_and_radiation_are_equal() -> None:
    found = orbit.temperatures(BARS[:1], period_s=100.0, sink_K=0.0)
    sun = 0.3 * 0.318 * orbit.SOLAR_CONSTANT_W_PER_M2
    assert found.temperature_K == pytest.approx((sun / (0.8 * orbit.STEFAN_BOLTZMANN_W_PER_M2_K4)) ** 0.25, rel=1e-12)


def test_straight_lines_between_the_times_that_are_kept_are_near_enough() -> None:
    every = orbit.temperatures(BARS, period_s=5400.0, shadow_s=SHADOW, samples_per_orbit=500, orbits=2)
    for within in (5.0, 0.5):
        some = orbit.temperatures(BARS, period_s=5400.0, shadow_s=SHADOW, samples_per_orbit=500, orbits=2,
                                  within_K=within)
        missed = [np.abs(np.interp(every.time_s, some.time_s, ours) - theirs).max()
                  for ours, theirs in zip(some.temperature_K.T, every.temperature_K.T)]
        assert 0.2 * within < max(missed) <= within
        assert len(some.time_s) < 20 / within**0.5 * 2 and set(SHADOW[0]) <= set(some.time_s)


def test_a_case_takes_the_file(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "members.csv").write_text(
        "name,absorptivity,emissivity,sun_view,heat_capacity_J_per_m2_K\nsun,0.3,0.8,0.318,2500\n")
    told = statejump("orbit", "members.csv", "--period", 5400, "--shadow", "1800:3900", "--orbits", 2, "-o", "orbit.csv")
    assert told.status == 0, told.errors
    data = tomllib.loads((REPOSITORY / "cases/table1.toml").read_text())
    data["thermal"] = {"shape": "table", "table_file": str(tmp_path / "orbit.csv"), "reference_temperature_K": 293.15,
                       "lead_in_s": 600.0}
    case = sj.load(data)
    assert case.definition.ending.time_s == 2 * 5400.0 + 600.0 and case.reduced().complete


HEAD = "name,absorptivity,emissivity,sun_view,heat_capacity_J_per_m2_K\n"
WRONG = {
    "column": (HEAD.replace("emissivity", "emission"), [], failure("misspelt_key", key="emission", meant="emissivity", file="members.csv")),
    "cells": (HEAD + "a,1,1,1\n", [], failure("row_of_other_length", line=2, cells=4, width=5, file="members.csv")),
    "number": (HEAD + "a,1,1,x,1\n", [], failure("bad_cell", line=2, column="'sun_view'", file="members.csv")),
    "NaN": (HEAD + "a,1,nan,1,1\n", [], failure("bad_cell", line=2, column="'emissivity'", file="members.csv")),
    "range": (HEAD + "a,1.5,1,1,1\n", [], failure("out_of_range", item="member 'a'", key="absorptivity", value=1.5)),
    "names": (HEAD + "a,1,1,1,1\na,1,1,1,1\n", [], failure("wrong_number_of_members", key="members", most=10000)),
    "empty": (HEAD, [], failure("wrong_number_of_members", key="members", most=10000)),
    "shadow": (HEAD + "a,1,1,1,9\n", ["--shadow", "5:3"], failure("shadow_times", key="shadow_s", value=[[5.0, 3.0]], period_s=100.0)),
    "no shadow": (HEAD + "a,1,1,1,9\n", ["--shadow", "x"], failure("bad_shadow_option", key="--shadow", value="x")),
    "sink": (HEAD + "a,1,1,1,9\n", ["--sink", "nan"], failure("number_not_finite", key="sink_K", value=float("nan"), range="between 0 and 10000 [K]")),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_one_sentence(what: str, tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    text, more, sentence = WRONG[what]
    (tmp_path / "members.csv").write_text(text)
    told = statejump("orbit", "members.csv", "--period", 100, "-o", "orbit.csv", *more)
    assert told.status == 2 and told.errors.count("\n") == 1 and told.failure == sentence
    assert not (tmp_path / "orbit.csv").exists()
