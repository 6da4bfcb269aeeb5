# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints from loops: forward models, estimates, refusals."""
from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import Failure, failing, failure, note
from loops import JOINT, SIGMA, SINE, measured
import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.core.tables import write_columns
from statejump.identification.fit import Fits
from statejump.identification.hysteresis import remembered
from statejump.identification.loop import read_loop
from statejump.identification.models import MODELS, parts_of


def block_by_block(path: np.ndarray, joint: dict[str, float], block: float = 0.0) -> np.ndarray:
    """Return the force of a slider between rigid stops, step by step; the block moves only as far as necessary."""
    stiffness, spring = joint["stiffness"], joint["preload_stiffness"]
    forces = []
    for there in path:
        centre = (stiffness * there - joint["preload"]) / (stiffness + spring)
        width = joint["friction"] / (stiffness + spring)
        block = min(max(block, centre - width), centre + width)
        forces.append(stiffness * (there - min(max(block, -joint["clearance_minus"]), joint["clearance_plus"])))
    return np.array(forces)


def test_slide_between_stops_is_that_of_small_steps() -> None:
    """A random path with all sequences of slip and stops; the difference is the rounding of some hundred sums."""
    path = np.concatenate([np.linspace(a, b, 40) for a, b in zip(
        *(lambda ends: (ends[:-1], ends[1:]))(np.random.default_rng(3).uniform(-1e-3, 1e-3, 60)))])
    joint = {name: JOINT[name] for name in MODELS["coulomb_clearance_spring"].parameters}
    twice = block_by_block(np.concatenate((path, path)), joint)[len(path):]
    found = MODELS["coulomb_clearance_spring"].answer(joint, path, remembered(path, fresh=False))
    np.testing.assert_allclose(found, twice, rtol=0, atol=1e-9)


def resting(path: np.ndarray, joint: dict[str, float], block: float) -> np.ndarray:
    """Return the force of a slider behind a spring with play, between soft stops, step by step. At every row bisection
    finds the position at which friction holds the block."""
    gap, slack = joint.get("play", 0.0) / 2, 1 - joint.get("play_ratio", 0.0)

    def forces(there: float, at: float) -> tuple[float, float]:
        stretch = there - at
        pull = joint["stiffness"] * (stretch - slack * np.clip(stretch, -gap, gap))
        stop = joint.get("stop_stiffness", 0.0) * (at - np.clip(at, -joint.get("clearance_minus", 1), joint.get(
            "clearance_plus", 1)))
        return pull, pull - joint["preload"] - stop

    found = []
    for there in path:
        for sign in (1.0, -1.0):
            if sign * forces(there, block)[1] > joint["friction"]:
                ends = [block, block + sign]
                for _ in range(60):
                    middle = sum(ends) / 2
                    ends[int(sign * forces(there, middle)[1] <= joint["friction"])] = middle
                block = sum(ends) / 2
        found.append(forces(there, block)[0])
    return np.array(found)


@pytest.mark.parametrize("model", ["coulomb_play", "coulomb_soft_play", "coulomb_soft_stops"])
@pytest.mark.parametrize("start", [-1.0, 0.0, 0.4])
def test_play_and_soft_stops_are_those_of_small_steps(model: str, start: float) -> None:
    """The force agrees with that of small steps for any friction in the first row."""
    path = np.interp(np.linspace(0, 9, 400), np.arange(10), 1e-3 * np.array([0, .2, -.1, .5, -.6, 1, -1, .3, -.2, 1]))
    values = {name: JOINT[name] for name in MODELS[model].parameters} | {"preload": 0.0}
    loop = read_loop({"displacement_m": path, "force_N": path})
    width = values["friction"] / values["stiffness"] + (1 - values.get("play_ratio", 0.0)) * values.get("play", 0.0) / 2
    found = MODELS[model].answer({**values, "initial_friction": start}, path, loop.memory)
    # Bisection to 1 m/2^60 leaves 1e-12 N; rounding of the path times 1e6 N/m is 1e-10 N.
    np.testing.assert_allclose(found, resting(path, values, -start * width), rtol=0, atol=1e-9)


