# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that are not finite: a verdict on such a value fails and names it, and no value is dropped silently."""
from __future__ import annotations

import math
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from statejump import load
from statejump.core.case import Case
from statejump.core.comparison import Comparison, models, share
from statejump.core.run import Run
from statejump.results.difference import difference
from statejump.results.read import read
from statejump.results.record import save

NAN = float("nan")


@pytest.mark.parametrize("values, expected", [
    ((0.0, 0.0), 0.0), ((1.0, 2.0), 0.5), ((-1.0, 2.0), -0.5), ((1.0, 0.0), math.inf), ((-1.0, 0.0), -math.inf),
    ((0.0, 2.0), 0.0), ((1.0, -1.0), math.inf),
])
def test_share(values: tuple[float, float], expected: float) -> None:
    assert share(*values) == expected


@pytest.mark.parametrize("values", [(NAN, 1.0), (1.0, NAN), (0.0, NAN), (NAN, NAN)])
def test_share_of_no_number_is_none(values: tuple[float, float]) -> None:
    assert math.isnan(share(*values))


def test_share_of_no_number_without_scale_is_not_finite() -> None:
    assert not math.isfinite(share(NAN, 0.0))


@pytest.mark.parametrize("values", [(NAN, 0.0), (0.0, NAN), (math.inf, math.inf), (0.0, -math.inf)])
def test_row_that_is_not_finite_fails(values: tuple[float, float]) -> None:
    row = models("a", "-", *values, 1.0)
    assert not row.passed and not row.finite


# The columns that each kind's rows read.
SHORT = {
    "table1": {},
    "umbrella_damped": {"reduced.steps_per_cycle": 20000, "dem.steps_per_cycle": 20000},
    "trusses/chain_10": {},
}


def case_of(cases: Path, name: str) -> Case:
    return load(cases / f"{name}.toml").changed(SHORT[name])


def as_dem(case: Case, run: Run) -> Run:
    """The reduced run in the form of a DEM run; energies that only the DEM records are zero."""
    zero = replace(next(iter(run.energy.values())), values=np.zeros(len(run)))
    names = {"elastic_energy_J", "kinetic_energy_J", "contact_energy_J", "preload_energy_J", "damping_dissipation_J",
             "friction_dissipation_J", "thermal_work_J", "external_work_J"}
    energy = dict(run.energy) if case.kind == "umbrella" else {**dict.fromkeys(names, zero), **run.energy}
    history = dict(run.history)
    if case.kind == "spring_slider":
        flags = {"slipping": np.isin(run["stage"], ("S2", "S5")), "stop_contact": np.abs(run["displacement_m"]) > 9e-4}
        history |= {name: replace(run.history["time_s"], values=values.astype(float)) for name, values in flags.items()}
    return replace(run, model="dem", history=history, energy=energy, sampler=None)


def rows_of(case: Case, reduced: Run, dem: Run) -> Comparison:
    return case.definition.behaviour.compare(case.definition, reduced, dem)


def spoilt(run: Run, group: str, name: str, value: float, place: int | None = None) -> Run:
    column = getattr(run, group)[name]
    values = np.array(column.values, dtype=float)
    values[slice(None) if place is None else place] = value
    return replace(run, **{group: {**getattr(run, group), name: replace(column, values=values)}}, sampler=None)


@pytest.mark.parametrize("name", SHORT)
def test_energies_that_are_none_fail_by_name(cases: Path, name: str) -> None:
    case = case_of(cases, name)
    reduced = case.reduced()
    dem = as_dem(case, reduced)
    assert not [row for row in rows_of(case, reduced, dem).rows if not row.finite]
    for column in dem.energy:
        dem = spoilt(dem, "energy", column, NAN)
    missed = rows_of(case, reduced, dem).missed
    assert [row for row in missed if row.startswith("energy_residual")], missed


