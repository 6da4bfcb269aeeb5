# SPDX-License-Identifier: GPL-3.0-or-later
"""What items of a truss say of each other: names that are there, ends that fit, keys that exclude each other."""
from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from statejump.core.errors import ABSENT, MissingKey, NotAllowed

if TYPE_CHECKING:
    from statejump.kinds.truss.case import LatchHinge, Revolute, TrussCase, TrussTorsionSpring

MOST_LISTED = 5
# Sections whose items name nodes: least and greatest number of nodes.
_NODES_OF = {"link": (2, 2), "slider": (1, 2), "spring": (2, 2)}


def check_references(case: TrussCase) -> None:
    """Raise StatejumpError for the first name that is not there or does not fit."""
    nodes = {node.name: node for node in case.node}
    links = {link.name: link for link in case.link}
    _nodes(case, nodes)
    _programs(case)
    _members(case)
    _alternatives(case)
    for revolute in case.revolute:
        _revolute(revolute, nodes, links)
    for section in ("torsion_spring", "latch_hinge"):
        _turned_links(section, getattr(case, section), links)
    if case.reflector is not None:
        if not case.reflector.nodes:
            raise NotAllowed("reflector.nodes", [], "must be one or more nodes")
        for name in case.reflector.nodes:
            known_name("reflector.nodes", ABSENT, name, nodes, "node", beside="as it is")


def listed(names: list[str]) -> str:
    """Return the first names as a sentence lists them."""
    return ", ".join(repr(name) for name in names[:MOST_LISTED]) + (", ..." if len(names) > MOST_LISTED else "")


def known_name(key: str, value: Any, name: str, known: Mapping[str, Any], what: str, **where: Any) -> None:
    """Raise NotAllowed for a name that is not known; its remedy is the nearest one."""
    if name in known:
        return
    nearest = difflib.get_close_matches(name, list(known), n=1, cutoff=0.5)
    if nearest:
        remedy = f"did you mean {nearest[0]!r}?"
    else:
        remedy = f"known are {listed(list(known))}" if known else f"the file has no section [[{what}]]"
    raise NotAllowed(key, value, f"there is no {what} {name!r}", remedy=remedy,
                     nodes=(name,) if what == "node" else (), **where)


def _nodes(case: TrussCase, nodes: Mapping[str, Any]) -> None:
    for section, (least, most) in _NODES_OF.items():
        for item in getattr(case, section):
            where: dict[str, Any] = {
                "item": f"{section} {item.name!r}", "joint": item.name if section == "slider" else None,
            }
            if not least <= len(item.nodes) <= most:
                many = "2 nodes" if least == most else "1 node, on ground, or 2 nodes"
                raise NotAllowed("nodes", item.nodes, f"must be {many}", **where)
            for name in item.nodes:
                if name not in nodes:
                    known_name("nodes", item.nodes, name, nodes, "node", **where)
            if len(item.nodes) == 2 and item.nodes[0] == item.nodes[1]:
                raise NotAllowed("nodes", item.nodes, "must be two different nodes", **where)


def _programs(case: TrussCase) -> None:
    programs = {program.name: program for program in case.program}
    for section in ("link", "revolute"):
        for item in getattr(case, section):
            if item.program is not None and item.program not in programs:
                known_name("program", item.program, item.program, programs, "program", item=f"{section} {item.name!r}",
                           joint=item.name if section == "revolute" else None)


def _members(case: TrussCase) -> None:
    """Every link has a column of the histories of members or names a program; every column is of a member."""
    members = case.thermal.members
    if members is None:
        return
    file, columns = members.source or ABSENT, set(members.names)
    for section in ("link", "revolute"):
        for item in getattr(case, section):
            where = {"item": f"{section} {item.name!r}"}
            if item.name not in columns:
                expands = section == "link" or item.journal_thermal_expansion_per_K or (
                    item.bearing_thermal_expansion_per_K)
                if item.program is None and expands:
                    near = difflib.get_close_matches(item.name, members.names, n=1, cutoff=0.8)
                    raise NotAllowed("thermal.members_file", file, f"it has no column of {section} {item.name!r}",
                                     remedy=f"is {near[0]!r} meant?" if near else "or name a program for it")
                continue
            if item.program is not None:
                raise NotAllowed("program", item.program, "thermal.members_file has its temperature", **where)
            if item.temperature_fraction != 1:
                raise NotAllowed("temperature_fraction", item.temperature_fraction,
                                 "thermal.members_file has its temperature", **where)
    known = {item.name for item in (*case.link, *case.revolute)}
    for name in members.names:
        if name not in known:
            raise NotAllowed("thermal.members_file", file, f"its column {name!r} is of no link and no revolute")


def _alternatives(case: TrussCase) -> None:
    for link in case.link:
        if link.density_kg_per_m3 is not None and link.mass_kg is not None:
            raise NotAllowed("mass_kg", link.mass_kg, "only without density_kg_per_m3", item=f"link {link.name!r}")
    for spring in case.spring:
        if spring.preload_N is not None and spring.free_length_m is not None:
            raise NotAllowed("preload_N", spring.preload_N, "only without free_length_m",
                             item=f"spring {spring.name!r}")


def _revolute(revolute: Revolute, nodes: Mapping[str, Any], links: Mapping[str, Any]) -> None:
    where = {"item": f"revolute {revolute.name!r}", "joint": revolute.name}
    for part in ("bearing", "journal"):
        node_key, link_key = f"{part}_node", f"{part}_link"
        node, link = getattr(revolute, node_key), getattr(revolute, link_key)
        known_name(node_key, node, node, nodes, "node", **where)
        if link is None:
            # Nothing at hand says how such a part turns.
            if not nodes[node].fixed and nodes[node].guide_normal is None:
                raise MissingKey(
                    link_key, f"without a link the {part} does not turn, so node {node!r} must have a support "
                    "(fixed or guide_normal)", nodes=(node,), **where,
                )
            continue
        known_name(link_key, link, link, links, "link", **where)
        if node not in links[link].nodes:
            ends = " and ".join(repr(end) for end in links[link].nodes)
            raise NotAllowed(link_key, link, f"that link ends at {ends}, it must end at {node_key} = {node!r}", **where)
    if revolute.bearing_node == revolute.journal_node:
        raise NotAllowed("journal_node", revolute.journal_node, "must be another node than bearing_node", **where)
    if revolute.bearing_link is not None and revolute.bearing_link == revolute.journal_link:
        raise NotAllowed("journal_link", revolute.journal_link, "must be another link than bearing_link", **where)


def _turned_links(section: str, items: Iterable[TrussTorsionSpring | LatchHinge], links: Mapping[str, Any]) -> None:
    for item in items:
        where: dict[str, Any] = {
            "item": f"{section} {item.name!r}", "joint": None if section == "torsion_spring" else item.name,
        }
        if not 1 <= len(item.links) <= 2:
            raise NotAllowed("links", item.links, "must be 2 links, or 1 against ground", **where)
        for name in item.links:
            known_name("links", item.links, name, links, "link", **where)
        if len(item.links) == 2 and item.links[0] == item.links[1]:
            raise NotAllowed("links", item.links, "must be two different links", **where)
