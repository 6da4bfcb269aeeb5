# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that involve several keys of a case, just within and just beyond the limit; also values derived by cases."""
from __future__ import annotations

import copy
import tomllib
from math import atan, atan2, hypot, nextafter, pi
from typing import Any

import pytest

from conftest import REPOSITORY
from failures import failing, failure
from statejump import _engine
from statejump.core.errors import Range, StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.spring_slider import stable_step
from statejump.kinds.statics.case import read_forces
from statejump.kinds.truss import generate

DOCUMENTS: dict[str, dict[str, Any]] = {}


def document(name: str, changes: dict[str, Any]) -> dict[str, Any]:
    """A shipped case file with changed values, given by ``section.key``."""
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


def refused(name: str, **changes: Any) -> StatejumpError:
    with pytest.raises(StatejumpError) as found:
        made(name, **changes)
    return found.value


TABLE = {"shape": "table", "table_time_s": [0, 1, 2, 3, 4], "table_temperature_change_K": [0, -50, 0, 100, 0]}


# A bar on a slider.
def test_a_bar_on_a_slider() -> None:
    case = made("table1", joint__pad_thermal_expansion_per_K=2e-5, joint__slot_thermal_expansion_per_K=1e-5,
                joint__clearance_plus_m=2e-3, thermal=TABLE)
    assert case.thermal_expansion_per_K == 23.4e-6 and case.samples_per_cycle == 2000 and case.friction_force_N == 30
    assert case.temperature_range_K == (-50, 100) == case.turning_changes_K
    assert case.thermal_strain(-50) == pytest.approx(-50 * 23.4e-6) and case.bar_program is case.thermal
    # The stop expands with the coefficient of the slot from pad radius plus clearance, the pad with its own.
    for side, start in ((1, 2e-3), (-1, 1e-3)):
        assert case.clearance_m(side, 30.0) == pytest.approx(start + 30 * (1e-5 * (0.05 + start) - 2e-5 * 0.05), rel=1e-12)


def test_a_bar_whose_coefficient_follows_the_temperature() -> None:
    rows, alpha = [-100.0, -50.0, 0.0, 100.0, 200.0], [-1e-5, 1e-5, 3e-5, -1e-5, 2e-5]
    changes = {"link__thermal_expansion_per_K": None, "thermal": TABLE}
    case = made("table1", **changes, expansion={"temperature_change_K": rows, "thermal_expansion_per_K": alpha})
    assert case.thermal_expansion_per_K == 3e-5
    assert case.turning_changes_K == pytest.approx((-50, 75, 100))  # zeros at -75, 75 and 133; 75 is in range
    assert case.thermal_strain(100) == pytest.approx(1e-3) and case.thermal_strain(-50) == pytest.approx(-1e-3)
    assert case.bar_program is not case.thermal
    # Zeros at the ends of the program are not repeated.
    ends = made("table1", **changes, expansion={"temperature_change_K": [-50, 0, 100], "thermal_expansion_per_K": [0, 1e-5, 0]})
    assert ends.turning_changes_K == (-50, 100)
    assert refused("table1", link__thermal_expansion_per_K=None) == (
        failure("expansion_missing", key="link.thermal_expansion_per_K"))
    table = {"temperature_change_K": [0, 200], "thermal_expansion_per_K": [1e-5, 2e-5]}
    assert refused("table1", expansion=table) == failure("conflicting_key", other="[expansion]", key="link.thermal_expansion_per_K", value=2.34e-05)
    short = {"temperature_change_K": [-10, 200], "thermal_expansion_per_K": [1e-5, 2e-5]}
    assert refused("table1", **changes, expansion=short) == failure("expansion_too_narrow", key="expansion.temperature_change_K", value=[-10.0, 200.0], reached_K=-50.0)
    assert refused("table1", **changes, expansion={**short, "temperature_change_K": [10, 200]}) == failure("expansion_temperatures", key="expansion.temperature_change_K", value=[10.0, 200.0])
    # 1 + strain is 0 at the end of this program.
    cold = {"shape": "table", "table_time_s": [0, 1, 2], "table_temperature_change_K": [0, -2000, 0]}
    table = {"temperature_change_K": [-2000, 0], "thermal_expansion_per_K": [5e-4, 5e-4]}
    assert refused("table1", link__thermal_expansion_per_K=None, thermal=cold, expansion=table) == (
        failure("link_without_length", key="expansion.thermal_expansion_per_K", value=[0.0005, 0.0005], at_K=-2000.0))
    table["thermal_expansion_per_K"] = [4.9e-4, 4.9e-4]
    made("table1", link__thermal_expansion_per_K=None, thermal=cold, expansion=table)


