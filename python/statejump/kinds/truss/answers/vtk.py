# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK files of a truss' path: lines of links and springs and points of joints, a series with true times."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import VTK_LINE, VTK_VERTEX, vtkUnstructuredGrid

from statejump.core.progress import Tell
from statejump.results.vtk_data import add_array, cells, file_time, frames_of, points, write, write_series
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, engine_program

LINK, SPRING, SLIDER, REVOLUTE = range(4)  # "kind" of a cell


def link_temperatures(truss: ResolvedTruss, times_s: np.ndarray) -> np.ndarray:
    """Return ΔT [K] (times, links) of every link."""
    common = np.stack([engine_program(program).temperature_change(times_s) for program in truss.programs], axis=1)
    return common[:, truss.links.shown_program] * truss.links.shown_fraction


def series(found: TrussPath, folder: Path, name: str, wanted_frames: int = 50,
           tell: Tell = lambda share: None) -> Path:
    """Write ``<name>.N.vtu`` and ``<name>.vtu.series`` and return the latter.

    Points are the drawn nodes; ``displacement_m`` moves them (Warp By Vector). Cells: links, springs,
    joints as points at their first or bearing node; arrays that a cell lacks are NaN, its status is 255.

    :param wanted_frames: how many states of the path, evenly spread; 0: all
    """
    truss, states = found.truss, found.states
    frames = frames_of(len(states["time_s"]), wanted_frames)
    temperatures = link_temperatures(truss, states["time_s"])
    links, springs = len(truss.links.names), len(truss.springs.names)
    sliders, revolutes = len(truss.sliders.names), len(truss.revolutes.names)
    lines = np.concatenate((truss.links.nodes, truss.springs.nodes)).ravel()
    places = np.concatenate((truss.sliders.nodes[:, 0], truss.revolutes.bearing_node))
    drawn = cells([2] * (links + springs) + [1] * (sliders + revolutes), np.concatenate((lines, places)))
    kinds = np.repeat([LINK, SPRING, SLIDER, REVOLUTE], [links, springs, sliders, revolutes]).astype(np.int32)
    names = [*truss.links.names, *truss.springs.names, *truss.sliders.names, *truss.revolutes.names]
    types = np.where(kinds < SLIDER, VTK_LINE, VTK_VERTEX).astype(np.uint8)

    def column(*parts: Any) -> np.ndarray:
        sizes = (links, springs, sliders, revolutes)
        return np.concatenate([np.full(size, np.nan) if part is None else np.asarray(part, float)
                               for part, size in zip(parts, sizes)])

    entries = []
    for number, frame in enumerate(frames):
        data = vtkUnstructuredGrid()
        data.SetPoints(points(truss.nodes.position_m))
        data.SetCells(numpy_to_vtk(types, deep=True), drawn)
        add_array(data.GetPointData(), "name", list(truss.nodes.names))
        add_array(data.GetPointData(), "displacement_m", states["displacement_m"][frame])
        add_array(data.GetPointData(), "since_start_m", states["displacement_m"][frame] - states["displacement_m"][0])
        at = {key: values[frame] for key, values in states.items()}
        eccentricity = np.linalg.norm(at["eccentricity_m"], axis=1)
        for name_of, values in {
            "axial_force_N": column(at["axial_force_N"], -at["tension_N"], None, None),
            "temperature_change_K": column(temperatures[frame], None, None, None),
            "slide_m": column(None, None, at["slide_m"], None),
            "eccentricity_m": column(None, None, None, eccentricity),
            "normal_force_N": column(None, None, None, at["normal_force_N"]),
            "friction_force_N": column(None, None, at["slider_force_N"], at["friction_force_N"]),
            "dissipation_J": column(None, None, at["slider_dissipation_J"], at["revolute_dissipation_J"]),
        }.items():
            add_array(data.GetCellData(), name_of, values)
        status = np.concatenate((np.full(links + springs, 255), at["slider_status"], at["revolute_status"]))
        add_array(data.GetCellData(), "status", status.astype(np.uint8))
        add_array(data.GetCellData(), "kind", kinds)
        add_array(data.GetCellData(), "name", names)
        path = folder / f"{name}.{number:0{len(str(len(frames) - 1))}d}.vtu"
        time_s = file_time(at["time_s"])
        write(data, path, time_s)
        entries.append((path.name, time_s))
        tell((number + 1) / len(frames))
    index = folder / f"{name}.vtu.series"
    write_series(index, entries)
    return index
