# SPDX-License-Identifier: GPL-3.0-or-later
"""Building blocks of VTK files: points, cells, named arrays, a file, a series of files with the true times."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkDataObject, vtkFieldData
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter, vtkXMLWriter

from statejump.core.errors import NotWritten
from statejump.core.output import write_bytes
from statejump.core.tables import write_json


def frames_of(samples: int, wanted: int) -> np.ndarray:
    """Return the samples to write: all if ``wanted`` is 0, else evenly spaced ones with the first and the last."""
    if wanted == 0 or wanted >= samples:
        return np.arange(samples)
    return np.unique(np.round(np.linspace(0, samples - 1, max(wanted, 2))).astype(int))


def file_time(time_s: float) -> float:
    """Return a time [s] rounded for VTK files, because two models may round the same instant differently."""
    return float(f"{time_s:.9g}")


def points(values: np.ndarray) -> vtkPoints:
    """Return points [m] (n, 3)."""
    made = vtkPoints()
    made.SetDataTypeToDouble()
    made.SetData(numpy_to_vtk(np.ascontiguousarray(values, dtype=float).reshape(-1, 3), deep=True))
    return made


def cells(lengths: list[int], connectivity: np.ndarray) -> vtkCellArray:
    """Return cells with equal numbers of points; ``connectivity`` has the points' indices, cell after cell."""
    made = vtkCellArray()
    offsets = np.concatenate((np.zeros(1, dtype=np.int64), np.cumsum(lengths, dtype=np.int64)))
    made.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True),
                 numpy_to_vtkIdTypeArray(np.ascontiguousarray(connectivity, dtype=np.int64), deep=True))
    return made


def add_array(field: vtkFieldData, name: str, values: Any) -> None:
    """Add an array to VTK data; a list of texts becomes a text array."""
    if isinstance(values, list):
        array = vtkStringArray()
        for text in values:
            array.InsertNextValue(text)
    else:
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    field.AddArray(array)


def write(data: vtkDataObject, path: Path, time_s: float | None = None) -> None:
    """Write a .vtu or .vtp file. The time is stored as the field array ``time_s``.

    :raises NotWritten: VTK cannot write the file
    """
    if time_s is not None:
        add_array(data.GetFieldData(), "time_s", np.array([time_s]))
    writer: vtkXMLWriter = vtkXMLUnstructuredGridWriter() if path.suffix == ".vtu" else vtkXMLPolyDataWriter()
    writer.SetWriteToOutputString(True)
    writer.SetInputData(data)
    if not writer.Write():
        raise NotWritten(code="write_failed", file=path)
    write_bytes(path, writer.GetOutputString().encode())


def write_series(path: Path, files: list[tuple[str, float]]) -> None:
    """Write the ``.series`` file that ParaView opens. It lists the names of files and their times [s]."""
    entries = [{"name": name, "time": time_s} for name, time_s in files]
    write_json(path, {"file-series-version": "1.0", "files": entries}, indent=1)
