# SPDX-License-Identifier: GPL-3.0-or-later
"""How a structure reaches its first equilibrium: the key ``start.friction``, the same for all kinds and models."""
from __future__ import annotations

from typing import Any

import numpy as np

from statejump.schema.fields import Section, choice, definition

STUCK, FRICTIONLESS = "stuck", "frictionless"


def start_friction() -> Any:
    """Declare the key ``start.friction``. The default is stuck, because a structure is assembled before loading."""
    return choice(STUCK, (STUCK, FRICTIONLESS),
                  "joints hold where they were assembled; frictionless: friction begins after loads and preloads act")


@definition
class Start(Section):
    """How the structure gets to its first equilibrium, at ΔT = 0."""

    friction: str = start_friction()


def carried(friction: Any, limit: Any) -> dict[str, float]:
    """Return the summary of friction at the start: largest friction force [N], largest ratio of a joint's friction
    force to its limit [-]."""
    force, most = np.abs(np.atleast_1d(friction)), np.atleast_1d(limit)
    share = np.divide(force, most, out=np.zeros_like(force), where=most > 0)
    return {"start_friction_N": float(force.max(initial=0.0)),
            "start_friction_over_limit": float(share.max(initial=0.0))}
