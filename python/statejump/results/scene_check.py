# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks a scene in a file against the form that :mod:`.scene` describes, on which viewers rely."""
from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from reprlib import repr
from typing import Any

from statejump.core.run import Run
from statejump.results.contents import Result
from statejump.results.scene import FORCE_KINDS, PART_TYPES
from statejump.schema.rules import is_finite_number

Problems = Iterator[str]


def problems(result: Result) -> list[str]:
    """Return the faults in the scene of a result, one sentence each."""
    return list(_Check(result.models, result.names, [*result.meshes]).scene(result.scene))


@dataclass(frozen=True)
class _Check:
    """Data that a description may refer to."""

    models: Mapping[str, Run]
    names: Mapping[str, list[str]]
    meshes: list[str]

    def scene(self, scene: Any) -> Problems:
        if not isinstance(scene, dict):
            yield "it is not an object"
            return
        if scene.get("plane") not in ("xy", "xyz"):
            yield "plane is neither 'xy' nor 'xyz'"
        yield from self._keys("scene", scene, {"temperature_change_K": self.value, "smallest_clearance_m": self.number})
        states = scene.get("states")
        if not isinstance(states, dict) or not all(isinstance(colour, str) for colour in states.values()):
            yield "states are not colours by name"
        for key in ("parts", "contacts", "forces"):
            items = scene.get(key)
            if not isinstance(items, list) or not all(
                isinstance(item, dict) and isinstance(item.get("name"), str) for item in items
            ):
                yield f"{key} are not a list of objects with names"
                return
        parts = {part["name"]: part for part in scene["parts"]}
        if not parts:
            yield "there are no parts"
        for part in scene["parts"]:
            yield from self._part(part)
        for contact in scene["contacts"]:
            yield from self._bodies(contact, parts, ("on", "from"))
            yield from self._keys(contact["name"], contact, {"state": self.value, "gap_m": self.value})
            for kind in ("normal", "tangential"):
                if not any(force.get("contact") == contact["name"] and force.get("kind") == kind
                           for force in scene["forces"]):
                    yield f"contact {contact['name']} has no {kind} force"
        for force in scene["forces"]:
            if force.get("kind") not in FORCE_KINDS:
                yield f"{force['name']}: {repr(force.get('kind'))} is not a kind of force"
            yield from self._bodies(force, parts, ("on", "from") if "from" in force else ("on",))
            yield from self._keys(force["name"], force, {"at": self.point, "vector_N": self.point})

    def _bodies(self, item: dict[str, Any], parts: Mapping[str, Any], keys: tuple[str, ...]) -> Problems:
        for key in keys:
            if not isinstance(item.get(key), str) or item[key] not in parts:
                yield f"{item['name']}: {repr(item.get(key))} is not a part"

    def _part(self, part: dict[str, Any]) -> Problems:
        needed = PART_TYPES.get(part["type"]) if isinstance(part.get("type"), str) else None
        if needed is None:
            yield f"part {part['name']} has no known type"
            return
        missing = set(needed) - set(part)
        if missing:
            yield f"part {part['name']} of type {part['type']} lacks {', '.join(sorted(missing))}"
            return
        yield from self._keys(f"part {part['name']}", part, {key: self._of(key) for key in needed})
        further = {"temperature_change_K": self.value, "thermal_expansion_per_K": self.number, "axis": self._axis,
                   "values": self._values}
        yield from self._keys(f"part {part['name']}", part, {key: further[key] for key in further if key in part})

    def _of(self, key: str) -> Callable[[Any], Problems]:
        by_key: dict[str, Callable[[Any], Problems]] = {
            "ends": lambda value: self._points(value, 2), "points": self._points, "centre": self.point,
            "angle_rad": self.value, "mesh": self._mesh,
        }
        return by_key.get(key, self.number)

    @staticmethod
    def _keys(where: str, item: dict[str, Any], checks: Mapping[str, Callable[[Any], Problems]]) -> Problems:
        for key, check in checks.items():
            for problem in check(item.get(key)):
                yield f"{where}, {key}: {problem}"

    def number(self, value: Any) -> Problems:
        if not is_finite_number(value):
            yield f"{repr(value)} is not a finite number"

    def value(self, value: Any) -> Problems:
        yield from self._reference(value, 1) if isinstance(value, dict) else self.number(value)

    def point(self, value: Any) -> Problems:
        if isinstance(value, dict):
            yield from self._reference(value, 2)
        elif isinstance(value, list) and len(value) == 3:
            for one in value:
                yield from self.value(one)
        else:
            yield f"{repr(value)} is not a point"

    def _points(self, value: Any, count: int | None = None) -> Problems:
        if not isinstance(value, list) or not value or count not in (None, len(value)):
            yield f"{repr(value)} are not {count or 'any'} points"
            return
        for one in value:
            yield from self.point(one)

    def _axis(self, value: Any) -> Problems:
        if not isinstance(value, list) or len(value) != 3 or not all(map(is_finite_number, value)) or not any(value):
            yield f"{repr(value)} is not a direction"

    def _values(self, value: Any) -> Problems:
        if not isinstance(value, dict):
            yield f"{repr(value)} are not values by name"
            return
        for name, one in value.items():
            for problem in self.value(one):
                yield f"{name}: {problem}"

    def _mesh(self, value: Any) -> Problems:
        if value not in self.meshes:
            yield f"{repr(value)} is not a mesh of the file"

    def _reference(self, value: dict[str, Any], axes: int) -> Problems:
        """Check that every model has the referenced column, with a given number of axes after the item is selected."""
        for model, run in self.models.items():
            try:
                column = run.column(value["data"])
                found = column.values.ndim
                if "item" in value:
                    self.names[column.items].index(value["item"])
                    found -= 1
            except (KeyError, ValueError, TypeError, AttributeError):
                yield f"{model}: {repr(value)} refers to nothing in the file"
                return
            if found != axes:
                yield f"{model}: {repr(value)} is not {'a value' if axes == 1 else 'a vector'}"
        for key in ("scale", "offset"):
            if key in value:
                yield from self.number(value[key])
