# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables as written by spreadsheets and test rigs: many notations of the same content, and refusal of ambiguous ones.
"""
from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import BUILT
from failures import Failure, failing, failure

import statejump as sj
from statejump.core.column_units import conversion
from statejump.core.errors import StatejumpError
from statejump.core.table_files import open_table, read_columns, read_known
from statejump.core.temperature_columns import read_columns as temperatures_of
from statejump.identification.loop import COLUMNS, WORDS
from statejump.kinds.loading import load_case
from statejump.kinds.truss.importing.tables import read as read_deck
from statejump.surface.summary import read_nodes

# 0, 0.25, 1 s; 0, 12.5, -3 mm; 0, 1.25, -0.5 kN
TABLES = {
    "own": b"time_s,displacement_m,force_N\n0,0,0\n0.25,0.0125,1250\n1,-0.003,-500\n",
    "rows that end as on old systems": b"time_s,displacement_m,force_N\r\n0,0,0\r\n0.25,0.0125,1250\r\n1,-0.003,-500\r\n\r\n",
    "byte order mark, semicolons, decimal commas": (
        "\ufefft [s];disp (mm);Force [kN]\r\n0;0;0\r\n0,25;12,5;1,25\r\n1;-3;-0,5\r\n").encode(),
    "quotes, decimal commas": b'"t [s]","disp [mm]","Force [kN]"\n"0","0","0"\n"0,25","12,5","1,25"\n"1","-3","-0,5"\n',
    "tabs, other case": b"TIME [s]\tDisplacement [mm]\tFORCE [kN]\n0\t0\t0\n0.25\t12.5\t1.25\n1\t-3\t-0.5\n",
    "blanks": b"  Time [s]   disp [mm]   Force [kN]\n 0 0 0\n  0.25  12.5 1.25\n1 -3 -5e-1\n\n",
    "UTF-16": "t [s]\tdisp [mm]\tForce [kN]\n0\t0\t0\n0.25\t12.5\t1.25\n1\t-3\t-0.5\n".encode("utf-16"),
    "old code page": "t [s];position [µm];load / kN\n0;0;0\n0,25;12500;1,25\n1;-3000;-0,5\n"
    .encode("cp1252"),
    "separator said, blank columns and rows": b"sep=;\nt [s];disp [mm];Force [kN];;\n0;0;0;;\n0.25;12.5;1.25;;\n;;;;\n1;-3;-0.5;;\n;;;;\n",
    "blank lines first": b"\n\n,,\nt [s],disp [mm],Force [kN]\n0,0,0\n0.25,12.5,1.25\n1,-3,-0.5\n",
    "minutes, inches": b"t_min,disp_in,F [kN]\n0,0,0\n0.00416666666666666667,0.49212598425196850,1.25\n"
    b"0.0166666666666666667,-0.11811023622047244,-0.5\n",
    "dates": b"time,disp [mm],Force [kN]\n2026-03-01T12:00:00Z,0,0\n2026-03-01T12:00:00.250Z,12.5,1.25\n"
    b"2026-03-01T13:00:01+01:00,-3,-0.5\n",
    "clock": b"time,disp [mm],Force [kN]\n23:59:58,0,0\n23:59:58.25,12.5,1.25\n23:59:59,-3,-0.5\n",
    "other words": b't/ms;travel, mm;"load, N"\n0;0;0\n250;12.5;1250\n1000;-3;-500\n',
}


@pytest.mark.parametrize("what", TABLES)
def test_one_table_in_many_spellings(what: str, tmp_path: Path) -> None:
    (tmp_path / "loop.csv").write_bytes(TABLES[what])
    found = read_known(tmp_path / "loop.csv", COLUMNS, WORDS)
    for key, values in {"time_s": [0, 0.25, 1], "displacement_m": [0, 0.0125, -0.003], "force_N": [0, 1250, -500]}.items():
        # A product and a quotient of rounded numbers.
        np.testing.assert_allclose(found[key], values, rtol=4 * np.finfo(float).eps, atol=0)


# Unit of a column, unit of the key, how many of the key's it is.
UNITS = [
    ("kN", "N", 1e3), ("lbf", "N", 4.4482216152605), ("kip", "N", 4448.2216152605), ("kgf", "N", 9.80665),
    ("Newton", "N", 1.0), ("µN", "N", 1e-6), ("uN", "N", 1e-6), ("mm", "m", 1e-3), ("inch", "m", 0.0254),
    ("μm", "m", 1e-6), ("Nm", "N m", 1.0), ("N·m", "N m", 1.0), ("N-m", "N m", 1.0), ("kN.m", "N m", 1e3),
    ("N_mm", "N m", 1e-3), ("Nmm", "N m", 1e-3), ("ft*lbf", "N m", 1.3558179483314004), ("mm2", "m2", 1e-6),
    ("mm²", "m2", 1e-6), ("cm^4", "m4", 1e-8), ("GPa", "Pa", 1e9), ("N/mm2", "Pa", 1e6), ("g/cm3", "kg/m3", 1e3),
    ("N/mm", "N/m", 1e3), ("kN_per_mm", "N/m", 1e6), ("h", "s", 3600.0), ("hours", "s", 3600.0), ("min", "s", 60.0),
    ("ms", "s", 1e-3), ("deg", "rad", np.pi / 180), ("°", "rad", np.pi / 180), ("mrad", "rad", 1e-3), ("1/°C", "1/K", 1.0),
    ("%", "-", 0.01),
]


@pytest.mark.parametrize("unit, wanted, factor", UNITS)
def test_units(unit: str, wanted: str, factor: float) -> None:
    found = conversion(unit, wanted)
    assert found is not None and found(np.ones(1))[0] == pytest.approx(factor, rel=1e-12)
    assert found(np.zeros(1))[0] == 0


@pytest.mark.parametrize("unit, kelvin", [
    ("°C", 293.15), ("degC", 293.15), ("deg C", 293.15), ("Celsius", 293.15), ("ºC", 293.15), ("℃", 293.15), ("K", 20.0),
    ("°F", 266.4833333333333), ("delta_degC", 20.0)])
def test_temperatures(unit: str, kelvin: float) -> None:
    found = conversion(unit, "K")
    assert found is not None and found(np.array([20.0]))[0] == pytest.approx(kelvin, rel=1e-12)
    change = conversion(unit, "K", change=True)
    assert change is not None and change(np.zeros(1))[0] == 0


@pytest.mark.parametrize("unit, wanted", [
    ("kg", "N"), ("t", "N"), ("lb", "N"), ("KN", "N"), ("MM", "m"), ("m", "s"), ("C", "K"), ("F", "K"), ("deg", "K"),
    ("nm", "N m"), ("ft lb", "N m"), ("", "N"), ("x", "m"), ("N/", "N"), ("__import__('os')", "N"), ("m**99**99", "m"), ("m**9**9**9**9", "m"),
    ("m" * 1000, "m"),
])
def test_what_is_no_such_unit(unit: str, wanted: str) -> None:
    assert conversion(unit, wanted) is None


WRONG = {
    failure("column_without_unit", column="Force", accepted=("force_N", "Force [N]", "Force [kN]", "Force [lbf]")): "disp [mm],Force\n1,2\n",
    failure("column_of_other_unit", column="Force [kg]", unit="kg", quantity="of force", accepted=("force_N", "Force [N]", "Force [kN]", "Force [lbf]")):
    "disp [mm],Force [kg]\n1,2\n",
    failure("column_without_unit_or_times", column="'time'", accepted=("time_s", "time [s]", "time [min]", "time [h]")):
    "time,disp [mm],F [N]\n1,2,3\n",
    failure("columns_of_one_key", other="force_N", column="load [kN]", key_of_both="force_N"): "disp [mm],force_N,load [kN]\n1,2,3\n",
    failure("no_such_key", section="column 'Normal [N]'", known="time_s, displacement_m, force_N, rotation_rad, moment_N_m"):
    "disp [mm],F [N],Normal [N]\n1,2,3\n",
    failure("column_without_name", line=1, column=2): "disp [mm],,F [N]\n1,2,3\n",
    failure("decimal_comma_and_point", column="'F [N]'", line=3, other="'1.5'", other_line=2, cell="'2,5'"):
    "disp [mm];F [N]\n1.5;1\n1;2,5\n",
    failure("decimal_comma_or_thousands", column="'F [N]'", line=2, cell="'1,234'"):
    "disp [mm]\tF [N]\n1\t1,234\n2\t5,678\n",
    failure("row_of_other_length", line=2, cells=4, width=2, decimal_commas=True):
    "disp [mm],F [N]\n1,5,2,5\n",
    failure("bad_cell", column="'F [N]'", line=3, reason="empty", cell=""): "disp [mm],F [N]\n1,2\n3,\n",
    failure("bad_cell", column="'F [N]'", line=3, reason="no_finite_number", cell="#N/A"): "disp [mm],F [N]\n1,2\n3,#N/A\n",
    failure("no_iso_time", column="time", line=3, reason="some_time_zones", accepted="2026-03-01T12:00:00 or 12:00:00"):
    "time,disp [mm]\n2026-03-01T12:00:00Z,1\n2026-03-01T12:00:00,1\n",
    failure("no_samples"): "disp [mm],F [N]\n\n",
}


@pytest.mark.parametrize("sentence", WRONG)
def test_what_is_ambiguous_is_one_sentence(sentence: Failure, tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    path.write_text(WRONG[sentence], encoding="utf-8")
    with pytest.raises(StatejumpError) as refused:
        read_known(path, COLUMNS, WORDS)
    assert refused.value == sentence.at(file=str(path))


def test_text_in_another_code_page_is_refused(tmp_path: Path) -> None:
    for page in ("cp437", "cp850", "mac_roman"):
        (tmp_path / "a.csv").write_bytes("Kraft [N],Länge [m]\n1,2\n".encode(page))
        with failing("csv_not_utf8"):
            read_columns(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_bytes("Kraft [N],Länge [m]\n1,2\n".encode("cp1252"))  # as Excel of western Europe writes it
    assert list(read_columns(tmp_path / "a.csv")) == ["Kraft [N]", "Länge [m]"]


def test_a_decimal_comma_may_come_late(tmp_path: Path) -> None:
    """A decimal comma is recognised late: by one number without thousands, in a later block of rows."""
    (tmp_path / "a.txt").write_text("x\ty\n" + "1\t1,234\n" * 5000 + "1\t0,5\n")
    with open_table(tmp_path / "a.txt") as table:
        found = [table.numbers([row[1] for row in rows], lambda index: (0, "y")) for _, rows in table.blocks()]
    assert np.concatenate(found)[-1] == 0.5 and found[0][0] == 1.234


def test_every_reader_takes_units(tmp_path: Path) -> None:
    (tmp_path / "nodes.csv").write_text("name;x [mm];y [mm];fixed;Force_y [kN]\nA;0;0;xy;\nB;1000,5;0;y;\nC;0;1000;;-1,5\n")
    (tmp_path / "bars.csv").write_text("name;first;second;Young modulus [GPa];cross section area [mm2];thermal_expansion [1/°C]\n"
                                       "L1;A;B;70;100;2,3e-5\n")
    deck = read_deck(tmp_path / "nodes.csv", tmp_path / "bars.csv")
    bar = deck.bars[0]
    assert (bar.young_modulus, bar.area, bar.expansion) == (70e9, 1e-4, 2.3e-5)
    (tmp_path / "surface.csv").write_text("node\tx [mm]\ty [mm]\tz [mm]\t" + "\t".join(
        f"displacement {axis} [µm]" for axis in "xyz") + "\n1\t1000\t0\t0\t1\t2\t3\n")
    drawn, moved = read_nodes(tmp_path / "surface.csv")
    assert drawn.tolist() == [[1.0, 0.0, 0.0]] and moved == pytest.approx(np.array([[1e-6, 2e-6, 3e-6]]))


def test_loops_from_python_name_their_units() -> None:
    path = np.sin(np.linspace(0, 12, 100))
    ours = sj.identify({"disp [mm]": path, "Force [kN]": path}, model="linear", start="fresh")
    assert ours.values["stiffness"] == pytest.approx(1e6)


def test_pint_is_not_loaded_without_need(tmp_path: Path) -> None:
    """Its import takes half a second."""
    (tmp_path / "own.csv").write_bytes(TABLES["own"])
    told = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(BUILT)!r})\n"
         "from pathlib import Path\nimport statejump.cli.main\nfrom statejump.core.table_files import read_known\n"
         f"read_known(Path({str(tmp_path / 'own.csv')!r}), ('time_s', 'displacement_m', 'force_N'))\n"
         "print('pint' in sys.modules)"], capture_output=True, text=True, check=True)
    assert told.stdout == "False\n"


@pytest.mark.parametrize("content", [
    b"# time_s,A_K\n0.0,1.5\n10.0,2\n",  # numpy.savetxt
    b"# made by a logger\n# time_s A_K\n0.0 1.5\n10.0 2\n", b"% run 7\ntime_s,A_K\n0,1.5\n10,2\n",
    b"\xef\xbb\xbf# time_s;A_K\n0;1,5\n10;2\n",
    b"Time,A\ns,K\n0,1.5\n10,2\n", b"Time;A\n[s];[K]\n0;1,5\n10;2\n", b"time_s,A\n,(K)\n0,1.5\n10,2\n",
    b",time_s,A_K\n0,0,1.5\n1,10,2\n", b'"","time_s","A_K"\n"1",0,1.5\n"2",10,2\n',  # pandas, R
    b"#,time_s,A_K\n1,0,1.5\n2,10,2\n",
    b"A_K,time_s\n1.5,0\n2,10\n",  # the time in another column
    b"time_s,A_K\n0.0D+00,1.5D0\n1.0d+01,2\n",  # Fortran
    b"timestamp,A_K\n2024-05-01T10:00:00Z,1.5\n2024-05-01T10:00:10Z,2\n", b"Zeit [s];A_K\n0;1,5\n10;2\n",
    b"Time,A_K\n0 sec,1.5\n10 sec,2\n", b"Time,A_K\n0 min,1.5\n0.16666666666666666 min,2\n",  # timetables of MATLAB
    b"LabVIEW Measurement\t\r\nWriter_Version\t2\r\nSeparator\tTab\r\nDecimal_Separator\t,\r\n***End_of_Header***\t\r\n\t\r\n"
    b"Channels\t1\t\r\nY_Unit_Label\tK\t\r\nX_Dimension\tTime\t\r\n***End_of_Header***\t\t\r\nX_Value\tA\tComment\r\n"
    b"0,0\t1,5\t\r\n10,0\t2\t\r\n",
])
def test_tables_as_programs_write_them(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.csv").write_bytes(content)
    found = temperatures_of(tmp_path / "a.csv", "thermal.table_file")
    assert (found.names, found.time_s.tolist(), found.values.tolist()) == (("A",), [0, 10], [[1.5], [2]])


@pytest.mark.parametrize("content, said", [
    (b"time_s,A_K\nh,K\n0,1.5\n10,2\n", failure("bad_cell", column="'A_K'", line=2, reason="no_finite_number", cell="K")),
    (b"Time,A\ns,furlong-ish\n0,1\n1,2\n", failure("temperature_column_without_unit", column="'A'", unit="")),
    (b",time_s,A_K\n0.5,0,1\n1.5,1,2\n", failure("first_column_without_name", line=2)),
    (b",time_s,A_K\n0,0,1\n2,1,2\n", failure("first_column_without_name", line=3)),
    (b"# c\n# time_s,A_K\n0,1\n1,x\n", failure("bad_cell", column="'A_K'", line=4, reason="no_finite_number", cell="x")),
    (b"Time,A\ns,K\n0,1\n1,x\n", failure("bad_cell", column="'A [K]'", line=4, reason="no_finite_number", cell="x")),
    (b"# time_s,A_K\n", failure("no_column")),
    (b"\n   0.0e+00   1.5e+00\n   1.0e+01   2.0e+00\n", failure("table_without_header", line=2)),
    (b"Time,A_K\n0 sec,1\n1 min,2\n", failure("column_without_unit_or_times", column="'Time'")),
    (b'time_s,A_K\n"1,000.5",1\n"2,5",2\n', failure("decimal_comma_and_point", other="'1,000.5'", other_line=2, cell="'2,5'")),
    ("time_s,Tr\xe4ger_K\n0,1\n1,2\u20ac\n".encode("cp1252"), failure("csv_not_utf8")),
])
def test_tables_that_stay_refused(tmp_path: Path, content: bytes, said: Failure) -> None:
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(StatejumpError) as refused:
        temperatures_of(tmp_path / "a.csv", "thermal.table_file")
    assert refused.value == said


@pytest.mark.parametrize("content", [
    b'"Kraft [kN]";"Weg [mm]"\n-1.000,5;0\n2;0,5\n', b'F [N],x [\xc2\xb5m]\n"-1,000,500.0",0\n"2,000.",500\n',
    b"Load,Extension\n(kN),(mm)\n-1000.5,0\n2,0.5\n",
])
def test_loops_as_programs_write_them(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.csv").write_bytes(content)
    found = read_known(tmp_path / "a.csv", COLUMNS, WORDS)
    assert {key: values.tolist() for key, values in found.items()} == {
        "force_N": [-1000500, 2000], "displacement_m": [0, 5e-4]}


def test_names_in_the_code_page_of_excel(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes("name,x_m\nTr\xe4ger \xd8,1\n".encode("cp1252"))
    found = read_known(tmp_path / "a.csv", ("name", "x_m"), texts=("name",))
    assert found["name"].tolist() == ["Tr\xe4ger \xd8"]


def test_a_case_file_with_a_byte_order_mark(tmp_path: Path, cases: Path) -> None:
    (tmp_path / "mine.toml").write_bytes(b"\xef\xbb\xbf" + (cases / "table1.toml").read_bytes().replace(b"\n", b"\r\n"))
    assert load_case(tmp_path / "mine.toml") == load_case(cases / "table1.toml")
