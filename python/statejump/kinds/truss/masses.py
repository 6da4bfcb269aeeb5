# SPDX-License-Identifier: GPL-3.0-or-later
"""Masses of nodes. Half of the mass of a link or beam is lumped at each end. If one end of a link is fixed, the other
end gets a third of the mass, which is exact for a uniform rod on a pin."""
from __future__ import annotations

import numpy as np

from statejump.core.errors import MissingKey
from statejump.kinds.truss.arrays import SAME_DIRECTION
from statejump.kinds.truss.resolved import ResolvedTruss


def lumped_mass_kg(truss: ResolvedTruss) -> np.ndarray:
    """Return the lumped mass of every node [kg]. :raises MissingKey: a link has no density"""
    for name, link in zip(truss.links.names, truss.links.mass_kg):
        if np.isnan(link):
            raise MissingKey("mass_kg", code="mass_of_moving_link_missing", section="density_kg_per_m3 or mass_kg",
                             item=f"link {name!r}", case=truss.name)
    mass = truss.nodes.mass_kg.copy()
    held = np.asarray(truss.nodes.fixed.all(axis=1))
    for ends, link in zip(truss.links.nodes, truss.links.mass_kg):
        share = link / 3 if held[ends].any() else link / 2
        mass[ends] += share
    beams = truss.elements["beam"].nodes
    np.add.at(mass, beams, 0.5 * beam_mass_kg(truss)[:, None])
    mass += condensed_mass_kg(truss)
    mass[held] = 0
    return mass


def condensed_mass_kg(truss: ResolvedTruss) -> np.ndarray:
    """Return the mass of condensed bodies at every node [kg], in equal shares for all interface nodes.

    :raises MissingKey: the file of a body has no mass
    """
    bodies, found = truss.elements["body"], np.zeros(len(truss.nodes.names))
    for nodes, mass in zip(bodies.nodes, bodies.mass_kg):
        np.add.at(found, nodes, mass / len(nodes))
    return found


def beam_mass_kg(truss: ResolvedTruss) -> np.ndarray:
    """Return the mass of every beam [kg]. :raises MissingKey: a beam has no density"""
    beams = truss.elements["beam"]
    for name, density in zip(beams.names, beams.density_kg_per_m3):
        if np.isnan(density):
            raise MissingKey("density_kg_per_m3", code="mass_of_moving_beam_missing", item=f"beam {name!r}",
                             case=truss.name)
    return np.asarray(beams.mass_kg)


def beam_moment_kg_m2(truss: ResolvedTruss) -> np.ndarray:
    """Return the moments of inertia (k, 3) of the sections of half of each beam about x, y and z [kg m²]."""
    beams = truss.elements["beam"]
    moments = beams.second_moments_of_area_m4
    half = 0.5 * beams.density_kg_per_m3 * beams.stress_free_length_m
    return np.asarray(half[:, None] * np.column_stack((moments.sum(axis=1), moments)))


def blocked_directions(truss: ResolvedTruss) -> np.ndarray:
    """Return for each node and axis (n, 3) whether supports, or a guide normal to the axis, prevent motion along it."""
    return truss.nodes.fixed | (np.abs(truss.nodes.guide_normal) >= 1 - SAME_DIRECTION)


def require_masses(truss: ResolvedTruss) -> None:
    """Check that every node that moves has a mass, a link, a spring, a constraint, a rigid body or a hinge.

    :raises MissingKey: a node has none of them, so nothing determines its acceleration
    """
    has = truss.nodes.mass_kg > 0
    bodies, hinges = truss.joints["rigid"], truss.joints["hinge"]
    for nodes in (truss.links.nodes, truss.springs.nodes, truss.elements["beam"].nodes, *truss.elements["body"].nodes,
                  *truss.constraints.nodes,                  bodies.master, bodies.node, hinges.nodes):
        has[nodes[nodes >= 0]] = True
    for index in np.flatnonzero(~has & ~blocked_directions(truss)[:, :truss.dimension].all(axis=1))[:1]:
        raise MissingKey("mass_kg", code="mass_of_moving_node_missing", section=f"mass_kg of node "
                         f"{truss.nodes.names[index]!r}", case=truss.name)
