# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong between several keys of a case: every check just within and just beyond, and what cases calculate."""
from __future__ import annotations

import copy
import tomllib
from math import atan, atan2, hypot, nextafter, pi
from typing import Any

import pytest

from conftest import REPOSITORY
from statejump import _engine
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.spring_slider import stable_step
from statejump.kinds.statics.case import read_forces
from statejump.kinds.truss import generate

DOCUMENTS: dict[str, dict[str, Any]] = {}


def document(name: str, changes: dict[str, Any]) -> dict[str, Any]:
    """A case file that comes with the program, or what a list of changes by ``section.key`` makes of it."""
    if name not in DOCUMENTS:
        DOCUMENTS[name] = tomllib.loads((REPOSITORY / "cases" / f"{name}.toml").read_text(encoding="utf-8"))
    found = copy.deepcopy(DOCUMENTS[name])
    for path, value in changes.items():
        section, _, key = path.partition(".")
        if not key:
            found[section] = value
        elif value is None:
            del found[section][key]
        else:
            found.setdefault(section, {})[key] = value
    return found


def made(name: str, **changes: Any) -> Any:
    """A case with changes by ``section__key``."""
    return parse_case(document(name, {path.replace("__", "."): value for path, value in changes.items()}))


def refused(name: str, **changes: Any) -> str:
    with pytest.raises(StatejumpError) as found:
        made(name, **changes)
    return str(found.value)


TABLE = {"shape": "table", "table_time_s": [0, 1, 2, 3, 4], "table_temperature_change_K": [0, -50, 0, 100, 0]}


# A bar on a slider.
def test_a_bar_on_a_slider() -> None:
    case = made("table1", joint__pad_thermal_expansion_per_K=2e-5, joint__slot_thermal_expansion_per_K=1e-5,
                joint__clearance_plus_m=2e-3, thermal=TABLE)
    assert case.thermal_expansion_per_K == 23.4e-6 and case.samples_per_cycle == 2000 and case.friction_force_N == 30
    assert case.temperature_range_K == (-50, 100) == case.turning_changes_K
    assert case.thermal_strain(-50) == pytest.approx(-50 * 23.4e-6) and case.bar_program is case.thermal
    # The stop is at pad and clearance with the slot's coefficient, the pad grows by its own.
    for side, start in ((1, 2e-3), (-1, 1e-3)):
        assert case.clearance_m(side, 30.0) == pytest.approx(start + 30 * (1e-5 * (0.05 + start) - 2e-5 * 0.05), rel=1e-12)


def test_a_bar_whose_coefficient_follows_the_temperature() -> None:
    rows, alpha = [-100.0, -50.0, 0.0, 100.0, 200.0], [-1e-5, 1e-5, 3e-5, -1e-5, 2e-5]
    changes = {"link__thermal_expansion_per_K": None, "thermal": TABLE}
    case = made("table1", **changes, expansion={"temperature_change_K": rows, "thermal_expansion_per_K": alpha})
    assert case.thermal_expansion_per_K == 3e-5
    assert case.turning_changes_K == pytest.approx((-50, 75, 100))  # of zeros at -75, 75 and 133 that within
    assert case.thermal_strain(100) == pytest.approx(1e-3) and case.thermal_strain(-50) == pytest.approx(-1e-3)
    assert case.bar_program is not case.thermal
    # Zeros at the ends of the program are there once.
    ends = made("table1", **changes, expansion={"temperature_change_K": [-50, 0, 100], "thermal_expansion_per_K": [0, 1e-5, 0]})
    assert ends.turning_changes_K == (-50, 100)
    assert refused("table1", link__thermal_expansion_per_K=None) == (
        "link.thermal_expansion_per_K is missing: a number [1/K], or a section [expansion], is needed")
    table = {"temperature_change_K": [0, 200], "thermal_expansion_per_K": [1e-5, 2e-5]}
    assert refused("table1", expansion=table) == "link.thermal_expansion_per_K = 2.34e-05 is not allowed: only without [expansion]"
    short = {"temperature_change_K": [-10, 200], "thermal_expansion_per_K": [1e-5, 2e-5]}
    assert refused("table1", **changes, expansion=short).startswith(
        "expansion.temperature_change_K = [-10.0, 200.0] is not allowed: it must hold the temperature change of -50 K")
    assert refused("table1", **changes, expansion={**short, "temperature_change_K": [10, 200]}).startswith(
        "expansion.temperature_change_K = [10.0, 200.0] is not allowed: must be at least two")
    # 1 + strain is 0 at the end of this one.
    cold = {"shape": "table", "table_time_s": [0, 1, 2], "table_temperature_change_K": [0, -2000, 0]}
    table = {"temperature_change_K": [-2000, 0], "thermal_expansion_per_K": [5e-4, 5e-4]}
    assert refused("table1", link__thermal_expansion_per_K=None, thermal=cold, expansion=table) == (
        "expansion.thermal_expansion_per_K = [0.0005, 0.0005] is not allowed: the link has no length left at a temperature "
        "change of -2000 K")
    table["thermal_expansion_per_K"] = [4.9e-4, 4.9e-4]
    made("table1", link__thermal_expansion_per_K=None, thermal=cold, expansion=table)


