# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of verdicts, checked by hand on made-up runs."""
from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from statejump import load
from statejump.core.comparison import Quantity
from statejump.core.run import Column, Event, Events, Run
from statejump.kinds.spring_slider import compare as slider
from statejump.kinds.truss import compare as truss
from statejump.kinds.umbrella import compare as umbrella

EXACT = 1e-12


def run_of(history: dict[str, Any], energy: dict[str, Any] | None = None, links: dict[str, Any] | None = None,
           events: list[Event] | None = None, summary: dict[str, float] | None = None) -> Run:
    groups = [{name: Column(np.asarray(values, dtype=float)) for name, values in (group or {}).items()}
              for group in (history, energy, links)]
    return Run("dem", groups[0], groups[1], groups[2], {}, Events(events or []), summary or {})


def by_name(rows: list[Quantity]) -> dict[str, Quantity]:
    return {row.name: row for row in rows}


def triangle(samples: int, cycles: int) -> np.ndarray:
    """Share of the largest temperature at each sample."""
    phase = np.arange(samples * cycles + 1) % samples / samples
    return 1 - np.abs(2 * phase - 1)


# Trusses. More nodes than axes.
SAMPLES, NODES, CYCLES = 10, 11, 3


def moved(offsets: dict[tuple[int, int, int], float]) -> np.ndarray:
    """Displacements of a chain that expands with the temperature, plus given displacements at some (sample, node,
    axis)."""
    share = triangle(SAMPLES, CYCLES)
    found = np.zeros((len(share), NODES, 3))
    found[:, :, 0] = share[:, None] * 1e-3 * np.arange(NODES)
    for place, value in offsets.items():
        found[place] += value
    return found


def truss_run(displacement: np.ndarray, forces: np.ndarray, energy: dict[str, Any] | None = None) -> Run:
    share = triangle(SAMPLES, CYCLES)
    return run_of({"time_s": np.arange(len(share)), "temperature_change_K": 50 * share, "displacement_m": displacement},
                  energy, {"axial_force_N": forces})


@pytest.mark.parametrize("change, width", [
    ([0, 1, 2, 1, 0], 5e-4),  # 3-4-5, in the second sample against the fourth
    ([0, -1, -2, -1, 0], 5e-4),
    ([0, 2, 1, 1, 0], 0.0),  # cooling and heating again: no branch each
    ([0, 1, 0.5, 2, 0], 0.0),
    ([2, 1, 0.5, 0.2, 0], 0.0),
    ([0, 1, 2, 3, 4], 0.0),
])
def test_width_of_the_loop_is_that_of_the_widest_node(change: list[float], width: float) -> None:
    displacement = np.zeros((7, 6, 3))
    displacement[1, 4] = 3e-4, 0, 1e-4
    displacement[3, 4] = 0, 4e-4, 1e-4
    displacement[1, 5, 0] = 1e-4
    displacement[5:] = 1.0  # of another cycle
    run = run_of({"time_s": range(7), "temperature_change_K": [*change, 1, 2], "displacement_m": displacement})
    assert truss.loop_width_m(SimpleNamespace(samples_per_cycle=4), run) == pytest.approx(width, rel=EXACT)


def test_width_of_a_loop_of_two_branches_of_one_sample() -> None:
    displacement = np.zeros((3, 2, 3))
    displacement[:, 1, 0] = 0, 1e-3, 2e-4
    run = run_of({"time_s": range(3), "temperature_change_K": [0, 1, 0], "displacement_m": displacement})
    assert truss.loop_width_m(SimpleNamespace(samples_per_cycle=2), run) == pytest.approx(2e-4, rel=EXACT)


