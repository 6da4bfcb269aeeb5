# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature-dependent expansion coefficients: the strain is their integral, in solver and DEM."""
from __future__ import annotations

from copy import deepcopy
from typing import Any, Callable

import numpy as np
import pytest
from conftest import Outcome
from failures import Failure, failure
from scipy.integrate import quad

import statejump as sj
from statejump.core.expansion import CHORD
from statejump.kinds.truss.generate.document import to_toml

ROWS_K, ALPHA_PER_K = [-120.0, 0.0, 40.0, 150.0], [17e-6, 23e-6, 24e-6, 29e-6]
LENGTH_M, RIGIDITY_N, FRICTION_N, PLAY_M = 1.0, 70e9 * 1e-5, 200.0, 5e-4
BAR = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-5, "density_kg_per_m3": 2700.0}


def bar(friction_N: float | None = None, **thermal: Any) -> dict[str, Any]:
    """Return a bar along x from a fixed node to a node that is free, or that slides with friction."""
    data: dict[str, Any] = {
        "case": {"name": "bar", "kind": "truss"}, "truss": {"dimension": 2},
        "node": [{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
                 {"name": "B", "position_m": [LENGTH_M, 0.0], "fixed": ["y"]}],
        "link": [{"name": "AB", "nodes": ["A", "B"], **BAR, "expansion": "alloy"}],
        "expansion": [{"name": "alloy", "temperature_change_K": ROWS_K, "thermal_expansion_per_K": ALPHA_PER_K}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 130.0, **thermal},
    }
    if friction_N is not None:
        data["slider"] = [{"name": "S", "nodes": ["B"], "axis": [1.0, 0.0], "friction_coefficient": 0.5,
                           "normal_force_N": 2 * friction_N}]
    return data


def pushed_block(play_m: float = PLAY_M, **thermal: Any) -> dict[str, Any]:
    """Return the bar with a block between two stops, as a ``spring_slider``."""
    table = {"temperature_change_K": ROWS_K, "thermal_expansion_per_K": ALPHA_PER_K}
    return {
        "case": {"name": "block", "kind": "spring_slider"}, "link": {**BAR, "stress_free_length_m": LENGTH_M},
        "joint": {"normal_force_N": 2 * FRICTION_N, "friction_coefficient": 0.5, "clearance_minus_m": play_m,
                  "clearance_plus_m": play_m},
        "expansion": table, "thermal": {"shape": "triangle", "temperature_change_max_K": 130.0, **thermal},
    }


def slip_K(strain: float, bound_K: float = 0.0) -> float:
    """Return the ΔT between 0 and 40 K at which the thermal strain exceeds that at ``bound_K`` by ``strain``."""
    slope = (ALPHA_PER_K[2] - ALPHA_PER_K[1]) / ROWS_K[2]
    total = strain + integral(bound_K)
    return float((-ALPHA_PER_K[1] + np.sqrt(ALPHA_PER_K[1]**2 + 2 * slope * total)) / slope)


def integral(change_K: float) -> float:
    """Return ∫ α dΔT from 0, by a quadrature that splits at the corners of α."""
    corners = [row for row in ROWS_K if min(change_K, 0.0) < row < max(change_K, 0.0)]
    return quad(lambda at: np.interp(at, ROWS_K, ALPHA_PER_K), 0.0, change_K, points=corners or None)[0]


@pytest.mark.parametrize("peak_K", [130.0, -110.0])
def test_a_free_bar_is_as_long_as_the_integral_of_the_coefficient_says(peak_K: float) -> None:
    run = sj.load(bar(temperature_change_max_K=peak_K)).reduced()
    times = np.linspace(0.0, 1.0, 61)
    at = run.at(times)
    wanted = np.array([integral(change) for change in at.history["temperature_change_K"].values])
    # A chord of a parabola has an error of CHORD of the range; the solver's 1e-9 is far smaller.
    assert np.abs(at.links["thermal_strain"].values[:, 0] - wanted).max() < CHORD * np.ptp(wanted)
    assert at.history["displacement_m"].values[-31, 1, 0] == pytest.approx(LENGTH_M * integral(peak_K), rel=1e-9)


def test_a_table_of_one_value_is_that_coefficient() -> None:
    table, plain = bar(FRICTION_N), bar(FRICTION_N)
    table["expansion"][0]["thermal_expansion_per_K"] = 4 * [23e-6]
    del plain["link"][0]["expansion"], plain["expansion"]
    plain["link"][0]["thermal_expansion_per_K"] = 23e-6
    ours, theirs = (sj.load(data).reduced().at([0.1, 0.5, 0.9, 1.0]) for data in (table, plain))
    assert ours.history["displacement_m"].values == pytest.approx(theirs.history["displacement_m"].values, abs=1e-15)


def test_the_block_slips_where_the_integral_reaches_its_strain() -> None:
    run = sj.load(bar(FRICTION_N)).reduced()
    first = next(event for event in run.events if event.joint == "S")
    # A stuck bar of length l and free length l (1 + e) is compressed by E A e/(1 + e) = f.
    change = slip_K(FRICTION_N / (RIGIDITY_N - FRICTION_N))
    # A chord shifts an event by its error, a fraction of the range of the strain, over the coefficient.
    assert first.temperature_change_K == pytest.approx(change, abs=CHORD * integral(130.0) / ALPHA_PER_K[1])
    assert run.summary["largest_jump_m"] == pytest.approx(FRICTION_N * LENGTH_M / RIGIDITY_N, rel=1e-9)


def test_the_dem_interpolates_the_same_strain() -> None:
    case = sj.load(bar(FRICTION_N)).definition
    values, truss = case.behaviour.dem_input(case), case.resolve()
    number = values["link"]["program"][0]
    assert number == truss.links.program[0] == 1 and values["link"]["temperature_fraction"] == [1.0]
    program = values["programs"][number]
    assert program["table_time_s"] == truss.programs[1].table_time_s.tolist()
    strains = values["link"]["thermal_expansion_per_K"][0] * np.array(program["table_temperature_change_K"])
    changes = np.interp(program["table_time_s"], [0.0, 0.5, 1.0], [0.0, 130.0, 0.0])
    assert strains == pytest.approx([integral(change) for change in changes], rel=1e-12, abs=1e-18)


def test_a_bar_on_a_slider_follows_the_integral_of_the_coefficient() -> None:
    """Slip, stop contact and return occur at the strains of the closed forms; events have temperatures of the program.
    """
    case = sj.load(pushed_block())
    run = case.reduced()
    first = {event.kind: event for event in reversed(run.events)}
    held = FRICTION_N / RIGIDITY_N
    assert first["first_slip"].temperature_change_K == pytest.approx(
        slip_K(held / (1 - held)), abs=CHORD * integral(130.0) / ALPHA_PER_K[1])
    # At the stop the bar is compressed by f: x = l_T (1 - f/EA) - l0 = c.
    stop = slip_K((1 + PLAY_M / LENGTH_M) / (1 - held) - 1)
    assert 0 < stop < ROWS_K[2]
    assert first["stop_reached"].temperature_change_K == pytest.approx(stop, abs=CHORD * integral(130.0) / ALPHA_PER_K[1])
    assert run.summary["state_jump_m"] == pytest.approx(FRICTION_N * LENGTH_M / RIGIDITY_N, rel=1e-9)
    for event in run.events:  # time and temperature are those of one program
        assert event.temperature_change_K == pytest.approx(130.0 * (1 - abs(2 * event.time_s - 1)), abs=1e-9)
    times = np.linspace(0.0, 1.0, 61)
    at = run.at(times)
    assert at["temperature_change_K"] == pytest.approx(130.0 * (1 - np.abs(2 * times - 1)), abs=1e-12)
    wanted = np.array([integral(change) for change in at["temperature_change_K"]])
    assert np.abs(at.links["thermal_strain"].values[:, 0] - wanted).max() < CHORD * np.ptp(wanted)
    hottest = sj.statics(case).segments[-1]
    push = RIGIDITY_N / (1 + integral(130.0)) / LENGTH_M
    assert hottest.zero_force_m == pytest.approx(LENGTH_M * integral(130.0), rel=1e-12)
    assert hottest.to_m == PLAY_M and hottest.from_m == pytest.approx(
        min(PLAY_M, LENGTH_M * integral(130.0) - FRICTION_N / push), rel=1e-12)


def test_where_the_coefficient_changes_its_sign_the_bar_turns() -> None:
    """If the coefficient of expansion falls below 0, the bar shrinks during heating and pulls the block back."""
    data = pushed_block(temperature_change_max_K=200.0)
    data["expansion"] = {"temperature_change_K": [0.0, 100.0, 200.0], "thermal_expansion_per_K": [2e-5, 0.0, -2e-5]}
    case = sj.load(data)
    assert case.definition.turning_changes_K == (0.0, 100.0, 200.0)
    reversal = next(event for event in case.reduced().events if event.kind in ("reversal", "stop_unloaded"))
    assert 100.0 <= reversal.temperature_change_K < 200.0 and reversal.time_s < 0.5
    data["link"]["thermal_expansion_per_K"], data["expansion"] = 1e-5, None
    assert sj.load({key: value for key, value in data.items() if value}).definition.turning_changes_K == (0.0, 200.0)


@pytest.mark.parametrize("made", [lambda: bar(FRICTION_N), lambda: pushed_block(play_m=1e-2)],
                         ids=["truss", "spring_slider"])
def test_the_dem_agrees_within_the_tolerances(made: Callable[[], dict[str, Any]]) -> None:
    case = sj.load(made())
    found = sj.compare(case.reduced(), case.dem())
    assert found.passed, found.missed


def test_histories_of_members_are_exact_at_their_rows(tmp_path: Any) -> None:
    data = bar(shape="table", members_file="members.csv")
    del data["thermal"]["temperature_change_max_K"]
    (tmp_path / "members.csv").write_text("time_s,AB_K\n0,0\n10,90\n30,-100\n40,0\n", encoding="utf-8")
    (tmp_path / "bar.toml").write_text(to_toml(data), encoding="utf-8")
    case = sj.load(tmp_path / "bar.toml")
    strain = case.reduced().at([0.0, 10.0, 20.0, 30.0, 40.0]).links["thermal_strain"].values[:, 0]
    wanted = [0.0, integral(90.0), 0.5 * (integral(90.0) + integral(-100.0)), integral(-100.0), 0.0]
    assert strain == pytest.approx(wanted, rel=1e-12, abs=1e-18)


def put(section: str, **values: Any) -> Callable[[dict[str, Any]], None]:
    """Return a function that changes keys of a section, or of the first item in a list section."""
    def change(data: dict[str, Any]) -> None:
        item = data[section][0] if isinstance(data[section], list) else data[section]
        item.update(values)
    return change


WRONG: dict[str, tuple[Callable[[dict[str, Any]], None], Failure]] = {
    "both": (put("link", thermal_expansion_per_K=2e-5),
             failure("conflicting_key", item="link 'AB'", key="thermal_expansion_per_K", value=2e-05, other="expansion")),
    "neither": (lambda data: data["link"][0].pop("expansion"),
                failure("expansion_of_link_missing", item="link 'AB'", key="thermal_expansion_per_K")),
    "unknown": (put("link", expansion="aloy"), failure("misspelt_reference", item="link 'AB'", key="expansion", value="aloy", meant="alloy", what_it_is="expansion", name="aloy")),
    "rows fall": (put("expansion", temperature_change_K=[150.0, 40.0, 0.0, -120.0]),
                  failure("expansion_temperatures", item="expansion 'alloy'", key="temperature_change_K")),
    "without 0": (put("expansion", temperature_change_K=[10.0, 20.0, 40.0, 150.0]), failure("expansion_temperatures", item="expansion 'alloy'", key="temperature_change_K")),
    "too few": (put("expansion", thermal_expansion_per_K=[1e-6]), failure("expansion_coefficients", item="expansion 'alloy'", key="thermal_expansion_per_K", value=[1e-06], rows=4)),
    "all zero": (put("expansion", thermal_expansion_per_K=4 * [0.0]), failure("expansion_coefficients", item="expansion 'alloy'", key="thermal_expansion_per_K", rows=4)),
    "program beyond the table": (put("thermal", temperature_change_max_K=151.0),
                                 failure("expansion_too_narrow", reached_K=151.0)),
    "sine": (put("thermal", shape="half_sine"), failure("expansion_shape", item="expansion 'alloy', link 'AB'", key="thermal.shape", value="half_sine")),
}


WRONG_BLOCK: dict[str, tuple[Callable[[dict[str, Any]], None], Failure]] = {
    "both": (put("link", thermal_expansion_per_K=2e-5),
             failure("conflicting_key", key="link.thermal_expansion_per_K", other="[expansion]")),
    "neither": (lambda data: data.pop("expansion"),
                failure("expansion_missing", key="link.thermal_expansion_per_K")),
    "rows fall": (put("expansion", temperature_change_K=[150.0, 40.0, 0.0, -120.0]),
                  failure("expansion_temperatures", key="expansion.temperature_change_K", value=[150.0, 40.0, 0.0, -120.0])),
    "program beyond the table": (put("thermal", temperature_change_max_K=151.0),
                                 failure("expansion_too_narrow", key="expansion.temperature_change_K", value=[-120.0, 0.0, 40.0, 150.0], reached_K=151.0)),
    "sine": (put("thermal", shape="sine"), failure("expansion_shape", key="thermal.shape", value="sine")),
    "no length left": (lambda data: (put("thermal", temperature_change_max_K=-1500.0)(data),
                                     put("expansion", temperature_change_K=[-2000.0, 0.0],
                                         thermal_expansion_per_K=[1e-3, 1e-3])(data)) and None,
                       failure("link_without_length", key="expansion.thermal_expansion_per_K", value=[0.001, 0.001], at_K=-1500.0)),
}


@pytest.mark.parametrize(("made", "change", "sentence"), [
    *(pytest.param(pushed_block, *wrong, id=f"block, {what}") for what, wrong in WRONG_BLOCK.items()),
    *(pytest.param(bar, *wrong, id=f"bar, {what}") for what, wrong in WRONG.items()),
])
def test_what_is_wrong_is_one_sentence(
    made: Callable[[], dict[str, Any]], change: Callable[[dict[str, Any]], None], sentence: Failure, tmp_path: Any,
    statejump: Callable[..., Outcome],
) -> None:
    data = deepcopy(made())
    change(data)
    (tmp_path / "case.toml").write_text(to_toml(data), encoding="utf-8")
    told = statejump("reduced", tmp_path / "case.toml")
    assert told.status == 2 and told.errors.count("\n") == 1
    assert told.failure == sentence
