# SPDX-License-Identifier: GPL-3.0-or-later
"""Failures of runs in YADE name the joint of the case, for every kind of case and every type of joint or element.

To cause failures that a case file cannot cause, tests change the input of YADE.
"""
from __future__ import annotations

import copy
import re
import sys
from typing import Any, Callable

import pytest

from conftest import REPOSITORY
from statejump.core import yade_process as dem
from statejump.core.errors import FailedRun
from statejump.kinds.loading import load_case

sys.path.insert(0, str(REPOSITORY / "yade_scripts" / "runner"))
import failures  # noqa: E402 - needs no YADE

Values = dict[str, Any]


def resolved(name: str) -> Values:
    case = load_case(REPOSITORY / "cases" / f"{name}.toml")
    return {"scene": case.behaviour.scene_module(), **case.behaviour.dem_input(case)}


@pytest.fixture(scope="module")
def values() -> Callable[[str], Values]:
    """Return a function that returns the input of YADE for a case; every case is resolved once."""
    known: dict[str, Values] = {}

    def of(name: str) -> Values:
        if name not in known:
            known[name] = resolved(name)
        return copy.deepcopy(known[name])

    return of


def coarse(found: Values) -> None:
    """One step per sample, far above every stable step."""
    times = found["dem"]["number_of_steps"] / found["number_of_samples"]
    found["dem"]["number_of_steps"] = found["number_of_samples"]
    found["dem"]["time_step_s"] *= times
    found["dem"]["time_step_fraction"] = times * found["dem"].get("time_step_fraction", 0.1)


def stiff_spring(found: Values) -> None:
    found["spring"]["stiffness_N_per_m"][-1] *= 1e9


def stiff_torsion_spring(found: Values) -> None:
    found["torsion_spring"]["stiffness_N_m_per_rad"][0] *= 1e9


def stiff_latch(found: Values) -> None:
    found["latch_hinge"]["friction_stiffness_N_m_per_rad"][0] *= 1e9


def stiff_slider(found: Values) -> None:
    found["slider"]["friction_stiffness_N_per_m"][0] *= 1e9


def above_the_floor(found: Values) -> None:
    found["slider"]["depth_m"][3] = -1e-6


def floors_everywhere(found: Values) -> None:
    """Put all pads into one contact group, on floors that extend below the neighbouring pads."""
    count = len(found["slider"]["names"])
    found["slider"].update(group=[0] * count, reach_m=[2.0] * count, pad_radius_m=[0.7] * count)


SET_STEP = r"set dem\.(time_step_s|steps_per_cycle|time_step_fraction) to (\S+) or (less|more), stable in this state"
STEP = "time_step_unstable"
# What is changed, the joint, reason and part, the remedy.
FAILURES: dict[str, tuple[str, Callable[[Values], None], str | None, tuple[str, str], str]] = {
    "floor": ("table1", coarse, "floor", (STEP, "floor"), SET_STEP),
    "link": ("umbrella_damped", coarse, None, (STEP, "link_ab"), SET_STEP),
    "slider": ("trusses/chain_10", coarse, "S1", (STEP, "the floor of slider 'S1'"), SET_STEP),
    "revolute": ("trusses/umbrella_rib", coarse, "joint", (STEP, "revolute 'joint'"), SET_STEP),
    "spring": ("trusses/umbrella_8", stiff_spring, None, (STEP, "spring 'cable8'"), SET_STEP),
    "torsion spring": ("trusses/umbrella_rib", stiff_torsion_spring, None, (STEP, "torsion_spring 'spring'"), SET_STEP),
    "latch hinge": ("trusses/latch_lever", stiff_latch, "latch", (STEP, "latch_hinge 'latch'"), SET_STEP),
    "slider between nodes": ("trusses/telescope", stiff_slider, "S", (STEP, "slider 'S'"), SET_STEP),
    "lost": ("trusses/chain_10", above_the_floor, "S4", ("contact_lost", ""), ""),
    "strangers": ("trusses/chain_10", floors_everywhere, "S1", ("foreign_contact", ""), ""),
}


@pytest.mark.parametrize("name", FAILURES)
def test_failure_names_what_the_case_names(name: str, values: Callable[[str], Values]) -> None:
    case, change, joint, reason, remedy = FAILURES[name]
    found = values(case)
    change(found)
    with pytest.raises(FailedRun) as caught:
        dem.execute(found, lambda fraction: None)
    failure = caught.value.fields()
    message = failure["message"]
    assert message.startswith(f"case {found['case']['name']}: ")
    assert (caught.value.details["reason"], caught.value.details["part"]) == reason
    assert not re.search(r"\bbod(y|ies)\b", message)
    assert failure.get("joint") == joint
    # All of them fail in the first step, at the start of every program.
    assert (failure["time_s"], failure["temperature_change_K"]) == (0, 0)
    assert "(" not in failure["cause"] and f": {failure['cause']} (" in message
    assert re.fullmatch(remedy, failure.get("remedy", ""))
    if remedy == SET_STEP:
        key, number, _ = re.fullmatch(remedy, failure["remedy"]).groups()
        step = {
            "time_step_s": float(number),
            "steps_per_cycle": found.get("period_s", 0) / float(number),
            "time_step_fraction": float(number) / found["dem"].get("time_step_fraction", 1) * found["dem"]["time_step_s"],
        }[key]
        # The step is stable for the failed part; the whole scene may require a smaller one.
        assert step <= float(re.search(r", (\S+) s$", failure["cause"])[1])


