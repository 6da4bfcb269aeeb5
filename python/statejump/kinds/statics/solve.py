# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a loaded clearance joint can rest: rest sets of a case, table, JSON, ParaView file."""
from __future__ import annotations

import json
from dataclasses import dataclass, field
from math import cos, pi, sin
from pathlib import Path
from typing import Any, Optional

import click
import numpy as np
from rich.console import Console
from rich.table import Table

from statejump import _engine
from statejump.kinds.statics.case import LoadCase, StaticsCase
from statejump.core.errors import FailedRun, StatejumpError
from statejump.core.output import results_folder, write_atomically
from statejump.cli.terminal import CASE, QUIET, RESULTS, load_kind, make_console, number

SPHERE_LEVEL = 4  # 5120 triangles
SIDES = 96  # of the can that stands for a cylinder's positions


@dataclass(frozen=True)
class Statics:
    """Rest sets of a case: one per force, the union (any), the intersection (all)."""

    friction_coefficient: float
    loads: list[LoadCase]
    each: list[dict[str, Any]]
    any: dict[str, Any]
    all: dict[str, Any]
    curve: Optional[_engine.RestCurve] = None  # of a lobed bearing
    mesh: Optional[_engine.RestMesh] = None  # of positions in space, for pictures
    pieces: dict[str, Any] = field(default_factory=dict)  # the mesh cut into polygons

    def named(self) -> list[tuple[str, dict[str, Any]]]:
        """All sets with their names; union and intersection only of several forces."""
        sets = [(load.name, found) for load, found in zip(self.loads, self.each)]
        if len(sets) > 1:
            sets += [("union: any force", self.any), ("intersection: every force", self.all)]
        return sets


def solve(case: StaticsCase, folder: Path, friction_coefficient: Optional[float] = None) -> Statics:
    """Return the rest sets of a case.

    :param folder: the case file's, where a mesh file is looked for
    :param friction_coefficient: instead of the case's own
    """
    joint, loads = case.joint, case.load_cases
    mu = joint.friction_coefficient if friction_coefficient is None else friction_coefficient
    forces = [load.force_N for load in loads]
    curve = mesh = None
    try:
        if joint.type == "slot":
            found = _engine.rest_in_slot(joint.clearance_m, forces, mu)
        elif joint.type == "journal":
            found = _engine.rest_in_bearing(joint.clearance_m, [force[:2] for force in forces], mu)
        elif joint.type == "lobed":
            curve = _engine.lobed_curve(joint.clearance_m, joint.lobe_amplitude_m / joint.clearance_m, joint.lobes)
            found = _engine.rest_on_curves([curve], [force[:2] for force in forces], mu)
        elif joint.type == "ball":
            found = _engine.rest_in_socket(joint.clearance_m, forces, mu)
            mesh = _engine.clearance_sphere(joint.clearance_m, SPHERE_LEVEL)
        elif joint.type == "cylinder":
            found = _engine.rest_in_bore(joint.clearance_m, joint.axial_play_m, forces, mu)
            mesh = can_mesh(joint.clearance_m, joint.axial_play_m)
        else:
            mesh = read_mesh(case, folder)
            found = _engine.rest_on_mesh(mesh, forces, mu)
        pieces: dict[str, Any] = {}
        if mesh is not None:
            pieces = found if joint.type == "mesh" else _engine.rest_on_mesh(mesh, forces, mu)
    except ValueError as reason:
        raise FailedRun(f"{case.name}: {reason}") from None
    return Statics(mu, loads, found["each"], found["any"], found["all"], curve, mesh, pieces)


def can_mesh(clearance_m: float, axial_play_m: float) -> _engine.RestMesh:
    """Positions of a cylinder's centre: wall and two discs, each with normals of its own."""
    vertices: list[tuple[float, float, float]] = []
    normals: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    rows = 16
    for row in range(rows + 1):
        for side in range(SIDES):
            angle = 2 * pi * side / SIDES
            z = axial_play_m * (2 * row / rows - 1)
            vertices.append((clearance_m * cos(angle), clearance_m * sin(angle), z))
            normals.append((-cos(angle), -sin(angle), 0.0))
            if row < rows:
                a, b = row * SIDES + side, row * SIDES + (side + 1) % SIDES
                triangles += [(a, a + SIDES, b), (b, a + SIDES, b + SIDES)]
    rings = 6
    for end in (-1.0, 1.0):
        centre = len(vertices)
        vertices.append((0.0, 0.0, end * axial_play_m))
        normals.append((0.0, 0.0, -end))
        for ring in range(1, rings + 1):
            for side in range(SIDES):
                angle, radius = 2 * pi * side / SIDES, clearance_m * ring / rings
                vertices.append((radius * cos(angle), radius * sin(angle), end * axial_play_m))
                normals.append((0.0, 0.0, -end))
                here, there = (centre + 1 + (ring - 1) * SIDES + s for s in (side, (side + 1) % SIDES))
                if ring == 1:
                    triangles.append((centre, here, there))
                else:
                    triangles += [(here - SIDES, here, there - SIDES), (there - SIDES, here, there)]
    return _engine.RestMesh(vertices, triangles, normals)


