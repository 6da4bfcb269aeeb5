# SPDX-License-Identifier: GPL-3.0-or-later
"""Masses of nodes. Half of a link's mass is lumped at each end. If one end is fixed, the other end gets a third of the
mass, which is exact for a uniform rod on a pin."""
from __future__ import annotations

import numpy as np

from statejump.core.errors import MissingKey
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
    mass[held] = 0
    return mass
