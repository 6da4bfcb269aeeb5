# SPDX-License-Identifier: GPL-3.0-or-later
"""The path of the case itself, with which bounds are compared."""
from __future__ import annotations

import numpy as np

from statejump.core.errors import FailedRun
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.solve import path as start_of
from statejump.kinds.truss.solve import solve

MOST_SIMULATED = 100  # joints of a case that is simulated without request


def simulated(case: TrussCase, whole: bool | None) -> np.ndarray:
    """Return the displacements (states, nodes, 3) of the path of a case, or of its start alone.

    :param whole: whether to simulate the path; None: with at most MOST_SIMULATED joints, and if it exists
    """
    truss = case.resolve()
    if whole or (whole is None and sum(len(joints.names) for joints in truss.joints.values()) <= MOST_SIMULATED):
        try:
            return np.asarray(solve(case).states["displacement_m"])
        except FailedRun:  # bounds do not need the path
            if whole:
                raise
    return np.asarray(start_of(truss, progress=lambda share: share <= 0).states["displacement_m"][:1])