@pytest.mark.parametrize("value", [NAN, math.inf])
@pytest.mark.parametrize("name", ["umbrella_damped", "trusses/chain_10"])
def test_one_energy_that_is_none_fails(cases: Path, name: str, value: float) -> None:
    case = case_of(cases, name)
    reduced = case.reduced()
    dem = as_dem(case, reduced)
    for column in ("friction_dissipation_J", "thermal_work_J", "kinetic_energy_J"):
        missed = rows_of(case, reduced, spoilt(dem, "energy", column, value, -1)).missed
        assert [row for row in missed if row.startswith("energy_residual")], (column, missed)


def test_either_residue_of_the_umbrella_can_miss(cases: Path) -> None:
    case = case_of(cases, "umbrella_damped")
    runs = [case.reduced(), as_dem(case, case.reduced())]
    for side in (0, 1):
        # A residue of twice the tolerance in one model only.
        largest = max(float(np.max(np.abs(column.values))) for column in runs[side].energy.values())
        off = list(runs)
        column = runs[side].energy["friction_dissipation_J"].values
        off[side] = spoilt(runs[side], "energy", "friction_dissipation_J",
                           float(column[-1]) + 100 * case["tolerance.energy_balance_relative"] * largest, -1)
        assert "energy_residual_over_largest_energy" in rows_of(case, *off).missed


@pytest.mark.parametrize("name", ["table1", "trusses/chain_10"])
def test_later_cycle_that_is_none_is_noticed(cases: Path, name: str) -> None:
    """Python's max() drops a NaN that does not come first."""
    case = case_of(cases, name).changed({"thermal.cycles": 4})
    reduced = case.reduced()
    dem = spoilt(as_dem(case, reduced), "history", "displacement_m", NAN, 3 * case.definition.samples_per_cycle - 5)
    assert "loop_drift_over_largest_displacement" in rows_of(case, reduced, dem).missed


def test_case_without_expansion_agrees(cases: Path) -> None:
    """Nothing moves and nothing differs: no 0/0."""
    case = load(cases / "table1.toml").changed({"link.thermal_expansion_per_K": 0.0, "thermal.cycles": 3})
    reduced = case.reduced()
    found = rows_of(case, reduced, as_dem(case, reduced))
    assert found.passed, found.missed
    moved = spoilt(as_dem(case, reduced), "history", "displacement_m", 1e-3, 100)
    assert "displacement_rms_over_largest" in rows_of(case, reduced, moved).missed


def written(case: Case, run: Run, folder: Path) -> Path:
    folder.mkdir()
    return save("reduced", case.definition, {"reduced": run}, folder)


def test_two_files(cases: Path, tmp_path: Path, statejump) -> None:
    case = load(cases / "table1.toml")
    run = case.reduced()
    whole = written(case, run, tmp_path / "whole")
    lacking = replace(run, history={name: column for name, column in run.history.items() if name != "axial_force_N"})
    for name, other, sentence in (
        ("lacking", lacking, "history/axial_force_N (in one file only)"),
        ("none", spoilt(run, "history", "axial_force_N", NAN), "history/axial_force_N (not finite)"),
        ("once", spoilt(run, "energy", "elastic_energy_J", math.inf, 7), "energy/elastic_energy_J (not finite)"),
    ):
        path = written(case, other, tmp_path / name)
        for files in ((whole, path), (path, whole)):
            outcome = statejump("compare", *files)
            assert outcome.status == 1 and sentence in outcome.errors, outcome.errors
        assert statejump("compare", path, path).status == 0
    found = difference(read(whole), read(whole))[0]
    assert found.missed == [] and found.lacking == [] and found.not_finite == []


@pytest.mark.parametrize(("name", "group", "column"), [("table1", "history", "displacement_m"),
                                                       ("trusses/chain_10", "links", "axial_force_N")])
def test_numbers_without_an_end_are_compared_without_a_warning(
        name: str, group: str, column: str, cases: Path, tmp_path: Path) -> None:
    case = case_of(cases, name)
    run = case.reduced()
    for place, value in enumerate((math.inf, 1e200)):
        path = written(case, spoilt(run, group, column, value), tmp_path / str(place))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found = difference(read(path), read(path))[0]
        assert not found.not_finite  # both files have the same