def test_columns_of_other_sensors_are_left_out_by_name(tmp_path: Path, statejump: Callable[..., Any]) -> None:
    loop = measured("coulomb", JOINT)
    write_columns({"Strain 1 [-]": loop["force_N"], **loop}, tmp_path / "rig.csv")
    refused = statejump("identify", "rig.csv", "--model", "coulomb")
    assert refused.status == 2 and refused.failure == failure("no_such_key", key="Strain 1 [-]")
    assert refused.failure == failure("no_such_key", key="Strain 1 [-]")
    taken = statejump("identify", "rig.csv", "--model", "coulomb", "--ignore", "Strain 1 [-]")
    assert taken.status == 0, taken.errors
    assert sj.identify(tmp_path / "rig.csv", model="coulomb", ignored=["Strain 1 [-]"]).values == sj.identify(
        loop, model="coulomb").values
    assert "--ignore = 'Strain 2'" in statejump("identify", "rig.csv", "--ignore", "Strain 2").errors


def test_a_table_of_a_data_logger_is_read(tmp_path: Path, statejump: Callable[..., Any]) -> None:
    """Loggers write times in a column 'Timestamp', and the voltages of sensors beside forces and displacements."""
    loop = measured("coulomb", JOINT)
    times = [f"2025-11-14 19:48:{second // 10:02d}.{second % 10}00000" for second in range(len(loop["force_N"]))]
    rows = ["Timestamp,Force (V),Force (N),Displacement (mm)"] + [
        f"{time},{force / 200!r},{force!r},{1e3 * place!r}"
        for time, force, place in zip(times, loop["force_N"].tolist(), loop["displacement_m"].tolist())]
    (tmp_path / "logger.csv").write_text("\n".join(rows[:600]) + "\n")
    refused = statejump("identify", "logger.csv", "--model", "coulomb")
    assert refused.failure == failure("column_of_other_unit", column="Force (V)", unit="V")
    assert "--ignore 'Force (V)' leaves it out" in refused.errors
    taken = statejump("identify", "logger.csv", "--model", "coulomb", "--ignore", "Force (V)")
    assert taken.status == 0, taken.errors


def test_a_table_without_a_header_has_names_of_the_user(tmp_path: Path, statejump: Callable[..., Any]) -> None:
    loop = measured("coulomb", JOINT)
    rows = [f"{1e3 * place!r} {force!r}" for place, force in zip(loop["displacement_m"].tolist(), loop["force_N"].tolist())]
    (tmp_path / "loop.out").write_text("\n".join(rows) + "\n")
    assert "--columns names them" in statejump("identify", "loop.out").errors
    found = sj.identify(tmp_path / "loop.out", model="coulomb", columns=["disp [mm]", "force_N"])
    assert len(found.loop.force) == len(rows)
    assert found.values["friction"] == pytest.approx(sj.identify(loop, model="coulomb").values["friction"], rel=1e-9)
    assert statejump("identify", "loop.out", "--model", "coulomb", "--columns", "disp [mm], force_N").status == 0
    short = statejump("identify", "loop.out", "--columns", "disp [mm],force_N,time_s")
    assert short.failure == failure("row_of_other_length", cells=2, width=3, line=1)
    (tmp_path / "named.out").write_text("\"Actuator Displacment\" \"Actuator Force\"\nmm N\n" + "\n".join(rows) + "\n")
    assert "--columns gives other names" in statejump("identify", "named.out").errors
    named = sj.identify(tmp_path / "named.out", model="coulomb", columns=["disp [mm]", "force_N"])
    assert named.values == found.values


def test_a_slide_may_slip_before_its_play_is_used_up() -> None:
    """A play of 1 mm has a stiffness of 0.5 kN/mm, so a friction of 150 N is reached after 0.3 mm of it."""
    path = 1e-3 * np.sin(np.linspace(0, 4 * np.pi, 400))
    values = {"stiffness": 1e6, "friction": 150.0, "preload": 0.0, "play": 1e-3, "play_ratio": 0.5}
    found = MODELS["coulomb_soft_play"].answer(values, path, remembered(path, fresh=True))
    # Bisection to 1 m/2^60 leaves 1e-12 N; rounding of the path times 1e6 N/m is 1e-10 N.
    np.testing.assert_allclose(found, resting(path, values, 0.0), rtol=0, atol=1e-9)


