# SPDX-License-Identifier: GPL-3.0-or-later
"""Requirements of a design as rows of constraints: one row for each node and each point of the grid."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from statejump.control.capabilities import RestBounds, VibrationModes
from statejump.core.errors import NotAllowed, StatejumpError
from statejump.design.file import BOUND, FREQUENCY, JUMP, LINEAR_BOUND, MASS, OF_PATH, RMS, TILT, DesignRequirement
from statejump.design.model import Model, Setting
from statejump.kinds import require
from statejump.kinds.truss.answers import reflector
from statejump.kinds.truss.answers.jumps import node_jumps
from statejump.kinds.truss.body_points import displacements_m
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.masses import condensed_mass_kg
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath
from statejump.schema.paths import meant

UNITS = {JUMP: "m", TILT: "rad", RMS: "m", MASS: "kg", FREQUENCY: "Hz"}
BOUNDS = (BOUND, LINEAR_BOUND)
OF_GRID = (*OF_PATH, *BOUNDS)  # quantities that depend on friction and clearances


def total_mass_kg(truss: ResolvedTruss) -> float:
    """Return the mass of the truss. Parts without a mass count as massless."""
    parts = (truss.links.mass_kg, truss.elements["beam"].mass_kg, truss.nodes.mass_kg)
    return float(sum(np.nansum(part) for part in parts) + np.nansum(condensed_mass_kg(truss)))


@dataclass(frozen=True)
class Requirement:
    """A quantity with a limit.

    :param most: whether the limit is the largest allowed value; else it is the smallest
    :param nodes: indices of nodes of a jump
    :param labels: names of the rows at one point of the grid
    """

    name: str
    quantity: str
    limit: float
    most: bool
    unit: str
    labels: tuple[str, ...]
    nodes: tuple[int, ...] = ()
    surface: Any = None
    output: str = ""

    @property
    def of_path(self) -> bool:
        """Whether a path gives its values."""
        return self.quantity in OF_PATH

    def values(self, found: TrussPath | TrussCase) -> np.ndarray:
        """Return its values (labels,) of a path, or of a case."""
        if isinstance(found, TrussPath):
            return self._of_path(found)
        if self.quantity == MASS:
            return np.array([total_mass_kg(found.resolve())])
        if self.quantity == FREQUENCY:
            return np.array([require(found, VibrationModes).modes(found, 1).frequency_Hz[0]])
        bound = require(found, RestBounds).bounds(found, [self.output], simulate=False).record()["bounds"][0]
        jump, margin = bound[f"jump_{self.unit}"], bound[f"margin_{self.unit}"]
        if jump is not None and self.quantity == LINEAR_BOUND:
            return np.array([jump])
        if jump is None or margin is None:
            raise StatejumpError(code="design_no_guarantee", place=found.name, case=found.name, output=self.output)
        return np.array([jump + margin])

    def _of_path(self, path: TrussPath) -> np.ndarray:
        if self.quantity == JUMP:
            return np.asarray(np.linalg.norm(node_jumps(path)[-1, list(self.nodes)], axis=1))
        moved = displacements_m(path.truss, path.cycle_ends)
        start, end = (self.surface.fit(moved[index]) for index in (0, -1))
        if self.quantity == TILT:
            return np.array([np.linalg.norm(end.tilt_rad - start.tilt_rad)])
        return np.array([np.sqrt(np.mean((end.residual_m - start.residual_m) ** 2))])

    def margins(self, values: np.ndarray) -> np.ndarray:
        """Return how far values are within the limit, relative to it; negative: they violate it."""
        scale = abs(self.limit) or 1.0
        return (self.limit - values) / scale if self.most else (values - self.limit) / scale

    @property
    def text(self) -> str:
        """The requirement for tables."""
        return f"{self.quantity} {'≤' if self.most else '≥'} {self.limit:g}"


def requirements_of(case: TrussCase, wanted: Sequence[DesignRequirement]) -> list[Requirement]:
    """Return the requirements. :raises StatejumpError: one is invalid for this case"""
    found = list[Requirement]()
    for one in wanted:
        try:
            if one.name in [other.name for other in found]:
                raise NotAllowed("name", one.name, code="duplicate")
            found.append(_requirement(case, one))
        except NotAllowed as refused:
            refused.item = refused.item or f"requirement {one.name!r}"
            raise
    return found


def _requirement(case: TrussCase, wanted: DesignRequirement) -> Requirement:
    limits = [one for one in (wanted.at_most, wanted.at_least) if one is not None]
    if len(limits) != 1:
        raise NotAllowed("at_most", wanted.at_most, code="rare_needs_limit", options="at_most and at_least")
    limit, quantity = limits[0], wanted.quantity
    if not np.isfinite(limit):
        raise NotAllowed("at_most", limit, code="not_finite")
    most = wanted.at_most is not None
    if (wanted.output is None) == (quantity in BOUNDS):
        raise NotAllowed("output", wanted.output, code="design_output_of_bound")
    if quantity in OF_PATH and not case.has_jump:
        raise NotAllowed("quantity", quantity, code="design_without_jump")
    if quantity == JUMP:
        truss = case.resolve()
        names = [name for name, held in zip(truss.nodes.names, truss.nodes.fixed.all(axis=1)) if not held]
        chosen = list(dict.fromkeys(name for item in wanted.nodes for name in meant(item, names)))
        if not chosen:
            raise NotAllowed("nodes", wanted.nodes, code="design_no_node")
        places = {name: place for place, name in enumerate(truss.nodes.names)}
        return Requirement(wanted.name, quantity, limit, most, "m", tuple(chosen), tuple(places[one] for one in chosen))
    if quantity in (TILT, RMS):
        surface = reflector.surface(case.resolve())
        if surface is None:
            raise NotAllowed("quantity", quantity, code="no_fit")
        return Requirement(wanted.name, quantity, limit, most, UNITS[quantity], ("surface",), surface=surface)
    if quantity in BOUNDS:
        output = str(wanted.output)
        unit = "rad" if output == "tilt" or output.startswith("point") else "m"
        made = Requirement(wanted.name, quantity, limit, most, unit, (output,), output=output)
    else:
        made = Requirement(wanted.name, quantity, limit, most, UNITS[quantity], (case.name,))
    made.values(case)  # refuses what the case does not have
    return made


@dataclass(frozen=True)
class Row:
    """One constraint: a value of a requirement at a point of the grid; None: it does not depend on it."""

    requirement: Requirement
    label: str
    setting: Setting | None


def rows_of(requirements: Sequence[Requirement], grid: Sequence[Setting]) -> list[Row]:
    """Return all rows in the order of :func:`statejump.design.gradients.values_of`."""
    rows = [Row(one, label, setting) for setting in grid for one in requirements if one.quantity in OF_GRID
            for label in one.labels]
    return rows + [Row(one, label, None) for one in requirements if one.quantity not in OF_GRID for label in one.labels]


def at_setting(model: Model, x: np.ndarray, requirements: Sequence[Requirement], setting: Setting | None,
               more: Sequence[tuple[str, float]] = ()) -> np.ndarray:
    """Return the values of the rows of one point of the grid, or of the rows that do not depend on it.

    :param more: further values by ``section.item.key``
    :raises StatejumpError: the truss has no path, or the case is not allowed
    """
    mine = [one for one in requirements if (one.quantity in OF_GRID) == (setting is not None)]
    path = model.path(x, setting or Setting(), more) if any(one.of_path for one in mine) else None
    case = model.case(x, setting or Setting(), more=more) if any(not one.of_path for one in mine) else None
    found = [one.values(path if one.of_path else case) for one in mine]  # type: ignore[arg-type]
    return np.concatenate(found) if found else np.zeros(0)
