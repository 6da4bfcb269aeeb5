# SPDX-License-Identifier: GPL-3.0-or-later
"""What a campaign records of one truss. Reflector columns are NaN without a surface that determines a fit."""
from __future__ import annotations

import numpy as np

from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.answers import reflector
from statejump.kinds.truss.answers.answers import node_jumps, quick_path

UNITS = {
    "largest_node_jump_m": "m",
    "rms_node_jump_m": "m",
    "reflector_rms_of_change_m": "m",
    "reflector_rms_error_m": "m",
    "reflector_tilt_change_rad": "rad",
    "reflector_depth_change_m": "m",
    "friction_dissipation_J": "J",
    "slipping_joints": "-",
    "largest_axial_force_N": "N",
}
# Share of the heat of all joints below which a joint does not slip: what it has is rounding.
LEAST_HEAT = 1e-9


def outcomes(case: TrussCase) -> dict[str, float]:
    """Run a truss and return its outcomes, jumps over all cycles.

    :raises StatejumpError: the solver finds no path
    """
    truss = case.resolve()
    found = quick_path(truss, case.reduced.increments_per_branch)
    ends = found.cycle_ends
    jumps = np.linalg.norm(node_jumps(found)[-1], axis=1)
    heat = np.concatenate((ends["slider_dissipation_J"][-1], ends["revolute_dissipation_J"][-1]))
    values = dict.fromkeys(UNITS, float("nan"))
    surface = reflector.surface(truss)
    if surface is not None:
        start, end = (surface.fit(ends["displacement_m"][index]) for index in (0, -1))
        values.update(
            reflector_rms_of_change_m=float(np.sqrt(np.mean((end.residual_m - start.residual_m) ** 2))),
            reflector_rms_error_m=end.rms_error_m,
            reflector_tilt_change_rad=float(np.linalg.norm(end.tilt_rad - start.tilt_rad)),
            reflector_depth_change_m=end.depth_m - start.depth_m,
        )
    values.update(
        largest_node_jump_m=float(jumps.max()),
        rms_node_jump_m=float(np.sqrt(np.mean(jumps**2))),
        friction_dissipation_J=float(heat.sum()),
        slipping_joints=float(np.count_nonzero(heat > LEAST_HEAT * heat.sum())),
        largest_axial_force_N=float(np.abs(found.states["axial_force_N"]).max()),
    )
    return values
