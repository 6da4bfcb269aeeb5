# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparisons checked by hand: rows of each kind of case, of finite elements, of two files."""
from __future__ import annotations

import json
from dataclasses import replace
from math import inf, isnan, nan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from conftest import REPOSITORY
from failures import failure
from statejump import load
from statejump.core.comparison import Comparison, Quantity, models, of_two, quantity, share, sides, table
from statejump.core.errors import StatejumpError
from statejump.core.run import Column, Event, Run
from statejump.kinds.spring_slider import compare as slider
from statejump.kinds.truss import compare as truss
from statejump.kinds.umbrella import compare as umbrella
from statejump.results import difference as files
from test_verdict_rows import by_name, run_of


def case_of(name: str, **changes: Any) -> Any:
    found = load(REPOSITORY / "cases" / f"{name}.toml")
    return found.changed({path.replace("__", "."): value for path, value in changes.items()}).definition


# Rows.
def test_a_row() -> None:
    row = quantity("jump", "m", 0.25, closed_form=1.0, dem=1.25)
    assert (row.difference, row.passed, row.closed_form, row.dem, row.reduced, row.finite) == (0.25, True, 1.0, 1.25, None, True)
    assert row.to_dict() == {"name": "jump", "unit": "m", "closed_form": 1.0, "dem": 1.25, "difference": 0.25,
                             "tolerance": 0.25, "pass": True}
    with pytest.raises(AttributeError, match="^fem$"):
        row.fem
    assert quantity("jump", "m", 0.25, reduced=1.0, dem=0.75).passed and models("a", "-", 1.0, 0.75, 0.25).difference == -0.25
    assert not quantity("jump", "m", 0.25, reduced=1.0, dem=0.7).passed
    assert not quantity("jump", "m", inf, reduced=1.0, dem=inf).passed
    for first, second, passed in ((None, None, True), (None, 1.0, False), (1.0, None, False)):
        row = quantity("contact", "K", 1.0, reduced=first, dem=second)
        assert (row.difference, row.passed, row.finite) == (None, passed, True)
    assert [quantity("a", "-", tolerance, reduced=first, dem=1.0).finite for tolerance, first in (
        (1.0, nan), (inf, 1.0), (1.0, inf), (1.0, 2.0))] == [False, False, False, True]


def test_shares() -> None:
    assert [share(*pair) for pair in ((0.0, 0.0), (1.0, 2.0), (0.0, 2.0), (-3.0, 2.0), (1.0, 0.0), (-1.0, 0.0))] == [
        0, 0.5, 0, -1.5, inf, -inf]
    assert all(isnan(share(*pair)) for pair in ((1.0, nan), (0.0, nan), (nan, 1.0)))
    assert not np.isfinite(share(nan, 0.0)) and share(1.0, -1.0) == inf


def test_tables_of_rows() -> None:
    rows = [models("a", "m", 1.0, 2.0, 3.0), quantity("b", "K", 0.5, closed_form=1.0, dem=4.0)]
    assert sides(rows) == ["closed_form", "reduced", "dem"] and sides([]) == []
    assert table(rows)[0] == {"name": "a", "unit": "m", "closed_form": None, "reduced": 1.0, "dem": 2.0, "difference": 1.0,
                              "tolerance": 3.0, "pass": True}
    assert table(rows)[1]["reduced"] is None and not table(rows)[1]["pass"]
    two = of_two(rows)
    assert [(row.first, row.second, row.reduced, row.passed) for row in two] == [(1, 2, None, True), (1, 4, None, False)]


