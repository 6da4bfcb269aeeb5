# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK files of a result, made from its scene. Each model has one series per type of content, with the true times.

- ``<model>_links``, .vtu: links and springs as lines with axial force, thermal strain, temperature change
- ``<model>_parts``, .vtp: journals, bearings, blocks, slots, frames, meshes
- ``<model>_contacts``, .vtp: a point per contact with its state, gap, normal and tangential force
- ``<model>_forces``, .vtp: a point per further force, if the scene has any
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from vtkmodules.vtkCommonDataModel import VTK_LINE, vtkDataObject, vtkPolyData, vtkUnstructuredGrid

from statejump.core.run import Run
from statejump.results.contents import Result
from statejump.results.outline import growth, outlines, placed
from statejump.results.scene import PART_TYPES, resolve, resolve_point
from statejump.results.vtk_data import add_array, cells, file_time, frames_of, points, write, write_series

TYPE_NUMBERS = {name: number for number, name in enumerate(PART_TYPES, start=1)}


class _Lines:
    """Links and springs."""

    suffix = ".vtu"

    def __init__(self, result: Result, run: Run, model: str) -> None:
        self.parts = [part for part in result.scene["parts"] if part["type"] in ("link", "spring")]
        self.ends = [[resolve_point(end, run, result.names) for end in part["ends"]] for part in self.parts]
        samples = len(run.time_s)
        missing = np.full(samples, np.nan)
        self.arrays = {
            name: np.stack([
                resolve(part["values"][name], run, result.names) if name in part.get("values", {}) else missing
                for part in self.parts
            ] or [missing], axis=1)[:, : len(self.parts)]
            for name in sorted(
                {"axial_force_N", "thermal_strain"}.union(*(part.get("values", {}) for part in self.parts))
            )
        }
        change = [
            resolve(part.get("temperature_change_K", result.scene["temperature_change_K"]), run, result.names)
            for part in self.parts
        ]
        self.arrays["temperature_change_K"] = np.stack(change or [missing], axis=1)[:, : len(self.parts)]

    def at(self, frame: int) -> vtkDataObject:
        data = vtkUnstructuredGrid()
        ends = [end[frame] for pair in self.ends for end in pair]
        data.SetPoints(points(np.array(ends)))
        data.SetCells(VTK_LINE, cells([2] * len(self.parts), np.arange(2 * len(self.parts))))
        about = data.GetCellData()
        add_array(about, "part", [part["name"] for part in self.parts])
        add_array(about, "type", np.array([TYPE_NUMBERS[part["type"]] for part in self.parts], dtype=np.int32))
        for name, values in self.arrays.items():
            add_array(about, name, values[frame])
        return data


@dataclass(frozen=True)
class _Shape:
    """A part to be drawn: polylines or triangles in its own coordinate frame, and the motion of this frame."""

    part: dict[str, Any]
    lines: list[np.ndarray]
    triangles: tuple[np.ndarray, np.ndarray] | None
    centre: np.ndarray
    angle_rad: np.ndarray
    growth: np.ndarray
    change_K: np.ndarray


class _Parts:
    """All parts except links and springs."""

    suffix = ".vtp"

    def __init__(self, result: Result, run: Run, model: str) -> None:
        self.shapes = [
            self._shape(part, result, run, model)
            for part in result.scene["parts"] if part["type"] not in ("link", "spring")
        ]

    @staticmethod
    def _shape(part: dict[str, Any], result: Result, run: Run, model: str) -> _Shape:
        names, samples = result.names, len(run.time_s)
        change = resolve(part.get("temperature_change_K", result.scene["temperature_change_K"]), run, names)
        if part["type"] == "frame":
            outline = np.array([resolve_point(point, run, names)[0] for point in part["points"]])
            return _Shape(part, [outline], None, np.zeros((samples, 3)), np.zeros(samples), np.ones(samples), change)
        triangles = None
        if part["type"] == "mesh":
            mesh = result.meshes[part["mesh"]]
            triangles = (mesh.vertices_m, mesh.triangles)
        return _Shape(
            part, outlines(part), triangles, resolve_point(part["centre"], run, names),
            resolve(part["angle_rad"], run, names), growth(part, result, model), change,
        )

    def at(self, frame: int) -> vtkDataObject:
        all_points: list[np.ndarray] = []
        lines: list[np.ndarray] = []
        triangles: list[np.ndarray] = []
        drawn: list[_Shape] = []  # one part per cell: lines before triangles, the order of VTK
        faces: list[_Shape] = []
        count = 0
        for shape in self.shapes:
            place = (shape.centre[frame], float(shape.angle_rad[frame]), float(shape.growth[frame]))
            for line in shape.lines:
                all_points.append(placed(line, *place))
                lines.append(np.arange(count, count + len(line)))
                drawn.append(shape)
                count += len(line)
            if shape.triangles is not None:
                vertices, corners = shape.triangles
                all_points.append(placed(vertices, *place))
                triangles.append(corners + count)
                faces += [shape] * len(corners)
                count += len(vertices)
        data = vtkPolyData()
        data.SetPoints(points(np.concatenate(all_points) if all_points else np.zeros((0, 3))))
        data.SetLines(cells([len(line) for line in lines], np.concatenate(lines) if lines else np.zeros(0)))
        if triangles:
            corners = np.concatenate(triangles)
            data.SetPolys(cells([3] * len(corners), corners.ravel()))
        shapes, about = drawn + faces, data.GetCellData()
        add_array(about, "part", [shape.part["name"] for shape in shapes])
        add_array(about, "type", np.array([TYPE_NUMBERS[shape.part["type"]] for shape in shapes], dtype=np.int32))
        add_array(about, "temperature_change_K", np.array([shape.change_K[frame] for shape in shapes], dtype=float))
        add_array(about, "thermal_strain", np.array([shape.growth[frame] - 1 for shape in shapes], dtype=float))
        return data


