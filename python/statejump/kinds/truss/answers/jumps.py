# SPDX-License-Identifier: GPL-3.0-or-later
"""Jumps of a truss after each cycle of the quasi-static path: displacement at the end of the cycle minus displacement
at the start of the path."""
from __future__ import annotations

from typing import Any

import numpy as np

from statejump.core.progress import OnProgress
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.scales import scales
from statejump.kinds.truss.solve import TrussPath, whole_path


def quick_path(truss: ResolvedTruss, increments_per_branch: int = 50, on_progress: OnProgress = lambda share: None,
               **more: Any) -> TrussPath:
    """Return the path with only the events located that affect the state.

    Ends of cycles are those of the path with all events located, unless slip reverses between two changes of status
    within one increment.
    """
    return whole_path(truss, on_progress, increments_per_branch=increments_per_branch, locate_events=False, **more)


def node_jumps(found: TrussPath) -> np.ndarray:
    """Return the jump [m] (cycles, nodes, 3) of every node from the start of the path to the end of each cycle."""
    ends = found.cycle_ends["displacement_m"]
    return ends[1:] - ends[0]


def rounding_m(found: TrussPath) -> float:
    """Return the largest displacement [m] that counts as rounding."""
    return scales(found.truss, found.states["displacement_m"]).rounding_m


def most_moved(found: TrussPath) -> int:
    """Return the node with the largest jump after the last cycle."""
    return int(np.argmax(np.linalg.norm(node_jumps(found)[-1], axis=1)))
