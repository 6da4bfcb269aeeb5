# SPDX-License-Identifier: GPL-3.0-or-later
"""The path of the case itself, with which bounds are compared."""
from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from statejump.core.errors import FailedRun, StatejumpError
from statejump.kinds.loading import load_case
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.solve import path as start_of
from statejump.kinds.truss.solve import heat_of_joints_J, solve

MOST_SIMULATED = 100  # joints of a case that is simulated without request
CYCLES = 6  # of a simulation that shows whether joints settle
RUBS = 1e-6  # heat of the last cycle over that of all cycles, above which joints rub
STILL = 1e-6  # drift of the last cycle over the largest displacement, below which the shape repeats


def simulated(case: TrussCase, whole: bool | None, free_m: np.ndarray | None = None) -> np.ndarray:
    """Return the displacements (states, nodes, 3) of the path of a case, or of its start alone.

    :param whole: whether to simulate the path; None: with at most MOST_SIMULATED joints, and if it exists
    :param free_m: displacements (nodes, 3) of the equilibrium without friction
    """
    truss = case.resolve()
    if whole or (whole is None and sum(len(joints.names) for joints in truss.joints.values()) <= MOST_SIMULATED):
        try:
            return np.asarray(solve(case).states["displacement_m"])
        except FailedRun:  # bounds do not need the path
            if whole:
                raise
    if free_m is not None and not free_m.any():  # joints carry nothing, so the start is this equilibrium
        return np.zeros((1, *free_m.shape))
    return np.asarray(start_of(truss, progress=lambda share: share <= 0).states["displacement_m"][:1])


@dataclass(frozen=True)
class Repeated:
    """The last of CYCLES simulated cycles of a case.

    :param drift_m: largest displacement of a node over the cycle
    :param rubs: whether joints slip in it; ``drifts``: whether its drift exceeds rounding
    """

    drift_m: float
    rubs: bool
    drifts: bool

    @property
    def text(self) -> str:
        """What the simulation shows."""
        what = "joints rub and the shape repeats" if self.rubs else "no joint slips"
        if self.drifts:
            what = f"the shape changes by {1e6 * self.drift_m:.3g} µm"
        return f"simulated: {what} in cycle {CYCLES} of the case"


def repeated(case: TrussCase) -> Repeated | None:
    """Return the last of several simulated cycles of a case; None: it has no such path."""
    data = deepcopy(dict(case.origin.document))
    data["thermal"] = {**data["thermal"], "cycles": CYCLES}
    made = load_case(data)
    assert isinstance(made, TrussCase)
    try:
        states = solve(made).states
    except StatejumpError:
        return None
    last = int(np.abs(states["time_s"] - (CYCLES - 1) * made.period_s).argmin())
    moved = states["displacement_m"]
    drift = float(np.linalg.norm(moved[-1] - moved[last], axis=1).max())
    heat = heat_of_joints_J(states).sum(axis=1)
    largest = float(np.linalg.norm(moved - moved[0], axis=2).max())
    return Repeated(drift, bool(heat[-1] - heat[last] > RUBS * heat[-1]), drift > STILL * largest)