def test_comparisons(tmp_path: Path) -> None:
    rows = (models("a", "m", 1.0, 2.0, 3.0), models("b", "K", 1.0, 2.0, 0.5))
    found = Comparison(case_of("table1"), {}, rows, reasons=("too fast",))
    assert not found.passed and found.missed == ["b"] and repr(found) == "Comparison(table1, missed: b)"
    kept = replace(found, rows=rows[:1], reasons=())
    assert kept.passed and repr(kept) == "Comparison(table1, passed)" and list(found.frame()["name"]) == ["a", "b"]
    assert [path.name for path in found.write(tmp_path)] == ["comparison.json", "comparison.csv"]
    told = json.loads((tmp_path / "comparison.json").read_text())
    assert (told["pass"], told["reasons"], [row["name"] for row in told["quantities"]]) == (False, ["too fast"], ["a", "b"])
    # Differences of finite-element rows are relative to the reduced model; for a value of 0 they are absolute.
    more = [Quantity("c", "m", {"reduced": own, "fe": 1.0}, by, 0.5, True) for own, by in ((-4.0, 0.25), (0.0, 0.25), (2.0, None))]
    whole = replace(found, notes=("here",)).with_fe(more, ["there"])
    assert whole.notes == ("here", "there") and [row.name for row in whole.rows] == ["a", "b", *3 * ["c, finite elements"]]
    assert [(row.difference, row.tolerance) for row in whole.rows[2:]] == [(1.0, 2.0), (0.25, 0.5), (None, 1.0)]


# A bar on a slider.
X = np.array([0.0, 4e-4, 8e-4, 4e-4, 2e-5])
ENERGY = {"thermal_work_J": 20.0, "external_work_J": 1.0, "elastic_energy_J": 3.0, "preload_energy_J": 0.5, "contact_energy_J": 0.25,
          "kinetic_energy_J": 0.125, "friction_dissipation_J": 10.0, "damping_dissipation_J": 2.0}
RESIDUE = 20 + 1 - 3 - 0.5 - 0.25 - 0.125 - 10 - 2


def slider_runs(case: Any, x: np.ndarray = X, y: np.ndarray = X, **energy: float) -> list[Run]:
    ramp = np.linspace(0, 1, len(x))
    more = {name: 0 * ramp for name in ("slipping", "stop_contact", "stop_force_N", "velocity_m_per_s")}
    return [run_of({"time_s": np.linspace(0, case.duration_s, len(x)), "temperature_change_K": 100 * ramp, "displacement_m": values,
                    **more}, {name: value * ramp for name, value in {**ENERGY, **energy}.items()},
                   summary={"state_jump_m": float(values[-1])}) for values in (x, y)]


def test_comparison_of_a_slider() -> None:
    case = case_of("table1", dem__samples_per_cycle=10)
    exact, dem = slider_runs(case, y=X + np.array([0, 0, 0, 0, 1e-6]))
    dem = replace(dem, history={**dem.history, "displacement_m": Column(dem["displacement_m"] + 5.0)})  # it begins elsewhere
    rows = by_name(list(slider.compare(case, exact, dem).rows))
    assert (rows["state_jump"].reduced, rows["state_jump"].dem) == (2e-5, pytest.approx(2.1e-5, rel=1e-6))
    assert {name for name in rows if name.endswith("temperature_change")} == {
        f"{kind}_temperature_change" for kind in slider.COMPARED_EVENTS}
    assert rows["energy_residual_over_friction_work"].dem == pytest.approx(RESIDUE / 10)
    assert rows["energy_residual_over_friction_work"].reduced == 0
    assert rows["energy_residual_over_friction_work"].tolerance == case.tolerance.energy_balance_relative
    assert rows["displacement_rms_over_largest"].reduced == 0 and "loop_drift_over_largest_displacement" not in rows
    assert slider.energy_residual(dem) == pytest.approx(RESIDUE)
    # Without friction work, the largest stored energy is the scale.
    rows = by_name(list(slider.compare(case, *slider_runs(case, friction_dissipation_J=0.0)).rows))
    assert rows["energy_residual_over_largest_stored"].dem == pytest.approx((RESIDUE + 10) / 3.25)
    smooth = case_of("table1_frictionless", dem__samples_per_cycle=10)
    assert not [name for name in by_name(list(slider.compare(smooth, *slider_runs(smooth)).rows)) if "temperature_change" in name]


def test_verdict_of_a_slider_has_reasons_where_it_is_missed() -> None:
    case = case_of("table1", dem__samples_per_cycle=10)
    energy = {name: 0.0 for name in ENERGY}
    kept = slider.compare(case, *slider_runs(case, **energy))
    assert kept.passed and kept.reasons == () and set(kept.models) == {"reduced", "dem"}
    fast = case_of("table1", dem__samples_per_cycle=10, thermal__period_s=1e-3)
    missed = slider.compare(fast, *slider_runs(fast, y=X * 1.5, **energy))
    assert not missed.passed and missed.reasons


