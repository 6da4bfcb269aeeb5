# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses from meshes: their solution equals that of the same truss written by hand."""
from __future__ import annotations

import contextlib
import io
import random
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
from conftest import Outcome
from failures import Failure, failing, failure
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.kinds.truss.importing import read
from statejump.kinds.truss.importing.mesh import BY_VTK, FORMATS

meshio = pytest.importorskip("meshio")

BAR = {"young_modulus_Pa": 7e10, "cross_section_area_m2": 1e-4, "thermal_expansion_per_K": 2.3e-5}
POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.2, 0.0]])
ENDS = np.array([[0, 1], [0, 2], [1, 2]])
ARGUMENTS = ("--young-modulus", 7e10, "--area", 1e-4, "--thermal-expansion", 2.3e-5, "--temperature-change", 80,
             "--fixed", "N1=xy", "--fixed", "N2=y")


def polydata(dtype: Any = np.float64) -> Any:
    """Return the same triangle as lines and a polygon of VTK, with the data arrays of the bars."""
    points, data = vtkPoints(), vtkPolyData()
    points.SetData(numpy_to_vtk(POINTS.astype(dtype), deep=True))
    data.SetPoints(points)
    lines, polygons = vtkCellArray(), vtkCellArray()
    for cells, nodes in ((lines, ENDS), (polygons, [[0, 1, 3]])):
        for corners in nodes:
            cells.InsertNextCell(len(corners))
            for corner in corners:
                cells.InsertCellPoint(int(corner))
    data.SetLines(lines)
    data.SetPolys(polygons)
    return data


def write_vtk(path: Path, data: Any, **settings: Any) -> None:
    """Write a file as ParaView does."""
    writer: Any = vtkXMLPolyDataWriter() if path.suffix == ".vtp" else vtkPolyDataWriter()
    writer.SetInputData(data)
    writer.SetFileName(str(path))
    for name, value in settings.items():
        getattr(writer, f"Set{name}")(value)
    assert writer.Write() == 1


def write(path: Path, **data: Any) -> Path:
    """Write a mesh with a triangle of bars and a surface; the surface does not belong to the truss."""
    if path.suffix == ".vtp":
        write_vtk(path, polydata())
        return path
    mesh = meshio.Mesh(POINTS, [("line", ENDS), ("triangle", np.array([[0, 1, 3]]))], **data)
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        # meshio's writer of Gmsh 4 wants to know more of a mesh of two types of cells.
        meshio.write(path, mesh, {**FORMATS, ".msh": "gmsh22"}[path.suffix])
    return path


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_mesh_gives_the_numbers_of_the_truss_by_hand(
    suffix: str, tmp_path: Path, statejump: Callable[..., Outcome]
) -> None:
    write(tmp_path / f"deck{suffix}")
    told = statejump("truss", "import", f"deck{suffix}", "-o", "deck.toml", *ARGUMENTS)
    assert told.status == 0, told.errors
    assert "cells triangle" in told.output and "no part" in told.output
    by_hand = sj.load({
        "case": {"name": "deck", "kind": "truss"}, "truss": {"dimension": 2},
        "node": [{"name": "N1", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
                 {"name": "N2", "position_m": [1.0, 0.0], "fixed": ["y"]}, {"name": "N3", "position_m": [0.0, 1.0]}],
        "link": [{"name": f"L{place}", "nodes": [f"N{end + 1}" for end in ends], **BAR}
                 for place, ends in enumerate(ENDS, start=1)],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 80.0}})
    ours, theirs = (case.reduced().history["displacement_m"].values for case in (sj.load(tmp_path / "deck.toml"), by_hand))
    assert np.array_equal(ours, theirs)


@pytest.mark.parametrize("suffix", [".vtk", ".vtu"])
def test_data_of_cells_that_have_our_names_are_those_of_links(suffix: str, tmp_path: Path) -> None:
    areas = np.array([1e-4, 2e-4, 3e-4])
    path = write(tmp_path / f"deck{suffix}", point_data={"heat": np.zeros(4)}, cell_data={
        "cross_section_area_m2": [areas, np.zeros(1)], "colour": [np.zeros(3), np.zeros(1)]})
    deck = read(path)
    assert [bar.area for bar in deck.bars] == areas.tolist() and deck.bars[0].young_modulus is None
    assert {card for card, _, _, _ in deck.left_rows()} == {"cells triangle", "point data 'heat'", "cell data 'colour'"}


