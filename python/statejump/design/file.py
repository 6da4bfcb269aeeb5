# SPDX-License-Identifier: GPL-3.0-or-later
"""Design files: variables, cost, requirements, robustness and scatter."""
from __future__ import annotations

import math
from typing import Any

from statejump.campaign.vary import MonteCarloVary
from statejump.schema.fields import (
    CHOICE, Section, choice, definition, numbers, parameter, section, switch, tables, text, texts, whole,
)
from statejump.schema.items import Item

SLSQP, TRUST, COBYLA, NLOPT = "slsqp", "trust-constr", "cobyla", "nlopt-mma"
METHODS = (SLSQP, TRUST, COBYLA, NLOPT)
JUMP, TILT, RMS, MASS, FREQUENCY, BOUND = "jump_m", "tilt_rad", "rms_m", "mass_kg", "frequency_Hz", "bound"
LINEAR_BOUND = "linear_bound"
QUANTITIES = (JUMP, TILT, RMS, MASS, FREQUENCY, BOUND, LINEAR_BOUND)
OF_PATH = (JUMP, TILT, RMS)
SCALES = ("log", "linear")
NAME = "[A-Za-z_][A-Za-z0-9_]*"


@definition
class DesignSettings(Section):
    """The search and its checks."""

    method: str = choice(SLSQP, METHODS, CHOICE + ": cobyla needs no gradients, and is for comparison")
    iterations: int = whole(60, 1, 100_000, "most iterations of each stage")
    tolerance: float = parameter(1e-6, "-", 1e-12, 0.1, "of the cost, at which the search ends")
    step: float = parameter(1e-3, "-", 1e-9, 0.1, "of central differences: change of ln(factor), factor or shift/high")
    samples: int = whole(1000, 0, 10_000_000, "random samples of the result, if there is scatter")
    seed: int = whole(1, 0, 2**31 - 1, CHOICE)
    tail: bool = switch(True, "whether few failed samples lead to FORM and importance sampling, see statejump rare")


@definition
class DesignVariable(Item):
    """Numbers of the case that the search changes by factors; positions by shifts."""

    name: str = text(..., "by which the cost calls its factors", pattern=NAME)
    keys: list[str] = texts(..., "section.item.key as in the case file, * for all items or as part of a name")
    each: bool = switch(True, "one factor for each key and item; false: one common factor")
    low: float = parameter(..., "-", -math.inf, math.inf, "smallest factor; of a position the shift [m]")
    high: float = parameter(..., "-", -math.inf, math.inf, "largest factor; of a position the shift [m]")
    scale: str = choice("log", SCALES, CHOICE + "; of a position linear")
    axis: str | None = choice(None, ("x", "y", "z"), "of position_m; none")


@definition
class DesignCost(Section):
    """The cost, which the search makes small."""

    formula: str = text(..., "names of variables, mass_kg, sum(), sqrt(), exp(), log(); as 'sum(K) + 0.2*sum(1/c)'")


@definition
class DesignRequirement(Item):
    """A quantity with a limit. Every node has a constraint of its own, at each point of the grid of [robust]."""

    quantity: str = choice(..., QUANTITIES,
                           "over all cycles; bound: guaranteed for any temperature history; linear_bound: no margin")
    at_most: float | None = parameter(None, "as quantity", -math.inf, math.inf, "this or at_least")
    at_least: float | None = parameter(None, "as quantity", -math.inf, math.inf, "this or at_most")
    nodes: list[str] = texts(["*"], "of jump_m: names, * for all nodes or as part of a name")
    output: str | None = text(None, "of bound and linear_bound: as of statejump bounds")


@definition
class DesignRobust(Section):
    """Factors on all friction coefficients and clearances. The requirements hold for each pair of them."""

    friction: list[float] = numbers([0.1, 0.4, 1.0, 1.3, 1.6], "-", 0, 1e3, CHOICE + ": both sides of the nominal one")
    clearance: list[float] = numbers([1.0], "-", 0, 1e3, CHOICE)


def _as_given(name: str, value: Any) -> list[Any]:
    """Return ``[[scatter]]`` unchecked: its rules depend on the case."""
    return list(value) if isinstance(value, list) else [value]


@definition
class DesignFile(Section):
    """What a design may change, what it costs, and what it has to meet."""

    design: DesignSettings = section(DesignSettings)
    variable: list[Any] = tables(DesignVariable, "sections [[variable]]", required=True)
    cost: DesignCost = section(DesignCost, required=True)
    requirement: list[Any] = tables(DesignRequirement, "sections [[requirement]]", required=True)
    robust: DesignRobust = section(DesignRobust)
    scatter: list[Any] = tables(MonteCarloVary, "sections [[scatter]], as [[vary]] of a Monte Carlo campaign",
                                read=_as_given)