def test_rows_of_a_truss(cases: Path) -> None:
    case = load(cases / "trusses/chain_10.toml").changed({"thermal.cycles": CYCLES}).definition
    last, peak = SAMPLES * CYCLES, SAMPLES // 2
    # The first jumps by 3-4-5 at node 7 and a little at node 10; the second is elsewhere by 2e-5 at the peak, 1e-5 in
    # another direction at the end of node 3, by 6e-6 of node 7's own jump.
    ours = moved({(last, 7, 0): 3e-4, (last, 7, 1): 4e-4, (last, 10, 0): 1e-4})
    other = ours.copy()
    other[peak, 10, 1] += 2e-5
    other[last, 3, 2] += 1e-5
    other[last, 7] += np.array([3.6e-6, 4.8e-6, 0])
    forces = np.zeros((last + 1, 10))
    forces[peak, 2] = -40.0
    off = forces.copy()
    off[5, 9] += 2.0
    off[6, 9] -= 1.0
    rows = by_name(truss.difference(case, truss_run(ours, forces), truss_run(other, off)))
    largest, samples = 1e-2, last + 1
    tolerance = case.tolerance
    expected = {
        "displacement_at_peak_largest_difference_over_largest": (2e-5 / largest, tolerance.displacement_relative),
        "displacement_largest_rms_over_largest": (2e-5 / np.sqrt(samples) / largest, tolerance.displacement_relative),
        "jump_largest_difference_over_largest_jump_or_loop": (1e-5 / 5e-4, tolerance.jump_relative),
        "axial_force_largest_rms_over_largest": (np.sqrt(5 / samples) / 40, tolerance.force_relative),
    }
    assert {*expected, f"jump_of_node_{case.node[7].name}"} == set(rows)
    for name, (value, allowed) in expected.items():
        assert (rows[name].reduced, rows[name].dem) == (0, pytest.approx(value, rel=1e-9)), name
        assert rows[name].tolerance == allowed
    jump = rows[f"jump_of_node_{case.node[7].name}"]
    assert (jump.reduced, jump.dem) == (pytest.approx(5e-4), pytest.approx(5.06e-4))
    assert jump.tolerance == pytest.approx(tolerance.jump_relative * 5e-4)


def test_drift_of_a_truss_is_that_of_later_cycles_from_the_second(cases: Path) -> None:
    case = load(cases / "trusses/chain_10.toml").changed({"thermal.cycles": CYCLES, "output.samples_per_cycle": SAMPLES})
    offsets = {(3, 2, 0): 1.0, (SAMPLES + 3, 4, 0): 3e-5, (2 * SAMPLES + 3, 4, 1): 4e-5, (2 * SAMPLES + 5, 1, 2): -4.5e-5}
    run = truss_run(moved(offsets), np.zeros((SAMPLES * CYCLES + 1, 10)))
    assert truss.loop_drift_m(case.definition, run) == pytest.approx(5e-5, rel=1e-9)


def test_energy_of_a_truss_is_measured_by_friction_or_by_what_is_stored(cases: Path) -> None:
    case = load(cases / "trusses/chain_10.toml").changed({"thermal.cycles": CYCLES, "output.samples_per_cycle": SAMPLES})
    still = moved({})
    forces = np.zeros((len(still), 10))
    ramp = np.linspace(0, 1, len(still))
    energy = {"thermal_work_J": 10 * ramp, "external_work_J": 1 * ramp, "elastic_energy_J": 3 * ramp,
              "kinetic_energy_J": 0.5 * ramp, "friction_dissipation_J": 4 * ramp, "damping_dissipation_J": 2 * ramp,
              "impact_dissipation_J": 1 * ramp}
    run = truss_run(still, forces, energy)
    for friction, scale, name in ((4, 4, "friction_work"), (0, 3 + 2, "largest_stored")):
        spent = replace(run, energy={**run.energy, "friction_dissipation_J": Column(friction * ramp)})
        compare = case.behaviour.compare
        row = by_name(list(compare(case.definition, run, spent).rows))[f"energy_residual_over_{name}"]
        assert row.dem == pytest.approx((10 + 1 - 3 - 0.5 - friction - 2 - 1) / scale, rel=EXACT)


# A bar on a slider.
def slider_run(**columns: list[float]) -> Run:
    return run_of({"time_s": range(len(columns["temperature_change_K"])), **columns})


@pytest.mark.parametrize("change, expected", [
    ({}, {"first_slip": 15, "stop_reached": 35, "stop_left": 25}),
    ({"slipping": [1, 0, 1, 0, 0, 0, 0, 0, 0]}, {"first_slip": 0, "stop_reached": 35, "stop_left": 25}),
    ({"slipping": [0] * 9}, {"first_slip": None, "stop_reached": 35, "stop_left": 25}),
    ({"stop_contact": [1, 0, 0, 0, 1, 1, 0, 0, 0]}, {"first_slip": 15, "stop_reached": 35, "stop_left": 25}),
    ({"stop_contact": [1, 1, 0, 0, 0, 0, 0, 0, 0]}, {"first_slip": 15, "stop_reached": None, "stop_left": None}),
    # the other stop is reached later
    ({"stop_contact": [0, 0, 0, 0, 1, 1, 0, 1, 1], "stop_force_N": [0, 0, 0, 0, -5, -5, 0, 3, 3]},
     {"first_slip": 15, "stop_reached": 35, "stop_left": 25}),
    # and not left again
    ({"stop_contact": [0, 0, 0, 0, 1, 1, 1, 1, 1], "stop_force_N": [0, 0, 0, 0, -5, -5, -5, -5, -5]},
     {"first_slip": 15, "stop_reached": 35, "stop_left": None}),
])
def test_events_of_the_dem_lie_between_two_samples(change: dict[str, list], expected: dict[str, float | None]) -> None:
    columns = {"temperature_change_K": [0, 10, 20, 30, 40, 30, 20, 10, 0], "slipping": [0, 0, 1, 1, 0, 0, 1, 0, 0],
               "stop_contact": [0, 0, 0, 0, 1, 1, 0, 0, 0], "stop_force_N": [0, 0, 0, 0, -5, -5, 0, 0, 0], **change}
    beyond = {name: [*values, 1.0] for name, values in columns.items()}  # a sample of the next cycle
    assert slider.dem_event_temperatures(slider_run(**beyond), 8) == expected