def test_a_play_that_is_not_empty_is_wider_than_an_empty_one() -> None:
    """A soft play transmits 0.2 of the stiffness. Between forward and backward slip it has the same displacement as an
    empty play of 0.8 of its width, which a case can represent."""
    found = sj.identify(measured("coulomb_soft_play", JOINT), start="cycled")
    assert found.model == "coulomb_soft_play"
    play = found.intervals["play"]
    # 3 standard deviations; the interval covers 1.96 of them.
    assert abs(found.values["play"] - 4e-4) < 1.5 * (play.high - play.low) / 2
    assert found.changes()["joint.play_m"] == pytest.approx(found.values["play"] * (1 - found.values["play_ratio"]), rel=1e-12)
    assert note("play_carries_no_force") in found.notes


@pytest.mark.parametrize("fresh", [True, False])
def test_partial_slip_is_that_of_the_kernel(fresh: bool) -> None:
    """The kernel's load history and Masing's rule share no code; the path has closed nested loops."""
    contact = dict(effective_young_modulus_Pa=38.5e9, effective_shear_modulus_Pa=7.9e9, effective_radius_m=0.01,
                   friction_coefficient=0.3)
    corners = 1e-7 * np.array([0, 3, -1, 2, -1, 2, -2, 4, -5, 5, 0, 7, -7])  # gross slip from 5.7 on
    path = np.interp(np.linspace(0, len(corners) - 1, 600), np.arange(len(corners)), corners)
    gone = path if fresh else np.concatenate((path, path))
    answer = sj.laws.drive("mindlin_deresiewicz", {"slide_m": gone, "normal_force_N": np.full(len(gone), 10.0)},
                           **contact)
    radius = (3 * 10.0 * 0.01 / (4 * 38.5e9)) ** (1 / 3)
    values = {"friction": 3.0, "stiffness": 8 * 7.9e9 * radius, "preload": 0.0}
    found = MODELS["mindlin"].answer(values, path, remembered(path, fresh))
    # The kernel solves for the slide of a force to 1e-12 of the limit.
    np.testing.assert_allclose(found, answer["tangential_force_N"][-len(path):], rtol=0, atol=3e-10)


def test_iwan_joint_is_a_sum_of_its_sliders() -> None:
    """Sliders of equal stiffness at 4000 midpoints of the Iwan density, and one slider at its end. The error of their
    sum is of order 1/4000²."""
    friction, stiffness, chi, beta = 300.0, 1e6, -0.5, 1.0
    last = friction * (1 + beta) / (stiffness * (beta + (chi + 1) / (chi + 2)))
    share = ((np.arange(4000) + 0.5) / 4000) ** (1 / (chi + 1))  # equal stiffness each
    slide = np.append(last * share, last)
    springs = stiffness / (1 + beta) * np.append(np.full(4000, 1 / 4000), beta)
    carried, bent = [], np.zeros(4001)
    path = np.concatenate((SINE, SINE))
    for before, now in zip(np.append(0.0, path[:-1]), path):
        bent = np.clip(bent + now - before, -slide, slide)
        carried.append(springs @ bent)
    values = {"friction": friction, "stiffness": stiffness, "iwan_exponent": chi, "iwan_ratio": beta, "preload": 0.0}
    found = MODELS["iwan"].answer(values, SINE, remembered(SINE, fresh=False))
    np.testing.assert_allclose(found, carried[len(SINE):], rtol=0, atol=1e-4 * friction)


@pytest.mark.parametrize("model", list(MODELS))
def test_every_joint_is_known_again(model: str) -> None:
    """BIC selects the correct joint among all models. Parameters are within 4 standard deviations, which chance exceeds
    once in 16 000."""
    known = {**JOINT, "friction": 300.0, "iwan_exponent": -0.5, "iwan_ratio": 1.0}
    if model in ("coulomb_clearance", "coulomb_soft_stops", "coulomb_soft_stops_spring"):
        known["friction"] = 150.0
    values = {name: known[name] for name in MODELS[model].parameters}
    found = sj.identify(measured(model, values), start="cycled")
    assert found.model == model
    for name, value in values.items():
        interval = found.intervals[name]
        assert interval.bounded
        assert abs(found.values[name] - value) < 4 * (interval.high - interval.low) / (2 * 1.96), name
    assert found.fit.noise == pytest.approx(SIGMA, rel=4 / np.sqrt(2 * len(SINE)))


