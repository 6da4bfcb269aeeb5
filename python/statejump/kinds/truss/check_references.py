# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of references between the items of a truss: names exist, ends match, keys do not contradict each other."""
from __future__ import annotations

import difflib
from collections.abc import Collection, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from statejump.core.errors import ABSENT, MissingKey, NotAllowed
from statejump.kinds.truss import check_mechanism
from statejump.kinds.truss.arrays import having, said
from statejump.kinds.truss.check_means import check_means
from statejump.kinds.truss.constraints import LEAST_COEFFICIENT, TURNS
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.elements.beam import BEAM
from statejump.kinds.truss.elements.body import BODY, columns_of, names_of_points
from statejump.kinds.truss.elements.protocol import ElementType
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.protocol import JointType
from statejump.kinds.truss.references import Around, known_name, known_nodes, wrong_ends
from statejump.kinds.truss.rotating import rotated_by_parts, rotating_nodes
from statejump.kinds.truss.sections import Link, TrussSections
from statejump.schema.item_tables import NONE, UNKNOWN, ItemColumns, ItemIndex, by_name, each, where_wrong

_WITH_TEMPERATURE: list[JointType[Any, Any] | ElementType[Any, Any]] = [
    *(joint for joint in JOINTS if joint.has_temperature),
    *(element for element in ELEMENTS if element.has_temperature)]


def check_references(case: TrussSections) -> None:
    """Raise StatejumpError for the first reference to a name that does not exist or does not match."""
    nodes, links = by_name(case.node), by_name(case.link)
    node_places, link_places = ItemIndex(case.node), ItemIndex(case.link)
    for link in where_wrong(case.link, lambda items: wrong_ends(node_places.of(items, "nodes"), 2)):
        known_nodes(link.nodes, 2, nodes, {"item": f"link {link.name!r}"})
    _programs(case)
    _expansions(case)
    _members(case)
    _alternatives(case)
    rotating = rotating_nodes(case)
    turns, rotated = _held(case), node_places.called(sorted(rotating))
    turns[rotated[rotated != UNKNOWN]] = True
    around = Around(node_places, link_places, turns, node_places.of(case.link, "nodes"))
    for kind in (*JOINTS, *ELEMENTS):
        for item in where_wrong(kind.listed(case), partial(kind.may_be_wrong_references, around=around)):
            kind.check_references(item, nodes, links, rotating)
    check_constraints(case, nodes, rotating)
    check_means(case.mean, nodes, case.truss.dimension, rotated_by_parts(case))
    check_mechanism.check(case, links)
    if case.reflector is not None:
        if not case.reflector.nodes and not case.reflector.points:
            raise NotAllowed("reflector.nodes", [], code="no_nodes")
        for place in np.flatnonzero(node_places.called(case.reflector.nodes) == UNKNOWN):
            known_name("reflector.nodes", ABSENT, case.reflector.nodes[place], nodes, "node", beside="as it is")
        points = dict.fromkeys(name for body in case.body for name in names_of_points(body))
        for point in case.reflector.points:
            known_name("reflector.points", case.reflector.points, point, points, "point of a body")


def _held(case: TrussSections) -> np.ndarray:
    """Return which nodes have a support."""
    found = said(case.node, "guide_normal")
    for axis in "xyz":
        found |= having(case.node, "fixed", axis)
    return found


def _followers(case: TrussSections) -> Iterator[tuple[Any, dict[str, Any], bool]]:
    """Yield the items that have a temperature: item, its name in messages, and whether it expands."""
    yield from ((link, {"item": f"link {link.name!r}"}, True)
                for link in each(case.link, "name", "program", "temperature_fraction"))
    yield from ((item, joint.where(item.name), joint.expands(item)) for joint in _WITH_TEMPERATURE
                for item in joint.listed(case))


def _programs(case: TrussSections) -> None:
    programs, places = by_name(case.program), ItemIndex(case.program)
    followers: tuple[tuple[str, Any, Any], ...] = (
        ("program", case.link, lambda name: {"item": f"link {name!r}"}),
        *(("program", joint.listed(case), joint.where) for joint in _WITH_TEMPERATURE),
        ("gradient_program", case.beam, BEAM.where))

    def unknown(key: str, items: ItemColumns[Any]) -> np.ndarray:
        return places.of(items, key) == UNKNOWN

    for body in case.body:
        for name in body.programs or ():
            known_name("programs", body.programs, name, programs, "program", **BODY.where(body.name))
    for key, items, where in followers:
        for item in where_wrong(items, partial(unknown, key)):
            name = getattr(item, key)
            if name is not None:
                known_name(key, name, name, programs, "program", **where(item.name))