def test_drift_of_a_slider_is_that_of_later_cycles_from_the_second() -> None:
    x = np.zeros(13)
    x[2], x[6], x[10], x[11] = 9.0, 3e-5, -1e-5, 2e-5
    assert slider.loop_drift(slider_run(displacement_m=x, temperature_change_K=x), 4, 3) == pytest.approx(4e-5)


def test_rows_of_a_slider(cases: Path) -> None:
    case = load(cases / "table1.toml").definition
    tolerance = case.tolerance
    x = np.array([0, 4e-4, 8e-4, 4e-4, 2e-5])
    y = x + np.array([0, 3e-6, 0, -4e-6, 0])
    events = [Event("first_slip", 0.1, 12.0), Event("first_slip", 0.2, 99.0), Event("stop_left", 2 * case.period_s, 5.0)]
    sides = [slider_run(displacement_m=list(values), temperature_change_K=[0] * 5) for values in (x, y)]
    runs = [replace(side, summary={"state_jump_m": jump}, events=Events(found))
            for side, jump, found in zip(sides, (2e-5, 2.1e-5), (events, []))]
    rows = by_name(slider.difference(case, *runs))
    assert rows["state_jump"].difference == pytest.approx(1e-6)
    # On the scale of jumps, f/k, which is larger than this jump.
    scale = 30 * 0.5 / (70e9 * 9e-6)
    assert rows["state_jump"].tolerance == pytest.approx(tolerance.state_jump_relative * scale)
    assert rows["displacement_rms_over_largest"].dem == pytest.approx(np.sqrt(5e-12) / 8e-4)
    assert rows["first_slip_temperature_change"].reduced == 12 and not rows["first_slip_temperature_change"].passed
    # None of the two has it in the first cycle.
    assert rows["stop_left_temperature_change"].passed and rows["stop_reached_temperature_change"].passed
    larger = [replace(run, summary={"state_jump_m": 1.0}) for run in runs]
    assert by_name(slider.difference(case, *larger))["state_jump"].tolerance == tolerance.state_jump_relative
    smooth = load(cases / "table1_frictionless.toml").definition
    assert set(by_name(slider.difference(smooth, *runs))) == {"state_jump", "displacement_rms_over_largest"}


# The rib of the umbrella.
@pytest.mark.parametrize("changes", [
    {"start.eccentricity_m": 5e-5}, {"start.mode": "rest"}, {"link_bc.thermal_expansion_per_K": 2e-5},
    {"torsion_spring.stiffness_N_m_per_rad": 0.1, "torsion_spring.bias_rad": 0.05},
    {"thermal": {"shape": "table", "table_time_s": [0, 1, 2], "table_temperature_change_K": [0, -60, 0], "cycles": 1}},
])
def test_first_contact_has_a_closed_form_from_the_centre_alone(cases: Path, changes: dict[str, Any]) -> None:
    case = load(cases / "umbrella_damped.toml")
    rib = case.definition
    expected = rib.joint.radial_clearance_m / (rib.link_ab.thermal_expansion_per_K * rib.frame.length_m)
    assert umbrella.closed_form_first_contact(rib) == pytest.approx(expected)
    unbiased = case.changed({"torsion_spring.stiffness_N_m_per_rad": 0.1, "torsion_spring.bias_rad": 0.0})
    assert umbrella.closed_form_first_contact(unbiased.definition) == pytest.approx(expected)
    changed = load({**case.to_dict(), **changes}) if "thermal" in changes else case.changed(changes)
    assert umbrella.closed_form_first_contact(changed.definition) is None
