# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of kind ``statics``: where a loaded clearance joint can rest, the paper's section 2.

Forces that depend on temperature, F0 + rate dT, are taken at the listed temperatures. Friction cones
are convex, so what holds at the first and the last temperature holds between them: the intersection
is exact with the two ends of the range. The union is that of the listed temperatures only.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import hypot, isfinite
from typing import Any, ClassVar, Optional

from pydantic import Field, validator
from pydantic.fields import ModelField

from statejump.schema.fields import CHOICE, Case, Section, Thermal, choice, parameter, suggestion
from statejump.schema.items import numbers

PAPER = "Chen et al. (2021), section 2"
TYPES = ("slot", "journal", "ball", "cylinder", "lobed", "mesh")
LARGEST_FORCE_N = 1e12
MOST_FORCES = 256
# key of [joint]: the types that need it
KEYS_OF_TYPES = {
    "clearance_m": ("slot", "journal", "ball", "cylinder", "lobed"),
    "axial_play_m": ("cylinder",),
    "lobes": ("lobed",),
    "lobe_amplitude_m": ("lobed",),
    "mesh_file": ("mesh",),
    "mesh_unit_m": ("mesh",),
}
LARGEST_TEMPERATURE_CHANGE_K = 1e4


# What a [[force]] may hold; _load_cases() judges it.
class Force(Section):
    """One force on the component, or one for each of several temperatures."""

    name: Optional[str] = Field(None, description="F1, F2, ...")
    force_N: list[float] = numbers(..., "N", -LARGEST_FORCE_N, LARGEST_FORCE_N, PAPER + ": x, y, z", length=3)
    force_rate_N_per_K: Optional[list[float]] = numbers(
        None, "N/K", -LARGEST_FORCE_N, LARGEST_FORCE_N, "with temperature_change_K", length=3
    )
    temperature_change_K: Optional[list[float]] = numbers(
        None, "K", -LARGEST_TEMPERATURE_CHANGE_K, LARGEST_TEMPERATURE_CHANGE_K, "with force_rate_N_per_K"
    )


class StaticsJoint(Section):
    """The joint: what its clearance leaves free, and friction."""

    GOES_WITH = {"type": KEYS_OF_TYPES}

    type: str = choice(..., TYPES, PAPER + ": one, two or three dimensions")
    friction_coefficient: float = parameter(..., "-", 0, 100, PAPER)
    clearance_m: Optional[float] = parameter(None, "m", 0, 1e2, PAPER + ": c", above=True)
    axial_play_m: Optional[float] = parameter(None, "m", 0, 1e2, "cylinder: middle to shoulder", above=True)
    lobes: Optional[int] = parameter(None, "-", 1, 45, "lobed")
    lobe_amplitude_m: Optional[float] = parameter(None, "m", 0, 1e2, "lobed: of the centre's curve")
    mesh_file: Optional[str] = Field(None, description="STL, OBJ, PLY or VTP; from the case file's folder")
    mesh_unit_m: Optional[float] = parameter(None, "m", 0, 1e3, "length of one unit of the mesh file", above=True)
    mesh_free_side: str = choice("right_hand", ("right_hand", "left_hand"), "side of the triangles' vertex order")


class Picture(Section):
    """What is drawn besides the case's own friction coefficient."""

    friction_coefficients: list[float] = Field(
        [], unit="-", low=0, high=100, above=False, listed=True, description="one panel each, two dimensions"
    )


@dataclass(frozen=True)
class LoadCase:
    """One force on the component."""

    name: str
    force_N: tuple[float, float, float]


def _vector(value: Any) -> Optional[tuple[float, float, float]]:
    if not isinstance(value, list) or len(value) != 3:
        return None
    if any(isinstance(item, bool) or not isinstance(item, (int, float)) or not isfinite(item) for item in value):
        return None
    if max(abs(item) for item in value) > LARGEST_FORCE_N:
        return None
    return (float(value[0]), float(value[1]), float(value[2]))


def _temperatures(value: Any) -> Optional[list[float]]:
    if not isinstance(value, list) or not value:
        return None
    largest = LARGEST_TEMPERATURE_CHANGE_K
    if any(isinstance(item, bool) or not isinstance(item, (int, float)) or not abs(item) <= largest for item in value):
        return None
    return [float(item) for item in value]


