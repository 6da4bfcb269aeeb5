# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user meets on the first day: warnings of wrong units, names of files, choices that are printed."""
from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import statejump as sj
from conftest import Outcome

TABLE1 = {"thermal.temperature_change_max_K": 200.0}
RING = {"thermal.temperature_change_max_K": 150.0}


@pytest.mark.parametrize("case, changes, sentence", [
    ("table1", {**TABLE1, "link.young_modulus_Pa": 7e5, "joint.normal_force_N": 1e-3},
     "link 'bar': Young's modulus of 7e+05 Pa is below 1 MPa; check the units"),
    ("table1", {**TABLE1, "joint.young_modulus_Pa": 70.0},
     "joint 'block': Young's modulus of 70 Pa is below 1 MPa; check the units"),
    ("table1", {**TABLE1, "link.thermal_expansion_per_K": 1e-3},
     "link 'bar': thermal strain of 0.2 is above 10 %; the models are for small strains, check the units"),
    ("table1", {**TABLE1, "link.thermal_expansion_per_K": 1e-3}, "link 'bar': axial strain of 0.165 is above 10 %; "
     "the models are for small strains, check the units"),
    ("umbrella", {"joint.radial_clearance_m": 0.02, "thermal.temperature_change_max_K": 0.0},
     "joint 'B': the radial clearance of 0.02 m is above the radius of 0.005 m; check the units"),
    ("ring_12", {**RING, "revolute.joint3.radial_clearance_m": 0.02},
     "revolute 'joint3': the radial clearance of 0.02 m is above the radius of 0.01 m; check the units"),
    ("ring_12", {**RING, "revolute.*.young_modulus_Pa": 7e5},
     "revolute 'joint0' and 11 others: Young's modulus of 7e+05 Pa is below 1 MPa; check the units"),
    ("ring_12", {**RING, "link.radial0.thermal_expansion_per_K": 9e-4},
     "link 'radial0': thermal strain of 0.135 is above 10 %; the models are for small strains, check the units"),
])
def test_implausible_values_are_warnings(case: str, changes: dict[str, Any], sentence: str) -> None:
    changed = sj.load(case).changed(changes)
    found = changed.reduced().warnings if "axial" in sentence else changed.definition.implausible
    assert sentence in found


def test_shipped_cases_are_plausible(cases: Path) -> None:
    for file in [*cases.glob("*.toml"), *cases.glob("trusses/*.toml")]:
        assert not sj.load(file).definition.implausible, file


def test_a_run_prints_what_is_implausible(statejump: Callable[..., Outcome], edited: Callable[..., Path]) -> None:
    case = edited(("young_modulus_Pa = 70e9", "young_modulus_Pa = 70e4"),
                  ("normal_force_N = 100", "normal_force_N = 0.001"))
    done = statejump("reduced", case)
    assert done.status == 0, done.errors
    assert "warning: link 'bar': Young's modulus of 7e+05 Pa is below 1 MPa" in done.output


def test_a_reference_temperature_in_degrees(tmp_path: Path) -> None:
    (tmp_path / "day.csv").write_text("time_s,bar_K\n0,20\n10,120\n20,20\n")
    text = Path(sj.load("table1").definition.origin.file or "").read_text()
    begin = text.index("[thermal]")
    end = text.index("\n[", begin + 1)
    for reference, count in ((20.0, 1), (99.9, 1), (100.0, 0)):
        (tmp_path / "case.toml").write_text(
            f'{text[:begin]}[thermal]\nshape = "table"\ntable_file = "day.csv"\nreference_temperature_K = {reference}\n'
            f'lead_in_s = 5\nlead_out_s = 5\n{text[end:]}')
        with pytest.warns() as found:
            sj.load(tmp_path / "case.toml")
            import warnings
            warnings.warn("the last one")
        assert len(found) == count + 1
        if count:
            assert str(found[0].message).startswith(f"thermal.reference_temperature_K = {reference:g} is taken as kelvin")