def test_loop_that_never_slides_says_so() -> None:
    found = sj.identify(measured("coulomb", {"stiffness": 1e6, "friction": 3e3, "preload": 0.0}), start="cycled")
    assert found.model == "linear"
    limit = found.limits["friction"][1].low
    assert note("not_identifiable", parameter="friction", reason="never_slides", joint="coulomb", low=limit) in found.notes
    assert 900 < found.limits["friction"][1].low < 1000 and found.limits["friction"][1].high == np.inf
    assert "friction" not in found.joint().replace("# friction", "#")


def test_loop_that_meets_no_stop_says_so() -> None:
    wide = {"stiffness": 1e6, "friction": 150.0, "preload": 20.0, "clearance_minus": 2e-3, "clearance_plus": 2e-3}
    found = sj.identify(measured("coulomb_clearance", wide), start="cycled")
    assert found.model == "coulomb"
    for name in ("clearance_minus", "clearance_plus"):  # the block moves 1e-3 - 150/1e6 each way, plus or minus 20/1e6
        assert 8e-4 < found.limits[name][1].low < 9e-4 and found.limits[name][1].high == np.inf
        assert note("not_identifiable", parameter=name, reason="no_stop") in found.notes
    forced = sj.identify(measured("coulomb_clearance", wide), start="cycled", model="coulomb_clearance",
                         normal_force_N=500)
    assert not forced.intervals["clearance_plus"].bounded
    assert "# clearance_plus_m = ?  # not identifiable" in forced.joint()
    assert set(forced.distributions()) == {"joint.friction_coefficient", "joint.preload_force_N"}


def test_gap_without_friction_bounds_it() -> None:
    found = sj.identify(measured("clearance", {name: JOINT[name] for name in MODELS["clearance"].parameters}),
                        start="cycled")
    assert found.model == "clearance" and -np.inf == found.limits["friction"][1].low
    assert found.limits["friction"][1].high < SIGMA / 2


def test_partial_slip_extrapolates_and_says_so() -> None:
    found = sj.identify(measured("mindlin", {"stiffness": 1e6, "friction": 1300.0, "preload": 0.0}), start="cycled")
    assert note("friction_extrapolated") in found.notes


@pytest.mark.parametrize("amplitude", [np.linspace(0.05, 1, 401), np.linspace(1, 0.05, 401)], ids=["growing", "shrinking"])
def test_growing_and_shrinking_cycles_are_used_whole(amplitude: np.ndarray) -> None:
    """The cycles begin at rest, as in test standards. The fit does not use this, so it also determines the friction of
    the first row."""
    path = 1.5e-3 * amplitude * np.sin(np.linspace(0, 14 * np.pi, 401))
    joint = {name: JOINT[name] for name in MODELS["coulomb_spring"].parameters} | {"preload": 0.0}
    loop = read_loop({"displacement_m": path, "force_N": path}, "fresh")
    force = MODELS["coulomb_spring"].answer(joint, path, loop.memory) + np.random.default_rng(2).normal(0, SIGMA, 401)
    found = sj.identify({"displacement_m": path, "force_N": force})
    assert found.model == "coulomb_spring" and found.fit.rows == 401
    assert abs(found.values["initial_friction"]) < 0.2
    for name in ("friction", "preload_stiffness", "stiffness"):
        assert found.intervals[name].low < joint[name] < found.intervals[name].high


def test_no_joint_fits_worse_than_one_that_it_contains() -> None:
    """A stiff joint slips nearly all the time; a search that starts with stops would not remove them by itself."""
    fits = Fits(read_loop(measured("coulomb", {"stiffness": 1e7, "friction": 100.0, "preload": 0.0}), "fresh"))
    for model in MODELS.values():
        for part in parts_of(model.name):
            assert fits.fit(model.name).squares <= fits.fit(part).squares * (1 + 1e-6), (model.name, part)


def test_intervals_have_a_width_and_clearances_are_not_negative() -> None:
    found = sj.identify(measured("coulomb", {"stiffness": 1e6, "friction": 300.0, "preload": 0.0}), start="cycled",
                        model="coulomb_clearance_spring")
    assert all(interval.high > interval.low for interval in found.intervals.values())
    assert found.values["clearance_minus"] >= 0 and found.values["clearance_plus"] >= 0


