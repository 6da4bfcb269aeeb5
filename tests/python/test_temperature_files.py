# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperatures from files: they are used exactly as written, and an invalid file gives one sentence."""
from __future__ import annotations

import tomllib
import warnings
from pathlib import Path
from typing import Any, Callable

import h5py
import numpy as np
import pytest
from conftest import REPOSITORY, Outcome
from failures import failing, failure

import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.kinds.truss.generate.document import to_toml
from statejump.results.record import save

TIMES = np.array([0.0, 1.0, 2.5, 7.0, 10.0])
REFERENCE_K = 293.15
CASES = ("table1", "umbrella_damped", "trusses/umbrella_rib")


def document(name: str, **thermal: Any) -> dict[str, Any]:
    """Return a shipped case with another temperature program, a table."""
    data = tomllib.loads((REPOSITORY / "cases" / f"{name}.toml").read_text(encoding="utf-8"))
    data["thermal"] = {"shape": "table", **thermal}
    return data


def write(path: Path, header: str, rows: np.ndarray) -> Path:
    """Write a CSV file."""
    lines = [",".join(repr(float(value)) for value in row) for row in rows]
    path.write_text("\n".join([header, *lines]) + "\n", encoding="utf-8")
    return path


def histories(count: int) -> np.ndarray:
    """Return temperatures [K] of members at TIMES, as an array (5, count); they differ between members."""
    shape = np.array([0.0, 40.0, 110.0, 25.0, 0.0])
    return REFERENCE_K + shape[:, None] * (1 + 0.1 * np.arange(count))


@pytest.fixture
def chain(tmp_path: Path) -> tuple[Path, list[str], np.ndarray]:
    """A chain whose links have individual temperatures, its temperature file, link names and temperatures [K]."""
    data = document("trusses/chain_10", members_file="members.csv", reference_temperature_K=REFERENCE_K)
    names = [link["name"] for link in data["link"]]
    given = histories(len(names))
    write(tmp_path / "members.csv", ",".join(["time_s", *(f"{name}_K" for name in names)]), np.c_[TIMES, given])
    (tmp_path / "chain.toml").write_text(to_toml(data), encoding="utf-8")
    return tmp_path / "chain.toml", names, given


@pytest.mark.parametrize("name", CASES)
def test_a_column_of_a_file_is_the_table_of_every_kind_of_case(name: str, tmp_path: Path) -> None:
    write(tmp_path / "orbit.csv", "time_s,sun_degC,shade_K", np.array(
        [[100.0, 20.0, 293.15], [105.0, 120.0, 300.0], [110.0, 20.0, 293.15]]))
    (tmp_path / "mine.toml").write_text(to_toml(document(
        name, table_file="orbit.csv", table_column="sun", reference_temperature_K=REFERENCE_K)), encoding="utf-8")
    found = sj.load(tmp_path / "mine.toml")
    typed = sj.load(document(name, table_time_s=[0.0, 5.0, 10.0], table_temperature_change_K=[0.0, 100.0, 0.0]))
    assert found == typed and found.period_s == 10.0
    # Read once: changed cases, result files and campaigns need the file no more.
    (tmp_path / "orbit.csv").unlink()
    assert found.changed({"thermal.cycles": 2}).duration_s == 20.0


def test_a_program_finds_its_column_by_its_name(tmp_path: Path) -> None:
    write(tmp_path / "orbit.csv", "time_s,shade_K,sun_K", np.array([[0.0, 0.0, 0.0], [1.0, 10.0, 50.0], [3.0, 0.0, 0.0]]))
    data = document("trusses/chain_10", table_file="orbit.csv", table_column="sun")
    data["program"] = [{"name": "shade", "shape": "table", "table_file": "orbit.csv"}]
    (tmp_path / "mine.toml").write_text(to_toml(data), encoding="utf-8")
    common, shade = sj.load(tmp_path / "mine.toml").definition.programs
    assert common.table_temperature_change_K == [0.0, 50.0, 0.0]
    assert shade.table_temperature_change_K == [0.0, 10.0, 0.0] and shade.table_time_s == [0.0, 1.0, 3.0]