def test_checks_of_a_bar_on_a_slider() -> None:
    for key in ("clearance_minus_m", "clearance_plus_m"):
        # The pad grows by 100 K · 1e-4 · 0.05 m = 5e-4 m, the other stop stands off.
        grows = {"joint__pad_thermal_expansion_per_K": 1e-4, f"joint__{key}": 5e-4}
        assert refused("table1", **grows) == (
            f"joint.{key} = 0.0005 is not allowed: the expansion of pad and slot closes it at a temperature change of 100 K, "
            "it must stay above 0 [m] within the program")
        made("table1", **{**grows, f"joint__{key}": 5.1e-4})
        # The slot shrinks in the cold.
        shrinks = {"joint__slot_thermal_expansion_per_K": 4e-4, f"joint__{key}": 9e-4, "thermal": TABLE}
        assert "at a temperature change of -50 K" in refused("table1", **shrinks)
    assert refused("table1", joint__clearance_minus_m=0.5) == (
        "joint.clearance_minus_m = 0.5 is not allowed: must be below link.stress_free_length_m = 0.5 [m]")
    made("table1", joint__clearance_minus_m=0.4999)
    made("table1", joint__clearance_plus_m=0.6)
    # E A is 630 000 N.
    assert refused("table1", joint__normal_force_N=630e3, joint__friction_coefficient=1.0) == (
        "joint.friction_coefficient = 1.0 is not allowed: the friction force 630000 N must be below E A = 630000 N")
    made("table1", joint__normal_force_N=629e3, joint__friction_coefficient=1.0)
    for preload in (629970.0, -629970.0):
        assert refused("table1", joint__preload_force_N=preload) == (
            f"joint.preload_force_N = {preload} is not allowed: its size and the friction force 30 N must stay below "
            "E A = 630000 N")
    made("table1", joint__preload_force_N=629969.0)
    made("table1", joint__preload_force_N=-629969.0)
    stable = stable_step.stable_time_step(made("table1"))
    assert made("table1", dem__time_step_s=stable).dem_settings.time_step_s == stable
    assert "must be above 0 and at most the stable time step" in refused("table1", dem__time_step_s=nextafter(stable, 1))
    # A link that heating or cooling leaves no length.
    cold = {"shape": "table", "table_time_s": [0, 1, 2], "table_temperature_change_K": [0, -1000, 0]}
    assert "no length left" in refused("table1", link__thermal_expansion_per_K=1e-3, thermal=cold)
    made("table1", link__thermal_expansion_per_K=9.9e-4, thermal=cold)


