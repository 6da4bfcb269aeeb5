# SPDX-License-Identifier: GPL-3.0-or-later
"""Program that reads the lines of a file with VTK: ``python vtk_lines.py FILE`` writes arrays to standard output.

The program runs as a separate process, because some damaged files crash the process that reads them. It imports nothing
of the package.
"""
from __future__ import annotations

import io
import sys
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkCommonDataModel import VTK_LINE, VTK_POLY_LINE, VTK_QUADRATIC_EDGE, vtkCellTypes
from vtkmodules.vtkFiltersCore import vtkAppendFilter
from vtkmodules.vtkIOLegacy import vtkDataSetReader
from vtkmodules.vtkIOXML import vtkXMLGenericDataObjectReader

LINES = {VTK_LINE: "line", VTK_POLY_LINE: "polyline", VTK_QUADRATIC_EDGE: "line3"}
NOT_READ = 3  # exit status


def grid_of(path: str) -> Any:
    """Return the contents of a file as an unstructured grid. :raises SystemExit: VTK reports an error"""
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    reader: Any = vtkDataSetReader() if path.lower().endswith(".vtk") else vtkXMLGenericDataObjectReader()
    if isinstance(reader, vtkDataSetReader):
        for what in ("Scalars", "Vectors", "Normals", "Tensors", "ColorScalars", "TCoords", "Fields"):
            getattr(reader, f"ReadAll{what}On")()
    reader.SetFileName(path)
    append = vtkAppendFilter()
    append.SetInputConnection(reader.GetOutputPort())
    append.Update()
    said = window.GetOutput()
    grid = append.GetOutput()
    if "ERROR" in said or grid is None or grid.GetPoints() is None:
        sys.stderr.write(said or "it holds no points")
        sys.exit(NOT_READ)
    return grid


def arrays_of(grid: Any) -> dict[str, np.ndarray]:
    """Return points, names of data and, for each block of cells of one type, its name and the ends and the positions of
    lines."""
    types = vtk_to_numpy(grid.GetCellTypesArray()) if grid.GetNumberOfCells() else np.zeros(0, dtype=np.uint8)
    cells = grid.GetCells()
    offsets, nodes = (vtk_to_numpy(part) for part in (cells.GetOffsetsArray(), cells.GetConnectivityArray()))
    found = {"points": vtk_to_numpy(grid.GetPoints().GetData()).astype(float)}
    for kind in np.unique(types):
        places = np.flatnonzero(types == kind)
        name = LINES.get(int(kind)) or vtkCellTypes.GetClassNameFromTypeId(int(kind)).removeprefix("vtk").lower()
        if int(kind) == VTK_POLY_LINE:
            parts = np.diff(offsets)[places] - 1
            starts = np.concatenate([np.arange(offsets[cell], offsets[cell + 1] - 1) for cell in places])
            places = np.repeat(places, parts)
        else:
            starts = offsets[places]
        if int(kind) in LINES:
            found[f"ends/{name}"] = np.column_stack([nodes[starts], nodes[starts + 1]])
        found[f"cells/{name}"] = places
    for where, data in (("point", grid.GetPointData()), ("cell", grid.GetCellData())):
        for number in range(data.GetNumberOfArrays()):
            array = data.GetAbstractArray(number)
            values = vtk_to_numpy(array) if where == "cell" and array.IsNumeric() else np.zeros(0)
            found[f"{where} data/{array.GetName()}"] = values
    return found


def main(path: str) -> None:
    """Write the arrays of a file as an archive of numpy."""
    archive = io.BytesIO()
    np.savez(archive, **arrays_of(grid_of(path)))  # type: ignore[arg-type]
    sys.stdout.buffer.write(archive.getvalue())


if __name__ == "__main__":
    main(sys.argv[1])