def test_histories_of_members_are_followed_as_a_program_for_each(chain: tuple[Path, list[str], np.ndarray]) -> None:
    path, names, given = chain
    case = sj.load(path)
    data = document("trusses/chain_10", table_time_s=TIMES.tolist(),
                    table_temperature_change_K=case.thermal.table_temperature_change_K)
    data["program"] = [{"name": name, "shape": "table", "table_time_s": TIMES.tolist(),
                        "table_temperature_change_K": (given[:, place] - REFERENCE_K).tolist()}
                       for place, name in enumerate(names)]
    for link in data["link"]:
        link["program"] = link["name"]
    ours, typed = case.reduced(), sj.load(data).reduced()
    for key in ("displacement_m", "slide_m"):
        assert np.array_equal(ours.history[key].values, typed.history[key].values)
    # Straight lines between the rows, at times that are no rows too.
    strain = ours.at([0.5, 4.0]).links["thermal_strain"].values
    expansion = np.array([link.thermal_expansion_per_K for link in case.link])
    wanted = [[np.interp(time, TIMES, column - REFERENCE_K) for column in given.T] for time in (0.5, 4.0)]
    assert strain == pytest.approx(expansion * wanted, rel=1e-12)


def test_dem_has_the_same_programs(chain: tuple[Path, list[str], np.ndarray]) -> None:
    path, names, given = chain
    case = sj.load(path).definition
    values = case.behaviour.dem_input(case)
    for place, number in enumerate(values["link"]["program"]):
        program = values["programs"][number]
        assert program["table_time_s"] == TIMES.tolist()
        assert program["table_temperature_change_K"] == (given[:, place] - REFERENCE_K).tolist()


def test_hdf5_says_the_same_as_csv(chain: tuple[Path, list[str], np.ndarray]) -> None:
    path, names, given = chain
    with h5py.File(path.parent / "members.h5", "w") as file:
        file["time_s"], file["temperature_degC"], file["members"] = TIMES, given - 273.15, names
    other = path.with_name("other.toml")
    other.write_text(path.read_text().replace("members.csv", "members.h5"))
    ours, theirs = (sj.load(one).thermal.members for one in (path, other))
    assert ours.names == theirs.names
    # The rounding of °C into kelvin: some ulps of 300 K.
    assert np.abs(ours.temperature_change_K - theirs.temperature_change_K).max() < 1e-12 * 300


@pytest.mark.parametrize("value", [np.inf, -np.inf, np.nan])
def test_hdf5_times_that_are_none_are_one_sentence(value: float, chain: tuple[Path, list[str], np.ndarray]) -> None:
    path, names, given = chain
    with h5py.File(path.parent / "members.h5", "w") as file:
        file["time_s"], file["temperature_degC"], file["members"] = TIMES, given - 273.15, names
        file["time_s"][1:3] = value
    path.write_text(path.read_text().replace("members.csv", "members.h5"))
    with warnings.catch_warnings(), pytest.raises(StatejumpError) as refused:
        warnings.simplefilter("error")
        sj.load(path)
    assert refused.value == failure("time_not_increasing", file="members.h5", at_s=value, index=1)


def test_a_result_file_keeps_the_histories(chain: tuple[Path, list[str], np.ndarray], tmp_path: Path) -> None:
    path, _, _ = chain
    case = sj.load(path)
    run = case.reduced()
    written = save("reduced", case.definition, {"reduced": run}, tmp_path)
    (tmp_path / "members.csv").unlink()
    again = sj.read(written)
    assert again.definition == case.definition
    assert again.case.reduced().summary == run.summary


