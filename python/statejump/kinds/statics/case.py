# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of kind ``statics``: rest positions of a loaded clearance joint (section 2 of the paper).

Forces that depend on temperature, F0 + rate dT, are evaluated at the listed temperatures. Friction cones are convex, so
a position that is at rest at the first and the last temperature is at rest between them. Both ends of the range
therefore suffice for the intersection. The union of rest sets covers only the listed temperatures.
"""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot
from typing import Any, ClassVar

from statejump.core.case import Case
from statejump.core.errors import MissingKey, NotAllowed, StatejumpError, UnknownKey
from statejump.core.thermal import CaseThermal
from statejump.schema.fields import (
    Section, choice, definition, fields_of, numbers, parameter, rule_of, section, tables, text, whole,
)
from statejump.schema.rules import suggestion

PAPER = "Chen et al. (2021), section 2"
TYPES = {
    "slot": "A block in a slot", "journal": "A journal in a round bearing", "ball": "A ball in a socket",
    "cylinder": "A cylinder in a bore with shoulders", "lobed": "A journal in a lobed bearing",
    "mesh": "A component whose positions are the surface of a mesh",
}
LARGEST_FORCE_N = 1e12
LARGEST_TEMPERATURE_CHANGE_K = 1e4
MOST_FORCES = 256
# Types of joint that need a key of [joint].
KEYS_OF_TYPES = {
    "clearance_m": ("slot", "journal", "ball", "cylinder", "lobed"),
    "axial_play_m": ("cylinder",),
    "lobes": ("lobed",),
    "lobe_amplitude_m": ("lobed",),
    "mesh_file": ("mesh",),
    "mesh_unit_m": ("mesh",),
}
# Conditions for a key of a [[force]].
NEEDS: dict[str, dict[str, Any]] = {
    "name": {"code": "not_string"},
    "force_N": {"code": "force_components", "largest_N": LARGEST_FORCE_N},
    "force_rate_N_per_K": {"code": "force_rate"},
    "temperature_change_K": {"code": "force_temperatures", "least_K": -LARGEST_TEMPERATURE_CHANGE_K,
                             "largest_K": LARGEST_TEMPERATURE_CHANGE_K},
}


@definition
class Force(Section):
    """One force on the component, or one for each of several temperatures."""

    name: str | None = text(None, "F1, F2, ...")
    force_N: list[float] = numbers(..., "N", -LARGEST_FORCE_N, LARGEST_FORCE_N, PAPER + ": x, y, z", length=3)
    force_rate_N_per_K: list[float] | None = numbers(
        None, "N/K", -LARGEST_FORCE_N, LARGEST_FORCE_N, "with temperature_change_K", length=3
    )
    temperature_change_K: list[float] | None = numbers(
        None, "K", -LARGEST_TEMPERATURE_CHANGE_K, LARGEST_TEMPERATURE_CHANGE_K, "with force_rate_N_per_K"
    )

    def __attrs_post_init__(self) -> None:
        if self.name == "":
            raise NotAllowed("name", self.name, **NEEDS["name"])
        rate, changes = self.force_rate_N_per_K, self.temperature_change_K
        if rate is None and changes is None:
            return
        for key, value in (("force_rate_N_per_K", rate), ("temperature_change_K", changes)):
            if not value:
                raise NotAllowed(key, value, **NEEDS[key])

    def at_temperatures(self, name: str) -> list[LoadCase]:
        """Return the force, once or once per temperature."""
        x, y, z = self.force_N
        if self.force_rate_N_per_K is None or self.temperature_change_K is None:
            return [LoadCase(name, (x, y, z))]
        a, b, c = self.force_rate_N_per_K
        return [
            LoadCase(f"{name}, ΔT = {change:g} K", (x + a * change, y + b * change, z + c * change))
            for change in self.temperature_change_K
        ]


def read_forces(name: str, value: Any) -> list[Force]:
    """Return the forces of ``[[force]]``. Forces may lack names, so messages number them.

    :raises StatejumpError: the first failure, without the file's name
    """
    given = [value] if isinstance(value, Mapping) else value
    if not isinstance(given, list) or not given or not all(isinstance(table, Mapping) for table in given):
        raise NotAllowed(name, value, code="force_section_missing", name=name)
    known = fields_of(Force)
    found = []
    for number, table in enumerate(given, start=1):
        item = f"{name} {number}"
        for key in table:
            if key not in known:
                raise UnknownKey(key, item=item, **suggestion(key, list(known)))
        if "force_N" not in table:
            raise MissingKey("force_N", item=item, allowed=rule_of(known["force_N"]).allowed, **NEEDS["force_N"])
        try:
            found.append(Force(**table))
        except NotAllowed as refused:
            key = refused.key or ""
            raise NotAllowed(key, table.get(key), item=item, allowed=refused.allowed, **NEEDS[key]) from None
    return found


@definition
class StaticsJoint(Section):
    """The joint: geometry of its clearance, and friction."""

    GOES_WITH = {"type": KEYS_OF_TYPES}

    type: str = choice(..., tuple(TYPES), PAPER + ": one, two or three dimensions")
    friction_coefficient: float = parameter(..., "-", 0, 100, PAPER)
    clearance_m: float | None = parameter(None, "m", 0, 1e2, PAPER + ": c", above=True)
    axial_play_m: float | None = parameter(None, "m", 0, 1e2, "cylinder: middle to shoulder", above=True)
    lobes: int | None = whole(None, 1, 45, "lobed")
    lobe_amplitude_m: float | None = parameter(None, "m", 0, 1e2, "lobed: of the centre's curve")
    mesh_file: str | None = text(None, "STL, OBJ, PLY or VTP; from the case file's folder")
    mesh_unit_m: float | None = parameter(None, "m", 0, 1e3, "length of one unit of the mesh file", above=True)
    mesh_free_side: str = choice("right_hand", ("right_hand", "left_hand"), "side of the triangles' vertex order")


@definition
class Picture(Section):
    """Friction coefficients for drawings, besides that of the case."""

    friction_coefficients: list[float] = numbers([], "-", 0, 100, "one panel each, two dimensions")


@dataclass(frozen=True)
class LoadCase:
    """One force on the component."""

    name: str
    force_N: tuple[float, float, float]


@definition
class StaticsCase(Case):
    """Rest positions of a loaded joint under given forces, friction included."""

    KIND: ClassVar[str] = "statics"
    NOT_IN_FILE: ClassVar[Mapping[str, str]] = {
        "thermal": "a force takes temperature_change_K and force_rate_N_per_K",
    }

    joint: StaticsJoint = section(StaticsJoint, required=True)
    force: list[Force] = tables(Force, "sections [[force]]", required=True, read=read_forces)
    picture: Picture = section(Picture)
    # All kinds have this section. Here the forces have temperatures of their own.
    thermal: CaseThermal = section(
        CaseThermal, made=lambda: CaseThermal(shape="triangle", temperature_change_max_K=0.0)
    )

    @property
    def load_cases(self) -> list[LoadCase]:
        """Return every force, once per temperature if it depends on temperature."""
        return [
            load for number, force in enumerate(self.force, start=1)
            for load in force.at_temperatures(force.name or f"F{number}")
        ]

    @property
    def is_planar(self) -> bool:
        """Whether positions are on a plane curve."""
        return self.joint.type in ("slot", "journal", "lobed")

    def check(self) -> None:
        """Raise StatejumpError for a contradiction between several keys."""
        self._check_joint()
        self._check_forces()

    def _check_joint(self) -> None:
        joint = self.joint
        for key, types in KEYS_OF_TYPES.items():
            value = getattr(joint, key)
            if value is None and joint.type in types:
                raise MissingKey(f"joint.{key}", code="missing_for_joint_type", type=joint.type)
            if value is not None and joint.type not in types:
                raise NotAllowed(f"joint.{key}", value, code="wrong_joint_type",
                                 types=" or ".join((repr(name) for name in types)))
        if joint.lobe_amplitude_m is not None and joint.clearance_m is not None:
            if not joint.lobe_amplitude_m < joint.clearance_m:
                raise NotAllowed("joint.lobe_amplitude_m", joint.lobe_amplitude_m, code="lobe_amplitude",
                                 clearance_m=joint.clearance_m)
        if self.picture.friction_coefficients and not self.is_planar:
            raise NotAllowed("picture.friction_coefficients", code="only_below_three_dimensions")

    def _check_forces(self) -> None:
        loads = self.load_cases
        if len(loads) > MOST_FORCES:
            raise StatejumpError(code="too_many_forces", key="force", forces=len(loads), most=MOST_FORCES)
        for load in loads:
            x, y, z = load.force_N
            if hypot(x, y, z) == 0:
                raise NotAllowed(f"force {load.name!r}", [0, 0, 0], code="no_nonzero_force")
            if self.joint.type in ("journal", "lobed") and z != 0:
                raise NotAllowed(f"force {load.name!r}", list(load.force_N), code="force_out_of_plane",
                                 type=self.joint.type)