@pytest.mark.parametrize("cycles", [2, 3])
def test_later_loops_of_a_slider(cycles: int) -> None:
    case = case_of("table1", dem__samples_per_cycle=10, thermal__cycles=cycles)
    x = np.tile(np.linspace(0, 8e-4, 10), cycles)
    x = np.append(x, 0.0)
    y = x.copy()
    y[-5] += 4e-5
    rows = by_name(list(slider.compare(case, *slider_runs(case, x, y)).rows))
    assert ("loop_drift_over_largest_displacement" in rows) == (cycles > 2)
    if cycles > 2:
        row = rows["loop_drift_over_largest_displacement"]
        assert (row.reduced, row.dem, row.tolerance) == (0, pytest.approx(4e-5 / 8e-4), case.tolerance.drift_relative)


# A rib of the umbrella.
def rib_run(theta: Any, events: list[Event] | None = None, largest: int = 2, **more: Any) -> Run:
    count = len(theta)
    heat = 100 - 10.0 * np.abs(np.arange(count) - largest)
    energy = {"thermal_work_J": 8.0, "kinetic_energy_J": 1.0, "axial_energy_J": 0.5, "contact_energy_J": 0.25,
              "torsion_energy_J": 0.125, "axial_dissipation_J": 2.0, "pin_dissipation_J": 1.5, "friction_dissipation_J": 1.0,
              "impact_dissipation_J": 0.75, **more}
    ramp = np.linspace(0, 1, count)
    theta = np.asarray(theta, dtype=float)
    return run_of({"time_s": np.linspace(0, 1, count), "temperature_change_K": heat, "theta2_rad": theta, "theta4_rad": 2 * theta},
                  {name: value * ramp for name, value in energy.items()}, events=events,
                  summary={"theta2_jump_rad": theta[-1], "theta4_jump_rad": 3 * theta[-1]})


ABOUT = 1 + 0.5 + 0.25 + 0.125 + 2 + 1.5 + 1 + 0.75
OURS, OTHER = [0, 0.1, 0.4, 0.2, 0.1], [0, 0.11, 0.38, 0.2, 0.4]


def first_contact(rows: dict[str, Any], model: str) -> Any:
    """Return the row that compares the first contact of a model with the closed form."""
    (row,) = [row for name, row in rows.items() if name.startswith("first_contact_") and name.split()[-1] == model]
    return row


def test_comparison_of_a_damped_rib() -> None:
    case = case_of("umbrella_damped")
    tolerance = case.tolerance
    limit = 1e-4 / (23.75e-6 * 0.12)
    runs = [rib_run(OURS, [Event("first_contact", 0.1, limit + 1e-7)]), rib_run(OTHER, [Event("first_contact", 0.1, limit + 1e-4)])]
    found = umbrella.compare(case, *runs)
    rows = by_name(list(found.rows))
    assert found.notes == () and set(found.models) == {"reduced", "dem"}
    for model, name, value, allowed in (("reduced", "reduced", limit + 1e-7, tolerance.first_contact_reduced_K),
                                        ("dem", "DEM", limit + 1e-4, tolerance.first_contact_dem_K)):
        row = first_contact(rows, name)
        assert (row.closed_form, row.values[model], row.tolerance, row.passed) == (pytest.approx(limit), value, allowed, True)
    for angle, size, jump in (("theta2", 1, 1), ("theta4", 2, 3)):
        row = rows[f"{angle}_jump"]
        assert (row.reduced, row.dem, row.tolerance) == (pytest.approx(0.1 * jump), pytest.approx(0.4 * jump),
                                                         tolerance.final_theta2_rad)
        row = rows[f"{angle}_largest_difference_over_range"]
        assert (row.reduced, row.dem, row.tolerance) == (0, pytest.approx(0.3 / 0.4), tolerance.history_relative)
    residue = 8 - ABOUT
    row = rows["energy_residual_over_largest_energy"]
    assert (row.reduced, row.dem, row.difference) == (pytest.approx(residue / ABOUT), pytest.approx(residue / ABOUT), 0)
    assert len(rows) == 7 and umbrella.energy_residual(runs[0]) == pytest.approx(residue)