def test_a_revolute_has_a_column_of_its_own_where_its_radii_expand(tmp_path: Path) -> None:
    data = document("trusses/umbrella_rib", members_file="members.csv", reference_temperature_K=REFERENCE_K)
    names = [link["name"] for link in data["link"]]
    data["revolute"][0].update(journal_thermal_expansion_per_K=2e-5)
    joint = data["revolute"][0]["name"]
    rows = np.c_[TIMES, histories(len(names) + 1)]
    write(tmp_path / "members.csv", ",".join(["time_s", *(f"{name}_K" for name in [*names, joint])]), rows)
    (tmp_path / "mine.toml").write_text(to_toml(data), encoding="utf-8")
    truss = sj.load(tmp_path / "mine.toml").definition.resolve()
    assert truss.program_names[truss.revolutes.program[0]] == joint
    write(tmp_path / "members.csv", ",".join(["time_s", *(f"{name}_K" for name in names)]), rows[:, :-1])
    with failing("no_column_of_item", part=f"revolute '{joint}'"):
        sj.load(tmp_path / "mine.toml")


def test_the_way_from_the_stress_free_temperature_is_said(chain: tuple[Path, list[str], np.ndarray]) -> None:
    path, _, given = chain
    text = path.read_text()
    path.write_text(text.replace("293.15", "283.15"))
    with failing("lead_in_missing", key="thermal.lead_in_s", away_K=10.0, table="members.csv"):
        sj.load(path)
    path.write_text(text.replace("293.15", "283.15\nlead_in_s = 5.0"))
    members = sj.load(path).thermal.members
    assert members.time_s.tolist() == [0.0, *(TIMES + 5.0)]
    assert not members.temperature_change_K[0].any()
    assert members.temperature_change_K[1:] == pytest.approx(given - 283.15, abs=1e-12 * 300)
    # With the way back it may be repeated.
    path.write_text(text.replace("293.15", "283.15\nlead_in_s = 5.0\nlead_out_s = 7.0\ncycles = 2"))
    members = sj.load(path).thermal.members
    assert members.time_s.tolist() == [0.0, *(TIMES + 5.0), TIMES[-1] + 12.0]
    assert not members.temperature_change_K[-1].any()


@pytest.mark.parametrize("times, unit, degrees", [
    (["0", "0,5", "1,25", "3,5", "5"], "time [h]", "[°C]"),
    (["0", "30", "75", "210", "300"], "time (min)", "(C)"),
    (["2026-03-01T00:00:00", "2026-03-01T00:30:00", "2026-03-01T01:15:00", "2026-03-01T03:30:00", "2026-03-01T05:00:00"],
     "Time stamp", "[C]")])
def test_hours_dates_and_degrees(times: list[str], unit: str, degrees: str, chain: tuple[Path, list[str], np.ndarray]) -> None:
    """The format is that of a German spreadsheet. Degrees Celsius need the reference temperature, which is given."""
    path, names, given = chain
    rows = [";".join([time, *(f"{value - 273.15:.4f}".replace(".", ",") for value in row)]) for time, row in zip(times, given)]
    path.with_name("members.csv").write_text("\r\n".join(
        [";".join([unit, *(f"{name} {degrees}" for name in names)]), *rows, ";" * len(names), ""]), encoding="utf-8-sig")
    members = sj.load(path).thermal.members
    assert members.names == tuple(names)
    assert members.time_s.tolist() == (1800 * TIMES).tolist()
    # Four decimals are exact here; °C into kelvin rounds.
    assert members.temperature_change_K == pytest.approx(given - REFERENCE_K, abs=1e-12 * 300)
    path.write_text(path.read_text().replace("reference_temperature_K = 293.15", ""))
    with failing("reference_missing", key="thermal.reference_temperature_K", table="members.csv"):
        sj.load(path)


def test_both_ends_of_a_link_give_its_mean(chain: tuple[Path, list[str], np.ndarray]) -> None:
    path, names, given = chain
    file = path.with_name("members.csv")
    apart = np.array([0.0, 8.0, -30.0, 4.0, 0.0])
    ends = np.c_[given[:, :1] - apart[:, None], given[:, 1:], given[:, 0] + apart]
    write(file, ",".join(["time_s", "L1@b_K", *(f"{name}_K" for name in names[1:]), "L1@a_K"]), np.c_[TIMES, ends])
    found = sj.load(path).thermal.members
    assert found.names == tuple(names)
    assert found.temperature_change_K == pytest.approx(given - REFERENCE_K, abs=1e-12 * 300)