@pytest.mark.parametrize("suffix, settings", [
    (".vtk", {"FileVersion": 42, "FileType": 1}), (".vtk", {"FileVersion": 51, "FileType": 2}), (".vtp", {"DataMode": 0}),
    (".vtp", {"DataMode": 2, "CompressorType": 2}),  # LZ4
])
def test_lines_of_surfaces_as_paraview_writes_them_are_read(suffix: str, settings: dict[str, int], tmp_path: Path) -> None:
    data = polydata(np.float32)
    for name, values in (("cross_section_area_m2", [1e-4, 2e-4, 3e-4, 0.0]), ("number", range(4))):
        array = numpy_to_vtk(np.array(values, dtype=np.float64 if name != "number" else np.int64), deep=True)
        array.SetName(name)
        data.GetCellData().AddArray(array)
    path = tmp_path / f"frame of bars{suffix}"
    write_vtk(path, data, **settings)
    deck = read(path)
    assert [bar.area for bar in deck.bars] == [1e-4, 2e-4, 3e-4]
    assert [bar.nodes for bar in deck.bars] == [tuple(str(end + 1) for end in ends) for ends in ENDS]
    assert {card for card, _, _, _ in deck.left_rows()} == {"cells triangle", "cell data 'number'"}


def test_polylines_are_bars_of_their_straight_parts(tmp_path: Path) -> None:
    data, line = polydata(), vtkCellArray()
    line.InsertNextCell(4)
    for corner in (0, 1, 3, 2):
        line.InsertCellPoint(corner)
    data.SetLines(line)
    areas = numpy_to_vtk(np.array([2e-4, 0.0]), deep=True)
    areas.SetName("cross_section_area_m2")
    data.GetCellData().AddArray(areas)
    write_vtk(tmp_path / "rope.vtp", data)
    deck = read(tmp_path / "rope.vtp")
    assert [bar.nodes for bar in deck.bars] == [("1", "2"), ("2", "4"), ("4", "3")]
    assert {bar.area for bar in deck.bars} == {2e-4}


WRONG: dict[str, tuple[tuple[Any, ...], Failure]] = {
    "no area": (ARGUMENTS[:2] + ARGUMENTS[4:], failure("bar_without_property", kind="line", name="1", property="cross-section area", option="--area")),
    "no modulus": (ARGUMENTS[2:], failure("bar_without_property", kind="line", name="1", property="Young's modulus", option="--young-modulus")),
    "negative": (("--young-modulus", -1, *ARGUMENTS[2:]), failure("out_of_range", item="link 'L1'", key="young_modulus_Pa", value=-1.0)),
    "no such node": ((*ARGUMENTS, "--fixed", "M1=x"), failure("misspelt_key", key="--fixed", value="M1")),
    "no direction": ((*ARGUMENTS, "--fixed", "N1=w"), failure("bad_fixed_option", key="--fixed", value="N1=w")),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_one_sentence(what: str, tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    write(tmp_path / "deck.vtk")
    arguments, sentence = WRONG[what]
    told = statejump("truss", "import", "deck.vtk", "-o", "deck.toml", *arguments)
    assert told.status == 2 and told.errors.count("\n") == 1 and told.failure == sentence, told.errors
    assert not (tmp_path / "deck.toml").exists()


@pytest.mark.parametrize("suffix", FORMATS)
def test_damaged_meshes_are_refused_or_read(suffix: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    whole = write(tmp_path / f"deck{suffix}").read_bytes()
    chance, refused = random.Random(1), 0
    numbers = 8 if suffix in BY_VTK else 60  # VTK reads each in a process of its own
    for number in range(numbers):
        damaged = bytearray(whole[:chance.randrange(len(whole))] if number % 2 else whole)
        for _ in range(3):
            if damaged:
                damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        path = tmp_path / f"damaged{suffix}"
        path.write_bytes(damaged)
        try:
            assert read(path).bars
        except StatejumpError as failure:
            refused += 1
            assert path.name in str(failure) and "\n" not in str(failure)
    assert refused > numbers / 3 and capfd.readouterr() == ("", "")


def test_addresses_of_objects_are_no_part_of_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "empty.vtk").write_text("")
    with failing("not_vtk", file="empty.vtk") as refused:
        read(tmp_path / "empty.vtk")
    assert "0x" not in str(refused.value)
