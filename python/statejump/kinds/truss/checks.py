# SPDX-License-Identifier: GPL-3.0-or-later
"""What can be wrong between several keys of a truss, as one sentence that names the item.

Names and references first, then geometry and temperatures on arrays. Whether the truss is a mechanism
is the solver's to find: it depends on which joints are in contact.
"""
from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Any, Iterable, Iterator, Optional, Sequence

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from statejump.schema.fields import thermal_problem, thermal_range_K
from statejump.kinds.truss.resolved import GROUND, ResolvedTruss, distances

if TYPE_CHECKING:
    from statejump.schema.items import Item
    from statejump.kinds.truss.case import TrussCase

MOST_LISTED = 5
# Sections whose items name nodes: key, least and greatest number of nodes.
_NODES_OF = {"link": (2, 2), "slider": (1, 2), "spring": (2, 2)}
# Directions that differ by less are one: far above rounding, far below what anybody means.
SAME_DIRECTION = 1e-6


class _Problem(Exception):
    """One sentence."""


def problem(case: "TrussCase") -> Optional[str]:
    """Return the first thing that is wrong with a truss as a whole, without the file's name."""
    try:
        _programs(case)
        _names(case)
        _vectors(case)
        _references(case)
        truss = case.resolve()
        _lengths(truss)
        _temperatures(case, truss)
        _sliders(truss)
        _revolutes(case, truss)
        _torsion_springs(truss)
        _supports(truss)
    except _Problem as found:
        return str(found)
    return None


def _lists(case: "TrussCase") -> Iterator[tuple[str, Sequence["Item"]]]:
    for section in ("node", "link", "program", "slider", "revolute", "spring", "torsion_spring"):
        yield section, getattr(case, section)


def _listed(names: Iterable[str]) -> str:
    return ", ".join(repr(name) for name in names)


def _programs(case: "TrussCase") -> None:
    for item, program in zip(case.program, case.programs[1:]):
        found = thermal_problem(program)
        if found is not None:
            raise _Problem(f"program {item.name!r}: {found.replace('thermal.', '')}")
        lasts = program.cycles * program.period_s
        if abs(lasts - case.duration_s) > 1e-9 * case.duration_s:
            raise _Problem(
                f"program {item.name!r}: cycles = {program.cycles} of period_s = {program.period_s!r} are not allowed: "
                f"they last {lasts:g} s and must last {case.duration_s:g} s, as thermal.cycles of thermal.period_s do"
            )


def _names(case: "TrussCase") -> None:
    for section, items in _lists(case):
        seen: set[str] = set()
        for number, item in enumerate(items, start=1):
            if item.name in seen:
                raise _Problem(f"{section} {number}: name = {item.name!r} is not allowed: another {section} has it")
            seen.add(item.name)


def _vector(where: str, key: str, value: Optional[list[float]], unit: str, dimension: int, direction: bool) -> None:
    if value is None:
        return
    if len(value) != dimension:
        raise _Problem(
            f"{where}: {key} = {value} is not allowed: must be {dimension} numbers [{unit}], as truss.dimension is "
            f"{dimension}"
        )
    if direction and not any(value):
        raise _Problem(f"{where}: {key} = {value} is not allowed: must not be zero in every direction")


def _vectors(case: "TrussCase") -> None:
    dimension = case.truss.dimension
    for node in case.node:
        where = f"node {node.name!r}"
        _vector(where, "position_m", node.position_m, "m", dimension, False)
        _vector(where, "guide_normal", node.guide_normal, "-", dimension, True)
        _vector(where, "force_N", node.force_N, "N", dimension, False)
        if dimension == 2 and "z" in node.fixed:
            raise _Problem(f"{where}: fixed = {node.fixed} is not allowed: a planar truss has 'x' and 'y' only")
    for slider in case.slider:
        _vector(f"slider {slider.name!r}", "axis", slider.axis, "-", dimension, True)
    for section in ("revolute", "torsion_spring"):
        for item in getattr(case, section):
            where = f"{section} {item.name!r}"
            if dimension == 2 and item.axis is not None:
                raise _Problem(f"{where}: axis = {item.axis} is not allowed: in a planar truss it is z")
            if dimension == 3 and item.axis is None:
                raise _Problem(f"{where}: axis is missing: a list of 3 numbers is needed in a spatial truss")
            _vector(where, "axis", item.axis, "-", dimension, True)
    if case.reflector is not None:
        axis = case.reflector.axis
        if len(axis) != dimension or not any(axis):
            raise _Problem(
                f"reflector.axis = {axis} is not allowed: must be {dimension} numbers, not zero in every direction"
            )


