# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses in motion with the DEM's penalty contact in explicit steps, ``motion.scheme = "regularised"``."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import statejump as sj

from conftest import REPOSITORY
from failures import Failure, failing, failure

from statejump.core.errors import StatejumpError
from statejump.kinds.truss import generate, stable_steps

SCHEME = {"motion.scheme": "regularised", "motion.masses": "lumped", "reduced.sticking": "elastic"}


def chain(**changes: Any) -> sj.Case:
    made = sj.load(generate.chain(3, friction_force_N=100.0, cycles=1, period_s=0.1))
    return made.changed({"output.samples_per_cycle": 100, **SCHEME, **changes})


def rms(run: sj.Run, other: sj.Run) -> float:
    """Largest root-mean-square difference of a node's displacement, over the largest displacement."""
    apart = np.linalg.norm(run["displacement_m"] - other["displacement_m"], axis=2)
    return float(np.sqrt((apart**2).mean(axis=0)).max() / np.linalg.norm(other["displacement_m"], axis=2).max())


def steps(case: sj.Case, times: float) -> sj.Case:
    """Return the case with so many times the least steps."""
    least = stable_steps.least_steps_per_cycle(case.definition)
    return case.changed({"motion.steps_per_cycle": int(np.ceil(times * least / 100)) * 100})


@pytest.mark.parametrize(("changes", "sentence"), [
    ({"motion.theta": 1.0}, failure("unused_by_scheme", key="motion.theta", value=1.0, scheme="with motion.scheme = 'regularised'")),
    ({"motion.restitution": 0.5}, failure("unused_by_scheme", key="motion.restitution", value=0.5, scheme="with motion.scheme = 'regularised'")),
    ({"motion.displacement_tolerance_m": 1e-6}, failure("unused_by_scheme", key="motion.displacement_tolerance_m", value=1e-06, scheme="with motion.scheme = 'regularised'")),
    ({"motion.masses": "consistent"}, failure("masses_not_lumped", key="motion.masses", value="consistent", scheme="with motion.scheme = 'regularised'")),
    ({"reduced.sticking": "rigid"}, failure("sticking_not_elastic", key="reduced.sticking", value="rigid", scheme="with motion.scheme = 'regularised'")),
    ({"motion.scheme": "regularized"}, failure("misspelt_name", key="motion.scheme", value="regularized", meant="regularised", known="'set_valued' or 'regularised'")),
])
def test_what_the_scheme_does_not_read_is_refused(changes: dict[str, Any], sentence: Failure) -> None:
    with pytest.raises(StatejumpError) as refused:
        chain(**changes)
    assert refused.value == sentence


def test_steps_above_the_stable_one_are_refused() -> None:
    case = chain()
    least = stable_steps.least_steps_per_cycle(case.definition)
    with failing("too_few_steps_of_regularised", key="motion.steps_per_cycle", value=4928, least=4929):
        case.changed({"motion.steps_per_cycle": least - 1}).reduced(dynamic=True)
    run = case.changed({"motion.steps_per_cycle": least}).reduced(dynamic=True)
    assert not any("stiffer" in warning for warning in run.warnings)


@pytest.mark.parametrize(("name", "sentence"), [
    ("latch_lever", failure("regularised_not_supported", joint="latch")),
    ("telescope", failure("regularised_not_supported", joint="S")),
])
def test_a_joint_without_such_a_contact_is_named(name: str, sentence: Failure) -> None:
    case = sj.load(REPOSITORY / f"cases/trusses/{name}.toml").changed({**SCHEME, "motion.steps_per_cycle": 1_000_000})
    with pytest.raises(StatejumpError) as refused:
        case.reduced(dynamic=True)
    assert refused.value == sentence


def test_dem_converges_to_the_chain_in_motion() -> None:
    # The DEM's steps are of first order (at the corner of the program its dashpots see the rate of the step before), so
    # half of its step halves what it is off; Runge and Kutta's own error is a hundredth of that.
    case = chain()
    dem, finer = (case.changed({"dem.time_step_fraction": fraction}).dem() for fraction in (0.1, 0.05))
    coarse, exact = (steps(case, times).reduced(dynamic=True) for times in (1.0, 8.0))
    assert rms(dem, exact) == pytest.approx(2 * rms(finer, exact), rel=0.1)
    assert rms(coarse, exact) < 1.2 * rms(dem, exact)
    heat = exact["friction_dissipation_J"][-1]
    off = [run["friction_dissipation_J"][-1] - heat for run in (dem, finer)]
    assert off[0] == pytest.approx(2 * off[1], rel=0.2)
    assert abs(exact.summary["energy_residue_J"]) < 1e-8 * heat


def test_partial_slip_moves_by_the_law_that_the_dem_names() -> None:
    case = steps(chain(**{"reduced.sticking": "partial_slip", "dem.friction_law": "mindlin_deresiewicz",
                          "thermal.period_s": 5.0}), 1.0)
    run, path = case.reduced(dynamic=True), case.reduced()
    spring = case.changed({"dem.friction_law": "mindlin"}).reduced(dynamic=True)
    # Heated in 5 s inertia is small beside what the two laws differ by: with that of the path it is nearer to it.
    assert rms(run, path) < 0.2 * rms(spring, path)
    heat = path["friction_dissipation_J"][-1]
    assert abs(run["friction_dissipation_J"][-1] - heat) < 0.2 * abs(spring["friction_dissipation_J"][-1] - heat)
    by_sets = case.changed({"motion.scheme": "set_valued", "motion.steps_per_cycle": 20_000}).reduced(dynamic=True)
    assert rms(by_sets, run) < 0.1 * rms(spring, run)
