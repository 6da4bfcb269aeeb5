# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages for new users: warnings of wrong units, names of files, printed choices."""
from __future__ import annotations

import copy
import pickle
import re
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import statejump as sj
from conftest import BUILT, Outcome
from failures import Failure, failing, failure, note
from statejump.campaign.summary import statistics
from statejump.core.comparison import models
from statejump.core.run import Events
from statejump.report.labels import of_kind

TABLE1 = {"thermal.temperature_change_max_K": 200.0}
RING = {"thermal.temperature_change_max_K": 150.0}


@pytest.mark.parametrize(("case", "changes", "expected"), [
    ("table1", {**TABLE1, "link.young_modulus_Pa": 7e5, "joint.normal_force_N": 1e-3},
     note("modulus_implausible", what="link", name="bar", young_modulus_Pa=7e5, items=1)),
    ("table1", {**TABLE1, "joint.young_modulus_Pa": 70.0},
     note("modulus_implausible", what="joint", name="block", young_modulus_Pa=70.0, items=1)),
    ("table1", {**TABLE1, "link.thermal_expansion_per_K": 1e-3},
     note("strain_implausible", what="link", name="bar", cause="thermal", strain=0.2, items=1)),
    ("table1", {**TABLE1, "link.thermal_expansion_per_K": 1e-3},
     note("strain_implausible", what="link", name="bar", cause="axial", strain=pytest.approx(0.165, abs=5e-4))),
    ("umbrella", {"joint.radial_clearance_m": 0.02, "thermal.temperature_change_max_K": 0.0},
     note("clearance_above_radius", what="joint", name="B", clearance_m=0.02, radius_m=0.005, items=1)),
    ("ring_12", {**RING, "revolute.joint3.radial_clearance_m": 0.02},
     note("clearance_above_radius", what="revolute", name="joint3", clearance_m=0.02, radius_m=0.01, items=1)),
    ("ring_12", {**RING, "revolute.*.young_modulus_Pa": 7e5},
     note("modulus_implausible", what="revolute", name="joint0", young_modulus_Pa=7e5, items=12)),
    ("ring_12", {**RING, "link.radial0.thermal_expansion_per_K": 9e-4},
     note("strain_implausible", what="link", name="radial0", cause="thermal", strain=0.135, items=1)),
])
def test_implausible_values_are_warnings(case: str, changes: dict[str, Any], expected: Failure) -> None:
    changed = sj.load(case).changed(changes)
    axial = expected.fields.get("cause") == "axial"
    assert expected in (changed.reduced().warnings if axial else changed.definition.implausible)


def test_shipped_cases_are_plausible(cases: Path) -> None:
    for file in [*cases.glob("*.toml"), *cases.glob("trusses/*.toml")]:
        assert not sj.load(file).definition.implausible, file


def test_a_run_prints_what_is_implausible(statejump: Callable[..., Outcome], edited: Callable[..., Path]) -> None:
    case = edited(("young_modulus_Pa = 70e9", "young_modulus_Pa = 70e4"),
                  ("normal_force_N = 100", "normal_force_N = 0.001"))
    done = statejump("reduced", case)
    assert done.status == 0, done.errors
    implausible, = sj.load(case).definition.implausible
    assert implausible == note("modulus_implausible", name="bar") and f"warning: {implausible}" in done.output


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
            warnings.warn("the last one")
        assert len(found) == count + 1
        if count:
            assert found[0].message.args[0] == note(
                "reference_in_kelvin", key="thermal.reference_temperature_K", given=reference)


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
        assert (done.status, done.failure) == (2, failure("units_in_columns", key=option, value=said, file="nodes.csv"))
    assert imported(statejump, "--units", "SI").status == 0
    assert sj.load(tables / "t.toml")["node.B.position_m"] == [1.0, 0.0]


def test_the_bearing_that_an_import_chose(statejump: Callable[..., Outcome], tables: Path) -> None:
    joint = "node=C,link=a,journal_radius_m=0.01,radial_clearance_m=1e-5,friction_coefficient=0.2"
    done = imported(statejump, "--joint", joint)
    assert done.status == 0, done.errors
    assert re.search(r"revolute 'R_C_a': bearing_link = 'b'; 'd' .* --joint ", " ".join(done.output.split()))
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
    assert (done.status, done.failure) == (2, failure("wrong_suffix", suffixes=suffixes))
    assert not (tmp_path / words[-1]).exists()