def test_checks_of_a_bar_on_a_slider() -> None:
    for key in ("clearance_minus_m", "clearance_plus_m"):
        # The pad grows by 100 K · 1e-4 · 0.05 m = 5e-4 m; the other stop is farther away.
        grows = {"joint__pad_thermal_expansion_per_K": 1e-4, f"joint__{key}": 5e-4}
        assert refused("table1", **grows) == (
            failure("clearance_closes", key=f"joint.{key}", value=0.0005, at_K=100.0))
        made("table1", **{**grows, f"joint__{key}": 5.1e-4})
        # The slot shrinks in the cold.
        shrinks = {"joint__slot_thermal_expansion_per_K": 4e-4, f"joint__{key}": 9e-4, "thermal": TABLE}
        assert refused("table1", **shrinks) == failure("clearance_closes", at_K=-50.0)
    assert refused("table1", joint__clearance_minus_m=0.5) == (
        failure("not_below_link_length", key="joint.clearance_minus_m", value=0.5, stress_free_length_m=0.5))
    made("table1", joint__clearance_minus_m=0.4999)
    made("table1", joint__clearance_plus_m=0.6)
    # E A is 630 000 N.
    assert refused("table1", joint__normal_force_N=630e3, joint__friction_coefficient=1.0) == (
        failure("friction_above_rigidity", key="joint.friction_coefficient", value=1.0, rigidity=630000.0, friction_force_N=630000.0))
    made("table1", joint__normal_force_N=629e3, joint__friction_coefficient=1.0)
    for preload in (629970.0, -629970.0):
        assert refused("table1", joint__preload_force_N=preload) == (
            failure("preload_above_rigidity", key="joint.preload_force_N", value=preload, rigidity=630000.0, friction_force_N=30.0))
    made("table1", joint__preload_force_N=629969.0)
    made("table1", joint__preload_force_N=-629969.0)
    stable = stable_step.stable_time_step(made("table1"))
    assert made("table1", dem__time_step_s=stable).dem_settings.time_step_s == stable
    assert refused("table1", dem__time_step_s=nextafter(stable, 1)) == failure("above_stable_time_step")
    # Heating or cooling reduces the length of the link to zero.
    cold = {"shape": "table", "table_time_s": [0, 1, 2], "table_temperature_change_K": [0, -1000, 0]}
    assert refused("table1", link__thermal_expansion_per_K=1e-3, thermal=cold) == failure("link_without_length")
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
    # Links of 1/2 and 1/4 m have an exact sum and difference.
    ends = {**STILL, "link_ab__stress_free_length_m": 0.5, "link_bc__stress_free_length_m": 0.25}
    for frame in (0.25, 0.75, 0.2, 0.8):
        assert refused("umbrella_damped", **ends, frame__length_m=frame) == (
            failure("links_cannot_meet", key="frame.length_m", value=frame, at_K=0.0, most=0.75, least=0.25))
    for frame in (nextafter(0.25, 1), nextafter(0.75, 0)):
        made("umbrella_damped", **ends, frame__length_m=frame)
    # Too short in the cold alone.
    assert refused("umbrella_damped", **{**ends, "link_ab__thermal_expansion_per_K": 1e-4}, frame__length_m=0.72, thermal=COLD) == (
        failure("links_cannot_meet", at_K=-1000.0))
    for link in ("link_ab", "link_bc"):
        assert refused("umbrella_damped", **{f"{link}__thermal_expansion_per_K": 1e-3}, thermal=COLD) == failure("link_without_length", key=f"{link}.thermal_expansion_per_K", value=0.001)
    flare = made("umbrella_damped").flare_angle_rad
    for bias in (-flare, pi - flare):
        outside = nextafter(bias, bias * 2)
        assert refused("umbrella_damped", torsion_spring={"stiffness_N_m_per_rad": 1.0, "bias_rad": outside}) == failure("bias_out_of_range", key="torsion_spring.bias_rad", value=outside, most=pi - flare, least=-flare)
        made("umbrella_damped", torsion_spring={"stiffness_N_m_per_rad": 1.0, "bias_rad": bias * (1 - 1e-9)})
    assert refused("umbrella_damped", torsion_spring={"bias_rad": -flare}).key == "torsion_spring.bias_rad"  # free at 0