# One rib of the umbrella.
def test_geometry_of_a_rib() -> None:
    rib = made("umbrella_damped", torsion_spring={"stiffness_N_m_per_rad": 1.0, "bias_rad": 0.1},
               joint__journal_thermal_expansion_per_K=2e-5, joint__bearing_thermal_expansion_per_K=3e-5,
               link_bc__thermal_expansion_per_K=1e-5)
    x, y = rib.ideal_position_m
    assert y > 0 and hypot(x, y) == pytest.approx(0.05) and hypot(x - 0.12, y) == pytest.approx(0.1)
    assert rib.theta2_rad == pytest.approx(atan2(y, x)) and rib.theta4_rad == pytest.approx(atan2(y, x - 0.12))
    assert rib.flare_angle_rad == rib.theta4_rad - rib.theta2_rad
    assert rib.free_flare_angle_rad == pytest.approx(rib.flare_angle_rad + 0.1)
    assert rib.bearing_radius_m == pytest.approx(5.1e-3)
    assert rib.clearance_m(50) == pytest.approx(5.1e-3 * (1 + 50 * 3e-5) - 5e-3 * (1 + 50 * 2e-5))
    assert rib.link_lengths_m(100) == pytest.approx((0.05 * (1 + 23.75e-4), 0.1 * 1.001))
    assert rib.samples_per_cycle == 2000 and rib.is_reproducible
    for key in ("axial_damping_ratio", "pin_damping_N_m_s_per_rad"):
        assert not made("umbrella_damped", **{f"damping__{key}": 0.0}).is_reproducible
    # Each side with its own material.
    soft = made("umbrella_damped", link_ab__young_modulus_Pa=10e9, link_ab__poisson_ratio=0.4)
    assert soft.effective_young_modulus_Pa == pytest.approx(1 / ((1 - 0.16) / 10e9 + (1 - 0.09) / 70e9))


LINE_LAW = "johnson"  # a contact of lines
STILL = {"link_ab__thermal_expansion_per_K": 0.0, "link_bc__thermal_expansion_per_K": 0.0}
COLD = {"shape": "table", "table_time_s": [0, 1, 2], "table_temperature_change_K": [0, -1000, 0]}


def test_checks_of_the_geometry_of_a_rib() -> None:
    # Links of 1/2 and 1/4 m, whose sum and difference are exact.
    ends = {**STILL, "link_ab__stress_free_length_m": 0.5, "link_bc__stress_free_length_m": 0.25}
    for frame in (0.25, 0.75, 0.2, 0.8):
        assert refused("umbrella_damped", **ends, frame__length_m=frame) == (
            f"frame.length_m = {frame} is not allowed: must be above 0.25 and below 0.75 [m], or the links cannot meet at a "
            "temperature change of 0 K")
    for frame in (nextafter(0.25, 1), nextafter(0.75, 0)):
        made("umbrella_damped", **ends, frame__length_m=frame)
    # Too short in the cold alone.
    assert "at a temperature change of -1000 K" in refused(
        "umbrella_damped", **{**ends, "link_ab__thermal_expansion_per_K": 1e-4}, frame__length_m=0.72, thermal=COLD)
    for link in ("link_ab", "link_bc"):
        assert refused("umbrella_damped", **{f"{link}__thermal_expansion_per_K": 1e-3}, thermal=COLD).startswith(
            f"{link}.thermal_expansion_per_K = 0.001 is not allowed: the link has no length left")
    flare = made("umbrella_damped").flare_angle_rad
    for bias in (-flare, pi - flare):
        outside = nextafter(bias, bias * 2)
        assert refused("umbrella_damped", torsion_spring={"stiffness_N_m_per_rad": 1.0, "bias_rad": outside}).startswith(
            f"torsion_spring.bias_rad = {outside!r} is not allowed: must be above {-flare:.9g} and below {pi - flare:.9g} [rad]")
        made("umbrella_damped", torsion_spring={"stiffness_N_m_per_rad": 1.0, "bias_rad": bias * (1 - 1e-9)})
    assert "torsion_spring.bias_rad" in refused("umbrella_damped", torsion_spring={"bias_rad": -flare})  # free at 0


