# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with the shape of a truss: lengths, clearances over the temperatures, axes, supports."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.kinds.truss.check_references import MOST_LISTED, listed
from statejump.kinds.truss.resolved import (
    GROUND, LatchHinges, Links, ResolvedTruss, Springs, TorsionSprings, distances,
)

if TYPE_CHECKING:
    from statejump.kinds.truss.case import TrussCase

# Directions that differ by less are one: far above rounding, far below what anybody means.
SAME_DIRECTION = 1e-6


def check_geometry(case: TrussCase) -> None:
    """Raise StatejumpError for the first thing that is wrong with the shape of a truss whose names are right."""
    truss = case.resolve()
    _lengths(truss)
    _temperatures(case, truss)
    _sliders(truss)
    _revolutes(case, truss)
    _turned_links(truss, "torsion_spring", truss.torsion_springs)
    _turned_links(truss, "latch_hinge", truss.latch_hinges)
    _supports(truss)


def _of_revolute(truss: ResolvedTruss, index: int) -> dict[str, Any]:
    name = truss.revolutes.names[index]
    return {"item": f"revolute {name!r}", "joint": name}


def _lengths(truss: ResolvedTruss) -> None:
    sections: tuple[tuple[str, Links | Springs], ...] = (("link", truss.links), ("spring", truss.springs))
    for section, items in sections:
        for index in np.flatnonzero(distances(truss.nodes.position_m, items.nodes) == 0)[:1]:
            ends = [truss.nodes.names[node] for node in items.nodes[index]]
            place = truss.nodes.position_m[items.nodes[index, 0]][: truss.dimension].tolist()
            raise StatejumpError(
                f"nodes {' and '.join(map(repr, ends))} are at one place, {place} m",
                cause=f"the {section} has no length", item=f"{section} {items.names[index]!r}", key="nodes", value=ends,
                nodes=ends,
            )


def _temperatures(case: TrussCase, truss: ResolvedTruss) -> None:
    ranges = np.array(case.temperature_ranges_K)
    links, revolutes = truss.links, truss.revolutes
    for side in (0, 1):
        changes = links.temperature_fraction * ranges[links.program, side]
        for index in np.flatnonzero(1 + links.thermal_expansion_per_K * changes <= 0)[:1]:
            raise NotAllowed(
                "thermal_expansion_per_K", float(links.thermal_expansion_per_K[index]),
                f"the link has no length left at a temperature change of {changes[index]:g} K, "
                f"{links.temperature_fraction[index]:g} times that of program "
                f"{truss.program_names[links.program[index]]!r}", item=f"link {links.names[index]!r}",
                temperature_change_K=float(changes[index]),
            )
        changes = revolutes.temperature_fraction * ranges[revolutes.program, side]
        for part in ("journal", "bearing"):
            expansion = getattr(revolutes, f"{part}_thermal_expansion_per_K")
            for index in np.flatnonzero(1 + expansion * changes <= 0)[:1]:
                raise NotAllowed(
                    f"{part}_thermal_expansion_per_K", float(expansion[index]),
                    f"the {part} has no radius left at a temperature change of {changes[index]:g} K",
                    temperature_change_K=float(changes[index]), **_of_revolute(truss, index),
                )
        for index in np.flatnonzero(~(revolutes.clearance_m(changes) > 0))[:1]:
            raise NotAllowed(
                "radial_clearance_m", float(revolutes.radial_clearance_m[index]),
                f"the expansion of journal and bearing closes it at a temperature change of {changes[index]:g} K, it "
                "must stay above 0 [m] within the program", temperature_change_K=float(changes[index]),
                **_of_revolute(truss, index),
            )
    for index in np.flatnonzero(~(revolutes.bearing_radius_m > revolutes.journal_radius_m))[:1]:
        raise NotAllowed(
            "radial_clearance_m", float(revolutes.radial_clearance_m[index]),
            f"too small beside journal_radius_m = {revolutes.journal_radius_m[index]:g} [m], the radii come out equal",
            **_of_revolute(truss, index),
        )


