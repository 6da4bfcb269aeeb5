# SPDX-License-Identifier: GPL-3.0-or-later
"""Outcomes that a campaign records of a truss. Reflector columns are NaN if the nodes determine no best fit. Jumps and
reflector columns are NaN if the program does not return to the reference temperature."""
from __future__ import annotations

import numpy as np

from statejump.core.run import Run
from statejump.kinds import of
from statejump.kinds.truss.answers import reflector
from statejump.kinds.truss.body_points import displacements_m
from statejump.kinds.truss.answers.jumps import node_jumps, quick_path
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.result import reduced_run
from statejump.kinds.truss.solve import TrussPath, heat_of_joints_J

# Fraction of the heat of all joints below which the heat of a joint is rounding, and the joint counts as not slipping.
LEAST_HEAT = 1e-9


def quick(case: TrussCase) -> Run:
    """Run the reduced model and keep the ends of cycles. The solver locates only events that affect the state."""
    path = quick_path(case.resolve(), case.reduced_settings.increments_per_branch)
    return reduced_run(case, path, np.array([0.0, case.duration_s]))


def outcomes(case: TrussCase, run: Run) -> dict[str, float]:
    """Return the outcomes of a run of the reduced model. A jump is the change over all cycles."""
    found: TrussPath = run.native
    truss, ends = found.truss, found.cycle_ends
    jumps = np.linalg.norm(node_jumps(found)[-1], axis=1)
    heat = heat_of_joints_J(ends)[-1]
    values = dict.fromkeys(of(case).OUTCOMES, float("nan"))
    surface = reflector.surface(truss) if case.has_jump else None
    if surface is not None:
        moved = displacements_m(truss, ends)
        start, end = (surface.fit(moved[index]) for index in (0, -1))
        values.update(
            reflector_rms_of_change_m=float(np.sqrt(np.mean((end.residual_m - start.residual_m) ** 2))),
            reflector_rms_error_m=end.rms_error_m,
            reflector_tilt_change_rad=float(np.linalg.norm(end.tilt_rad - start.tilt_rad)),
            reflector_depth_change_m=end.depth_m - start.depth_m,
        )
    if case.has_jump:
        values.update(largest_node_jump_m=float(jumps.max()), rms_node_jump_m=float(np.sqrt(np.mean(jumps**2))))
    bending = [element.tension_N(truss.elements[element.section], found.states)
               for element in ELEMENTS if element.bends]
    axial_forces = [found.states["axial_force_N"], *bending]
    values.update(
        friction_dissipation_J=float(heat.sum()),
        slipping_joints=float(np.count_nonzero(heat > LEAST_HEAT * heat.sum())),
        largest_axial_force_N=max(float(np.abs(axial).max(initial=0.0)) for axial in axial_forces),
    )
    return values