def _load_cases(tables: Any) -> list[LoadCase] | str:
    """Return the forces of [[force]], or what is wrong with it."""
    if isinstance(tables, dict):
        tables = [tables]
    if not isinstance(tables, list) or not tables or not all(isinstance(table, dict) for table in tables):
        return f"force = {tables!r} is not allowed: must be one or more sections [[force]] with force_N = [x, y, z]"
    found: list[LoadCase] = []
    rule = f"must be a list of three numbers [N], none beyond {LARGEST_FORCE_N:g}"
    for number, table in enumerate(tables, start=1):
        where = f"force {number}"
        for key in table:
            if key not in Force.__fields__:
                return f"{where}: {key} is unknown: {suggestion(key, list(Force.__fields__), '', '')}"
        name = table.get("name", f"F{number}")
        if not isinstance(name, str) or not name:
            return f"{where}: name = {name!r} is not allowed: must be a text in quotes"
        if "force_N" not in table:
            return f"{where}: force_N is missing: {rule}"
        force = _vector(table["force_N"])
        if force is None:
            return f"{where}: force_N = {table['force_N']!r} is not allowed: {rule}"
        if "force_rate_N_per_K" not in table and "temperature_change_K" not in table:
            found.append(LoadCase(name, force))
            continue
        rate = _vector(table.get("force_rate_N_per_K"))
        if rate is None:
            return (
                f"{where}: force_rate_N_per_K = {table.get('force_rate_N_per_K')!r} is not allowed: must be a list of "
                "three numbers [N/K] together with temperature_change_K"
            )
        changes = _temperatures(table.get("temperature_change_K"))
        if changes is None:
            return (
                f"{where}: temperature_change_K = {table.get('temperature_change_K')!r} is not allowed: must be a "
                "list of numbers between -10000 and 10000 [K] together with force_rate_N_per_K"
            )
        for change in changes:
            x, y, z = (a + b * change for a, b in zip(force, rate))
            found.append(LoadCase(f"{name}, ΔT = {change:g} K", (x, y, z)))
    if len(found) > MOST_FORCES:
        return f"force stands for {len(found)} forces: must be at most {MOST_FORCES}"
    return found


class StaticsCase(Case):
    """Where a loaded joint can rest: its position under given forces, friction included."""

    KIND: ClassVar[str] = "statics"

    joint: StaticsJoint
    NOT_IN_FILE: ClassVar[tuple[str, ...]] = ("thermal",)

    force: Any = Field(..., tables=Force, description="sections [[force]]")
    picture: Picture = Field(default_factory=Picture)
    # The common part of all kinds; forces carry their temperatures themselves.
    thermal: Thermal = Field(default_factory=lambda: Thermal(shape="triangle", temperature_change_max_K=0.0))

    @validator("*", pre=True)
    def _strict(cls, value: Any, field: ModelField) -> Any:
        # The schema knows tables of keys only; [[force]] is judged by problem().
        return value if field.name == "force" else Section._strict(value, field)

    @property
    def load_cases(self) -> list[LoadCase]:
        """Every force, one per temperature where it depends on it."""
        found = _load_cases(self.force)
        assert not isinstance(found, str)
        return found

    @property
    def is_planar(self) -> bool:
        """Whether positions are on a plane curve."""
        return self.joint.type in ("slot", "journal", "lobed")

    def problem(self) -> str | None:
        """Return what is wrong between several keys, without the file's name."""
        if "thermal" in self.__fields_set__:
            return "section [thermal] is not allowed: a force takes temperature_change_K and force_rate_N_per_K"
        return self._joint_problem() or self._force_problem()

    def _joint_problem(self) -> str | None:
        joint = self.joint
        for key, types in KEYS_OF_TYPES.items():
            value = getattr(joint, key)
            if value is None and joint.type in types:
                return f"joint.{key} is missing: joint.type = {joint.type!r} needs it"
            if value is not None and joint.type not in types:
                return (
                    f"joint.{key} = {value!r} is not allowed: only with joint.type = "
                    + " or ".join(repr(name) for name in types)
                )
        if joint.type == "lobed" and not joint.lobe_amplitude_m < joint.clearance_m:
            return (
                f"joint.lobe_amplitude_m = {joint.lobe_amplitude_m!r} is not allowed: must be at least 0 and below "
                f"joint.clearance_m = {joint.clearance_m!r} [m]"
            )
        if self.picture.friction_coefficients and not self.is_planar:
            return "picture.friction_coefficients is not allowed: only for joints in one or two dimensions"
        return None

    def _force_problem(self) -> str | None:
        found = _load_cases(self.force)
        if isinstance(found, str):
            return found
        for load in found:
            x, y, z = load.force_N
            if hypot(x, y, z) == 0:
                return f"force {load.name!r} = [0, 0, 0] is not allowed: without a force every position is at rest"
            if self.joint.type in ("journal", "lobed") and z != 0:
                return (
                    f"force {load.name!r} = {list(load.force_N)} is not allowed: joint.type = {self.joint.type!r} is "
                    "planar, the third number must be 0; 'cylinder' takes axial forces"
                )
        return None
