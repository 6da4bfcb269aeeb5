# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of means: their nodes exist, and determine what follows."""
from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.means import Mean, Means
from statejump.kinds.truss.references import known_name


def check_means(items: Sequence[Mean], nodes: Mapping[str, Any], dimension: int, rotating: Collection[str]) -> None:
    """Raise NotAllowed for the first mean with inconsistent keys.

    :param rotating: nodes that beams, bodies or hinges rotate
    """
    for item in items:
        where: dict[str, Any] = {"item": f"mean {item.name!r}"}
        known_name("reference", item.reference, item.reference, nodes, "node", **where)
        if not item.nodes:
            raise NotAllowed("nodes", item.nodes, code="no_nodes", **where)
        for name in item.nodes:
            known_name("nodes", item.nodes, name, nodes, "node", **where)
        if item.reference in item.nodes or len(set(item.nodes)) < len(item.nodes):
            raise NotAllowed("nodes", item.nodes, code="mean_node_repeated", **where)
        if item.weights is not None and (len(item.weights) != len(item.nodes) or not min(item.weights) > 0):
            raise NotAllowed("weights", item.weights, code="mean_weights", nodes_of_mean=len(item.nodes), **where)
        if not item.follows(dimension):
            raise NotAllowed("directions", item.directions, code="rigid_without_direction", **where)
        moment = nodes[item.reference].moment_N_m
        if item.turns(dimension) and moment is not None and item.reference not in rotating:
            for axis, value in zip("xyz"[3 - len(moment):], moment):
                if value and axis not in item.turns(dimension):
                    raise NotAllowed("directions", item.directions, code="mean_moment", node=item.reference,
                                     direction=f"R{axis}", **where)


def check_clouds(items: Sequence[Mean], means: Means, dimension: int) -> None:
    """Raise NotAllowed for the first mean whose nodes do not determine a direction that follows."""
    for item, cloud in zip(items, means.clouds):
        for direction in item.follows(dimension):
            if cloud.undetermined(direction):
                raise NotAllowed("directions", item.directions, code="mean_undetermined", direction=direction,
                                 item=f"mean {item.name!r}", nodes=tuple(item.nodes))
