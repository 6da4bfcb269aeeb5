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
ARROW = 0.2  # of the scene: length of the arrow of the largest force

TEMPLATE = '''"""Opens @TITLE@ in ParaView: bodies, links by axial force, contacts by state, forces.

    paraview --script=@NAME@
    pvpython @NAME@ picture.png     # a picture of the last instant, no window

In ParaView's window: Tools > Python Shell > Run Script. Written by statejump export.
"""
import os
import sys

import paraview.simple as pv

FOLDER = os.path.dirname(os.path.abspath(__file__)) if "__file__" in globals() else os.getcwd()
SERIES = @SERIES@
SHOWN = @SHOWN@  # the other models are loaded, not shown
STATES = @STATES@
COLOURS = @COLOURS@  # red, green, blue of each state
ARROW_M_PER_N = @SCALE@  # length of a force's arrow
BODY_COLOUR = [0.35, 0.35, 0.35]
ARROW_COLOURS = {"normal_force_N": [0.0, 0.0, 0.0], "tangential_force_N": [0.8, 0.4, 0.0],
                 "force_N": [0.0, 0.45, 0.7]}

pv._DisableFirstRenderCameraReset()
view = pv.GetActiveViewOrCreate("RenderView")
view.Background = [1.0, 1.0, 1.0]
view.UseColorPaletteForBackground = 0
view.InteractionMode = "@MODE@"
if len(sys.argv) > 1:
    view.ViewSize = [1600, 1000]


def load(name):
    """Open a series under its name."""
    source = pv.OpenDataFile(os.path.join(FOLDER, name))
    pv.RenameSource(name.split(".")[0], source)
    return source


def show(source, shown, width=2.0, colour=None):
    """Show a source in lines or points of a width; return its display."""
    display = pv.Show(source, view)
    display.LineWidth = width
    display.PointSize = 3 * width
    if colour is not None:
        display.ColorArrayName = ["POINTS", ""]
        display.DiffuseColor = display.AmbientColor = colour
    if not shown:
        pv.Hide(source, view)
    return display


def arrows(source, array, name, shown):
    """Draw a force of every point of a source as an arrow."""
    glyph = pv.Glyph(Input=source, GlyphType="Arrow")
    glyph.OrientationArray = ["POINTS", array]
    glyph.ScaleArray = ["POINTS", array]
    glyph.VectorScaleMode = "Scale by Magnitude"
    glyph.ScaleFactor = ARROW_M_PER_N
    glyph.GlyphMode = "All Points"
    pv.RenameSource(name, glyph)
    show(glyph, shown, colour=ARROW_COLOURS[array])


def legend(display, table, title, corner):
    """Show the legend of a colour table, dark on the white background."""
    display.SetScalarBarVisibility(view, True)
    bar = pv.GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = title, ""
    bar.TitleColor = bar.LabelColor = [0.0, 0.0, 0.0]
    bar.WindowLocation = corner
    bar.ScalarBarLength = 0.25
    bar.HorizontalTitle = 1


def colour_by_state(display):
    """Colour contacts by what they do."""
    pv.ColorBy(display, ("POINTS", "contact_state"))
    table = pv.GetColorTransferFunction("contact_state")
    table.InterpretValuesAsCategories = 1
    table.Annotations = [text for number, state in enumerate(STATES) for text in (str(number), state)]
    table.IndexedColors = [part for colour in COLOURS for part in colour]
    legend(display, table, "contact", "Upper Right Corner")


for model, names in SERIES.items():
    shown = model == SHOWN
    if "parts" in names:
        show(load(names["parts"]), shown, 2.0, BODY_COLOUR)
    if "links" in names:
        links = load(names["links"])
        display = show(links, shown, 4.0)
        pv.ColorBy(display, ("CELLS", "axial_force_N"))
        if shown:
            # One range for all times: a colour means the same force throughout.
            table = pv.GetColorTransferFunction("axial_force_N")
            table.RescaleTransferFunction(*@RANGE@)
            legend(display, table, "axial force (N), compression +", "Upper Left Corner")
    if "contacts" in names:
        contacts = load(names["contacts"])
        display = show(contacts, shown, 3.0)
        if shown:
            colour_by_state(display)
        for array in ("normal_force_N", "tangential_force_N"):
            arrows(contacts, array, "%s_%s" % (model, array), shown)
    if "forces" in names:
        forces = load(names["forces"])
        show(forces, shown, 3.0)
        arrows(forces, "force_N", "%s_force_N" % model, shown)

scene = pv.GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.GoToLast()
pv.ResetCamera(view)
pv.Render(view)
if len(sys.argv) > 1 and sys.argv[-1].endswith(".png"):
    pv.SaveScreenshot(sys.argv[-1], view)
    print("%d instants from %g to %g s" % (
        len(scene.TimeKeeper.TimestepValues), scene.StartTime, scene.EndTime))
'''


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
    """Return a range of axial forces around 0 that covers all links at all times."""
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
    text = TEMPLATE
    for key, value in values.items():
        text = text.replace(f"@{key}@", value)
    return text


def write_script(result: Result, folder: Path) -> Path:
    """Write the script beside the series."""
    return write_text(folder / NAME, script(result).splitlines())