def test_checks_of_the_joint_of_a_rib() -> None:
    assert refused("umbrella_damped", joint__journal_radius_m=100.0, joint__radial_clearance_m=1e-20).startswith(
        "joint.radial_clearance_m = 1e-20 is not allowed: too small beside joint.journal_radius_m = 100.0 [m]")
    both = {"joint__journal_thermal_expansion_per_K": 5e-4, "joint__bearing_thermal_expansion_per_K": 5e-4}
    made("umbrella_damped", **both, **STILL, thermal=COLD)
    for part in ("journal", "bearing"):
        assert refused("umbrella_damped", **{**both, f"joint__{part}_thermal_expansion_per_K": 1e-3}, **STILL, thermal=COLD) == (
            f"joint.{part}_thermal_expansion_per_K = 0.001 is not allowed: the {part} has no radius left at a temperature "
            "change of -1000 K")
        made("umbrella_damped", **{f"joint__{part}_thermal_expansion_per_K": -1e-5 if part == "journal" else 1e-5}, **STILL)
        assert refused("umbrella_damped", **{f"joint__{part}_thermal_expansion_per_K": 5e-4 if part == "journal" else -5e-4},
                       **STILL).startswith("joint.radial_clearance_m = 0.0001 is not allowed: the expansion of journal and bearing")
    speeds = {"joint__friction_v0_m_per_s": 1e-3, "joint__friction_v1_m_per_s": 1e-3}
    assert refused("umbrella_damped", **speeds) == (
        "joint.friction_v1_m_per_s = 0.001 is not allowed: must be above joint.friction_v0_m_per_s = 0.001 [m/s]")
    made("umbrella_damped", **{**speeds, "joint__friction_v1_m_per_s": 1.1e-3})
    # Only a law that knows no restitution of its own takes none.
    refusing = {"joint__dissipation_law": "flores", "joint__restitution": 0.0}
    assert refused("umbrella_damped", **refusing) == (
        "joint.restitution = 0.0 is not allowed with joint.dissipation_law = 'flores': must be above 0 [-]")
    made("umbrella_damped", **{**refusing, "joint__dissipation_law": "exact_restitution"})
    made("umbrella_damped", **{**refusing, "joint__restitution": 0.1})
    slips = {"joint__friction_law": "mindlin_deresiewicz"}
    made("umbrella_damped", **slips)
    message = refused("umbrella_damped", **slips, joint__normal_law=LINE_LAW)
    assert message.startswith(f"joint.normal_law = '{LINE_LAW}' is not allowed with joint.friction_law = 'mindlin_deresiewicz': "
                              "must be one of ")
    made("umbrella_damped", joint__normal_law=LINE_LAW)


def test_a_law_that_cannot_be_used(monkeypatch: pytest.MonkeyPatch) -> None:
    for kind, key in (("normal", "normal_law"), ("dissipation", "dissipation_law"), ("friction", "friction_law"),
                      ("tangential_velocity", "tangential_velocity")):
        monkeypatch.setattr(_engine, "law_problem", lambda asked, name: "it is of another version" if asked == kind else "")
        assert refused("umbrella_damped") == (
            f"joint.{key} = {DOCUMENTS['umbrella_damped']['joint'][key]!r} is not allowed: it is of another version")


def test_checks_of_the_start_of_a_rib() -> None:
    assert refused("umbrella_damped", start__contact_angle_rad=0.1) == (
        "start.contact_angle_rad = 0.1 is not allowed: only with start.mode = 'loaded'")
    made("umbrella_damped", start__eccentricity_m=1e-4, start__eccentricity_angle_rad=1.0)
    assert refused("umbrella_damped", start__eccentricity_m=1.01e-4).startswith(
        "start.eccentricity_m = 0.000101 is not allowed: must be between 0 and joint.radial_clearance_m = 0.0001 [m]")
    made("umbrella_damped", ensemble__start_spread_m=1e-4)
    assert refused("umbrella_damped", ensemble__start_spread_m=1.01e-4) == (
        "ensemble.start_spread_m = 0.000101 is not allowed: must be above 0 and at most joint.radial_clearance_m = 0.0001 [m]")
    spring = {"stiffness_N_m_per_rad": 1.0, "bias_rad": 0.05}
    largest = atan(0.3)
    for angle in (0.0, largest, -largest):
        made("umbrella_damped", start={"mode": "loaded", "contact_angle_rad": angle}, torsion_spring=spring)
    for angle in (1.001 * largest, -1.001 * largest):
        assert refused("umbrella_damped", start={"mode": "loaded", "contact_angle_rad": angle}, torsion_spring=spring).endswith(
            f"must be between {-largest:.9g} and {largest:.9g} [rad], atan of joint.friction_coefficient")
    assert refused("umbrella_damped", start={"mode": "loaded", "contact_angle_rad": 0.1}, torsion_spring=spring,
                   joint__friction_law="ambrosio").endswith("must be 0 [rad]: this friction holds no static load")
    made("umbrella_damped", start={"mode": "loaded"}, torsion_spring=spring, joint__friction_law="ambrosio")
    for key in ("eccentricity_m", "eccentricity_angle_rad"):
        for value in (1e-5, 1.0)[key == "eccentricity_angle_rad":]:
            assert refused("umbrella_damped", start={"mode": "loaded", key: value}, torsion_spring=spring) == (
                f"start.{key} = {value} is not allowed with start.mode = 'loaded': equilibrium decides")
    for key in ("stiffness_N_m_per_rad", "bias_rad"):
        assert refused("umbrella_damped", start={"mode": "loaded"}, torsion_spring={**spring, key: 0.0}) == (
            f"start.mode = 'loaded' is not allowed: torsion_spring.{key} is 0, and only a biased torsion spring loads the joint")


