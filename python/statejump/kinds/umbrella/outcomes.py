# SPDX-License-Identifier: GPL-3.0-or-later
"""Outcomes of an ``umbrella`` case for campaigns."""
from __future__ import annotations

from math import nan

import numpy as np

from statejump.core.run import Run
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.compare import energy_residual

ANGLES = ("theta2", "theta4")


def outcomes(case: UmbrellaCase, run: Run) -> dict[str, float]:
    """Return jumps and ranges of both angles, first contact, contacts and energy residue; NaN: it did not happen."""
    said = run.summary
    # The reduced model sums energy in every step, the DEM only at its samples.
    residue = said["energy_residue_J"] if "energy_residue_J" in said else energy_residual(run)
    return {
        **{f"{angle}_jump_rad": said[f"{angle}_jump_rad"] for angle in ANGLES},
        **{f"{angle}_range_rad": float(np.ptp(run[f"{angle}_rad"])) for angle in ANGLES},
        "first_contact_temperature_change_K": said.get("first_contact_temperature_change_K", nan),
        "contacts": said["contacts"],
        "energy_residue_J": residue,
    }