def test_checks_of_the_joint_of_a_rib() -> None:
    assert refused("umbrella_damped", joint__journal_radius_m=100.0, joint__radial_clearance_m=1e-20) == failure("clearance_below_precision", key="joint.radial_clearance_m", value=1e-20, radius_key="joint.journal_radius_m", radius_m=100.0)
    both = {"joint__journal_thermal_expansion_per_K": 5e-4, "joint__bearing_thermal_expansion_per_K": 5e-4}
    made("umbrella_damped", **both, **STILL, thermal=COLD)
    for part in ("journal", "bearing"):
        assert refused("umbrella_damped", **{**both, f"joint__{part}_thermal_expansion_per_K": 1e-3}, **STILL, thermal=COLD) == (
            failure("no_radius_left", key=f"joint.{part}_thermal_expansion_per_K", value=0.001, at_K=-1000.0, part=part))
        made("umbrella_damped", **{f"joint__{part}_thermal_expansion_per_K": -1e-5 if part == "journal" else 1e-5}, **STILL)
        assert refused("umbrella_damped", **{f"joint__{part}_thermal_expansion_per_K": 5e-4 if part == "journal" else -5e-4},
                       **STILL) == failure("clearance_closes", key="joint.radial_clearance_m", value=0.0001)
    speeds = {"joint__friction_v0_m_per_s": 1e-3, "joint__friction_v1_m_per_s": 1e-3}
    assert refused("umbrella_damped", **speeds) == (
        failure("friction_velocities_unordered", key="joint.friction_v1_m_per_s", value=0.001, friction_v0_m_per_s=0.001))
    made("umbrella_damped", **{**speeds, "joint__friction_v1_m_per_s": 1.1e-3})
    # Only laws without a built-in restitution accept restitution 0.
    refusing = {"joint__dissipation_law": "flores", "joint__restitution": 0.0}
    assert refused("umbrella_damped", **refusing) == (
        failure("restitution_zero", key="joint.restitution", value=0.0, law="flores"))
    made("umbrella_damped", **{**refusing, "joint__dissipation_law": "exact_restitution"})
    made("umbrella_damped", **{**refusing, "joint__restitution": 0.1})
    slips = {"joint__friction_law": "mindlin_deresiewicz"}
    made("umbrella_damped", **slips)
    message = refused("umbrella_damped", **slips, joint__normal_law=LINE_LAW)
    assert message == failure("law_not_with_friction", key="joint.normal_law", value=LINE_LAW, law="mindlin_deresiewicz")
    made("umbrella_damped", joint__normal_law=LINE_LAW)


