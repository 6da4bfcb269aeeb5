# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks between several keys of a truss. Each check raises an error for the first fault and names the item.

The order is: programs, names, references, then geometry and temperatures as arrays. The solver detects mechanisms,
because these depend on the joints in contact.
"""
from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from statejump.core import expansion, thermal
from statejump.core.errors import NotAllowed, StatejumpError
from statejump.kinds.truss.arrays import said
from statejump.kinds.truss.check_geometry import check_geometry
from statejump.kinds.truss.check_means import check_clouds
from statejump.kinds.truss.check_references import check_references
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.references import vector, wrong_vectors
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.rotating import rotating_nodes
from statejump.kinds.truss.sections import Node, TrussSections
from statejump.schema.item_tables import ItemColumns, each, repeated_names, where_wrong

SECTIONS = ("node", "link", "program", "expansion", *(kind.section for kind in (*JOINTS, *ELEMENTS)), "constraint",
            "mean", "drive")


def check(case: TrussSections, resolve: Callable[[], ResolvedTruss]) -> None:
    """Raise StatejumpError for the first fault of a truss. The message does not contain the name of the file.

    :param resolve: returns the truss as arrays, after its references are checked
    """
    if case.tables is not None:
        raise NotAllowed("section [tables]", code="tables_of_case_file")
    _programs(case)
    _expansions(case)
    _names(case)
    _vectors(case)
    check_references(case)
    check_geometry(resolve())
    check_clouds(case.mean, resolve().means, case.truss.dimension)
    if case.motion.displacement_tolerance_m is not None and case.motion.theta != 0.5:
        raise NotAllowed("motion.theta", case.motion.theta, code="theta_without_equal_steps")
    if case.motion.scheme == "regularised":
        _regularised(case)


def _rotations(case: TrussSections) -> None:
    """Check the supports of rotations and the moments of nodes. Only beams, bodies, hinges and means rotate nodes."""
    dimension = case.truss.dimension
    rotating = rotating_nodes(case)
    # A support may prevent a rotation that no beam transmits; a moment there would have no effect.
    touched = {name for beam in case.beam for name in beam.nodes} | {name for body in case.body for name in body.nodes}
    ends = {"fixed_rotations": rotating | touched, "moment_N_m": rotating}

    def wrong(nodes: ItemColumns[Node]) -> np.ndarray:
        given = said(nodes, "moment_N_m")
        for axis in "xyz":
            given |= nodes.texts("fixed_rotations").has(axis)
        return given

    for node in where_wrong(case.node, wrong):
        where: dict[str, Any] = {"item": f"node {node.name!r}", "nodes": (node.name,)}
        for key in ("fixed_rotations", "moment_N_m"):
            if getattr(node, key) and node.name not in ends[key]:
                raise NotAllowed(key, getattr(node, key), code="node_without_rotation", **where)
        if dimension == 2 and set(node.fixed_rotations) - {"z"}:
            raise NotAllowed("fixed_rotations", node.fixed_rotations, code="planar_rotations", **where)
        if node.moment_N_m is not None and len(node.moment_N_m) != (1 if dimension == 2 else 3):
            raise NotAllowed("moment_N_m", node.moment_N_m, code="wrong_dimension_of_moment",
                             numbers="1 number" if dimension == 2 else "3 numbers", dimension=dimension, **where)


def _regularised(case: TrussSections) -> None:
    scheme = "with motion.scheme = 'regularised'"
    for key, usual in (("displacement_tolerance_m", None), ("theta", 0.5), ("restitution", 0.0)):
        if getattr(case.motion, key) != usual:
            raise NotAllowed(f"motion.{key}", getattr(case.motion, key), code="unused_by_scheme", scheme=scheme)
    if case.motion.masses != "lumped":
        raise NotAllowed("motion.masses", case.motion.masses, code="masses_not_lumped", scheme=scheme)
    if case.reduced_settings.sticking == "rigid":
        raise NotAllowed("reduced.sticking", case.reduced_settings.sticking, code="sticking_not_elastic", scheme=scheme)


def _programs(case: TrussSections) -> None:
    for item in case.program:
        try:
            program = item.completed(case.thermal)
            thermal.check(program, section="", returns=case.ending is not None)
        except StatejumpError as refused:
            refused.item = f"program {item.name!r}"
            raise
        lasts = program.cycles * program.period_s
        if abs(lasts - case.duration_s) > thermal.SAME_TIME * case.duration_s:
            raise NotAllowed("period_s", program.period_s, code="program_duration_differs",
                             item=f"program {item.name!r}", cycles=program.cycles, lasts=lasts,
                             wanted_s=case.duration_s)


def _expansions(case: TrussSections) -> None:
    for item in case.expansion:
        try:
            expansion.check(item, section="")
        except StatejumpError as refused:
            refused.item = f"expansion {item.name!r}"
            raise


def _names(case: TrussSections) -> None:
    for section in SECTIONS:
        if not repeated_names(getattr(case, section)):
            continue
        seen: set[str] = set()
        for number, item in enumerate(each(getattr(case, section), "name"), start=1):
            if item.name in seen:
                raise NotAllowed("name", item.name, code="duplicate_name", item=f"{section} {number}", part=section)
            seen.add(item.name)


def _vectors(case: TrussSections) -> None:
    dimension = case.truss.dimension
    keys = (("position_m", "m", False), ("guide_normal", "-", True), ("force_N", "N", False))

    def wrong(nodes: ItemColumns[Node]) -> np.ndarray:
        found = nodes.texts("fixed").has("z") & (dimension == 2)
        for key, _, direction in keys:
            found |= wrong_vectors(nodes, key, dimension, direction)
        return found

    for node in where_wrong(case.node, wrong):
        for key, unit, direction in keys:
            vector(key, getattr(node, key), unit, dimension, direction, item=f"node {node.name!r}", nodes=(node.name,))
        if dimension == 2 and "z" in node.fixed:
            raise NotAllowed("fixed", node.fixed, code="planar_directions", item=f"node {node.name!r}",
                             nodes=(node.name,))
    _rotations(case)
    for kind in (*JOINTS, *ELEMENTS):
        for item in where_wrong(kind.listed(case), partial(kind.may_be_wrong_vectors, dimension=dimension)):
            kind.check_vectors(item, dimension)
    if case.reflector is not None:
        axis = case.reflector.axis
        if len(axis) != dimension or not any(axis):
            raise NotAllowed("reflector.axis", axis, code="reflector_axis", dimension=dimension)
