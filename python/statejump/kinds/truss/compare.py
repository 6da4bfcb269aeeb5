# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of the DEM run of a ``truss`` case with its quasi-static path."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from statejump.core.comparison import Comparison, Quantity, models, share
from statejump.core.run import Column, Run, change, energy_residue_J
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.scales import COMPARED, NO_JUMP, Scales, scales
from statejump.kinds.truss.slack import hanging, sentence
from statejump.kinds.truss.why_missed import why_missed


def energy_residual(energy: Mapping[str, Column]) -> float:
    """Return supplied minus stored minus dissipated energy [J], over the whole run."""
    undamped = energy_residue_J(energy, ("thermal_work_J", "external_work_J"), ("elastic_energy_J", "kinetic_energy_J"),
                                ("friction_dissipation_J",))
    # The residue is a small difference, so the order of subtractions determines its rounding; it must not change.
    return undamped - change(energy, "damping_dissipation_J") - change(energy, "impact_dissipation_J")


def jumps_m(run: Run) -> np.ndarray:
    """Return the state jump of every node [m] (nodes, 3): displacement at the end minus that at the start."""
    displacement = run["displacement_m"]
    return displacement[-1] - displacement[0]


def loop_width_m(case: TrussCase, run: Run, hung: np.ndarray | None = None) -> float:
    """Return the width of the loop of the first cycle [m]: the largest distance of a node between heating and cooling
    at the same temperature. It is 0 unless the cycle has one heating and one cooling branch. Nodes that hang slack at a
    sample are omitted."""
    end = case.samples_per_cycle + 1
    change = run["temperature_change_K"][:end]
    displacement = run["displacement_m"][:end]
    if hung is not None:
        displacement = displacement[:, ~hung[:end].any(axis=0)]
    peak = int(np.argmax(np.abs(change)))
    size = np.abs(change)
    if not 0 < peak < len(change) - 1 or np.any(np.diff(size[: peak + 1]) < 0) or np.any(np.diff(size[peak:]) > 0):
        return 0.0
    back_size, back = size[peak:][::-1], displacement[peak:][::-1]
    width = 0.0
    for node in range(displacement.shape[1]):
        gap = [displacement[: peak + 1, node, axis] - np.interp(size[: peak + 1], back_size, back[:, node, axis])
               for axis in range(3)]
        width = max(width, float(np.linalg.norm(gap, axis=0).max()))
    return width


def scales_of(case: TrussCase, run: Run) -> Scales:
    """Return the scales of the motion of a run."""
    return scales(case.resolve(), run["displacement_m"])


def jump_scale_m(case: TrussCase, run: Run, hung: np.ndarray) -> float:
    """Return the reference [m] for differences of jumps: the larger of the largest jump and the width of the loop. If
    that is at most NO_JUMP times the allowed difference of displacements, COMPARED times this difference is allowed for
    jumps.

    :param hung: samples at which nodes hang slack (samples, nodes), see :func:`hanging`
    """
    jumps, tolerance = np.linalg.norm(_jumps_m(run, hung), axis=1), case.tolerance
    allowed = tolerance.displacement_relative * scales(case.resolve(), _displacement_m(run, hung)).motion_m
    largest = max(float(jumps.max()), loop_width_m(case, run, hung))
    least = COMPARED if largest <= NO_JUMP * allowed else NO_JUMP
    return max(largest, least * allowed / tolerance.jump_relative)


def _relative(name: str, difference: float, scale: float, tolerance: float) -> Quantity:
    """Return the row of a relative difference. Two models without any motion or force count as equal."""
    return models(name, "-", 0.0, share(difference, scale), tolerance)


def _displacement_m(run: Run, hung: np.ndarray) -> np.ndarray:
    """Return displacements [m] (samples, nodes, 3), set to zero where nodes hang slack."""
    return np.where(hung[:, :, None], 0.0, run["displacement_m"])


def _jumps_m(run: Run, hung: np.ndarray) -> np.ndarray:
    """Return the state jump of every node [m] (nodes, 3); zero for nodes that are slack at the start or end."""
    return np.where(hung[[0, -1]].any(axis=0)[:, None], 0.0, jumps_m(run))


def hung_nodes(case: TrussCase, run: Run) -> np.ndarray:
    """Return the samples at which nodes hang slack (samples, nodes)."""
    return hanging(case, run, COMPARED * scales_of(case, run).force_N)


