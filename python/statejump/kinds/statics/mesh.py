# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangle meshes of possible positions, either of a cylinder in its bore or from a file, and their normals."""
from __future__ import annotations

from math import cos, pi, sin
from typing import Any

import numpy as np

from statejump import _engine
from statejump.core.errors import NotAllowed, StatejumpError, shown
from statejump.kinds.statics.case import StaticsCase

SIDES = 96  # sides of the cylinder of positions


def can_mesh(clearance_m: float, axial_play_m: float) -> _engine.RestMesh:
    """Return the surface of the centre of a cylinder in its bore: wall and two discs, each with its own normals."""
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


class MeshUnusable(StatejumpError):
    """The mesh of a case cannot be read: ``joint.mesh_file = FILE: WHAT[: CAUSE]``."""

    def phrase(self) -> str:
        return f"{self.key} = {shown(self.value)}: {self.what}"


def read_mesh(case: StaticsCase) -> _engine.RestMesh:
    """Read the mesh of a case through VTK: STL, OBJ, PLY or VTP. Coincident points are merged.

    A relative path refers to the folder of the case file.

    :raises StatejumpError: the mesh cannot be read, or has no triangles
    """
    joint, name = case.joint, case.joint.mesh_file
    assert name is not None and joint.mesh_unit_m is not None
    path = case.origin.folder / name
    about: dict[str, Any] = {"key": "joint.mesh_file", "value": name, "case": case.name, "file": case.origin.file}
    try:
        path.open("rb").close()
    except OSError as failure:
        raise MeshUnusable(code="mesh_not_read", cause=failure.strerror, path=path, **about) from None
    try:
        from statejump.kinds.statics import mesh_files  # VTK, 0.2 s, which may be missing
    except ImportError as failure:
        raise MeshUnusable(code="vtk_missing", cause=str(failure), **about) from None
    if path.suffix.lower() not in mesh_files.READERS:
        raise NotAllowed(**about, code="suffix_unknown", suffixes=", ".join(mesh_files.READERS))
    surface = mesh_files.triangles_of(path)
    if surface.GetNumberOfPolys() == 0:
        raise MeshUnusable(code="mesh_without_triangles", path=path, **about)
    stored = mesh_files.vtk_to_numpy(surface.GetPoints().GetData())
    points = stored.astype(float) * joint.mesh_unit_m
    triangles = mesh_files.vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    if joint.mesh_free_side == "left_hand":
        triangles = triangles[:, ::-1]
    extent = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))
    # A vertex that a file repeats may be rounded twice: two units in the last place of the largest coordinate.
    rounding = 2 * float(np.finfo(stored.dtype).eps) * float(np.abs(points).max())
    return _engine.welded(_engine.RestMesh(points, triangles.tolist()), max(1e-9 * extent, rounding))


def vertex_normals(mesh: _engine.RestMesh) -> np.ndarray:
    """Return unit normals at the vertices. If the mesh has no normals, the engine computes mean normals."""
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
