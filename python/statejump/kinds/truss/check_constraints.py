# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of the constraints of a truss."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.constraints import LEAST_COEFFICIENT
from statejump.kinds.truss.references import known_name
from statejump.kinds.truss.sections import TrussSections


def check_constraints(case: TrussSections, nodes: Mapping[str, Any]) -> None:
    """Raise NotAllowed for the first constraint with inconsistent terms."""
    for item in case.constraint:
        where = {"item": f"constraint {item.name!r}"}
        if not item.nodes:
            raise NotAllowed("nodes", item.nodes, code="no_nodes", **where)
        for name in item.nodes:
            known_name("nodes", item.nodes, name, nodes, "node", **where)
        for key in ("directions", "coefficients"):
            if len(getattr(item, key)) != len(item.nodes):
                raise NotAllowed(key, getattr(item, key), code="constraint_length", terms=len(item.nodes), **where)
        if case.truss.dimension == 2 and "z" in item.directions:
            raise NotAllowed("directions", item.directions, code="planar_directions", **where)
        terms = list(zip(item.nodes, item.directions))
        for term in terms:
            if terms.count(term) > 1:
                raise NotAllowed("nodes", item.nodes, code="constraint_term_twice", node=term[0], direction=term[1],
                                 **where)
        largest = max(abs(value) for value in item.coefficients)
        for value in item.coefficients:
            if value == 0 or abs(value) < LEAST_COEFFICIENT * largest:
                raise NotAllowed("coefficients", value, code="constraint_coefficient", **where)