def read_mesh(case: StaticsCase, folder: Path) -> _engine.RestMesh:
    """Read the mesh of a case through VTK: STL, OBJ, PLY or VTP; points that coincide are one."""
    joint = case.joint
    assert joint.mesh_file is not None and joint.mesh_unit_m is not None
    path = folder / joint.mesh_file
    key = f"joint.mesh_file = {joint.mesh_file!r}"
    try:
        path.open("rb").close()
    except OSError as failure:
        raise StatejumpError(f"{case.name}: {key}: {path} cannot be read: {failure.strerror}") from None
    try:
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkObject
        from vtkmodules.vtkFiltersCore import vtkTriangleFilter
        from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader
        from vtkmodules.vtkIOPLY import vtkPLYReader
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
    except ImportError as failure:
        raise StatejumpError(f"{case.name}: {key}: VTK for Python is needed (python3-vtk9): {failure}") from None
    readers = {".stl": vtkSTLReader, ".obj": vtkOBJReader, ".ply": vtkPLYReader, ".vtp": vtkXMLPolyDataReader}
    if path.suffix.lower() not in readers:
        raise StatejumpError(f"{case.name}: {key} is not allowed: must end with {', '.join(readers)}")
    reader = readers[path.suffix.lower()]()
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
    surface = triangulate.GetOutput()
    if surface.GetNumberOfPolys() == 0:
        raise StatejumpError(f"{case.name}: {key}: {path} holds no triangles")
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float) * joint.mesh_unit_m
    triangles = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    if joint.mesh_free_side == "left_hand":
        triangles = triangles[:, ::-1]
    extent = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))
    return _engine.welded(_engine.RestMesh(points, triangles.tolist()), 1e-9 * extent)


def _plain(found: dict[str, Any]) -> dict[str, Any]:
    """Return a set as JSON takes it."""
    keys = ("area_m2", "length_m", "diameter_m", "diameter_error_m")
    parts = [
        {key: part[key] for key in ("area_m2", "length_m", "angle_rad", "diameter_m")}
        | {"representative_m": np.asarray(part["representative_m"]).tolist()}
        | ({"ends_m": part["points_m"][[0, -1]].tolist()} if len(part["points_m"]) else {})
        for part in found["parts"]
    ]
    farthest = found["farthest_m"].tolist() if found["parts"] else None
    return {key: found[key] for key in keys} | {"farthest_m": farthest, "parts": parts}


def write_json(case: StaticsCase, statics: Statics, folder: Path) -> Path:
    """Write ``statics.json``: every number of the table, and the positions."""
    joint = {key: value for key, value in case.joint.dict().items() if value is not None}
    document = {
        "case": case.name,
        "title": case.title,
        "joint": joint,
        "forces": [{"name": load.name, "force_N": list(load.force_N)} for load in statics.loads],
        "each": [_plain(found) for found in statics.each],
        "any": _plain(statics.any),
        "all": _plain(statics.all),
    }
    target = folder / "statics.json"
    with write_atomically(target) as stream:
        stream.write(json.dumps(document, indent=1, ensure_ascii=False) + "\n")
    return target


def write_vtp(statics: Statics, folder: Path, name: str) -> Path:
    """Write ``<name>.vtp`` for ParaView: the surface of positions, cut along the rest sets.

    Cell arrays: ``stable`` (1 if at least one force allows rest), ``forces`` (how many do). Point
    array: ``cone_angle_rad``, the smallest angle(-F, N) over the forces.
    """
    try:
        from vtkmodules.vtkCommonDataModel import vtkPolyData

        from statejump.results.vtk_data import add_array, cells, points, write
    except ImportError as failure:
        raise StatejumpError(f"{name}.vtp: VTK for Python is needed (python3-vtk9): {failure}") from None
    polygons, count = statics.pieces["polygons_m"], np.array(statics.pieces["polygon_forces"], dtype=np.int32)
    corners = np.concatenate(polygons)
    data = vtkPolyData()
    data.SetPoints(points(corners))
    data.SetPolys(cells([len(polygon) for polygon in polygons], np.arange(len(corners))))
    add_array(data.GetPointData(), "cone_angle_rad", cone_angles(statics))
    add_array(data.GetCellData(), "stable", (count > 0).astype(np.int32))
    add_array(data.GetCellData(), "forces", count)
    target = folder / f"{name}.vtp"
    write(data, target)
    return target


