# SPDX-License-Identifier: GPL-3.0-or-later
"""Check that steps with penalty contact in motion (``motion.scheme = "regularised"``) are short enough."""
from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.kinds.truss import dem
from statejump.kinds.truss.arrays import SAME_DIRECTION
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss


def _refuse(case: TrussCase, why: str, **fields: Any) -> StatejumpError:
    return StatejumpError(code="regularised_not_supported", case=case.name, why=why, **fields)


def _moves_along(truss: ResolvedTruss, node: int, axis: np.ndarray) -> bool:
    """Return whether the supports and the guide of a node allow a motion that has a component along an axis."""
    held = np.vstack((np.eye(3)[truss.nodes.fixed[node]], truss.nodes.guide_normal[node]))
    held = held[np.abs(held).any(axis=1)]
    across = axis - (np.linalg.lstsq(held.T, axis, rcond=None)[0] @ held if len(held) else 0)
    return bool(np.linalg.norm(across) > SAME_DIRECTION)


def least_steps_per_cycle(case: TrussCase) -> int:
    """Return the number of stable steps per cycle, by the bound of the DEM.

    The bound is the stable step of leapfrog, 2/ω. Without damping, Runge-Kutta steps may be √2 times as long; with
    stiff dashpots they may not be longer.
    """
    return ceil(case.period_s / dem.stable_time_step(case, dem.course(case, lambda share: None)))


def check(case: TrussCase) -> None:
    """Raise StatejumpError for a joint that the regularised scheme does not support. Raise NotAllowed if the steps are
    too long for the largest forces of the quasi-static path."""
    truss = case.resolve()
    for joint in JOINTS:
        refused = joint.regularised_refuses(truss.joints[joint.section])
        if refused is not None:
            name, why = refused
            raise _refuse(case, f"{joint.section} {name!r} {why}", joint=name)
    revolutes = truss.joints["revolute"]
    for name, axis, *ends in zip(revolutes.names, revolutes.axis, revolutes.journal_node, revolutes.bearing_node):
        if any(_moves_along(truss, node, axis) for node in ends):
            raise _refuse(case, f"revolute {name!r} holds its nodes together along its axis", joint=name)
    if truss.drives.names:
        raise _refuse(case, f"link {truss.drives.names[0]!r} is driven")
    least = least_steps_per_cycle(case)
    if case.motion.steps_per_cycle < least:
        raise NotAllowed("motion.steps_per_cycle", case.motion.steps_per_cycle, code="too_few_steps_of_regularised",
                         case=case.name, least=least)
