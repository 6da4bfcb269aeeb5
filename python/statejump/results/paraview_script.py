# SPDX-License-Identifier: GPL-3.0-or-later
"""A Python script for ParaView that opens the files of :mod:`.export_vtk`."""
from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.run import CONTACT_STATES
from statejump.core.tables import write_text
from statejump.results.contents import Result
from statejump.results.export_vtk import sorts
from statejump.results.scene import STATE_COLOURS, resolve_point

NAME = "open_in_paraview.py"
ARROW = 0.2  # length of the arrow of the largest force, as a fraction of the scene's size
TEMPLATE = "open_in_paraview.template"  # a script with @NAMES@ for values


def _size_m(result: Result) -> float:
    """Return the size of the drawing at the start [m]."""
    points = []
    for model, run in result.models.items():
        for part in result.scene["parts"]:
            for key in ("ends", "points"):
                points += [resolve_point(point, run, result.names)[0] for point in part.get(key, ())]
            if "centre" in part:
                points.append(resolve_point(part["centre"], run, result.names)[0])
    return float(np.max(np.ptp(np.array(points), axis=0))) if points else 1.0


def _largest_force_N(result: Result) -> float:
    largest = [
        np.max(np.linalg.norm(resolve_point(force["vector_N"], run, result.names), axis=1), initial=0.0)
        for run in result.models.values() for force in result.scene["forces"]
    ]
    return float(max(largest, default=0.0))


def _range_N(result: Result) -> tuple[float, float]:
    """Return a range of axial forces [N] that is symmetric about 0 and covers all links at all times."""
    largest = [
        np.nanmax(np.abs(run.links["axial_force_N"].values), initial=0.0)
        for run in result.models.values() if "axial_force_N" in run.links
    ]
    reach = float(max(largest, default=0.0)) or 1.0
    return -reach, reach


def script(result: Result) -> str:
    """Return the script."""
    series = {
        model: {name: f"{model}_{name}{source.suffix}.series" for name, source in sorts(result, model).items()}
        for model in result.models
    }
    force = _largest_force_N(result)
    colours = [
        [round(int(text[place : place + 2], 16) / 255, 3) for place in (1, 3, 5)]
        for text in (result.scene["states"].get(state, STATE_COLOURS[state]) for state in CONTACT_STATES)
    ]
    values: dict[str, Any] = {
        "TITLE": " ".join(result.title.split()).replace("\\", "").replace('"', ""),
        "NAME": NAME,
        "MODE": "2D" if result.scene["plane"] == "xy" else "3D",
        "SERIES": json.dumps(series, indent=4),
        "SHOWN": json.dumps("dem" if "dem" in series else next(iter(series), "")),
        "STATES": json.dumps(CONTACT_STATES),
        "COLOURS": json.dumps(colours),
        "SCALE": repr(ARROW * _size_m(result) / force if force > 0 else 1.0),
        "RANGE": repr(_range_N(result)),
    }
    text = Path(__file__).with_name(TEMPLATE).read_text(encoding="utf-8")
    for key, value in values.items():
        text = text.replace(f"@{key}@", value)
    return text


def write_script(result: Result, folder: Path) -> Path:
    """Write the script beside the series."""
    return write_text(folder / NAME, script(result).splitlines())