NODES = "name,x [mm],y [mm],fixed\nA,0,0,xy\nB,1000,0,xy\nC,500,800,\nD,500,0,xy\n"
BARS = ("name,first,second,young_modulus_Pa,cross_section_area_m2,thermal_expansion_per_K\n"
        "a,A,C,7e10,1e-4,2e-5\nb,B,C,7e10,1e-4,2e-5\nd,D,C,7e10,1e-4,2e-5\n")


@pytest.fixture
def tables(tmp_path: Path) -> Path:
    (tmp_path / "nodes.csv").write_text(NODES)
    (tmp_path / "bars.csv").write_text(BARS)
    return tmp_path


def imported(statejump: Callable[..., Outcome], *more: str) -> Outcome:
    return statejump("truss", "import", "nodes.csv", "--bars", "bars.csv", "--temperature-change", "50", "-o", "t.toml",
                     *more)


def test_units_beside_columns_that_name_theirs(statejump: Callable[..., Outcome], tables: Path) -> None:
    for option, value, said in (("--length-unit", "0.001", 0.001), ("--force-unit", "1000", 1000.0),
                                ("--units", "mm-N", "mm-N")):
        done = imported(statejump, option, value)
        assert (done.status, done.errors) == (
            2, f"error: nodes.csv: {option} = {said!r} is not allowed: columns of tables name their units\n")
    assert imported(statejump, "--units", "SI").status == 0
    assert sj.load(tables / "t.toml")["node.B.position_m"] == [1.0, 0.0]


def test_the_bearing_that_an_import_chose(statejump: Callable[..., Outcome], tables: Path) -> None:
    joint = "node=C,link=a,journal_radius_m=0.01,radial_clearance_m=1e-5,friction_coefficient=0.2"
    done = imported(statejump, "--joint", joint)
    assert done.status == 0, done.errors
    assert ("chosen: revolute 'R_C_a': bearing_link = 'b'; 'd' could be it as well, bearing_link=NAME in --joint chooses"
            in done.output)
    done = imported(statejump, "--force", "--joint", f"{joint},bearing_link=d")
    assert done.status == 0 and "chosen" not in done.output
    assert sj.load(tables / "t.toml")["revolute.R_C_a.bearing_link"] == "d"


@pytest.mark.parametrize("words, suffixes", [
    (("report", "results", "-o", "page.pdf"), ".html or .htm"),
    (("truss", "chain", "3", "-o", "chain.json"), ".toml"),
    (("schema", "-o", "schema.toml"), ".json"),
    (("orbit", "members.csv", "--period", "5400", "-o", "orbit.xlsx"), ".csv"),
    (("fclib", "solve", "a.hdf5", "-o", "solved.mat"), ".hdf5 or .h5"),
])
def test_a_suffix_of_another_format(statejump: Callable[..., Outcome], tmp_path: Path, words: tuple[str, ...],
                                    suffixes: str) -> None:
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "a.h5").touch()
    done = statejump(*words)
    assert (done.status, done.errors) == (
        2, f"error: --output = {words[-1]!r} is not allowed: the file must end with {suffixes}\n")
    assert not (tmp_path / words[-1]).exists()


@pytest.mark.parametrize("words, why", [
    (("compare", "trusses/chain_10"), "YADE is missing"), (("control", "--dem", "table1"), "YADE is missing"),
    (("convergence", "table1"), "YADE is missing"), (("compare", "trusses/four_bar"), "error: case four_bar: drive 'motor'"),
])
def test_what_the_dem_needs_is_checked_first(statejump: Callable[..., Outcome], cases: Path, tmp_path: Path,
                                             words: tuple[str, ...], why: str) -> None:
    done = statejump(*words[:-1], cases / f"{words[-1]}.toml", STATEJUMP_YADE="no-such-yade")
    assert (done.status, done.output) == (2, "") and why in done.errors
    assert not (tmp_path / "results").exists()
