# SPDX-License-Identifier: GPL-3.0-or-later
"""Records joints and links for ParaView. Imported by scripts that run under ``yade``.

    from paraview import ParaViewRecorder
    recorder = ParaViewRecorder("out/umbrella-", program=orbit)
    O.engines = [..., PyRunner(command="recorder.write()", iterPeriod=1000), NewtonIntegrator(...)]

Files are named as by YADE's VTKRecorder, ``<prefix>joints.<iteration>.vtp``. For each type of file a
``<prefix>joints.vtp.series`` gives ParaView the simulated times. Types:

- joints: outline of every Journal, Bearing, Ball, Socket, Slider and SlotFace, and the triangles of every MeshBore, at
  the current temperature; ``kind`` is the index in KINDS
- links: every ThermalLink as a line, with its axial force
- contacts: a point per contact, with normal and shear force as vectors on body 1, the gap or
  penetration depth and whether it slips
"""
from __future__ import annotations

import json
import os
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import statejump_yade as sj
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
from yade.minieigenHP import Vector3
from yade.wrapper import Omega

O = Omega()
SIDES = 96  # number of sides of a circle; the sagitta is 5e-4 of the radius
KINDS = {"Journal": 1, "Bearing": 2, "Slider": 3, "SlotFace": 4, "Ball": 5, "Socket": 6,
         "MeshBore": 7}


class _Data:
    """Polylines or points with data arrays, added one by one, followed by meshes. All arrays exist even without cells,
    because ParaView requires the same arrays at all times."""

    def __init__(self, components: dict[str, int]) -> None:
        self.points, self.lines, self.vertices = vtkPoints(), vtkCellArray(), vtkCellArray()
        self.triangles = vtkCellArray()
        self.points.SetDataTypeToDouble()
        self.arrays: dict[str, vtkDoubleArray] = {}
        for name, count in components.items():
            self.arrays[name] = vtkDoubleArray()
            self.arrays[name].SetName(name)
            self.arrays[name].SetNumberOfComponents(count)

    def add(self, points: list[Vector3], *values: float | Vector3) -> None:
        """Add one cell: a polyline, or a vertex for a single point. Values are in the order of the arrays."""
        cells = self.lines if len(points) > 1 else self.vertices
        cells.InsertNextCell(len(points))
        for point in points:
            cells.InsertCellPoint(self.points.InsertNextPoint(*point))
        for array, value in zip(self.arrays.values(), values, strict=True):
            array.InsertNextTuple(tuple(value) if isinstance(value, Vector3) else (float(value),))

    def add_mesh(self, points: np.ndarray, triangles: np.ndarray, *values: float | Vector3) -> None:
        """Add triangles with the same values. VTK orders them after all lines, so add them last."""
        first = self.points.GetNumberOfPoints()
        for point in points:
            self.points.InsertNextPoint(point)
        for corners in (triangles + first).tolist():
            self.triangles.InsertNextCell(3, corners)
        for array, value in zip(self.arrays.values(), values, strict=True):
            entry = tuple(value) if isinstance(value, Vector3) else (float(value),)
            for _ in range(len(triangles)):
                array.InsertNextTuple(entry)

    def write(self, path: Path) -> None:
        """Write the file aside, then rename it."""
        data = vtkPolyData()
        data.SetPoints(self.points)
        data.SetLines(self.lines)
        data.SetVerts(self.vertices)
        data.SetPolys(self.triangles)
        for array in self.arrays.values():
            data.GetCellData().AddArray(array)
        aside = path.with_name(f".{path.stem}.partial{path.suffix}")
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(str(aside))
        writer.SetInputData(data)
        if not writer.Write():
            raise OSError(f"{path}: cannot be written")
        os.replace(aside, path)