def cone_angles(statics: Statics) -> np.ndarray:
    """Smallest angle(-F, N) over the forces at every corner of every polygon, one after another."""
    assert statics.mesh is not None
    polygons = statics.pieces["polygons_m"]
    points = np.concatenate(polygons)
    owner = np.repeat(np.array(statics.pieces["polygon_triangles"]), [len(polygon) for polygon in polygons])
    triangles = np.array(statics.mesh.triangles)[owner]
    a, b, c = (statics.mesh.vertices_m[triangles[:, i]] for i in range(3))
    u, v, w = b - a, c - a, points - a
    uu, uv, vv, wu, wv = ((p * q).sum(axis=1) for p, q in ((u, u), (u, v), (v, v), (w, u), (w, v)))
    determinant = uu * vv - uv**2
    weights = np.stack(((vv * wu - uv * wv) / determinant, (uu * wv - uv * wu) / determinant), axis=1)
    corners = vertex_normals(statics.mesh)
    normals = corners[triangles[:, 0]] * (1 - weights.sum(axis=1))[:, None]
    for i in (0, 1):
        normals += corners[triangles[:, i + 1]] * weights[:, [i]]
    best = np.full(len(points), pi)
    for load in statics.loads:
        reaction = -np.array(load.force_N)
        across = np.linalg.norm(np.cross(normals, reaction), axis=1)
        best = np.minimum(best, np.arctan2(across, normals @ reaction))
    return best


def vertex_normals(mesh: _engine.RestMesh) -> np.ndarray:
    """Normals at the vertices, unit; of a mesh without, the mean that the engine takes."""
    if len(mesh.normals):
        return mesh.normals / np.linalg.norm(mesh.normals, axis=1)[:, None]
    points, triangles = mesh.vertices_m, np.array(mesh.triangles)
    normals = np.zeros_like(points)
    corners = points[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face /= np.maximum(np.linalg.norm(face, axis=1), 1e-300)[:, None]
    for i in range(3):
        one, two = corners[:, (i + 1) % 3] - corners[:, i], corners[:, (i + 2) % 3] - corners[:, i]
        angle = np.arctan2(np.linalg.norm(np.cross(one, two), axis=1), (one * two).sum(axis=1))
        np.add.at(normals, triangles[:, i], angle[:, None] * face)
    return normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]


def _measure(value: dict[str, Any]) -> tuple[str, str]:
    """Length and area for a table; a point has neither."""
    length, area = (number(value[key]) if value[key] else "-" for key in ("length_m", "area_m2"))
    return length, area


def print_table(case: StaticsCase, statics: Statics, console: Console) -> None:
    """Print every set and, if it has several parts, every part."""
    table = Table(title=f"{case.title}: where it can rest, friction coefficient {statics.friction_coefficient:g}")
    for heading in ("force", "parts", "length [m]", "area [m2]", "angle [rad]", "largest jump [m]"):
        table.add_column(heading, justify="left" if heading == "force" else "right")
    for name, found in statics.named():
        parts = found["parts"]
        angle = parts[0]["angle_rad"] if len(parts) == 1 else None
        table.add_row(name, str(len(parts)), *_measure(found), "-" if angle is None else number(angle),
                      number(found["diameter_m"]) if parts else "-")
        for index, part in enumerate(parts if len(parts) > 1 else (), start=1):
            angle = part["angle_rad"]
            table.add_row(f"  part {index}", "", *_measure(part), "-" if angle is None else number(angle),
                          number(part["diameter_m"]))
    console.print(table)
    if not statics.all["parts"] and len(statics.loads) > 1:
        console.print("no position holds under every force: the joint moves from one to the other")
    error = max(found["diameter_error_m"] for _, found in statics.named())
    if error > 0:
        console.print(f"on a mesh: error of the largest jump about {error:.2g} m")


@click.command("statics")
@CASE
@RESULTS
@QUIET
def statics_command(case_file: Path, results: Path, quiet: bool) -> None:
    """Where the joint of CASE can rest: parts, measure, and the largest jump that friction allows.

    \b
    Example:
      statejump statics cases/statics_journal.toml
    """
    from statejump.kinds.statics import figure as statics_plot

    console = make_console(quiet)
    case = load_kind(case_file, StaticsCase)
    folder = results_folder(results, case.name)
    statics = solve(case, case_file.parent)
    print_table(case, statics, console)
    written = [write_json(case, statics, folder)]
    if case.is_planar:
        wanted = sorted({*case.picture.friction_coefficients, case.joint.friction_coefficient})
        written += statics_plot.planar(case, [solve(case, case_file.parent, mu) for mu in wanted], folder)
    else:
        written += statics_plot.spatial(case, statics, folder)
        written.append(write_vtp(statics, folder, case.name))
    console.print(f"results: {', '.join(str(path) for path in written)}")