def test_checks_of_the_steps_of_a_rib() -> None:
    assert refused("umbrella_damped", reduced={"method": "adaptive"}) == (
        "reduced.method = 'adaptive' is not allowed with joint.friction_law = 'mindlin': friction with memory is not smooth, "
        "use 'rk4'")
    made("umbrella_damped", reduced={"method": "adaptive"}, joint__friction_law="ambrosio")
    for path in ("reduced.steps_per_cycle", "dem.steps_per_cycle", "ensemble.reduced_steps_per_cycle",
                 "ensemble.dem_steps_per_cycle"):
        key = path.replace(".", "__")
        assert refused("umbrella_damped", **{key: 3001}) == (
            f"{path} = 3001 is not allowed: must be a multiple of output.samples_per_cycle = 2000")
        made("umbrella_damped", **{key: 2000})


# Where a loaded joint can rest.
def test_forces_and_their_temperatures() -> None:
    case = made("statics_lobed", force=[
        {"force_N": [1, 2, 0], "force_rate_N_per_K": [0.5, -1, 0], "temperature_change_K": [0, 10]},
        {"name": "wind", "force_N": [3, 0, 0]}, {"force_N": [0, 4, 0]}])
    assert [(load.name, load.force_N) for load in case.load_cases] == [
        ("F1, ΔT = 0 K", (1, 2, 0)), ("F1, ΔT = 10 K", (6, -8, 0)), ("wind", (3, 0, 0)), ("F3", (0, 4, 0))]
    ball = made("statics_ball", force=[
        {"force_N": [1, 2, 3], "force_rate_N_per_K": [0, 0, -1], "temperature_change_K": [4]}])
    assert ball.load_cases[0].force_N == (1, 2, -1)
    assert [made(f"statics_{kind}").is_planar for kind in ("slot", "journal", "lobed", "ball", "cylinder")] == [
        True, True, True, False, False]
    assert made("statics_lobed", force={"force_N": [1, 0, 0]}).force[0].name is None  # one table


RATE = {"force_N": [1, 0, 0], "force_rate_N_per_K": [1, 0, 0], "temperature_change_K": [1]}


@pytest.mark.parametrize("force, why", [
    (3, "force = 3 is not allowed: must be one or more sections [[force]] with force_N = [x, y, z]"),
    ([], "force = [] is not allowed: must be one or more sections [[force]] with force_N = [x, y, z]"),
    ([RATE, 3], "must be one or more sections [[force]] with force_N = [x, y, z]"),
    ([RATE, {"forc_N": 1}], "force 2: forc_N is unknown: did you mean force_N?"),
    ([{"name": "a"}], "force 1: force_N is missing: must be a list of three numbers [N], none beyond 1e+12"),
    ([{"force_N": [1, 2]}], "force 1: force_N = [1, 2] is not allowed: must be a list of three numbers [N], none beyond 1e+12"),
    ([{"force_N": [1, 2, 2e12]}], "force 1: force_N = [1, 2, 2000000000000.0] is not allowed: must be a list of three numbers [N]"),
    ([RATE, {**RATE, "name": ""}], "force 2: name = '' is not allowed: must be a text in quotes"),
    ([{**RATE, "force_rate_N_per_K": None}], "force 1: force_rate_N_per_K = None is not allowed: must be a list of three numbers "
     "[N/K] together with temperature_change_K"),
    ([{**RATE, "temperature_change_K": None}], "force 1: temperature_change_K = None is not allowed: must be a list of numbers "
     "between -10000 and 10000 [K] together with force_rate_N_per_K"),
    ([{**RATE, "temperature_change_K": []}], "force 1: temperature_change_K = [] is not allowed: must be a list of numbers"),
])
def test_forces_that_are_refused(force: Any, why: str) -> None:
    with pytest.raises(StatejumpError) as found:
        read_forces("force", force)
    assert why in str(found.value)


