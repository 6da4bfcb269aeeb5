# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene of a result file for the replay on the page: moving points, parts on these points, forces.

The position of a part that rests on or in another part is stored *relative* to that part, as a difference of columns in
full precision. Absolute positions in single precision are too coarse, because the replay magnifies a clearance of 0.1
mm beside a link of 100 mm.
"""
from __future__ import annotations

import json
import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from statejump.core.errors import Unreadable
from statejump.core.run import Run
from statejump.report.labels import STATES, Labels
from statejump.results.contents import Result
from statejump.results.outline import growth
from statejump.results.scene import resolve, resolve_point

# Size of the smallest clearance at the default magnification, as a fraction of the scene; also limited to a fraction of
# the shortest link, so that both can be distinguished.
SHOWN_GAP = 0.03
SHOWN_GAP_OF_LINK = 0.15
# Largest displacement of a point at the default magnification, as a fraction of the scene. Expansion is much larger
# than a clearance.
SHOWN_WAY = 0.1
AXES = "xyz"


def round_down(value: float) -> float:
    """Return the largest of 1, 2, 5, 10, 20, ... that does not exceed the value, at least 1. Infinity stays
    infinity."""
    if not value > 1:
        return 1.0
    if math.isinf(value):
        return value
    power = 10.0 ** math.floor(math.log10(value))
    return power * max(step for step in (1, 2, 5) if step * power <= value * (1 + 1e-9))


class Drawing:
    """Collects points, parts and forces, and the columns that move them, for every model of a result.

    ``scene`` is plain JSON data in which names of columns replace the numbers that change. ``columns`` contains these
    columns by model and name.
    """

    def __init__(self, result: Result, labels: Labels) -> None:
        self.result, self._labels = result, labels
        self.columns: dict[str, dict[str, np.ndarray]] = {model: {} for model in result.models}
        self._points: dict[str, int] = {}
        self._parts = {part["name"]: part for part in result.scene["parts"]}
        self._expressions: list[Any] = []
        self._arms: dict[str, list[str]] = {}
        for part in result.scene["parts"]:
            for expression in _points_of(part):
                key = json.dumps(expression, sort_keys=True)
                if key not in self._points:
                    self._points[key] = len(self._points)
                    self._expressions.append(expression)
        pairs = self._pairs()
        self.scene: dict[str, Any] = {
            "points": [self._point(place, pairs.get(place)) for place in range(len(self._expressions))],
            "parts": [self._part(part) for part in result.scene["parts"]],
            "contacts": [self._contact(place, contact) for place, contact in enumerate(result.scene["contacts"])],
            "forces": self._forces(),
            "states": [
                {"label": STATES.get(state, state), "colour": colour}
                for state, colour in result.scene["states"].items()
            ],
        }
        with np.errstate(over="ignore", invalid="ignore"):  # numbers that are too large are refused
            self._measure()

    def _column(self, name: str, values: Callable[[Run], np.ndarray]) -> str:
        for model, run in self.result.models.items():
            self.columns[model][name] = values(run)
        return name

    def _vector(self, name: str, values: Callable[[Run], np.ndarray]) -> list[str]:
        for model, run in self.result.models.items():
            found = values(run)
            self.columns[model].update({f"{name}_{axis}": found[:, place] for place, axis in enumerate(AXES)})
        return [f"{name}_{axis}" for axis in AXES]

    def _at(self, expression: Any, run: Run) -> np.ndarray:
        return resolve_point(expression, run, self.result.names)

    def _place(self, part: dict[str, Any]) -> int:
        return self._points[json.dumps(part["centre"], sort_keys=True)]

    def _pairs(self) -> dict[int, int]:
        """Return a dict: for the point of each part that rests on another part, the point of that other part."""
        pairs: dict[int, int] = {}
        for contact in self.result.scene["contacts"]:
            on, other = (self._parts[contact[key]] for key in ("on", "from"))
            if "centre" not in on or "centre" not in other:
                continue
            place, base = self._place(on), self._place(other)
            step = base
            while step in pairs and step != place:  # a ring of parts has no beginning
                step = pairs[step]
            if step != place:
                pairs.setdefault(place, base)
        return pairs

    def _point(self, place: int, base: int | None) -> dict[str, Any]:
        expression = self._expressions[place]
        if base is None and isinstance(expression, list) and not any(isinstance(value, dict) for value in expression):
            return {"at": [float(value) for value in expression]}

        def values(run: Run) -> np.ndarray:
            at = self._at(expression, run)
            return at if base is None else at - self._at(self._expressions[base], run)

        at = self._vector(f"point{place}", values)
        return {"at": at} if base is None else {"at": at, "of": base}

    def _angle(self, part: dict[str, Any]) -> Any:
        angle = part.get("angle_rad", 0.0)
        if not isinstance(angle, dict):
            return float(angle)
        return self._column(f"angle_{part['name']}", lambda run: resolve(angle, run, self.result.names))

    def _partner(self, part: dict[str, Any], kind: str) -> dict[str, Any] | None:
        for contact in self.result.scene["contacts"]:
            if contact["from"] == part["name"] and self._parts[contact["on"]]["type"] == kind:
                return self._parts[contact["on"]]
        return None

    def _size(self, name: str, part: dict[str, Any], key: str, other: dict[str, Any], other_key: str) -> Any:
        """Return a dimension of one part minus one of another: a number, or a column if they expand."""
        if not part.get("thermal_expansion_per_K") and not other.get("thermal_expansion_per_K"):
            return part[key] - other[other_key]
        for model in self.result.models:
            self.columns[model][name] = (
                part[key] * growth(part, self.result, model) - other[other_key] * growth(other, self.result, model)
            )
        return name

    def _part(self, part: dict[str, Any]) -> dict[str, Any]:
        drawn: dict[str, Any] = {"name": part["name"], "label": self._labels.named(part["name"]), "type": part["type"]}
        drawn["points"] = [self._points[json.dumps(point, sort_keys=True)] for point in _points_of(part)]
        for key in ("width_m", "radius_m", "half_width_m", "half_height_m", "axis"):
            if key in part:
                drawn[key] = part[key]
        if "angle_rad" in part:
            drawn["angle"] = self._angle(part)
        if part["type"] == "bearing":
            journal = self._partner(part, "journal")
            if journal is not None:
                drawn["inner_m"] = journal["radius_m"]
                drawn["clearance"] = self._size(
                    f"clearance_{part['name']}", part, "radius_m", journal, "radius_m"
                )
        if part["type"] == "slot":
            block = self._partner(part, "block")
            for side in ("minus", "plus"):
                key = f"stop_{side}_m"
                drawn[f"inner_{side}_m"] = block["half_width_m"] if block else part[key]
                drawn[f"clearance_{side}"] = (
                    self._size(f"clearance_{side}_{part['name']}", part, key, block, "half_width_m") if block else 0.0
                )
        if part["type"] == "mesh" and part["mesh"] in self.result.meshes:
            mesh = self.result.meshes[part["mesh"]]
            drawn["vertices"] = np.asarray(mesh.vertices_m, dtype=float).ravel()
            drawn["triangles"] = np.asarray(mesh.triangles, dtype=float).ravel()
        return drawn

    def _contact(self, place: int, contact: dict[str, Any]) -> dict[str, Any]:
        names = self.result.names
        return {
            "name": contact["name"],
            "label": self._labels.named(contact["name"]),
            "on": list(self._parts).index(contact["on"]),
            "from": list(self._parts).index(contact["from"]),
            "state": self._column(
                f"state{place}", lambda run: resolve(contact["state"], run, names).astype(np.uint8)
            ),
            "gap": self._column(f"gap{place}", lambda run: resolve(contact["gap_m"], run, names)),
        }

    def _force(
        self, place: int, label: str, kind: str, on: str, at: Any, vector: Callable[[Run], np.ndarray]
    ) -> dict[str, Any]:
        part = self._parts[on]
        centre = part.get("centre")
        drawn = {
            "label": label,
            "kind": kind,
            "point": self._points[json.dumps(at if centre is None else centre, sort_keys=True)],
            "arm": [0.0, 0.0, 0.0] if centre is None else self._arm(at, centre),
            "vector": self._vector(f"force{place}", vector),
        }
        return {**drawn, "axis": part["axis"]} if "axis" in part else drawn

    def _arm(self, at: Any, centre: Any) -> list[str]:
        """Return the columns of the vector from the centre of a part to the point where a force acts. Normal and
        tangential force share these columns."""
        key = json.dumps([at, centre], sort_keys=True)
        if key not in self._arms:
            self._arms[key] = self._vector(
                f"arm{len(self._arms)}", lambda run: self._at(at, run) - self._at(centre, run)
            )
        return self._arms[key]

    def _vector_N(self, force: dict[str, Any], run: Run) -> np.ndarray:
        return resolve_point(force["vector_N"], run, self.result.names)

    def _forces(self) -> list[dict[str, Any]]:
        drawn = [
            self._force(
                place, f"{force['kind'].capitalize()} force on {self._labels.named(force['on'], True)}", force["kind"],
                force["on"], force["at"], partial(self._vector_N, force),
            )
            for place, force in enumerate(self.result.scene["forces"])
        ]
        for part in self.result.scene["parts"]:
            axial = part.get("values", {}).get("axial_force_N")
            if part["type"] == "link" and axial is not None:
                drawn.append(self._axial(len(drawn), part, axial))
        return [force for force in drawn if self._largest(force) > 0]

    def _axial(self, place: int, link: dict[str, Any], axial: Any) -> dict[str, Any]:
        """Return the force of a link on the item at its second end, along the drawn link. Compression points
        outward."""
        first, second = (self._points[json.dumps(end, sort_keys=True)] for end in link["ends"])
        return {
            "label": f"Axial force of {self._labels.named(link['name'])}", "kind": "axial", "point": second,
            "arm": [0.0, 0.0, 0.0], "from": first,
            "vector": [self._column(f"force{place}", lambda run: resolve(axial, run, self.result.names))],
        }

    def _largest(self, force: dict[str, Any]) -> float:
        with np.errstate(over="ignore"):
            return max(
                float(np.nanmax(np.sqrt(sum(columns[name] ** 2 for name in force["vector"])), initial=0.0))
                for columns in self.columns.values()
            )

    def _measure(self) -> None:
        """Compute the size of the scene at the start, the largest force, and the default magnification of the
        replay."""
        run = next(iter(self.result.models.values()))
        corners = []
        for part in self.result.scene["parts"]:
            reach = max(
                part.get(key, 0.0)
                for key in ("radius_m", "half_width_m", "half_height_m", "stop_plus_m", "stop_minus_m")
            )
            for expression in _points_of(part):
                at = self._at(expression, run)[0]
                corners += [at - [reach, reach, 0], at + [reach, reach, 0]]
        low, high = np.min(corners, axis=0), np.max(corners, axis=0)
        clearance = float(self.result.scene["smallest_clearance_m"])
        size = float(np.max(high - low))
        lengths = [
            float(np.linalg.norm(np.subtract(*(self._at(end, run)[0] for end in part["ends"]))))
            for part in self.result.scene["parts"] if part["type"] == "link"
        ]
        shortest = min((length for length in lengths if length > 0), default=size)
        shown = min(SHOWN_GAP * size, SHOWN_GAP_OF_LINK * shortest)
        way = self._largest_way()
        deformation = round_down(SHOWN_WAY * size / way) if way > 0 else 1.0
        magnification = round_down(shown / clearance) if clearance > 0 else deformation
        self.scene.update(
            low=low.tolist(),
            high=high.tolist(),
            largest_force_N=max((self._largest(force) for force in self.scene["forces"]), default=0.0),
            clearance_m=clearance,
            shortest_link_m=shortest,
            magnification=magnification,
            magnification_of_deformation=min(magnification, deformation) if way > 0 else magnification,
            # If only relative positions change, there is no deformation to magnify.
            deforms=way > 0,
        )
        if not np.isfinite([size, way, self.scene["largest_force_N"], magnification]).all():
            raise Unreadable(code="drawing_not_finite", case=self.result.name)

    def _largest_way(self) -> float:
        """Return the largest distance [m] of any point from its start. Points relative to other points are omitted."""
        return max(
            (
                float(np.max(np.sqrt(sum(
                    (columns[name] - columns[name][0]) ** 2 for name in point["at"] if isinstance(name, str)
                ))))
                for point in self.scene["points"] if "of" not in point and isinstance(point["at"][0], str)
                for columns in self.columns.values()
            ),
            default=0.0,
        )


def _points_of(part: dict[str, Any]) -> list[Any]:
    if "centre" in part:
        return [part["centre"]]
    return list(part.get("ends") or part.get("points") or [])
