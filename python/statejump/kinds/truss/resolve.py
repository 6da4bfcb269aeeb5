# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of a case of kind ``truss`` to arrays: names become indices, and each key becomes an array."""
from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.core.expansion import followed
from statejump.core.thermal import MemberProgram
from statejump.kinds.truss.arrays import (
    References, column, columns, distances, given_or, having, in_space, names, pairs, texts, unit, values, vectors,
)
from statejump.kinds.truss.constraints import resolve_constraints
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.elements.body import points_called
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.means import resolve_means
from statejump.kinds.truss.mechanism import resolve_bodies, resolve_drives, weights_N
from statejump.kinds.truss.resolved import Links, Nodes, ReflectorSurface, ResolvedTruss
from statejump.kinds.truss.rotating import rotated_by_parts, rotating_nodes
from statejump.kinds.truss.sections import TrussSections, TrussThermal
from statejump.schema.item_tables import ItemColumns, ItemIndex, once


def resolve(case: TrussSections) -> ResolvedTruss:
    """Return the arrays of a case. All references must be valid; ``checks`` verifies them."""
    dimension = case.truss.dimension
    node_places, link_places = ItemIndex(case.node), ItemIndex(case.link)
    positions = vectors(case.node, "position_m", dimension)

    members = case.thermal.members
    member_number = {} if members is None else {
        name: index for index, name in enumerate(members.names, start=1 + len(case.program))
    }

    known = References(dimension, positions, node_places, link_places, ItemIndex(case.program), member_number)

    nodes = _nodes(case, positions)
    program_names = ("thermal", *names(case.program), *(() if members is None else members.names))
    warmed = link_temperatures(case, known.programs_of(case.link), program_names)
    links = _links(case, pairs(case.link, "nodes", node_places), positions, warmed)
    bodies = resolve_bodies(case.link, links.stress_free_length_m, links.mass_kg)
    gravity = in_space(case.truss.gravity_m_per_s2, dimension)
    elements = {element.section: element.resolve(element.listed(case), known) for element in ELEMENTS}
    if gravity.any():
        weights = np.zeros((len(positions), 6))
        weights[:, :3] = weights_N(gravity, links.nodes, links.mass_kg, bodies, nodes.mass_kg)
        for element in ELEMENTS:
            weights += element.weights(elements[element.section], gravity, len(positions))
        nodes = replace(nodes, force_N=nodes.force_N + weights[:, :3], moment_N_m=nodes.moment_N_m + weights[:, 3:])

    means = resolve_means(case.mean, node_places, positions, dimension)
    reflector = None
    if case.reflector is not None:
        reflector = ReflectorSurface(
            nodes=np.concatenate((
                node_places.called(case.reflector.nodes).astype(int),
                len(positions) + np.array(points_called(case.body, case.reflector.points), dtype=int))),
            axis=unit(in_space(case.reflector.axis, dimension)),
            focal_length_m=case.reflector.focal_length_m,
        )
    return ResolvedTruss(
        name=case.name, dimension=dimension, nodes=nodes, links=links, bodies=bodies,
        joints={joint.section: joint.resolve(joint.listed(case), known) for joint in JOINTS},
        elements=elements,
        constraints=resolve_constraints(case.constraint, node_places) + means.constraints, means=means,
        drives=resolve_drives(case.drive, known),
        programs=warmed.programs,
        program_names=warmed.program_names,
        reflector=reflector,
        sticking=case.reduced_settings.sticking,
        start_friction=case.start.friction,
        free=case.truss.free,
        types=JOINTS,
        element_types=ELEMENTS,
    )


def _nodes(case: TrussSections, positions: np.ndarray) -> Nodes:
    dimension = case.truss.dimension
    fixed = np.stack([having(case.node, "fixed", axis) for axis in "xyz"], axis=1)
    fixed[:, dimension:] = True
    return Nodes(
        names=names(case.node),
        position_m=positions,
        fixed=fixed,
        guide_normal=unit(vectors(case.node, "guide_normal", dimension)),
        force_N=vectors(case.node, "force_N", dimension),
        mass_kg=column(case.node, "mass_kg"),
        **_rotations(case),
    )