def test_checks_of_a_rest() -> None:
    keys = {"slot": ("clearance_m",), "journal": ("clearance_m",), "ball": ("clearance_m",),
            "cylinder": ("clearance_m", "axial_play_m"), "lobed": ("clearance_m", "lobes", "lobe_amplitude_m")}
    for kind, needed in keys.items():
        for key in needed:
            assert refused(f"statics_{kind}", **{f"joint__{key}": None}) == (
                f"joint.{key} is missing: joint.type = '{kind}' needs it")
        for key, value in (("axial_play_m", 1e-4), ("lobes", 3), ("lobe_amplitude_m", 1e-5), ("mesh_file", "a.stl"),
                           ("mesh_unit_m", 1.0)):
            if key not in needed:
                assert refused(f"statics_{kind}", **{f"joint__{key}": value}).startswith(
                    f"joint.{key} = {value!r} is not allowed: only with joint.type = ")
    assert refused("statics_lobed", joint__lobe_amplitude_m=1e-4) == (
        "joint.lobe_amplitude_m = 0.0001 is not allowed: must be at least 0 and below joint.clearance_m = 0.0001 [m]")
    made("statics_lobed", joint__lobe_amplitude_m=0.99e-4)
    made("statics_lobed", joint__lobe_amplitude_m=0.0)
    assert refused("statics_ball", picture={"friction_coefficients": [0.1]}) == (
        "picture.friction_coefficients is not allowed: only for joints in one or two dimensions")
    made("statics_ball", picture={"friction_coefficients": []})
    many = {**RATE, "temperature_change_K": list(range(256))}
    made("statics_ball", force=[many])
    assert refused("statics_ball", force=[many, {"force_N": [1, 0, 0]}]) == "force stands for 257 forces: must be at most 256"
    for kind in ("lobed", "ball"):
        assert refused(f"statics_{kind}", force=[{**RATE, "temperature_change_K": [0, -1]}]) == (
            "force 'F1, ΔT = -1 K' = [0, 0, 0] is not allowed: without a force every position is at rest")
    for kind in ("lobed", "journal"):
        assert refused(f"statics_{kind}", force=[{"name": "up", "force_N": [1, 0, 0.5]}]) == (
            f"force 'up' = [1.0, 0.0, 0.5] is not allowed: joint.type = '{kind}' is planar, the third number must be 0; 'cylinder' "
            "takes axial forces")
    for kind in ("cylinder", "ball", "slot"):
        made(f"statics_{kind}", force=[{"force_N": [1, 0, 0.5]}])
    made("statics_ball", force=[{"force_N": [0.5, 0, 0]}])


# Trusses.
def truss(**changes: Any) -> Any:
    return parse_case({**generate.chain(3), **changes})


def truss_refused(**changes: Any) -> str:
    with pytest.raises(StatejumpError) as found:
        truss(**changes)
    return str(found.value)


