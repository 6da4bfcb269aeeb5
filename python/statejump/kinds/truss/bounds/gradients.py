# SPDX-License-Identifier: GPL-3.0-or-later
"""Gradients of the spread with respect to stiffnesses of links and springs, for design.

The spread is S = 2 Σ |a_i| f_i, a = B K⁻¹c. An element with stiffness k and elongation r · q adds k r rᵀ to K, so

    dS/d ln k = −2 k (r · K⁻¹c) (r · K⁻¹Bᵀ(f sgn a)),

at the equilibrium without friction and with its geometric stiffness. dS/df_i = 2 |a_i|.
"""
from __future__ import annotations

import numpy as np

from statejump.kinds.truss.bounds.margin import bars_of
from statejump.kinds.truss.bounds.sliding import Sliding

MOST_ELEMENTS = 500  # of a truss whose gradients are computed


def stiffness_names(of: Sliding) -> list[str]:
    """Return the links and the taut springs, as text; none of a large truss."""
    truss, place = of.truss, of.truss.nodes.position_m + of.displacement_m
    if len(truss.links.names) + len(truss.springs.names) > MOST_ELEMENTS:
        return []
    ends = truss.springs.nodes
    length = np.linalg.norm(place[ends[:, 1]] - place[ends[:, 0]], axis=1)
    taut = ~truss.springs.cable | (length > truss.springs.free_length_m)
    return [*(f"link '{name}'" for name in truss.links.names),
            *(f"spring '{name}'" for name, one in zip(truss.springs.names, taut) if one)]


def by_stiffness(of: Sliding, row: np.ndarray, gain: np.ndarray) -> np.ndarray:
    """Return dS/d ln k of all elements of :func:`stiffness_names`.

    :param row: c (dofs,) of a scalar output; ``gain``: a (joints,)
    """
    bars = bars_of(of)
    both = of.solve(np.column_stack((row, of.slides.T @ (np.sign(gain) * of.limit_N))))
    along = bars.along @ both
    return np.asarray(-2 * bars.stiffness * along[:, 0] * along[:, 1])