# What is wrong, how the file is changed, and what is said.
WRONG: dict[str, tuple[Callable[[list[str]], list[str]], str]] = {
    "missing member": (lambda rows: [row.rpartition(",")[0] for row in rows],
                       failure("no_column_of_item", key="thermal.members_file", value="members.csv", part="link 'L10'")),
    "unknown member": (lambda rows: [rows[0].replace("L3_K", "M3_K").replace("L4_K", "L3_K").replace("M3_K", "L4_K")
                                     .replace("time_s", "time_s,strange_K"),
                                     *(row.replace(",", ",293.15,", 1) for row in rows[1:])],
                       failure("column_of_several", column="strange")),
    "one end": (lambda rows: [rows[0].replace("L2_K", "L2@a_K"), *rows[1:]],
                failure("link_ends_incomplete", file="members.csv", other="'L2@b'", column="'L2@a'", relation="without")),
    "end and mean": (lambda rows: [rows[0].replace("L2_K", "L1@b_K"), *rows[1:]],
                     failure("link_ends_incomplete", file="members.csv", other="'L1'", column="'L1@b'", relation="beside")),
    "ends of two units": (lambda rows: [rows[0].replace("L2_K", "L1@b_degC").replace("L1_K", "L1@a_K"), *rows[1:]],
                          failure("columns_of_other_units", file="members.csv", column="'L1@a'", other="'L1@b'")),
    "NaN": (lambda rows: [*rows[:2], rows[2].rpartition(",")[0] + ",nan", *rows[3:]],
            failure("bad_cell", file="members.csv", column="'L10_K'", line=3, reason="no_finite_number", cell="nan")),
    "empty cell": (lambda rows: [*rows[:2], rows[2].rpartition(",")[0] + ",", *rows[3:]],
                   failure("bad_cell", file="members.csv", column="'L10_K'", line=3, reason="empty")),
    "times go back": (lambda rows: [*rows[:2], rows[3], rows[2], *rows[4:]],
                      failure("times_not_increasing", file="members.csv", column="time_s", time="1.0", line=4, before="2.5")),
    "times too close": (lambda rows: [*rows[:2], "1e-320," + rows[2].partition(",")[2], *rows[3:]],
                        failure("times_too_close", file="members.csv", first_s=0.0, second_s=1e-320)),
    "wrong unit": (lambda rows: [rows[0].replace("L2_K", "L2 [V]"), *rows[1:]],
                   failure("temperature_column_without_unit", file="members.csv", column="'L2 [V]'", unit="V")),
    "a letter as a name": (lambda rows: [rows[0].replace("L2_K", "Sensor C"), *rows[1:]],
                           failure("temperature_column_without_unit", file="members.csv", column="'Sensor C'", unit="C")),
    "a number as a name": (lambda rows: [rows[0].replace("L2_K", "Sensor 2"), *rows[1:]],
                           failure("temperature_column_without_unit", file="members.csv", column="'Sensor 2'", unit="")),
    "no unit": (lambda rows: [rows[0].replace("L2_K", "L2"), *rows[1:]],
                failure("temperature_column_without_unit", file="members.csv", column="'L2'", unit="")),
    "unit of time": (lambda rows: [rows[0].replace("time_s", "time_m"), *rows[1:]],
                     failure("first_column_no_times", file="members.csv", column="'time_m'", reason="column_of_other_unit")),
    "two columns of one name": (lambda rows: [rows[0].replace("L2_K", "L3_degC"), *rows[1:]],
                                failure("columns_of_one_name", file="members.csv", column="'L3'")),
    "short row": (lambda rows: [*rows[:3], "2.5,300"], failure("row_of_other_length", file="members.csv", cells=2, line=4, width=11)),
    "no rows": (lambda rows: rows[:2], failure("fewer_than_two_times", file="members.csv")),
    "below absolute zero": (lambda rows: [*rows[:2], rows[2].rpartition(",")[0] + ",-3", *rows[3:]],
                            failure("bad_temperature", file="members.csv", at_s=1.0, column="'L10'", reason="below_absolute_zero", value_K=-3.0)),
    "control characters": (lambda rows: [rows[0].replace("L2_K", "L\x1b2_K"), *rows[1:]], failure("temperature_column_without_unit", unit="")),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_with_a_file_is_one_sentence(
    what: str, chain: tuple[Path, list[str], np.ndarray], statejump: Callable[..., Outcome]
) -> None:
    path, _, _ = chain
    file = path.with_name("members.csv")
    change, sentence = WRONG[what]
    file.write_text("\n".join(change(file.read_text().splitlines())) + "\n")
    told = statejump("reduced", path)
    assert told.status == 2 and told.errors.count("\n") == 1 and "\x1b" not in told.errors
    assert told.failure == sentence


KEYS = {
    "no such file": ('members_file = "none.csv"', failure("temperature_file_not_found", file="none.csv")),
    "not a table": ('members_file = "/etc/passwd"', failure("suffix_unknown", suffixes=".csv, .txt, .tsv, .dat, .lvm, .h5, .hdf5")),
    "both": ('members_file = "members.csv"\ntable_time_s = [0.0, 1.0]',
             failure("conflicting_key", key="thermal.table_time_s")),
    "reference alone": ("table_time_s = [0.0, 1.0]\ntable_temperature_change_K = [0.0, 1.0]",
                        failure("key_of_case_file", key="thermal.reference_temperature_K", value=293.15)),
    "column": ('table_file = "members.csv"', failure("several_columns", key="thermal.table_column", table="members.csv")),
    "no such column": ('table_file = "members.csv"\ntable_column = "LX1"', failure("misspelt_column", meant="L1")),
    "reference is no temperature": ('members_file = "members.csv"\nlead_in_s = -1.0',
                                    failure("out_of_range", key="thermal.lead_in_s", value=-1.0)),
}


@pytest.mark.parametrize("what", KEYS)
def test_what_is_wrong_with_the_keys_is_one_sentence(
    what: str, chain: tuple[Path, list[str], np.ndarray], statejump: Callable[..., Outcome]
) -> None:
    path, _, _ = chain
    keys, sentence = KEYS[what]
    path.write_text(path.read_text().replace('members_file = "members.csv"', keys))
    told = statejump("reduced", path)
    assert told.status == 2 and told.errors.count("\n") == 1 and told.failure == sentence


def test_what_is_repeated_ends_where_it_begins(chain: tuple[Path, list[str], np.ndarray]) -> None:
    path, names, given = chain
    path.write_text(path.read_text().replace("[thermal]", "[thermal]\ncycles = 2"))
    assert sj.load(path).duration_s == 20.0
    given[-1, 3] += 0.5
    write(path.with_name("members.csv"), ",".join(["time_s", *(f"{name}_K" for name in names)]), np.c_[TIMES, given])
    assert sj.load(path).definition.ending.temperature_change_K == pytest.approx(0.5)  # every cycle returns
    path.write_text(path.read_text().replace("[thermal]", "[thermal]\nreturn_to_reference = false"))
    with failing("table_not_periodic", table="members.csv", away_K=0.5, column=names[3]):
        sj.load(path)


def test_temperatures_in_degrees_need_a_reference(tmp_path: Path) -> None:
    write(tmp_path / "orbit.csv", "time_s,sun_degC", np.array([[0.0, 0.0], [1.0, 20.0]]))
    with failing("reference_missing", key="thermal.reference_temperature_K", table="orbit.csv"):
        sj.load(document("table1", table_file=str(tmp_path / "orbit.csv")))


def test_other_kinds_have_no_members() -> None:
    with failing("misspelt_key", key="thermal.members_file"):
        sj.load(document("table1", members_file="x.csv"))


def test_a_result_file_cannot_name_a_file(chain: tuple[Path, list[str], np.ndarray]) -> None:
    from statejump.kinds.loading import parse_case

    path, _, _ = chain
    data = tomllib.loads(path.read_text())
    data["thermal"]["members_file"] = str(path.with_name("members.csv"))
    with failing("key_of_case_file", key="thermal.members_file"):
        parse_case(data)