def _known(where: str, key: str, value: Any, name: str, known: dict[str, Any], what: str) -> None:
    _known_at(f"{where}: {key} = {value!r} is not allowed", name, known, what)


def _known_at(wrong: str, name: str, known: dict[str, Any], what: str) -> None:
    if name in known:
        return
    nearest = difflib.get_close_matches(name, list(known), n=1, cutoff=0.5)
    if nearest:
        hint = f"did you mean {nearest[0]!r}?"
    else:
        shown = _listed(list(known)[:MOST_LISTED]) + (", ..." if len(known) > MOST_LISTED else "")
        hint = f"known are {shown}" if known else f"the file has no section [[{what}]]"
    raise _Problem(f"{wrong}: there is no {what} {name!r}; {hint}")


def _references(case: "TrussCase") -> None:
    nodes = {node.name: node for node in case.node}
    links = {link.name: link for link in case.link}
    programs = {program.name: program for program in case.program}
    for section, (least, most) in _NODES_OF.items():
        for item in getattr(case, section):
            where = f"{section} {item.name!r}"
            if not least <= len(item.nodes) <= most:
                many = "2 nodes" if least == most else "1 node, on ground, or 2 nodes"
                raise _Problem(f"{where}: nodes = {item.nodes} is not allowed: must be {many}")
            for name in item.nodes:
                if name not in nodes:
                    _known(where, "nodes", item.nodes, name, nodes, "node")
            if len(item.nodes) == 2 and item.nodes[0] == item.nodes[1]:
                raise _Problem(f"{where}: nodes = {item.nodes} is not allowed: must be two different nodes")
    for section in ("link", "revolute"):
        for item in getattr(case, section):
            if item.program is not None and item.program not in programs:
                _known(f"{section} {item.name!r}", "program", item.program, item.program, programs, "program")
    for link in case.link:
        if (link.density_kg_per_m3 is None) == (link.mass_kg is None):
            raise _Problem(
                f"link {link.name!r}: density_kg_per_m3 or mass_kg is missing: one of them is needed"
                if link.mass_kg is None else
                f"link {link.name!r}: mass_kg = {link.mass_kg!r} is not allowed: only without density_kg_per_m3"
            )
    for spring in case.spring:
        if spring.preload_N is not None and spring.free_length_m is not None:
            raise _Problem(
                f"spring {spring.name!r}: preload_N = {spring.preload_N!r} is not allowed: only without free_length_m"
            )
    for revolute in case.revolute:
        where = f"revolute {revolute.name!r}"
        for part in ("bearing", "journal"):
            node_key, link_key = f"{part}_node", f"{part}_link"
            node, link = getattr(revolute, node_key), getattr(revolute, link_key)
            if node not in nodes:
                _known(where, node_key, node, node, nodes, "node")
            if link is None:
                # Nothing at hand says how such a part turns.
                if not nodes[node].fixed and nodes[node].guide_normal is None:
                    raise _Problem(
                        f"{where}: {link_key} is missing: without a link the {part} does not turn, so node {node!r} "
                        "must have a support (fixed or guide_normal)"
                    )
                continue
            if link not in links:
                _known(where, link_key, link, link, links, "link")
            if node not in links[link].nodes:
                raise _Problem(
                    f"{where}: {link_key} = {link!r} is not allowed: that link ends at "
                    f"{' and '.join(repr(end) for end in links[link].nodes)}, it must end at {node_key} = {node!r}"
                )
        if revolute.bearing_node == revolute.journal_node:
            raise _Problem(
                f"{where}: journal_node = {revolute.journal_node!r} is not allowed: must be another node than "
                "bearing_node"
            )
        if revolute.bearing_link is not None and revolute.bearing_link == revolute.journal_link:
            raise _Problem(
                f"{where}: journal_link = {revolute.journal_link!r} is not allowed: must be another link than "
                "bearing_link"
            )
    for spring in case.torsion_spring:
        where = f"torsion_spring {spring.name!r}"
        if not 1 <= len(spring.links) <= 2:
            raise _Problem(f"{where}: links = {spring.links} is not allowed: must be 2 links, or 1 against ground")
        for name in spring.links:
            if name not in links:
                _known(where, "links", spring.links, name, links, "link")
        if len(spring.links) == 2 and spring.links[0] == spring.links[1]:
            raise _Problem(f"{where}: links = {spring.links} is not allowed: must be two different links")
    if case.reflector is not None:
        if not case.reflector.nodes:
            raise _Problem("reflector.nodes = [] is not allowed: must be one or more nodes")
        for name in case.reflector.nodes:
            if name not in nodes:
                _known_at("reflector.nodes is not allowed as it is", name, nodes, "node")


