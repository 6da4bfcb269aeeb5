# SPDX-License-Identifier: GPL-3.0-or-later
"""Rest sets of a loaded clearance joint."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from statejump import _engine
from statejump.core import libraries
from statejump.core.engine_failures import engine
from statejump.core.later import Later
from statejump.core.tables import Shown, html_table
from statejump.kinds.statics.case import LoadCase, StaticsCase
from statejump.kinds.statics.mesh import can_mesh, read_mesh, vertex_normals
from statejump.schema.fields import rule_of
from statejump.schema.paths import attribute_of

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DRAWN, _WRITTEN = Later("statejump.kinds.statics.figure:drawn"), Later("statejump.kinds.statics.files:write")
SPHERE_LEVEL = 4  # 5120 triangles
FRICTION = "joint.friction_coefficient"
HEADINGS = ("force", "parts", "length [m]", "area [m2]", "angle [rad]", "largest jump [m]")
NOWHERE = "no position holds under every force: the joint moves from one to the other"


@dataclass(frozen=True)
class Statics:
    """Rest sets of a case: one per force, their union (``any``) and their intersection (``all``).

    A set is a dict: its separate ``parts``, ``length_m`` and ``area_m2``; ``diameter_m``, the largest distance of two
    of its positions, which bounds every state jump; and ``farthest_m``, two positions at this distance.

    :param curve: curve of the centre of a journal in a lobed bearing
    :param mesh: surface of the positions in space, for pictures
    :param pieces: the mesh cut into polygons along the sets
    """

    case: StaticsCase
    friction_coefficient: float
    loads: list[LoadCase]
    each: list[dict[str, Any]]
    any: dict[str, Any]
    all: dict[str, Any]
    curve: _engine.RestCurve | None = None
    mesh: _engine.RestMesh | None = None
    pieces: Mapping[str, Any] = field(default_factory=dict)

    def named(self) -> list[tuple[str, dict[str, Any]]]:
        """Return all sets with their names. Union and intersection are included only if there are several forces."""
        sets = [(load.name, found) for load, found in zip(self.loads, self.each)]
        if len(sets) > 1:
            sets += [("union: any force", self.any), ("intersection: every force", self.all)]
        return sets

    def frame(self) -> pandas.DataFrame:
        """Return one row per part of every set, with units in the column names. An empty set has a row without numbers.
        ``set_diameter_m`` is the diameter of the whole set, the largest possible jump."""
        rows = []
        for name, found in self.named():
            whole = {"parts": len(found["parts"]), "set_diameter_m": found["diameter_m"]}
            for number, part in enumerate(found["parts"], start=1):
                x, y, z = (float(value) for value in part["representative_m"])
                rows.append({
                    "set": name, "part": number, "length_m": part["length_m"], "area_m2": part["area_m2"],
                    "angle_rad": part["angle_rad"], "diameter_m": part["diameter_m"], "x_m": x, "y_m": y, "z_m": z,
                    **whole,
                })
            if not found["parts"]:
                rows.append({"set": name, **whole})
        columns = ("set", "part", "length_m", "area_m2", "angle_rad", "diameter_m", "x_m", "y_m", "z_m", "parts",
                   "set_diameter_m")
        return libraries.frame(rows, columns=list(columns))

    def plot(self, axes: Axes | None = None) -> Figure:
        """Draw the rest sets.

        :param axes: axes to draw into, three-dimensional ones for positions in space; None: a new figure
        :return: the figure; matplotlib's backend does not change
        """
        return _DRAWN(self, axes)

    def summary_lines(self) -> list[Shown | str]:
        """Return the tables and lines that a command prints."""
        title = f"{self.case.title}: where it can rest, friction coefficient {self.friction_coefficient:g}"
        return [Shown(title, HEADINGS, self._rows(), left=("force",)), *self._notes()]

    def _rows(self) -> list[tuple[str, ...]]:
        """Return one row of ``HEADINGS`` for every set, and one for each of its parts if it has several."""
        found: list[tuple[str, ...]] = []
        for name, one in self.named():
            parts = one["parts"]
            found.append((name, str(len(parts)), *_measure(one), _angle(parts[0]) if len(parts) == 1 else "-",
                          _number(one["diameter_m"]) if parts else "-"))
            for index, part in enumerate(parts if len(parts) > 1 else (), start=1):
                found.append((f"  part {index}", "", *_measure(part), _angle(part), _number(part["diameter_m"])))
        return found

    def _notes(self) -> list[str]:
        """Return notes on the rest sets that their table does not show."""
        found = []
        if not self.all["parts"] and len(self.loads) > 1:
            found.append(NOWHERE)
        error = max(one["diameter_error_m"] for _, one in self.named())
        if error > 0:
            found.append(f"on a mesh: error of the largest jump about {error:.2g} m")
        return found

    def write(self, folder: Path) -> list[Path]:
        """Write ``statics.json``, the picture and, for positions in space, a ParaView file; return their paths.

        The picture of positions on a curve has a panel for each further friction coefficient of the case.
        """
        return _WRITTEN(self, folder)

    def __repr__(self) -> str:
        return (f"Statics({self.case.name}, friction coefficient {self.friction_coefficient:g}, "
                f"{len(self.loads)} forces, largest jump {self.any['diameter_m']:.6g} m)")

    def _repr_html_(self) -> str:
        said = "".join(f"<p>{escape(note)}</p>" for note in self._notes())
        title = f"{self.case.title}, friction coefficient {self.friction_coefficient:g}"
        return f"<h4>{escape(title)}</h4>{html_table(HEADINGS, self._rows())}{said}"


def _number(value: float) -> str:
    return f"{value:.6g}"


def _measure(value: dict[str, Any]) -> tuple[str, str]:
    """Return length and area as texts; a point has neither."""
    length, area = (_number(value[key]) if value[key] else "-" for key in ("length_m", "area_m2"))
    return length, area


def _angle(part: dict[str, Any]) -> str:
    return "-" if part["angle_rad"] is None else _number(part["angle_rad"])


def solve(case: StaticsCase, friction_coefficient: float | None = None) -> Statics:
    """Return the rest sets of a case.

    :param friction_coefficient: friction coefficient to use instead of that of the case [-]
    :raises NotAllowed: the friction coefficient is invalid
    :raises StatejumpError: the mesh of the case is unusable
    """
    joint, loads = case.joint, case.load_cases
    mu = joint.friction_coefficient
    if friction_coefficient is not None:
        mu = float(friction_coefficient)
        rule_of(attribute_of(StaticsCase, FRICTION)).check(FRICTION, mu)
    forces = [load.force_N for load in loads]
    curve = mesh = None
    with engine("the rest sets cannot be computed", file=case.origin.file, case=case.name):
        if joint.type == "slot":
            assert joint.clearance_m is not None
            found = _engine.rest_in_slot(joint.clearance_m, forces, mu)
        elif joint.type == "journal":
            assert joint.clearance_m is not None
            found = _engine.rest_in_bearing(joint.clearance_m, [force[:2] for force in forces], mu)
        elif joint.type == "lobed":
            assert joint.clearance_m is not None and joint.lobe_amplitude_m is not None and joint.lobes is not None
            curve = _engine.lobed_curve(joint.clearance_m, joint.lobe_amplitude_m / joint.clearance_m, joint.lobes)
            found = _engine.rest_on_curves([curve], [force[:2] for force in forces], mu)
        elif joint.type == "ball":
            assert joint.clearance_m is not None
            found = _engine.rest_in_socket(joint.clearance_m, forces, mu)
            mesh = _engine.clearance_sphere(joint.clearance_m, SPHERE_LEVEL)
        elif joint.type == "cylinder":
            assert joint.clearance_m is not None and joint.axial_play_m is not None
            found = _engine.rest_in_bore(joint.clearance_m, joint.axial_play_m, forces, mu)
            mesh = can_mesh(joint.clearance_m, joint.axial_play_m)
        else:
            mesh = read_mesh(case)
            found = _engine.rest_on_mesh(mesh, forces, mu)
        pieces: dict[str, Any] = {}
        if mesh is not None:
            pieces = found if joint.type == "mesh" else _engine.rest_on_mesh(mesh, forces, mu)
    return Statics(case, mu, loads, found["each"], found["any"], found["all"], curve, mesh, pieces)


def cone_angles(statics: Statics) -> np.ndarray:
    """Return the smallest angle of -F and normal N [rad] over all forces F, for each corner of each polygon."""
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
