# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes whose elements hang slack within the play of joints. No model determines positions of such nodes."""
from __future__ import annotations

import numpy as np

from statejump.core.notes import Note
from statejump.core.run import Run
from statejump.kinds.truss.arrays import GROUND
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.round_parts import RoundParts
from statejump.kinds.truss.notes import listed
from statejump.kinds.truss.resolved import ResolvedTruss

# Fraction of the largest force that counts as zero. An element without contact has up to 1e-9 of it in the solver:
# rounding of coordinates times stiffness. Comparisons resolve 1e-4 of it.
NO_FORCE = 1e-6


def sentence(case: TrussCase, hung: np.ndarray) -> tuple[str, ...]:
    """Return a sentence about the nodes that hang slack at a sample."""
    hung_nodes = np.flatnonzero(hung.any(axis=0))
    names = [repr(case.node[node].name) for node in hung_nodes]
    if not names:
        return ()
    named = f"node{'s' if len(names) > 1 else ''} {listed(names)}"
    return (Note("slack_not_compared", named=named, nodes=tuple(case.node[node].name for node in hung_nodes)),)


def hanging(case: TrussCase, run: Run, least_force_N: float) -> np.ndarray:
    """Return for each sample and node (samples, nodes) whether the node hangs slack.

    A node hangs slack if its links carry no force and the items that hold it are fewer than its directions of motion. A
    link does not hold a node if its other end hangs slack. A joint with clearance does not hold a node if its contact
    carries no force. A group of slack links is not recognised if each of its nodes has as many links as directions.

    :param least_force_N: lower bound of the largest force, which forces are compared with
    """
    truss = case.resolve()
    ends, force = truss.links.nodes, np.abs(run.links["axial_force_N"].values)
    none = NO_FORCE * max(float(force.max(initial=0.0)), least_force_N)
    holding = np.zeros((len(force), len(truss.nodes.names)), dtype=int)
    if not _pins_hold(truss, run, none, holding):
        return np.zeros(holding.shape, dtype=bool)
    holding += _others_hold(truss)
    idle, found = np.ones(holding.shape, dtype=bool), np.zeros(holding.shape, dtype=bool)
    for side in (0, 1):
        np.logical_and.at(idle.T, ends[:, side], force.T <= none)
    while True:
        links = np.zeros(holding.shape, dtype=int)
        for side in (0, 1):
            np.add.at(links.T, ends[:, side], ~found[:, ends[:, 1 - side]].T)
        more = idle & (holding + links < truss.dimension)
        if (more == found).all():
            return found
        found = more


def _pins_hold(truss: ResolvedTruss, run: Run, none_N: float, holding: np.ndarray) -> bool:
    """Add to ``held`` the directions in which joints with clearance hold nodes (samples, nodes). Return whether a joint
    carries no force at a sample."""
    place, idle = 0, False
    for joint in JOINTS:
        if not joint.has_contacts:
            continue
        joints = truss.joints[joint.section]
        columns = slice(place, place + len(joints.names))
        place += len(joints.names)
        if isinstance(joint, RoundParts) and len(joints.names):
            carries = np.linalg.norm(run.contacts["normal_force_N"].values[:, columns], axis=2) > none_N
            for nodes in joint.joined(joints).T:
                np.add.at(holding.T, nodes, truss.dimension * carries.T)
            idle = idle or not carries.all()
    return idle


def _others_hold(truss: ResolvedTruss) -> np.ndarray:
    """Return the number of directions in which supports, elements, torsional items and joints without clearance hold
    each node. Each of the last three counts as holding it in all directions."""
    d = truss.dimension
    found = truss.nodes.fixed[:, :d].sum(axis=1) + truss.nodes.guide_normal.any(axis=1)
    turned = [*(element.torsion(truss.elements[element.section]).links for element in ELEMENTS),
              *(joint.torsion(truss.joints[joint.section]).links for joint in JOINTS)]
    links = np.concatenate([one.ravel() for one in turned]).astype(int)
    np.add.at(found, truss.links.nodes[links[links != GROUND]].ravel(), d)
    for ends in truss.ends()[1:]:
        np.add.at(found, ends.ravel(), d)
    for joint in JOINTS:
        if not isinstance(joint, RoundParts):
            joints = truss.joints[joint.section]
            np.add.at(found, joint.place_nodes(truss, joints).astype(int), d)
            np.add.at(found, joint.joined(joints).ravel().astype(int), d)
    return np.asarray(found)