def _lengths(truss: ResolvedTruss) -> None:
    for section, items in (("link", truss.links), ("spring", truss.springs)):
        for index in np.flatnonzero(distances(truss.nodes.position_m, items.nodes) == 0)[:1]:
            ends = " and ".join(repr(truss.nodes.names[node]) for node in items.nodes[index])
            raise _Problem(
                f"{section} {items.names[index]!r}: nodes {ends} are at one place, "
                f"{_place(truss, items.nodes[index, 0])}: the {section} has no length"
            )


def _place(truss: ResolvedTruss, node: int) -> str:
    return f"{[float(value) for value in truss.nodes.position_m[node, : truss.dimension]]} m"


def _temperatures(case: "TrussCase", truss: ResolvedTruss) -> None:
    ranges = np.array([thermal_range_K(program) for program in truss.programs])
    links, revolutes = truss.links, truss.revolutes
    for side in (0, 1):
        changes = links.temperature_fraction * ranges[links.program, side]
        for index in np.flatnonzero(1 + links.thermal_expansion_per_K * changes <= 0)[:1]:
            raise _Problem(
                f"link {links.names[index]!r}: thermal_expansion_per_K = "
                f"{links.thermal_expansion_per_K[index]:g} is not allowed: the link has no length left at a "
                f"temperature change of {changes[index]:g} K, {links.temperature_fraction[index]:g} times that of "
                f"program {truss.program_names[links.program[index]]!r}"
            )
        changes = revolutes.temperature_fraction * ranges[revolutes.program, side]
        for part in ("journal", "bearing"):
            expansion = getattr(revolutes, f"{part}_thermal_expansion_per_K")
            for index in np.flatnonzero(1 + expansion * changes <= 0)[:1]:
                raise _Problem(
                    f"revolute {revolutes.names[index]!r}: {part}_thermal_expansion_per_K = {expansion[index]:g} is "
                    f"not allowed: the {part} has no radius left at a temperature change of {changes[index]:g} K"
                )
        for index in np.flatnonzero(~(revolutes.clearance_m(changes) > 0))[:1]:
            raise _Problem(
                f"revolute {revolutes.names[index]!r}: radial_clearance_m = {revolutes.radial_clearance_m[index]:g} "
                "is not allowed: the expansion of journal and bearing closes it at a temperature change of "
                f"{changes[index]:g} K, it must stay above 0 [m] within the program"
            )
    for index in np.flatnonzero(~(revolutes.bearing_radius_m > revolutes.journal_radius_m))[:1]:
        raise _Problem(
            f"revolute {revolutes.names[index]!r}: radial_clearance_m = {revolutes.radial_clearance_m[index]:g} is not "
            f"allowed: too small beside journal_radius_m = {revolutes.journal_radius_m[index]:g} [m], the radii come "
            "out equal"
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
        shown = [float(value) for value in axis[number, : truss.dimension]]
        name = nodes.names[carrier[number]]
        reason = (
            f"the supports of node {name!r} hold it along the axis" if along[number] else
            f"node {name!r} is free across the axis, a slider on ground needs supports there (fixed or guide_normal)"
        )
        raise _Problem(f"slider {sliders.names[on_ground[number]]!r}: axis = {shown} is not allowed: {reason}")


def _revolutes(case: "TrussCase", truss: ResolvedTruss) -> None:
    revolutes, positions = truss.revolutes, truss.nodes.position_m
    offset = positions[revolutes.journal_node] - positions[revolutes.bearing_node]
    along = (offset * revolutes.axis).sum(axis=1, keepdims=True) * revolutes.axis
    apart = np.linalg.norm(offset - along, axis=1)
    for index in np.flatnonzero(apart > revolutes.radial_clearance_m)[:1]:
        raise _Problem(
            f"revolute {revolutes.names[index]!r}: journal_node = {case.revolute[index].journal_node!r} is not "
            f"allowed: it is {apart[index]:.6g} m from bearing_node = {case.revolute[index].bearing_node!r}, the clearance is "
            f"radial_clearance_m = {revolutes.radial_clearance_m[index]:g} [m]"
        )


def joined(truss: ResolvedTruss) -> np.ndarray:
    """Return the pairs of nodes (k, 2) that joints hold together."""
    sliders, revolutes = truss.sliders, truss.revolutes
    return np.concatenate((
        sliders.nodes[sliders.nodes[:, 1] != GROUND],
        np.stack((revolutes.bearing_node, revolutes.journal_node), axis=1),
    ))


def _torsion_springs(truss: ResolvedTruss) -> None:
    springs, links = truss.torsion_springs, truss.links
    if not len(springs.links):
        return
    pairs = {frozenset(map(int, pair)) for pair in joined(truss)}
    for index, (one, two) in enumerate(springs.links):
        where = f"torsion_spring {springs.names[index]!r}"
        if two != GROUND:
            ends = [(int(a), int(b)) for a in links.nodes[one] for b in links.nodes[two]]
            if not any(a == b or frozenset((a, b)) in pairs for a, b in ends):
                raise _Problem(
                    f"{where}: links = {[links.names[one], links.names[two]]} is not allowed: the links share no "
                    "place, neither a node nor a joint between their ends"
                )
        for link in (one, two):
            if link == GROUND or truss.dimension == 2:
                continue
            start, end = truss.nodes.position_m[links.nodes[link]]
            direction = (end - start) / np.linalg.norm(end - start)
            if np.linalg.norm(np.cross(direction, springs.axis[index])) < SAME_DIRECTION:
                raise _Problem(
                    f"{where}: axis = {[float(value) for value in springs.axis[index]]} is not allowed: link "
                    f"{links.names[link]!r} lies along it and has no angle about it"
                )


def supported(truss: ResolvedTruss) -> np.ndarray:
    """Return which nodes (n,) have a support."""
    nodes = truss.nodes
    return nodes.fixed[:, : truss.dimension].any(axis=1) | nodes.guide_normal.any(axis=1)


def _supports(truss: ResolvedTruss) -> None:
    count = len(truss.nodes.names)
    held = supported(truss)
    pairs = np.concatenate((truss.links.nodes, truss.springs.nodes, joined(truss)))
    used = held.copy()
    used[pairs.ravel()] = True
    for node in np.flatnonzero(~used)[:1]:
        raise _Problem(
            f"node {truss.nodes.names[node]!r} is not allowed: no link, spring, joint or support uses it"
        )
    if not held.any():
        raise _Problem("no node has a support (fixed or guide_normal): the truss moves as a whole")
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    parts, part_of = connected_components(graph, directed=False)
    held_parts = np.zeros(parts, dtype=bool)
    held_parts[part_of[held]] = True
    if held_parts.all():
        return
    first = [int(np.flatnonzero(part_of == part)[0]) for part in range(parts)][: MOST_LISTED + 1]
    loose = int(np.flatnonzero(~held_parts)[0])
    more = ", ..." if parts > MOST_LISTED else ""
    name = truss.nodes.names[int(np.flatnonzero(part_of == loose)[0])]
    raise _Problem(
        f"the truss is in {parts} parts, with the nodes "
        f"{_listed(truss.nodes.names[node] for node in first[:MOST_LISTED])}{more} in one each: that of node {name!r} "
        "has no support and no link, spring or joint to a part that has one"
    )