def test_remedy_of_a_step_helps(values: Callable[[str], Values]) -> None:
    found = values("umbrella_damped")
    coarse(found)
    with pytest.raises(FailedRun) as caught:
        dem.execute(found, lambda fraction: None)
    steps = int(re.fullmatch(SET_STEP, caught.value.fields()["remedy"])[2])
    found["dem"].update(number_of_steps=steps, time_step_s=found["period_s"] / steps)
    assert len(dem.execute(found, lambda fraction: None).columns["time_s"]) == found["number_of_samples"] + 1


def test_number_that_is_none(values: Callable[[str], Values]) -> None:
    # Checks of case files prevent these values; the engine is the last check.
    nan = float("nan")
    for name, section, key, quantity, part, joint in (
        ("table1", "joint", "friction_coefficient", "ThermalFrictMat.frictionAngle", "the slider", None),
        ("table1", "dem", "tip_mass_kg", "mass", "the slider", None),
        ("umbrella_damped", "joint", "friction_coefficient", "ThermalFrictMat.frictionAngle", "the bearing of joint_b",
         "joint_b"),
    ):
        found = values(name)
        found[section][key] = nan
        with pytest.raises(FailedRun) as caught:
            dem.execute(found, lambda fraction: None)
        failure = caught.value.fields()
        assert failure["details"] == {"reason": "not_allowed", "part": part, "quantity": quantity}, failure
        assert failure.get("joint") == joint
        assert (failure["time_s"], failure["temperature_change_K"], failure["exit_status"]) == (0, 0, 2)
        assert "\n" not in failure["message"] and "Traceback" not in failure["message"]


TAKEN = {"part": "contact", "bodies": (7, 4), "before": "too deep", "after": "", "time": 1.5, "stable_time_step": None,
         "code": "too_deep", "quantity": "depth"}
FIELDS = {"time_s": 1.5, "temperature_change_K": 15.0, "reason": "too_deep", "quantity": "depth"}


def described(taken: Values | None, stable_s: float = 1e-5, error: Exception | None = None) -> dict[str, Any]:
    names = failures.Names({failures.pair(4, 7): ("J", "revolute 'J'")}, {failures.pair(1, 2): "link 'AB'"})
    return failures.described(
        error or RuntimeError("as YADE hands it on"), taken, names, 2.0, lambda time_s: 10 * time_s, lambda: stable_s,
        lambda stable: f"set dem.time_step_s to {stable:g}",
    )


def test_failure_keeps_its_own_time() -> None:
    # The contact fails in one step, and the engine that reports it may act in the next.
    for bodies in (7, 4), (4, 7):
        assert described({**TAKEN, "bodies": bodies}) == {
            **FIELDS, "joint": "J", "place": "revolute 'J'", "part": "revolute 'J'", "cause": "too deep"}


def test_failure_of_a_link_names_it_in_its_sentence() -> None:
    taken = {**TAKEN, "part": "link", "bodies": (2, 1), "before": "", "after": " leaves"}
    assert described(taken) == {**FIELDS, "part": "link 'AB'", "cause": "link 'AB' leaves"}


def test_failure_of_a_body_or_of_the_scene() -> None:
    taken = {**TAKEN, "part": "body", "bodies": (4,), "before": "mass: ", "after": " is nan"}
    assert described(taken) == {**FIELDS, "joint": "J", "part": "body 4", "cause": "mass: body 4 is nan"}
    taken = {**TAKEN, "part": "scene", "bodies": (), "before": "O.dt is 0 s"}
    assert described(taken) == {**FIELDS, "cause": "O.dt is 0 s"}


def test_what_is_not_the_plugins_gets_the_time_of_the_scene() -> None:
    assert described(None, error=RuntimeError("no\n engine")) == {
        "time_s": 2.0, "temperature_change_K": 20.0, "cause": "no engine"}


def test_unknown_bodies_keep_their_numbers() -> None:
    found = described({**TAKEN, "bodies": (1, 4)})
    assert found["place"] == "bodies 1 and 4" and "joint" not in found


@pytest.mark.parametrize("stable_s, wanted", [(1e-5, 1e-5), (5e-5, 2e-5), (float("nan"), 2e-5), (0.0, 2e-5)])
def test_remedy_is_the_smaller_step(stable_s: float, wanted: float) -> None:
    found = described({**TAKEN, "stable_time_step": 2e-5}, stable_s=stable_s)
    assert found["remedy"] == f"set dem.time_step_s to {wanted:g}"


@pytest.mark.parametrize("value, wanted", [(2.199e-5, 2.1e-5), (0.0022, 0.0022), (9.99e-6, 9.9e-6), (1.0, 1.0)])
def test_rounded_down(value: float, wanted: float) -> None:
    assert failures.rounded_down(value) == wanted
