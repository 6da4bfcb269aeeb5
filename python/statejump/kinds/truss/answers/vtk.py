# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK files of a truss path: lines for links and elements, points for joints, and a series with true times."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import VTK_LINE, VTK_VERTEX, vtkUnstructuredGrid

from statejump.core.progress import OnProgress
from statejump.results.vtk_data import add_array, cells, file_time, frames_of, points, write, write_series
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.elements.protocol import BetweenNodes
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, engine_programs

# "kind" of a cell: 0 for links, then element types in the order of ELEMENTS, then joint types in the order of JOINTS.
LINK = 0
BETWEEN_NODES = [element for element in ELEMENTS if isinstance(element, BetweenNodes)]
FIRST_JOINT = 1 + len(BETWEEN_NODES)
# Columns of several types that share one name in the files.
SHARED = {"slider_force_N": "friction_force_N"}


def link_temperatures(truss: ResolvedTruss, times_s: np.ndarray) -> np.ndarray:
    """Return ΔT [K] (times, links) of every link."""
    common = np.stack([program.temperature_change(times_s) for program in engine_programs(truss)], axis=1)
    return common[:, truss.links.shown_program] * truss.links.shown_fraction


def series(found: TrussPath, folder: Path, name: str, wanted_frames: int = 50,
           on_progress: OnProgress = lambda share: None) -> Path:
    """Write ``<name>.N.vtu`` for some states and the series ``<name>.vtu.series``; return the path of the series.

    Points are the nodes in the reference configuration; ``displacement_m`` moves them (Warp By Vector). Cells are
    links, elements between nodes, and joints as points at their first or bearing node. Cells without value have NaN,
    those without status 255.

    :param wanted_frames: number of states to write, evenly spread over the path; 0: all states
    """
    truss, states = found.truss, found.states
    frames = frames_of(len(states["time_s"]), wanted_frames)
    temperatures = link_temperatures(truss, states["time_s"])
    elements = [truss.elements[element.section] for element in BETWEEN_NODES]
    sizes = [len(truss.links.names), *(len(part.names) for part in elements),
             *(len(truss.joints[joint.section].names) for joint in JOINTS)]
    lines = np.concatenate([truss.links.nodes, *(part.nodes for part in elements)])
    places = [joint.place_nodes(truss, truss.joints[joint.section]) for joint in JOINTS]
    drawn = cells([2] * len(lines) + [1] * sum(sizes[FIRST_JOINT:]), np.concatenate((lines.ravel(), *places)))
    kinds = np.repeat(np.arange(FIRST_JOINT + len(JOINTS)), sizes).astype(np.int32)
    names = [*truss.links.names, *(own for part in elements for own in part.names),
             *(own for joint in JOINTS for own in truss.joints[joint.section].names)]
    types = np.where(kinds < FIRST_JOINT, VTK_LINE, VTK_VERTEX).astype(np.uint8)

    def column(parts: dict[int, Any]) -> np.ndarray:
        return np.concatenate([np.asarray(parts[kind], float) if kind in parts else np.full(size, np.nan)
                               for kind, size in enumerate(sizes)])

    entries = []
    for number, frame in enumerate(frames):
        data = vtkUnstructuredGrid()
        data.SetPoints(points(truss.nodes.position_m))
        data.SetCells(numpy_to_vtk(types, deep=True), drawn)
        add_array(data.GetPointData(), "name", list(truss.nodes.names))
        add_array(data.GetPointData(), "displacement_m", states["displacement_m"][frame])
        add_array(data.GetPointData(), "since_start_m", states["displacement_m"][frame] - states["displacement_m"][0])
        at = {key: values[frame] for key, values in states.items()}
        arrays: dict[str, dict[int, Any]] = {
            "axial_force_N": {LINK: at["axial_force_N"], **{
                kind: -element.tension_N(own, at)
                for kind, (element, own) in enumerate(zip(BETWEEN_NODES, elements), 1)}},
            "temperature_change_K": {LINK: temperatures[frame]},
        }
        for kind, joint in enumerate(JOINTS, FIRST_JOINT):
            if not sizes[kind] and not joint.has_contacts:
                continue
            for of in joint.columns:
                values = np.linalg.norm(at[of.name], axis=1) if of.vector else at[of.name]
                arrays.setdefault(SHARED.get(of.name, of.name), {})[kind] = values
            arrays.setdefault("dissipation_J", {})[kind] = at[f"{joint.section}_dissipation_J"]
        for name_of, parts in arrays.items():
            add_array(data.GetCellData(), name_of, column(parts))
        status = np.concatenate((np.full(len(lines), 255), *(at[f"{joint.section}_status"] for joint in JOINTS)))
        add_array(data.GetCellData(), "status", status.astype(np.uint8))
        add_array(data.GetCellData(), "kind", kinds)
        add_array(data.GetCellData(), "name", names)
        path = folder / f"{name}.{number:0{len(str(len(frames) - 1))}d}.vtu"
        time_s = file_time(at["time_s"])
        write(data, path, time_s)
        entries.append((path.name, time_s))
        on_progress((number + 1) / len(frames))
    index = folder / f"{name}.vtu.series"
    write_series(index, entries)
    return index