@pytest.mark.parametrize("reduced, dem, passed", [(ABOUT, ABOUT, True), (8.0, ABOUT, False), (ABOUT, 8.0, False)])
def test_both_models_of_a_rib_have_to_keep_their_energy(reduced: float, dem: float, passed: bool) -> None:
    runs = [rib_run(OURS, thermal_work_J=work) for work in (reduced, dem)]
    row = by_name(list(umbrella.compare(case_of("umbrella_damped"), *runs).rows))["energy_residual_over_largest_energy"]
    assert row.passed is passed and row.difference == pytest.approx((dem - reduced) / ABOUT)


def test_comparison_of_a_rib_without_damping_ends_at_the_largest_temperature() -> None:
    case = case_of("umbrella_damped", damping__pin_damping_N_m_s_per_rad=0.0)
    found = umbrella.compare(case, rib_run(OURS), rib_run(OTHER))
    rows = by_name(list(found.rows))
    assert found.notes == (umbrella.UNTIL,)
    assert not [name for name in rows if name.endswith("_jump")]
    assert rows["theta2_largest_difference_over_range_until_largest_temperature"].dem == pytest.approx(0.02 / 0.4)
    assert umbrella.largest_temperature(rib_run(OURS, largest=3)) == 3
    # If the program does not close the clearance, neither model has a first contact.
    wide = case_of("umbrella_damped", joint__radial_clearance_m=1e-3)
    rows = by_name(list(umbrella.compare(wide, rib_run(OURS), rib_run(OURS, [Event("first_contact", 0.1, 9.0)])).rows))
    ours, other = (first_contact(rows, name) for name in ("reduced", "DEM"))
    assert ours.passed and ours.closed_form is None and not other.passed and other.dem == 9
    # The clearance is just closed at the largest temperature of the program.
    just = case_of("umbrella_damped", joint__radial_clearance_m=23.75e-6 * 0.12 * 100 * (1 - 1e-12))
    rows = by_name(list(umbrella.compare(just, rib_run(OURS), rib_run(OURS)).rows))
    assert first_contact(rows, "reduced").closed_form == pytest.approx(100)


def test_a_spring_that_does_not_turn_leaves_the_closed_form() -> None:
    for stiffness, bias, holds in ((0.0, 0.05, True), (1.0, 0.0, True), (1.0, 0.05, False)):
        rib = case_of("umbrella_damped", torsion_spring__stiffness_N_m_per_rad=stiffness, torsion_spring__bias_rad=bias)
        assert (umbrella.closed_form_first_contact(rib) is not None) is holds


def test_rows_of_a_rib_without_a_closed_form() -> None:
    case = case_of("umbrella_damped", start__mode="rest")
    runs = [rib_run(OURS, [Event("first_contact", 0.1, 35.0)]), rib_run(OURS, [Event("first_contact", 0.1, 35.0005)])]
    row = by_name(list(umbrella.compare(case, *runs).rows))["first_contact_temperature_change"]
    assert (row.reduced, row.dem, row.tolerance, row.passed) == (35.0, 35.0005, case.tolerance.first_contact_dem_K, True)
    rows = umbrella.difference(case, *runs)
    assert [row.name for row in rows] == [
        "first_contact_temperature_change", "theta2_jump", "theta4_jump", "theta2_largest_difference_over_range",
        "theta4_largest_difference_over_range"]
    assert (rows[0].reduced, rows[0].dem, rows[0].tolerance) == (35.0, 35.0005, case.tolerance.first_contact_dem_K)
    loaded = case_of("umbrella_hold")
    assert loaded.start.mode == "loaded"
    for rows in (umbrella.difference(loaded, *runs), umbrella.compare(loaded, *runs).rows):
        assert not [row for row in rows if row.name.startswith("first_contact")]


