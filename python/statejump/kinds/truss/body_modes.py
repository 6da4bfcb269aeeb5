# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixed-interface modes of condensed bodies (Craig-Bampton) as further dofs of a linearised truss.

The stiffness couples modes to no node, so the engine needs none of them for equilibria. The mass couples them to the
interface nodes. The frame of a body does not change the coordinates of its modes.
"""
from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import bmat, csr_matrix, hstack

from statejump.core.notes import Note
from statejump.kinds.truss.elements.body import Bodies
from statejump.kinds.truss.resolved import ResolvedTruss


def with_modes(found: dict[str, Any], truss: ResolvedTruss) -> dict[str, Any]:
    """Return stiffness, mass, constraints and ``of_nodes`` with a dof for each mode, behind the other dofs."""
    bodies: Bodies = truss.elements["body"]
    stiffness, mass = found["stiffness_N_per_m"].tocsr(), found["mass_kg"].tocsr()
    of_nodes, constraints = found["of_nodes"].tocsr(), found["constraints"].tocsr()
    for index, content in enumerate(bodies.contents):
        if content.modes == 0 or content.mass is None:
            continue
        own = content.interface_dofs
        rows = _rows(bodies, index, len(truss.nodes.names))
        axes = np.kron(np.eye(own // 3), bodies.placed[index].axes)
        coupling = of_nodes[rows].T @ csr_matrix(axes @ content.mass[:own, own:])
        modal = bodies.stiffness_factor[index] * content.stiffness[own:, own:]
        none = csr_matrix(coupling.shape)
        stiffness = bmat([[stiffness, none], [none.T, csr_matrix(modal)]], format="csr")
        mass = bmat([[mass, coupling], [coupling.T, csr_matrix(content.mass[own:, own:])]], format="csr")
        of_nodes, constraints = (hstack([one, csr_matrix((one.shape[0], content.modes))], format="csr")
                                 for one in (of_nodes, constraints))
    return {**found, "stiffness_N_per_m": stiffness, "mass_kg": mass, "of_nodes": of_nodes, "constraints": constraints}


def _rows(bodies: Bodies, index: int, nodes: int) -> list[int]:
    """Return the rows of ``of_nodes`` of the dofs of a body."""
    return [3 * (int(node) + (nodes if turned else 0)) + axis
            for node, dofs in zip(bodies.nodes[index], bodies.contents[index].node_freedoms)
            for turned in range(int(dofs) // 3) for axis in range(3)]


def without_modes(truss: ResolvedTruss) -> tuple[Note, ...]:
    """Return notes about bodies whose modes a run in motion does not have."""
    bodies: Bodies = truss.elements["body"]
    return tuple(Note("body_without_modes", body=name, modes=content.modes)
                 for name, content in zip(bodies.names, bodies.contents) if content.modes)
