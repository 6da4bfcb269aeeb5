# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands of condensed bodies: files, tables, page, pictures, refusals."""
from __future__ import annotations

import csv
import shutil
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from studies.calculix.bracket_decks import bracket
from failures import failure
from frames import NAMES, POSITIONS_M, expanded, mass, stiffness
import statejump as sj
from statejump.cli.main import run
from statejump.core.figures import save


def called(arguments: Sequence[object]) -> int:
    return run([str(one) for one in arguments])


@pytest.fixture
def file(tmp_path: Path) -> Path:
    body = sj.body.from_arrays(NAMES, POSITIONS_M, stiffness(), mass=mass(), pattern_names=["warm"], free_shapes=[expanded()],
                               source="a frame")
    sj.body.write(tmp_path / "frame.h5", body)
    return tmp_path / "frame.h5"


def test_check_prints_and_writes_a_page(file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(["body", "check", file, "--results", tmp_path / "out"]) == 0
    printed = capsys.readouterr().out
    assert "warm: apparent expansion" in printed and "Frequencies [Hz]" in printed
    folder = tmp_path / "out" / "body_frame"
    page = (folder / "check.html").read_text()
    assert "a frame" in page and "data:image/png;base64," in page and "MISSED" not in page
    rows = {row["quantity"]: row for row in csv.DictReader((folder / "check.csv").open())}
    assert float(rows["mass"]["value"]) == pytest.approx(3.0)
    assert float(rows["warm: apparent expansion"]["value"]) == pytest.approx(23e-6)
    assert (folder / "shapes.svg").stat().st_size > 1000


def test_check_of_a_doubtful_body_is_status_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    noise = np.random.default_rng(1).normal(size=(18, 18))
    import h5py

    sj.body.write(tmp_path / "good.h5", sj.body.from_arrays(NAMES, POSITIONS_M, stiffness()))
    with h5py.File(tmp_path / "x.h5", "w") as made:
        made.attrs.update({"format": "statejump condensed body", "version": 1, "units": "SI"})
        made["node/name"], made["node/position_m"], made["node/freedoms"] = list(NAMES), POSITIONS_M, [6, 6, 6]
        made["stiffness"] = stiffness() * (1 + 1e-7 * (noise + noise.T))
    assert called(["body", "check", tmp_path / "x.h5", "--results", tmp_path / "out"]) == 1
    captured = capsys.readouterr()
    assert "MISSED" in captured.out and "force of rigid motions" in captured.err
    assert called(["--json", "body", "check", tmp_path / "none.h5"]) == 2
    assert failure("file_not_found") == capsys.readouterr().err


def test_mass_properties_are_those_of_the_masses() -> None:
    checked = sj.body.check(sj.body.from_arrays(NAMES, POSITIONS_M, stiffness(), mass=mass()))
    found = {row.name: row.value for row in checked.rows}
    centre = POSITIONS_M.mean(axis=0)
    arms = POSITIONS_M - centre
    for k, axis in enumerate("xyz"):
        assert found[f"centre of mass {axis}"] == pytest.approx(centre[k])
        others = np.delete(arms, k, axis=1)
        assert found[f"moment of inertia {axis}{axis} about it"] == pytest.approx((others**2).sum() + 3e-4)
    assert len(checked.free_Hz) == 18 and checked.free_Hz[6] > 1e3 * checked.free_Hz[5]


def test_plot(file: Path, tmp_path: Path) -> None:
    assert called(["body", "plot", file, "--results", tmp_path / "out", "--quiet"]) == 0
    assert (tmp_path / "out/body_frame/body.png").stat().st_size > 1000
    cube = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    solid = sj.body.from_arrays(list("abcde"), cube, np.zeros((30, 30)))
    assert len(solid.plot().axes) == 1
    save(solid.plot(), tmp_path, "cube")


def test_import_and_its_refusals(file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = "".join(f"{i // 6 + 1},{i % 6 + 1},{j // 6 + 1},{j % 6 + 1},{stiffness()[i, j]:.15e}\n"
                   for i in range(18) for j in range(i + 1))
    (tmp_path / "x_STIF1.mtx").write_text(rows)
    (tmp_path / "nodes.csv").write_text("name,x_m,y_m,z_m\n" + "".join(
        f"{k},{x},{y},{z}\n" for k, (x, y, z) in enumerate(POSITIONS_M, start=1)))
    given = ["body", "import", tmp_path / "x_STIF1.mtx", tmp_path / "nodes.csv", "-o", tmp_path / "x.h5"]
    assert called(given) == 0
    assert sj.body.read(tmp_path / "x.h5").node_names == ("1", "2", "3")
    capsys.readouterr()
    for more, code in (([], "exists_already"), (["--force", "--stiffness", "KXX"], "matrix_unknown"),
                       (["--force", "--cd", "3"], "body_pair")):
        assert called(["--json", *given, *more]) == 2
        assert failure(code) == capsys.readouterr().err.strip()
    assert called(["--json", "body", "import", tmp_path / "x_STIF1.mtx", "-o", tmp_path / "x.txt"]) == 2


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_condense(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "b.inp").write_text(bracket(fine=False))
    given = ["body", "condense", tmp_path / "b.inp", "-o", tmp_path / "b.h5", "--interface", "A", "--interface", "C",
             "--pattern", "uniform", "--pattern", "up=z", "--points", "P", "--modes", "2", "--at", "C=0.01,0.02,0.1"]
    assert called(given) == 0
    body = sj.body.read(tmp_path / "b.h5")
    assert body.pattern_names == ("uniform", "up") and body.modes == 2 and body.points is not None
    assert body.node_positions_m[1].tolist() == [0.01, 0.02, 0.1]
    capsys.readouterr()
    for more, code in ((["--at", "C=1"], "body_place"), (["--interface", "NONE"], "condense_no_set")):
        assert called(["--json", *given, "--force", *more]) == 2
        assert failure(code) == capsys.readouterr().err.strip()