def _sliders(truss: ResolvedTruss) -> None:
    sliders, nodes = truss.sliders, truss.nodes
    on_ground = np.flatnonzero(sliders.nodes[:, 1] == GROUND)
    carrier, axis = sliders.nodes[on_ground, 0], sliders.axis[on_ground]
    guide = nodes.guide_normal[carrier]
    # Sum of n n^T over the directions in which supports hold the node: its rank is how many these are.
    held = nodes.fixed[carrier][:, :, None] * np.eye(3) + guide[:, :, None] * guide[:, None, :]
    along = np.einsum("ki,kij,kj->k", axis, held, axis) > SAME_DIRECTION**2
    across = np.linalg.eigvalsh(held)[:, 1] <= SAME_DIRECTION**2
    for number in np.flatnonzero(along | across)[:1]:
        joint, node = sliders.names[on_ground[number]], nodes.names[carrier[number]]
        cause = (
            f"the supports of node {node!r} hold it along the axis" if along[number] else
            f"node {node!r} is free across the axis, a slider on ground needs supports there (fixed or guide_normal)"
        )
        raise NotAllowed("axis", [float(value) for value in axis[number, : truss.dimension]], cause,
                         item=f"slider {joint!r}", joint=joint, nodes=(node,))


def _revolutes(case: TrussCase, truss: ResolvedTruss) -> None:
    revolutes, positions = truss.revolutes, truss.nodes.position_m
    offset = positions[revolutes.journal_node] - positions[revolutes.bearing_node]
    along = (offset * revolutes.axis).sum(axis=1, keepdims=True) * revolutes.axis
    apart = np.linalg.norm(offset - along, axis=1)
    for index in np.flatnonzero(apart > revolutes.radial_clearance_m)[:1]:
        raise NotAllowed(
            "journal_node", case.revolute[index].journal_node,
            f"it is {apart[index]:.6g} m from bearing_node = {case.revolute[index].bearing_node!r}, the clearance is "
            f"radial_clearance_m = {revolutes.radial_clearance_m[index]:g} [m]", **_of_revolute(truss, index),
        )


def joined(truss: ResolvedTruss) -> np.ndarray:
    """Return the pairs of nodes (k, 2) that joints hold together."""
    sliders, revolutes = truss.sliders, truss.revolutes
    return np.concatenate((
        sliders.nodes[sliders.nodes[:, 1] != GROUND],
        np.stack((revolutes.bearing_node, revolutes.journal_node), axis=1),
    ))


def _turned_links(truss: ResolvedTruss, section: str, items: TorsionSprings | LatchHinges) -> None:
    links = truss.links
    if not len(items.links):
        return
    pairs = {frozenset(map(int, pair)) for pair in joined(truss)}
    for index, (one, two) in enumerate(items.links):
        where = f"{section} {items.names[index]!r}"
        if two != GROUND:
            ends = [(int(a), int(b)) for a in links.nodes[one] for b in links.nodes[two]]
            if not any(a == b or frozenset((a, b)) in pairs for a, b in ends):
                raise NotAllowed(
                    "links", [links.names[one], links.names[two]],
                    "the links share no place, neither a node nor a joint between their ends", item=where,
                )
        for link in (one, two):
            if link == GROUND or truss.dimension == 2:
                continue
            start, end = truss.nodes.position_m[links.nodes[link]]
            direction = (end - start) / np.linalg.norm(end - start)
            if np.linalg.norm(np.cross(direction, items.axis[index])) < SAME_DIRECTION:
                raise NotAllowed("axis", [float(value) for value in items.axis[index]],
                                 f"link {links.names[link]!r} lies along it and has no angle about it", item=where)


def supported(truss: ResolvedTruss) -> np.ndarray:
    """Return which nodes (n,) have a support."""
    nodes = truss.nodes
    held, guided = nodes.fixed[:, : truss.dimension].any(axis=1), nodes.guide_normal.any(axis=1)
    return np.asarray(held | guided)


def _supports(truss: ResolvedTruss) -> None:
    names = truss.nodes.names
    held = supported(truss)
    pairs = np.concatenate((truss.links.nodes, truss.springs.nodes, joined(truss)))
    used = held.copy()
    used[pairs.ravel()] = True
    for node in np.flatnonzero(~used)[:1]:
        raise StatejumpError(f"node {names[node]!r} is not allowed", cause="no link, spring, joint or support uses it",
                             nodes=(names[node],))
    if not held.any():
        raise StatejumpError("no node has a support (fixed or guide_normal)", cause="the truss moves as a whole")
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(names), len(names)))
    parts, part_of = connected_components(graph, directed=False)
    held_parts = np.zeros(parts, dtype=bool)
    held_parts[part_of[held]] = True
    if held_parts.all():
        return
    first = [names[int(np.flatnonzero(part_of == part)[0])] for part in range(parts)[: MOST_LISTED + 1]]
    loose = int(np.flatnonzero(~held_parts)[0])
    name = names[int(np.flatnonzero(part_of == loose)[0])]
    raise StatejumpError(
        f"the truss is in {parts} parts, with the nodes {listed(first)} in one each",
        cause=f"that of node {name!r} has no support and no link, spring or joint to a part that has one",
        nodes=(name,),
    )