def _expansions(case: TrussSections) -> None:
    """Check that every link has a coefficient of expansion, or refers to an [[expansion]]."""
    expansions, places = by_name(case.expansion), ItemIndex(case.expansion)

    def wrong(links: ItemColumns[Link]) -> np.ndarray:
        named = places.of(links, "expansion")
        return np.asarray((named == UNKNOWN) | ((named != NONE) == said(links, "thermal_expansion_per_K")))

    for link in where_wrong(case.link, wrong):
        where = {"item": f"link {link.name!r}"}
        if link.expansion is not None and link.thermal_expansion_per_K is not None:
            raise NotAllowed("thermal_expansion_per_K", link.thermal_expansion_per_K, code="conflicting_key",
                             other="expansion", **where)
        if link.expansion is not None:
            known_name("expansion", link.expansion, link.expansion, expansions, "expansion", **where)
        elif link.thermal_expansion_per_K is None:
            raise MissingKey("thermal_expansion_per_K", code="expansion_of_link_missing", **where)


def _members(case: TrussSections) -> None:
    """Check the histories of members: each link has a column or names a program; each column belongs to a member."""
    members = case.thermal.members
    if members is None:
        return
    file, columns = members.source or ABSENT, set(members.names)
    for item, where, expands in _followers(case):
        where = {"item": where["item"]}
        if item.name not in columns:
            if item.program is None and expands:
                near = difflib.get_close_matches(item.name, members.names, n=1, cutoff=0.8)
                raise NotAllowed("thermal.members_file", file, code="no_column_of_item",
                                 remedy=f"is {near[0]!r} meant?" if near else "or name a program for it",
                                 part=where["item"])
            continue
        if item.program is not None:
            raise NotAllowed("program", item.program, code="temperature_from_members_file", **where)
        if item.temperature_fraction != 1:
            raise NotAllowed("temperature_fraction", item.temperature_fraction, code="temperature_from_members_file",
                             **where)
    of_bodies = _columns_of_bodies(case, columns, file)
    known = {*(item.name for item, _, _ in _followers(case)), *of_bodies}
    sections = ("link", *(joint.section for joint in _WITH_TEMPERATURE), *(("pattern of a body",) if of_bodies else ()))
    kinds = " and ".join(f"no {section}" for section in sections)
    for name in members.names:
        if name not in known:
            raise NotAllowed("thermal.members_file", file, code="column_of_several", column=name, kinds=kinds)


def _columns_of_bodies(case: TrussSections, columns: set[str], file: Any) -> set[str]:
    """Check that each pattern of a body has a column or a program; return the possible names of their columns."""
    known: set[str] = set()
    for body in case.body:
        where = BODY.where(body.name)
        for names in columns_of(body):
            known.update(names)
            if not columns.intersection(names):
                if body.programs is None:
                    raise NotAllowed("thermal.members_file", file, code="no_column_of_item",
                                     part=f"pattern {names[0]!r}", remedy="or name programs for the body")
                continue
            if body.programs is not None:
                raise NotAllowed("programs", body.programs, code="temperature_from_members_file", **where)
            if body.temperature_fractions is not None:
                raise NotAllowed("temperature_fractions", body.temperature_fractions,
                                 code="temperature_from_members_file", **where)
    return known


def _alternatives(case: TrussSections) -> None:
    for link in where_wrong(case.link, lambda links: said(links, "density_kg_per_m3") & said(links, "mass_kg")):
        if link.density_kg_per_m3 is not None and link.mass_kg is not None:
            raise NotAllowed("mass_kg", link.mass_kg, code="conflicting_key", other="density_kg_per_m3",
                             item=f"link {link.name!r}")
    for element in ELEMENTS:
        for item in where_wrong(element.listed(case), element.may_be_wrong_keys):
            element.check_keys(item)


def check_constraints(case: TrussSections, nodes: Mapping[str, Any], rotating: Collection[str]) -> None:
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
        if case.truss.dimension == 2 and set(item.directions) & {"z", "Rx", "Ry"}:
            raise NotAllowed("directions", item.directions, code="planar_directions", **where)
        terms = list(zip(item.nodes, item.directions))
        for term in terms:
            if terms.count(term) > 1:
                raise NotAllowed("nodes", item.nodes, code="constraint_term_twice", node=term[0], direction=term[1],
                                 **where)
        for name, direction in terms:
            if direction in TURNS and name not in rotating:
                raise NotAllowed("nodes", name, code="node_without_rotation", item=where["item"],
                                 nodes=(name,))
        for value, direction in zip(item.coefficients, item.directions):
            beside = (abs(one) for one, of in zip(item.coefficients, item.directions)
                      if (of in TURNS) == (direction in TURNS))
            if value == 0 or abs(value) < LEAST_COEFFICIENT * max(beside):
                raise NotAllowed("coefficients", value, code="constraint_coefficient", **where)