# Trusses.
def test_names_and_jumps_of_a_truss() -> None:
    case = case_of("trusses/chain_10")
    count = len(case.node)
    displacement = np.zeros((3, count, 3))
    displacement[0, 4] = 1.0
    displacement[2, 4] = 1.0, 1.0, 1.0
    displacement[2, 2] = 3e-4, 4e-4, 0
    displacement[2, 7, 2] = -1e-3
    displacement[2, 1, 0] = 1e-4
    run = run_of({"time_s": range(3), "displacement_m": displacement})
    assert truss.jump_table(case, run) == [
        (case.node[7].name, 0, 0, -1e-3, 1e-3), (case.node[2].name, 3e-4, 4e-4, 0, pytest.approx(5e-4)),
        (case.node[1].name, 1e-4, 0, 0, 1e-4)]
    assert len(truss.jump_table(case, run, 2)) == 2
    assert truss.reduced_name(run) == "quasi-static solver"
    assert truss.reduced_name(run_of({"velocity_m_per_s": [0]})) .endswith("in motion")


@pytest.mark.parametrize("cycles", [2, 3])
def test_verdict_of_a_truss(cycles: int, monkeypatch: pytest.MonkeyPatch) -> None:
    samples = 10
    case = case_of("trusses/chain_10", thermal__cycles=cycles, output__samples_per_cycle=samples)
    count, nodes, links = samples * cycles + 1, len(case.node), len(case.link)
    phase = np.arange(count) % samples / samples
    heat = 1 - np.abs(2 * phase - 1)
    displacement = np.zeros((count, nodes, 3))
    displacement[:, :, 0] = heat[:, None] * 1e-3 * np.arange(nodes)
    energy = {name: 0 * heat for name in (
        "thermal_work_J", "external_work_J", "elastic_energy_J", "kinetic_energy_J", "friction_dissipation_J",
        "damping_dissipation_J", "impact_dissipation_J")}

    def run(displacement: np.ndarray) -> Run:
        return run_of({"time_s": np.linspace(0, case.duration_s, count), "temperature_change_K": 50 * heat,
                       "displacement_m": displacement, "velocity_m_per_s": 0 * displacement}, energy,
                      {"axial_force_N": np.zeros((count, links))})

    same = truss.compare(case, run(displacement), run(displacement))
    assert same.passed and same.reasons == () and set(same.models) == {"reduced", "dem"}
    other = displacement.copy()
    other[samples * (cycles - 1) + 3, 2, 1] += 5e-4
    missed = truss.compare(case, run(displacement), run(other))
    rows = by_name(list(missed.rows))
    assert ("loop_drift_over_largest_displacement" in rows) == (cycles > 2)
    if cycles > 2:
        row = rows["loop_drift_over_largest_displacement"]
        assert (row.reduced, row.dem) == (0, pytest.approx(5e-4 / (1e-3 * (nodes - 1))))
        assert row.tolerance == case.tolerance.displacement_relative and not row.passed
    # What is missed alone has reasons.
    monkeypatch.setattr(truss, "why_missed", lambda *given: ["too fast"])
    assert truss.compare(case, run(displacement), run(displacement)).reasons == ()
    assert truss.compare(case, run(displacement), run(2 * displacement)).reasons == ("too fast",)


def test_the_end_of_the_last_loop_belongs_to_it() -> None:
    """With four samples per cycle, the ninth sample is the end of the second loop and the start of the third."""
    x = np.zeros(13)
    x[12] = 5e-5
    assert slider.loop_drift(run_of({"displacement_m": x}), 4, 3) == pytest.approx(5e-5)
    nodes = np.zeros((13, 2, 3))
    nodes[12, 1, 2] = 5e-5
    case = SimpleNamespace(samples_per_cycle=4, thermal=SimpleNamespace(cycles=3))
    assert truss.loop_drift_m(case, run_of({"displacement_m": nodes})) == pytest.approx(5e-5)
    early = np.zeros(13)
    early[:4] = 1.0  # in the first loop, which is not compared
    assert slider.loop_drift(run_of({"displacement_m": early}), 4, 3) == 0


# Two files.
def result(case: Any, runs: dict[str, Run], **more: Any) -> Any:
    found = {"kind": case.kind, "case_json": json.dumps(case.to_dict()), "names": {}, "complete": True, "definition": case,
             "models": runs}
    return SimpleNamespace(**{**found, **more})


def two(first: Run, second: Run, **more: Any) -> files.RunDifference:
    case = case_of("table1")
    found = files.difference(result(case, {"reduced": first}), result(case, {"reduced": second}, **more))
    assert len(found) == 1
    return found[0]


