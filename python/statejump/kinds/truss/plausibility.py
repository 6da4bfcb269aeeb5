# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings for allowed but implausible values of a truss."""
from __future__ import annotations

import numpy as np

from statejump.core.plausibility import clearances, moduli, strains
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.round_parts import RoundParts
from statejump.kinds.truss.resolved import ResolvedTruss


def implausible(truss: ResolvedTruss) -> tuple[str, ...]:
    """Return one sentence for each kind of value, for its worst item."""
    links = truss.links
    largest_K = np.abs(truss.temperature_ranges_K).max(axis=1)
    found = list(moduli("link", links.names, links.young_modulus_Pa))
    if len(links.names):
        strain = np.abs(links.thermal_expansion_per_K * links.temperature_fraction) * largest_K[links.program]
        found += strains("link", links.names, strain, "thermal")
    for kind in JOINTS:
        if isinstance(kind, RoundParts) and (joints := truss.joints.get(kind.section)) is not None:
            radius = kind.radius_m(joints, kind.inner)
            found += clearances(kind.section, joints.names, joints.radial_clearance_m, radius)
            found += moduli(kind.section, joints.names, joints.young_modulus_Pa)
    return tuple(found)