def test_programs_of_a_truss() -> None:
    chain = generate.chain(3)
    thermal = {"shape": "triangle", "temperature_change_max_K": 10, "cycles": 2, "period_s": 3.0}
    own = [{"name": "sun", "shape": "sine", "temperature_change_max_K": 20},
           {"name": "shade", "shape": "triangle", "temperature_change_max_K": 5, "cycles": 3, "period_s": 2.0}]
    case = truss(thermal=thermal, program=own)
    assert [(one.shape, one.cycles, one.period_s) for one in case.programs] == [
        ("triangle", 2, 3), ("sine", 2, 3), ("triangle", 3, 2)]
    assert case.programs[0] is case.thermal and case.thermal.repeated(5).cycles == 5 and case.samples_per_cycle == 200
    assert case.resolve() is case.resolve()
    assert truss_refused(thermal=thermal, program=[{**own[1], "cycles": 4}]) == (
        "program 'shade': period_s = 2.0 is not allowed: 4 cycles of it last 8 s and must last 6 s, as thermal.cycles of "
        "thermal.period_s do")
    # Durations that are the same but for 1e-9 are the same.
    truss(thermal=thermal, program=[{**own[1], "period_s": 2.0 * (1 + 0.9e-9)}])
    assert "must last 6 s" in truss_refused(thermal=thermal, program=[{**own[1], "period_s": 2.0 * (1 - 1.1e-9)}])
    assert truss_refused(program=[{"name": "sun", "shape": "triangle"}]).startswith(
        "program 'sun': temperature_change_max_K is missing")
    assert truss_refused(expansion=[{"name": "soft", "temperature_change_K": [0], "thermal_expansion_per_K": [1e-5]}]).startswith(
        "expansion 'soft': temperature_change_K = [0.0] is not allowed")
    assert chain == generate.chain(3)


def test_checks_of_a_truss() -> None:
    chain = generate.chain(3)
    for section in ("node", "link", "slider"):
        twice = copy.deepcopy(chain[section])
        twice[2]["name"] = twice[0]["name"]
        assert truss_refused(**{section: twice}) == (
            f"{section} 3: name = {twice[0]['name']!r} is not allowed: another {section} has it")
    theta = {"theta": 0.6, "displacement_tolerance_m": 1e-6}
    assert truss_refused(motion=theta) == (
        "motion.theta = 0.6 is not allowed: it is of equal steps, which motion.displacement_tolerance_m has not")
    truss(motion={**theta, "theta": 0.5})
    truss(motion={"theta": 0.6})
    assert truss_refused(tables={"node": "a.csv"}).startswith("section [tables] is not allowed: only where")
    node = copy.deepcopy(chain["node"])
    for key, value, why in (
        ("position_m", [0.0, 0.0, 0.0], "must be 2 numbers [m], as truss.dimension is 2"),
        ("guide_normal", [0.0, 0.0], "must not be zero in every direction"),
        ("guide_normal", [1.0], "must be 2 numbers [-], as truss.dimension is 2"),
        ("force_N", [1.0, 0.0, 0.0], "must be 2 numbers [N], as truss.dimension is 2"),
        ("fixed", ["z"], "a planar truss has 'x' and 'y' only"),
    ):
        wrong = [*node[:-1], {**node[-1], key: value}]
        assert truss_refused(node=wrong) == f"node {node[-1]['name']!r}: {key} = {value} is not allowed: {why}"
    truss(node=[*node[:-1], {**node[-1], "force_N": [0.0, 0.0]}])
    names = [one["name"] for one in node]
    for axis in ([0.0, 0.0], [1.0, 0.0, 0.0]):
        assert truss_refused(reflector={"nodes": names, "axis": axis}) == (
            f"reflector.axis = {axis} is not allowed: must be 2 numbers, not zero in every direction")
    assert [node.fixed for node in made("trusses/ball_tripod").node if "z" in node.fixed]  # in space
    for section in ("node", "truss", "thermal"):
        with pytest.raises(StatejumpError, match="is missing$") as missing:
            parse_case({name: part for name, part in chain.items() if name != section})
        assert str(missing.value) == f"section {'[[node]]' if section == 'node' else f'[{section}]'} is missing"
    spring = {"name": "S", "links": [chain["link"][0]["name"]], "stiffness_N_m_per_rad": 1.0, "axis": [0, 0, 1]}
    assert truss_refused(torsion_spring=[spring]) == (
        "torsion_spring 'S': axis = [0.0, 0.0, 1.0] is not allowed: in a planar truss it is z")
    axis = {key: value for key, value in spring.items() if key != "axis"}
    truss(torsion_spring=[axis])
    members = truss(thermal={"shape": "triangle", "temperature_change_max_K": 10, "cycles": 2, "period_s": 3.0})
    assert members.returns_s().tolist() == [3, 6] and members.thermal.members is None