@pytest.mark.parametrize("words, why", [
    (("compare", "trusses/chain_10"), failure("yade_missing")), (("control", "--dem", "table1"), failure("yade_missing")),
    (("convergence", "table1"), failure("yade_missing")), (("compare", "trusses/four_bar"), failure("driven_truss", drive="motor")),
])
def test_what_the_dem_needs_is_checked_first(statejump: Callable[..., Outcome], cases: Path, tmp_path: Path,
                                             words: tuple[str, ...], why: Failure) -> None:
    done = statejump("--json", *words[:-1], cases / f"{words[-1]}.toml", STATEJUMP_YADE="no-such-yade")
    assert (done.status, done.output) == (2, "") and done.failure == why
    assert not (tmp_path / "results").exists()


# ---------------------------------------------------------------- Python


@pytest.mark.parametrize("name", ["table1", "umbrella_8", "ring_12"])
def test_runs_are_pickled_and_saved(tmp_path: Path, name: str) -> None:
    run = sj.load(name).reduced()
    file = run.save(tmp_path / "run.h5")
    again = sj.read(file).models["reduced"]
    kept = pickle.loads(pickle.dumps(again))  # of a file as well
    for other in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run), again, kept):
        assert other.definition == run.definition and other.summary == run.summary and other.events == run.events
        for group in ("history", "energy", "links", "contacts"):
            assert getattr(other, group).keys() == getattr(run, group).keys()
            for key, column in getattr(run, group).items():
                assert np.array_equal(getattr(other, group)[key].values, column.values, equal_nan=True), key
        assert other.native is None and other.at(0.5).time_s == [0.5]
    assert run.save(tmp_path / "other").name == "other.h5"
    with failing("wrong_suffix", key="path", suffixes=".h5"):
        run.save(tmp_path / "run.csv")


def test_comparisons_are_pickled_and_saved(tmp_path: Path) -> None:
    run = sj.load("table1").reduced()
    rows = (models("state_jump", "m", 1.0, 1.5, 0.6), models("drift", "m", 0.0, None, 0.1))
    both = sj.Comparison(run.definition, {"reduced": run, "dem": replace(run, model="dem")}, rows)
    kept = pickle.loads(pickle.dumps(both))
    assert (kept.rows, kept.passed, kept.case) == (both.rows, both.passed, both.case)
    read = sj.read(both.save(tmp_path / "both.h5"))
    assert set(read.models) == {"reduced", "dem"} and read.passed == both.passed
    with failing("one_run_of_a_model", key="path"):
        sj.compare(run, run).save(tmp_path / "two.h5")


@pytest.mark.parametrize("name", ["table1", "umbrella", "ring_12", "latch_boom", "statics_slot", "umbrella_8"])
def test_cases_are_written_as_toml(tmp_path: Path, name: str) -> None:
    case = sj.load(name)
    changed = case.changed({"thermal.temperature_change_max_K": 12.5}) if "thermal" in dir(case) else case
    (tmp_path / "text.toml").write_text(changed.to_toml())
    for file in (tmp_path / "text.toml", changed.save(tmp_path / "saved")):
        assert sj.load(file) == changed and sj.load(file) != case.changed({"case.title": "another"})
    with failing("wrong_suffix", key="path", suffixes=".toml"):
        case.save(tmp_path / "case.json")


def test_a_case_with_histories_of_members_is_written(tmp_path: Path) -> None:
    chain = sj.truss.chain(2).to_dict()
    names = [link["name"] for link in chain["link"]]
    (tmp_path / "day.csv").write_text("time_s," + ",".join(f"{name}_K" for name in names) + "\n0" + ",293" * len(names)
                                      + "\n10" + ",313.25" * len(names) + "\n20" + ",293" * len(names) + "\n")
    text = sj.truss.chain(2).to_toml()
    begin = text.index("[thermal]")
    end = text.find("\n[", begin + 1)
    (tmp_path / "case.toml").write_text(
        f'{text[:begin]}[thermal]\nshape = "table"\nmembers_file = "day.csv"\nreference_temperature_K = 293.0\n'
        + (text[end:] if end > 0 else ""))
    case = sj.load(tmp_path / "case.toml")
    (tmp_path / "there").mkdir()
    assert sj.load(case.save(tmp_path / "there" / "mine.toml")) == case
    with failing("members_file_not_in_text", key="thermal.members"):
        case.to_toml()