def test_a_law_that_cannot_be_used(monkeypatch: pytest.MonkeyPatch) -> None:
    for kind, key in (("normal", "normal_law"), ("dissipation", "dissipation_law"), ("friction", "friction_law"),
                      ("tangential_velocity", "tangential_velocity")):
        monkeypatch.setattr(_engine, "law_problem", lambda asked, name: "older version" if asked == kind else "")
        assert refused("umbrella_damped") == (
            failure("bad_law", key=f"joint.{key}", value=DOCUMENTS["umbrella_damped"]["joint"][key], cause="older version"))


def test_checks_of_the_start_of_a_rib() -> None:
    assert refused("umbrella_damped", start__contact_angle_rad=0.1) == (
        failure("requires_loaded_start", key="start.contact_angle_rad", value=0.1))
    made("umbrella_damped", start__eccentricity_m=1e-4, start__eccentricity_angle_rad=1.0)
    assert refused("umbrella_damped", start__eccentricity_m=1.01e-4) == failure("exceeds_clearance", key="start.eccentricity_m", value=0.000101, clearance=0.0001)
    made("umbrella_damped", ensemble__start_spread_m=1e-4)
    assert refused("umbrella_damped", ensemble__start_spread_m=1.01e-4) == (
        failure("not_above_zero_to_clearance", key="ensemble.start_spread_m", value=0.000101, clearance=0.0001))
    spring = {"stiffness_N_m_per_rad": 1.0, "bias_rad": 0.05}
    largest = atan(0.3)
    for angle in (0.0, largest, -largest):
        made("umbrella_damped", start={"mode": "loaded", "contact_angle_rad": angle}, torsion_spring=spring)
    for angle in (1.001 * largest, -1.001 * largest):
        assert refused("umbrella_damped", start={"mode": "loaded", "contact_angle_rad": angle}, torsion_spring=spring) == failure("angle_outside_friction_cone", least_rad=-largest, largest_rad=largest)
    assert refused("umbrella_damped", start={"mode": "loaded", "contact_angle_rad": 0.1}, torsion_spring=spring,
                   joint__friction_law="ambrosio") == failure("friction_without_static_load")
    made("umbrella_damped", start={"mode": "loaded"}, torsion_spring=spring, joint__friction_law="ambrosio")
    for key in ("eccentricity_m", "eccentricity_angle_rad"):
        for value in (1e-5, 1.0)[key == "eccentricity_angle_rad":]:
            assert refused("umbrella_damped", start={"mode": "loaded", key: value}, torsion_spring=spring) == (
                failure("set_by_equilibrium", key=f"start.{key}", value=value))
    for key in ("stiffness_N_m_per_rad", "bias_rad"):
        assert refused("umbrella_damped", start={"mode": "loaded"}, torsion_spring={**spring, key: 0.0}) == (
            failure("spring_without_preload", key="start.mode", value="loaded", spring_key=key))


