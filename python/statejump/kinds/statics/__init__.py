# SPDX-License-Identifier: GPL-3.0-or-later
"""Kind ``statics``: rest positions of a loaded clearance joint (section 2 of the paper)."""
from __future__ import annotations

from typing import ClassVar

from statejump.core.later import Later
from statejump.core.units import text
from statejump.kinds.protocol import Kind
from statejump.kinds.statics.case import TYPES, StaticsCase


class Statics(Kind):
    """The kind as one object."""

    name: ClassVar[str] = "statics"
    Case = StaticsCase

    statics = Later("statejump.kinds.statics.solve:solve")

    def describe(self, case: StaticsCase) -> list[str]:
        """Return the case in sentences."""
        joint, loads = case.joint, case.load_cases
        sentences = [f"{TYPES[joint.type]}; friction with μ = {joint.friction_coefficient:g}."]
        if joint.clearance_m is not None:
            sentences.append(f"The clearance is {text(joint.clearance_m, 'm')}.")
        forces = "one force" if len(loads) == 1 else f"{len(loads)} forces, one at a time"
        return [*sentences, f"It is loaded by {forces}."]


KIND = Statics()
