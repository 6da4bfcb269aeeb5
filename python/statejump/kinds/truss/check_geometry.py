# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of the shape of a truss: lengths, clearances over the temperatures, axes, supports."""
from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.elements.protocol import check_lengths
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.references import MOST_LISTED, listed
from statejump.kinds.truss.resolved import ResolvedTruss


def check_geometry(truss: ResolvedTruss) -> None:
    """Raise StatejumpError for the first fault in the geometry of a truss whose references are valid."""
    ranges_K = truss.temperature_ranges_K
    check_lengths(truss, "link", truss.links.names, truss.links.nodes)
    _expansions(truss, ranges_K)
    for element in ELEMENTS:
        element.check_geometry(truss, truss.elements[element.section])
    for joint in JOINTS:
        joint.check_geometry(truss, truss.joints[joint.section], ranges_K)
    _supports(truss)


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
    """Some nodes of a truss have no connection to any support.

    :param loose: one node of each group of unsupported nodes
    """

    def __init__(self, *, loose: tuple[str, ...], **fields: Any) -> None:
        super().__init__(**fields)
        self.loose = loose


def supported(truss: ResolvedTruss) -> np.ndarray:
    """Return for each node (n,) whether it has a support, a constraint that acts as one, or rests on ground."""
    nodes = truss.nodes
    held, guided = nodes.fixed[:, : truss.dimension].any(axis=1), nodes.guide_normal.any(axis=1)
    found = np.asarray(held | guided)
    found[truss.constraints.grounded()] = True
    for joint in JOINTS:
        found[joint.resting_nodes(truss.joints[joint.section])] = True
    return found


def _supports(truss: ResolvedTruss) -> None:
    names = truss.nodes.names
    held = supported(truss)
    pairs = *truss.ends(), truss.joined(), truss.constraints.pairs()
    used = held.copy()
    for ends in pairs:
        used[ends.ravel()] = True
    for node in np.flatnonzero(~used)[:1]:
        raise StatejumpError(code="node_unused", nodes=(names[node],), node=names[node])
    parts, part_of = len(names), np.arange(len(names), dtype=np.int32)
    for ends in pairs:  # pair by pair, because building a graph takes many times as long
        first, second = part_of[ends].T
        graph = coo_matrix((np.ones(len(ends)), (first, second)), shape=(parts, parts))
        parts, joined = connected_components(graph, directed=False)
        part_of = joined[part_of]
    held_parts = np.zeros(parts, dtype=bool)
    held_parts[part_of[held]] = True
    if held.any() and held_parts.all() or truss.free and parts == 1:
        return
    _, firsts = np.unique(part_of, return_index=True)
    loose = tuple(names[at] for at in firsts[~held_parts])
    if not held.any():
        raise NoSupport(code="no_support", loose=loose)
    first = [names[at] for at in firsts[: MOST_LISTED + 1]]
    raise NoSupport(code="disconnected_truss", nodes=loose[:1], loose=loose, parts=parts, one_of_each=listed(first),
                    loose_node=loose[0])