def test_checks_of_the_steps_of_a_rib() -> None:
    assert refused("umbrella_damped", reduced={"method": "adaptive"}) == (
        failure("adaptive_with_memory", key="reduced.method", value="adaptive", law="mindlin"))
    made("umbrella_damped", reduced={"method": "adaptive"}, joint__friction_law="ambrosio")
    for path in ("reduced.steps_per_cycle", "dem.steps_per_cycle", "ensemble.reduced_steps_per_cycle",
                 "ensemble.dem_steps_per_cycle"):
        key = path.replace(".", "__")
        assert refused("umbrella_damped", **{key: 3001}) == (
            failure("not_multiple_of_samples", key=path, value=3001, samples=2000))
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
    (3, failure("force_section_missing", key="force", value=3, name="force")),
    ([], failure("force_section_missing", key="force", value=[], name="force")),
    ([RATE, 3], failure("force_section_missing", key="force", name="force")),
    ([RATE, {"forc_N": 1}], failure("misspelt_key", item="force 2", key="forc_N", meant="force_N")),
    ([{"name": "a"}], failure("force_components", item="force 1", key="force_N", largest_N=1000000000000.0, allowed=Range(-1000000000000.0, 1000000000000.0, "N"))),
    ([{"force_N": [1, 2]}], failure("force_components", item="force 1", key="force_N", value=[1, 2], largest_N=1000000000000.0)),
    ([{"force_N": [1, 2, 2e12]}], failure("force_components", item="force 1", key="force_N", value=[1, 2, 2000000000000.0])),
    ([RATE, {**RATE, "name": ""}], failure("not_string", item="force 2", key="name", value="")),
    ([{**RATE, "force_rate_N_per_K": None}], failure("force_rate", item="force 1", key="force_rate_N_per_K", value=None)),
    ([{**RATE, "temperature_change_K": None}], failure("force_temperatures", item="force 1", key="temperature_change_K", value=None, least_K=-10000.0, largest_K=10000.0)),
    ([{**RATE, "temperature_change_K": []}], failure("force_temperatures", item="force 1", key="temperature_change_K", value=[])),
])
def test_forces_that_are_refused(force: Any, why: str) -> None:
    with pytest.raises(StatejumpError) as found:
        read_forces("force", force)
    assert found.value == why


def test_checks_of_a_rest() -> None:
    keys = {"slot": ("clearance_m",), "journal": ("clearance_m",), "ball": ("clearance_m",),
            "cylinder": ("clearance_m", "axial_play_m"), "lobed": ("clearance_m", "lobes", "lobe_amplitude_m")}
    for kind, needed in keys.items():
        for key in needed:
            assert refused(f"statics_{kind}", **{f"joint__{key}": None}) == (
                failure("missing_for_joint_type", key=f"joint.{key}", type=kind))
        for key, value in (("axial_play_m", 1e-4), ("lobes", 3), ("lobe_amplitude_m", 1e-5), ("mesh_file", "a.stl"),
                           ("mesh_unit_m", 1.0)):
            if key not in needed:
                assert refused(f"statics_{kind}", **{f"joint__{key}": value}) == failure("wrong_joint_type", key=f"joint.{key}", value=value)
    assert refused("statics_lobed", joint__lobe_amplitude_m=1e-4) == (
        failure("lobe_amplitude", key="joint.lobe_amplitude_m", value=0.0001, clearance_m=0.0001))
    made("statics_lobed", joint__lobe_amplitude_m=0.99e-4)
    made("statics_lobed", joint__lobe_amplitude_m=0.0)
    assert refused("statics_ball", picture={"friction_coefficients": [0.1]}) == (
        failure("only_below_three_dimensions", key="picture.friction_coefficients"))
    made("statics_ball", picture={"friction_coefficients": []})
    many = {**RATE, "temperature_change_K": list(range(256))}
    made("statics_ball", force=[many])
    assert refused("statics_ball", force=[many, {"force_N": [1, 0, 0]}]) == failure("too_many_forces", key="force", forces=257, most=256)
    for kind in ("lobed", "ball"):
        assert refused(f"statics_{kind}", force=[{**RATE, "temperature_change_K": [0, -1]}]) == (
            failure("no_nonzero_force", key="force 'F1, ΔT = -1 K'", value=[0, 0, 0]))
    for kind in ("lobed", "journal"):
        assert refused(f"statics_{kind}", force=[{"name": "up", "force_N": [1, 0, 0.5]}]) == (
            failure("force_out_of_plane", key="force 'up'", value=[1.0, 0.0, 0.5], type=kind))
    for kind in ("cylinder", "ball", "slot"):
        made(f"statics_{kind}", force=[{"force_N": [1, 0, 0.5]}])
    made("statics_ball", force=[{"force_N": [0.5, 0, 0]}])


# Trusses.
def truss(**changes: Any) -> Any:
    return parse_case({**generate.chain(3), **changes})