def _rotations(case: TrussSections) -> dict[str, np.ndarray]:
    """Return supports of rotations and moments of the nodes."""
    count = len(case.node)
    if not (case.beam or case.body or case.rigid or case.hinge or case.mean):
        none = np.broadcast_to(0.0, (count, 3))
        return {"fixed_rotations": none != 0, "moment_N_m": none, "rotates": none[:, 0] != 0}
    clamped = np.stack([having(case.node, "fixed_rotations", axis) for axis in "xyz"], axis=1)
    moment = np.zeros((count, 3))
    for index, given in enumerate(values(case.node, "moment_N_m")):
        if given is not None:
            moment[index, 3 - len(given):] = given
    if case.truss.dimension == 2:
        clamped[:, :2] = True
    numbers = {name: number for number, name in enumerate(names(case.node))} if case.mean else {}
    rotated = rotated_by_parts(case) if case.mean else set()
    for mean in case.mean:  # nothing resists the other rotations of its reference
        if mean.reference not in rotated and (turns := mean.turns(case.truss.dimension)):
            clamped[numbers[mean.reference]] |= [axis not in turns for axis in "xyz"]
    rotates = np.isin(names(case.node), list(rotating_nodes(case)))
    return {"fixed_rotations": clamped, "moment_N_m": moment, "rotates": rotates}


def _links(case: TrussSections, nodes: np.ndarray, positions: np.ndarray, warmed: LinkTemperatures) -> Links:
    length = given_or(column(case.link, "stress_free_length_m"), distances(positions, nodes))
    link = columns(
        case.link, "young_modulus_Pa", "cross_section_area_m2", "thermal_expansion_per_K", "poisson_ratio",
    )
    if warmed.expanding.any():
        link["thermal_expansion_per_K"] = np.where(
            warmed.expanding, warmed.largest_per_K, link["thermal_expansion_per_K"])
    area = link["cross_section_area_m2"]
    return Links(
        names=names(case.link), nodes=nodes, stress_free_length_m=length,
        mass_kg=given_or(column(case.link, "mass_kg"), column(case.link, "density_kg_per_m3") * area * length),
        program=warmed.program, temperature_fraction=warmed.temperature_fraction, shown_program=warmed.shown_program,
        shown_fraction=warmed.shown_fraction, **link,
        second_moment_of_area_m4=once(given_or(column(case.link, "second_moment_of_area_m4"), area**2 / 12)),
        ends=texts(case.link, "ends"), yield_strength_Pa=given_or(column(case.link, "yield_strength_Pa"), inf),
    )


@dataclass(frozen=True)
class LinkTemperatures:
    """Programs of a truss, and the index of the program of each link (m); see :mod:`statejump.core.expansion`."""

    programs: tuple[TrussThermal | MemberProgram, ...]
    program_names: tuple[str, ...]
    program: np.ndarray
    temperature_fraction: np.ndarray
    expanding: np.ndarray  # bool: it has an [[expansion]]
    largest_per_K: np.ndarray  # of the [[expansion]], else 0
    shown_program: np.ndarray  # program of the temperature itself
    shown_fraction: np.ndarray


def link_temperatures(case: TrussSections, shown: np.ndarray, names: tuple[str, ...]) -> LinkTemperatures:
    """Return the programs of the links. All references must be valid; ``checks`` verifies them.

    :param shown: index of the temperature program of every link
    :param names: names of the programs of the case
    :raises NotAllowed: a program leaves the temperatures of an expansion table, or is not piecewise linear
    """
    programs, named = case.programs, list(names)
    expansions = {expansion.name: expansion for expansion in case.expansion}
    fraction = column(case.link, "temperature_fraction")
    if isinstance(case.link, ItemColumns) and not case.link.texts("expansion").given().any():
        none = np.broadcast_to(0.0, len(case.link))
        return LinkTemperatures(tuple(programs), names, shown, fraction, none != 0, none, shown, fraction)
    program, own_fraction, largest = shown.copy(), fraction.copy(), np.zeros(len(case.link))
    made: dict[tuple[int, float, str], int] = {}
    for index, named_expansion in enumerate(values(case.link, "expansion")):
        if named_expansion is None:
            continue
        expansion, number = expansions[named_expansion], int(shown[index])
        key = number, float(fraction[index]), named_expansion
        if key not in made:
            followed_program = programs[number]
            try:
                strain = followed(expansion, followed_program, followed_program.period_s, key[1])
            except NotAllowed as refused:
                refused.item = f"expansion {expansion.name!r}, link {case.link[index].name!r}"
                raise
            made[key] = len(programs)
            programs.append(strain)
            named.append(f"{expansion.name} of {names[number]}")
        program[index], own_fraction[index], largest[index] = made[key], 1.0, expansion.largest_per_K
    return LinkTemperatures(tuple(programs), tuple(named), program, own_fraction, program != shown, largest, shown,
                            fraction)