def test_names_that_are_not_there_are_suggested() -> None:
    run = sj.load("table1").reduced()
    for get, sentence in (
        (lambda: run.column("displacement_m"),
         failure("misspelt_key", key="column 'displacement_m'", meant="history/displacement_m")),
        (lambda: run.column("history/displacment_m"),
         failure("misspelt_key", key="column 'history/displacment_m'", meant="history/displacement_m")),
        (lambda: run["gap_m"], failure("misspelt_key", key="column 'gap_m'", meant="contacts/gap_m")),
        (lambda: run.history["dispalcement_m"], failure("misspelt_key", key="column 'dispalcement_m'", meant="displacement_m")),
        (lambda: run.summary["state_jump"], failure("misspelt_key", key="number 'state_jump'", meant="state_jump_m")),
        (lambda: run.frame(["histroy"]), failure("misspelt_key", key="group 'histroy'", meant="history")),
    ):
        with pytest.raises(sj.StatejumpError) as refused:
            get()
        assert refused.value == sentence
    with pytest.raises(KeyError):
        run["nothing"]
    assert np.array_equal(run["history/displacement_m"], run["displacement_m"])
    assert run["contacts/gap_m"].shape == (len(run), 3)


def test_a_run_at_one_time() -> None:
    for run in (sj.load("table1").reduced(), sj.load("chain_10").reduced()):
        assert run.at(0.5).time_s.tolist() == [0.5] == run.at([0.5]).time_s.tolist() == run.at(np.float32(0.5)).time_s
        for wrong in ("now", None, [[0.1]], float("nan")):
            with failing("no_times", key="times_s"):
                run.at(wrong)  # type: ignore[arg-type]


def test_numbers_of_numpy() -> None:
    case = sj.load("ring_12")
    changed = case.changed({
        "revolute.*.friction_coefficient": np.float32(0.25), "thermal.cycles": np.int64(2),
        "thermal.return_to_reference": np.bool_(True), "node.hub.position_m": np.zeros(2, np.float32)})
    assert changed["revolute.*.friction_coefficient"] == 0.25 and type(changed.thermal.cycles) is int
    assert sj.load({**case.to_dict(), "output": {"samples_per_cycle": np.int32(50)}})["output.samples_per_cycle"] == 50
    assert sj.truss.ring(np.int64(6), radial_clearance_m=np.float64(2e-5))["revolute.*.radial_clearance_m"] == 2e-5
    table = sj.load("table1")
    for values in (0.25, np.float32(0.25), [0.25], (np.float64(0.25),), np.array(0.25)):
        frame = sj.sweep(table, {"joint.friction_coefficient": values}).frame()
        assert frame["joint.friction_coefficient"].tolist() == [0.25]
    drawn = sj.montecarlo(table, {"joint.friction_coefficient": {
        "distribution": "uniform", "low": np.float32(0.25), "high": np.float64(0.5)}}, samples=2)
    assert drawn.failed == 0
    with failing("distribution_not_dict", key="distributions['joint.friction_coefficient']", value=0.3):
        sj.montecarlo(table, {"joint.friction_coefficient": 0.3})  # type: ignore[dict-item]


def test_patterns_of_items() -> None:
    case = sj.load("ring_12").changed({"revolute.joint1*.friction_coefficient": 0.25})
    own = sj.load("ring_12")["revolute.joint0.friction_coefficient"]
    assert [item.friction_coefficient == 0.25 for item in case.revolute] == [
        item.name in ("joint1", "joint10", "joint11") for item in case.revolute] and own != 0.25
    assert case["revolute.joint1?.friction_coefficient"] == 0.25
    with failing("several_values", key="revolute.joint*.friction_coefficient", path="revolute.joint*.friction_coefficient"):
        case["revolute.joint*.friction_coefficient"]
    with failing("no_item_fits", key="revolute.jiont*.friction_coefficient", table="revolute", pattern="jiont*"):
        case.changed({"revolute.jiont*.friction_coefficient": 0.1})
    key = "revolute.joint1*.friction_coefficient"
    jumps = sj.sweep(case, {key: [0.25, 0.3]}).frame()
    one_by_one = [case.changed({key: value}).reduced().summary["largest_jump_m"] for value in (0.25, 0.3)]
    assert jumps["largest_node_jump_m"].tolist() == pytest.approx(one_by_one, rel=1e-12)
    random = sj.montecarlo(case, {key: {"distribution": "normal", "relative": 0.1}}, samples=2)
    assert len(random.plan.vary[0].items) == 3
    with failing("duplicate_vary", item="vary['revolute.joint10.friction_coefficient']", key="key", value="revolute.joint10.friction_coefficient"):
        sj.sweep(case, {key: [0.25], "revolute.joint10.friction_coefficient": [0.3]})


