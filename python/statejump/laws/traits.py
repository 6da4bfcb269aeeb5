# SPDX-License-Identifier: GPL-3.0-or-later
"""Descriptions of the laws in the catalogue: data that hold the traits of their C++ types."""
from __future__ import annotations

from dataclasses import dataclass
from math import inf

from statejump import _engine
from statejump.core.errors import NotAllowed

KINDS = ("normal", "dissipation", "friction", "tangential_velocity")


@dataclass(frozen=True)
class Parameter:
    """A parameter that a law reads; ``unit`` is "-" for a ratio."""

    name: str
    unit: str
    low: float
    high: float
    low_excluded: bool
    default: float
    meaning: str
    source: str

    def allows(self, value: float) -> bool:
        """Return whether a value is in range; NaN is not."""
        above = value > self.low if self.low_excluded else value >= self.low
        return above and value <= self.high and value < inf


@dataclass(frozen=True)
class Law:
    """Description of a law. Code that depends on the capabilities of a law reads its traits, never its name."""

    name: str
    formula: str
    source: str
    range: str  # range of validity, and the errors outside
    holds_static_load: bool
    frictionless: bool
    has_memory: bool  # True: the law keeps a history; False: a smooth function of the velocity
    needs_axis: bool  # invalid in a socket and on a flat face
    accepts_bulging_wall: bool
    point_contact: bool  # Hertz's
    needs_point_contact: bool  # valid only with a normal law for a point contact
    parameters: tuple[Parameter, ...]


def catalogue(kind: str) -> tuple[Law, ...]:
    """Return the laws of a kind in ``KINDS``, in the order of the catalogue. :raises ValueError: the kind is unknown"""
    return tuple(
        Law(**dict(declared, parameters=tuple(Parameter(**each) for each in declared["parameters"])))
        for declared in _engine.laws(kind)
    )


def names(kind: str) -> list[str]:
    """Return the names of the laws of a kind. :raises ValueError: the kind is unknown"""
    return _engine.law_names(kind)


class NoLaw(NotAllowed, ValueError):
    """A law is unknown or cannot be used; the error is also a ValueError."""


def law(kind: str, name: str) -> Law:
    """Return the law of a kind with a given name. :raises NoLaw: it is unknown or cannot be used"""
    for each in catalogue(kind):
        if each.name == name:
            return each
    problem = _engine.law_problem(kind, name)
    if problem:
        raise NoLaw(f"{kind}_law", name, code="bad_law", cause=problem)
    known = names(kind)
    raise NoLaw(f"{kind}_law", name, code="unknown_name", allowed=known, known=" or ".join(map(repr, known)))
