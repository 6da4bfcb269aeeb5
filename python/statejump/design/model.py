# SPDX-License-Identifier: GPL-3.0-or-later
"""The truss at a point of the search: as arrays, which is fast, or as a case."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from statejump.core.case import Case
from statejump.design.variables import Group, Target
from statejump.kinds.loading import parse_case
from statejump.kinds.truss.answers.jumps import quick_path
from statejump.kinds.truss.answers.gradient import RecordedPath
from statejump.kinds.truss.answers.parameters import changed, parameters
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath
from statejump.schema.paths import filled, split_path

FRICTION = ("friction_coefficient", "friction_moment_N_m")
CLEARANCE = ("radial_clearance_m", "clearance_m", "clearance_minus_m", "clearance_plus_m", "play_m", "deadband_rad")


@dataclass(frozen=True)
class Setting:
    """Factors on all friction coefficients and on all clearances."""

    friction: float = 1.0
    clearance: float = 1.0

    def __str__(self) -> str:
        return f"friction × {self.friction:g}, clearance × {self.clearance:g}"

    def of(self, key: str) -> float:
        """Return the factor on a key."""
        return self.friction if key in FRICTION else self.clearance if key in CLEARANCE else 1.0


NOMINAL = Setting()


@dataclass
class Model:
    """A case with variables.

    :param arrays: whether values can be set in the arrays of the truss, without making a case
    :param paths: number of paths that were solved
    :param solutions: number of linear systems solved for exact derivatives
    """

    base: TrussCase
    groups: Sequence[Group]
    arrays: bool = False
    paths: int = 0
    solutions: int = 0
    truss: ResolvedTruss = field(init=False)
    numbers: dict[tuple[str, str], np.ndarray] = field(init=False)
    places: dict[str, dict[str, int]] = field(init=False)

    def __post_init__(self) -> None:
        self.truss = self.base.resolve()
        self.numbers = {(section, key): values for section, key, values in parameters(self.truss)}
        parts = {**self.truss.joints, **self.truss.elements, "link": self.truss.links}
        self.places = {section: {name: place for place, name in enumerate(parts[section].names)}
                       for section in {section for section, _ in self.numbers}}
        keys = {split_path(target.path)[::2] for group in self.groups for target in group.targets}
        self.arrays = all(key in self.numbers for key in keys) and self.base.truss.gravity_m_per_s2 is None

    def path(self, x: np.ndarray, setting: Setting = NOMINAL,
             more: Iterable[tuple[str, float]] = ()) -> TrussPath:
        """Solve the path at a point. :raises StatejumpError: the truss has no path

        :param more: further values by ``section.item.key``
        """
        self.paths += 1
        truss = self.truss_at(x, setting, more) if self.arrays else self.case(x, setting, more=more).resolve()
        return quick_path(truss, self.base.reduced_settings.increments_per_branch, cycle_ends_only=True)

    def recorded(self, x: np.ndarray, setting: Setting) -> RecordedPath:
        """Solve the path at a point, for exact derivatives. :raises StatejumpError: the truss has no path"""
        self.paths += 1
        return RecordedPath(self.truss_at(x, setting, ()), self.base.reduced_settings.increments_per_branch)

    def truss_at(self, x: np.ndarray, setting: Setting, more: Iterable[tuple[str, float]]) -> ResolvedTruss:
        """Return the truss at a point. :raises KeyError: ``arrays`` is false"""
        factors = {key: np.full(len(values), setting.of(key[1])) for key, values in self.numbers.items()
                   if setting.of(key[1]) != 1.0}
        pairs = [(target.path, value / target.value) for group, one in zip(self.groups, x)
                 for target, value in group.values(one)]
        for path, factor in pairs:
            section, item, key = split_path(path)
            found = factors.setdefault((section, key), np.ones(len(self.numbers[section, key])))
            found[self.places[section][item]] *= factor
        for path, value in more:
            section, item, key = split_path(path)
            place = self.places[section][item]
            own = self.numbers[section, key]
            factors.setdefault((section, key), np.ones(len(own)))[place] = value / own[place]
        truss = self.truss
        for (section, key), of_items in factors.items():
            truss = changed(truss, section, key, of_items)
        return truss

    def case(self, x: np.ndarray, setting: Setting = NOMINAL, name: str = "",
             more: Iterable[tuple[str, float]] = ()) -> TrussCase:
        """Return the case at a point. :raises StatejumpError: the case is not allowed"""
        values: dict[str, object] = {}
        for group, one in zip(self.groups, x):
            for target, value in group.values(one):
                values[target.path] = self._placed(target, value, values)
        for (section, key), own in self.numbers.items():
            factor = setting.of(key)
            for item, place in self.places[section].items() if factor != 1.0 else ():
                path = f"{section}.{item}.{key}"
                if np.isfinite(own[place]) and own[place] != 0:
                    values[path] = factor * float(values.get(path, own[place]))  # type: ignore[arg-type]
        values.update(more)
        if name:
            values["case.name"] = name
        origin = self.base.origin
        data = filled(origin.document, values.items())  # type: ignore[arg-type]
        made: Case = parse_case(data, file=origin.file, files_from=origin.folder)
        assert isinstance(made, TrussCase)
        return made

    def _placed(self, target: Target, value: float, values: dict[str, object]) -> object:
        if target.axis < 0:
            return value
        own = values.get(target.path) or list(self.base[target.path])
        assert isinstance(own, list)
        return [value if axis == target.axis else one for axis, one in enumerate(own)]