def timed(times: Any, x: Any, events: list[Event] | None = None, **more: Any) -> Run:
    return replace(run_of({"time_s": times, "temperature_change_K": times, "displacement_m": x, **more}, events=events,
                          summary={"state_jump_m": float(x[-1])}), model="reduced")


def test_differences_of_cases() -> None:
    case = case_of("table1")
    other = case_of("table1", joint__friction_coefficient=0.2, dem__threads=2, tolerance__drift_relative=0.5)
    physical, numerical = files.case_differences(result(case, {}), result(other, {}))
    assert physical == ["joint.friction_coefficient = 0.3 and 0.2"]
    assert numerical == ["dem.threads = 1 and 2", "tolerance.drift_relative = 0.001 and 0.5"]
    one, long = SimpleNamespace(case_json='{"a": {"b": [1]}, "c": 1}'), SimpleNamespace(case_json=json.dumps({"a": {"b": "x" * 58}, "d": {}}))
    assert files.case_differences(one, long)[0] == [f"a.b = [1] and '{58 * 'x'}'", "c = 1 and None"]
    longer = SimpleNamespace(case_json=json.dumps({"a": {"b": "x" * 59}, "c": 1}))
    assert files.case_differences(one, longer)[0] == ["a.b = [1] and (another list)"]


def refused(first: Any, second: Any) -> StatejumpError:
    with pytest.raises(StatejumpError) as found:
        files.difference(first, second)
    return found.value


def test_files_that_cannot_be_compared() -> None:
    case, run = case_of("table1"), timed([0, 1], [0, 1])
    first = result(case, {"reduced": run})
    assert refused(first, result(case, {"reduced": run}, kind="truss")) == failure("kinds_differ", first="spring_slider", second="truss")
    one = case_of("table1", joint__friction_coefficient=0.2)
    assert refused(first, result(one, {})) == failure("cases_differ", more="")
    both = case_of("table1", joint__friction_coefficient=0.2, joint__normal_force_N=90)
    assert refused(first, result(both, {})).details["more"] == ", and 1 more"
    three = case_of("table1", joint__friction_coefficient=0.2, joint__normal_force_N=90, link__poisson_ratio=0.2)
    assert refused(first, result(three, {})).details["more"] == ", and 2 more"
    assert refused(first, result(case, {}, names={"links": ["a"]})) == failure("result_items_differ")
    assert refused(first, result(case, {})) == failure("result_without_run") == refused(result(case, {}), first)
    for end, apart in ((1 + 0.9e-9, False), (1 + 1.2e-9, True), (1 - 1.2e-9, True), (2.0, True)):
        second = result(case, {"reduced": timed([0, end], [0, 1])})
        if apart:
            assert refused(first, second) == failure("durations_differ", first_s=1.0, second_s=end)
        else:
            assert files.difference(first, second)[0].rows is not None
    long = result(case, {"reduced": timed([0, 100], [0, 1])})
    assert files.difference(long, result(case, {"reduced": timed([0, 100 * (1 + 0.9e-9)], [0, 1])}))[0].rows is not None
    assert refused(long, result(case, {"reduced": timed([0, 100 * (1 + 1.2e-9)], [0, 1])})) == failure("durations_differ")
    # Numerical parts may differ.
    assert files.difference(first, result(case_of("table1", dem__threads=2), {"reduced": run}))


def test_which_runs_are_compared() -> None:
    case, run = case_of("table1"), timed([0, 1], [0, 1])

    def pairs(first: list[str], second: list[str]) -> list[tuple[str, str]]:
        return files.pairs(*(result(case, {name: run for name in names}) for names in (first, second)))

    assert pairs(["reduced", "dem"], ["dem", "reduced"]) == [("reduced", "reduced"), ("dem", "dem")]
    alone = files.difference(result(case, {"dem": run}), result(case, {"reduced": timed([0, 1], [0, 3])}))
    assert [one.names for one in alone] == [("dem", "reduced")] and alone[0].columns[-1].largest == 2
    assert pairs(["reduced"], ["reduced", "dem"]) == [("reduced", "reduced")] and pairs(["dem"], ["reduced"]) == [("dem", "reduced")]