def test_parameter_at_the_end_of_its_range_takes_others_along() -> None:
    """Partial slip of a hundred sliders: as the Iwan exponent χ approaches -1, the sticking stiffness grows without
    bound."""
    loop = measured("iwan", {"stiffness": 1e9, "friction": 300.0, "iwan_exponent": -0.995, "iwan_ratio": 1e-3,
                             "preload": 0.0})
    found = sj.identify(loop, start="cycled", model="iwan")
    assert not found.intervals["iwan_exponent"].bounded and not found.intervals["stiffness"].bounded
    assert note("not_identifiable", parameter="stiffness", depends_on="iwan_exponent") in found.notes
    assert "stiffness" not in found.changes()


def test_misfit_that_every_cycle_repeats_is_no_evidence() -> None:
    """Friction that grows along the path is in no joint model; the fit must not report stops instead."""
    path = 1e-3 * np.sin(np.linspace(0, 40 * np.pi, 2001))
    loop = read_loop({"displacement_m": path, "force_N": path}, "cycled")
    force = MODELS["coulomb"].answer({"stiffness": 1e6, "friction": 100.0, "preload": 0.0}, path, loop.memory)
    force = force * (1 + 60 * path) + np.random.default_rng(3).normal(0, 1, 2001)
    found = sj.identify({"displacement_m": path, "force_N": force}, start="cycled",
                        model=["coulomb", "coulomb_clearance", "coulomb_soft_stops"])
    assert found.model == "coulomb" and found.fit.independent_rows < 100
    assert note("residuals_correlated", rows=2001, independent=found.fit.independent_rows) in found.notes


def test_reversed_sign_is_refused() -> None:
    loop = measured("coulomb", {"stiffness": 1e6, "friction": 300.0, "preload": 0.0})
    loop["force_N"] *= -1
    with failing("loop_gives_energy", energy_J=0.8489160897045946, force="force"):
        sj.identify(loop)


def test_what_is_found_goes_into_a_case_and_a_campaign() -> None:
    found = sj.identify(measured("coulomb_clearance_spring", JOINT), start="cycled", normal_force_N=500)
    case = sj.load("table1").changed(found.changes())
    assert case["joint.preload_force_N"] == found.values["preload"]
    assert found.distributions()["joint.preload_force_N"]["distribution"] == "normal"
    assert case["joint.friction_coefficient"] == found.values["friction"] / 500
    assert case["joint.clearance_plus_m"] == found.values["clearance_plus"]
    section = tomllib.loads(found.joint())["joint"]
    assert sj.load(case.to_dict() | {"joint": section})["joint.normal_force_N"] == 500
    drawn = sj.montecarlo(case, found.distributions(), samples=20).frame()
    assert drawn["joint.friction_coefficient"].mean() == pytest.approx(0.3, rel=0.05)


def test_moment_over_rotation() -> None:
    columns = measured("coulomb_spring", {name: JOINT[name] for name in MODELS["coulomb_spring"].parameters})
    turned = {"rotation_rad": columns["displacement_m"] * 100, "moment_N_m": columns["force_N"] / 100}
    found = sj.identify(turned, start="cycled", normal_force_N=100, journal_radius_m=5e-3)
    assert found.changes()["joint.friction_coefficient"] == pytest.approx(1.5 / (100 * 5e-3), rel=0.05)
    spring = sj.identify(turned, start="cycled", target="torsion_spring")
    assert spring.changes()["torsion_spring.*.stiffness_N_m_per_rad"] == pytest.approx(20.0, rel=0.05)
    assert spring.changes()["torsion_spring.*.bias_rad"] == pytest.approx(-0.2 / 20, rel=0.3)
    assert found.frame()["unit"].tolist() == ["N m/rad", "N m", "N m", "N m/rad"]


GOOD = {"displacement_m": SINE, "force_N": SINE * 1e6}


