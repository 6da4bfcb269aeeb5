# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether explicit steps of a truss in motion (``motion.scheme = "regularised"``) are short enough."""
from __future__ import annotations

from math import ceil
from typing import Any

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.kinds.truss import dem
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.joints import JOINTS


def _refuse(case: TrussCase, why: str, **fields: Any) -> StatejumpError:
    return StatejumpError(cause=f"{why}, which motion.scheme = 'regularised' has not", case=case.name,
                          remedy="leave motion.scheme out", **fields)


def least_steps_per_cycle(case: TrussCase) -> int:
    """Return how many steps of a cycle are stable, by the bound that the DEM takes its own steps from.

    It is that of a leapfrog, 2/ω; steps of Runge and Kutta's method may be √2 times as long where nothing is damped,
    and no longer where dashpots are stiff.
    """
    return ceil(case.period_s / dem.stable_time_step(case, dem.course(case, lambda share: None)))


def check(case: TrussCase) -> None:
    """Raise StatejumpError for a joint that has no such contact, NotAllowed for steps that are too long for the largest
    forces of the quasi-static path."""
    truss = case.resolve()
    for joint in JOINTS:
        refused = joint.regularised_refuses(truss.joints[joint.section])
        if refused is not None:
            name, why = refused
            raise _refuse(case, f"{joint.section} {name!r} {why}", joint=name)
    for name in truss.joints["revolute"].names[:1] if truss.dimension == 3 else ():
        raise _refuse(case, f"revolute {name!r} holds its nodes together along its axis", joint=name)
    if truss.drives.names:
        raise _refuse(case, f"link {truss.drives.names[0]!r} is driven")
    least = least_steps_per_cycle(case)
    if case.motion.steps_per_cycle < least:
        raise NotAllowed("motion.steps_per_cycle", case.motion.steps_per_cycle,
                         f"must be at least {least} with motion.scheme = 'regularised': its steps are explicit",
                         case=case.name)
