# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of the shape of a truss: lengths, clearances over the temperatures, axes, supports."""
from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.kinds.truss.arrays import distances
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.references import MOST_LISTED, listed, turned_links
from statejump.kinds.truss.resolved import Links, ResolvedTruss, Springs


def check_geometry(truss: ResolvedTruss) -> None:
    """Raise StatejumpError for the first fault in the shape of a truss whose references are valid."""
    ranges_K = truss.temperature_ranges_K
    _lengths(truss)
    _stretches(truss.springs)
    _expansions(truss, ranges_K)
    for joint in JOINTS:
        joint.check_geometry(truss, truss.joints[joint.section], ranges_K)
    turned_links(truss, "torsion_spring", truss.torsion_springs)
    _supports(truss)


def _lengths(truss: ResolvedTruss) -> None:
    sections: tuple[tuple[str, Links | Springs], ...] = (("link", truss.links), ("spring", truss.springs))
    for section, items in sections:
        for index in np.flatnonzero(distances(truss.nodes.position_m, items.nodes) == 0)[:1]:
            ends = [truss.nodes.names[node] for node in items.nodes[index]]
            place = truss.nodes.position_m[items.nodes[index, 0]][: truss.dimension].tolist()
            raise StatejumpError(code="coincident_nodes", item=f"{section} {items.names[index]!r}", key="nodes",
                                 value=ends, nodes=ends, ends=" and ".join(map(repr, ends)), place_m=place,
                                 part=section)


def _stretches(springs: Springs) -> None:
    for index in np.flatnonzero(~np.isfinite(springs.free_length_m))[:1]:
        raise NotAllowed("preload_N", float(springs.preload_N[index]), code="spring_without_length",
                         item=f"spring {springs.names[index]!r}", stiffness=springs.stiffness_N_per_m[index])


def _expansions(truss: ResolvedTruss, ranges_K: np.ndarray) -> None:
    links = truss.links
    for side in (0, 1):
        changes = links.temperature_fraction * ranges_K[links.program, side]
        for index in np.flatnonzero(1 + links.thermal_expansion_per_K * changes <= 0)[:1]:
            raise NotAllowed("thermal_expansion_per_K", float(links.thermal_expansion_per_K[index]),
                             code="link_without_length_of_program", item=f"link {links.names[index]!r}",
                             temperature_change_K=float(changes[index]), at_K=changes[index],
                             fraction=links.temperature_fraction[index],
                             program=truss.program_names[links.program[index]])


class NoSupport(StatejumpError):
    """Parts of a truss without a path to a support.

    :param loose: a node of each of them
    """

    def __init__(self, *, loose: tuple[str, ...], **fields: Any) -> None:
        super().__init__(**fields)
        self.loose = loose


def supported(truss: ResolvedTruss) -> np.ndarray:
    """Return which nodes (n,) have a support."""
    nodes = truss.nodes
    held, guided = nodes.fixed[:, : truss.dimension].any(axis=1), nodes.guide_normal.any(axis=1)
    return np.asarray(held | guided)


def _supports(truss: ResolvedTruss) -> None:
    names = truss.nodes.names
    held = supported(truss)
    pairs = truss.links.nodes, truss.springs.nodes, truss.joined()
    used = held.copy()
    for ends in pairs:
        used[ends.ravel()] = True
    for node in np.flatnonzero(~used)[:1]:
        raise StatejumpError(code="node_unused", nodes=(names[node],), node=names[node])
    parts, part_of = len(names), np.arange(len(names), dtype=np.int32)
    for ends in pairs:  # one after the other, for a graph takes many times what they do
        first, second = part_of[ends].T
        graph = coo_matrix((np.ones(len(ends)), (first, second)), shape=(parts, parts))
        parts, joined = connected_components(graph, directed=False)
        part_of = joined[part_of]
    held_parts = np.zeros(parts, dtype=bool)
    held_parts[part_of[held]] = True
    if held.any() and held_parts.all():
        return
    _, firsts = np.unique(part_of, return_index=True)
    loose = tuple(names[at] for at in firsts[~held_parts])
    if not held.any():
        raise NoSupport(code="no_support", loose=loose)
    first = [names[at] for at in firsts[: MOST_LISTED + 1]]
    raise NoSupport(code="disconnected_truss", nodes=loose[:1], loose=loose, parts=parts, one_of_each=listed(first),
                    loose_node=loose[0])
