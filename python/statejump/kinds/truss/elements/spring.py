# SPDX-License-Identifier: GPL-3.0-or-later
"""Springs and cables between two nodes."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.arrays import References, column, distances, given_or, pairs, said
from statejump.kinds.truss.elements.protocol import BetweenNodes, EndsArrays, Lines, Switch
from statejump.kinds.truss.joints.protocol import USER, ItemColumn, scaled
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import definition, parameter, switch, texts
from statejump.schema.item_tables import ItemColumns, once
from statejump.schema.items import Item

GREEN, ORANGE = "#009E73", "#D55E00"
LARGEST_LENGTH_M = 1e6


@definition
class Spring(Item):
    """A linear spring between two nodes, or a cable that only pulls."""

    nodes: list[str] = texts(..., "its two nodes")
    stiffness_N_per_m: float = parameter(..., "N/m", 0, 1e15, USER, above=True)
    preload_N: float | None = parameter(None, "N", -1e12, 1e12, "tension of the drawn truss; 0")
    free_length_m: float | None = parameter(None, "m", 0, LARGEST_LENGTH_M, "instead of preload_N")
    cable: bool = switch(False, "whether it only pulls")


@dataclass(frozen=True)
class Springs(EndsArrays):
    """Springs and cables. The tension is stiffness · (length - free length); that of a cable is at least 0."""

    names: Sequence[str]
    nodes: np.ndarray  # (k, 2) int
    stiffness_N_per_m: np.ndarray
    free_length_m: np.ndarray  # negative if the preload exceeds stiffness · length in the reference configuration
    preload_N: np.ndarray  # tension in the reference configuration, negative for a slack cable
    cable: np.ndarray  # bool


class SpringType(BetweenNodes[Spring, Springs]):
    """Springs and cables, supported by the solver and the DEM."""

    section = "spring"
    Item = Spring
    Arrays = Springs
    columns: ClassVar[tuple[ItemColumn, ...]] = (ItemColumn("tension_N"),)
    listed_if_none = True  # as in earlier result files
    varied = ("stiffness_N_per_m", "preload_N")

    def check_keys(self, item: Spring) -> None:
        if item.preload_N is not None and item.free_length_m is not None:
            raise NotAllowed("preload_N", item.preload_N, code="conflicting_key", other="free_length_m",
                             **self.where(item.name))

    def may_be_wrong_keys(self, items: ItemColumns[Spring]) -> np.ndarray:
        return np.asarray(said(items, "preload_N") & said(items, "free_length_m"))

    def derived(self, items: Sequence[Spring], known: References) -> dict[str, Any]:
        drawn = distances(known.position_m, pairs(items, "nodes", known.node))
        stiffness = column(items, "stiffness_N_per_m")
        free, preload = column(items, "free_length_m"), column(items, "preload_N")
        preload = once(np.where(np.isnan(free), np.nan_to_num(preload), stiffness * (drawn - free)))
        with np.errstate(over="ignore"):  # refused by the checks
            stretch = preload / stiffness
        return {"free_length_m": given_or(free, drawn - stretch), "preload_N": preload}

    def check_geometry(self, truss: ResolvedTruss, elements: Springs) -> None:
        super().check_geometry(truss, elements)
        for index in np.flatnonzero(~np.isfinite(elements.free_length_m))[:1]:
            raise NotAllowed("preload_N", float(elements.preload_N[index]), code="spring_without_length",
                             stiffness=elements.stiffness_N_per_m[index], **self.where(elements.names[index]))

    def preload_N(self, elements: Springs) -> np.ndarray:
        return elements.preload_N

    def tension_N(self, elements: Springs, states: Mapping[str, np.ndarray]) -> np.ndarray:
        return states["tension_N"]

    def switches(self, elements: Springs, columns: Mapping[str, np.ndarray]) -> list[Switch]:
        return [Switch(int(cable), columns["tension_N"][:, cable] > 0, "taut", "slack")
                for cable in np.flatnonzero(elements.cable)]

    def changed(self, truss: ResolvedTruss, elements: Springs) -> Springs:
        # A change of stiffness keeps the preload, and a change of preload keeps the stiffness.
        drawn = distances(truss.nodes.position_m, elements.nodes)
        return replace(elements, free_length_m=drawn - elements.preload_N / elements.stiffness_N_per_m)

    def lines(self, elements: Springs) -> list[Lines]:
        found = []
        for noun, which, colour in (("spring", ~elements.cable, GREEN), ("cable", elements.cable, ORANGE)):
            preload = f", preload {scaled(elements.preload_N[which], 1.0, 'N')}" if which.any() else ""
            found.append(Lines(which, colour, f"{noun}{preload}", dashed=noun == "cable"))
        return found

    def counted(self, items: Sequence[Spring]) -> list[tuple[Sequence[Spring], str]]:
        return [([spring for spring in items if not spring.cable], "spring"),
                ([spring for spring in items if spring.cable], "cable")]

    def dem_refuses(self, elements: Springs) -> tuple[str, str, str] | None:
        for index in np.flatnonzero(elements.free_length_m <= 0)[:1]:
            return elements.names[index], "dem_spring_free_length", (
                f"has the free length {elements.free_length_m[index]:.6g} m, the DEM needs one above 0")
        return None


SPRING = SpringType()