@pytest.mark.parametrize("columns, options, sentence", [
    ({"displacment_m": SINE, "force_N": SINE}, {}, failure("misspelt_key", key="displacment_m", meant="displacement_m")),
    (GOOD | {"force_N": -SINE * 1e6}, {}, failure("loop_falls", force="force", displacement="displacement")),
    ({"force_N": SINE}, {}, failure("partner_missing", key="displacement_m", partner="force_N")),
    ({"time_s": SINE}, {}, failure("loop_columns_missing", key="displacement_m")),
    (GOOD | {"moment_N_m": SINE}, {}, failure("loop_of_two_kinds", key="moment_N_m", other="displacement_m")),
    (GOOD | {"force_N": np.append(SINE[:-1], np.nan)}, {}, failure("not_finite", item="row 401", key="force_N", value=float("nan"))),
    (GOOD | {"force_N": SINE[1:]}, {}, failure("columns_of_other_length")),
    (GOOD | {"force_N": np.array(["x"] * 401)}, {}, failure("column_no_numbers", key="force_N")),
    (GOOD | {"force_N": SINE * 0}, {}, failure("loop_constant", key="force_N", value=0.0)),
    ({"displacement_m": SINE[:9], "force_N": SINE[:9]}, {"start": "fresh"},
     failure("too_few_rows", rows=9, fewest=20)),
    (GOOD, {"model": "coulom"}, failure("model_unknown", key="model", value="coulom", auto="auto")),
    (GOOD, {"start": "cold"}, failure("not_one_of", key="start", value="cold", known="unknown, fresh, cycled")),
    (GOOD, {"confidence": 1.0}, failure("out_of_range", key="confidence", value=1.0)),
    (GOOD, {"normal_force_N": 0.0}, failure("not_positive", key="normal_force_N", value=0.0, unit="N")),
    (GOOD, {"target": "torsion_spring"}, failure("target_of_rotation", key="target", value="torsion_spring")),
    (GOOD, {"target": "hinge"}, failure("not_one_of", key="target", value="hinge")),
])
def test_what_is_refused(columns: dict[str, Any], options: dict[str, Any], sentence: Failure) -> None:
    with pytest.raises(StatejumpError) as refused:
        sj.identify(columns, **options)
    assert refused.value == sentence


def test_command(statejump: Callable[..., Any], tmp_path: Path) -> None:
    values = {name: JOINT[name] for name in MODELS["coulomb_clearance"].parameters}
    write_columns(measured("coulomb_clearance", values), tmp_path / "hinge.csv")
    done = statejump("identify", "hinge.csv", "--start", "cycled", "--normal-force", "500")
    assert done.status == 0, done.errors
    folder = tmp_path / "results" / "identify_hinge"
    assert {path.name for path in folder.iterdir()} == {
        "parameters.csv", "models.csv", "fit.csv", "joint.toml", "vary.toml", "loop.png", "loop.svg"}
    section = tomllib.loads((folder / "joint.toml").read_text())["joint"]
    assert section["normal_force_N"] == 500 and section["clearance_plus_m"] == pytest.approx(5e-4, rel=0.01)
    keys = [table["key"] for table in tomllib.loads((folder / "vary.toml").read_text())["vary"]]
    assert keys == ["joint.friction_coefficient", "joint.clearance_minus_m", "joint.clearance_plus_m",
                    "joint.preload_force_N"]
    assert "coulomb_clearance" in done.output and "\nfriction_coefficient = 0." in done.output


@pytest.mark.parametrize("arguments, sentence", [
    (("none.csv",), failure("read_failed", file="none.csv")),
    (("hinge.csv", "--model", "x"), failure("model_unknown", key="--model", value="x", auto="auto")),
    (("hinge.csv", "--normal-force", "-1"), failure("not_positive", key="--normal-force", value=-1.0, unit="N")),
    (("ragged.csv",), failure("row_of_other_length", line=3, cells=1, width=2, file="ragged.csv")),
])
def test_command_refuses(statejump: Callable[..., Any], tmp_path: Path, arguments: tuple[str, ...], sentence: Failure
                         ) -> None:
    write_columns(GOOD, tmp_path / "hinge.csv")
    (tmp_path / "ragged.csv").write_text("displacement_m,force_N\n1,2\n3\n")
    done = statejump("identify", *arguments)
    assert done.status == 2 and done.failure == sentence, done.errors
    assert not list(tmp_path.glob("results/*/*"))