def truss_refused(**changes: Any) -> StatejumpError:
    with pytest.raises(StatejumpError) as found:
        truss(**changes)
    return found.value


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
        failure("program_duration_differs", item="program 'shade'", key="period_s", value=2.0, cycles=4, lasts=8.0, wanted_s=6.0))
    # Durations that differ by less than 1e-9 count as equal.
    truss(thermal=thermal, program=[{**own[1], "period_s": 2.0 * (1 + 0.9e-9)}])
    assert truss_refused(thermal=thermal, program=[{**own[1], "period_s": 2.0 * (1 - 1.1e-9)}]) == failure("program_duration_differs", wanted_s=6.0)
    assert truss_refused(program=[{"name": "sun", "shape": "triangle"}]) == failure("missing_key", item="program 'sun'", key="temperature_change_max_K")
    assert truss_refused(expansion=[{"name": "soft", "temperature_change_K": [0], "thermal_expansion_per_K": [1e-5]}]) == failure("expansion_temperatures", item="expansion 'soft'", key="temperature_change_K", value=[0.0])
    assert chain == generate.chain(3)


def test_checks_of_a_truss() -> None:
    chain = generate.chain(3)
    for section in ("node", "link", "slider"):
        twice = copy.deepcopy(chain[section])
        twice[2]["name"] = twice[0]["name"]
        assert truss_refused(**{section: twice}) == (
            failure("duplicate_name", item=f"{section} 3", key="name", value=twice[0]["name"], part=section))
    theta = {"theta": 0.6, "displacement_tolerance_m": 1e-6}
    assert truss_refused(motion=theta) == (
        failure("theta_without_equal_steps", key="motion.theta", value=0.6))
    truss(motion={**theta, "theta": 0.5})
    truss(motion={"theta": 0.6})
    assert truss_refused(tables={"node": "a.csv"}) == failure("tables_of_case_file", key="section [tables]")
    node = copy.deepcopy(chain["node"])
    for key, value, why in (
        ("position_m", [0.0, 0.0, 0.0], failure("wrong_dimension", dimension=2, unit="m")),
        ("guide_normal", [0.0, 0.0], failure("zero_vector")),
        ("guide_normal", [1.0], failure("wrong_dimension", dimension=2, unit="-")),
        ("force_N", [1.0, 0.0, 0.0], failure("wrong_dimension", dimension=2, unit="N")),
        ("fixed", ["z"], failure("planar_directions")),
    ):
        wrong = [*node[:-1], {**node[-1], key: value}]
        assert truss_refused(node=wrong) == why.at(item=f"node {node[-1]['name']!r}", key=key, value=value)
    truss(node=[*node[:-1], {**node[-1], "force_N": [0.0, 0.0]}])
    names = [one["name"] for one in node]
    for axis in ([0.0, 0.0], [1.0, 0.0, 0.0]):
        assert truss_refused(reflector={"nodes": names, "axis": axis}) == (
            failure("reflector_axis", key="reflector.axis", value=axis, dimension=2))
    assert [node.fixed for node in made("trusses/ball_tripod").node if "z" in node.fixed]  # in space
    for section in ("node", "truss", "thermal"):
        with failing("missing_key", section=f"section {'[[node]]' if section == 'node' else f'[{section}]'}"):
            parse_case({name: part for name, part in chain.items() if name != section})
    spring = {"name": "S", "links": [chain["link"][0]["name"]], "stiffness_N_m_per_rad": 1.0, "axis": [0, 0, 1]}
    assert truss_refused(torsion_spring=[spring]) == (
        failure("planar_axis", item="torsion_spring 'S'", key="axis", value=[0.0, 0.0, 1.0]))
    axis = {key: value for key, value in spring.items() if key != "axis"}
    truss(torsion_spring=[axis])
    members = truss(thermal={"shape": "triangle", "temperature_change_max_K": 10, "cycles": 2, "period_s": 3.0})
    assert members.returns_s().tolist() == [3, 6] and members.thermal.members is None
