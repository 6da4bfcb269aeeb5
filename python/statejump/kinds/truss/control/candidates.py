# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of a truss that may reduce the jump of a node: an added spring, or a scaled parameter."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil, log, log10

import numpy as np

from statejump.control.study import DesignChoices, grid, highest
from statejump.core.errors import NotAllowed, UnknownKey
from statejump.kinds.truss.answers.parameters import changed, parameters
from statejump.kinds.truss.arrays import distances
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.references import known_name
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import rule_of
from statejump.schema.paths import EVERY, attribute_of, meant, split_path
from statejump.schema.rules import suggestion

PER_DECADE = 3
FACTORS = (1e-3, 1e3)  # factors of a scaled parameter
STIFFER = 1e3  # range of spring stiffnesses: stiffest link times this, softest element divided by this
STIFFNESS = "spring.*.stiffness_N_per_m"


@dataclass(frozen=True)
class Candidate:
    """A change of a truss by one number.

    :param parameter: name of the change as the user gave it
    :param own: the number for the unchanged case: stiffness 0, or factor 1
    :param values: numbers to try
    :param truss: function that returns the changed truss for a number
    :param section: section of the changed items; ``key`` is their changed key, ``which`` returns their indices
    """

    parameter: str
    label: str
    unit: str
    own: float
    values: tuple[float, ...]
    truss: Callable[[float], ResolvedTruss]
    section: str
    key: str
    which: Callable[[ResolvedTruss], np.ndarray]

    @property
    def is_spring(self) -> bool:
        """Whether the candidate adds a spring; else it scales a parameter."""
        return self.own == 0

    def size(self, value: float) -> float:
        """Return the size of the change for a value: the stiffness [N/m], or the absolute logarithm of the factor."""
        return value if self.is_spring else abs(log(value))


def candidates(case: TrussCase, choices: DesignChoices) -> list[Candidate]:
    """Return the candidates: the changes that the user requests, or else all parameters that may affect the jump.

    :raises NotAllowed: a position or a parameter is invalid
    """
    found = [_spring(case, one, two) for one, two in choices.add_spring]
    wanted = [_scaled(case, path) for path in choices.scale]
    if not found and not wanted:
        wanted = [_scaled(case, f"{section}.{EVERY}.{key}") for section, key, values in parameters(case.resolve())
                  if _has_value(values).any()]
    asked = [one.parameter for one in found + wanted]
    for one in found + wanted:
        if asked.count(one.parameter) > 1:
            change, _, value = one.parameter.partition(" ")
            raise NotAllowed({"scale": "--free"}.get(change, "--add-spring"), value, code="duplicate")
    return found + wanted


def with_spring(truss: ResolvedTruss, ends: Sequence[int], stiffness_N_per_m: float) -> ResolvedTruss:
    """Return the truss with an additional spring, the last one, which is unloaded in the reference configuration. If
    the stiffness is 0, return the unchanged truss."""
    if stiffness_N_per_m == 0:
        return truss
    springs, pair = truss.springs, np.array([ends])
    return truss.with_elements(spring=replace(
        springs, names=(*springs.names, "added"), nodes=np.concatenate((springs.nodes.reshape(-1, 2), pair)),
        stiffness_N_per_m=np.append(springs.stiffness_N_per_m, stiffness_N_per_m),
        free_length_m=np.append(springs.free_length_m, distances(truss.nodes.position_m, pair)),
        preload_N=np.append(springs.preload_N, 0.0), cable=np.append(springs.cable, False),
    ))


def _spring(case: TrussCase, one: str, two: str) -> Candidate:
    truss, given = case.resolve(), f"{one} {two}"
    for name in (one, two):
        known_name("--add-spring", given, name, dict.fromkeys(truss.nodes.names), "node", case=case.name)
    ends = [truss.nodes.names.index(name) for name in (one, two)]
    if not distances(truss.nodes.position_m, np.array([ends]))[0] > 0:
        raise NotAllowed("--add-spring", given, code="coincident_spring_nodes", case=case.name)
    if truss.nodes.fixed[ends].all():
        raise NotAllowed("--add-spring", given, code="spring_between_supports", case=case.name)
    links, springs = truss.links, truss.springs
    bars = links.young_modulus_Pa * links.cross_section_area_m2 / links.stress_free_length_m
    size = float(np.ptp(truss.nodes.position_m, axis=0).max())
    turned = [element.torsion(truss.elements[element.section]).stiffness_N_m_per_rad / size**2 for element in ELEMENTS]
    every = np.concatenate((bars, *truss.element_stiffnesses_N_per_m(), *turned))
    stiffest = min(highest(case, STIFFNESS), STIFFER * (bars if len(bars) else every).max(initial=1.0))
    softest = every.min(initial=stiffest) / STIFFER
    return Candidate(
        f"add_spring {given}", f"Spring from {one} to {two}", "N/m", 0.0, _grid(0.0, softest, stiffest),
        lambda stiffness: with_spring(truss, ends, stiffness), "spring", "stiffness_N_per_m",
        lambda changed_truss: np.arange(len(changed_truss.springs.names)) == len(springs.names))


def _scaled(case: TrussCase, path: str) -> Candidate:
    truss = case.resolve()
    section, item, key = split_path(path)
    known = {(of, name): values for of, name, values in parameters(truss)}
    if (section, key) not in known:
        paths = [f"{of}.{EVERY}.{name}" for of, name in known]
        raise UnknownKey("--free", value=path, **suggestion(path, paths))
    names = [one.name for one in case.value_named(section)]
    wanted = set(meant(item, names))
    if not wanted:
        known_names = suggestion(item, names, f"{section}.", f".{key}")
        raise UnknownKey("--free", value=path,
                         **(known_names if names else {"code": "section_not_in_case", "table": section}))
    values = known[section, key]
    which = _has_value(values) & (np.array([name in wanted for name in names], dtype=bool))
    if not which.any():
        raise NotAllowed("--free", path, code="nothing_to_scale")
    sizes, allowed = np.abs(values[which]), rule_of(attribute_of(TrussCase, f"{section}.{EVERY}.{key}")).allowed
    assert allowed is not None
    # Only numbers within the range are tried; its lower end counts only if it is above 0.
    most = min(FACTORS[1], allowed.high / sizes.max())
    least = max(FACTORS[0], allowed.low / sizes.min())
    return Candidate(
        f"scale {path}", f"{path}, times", "-", 1.0, _grid(1.0, least, most),
        lambda factor: changed(truss, section, key, np.where(which, factor, 1.0)), section, key, lambda _: which)


def _has_value(values: np.ndarray) -> np.ndarray:
    return np.isfinite(values) & (values != 0)


def _grid(own: float, low: float, high: float) -> tuple[float, ...]:
    count = 1 + ceil(PER_DECADE * log10(high / low))
    return tuple(grid(own, low, high, count))