class _Vertices:
    """Points with arrays. The number of points is constant over time, even while some forces are zero."""

    suffix = ".vtp"

    def __init__(self, names: list[str], at: list[np.ndarray], arrays: dict[str, list[np.ndarray]]) -> None:
        self.names = names
        self.points = np.stack(at, axis=1)
        self.arrays = {name: np.stack(values, axis=1) for name, values in arrays.items()}

    def at(self, frame: int) -> vtkDataObject:
        data = vtkPolyData()
        data.SetPoints(points(self.points[frame]))
        data.SetVerts(cells([1] * len(self.names), np.arange(len(self.names))))
        add_array(data.GetPointData(), "name", self.names)
        for name, values in self.arrays.items():
            add_array(data.GetPointData(), name, values[frame])
        return data


def _contacts(result: Result, run: Run) -> _Vertices | None:
    scene, names = result.scene, result.names
    if not scene["contacts"]:
        return None
    forces = {(force.get("contact"), force["kind"]): force for force in scene["forces"]}
    contacts = [entry["name"] for entry in scene["contacts"]]
    arrays: dict[str, list[np.ndarray]] = {
        "contact_state": [resolve(entry["state"], run, names).astype(np.uint8) for entry in scene["contacts"]],
        "gap_m": [resolve(entry["gap_m"], run, names) for entry in scene["contacts"]],
    }
    for kind in ("normal", "tangential"):
        arrays[f"{kind}_force_N"] = [resolve_point(forces[name, kind]["vector_N"], run, names) for name in contacts]
    return _Vertices(contacts, [resolve_point(forces[name, "normal"]["at"], run, names) for name in contacts], arrays)


def _forces(result: Result, run: Run) -> _Vertices | None:
    contacts = {entry["name"] for entry in result.scene["contacts"]}
    further = [force for force in result.scene["forces"] if force.get("contact") not in contacts]
    if not further:
        return None
    return _Vertices(
        [force["name"] for force in further], [resolve_point(force["at"], run, result.names) for force in further],
        {"force_N": [resolve_point(force["vector_N"], run, result.names) for force in further]},
    )


def sorts(result: Result, model: str) -> dict[str, Any]:
    """Return the drawings of a model: for the name of each series, the object that makes its frames."""
    run = result.models[model]
    found = {
        "links": _Lines(result, run, model), "parts": _Parts(result, run, model),
        "contacts": _contacts(result, run), "forces": _forces(result, run),
    }
    return {name: source for name, source in found.items() if source is not None}


def write_all(
    result: Result, folder: Path, wanted_frames: int, progress: Callable[[float], None] = lambda fraction: None
) -> list[Path]:
    """Write the VTK files of all models, and return the paths of their series.

    :param wanted_frames: number of samples to write, see :func:`.vtk_data.frames_of`
    """
    written: list[Path] = []
    for place, (model, run) in enumerate(result.models.items()):
        sources = sorts(result, model)
        frames = frames_of(len(run.time_s), wanted_frames)
        digits = len(str(len(frames) - 1))
        entries: dict[str, list[tuple[str, float]]] = {name: [] for name in sources}
        for number, frame in enumerate(frames):
            time_s = file_time(run.time_s[frame])
            for name, source in sources.items():
                path = folder / f"{model}_{name}.{number:0{digits}d}{source.suffix}"
                write(source.at(int(frame)), path, time_s)
                entries[name].append((path.name, time_s))
            progress((place + (number + 1) / len(frames)) / len(result.models))
        for name, source in sources.items():
            path = folder / f"{model}_{name}{source.suffix}.series"
            write_series(path, entries[name])
            written.append(path)
    return written