def test_columns_of_two_files() -> None:
    ours = timed([0, 1, 2, 4], [0, 2, 6, 4], [Event("first_slip", 1, 5.0), Event("first_slip", 2, 7.0), Event("stop", 2, 8.0)],
                 push_N=[nan, 1, 1, inf], own_N=[1, 1, 1, 1])
    state = Column(np.array([0, 1, 1, 0]), labels=("a", "b"))
    ours = replace(ours, history={**ours.history, "state": state})
    other = timed([0, 2, 4], [0, 5, 7], [Event("first_slip", 1, 5.5), Event("left", 2, 9.0)], push_N=[nan, 1, inf], lone_N=[1, 1, 1])
    other = replace(other, history={**other.history, "state": Column(np.array([0, 0, 1]), labels=("a", "b"))},
                    energy={"work_J": Column(np.zeros(3))}, summary={"state_jump_m": 7.5, "loops": 1.0})
    found = two(ours, other)
    columns = {one.name: one for one in found.columns}
    # At the times of the first run: 0, 2.5, 5, 7.
    assert set(columns) == {"history/temperature_change_K", "history/displacement_m", "history/push_N"}
    x = columns["history/displacement_m"]
    assert (x.largest, x.time_s, x.range) == (3, 4, 6)
    assert columns["history/push_N"].largest == 0
    assert found.names == ("reduced", "reduced") and found.lacking == ["energy/work_J", "history/lone_N", "history/own_N"]
    assert found.not_finite == ["history/push_N"]  # at 1 s, where the second run lies between NaN and 1
    events = {one.kind: (one.counts, one.first_K) for one in found.events}
    assert events == {"first_slip": ((2, 1), (5.0, 5.5)), "stop": ((1, 0), (8.0, None)), "left": ((0, 1), (None, 9.0))}
    summary = {row[0]: row[1:] for row in found.summary}
    assert summary["state_jump_m"] == ("m", 4, 7.5) and isnan(summary["loops"][1]) and summary["loops"][2] == 1
    assert found.rows is not None and [row.first for row in found.rows if row.name == "state_jump"] == [4]
    assert found.missed[0] == "state_jump" and [one.split()[0] for one in found.missed[-4:]] == [
        *found.lacking, "history/push_N"]
    between = replace(found, names=("reduced", "dem"))
    assert between.missed[-1] == "history/push_N (not finite)" and not [name for name in between.missed if "only" in name]
    assert replace(found, rows=None, lacking=[], not_finite=[]).missed == []


def test_a_sample_is_itself_beside_one_that_is_no_number() -> None:
    run = timed([0, 1, 2, 3], [1, 2, nan, inf]).at(np.array([0, 0.5, 1, 1.5, 2, 3, 4]))
    assert np.array_equal(run["displacement_m"], [1, 1.5, 2, nan, nan, inf, inf], equal_nan=True)


def test_columns_over_items() -> None:
    times = np.arange(3.0)
    force = np.zeros((3, 2, 3))
    force[1, 1, 2], force[2, 0, 0] = -4.0, 3.0
    runs = [replace(timed(times, [0, 1, 2]), links={"force_N": Column(values), "gone_N": Column(nan * values)})
            for values in (force, 0 * force)]
    columns = {one.name: one for one in two(*runs).columns}
    assert (columns["links/force_N"].largest, columns["links/force_N"].time_s, columns["links/force_N"].range) == (4, 1, 7)
    assert "links/gone_N" not in columns  # nowhere a number
    assert two(*runs).not_finite == []
    lost = [runs[0], replace(runs[1], links={**runs[1].links, "gone_N": Column(0 * force)})]
    assert two(*lost).not_finite == ["links/gone_N"]


def test_a_file_that_is_not_complete_is_not_judged() -> None:
    found = two(timed([0, 1, 2, 3], [0, 1, 2, 3]), timed([0, 1, 2], [0, 1, 5]), complete=False)
    assert found.rows is None and {one.name: one.largest for one in found.columns}["history/displacement_m"] == 3
    assert [one.time_s for one in found.columns if one.name == "history/displacement_m"] == [2]
    found = two(timed([0, 1], [0, 1]), timed([0, 1, 2], [0, 1, 5]), complete=False)
    assert {one.name: one.largest for one in found.columns}["history/displacement_m"] == 0