def test_what_completion_offers() -> None:
    offered = [name for name in dir(sj.load("table1")) if not name.startswith("_")]
    assert {"joint", "link", "thermal", "tolerance", "save", "changed"} <= set(offered)
    assert {"node", "revolute", "reflector"} <= set(dir(sj.load("ring_12")))
    for module in (sj.truss, sj.surface, sj.fclib, sj.laws):
        assert dir(module) == sorted(module.__all__)


def test_types_are_announced() -> None:
    assert (BUILT / "statejump" / "py.typed").is_file()  # without it programs that check types see none (PEP 561)


def test_a_workbook(statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    run = sj.load("table1").reduced()
    run = replace(run, events=Events([*run.events, sj.Event("slip", 1.0, 0.0, "=1+1")]),
                  summary={**run.summary, "never_s": float("nan")})
    run.save(tmp_path / "run.h5")
    done = statejump("export", "run.h5", "--format", "xlsx", "--to", "sheets")
    assert done.status == 0, done.errors
    book = openpyxl.load_workbook(tmp_path / "sheets" / "run.xlsx")
    assert book.sheetnames == ["reduced summary", "reduced events", "reduced history"]
    rows = [[cell.value for cell in row] for row in book["reduced history"].iter_rows()]
    columns = run.flat()
    assert rows[0] == list(columns) and len(rows) == len(run) + 1
    for place, values in enumerate(columns.values()):  # 16 digits: half a unit of the last one is 5e-16
        read = [row[place] for row in rows[1:]]
        assert read == (values.tolist() if values.dtype.kind == "U" else pytest.approx(values.tolist(), rel=1e-15, abs=0))
    last = list(book["reduced events"].iter_rows())[-1]
    assert (last[3].value, last[3].data_type) == ("=1+1", "s")  # a name is no formula
    summary = {row[0].value: row[2].value for row in book["reduced summary"].iter_rows()}
    assert summary["state_jump_m"] == pytest.approx(run.summary["state_jump_m"], rel=1e-15) and summary["never_s"] is None


def test_extremes_name_their_samples() -> None:
    found = statistics(np.array([np.nan, 2.0, -3.0, np.inf, 5.0, 5.0]))
    assert (found["minimum"], found["minimum_sample"], found["maximum"], found["maximum_sample"]) == (-3.0, 2, 5.0, 4)
    assert statistics(np.array([np.nan]))["maximum_sample"] is None
    swept = sj.sweep(sj.load("table1"), {"joint.friction_coefficient": [0.1, 0.3, 0.2]})
    table = swept.summary_lines()[0]
    assert not isinstance(table, str)
    row = dict(zip(table.header[-3:], next(row for row in table.rows if row[0] == "state_jump_m")[-3:]))
    assert table.header[-2:] == ("largest", "in sample") and row["in sample"] == "1"
    assert swept.frame()["state_jump_m"].idxmax() == 1


def test_no_key_is_named_best_unless_it_is_free() -> None:
    chain, said = sj.truss.chain(2), "--free KEY"
    found = sj.truss.control(chain, node="N2", jump_below=1e-4)
    assert "best_scale" not in found.recommendation and said in found.sentences[-1]
    found = sj.truss.control(chain, node="N2", scale=["slider.*.friction_coefficient", "slider.*.normal_force_N"])
    assert found.recommendation["best_scale"].startswith("scale slider.*.") and said not in found.sentences[-1]


def test_wall_time_includes_start_and_figures(statejump_process: Callable[..., Outcome], cases: Path) -> None:
    began = time.monotonic()
    done = statejump_process("sweep", cases / "campaigns" / "table1_friction.toml")
    took = time.monotonic() - began
    said = float(re.search(r"wall time: ([\d.]+) s", done.output)[1])  # type: ignore[index]
    samples = float(re.search(r"samples in ([\d.]+) s on", done.output)[1])  # type: ignore[index]
    # A tick of the kernel's clock is 0.01 s, the line has a tenth; behind it the process only ends.
    assert samples < said <= took + 0.06 and said > 0.3


def test_names_on_a_page_are_those_that_users_gave() -> None:
    truss, rib = of_kind("truss"), of_kind("umbrella")
    for name in ("joint_a", "N10", "slider_left"):
        assert truss.named(name) == truss.named(name, True) == name
    assert rib.named("link_xy") == "Link xy" and rib.named("link_xy", True) == "link xy"
