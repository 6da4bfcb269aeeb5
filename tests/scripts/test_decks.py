# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/decks.py: one row per deck with a single cause of failure, and displacements compared with CalculiX."""
from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))
import decks_ccx  # noqa: E402

TRUSS = """*NODE, NSET=NALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 0., 1., 0.
*ELEMENT, TYPE=T3D2, ELSET=BARS
1, 1, 2
2, 2, 3
*MATERIAL, NAME=AL
*ELASTIC
7.e10, 0.3
*SOLID SECTION, ELSET=BARS, MATERIAL=AL
1.e-4
*BOUNDARY
1, 1, 3
3, 1, 3
2, 3, 3
*STEP, NLGEOM
*STATIC
*CLOAD
2, 2, -1000.
*NODE FILE
U
*END STEP
"""
NASTRAN = "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nCQUAD4,1,1,1,2,2,1\nENDDATA\n"


def test_a_row_for_every_deck(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "truss.inp").write_text(TRUSS)
    (tmp_path / "shell.bdf").write_text(NASTRAN)
    (tmp_path / "notes.txt").write_text("no deck")
    done = subprocess.run([sys.executable, SCRIPTS / "decks.py", tmp_path, "-j", "1"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": os.environ["STATEJUMP_PYTHON_DIR"]})
    assert done.returncode == 0, done.stderr
    table = [line for line in done.stdout.splitlines() if line.startswith("|")][2:]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table]
    assert [row[0] for row in rows] == ["shell.bdf", "sub/truss.inp"]
    assert rows[0][2:4] == ["no", "no"] and "CQUAD4" in rows[0][4]
    # Bars of 7e6 and 4.95e6 N/m: the second carries 1414 N, the first -1000 N.
    assert rows[1][1:4] == ["SI", "yes", "yes"]
    assert float(rows[1][5]) == pytest.approx(1e-3 / 7 * (1 + 2 * 2**0.5), rel=1e-3)
    if shutil.which("ccx"):
        assert float(rows[1][6]) < 1e-6
    assert done.stdout.endswith("2 decks, 1 imported, 1 ran, 0 faults\n")


# A second pair of bars beside the first one, and an equation between both.
TIED = TRUSS.replace("3, 0., 1., 0.\n", "3, 0., 1., 0.\n4, .5, 2., 0.\n").replace(
    "2, 2, 3\n", "2, 2, 3\n3, 3, 4\n4, 1, 4\n").replace("3, 1, 3\n", "3, 1, 3\n4, 3, 3\n").replace(
    "*STEP,", "*EQUATION\n3\n2, 1, 1., 2, 2, .4, 4, 1, -1.5\n*STEP,")


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not here: not every Debian has it")
def test_equations_are_those_of_calculix(tmp_path: Path) -> None:
    (tmp_path / "tied.inp").write_text(TIED)
    done = subprocess.run([sys.executable, SCRIPTS / "decks.py", tmp_path, "-j", "1"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": os.environ["STATEJUMP_PYTHON_DIR"]})
    row = [cell.strip() for cell in done.stdout.splitlines()[2].split("|")[1:-1]]
    assert row[2:4] == ["yes", "yes"], done.stdout
    assert float(row[6]) < 1e-6  # CalculiX prints seven digits


# A cantilever of two elements, ten times as long as high each: fully integrated B32 lock in shear.
CANTILEVER = """*NODE, NSET=NALL
1, 0., 0., 0.
2, 250., 0., 0.
3, 500., 0., 0.
4, 750., 0., 0.
5, 1000., 0., 0.
*ELEMENT, TYPE=B32, ELSET=BEAMS
1, 1, 2, 3
2, 3, 4, 5
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*BEAM SECTION, ELSET=BEAMS, MATERIAL=STEEL, SECTION=RECT
50., 50.
0., 1., 0.
*BOUNDARY
1, 1, 6
*STEP
*STATIC
*CLOAD
5, 2, -1.
*END STEP
"""


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not here: not every Debian has it")
def test_fully_integrated_beams_are_compared_as_reduced_ones(tmp_path: Path) -> None:
    (tmp_path / "beam.inp").write_text(CANTILEVER)
    done = subprocess.run([sys.executable, SCRIPTS / "decks.py", tmp_path, "-j", "1", "--units", "mm-N"],
                          capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": os.environ["STATEJUMP_PYTHON_DIR"]})
    row = [cell.strip() for cell in done.stdout.splitlines()[2].split("|")[1:-1]]
    assert row[2:4] == ["yes", "yes"], done.stdout
    # Left: the shear factor, 1 of the bricks and 5/6 of the beam, is 3 EI/(k G A L²)/5 = 2.5e-4 of the displacement.
    assert float(row[6].split()[0]) < 1e-3


def test_the_deck_of_calculix_ends_with_a_step_and_is_linear() -> None:
    again = TRUSS + 2 * TRUSS[TRUSS.index("*STEP"):]
    text = decks_ccx.printing(again, 2, [2, 1])
    assert text.count("*STEP") == 2 and text.count("*NODE PRINT") == 1
    assert text.rindex("*NODE PRINT") > text.rindex("*CLOAD")
    assert "NLGEOM" not in text and "*NODE FILE" not in text and "*NODE, NSET=NALL" in text
    assert "*NSET, NSET=SJPRINTED\n1,\n2,\n*STEP" in text


def test_the_last_increment_is_read(tmp_path: Path) -> None:
    block = "\n displacements (vx,vy,vz) for set SJPRINTED and time  {time}\n\n         2  {x}  0.000000E+00 -1.0E-03\n"
    (tmp_path / "a.dat").write_text(block.format(time=0.5, x="1.0E-03") + block.format(time=1, x="2.0E-03"))
    assert decks_ccx.printed(tmp_path / "a.dat")["2"].tolist() == [2e-3, 0, -1e-3]
    assert decks_ccx.printed(tmp_path / "none.dat") == {}
