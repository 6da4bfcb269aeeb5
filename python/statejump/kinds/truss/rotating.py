# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that rotate."""
from __future__ import annotations

from statejump.kinds.truss.elements.beam import rotated_nodes
from statejump.kinds.truss.elements.body import rotated_by_bodies
from statejump.kinds.truss.sections import TrussSections


def rotating_nodes(case: TrussSections) -> set[str]:
    """Return the names of the nodes that beams, condensed or rigid bodies, hinges or means rotate."""
    dimension = case.truss.dimension
    return rotated_by_parts(case) | {mean.reference for mean in case.mean if mean.turns(dimension)}


def rotated_by_parts(case: TrussSections) -> set[str]:
    """Return the names of the nodes that beams, condensed or rigid bodies, or hinges rotate."""
    found = {name for hinge in case.hinge for name in hinge.nodes} | {rigid.master for rigid in case.rigid}
    found |= {name for rigid in case.rigid if rigid.rotations for name in rigid.nodes}
    return found | rotated_nodes(case.beam, case.truss.dimension) | rotated_by_bodies(case.body)
