# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of rest sets: JSON with all numbers, and a ParaView file for positions in space."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from statejump.core import figures
from statejump.core.errors import StatejumpError
from statejump.core.tables import write_json
from statejump.kinds.statics import figure
from statejump.kinds.statics.solve import Statics, cone_angles, solve


def write(statics: Statics, folder: Path) -> list[Path]:
    """Write all files of rest sets and return their paths."""
    case, own = statics.case, statics.friction_coefficient
    written = [write_statics_json(statics, folder)]
    if not case.is_planar:
        written += figures.save(figure.spatial(statics), folder, case.name)
        return [*written, write_vtp(statics, folder)]
    wanted = sorted({*case.picture.friction_coefficients, own})
    panels = [statics if mu == own else solve(case, mu) for mu in wanted]
    return written + figures.save(figure.planar(panels), folder, case.name)


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


def write_statics_json(statics: Statics, folder: Path) -> Path:
    """Write ``statics.json``: every number of the table, and the positions."""
    case = statics.case
    document = {
        "case": case.name,
        "title": case.title,
        "joint": {key: value for key, value in case.joint.to_dict().items() if value is not None},
        "forces": [{"name": load.name, "force_N": list(load.force_N)} for load in statics.loads],
        "each": [_plain(found) for found in statics.each],
        "any": _plain(statics.any),
        "all": _plain(statics.all),
    }
    return write_json(folder / "statics.json", document, indent=1)


def write_vtp(statics: Statics, folder: Path) -> Path:
    """Write ``<case>.vtp`` for ParaView: the surface of positions, cut along the rest sets.

    Arrays of cells are ``stable`` (1 if at least one force allows rest) and ``forces`` (number of such forces). That of
    points is ``cone_angle_rad``, the smallest angle between -F and normal N over all forces F.
    """
    target = folder / f"{statics.case.name}.vtp"
    try:
        from vtkmodules.vtkCommonDataModel import vtkPolyData  # VTK, 0.2 s, which may be missing

        from statejump.results.vtk_data import add_array, cells, points, write  # VTK as well
    except ImportError as failure:
        raise StatejumpError(code="vtk_missing", file=target, cause=str(failure)) from None
    polygons, count = statics.pieces["polygons_m"], np.array(statics.pieces["polygon_forces"], dtype=np.int32)
    corners = np.concatenate(polygons)
    data = vtkPolyData()
    data.SetPoints(points(corners))
    data.SetPolys(cells([len(polygon) for polygon in polygons], np.arange(len(corners))))
    add_array(data.GetPointData(), "cone_angle_rad", cone_angles(statics))
    add_array(data.GetCellData(), "stable", (count > 0).astype(np.int32))
    add_array(data.GetCellData(), "forces", count)
    write(data, target)
    return target