def _outline(body) -> list[Vector3]:
    """Return the closed outline of a body of the plugin in space [m]."""
    shape, state = body.shape, body.state
    kind = type(shape).__name__
    grown = 1 + shape.thermalStrain
    if kind == "SlotFace":
        normal = shape.normal
        across = normal.cross(Vector3(0, 0, 1))
        half = shape.distance * grown if shape.distance > 0 else 1.0
        corners = [normal * shape.distance * grown + across * s for s in (-half, half)]
        return [state.pos + state.ori * corner for corner in corners]
    radius = shape.radius * grown
    turn = [2 * pi * i / SIDES for i in range(SIDES + 1)]
    circle = [Vector3(radius * cos(a), radius * sin(a), 0) for a in turn]
    if kind in ("Ball", "Socket"):  # one more great circle from the same point
        circle += [Vector3(point[0], 0, point[1]) for point in circle]
    return [state.pos + state.ori * point for point in circle]


def _mesh(body, given: np.ndarray) -> np.ndarray:
    """Return the vertices of a MeshBore in space [m], from those in its own axes."""
    shape, state = body.shape, body.state
    centre = np.array(shape.wallCentre())
    local = centre + (1 + shape.thermalStrain) * (given - centre)
    return np.array(state.pos) + local @ np.array(state.ori.toRotationMatrix()).reshape(3, 3).T


class ParaViewRecorder:
    """Writes the current scene as files for ParaView.

    :param prefix: beginning of all file names; missing folders are created
    :param program: ThermalProgram whose temperature change is also written, or None
    """

    def __init__(self, prefix: str, program: sj.ThermalProgram | None = None) -> None:
        self.prefix, self.program = Path(prefix), program
        self.prefix.parent.mkdir(parents=True, exist_ok=True)
        self.series: dict[str, list[dict[str, object]]] = {}
        # Vertices and triangles by body: they never change, but YADE makes new lists at each access.
        self.meshes: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def write(self) -> None:
        """Write one file of each type for the current step, and update the series files."""
        change = self.program.temperatureChange(O.time) if self.program else 0.0
        joints = _Data({"body": 1, "kind": 1, "temperature_change_K": 1, "velocity_m_per_s": 3})
        bores = []
        for body in O.bodies:
            kind = KINDS.get(type(body.shape).__name__) if body.shape else None
            if kind == KINDS["MeshBore"]:
                bores.append(body)
            elif kind:
                joints.add(_outline(body), body.id, kind, change, body.state.vel)
        for body in bores:
            if body.id not in self.meshes:
                shape = body.shape
                self.meshes[body.id] = (shape.scale * np.array(shape.vertices), np.array(shape.triangles))
            vertices, triangles = self.meshes[body.id]
            joints.add_mesh(_mesh(body, vertices), triangles, body.id, KINDS["MeshBore"], change, body.state.vel)
        links = _Data({"axial_force_N": 1, "temperature_change_K": 1})
        for engine in O.engines:
            for link in engine.links if isinstance(engine, sj.ThermalLinks) else ():
                ends = [O.bodies[link.id1].state.pos, O.bodies[link.id2].state.pos]
                links.add(ends, link.axialForce, link.temperatureChange)
        contacts = _Data({
            "normal_force_N": 3, "shear_force_N": 3, "penetration_depth_m": 1, "slipping": 1,
            "body_1": 1, "body_2": 1,
        })
        for contact in O.interactions:
            if not contact.isReal:
                continue
            pairs = []
            if isinstance(contact.geom, sj.JointGeom):
                pairs = [(contact.geom, contact.phys)]
            elif isinstance(contact.geom, sj.BoreGeom):
                pairs = zip(contact.geom.contacts, contact.phys.contacts)
            for geom, phys in pairs:
                contacts.add(  # YADE stores the forces on body 2
                    [geom.contactPoint], -phys.normalForce, -phys.shearForce,
                    geom.penetrationDepth, phys.slipping, contact.id1, contact.id2,
                )
        for name, data in (("joints", joints), ("links", links), ("contacts", contacts)):
            self._write(name, data)

    def _write(self, name: str, data: _Data) -> None:
        path = self.prefix.with_name(f"{self.prefix.name}{name}.{O.iter}.vtp")
        data.write(path)
        entries = self.series.setdefault(name, [])
        entries.append({"name": path.name, "time": O.time})
        target = self.prefix.with_name(f"{self.prefix.name}{name}.vtp.series")
        aside = target.with_name(f".{target.name}.partial")
        aside.write_text(json.dumps({"file-series-version": "1.0", "files": entries}, indent=1) + "\n")
        os.replace(aside, target)
