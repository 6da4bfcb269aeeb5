# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of a file, read by VTK."""
from __future__ import annotations

from pathlib import Path
from typing import Any

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

__all__ = ["READERS", "triangles_of", "vtk_to_numpy"]

READERS: dict[str, Any] = {
    ".stl": vtkSTLReader, ".obj": vtkOBJReader, ".ply": vtkPLYReader, ".vtp": vtkXMLPolyDataReader,
}


def triangles_of(path: Path) -> Any:
    """Return the surface in a file as triangles of VTK; empty if VTK cannot read the file."""
    reader = READERS[path.suffix.lower()]()
    reader.SetFileName(str(path))
    triangulate = vtkTriangleFilter()
    triangulate.PassLinesOff()
    triangulate.PassVertsOff()
    triangulate.SetInputConnection(reader.GetOutputPort())
    vtkObject.GlobalWarningDisplayOff()
    try:
        triangulate.Update()
    finally:
        vtkObject.GlobalWarningDisplayOn()
    return triangulate.GetOutput()