def difference(case: TrussCase, first: Run, second: Run) -> list[Quantity]:
    """Compare two runs at the same times. The first run gives the scales; nodes that hang slack in it are omitted."""
    tolerance, hung = case.tolerance, hung_nodes(case, first)
    ours, other = (_displacement_m(run, hung) for run in (first, second))
    of = scales(case.resolve(), ours)
    largest = max(float(np.linalg.norm(ours, axis=2).max()), COMPARED * of.motion_m)
    peak = int(np.argmax(np.abs(first["temperature_change_K"])))
    apart = np.linalg.norm(other - ours, axis=2)
    rows = [
        _relative("displacement_at_peak_largest_difference_over_largest", float(apart[peak].max()), largest,
                  tolerance.displacement_relative),
        _relative("displacement_largest_rms_over_largest", float(np.sqrt((apart**2).mean(axis=0)).max()), largest,
                  tolerance.displacement_relative),
    ]
    jumps = [_jumps_m(run, hung) for run in (first, second)]
    node = int(np.argmax(np.linalg.norm(jumps[0], axis=1)))
    scale = jump_scale_m(case, first, hung)
    ours_m, other_m = (float(np.linalg.norm(jump[node])) for jump in jumps)
    what = "jump" if case.has_jump else "displacement_at_program_end"
    rows.append(models(f"{what}_of_node_{case.node[node].name}", "m", ours_m, other_m, tolerance.jump_relative * scale))
    rows.append(_relative(f"{what}_largest_difference_over_largest_{'jump_or_loop' if case.has_jump else 'of_them'}",
                          float(np.linalg.norm(jumps[1] - jumps[0], axis=1).max()), scale, tolerance.jump_relative))
    forces = [run.links["axial_force_N"].values for run in (first, second)]
    rows.append(_relative(
        "axial_force_largest_rms_over_largest",
        float(np.sqrt(((forces[1] - forces[0]) ** 2).mean(axis=0)).max(initial=0.0)),
        max(float(np.abs(forces[0]).max(initial=0.0)), COMPARED * of.force_N), tolerance.force_relative,
    ))
    return rows


def reduced_name(run: Run) -> str:
    """Return the name of the reduced model that made a run: quasi-static solver, or motion."""
    return "reduced model in motion" if "velocity_m_per_s" in run.history else "quasi-static solver"


def loop_drift_m(case: TrussCase, run: Run, hung: np.ndarray | None = None) -> float:
    """Return the largest distance [m] of a node in any later cycle from its position at the same phase of the second
    cycle. Nodes that hang slack at a sample are omitted."""
    samples, displacement = case.samples_per_cycle, run["displacement_m"]
    if hung is not None:
        displacement = displacement[:, ~hung.any(axis=0)]
    loops = [displacement[k * samples : (k + 1) * samples + 1] for k in range(1, case.thermal.cycles)]
    return float(np.linalg.norm(np.stack(loops) - loops[0], axis=3).max(initial=0.0))


def _energy_row(case: TrussCase, dem: Run) -> Quantity:
    """Return the row of the energy residue, relative to friction work or, without friction, to stored energy and
    damping. An energy is of second order in the motion, so its smallest scale is the square of that of forces."""
    residual = energy_residual(dem.energy)
    scale = change(dem.energy, "friction_dissipation_J")
    name, least = "energy_residual_over_friction_work", COMPARED**2 * scales_of(case, dem).energy_J
    if not scale > least:
        scale = max(float(np.ptp(dem["elastic_energy_J"]) + dem["damping_dissipation_J"][-1]), least)
        name = "energy_residual_over_largest_stored"
    return models(name, "-", 0.0, share(residual, scale), case.tolerance.energy_balance_relative)


def compare(case: TrussCase, reduced: Run, dem: Run) -> Comparison:
    """Compare a DEM run with the quasi-static path at the times of the DEM's samples."""
    exact = reduced.at(dem.time_s)
    hung = hung_nodes(case, exact)
    rows = [*difference(case, exact, dem), _energy_row(case, dem)]
    if case.thermal.cycles > 2:
        rows.append(_relative("loop_drift_over_largest_displacement", loop_drift_m(case, dem, hung),
                              max(float(np.linalg.norm(_displacement_m(exact, hung), axis=2).max()),
                                  COMPARED * scales_of(case, exact).motion_m),
                              case.tolerance.displacement_relative))
    found = Comparison(case, {"reduced": exact, "dem": dem}, tuple(rows),
                       warnings=(*reduced.warnings, *sentence(case, hung)))
    return found if found.passed else replace(
        found, reasons=tuple(why_missed(case, exact, dem, jump_scale_m(case, exact, hung))))


def jump_table(case: TrussCase, run: Run, most: int = 8) -> list[tuple[Any, ...]]:
    """Return name, jump along x, y, z and its length [m] for the nodes with the largest jumps above rounding."""
    jumps, rounding_m = jumps_m(run), scales_of(case, run).rounding_m
    length = np.linalg.norm(jumps, axis=1)
    order = np.argsort(-length, kind="stable")[:most]
    return [(case.node[node].name, *jumps[node], length[node]) for node in order if length[node] > rounding_m]
