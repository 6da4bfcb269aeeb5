# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of the DEM run of an ``umbrella`` case with the reduced model."""
from __future__ import annotations

import math
from typing import Optional

import numpy as np

from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.core.comparison import Quantity, quantity
from statejump.core.yade_process import DemRun
from statejump.core.history import History
from statejump.kinds.umbrella import reduced as model

STORED = ("kinetic", "axial", "contact", "torsion")
DISSIPATED = ("axial", "pin", "friction", "impact")


def largest_temperature(history: History) -> int:
    """Index of the sample at which |ΔT| is largest first."""
    return int(np.argmax(np.abs(history["temperature_change_K"])))


def energy_residual(history: History) -> float:
    """Supplied minus stored minus dissipated energy over the whole run [J]."""

    def change(name: str) -> float:
        return float(history[name][-1] - history[name][0])

    stored = sum(change(f"{name}_energy_J") for name in STORED)
    dissipated = sum(change(f"{name}_dissipation_J") for name in DISSIPATED)
    return change("thermal_work_J") - stored - dissipated


def _energy_row(case: UmbrellaCase, reduced: History, dem: History) -> Quantity:
    """Both residues over the largest amount of energy that was about in the DEM run."""
    about = sum(dem[f"{name}_energy_J"] for name in STORED) + sum(
        dem[f"{name}_dissipation_J"] for name in DISSIPATED
    )
    scale = float(np.max(about))
    tolerance = case.tolerance.energy_balance_relative
    if not scale > 0:
        return Quantity("energy_residual_over_largest_energy", "-", 0.0, 0.0, 0.0, tolerance, True)
    ours, other = energy_residual(reduced) / scale, energy_residual(dem) / scale
    passed = bool(abs(ours) <= tolerance and abs(other) <= tolerance)
    return Quantity("energy_residual_over_largest_energy", "-", ours, other, other - ours, tolerance, passed)


def _first_contact_rows(case: UmbrellaCase, reduced: model.ReducedRun, dem: DemRun) -> list[Quantity]:
    """First contact: both models against the closed form where it holds, else against each other."""
    tolerance = case.tolerance
    ours = reduced.first_contact_temperature_change_K
    other = dem.summary["first_contact_temperature_change_K"]
    name = "first_contact_temperature_change"
    exact = closed_form_first_contact(case)
    if exact is None:
        return [quantity(name, "K", ours, other, tolerance.first_contact_dem_K)]
    limit: Optional[float] = exact if exact <= case.temperature_range_K[1] else None
    return [
        quantity(f"{name}, closed form and reduced", "K", limit, ours, tolerance.first_contact_reduced_K),
        quantity(f"{name}, closed form and DEM", "K", limit, other, tolerance.first_contact_dem_K),
    ]


def closed_form_first_contact(case: UmbrellaCase) -> Optional[float]:
    """ΔT_c [K] where c/(α |AC|) holds: heating from a concentric start whose links do not ring, no
    torsion spring before contact. Infinity: the play is never used up; None: no closed form."""
    first_heats = float(model.thermal_program(case).temperature_rate(0.0)) > 0
    expansions_agree = (
        case.link_ab.thermal_expansion_per_K == case.link_bc.thermal_expansion_per_K
    )
    unbiased = case.torsion_spring.stiffness_N_m_per_rad == 0 or case.torsion_spring.bias_rad == 0
    concentric = case.start.mode == "matched" and case.start.eccentricity_m == 0
    if not (first_heats and expansions_agree and unbiased and concentric):
        return None
    return model.linkage(case).first_contact_temperature_change()


def history_rows(case: UmbrellaCase, ours: History, other: History) -> list[Quantity]:
    """Compare two histories at the same times: jumps and largest differences of both angles. What is
    not reproducible is compared until the largest temperature, see :func:`compare`."""
    tolerance = case.tolerance
    reproducible = model.is_reproducible(case)
    rows = []
    if reproducible:
        for angle, limit in (("theta2", tolerance.final_theta2_rad), ("theta4", tolerance.final_theta2_rad)):
            column = f"{angle}_rad"
            jumps = [float(history[column][-1] - history[column][0]) for history in (ours, other)]
            rows.append(quantity(f"{angle}_jump", "rad", *jumps, limit))
    end = len(ours) if reproducible else largest_temperature(ours) + 1
    until = "" if reproducible else "_until_largest_temperature"
    for angle in ("theta2", "theta4"):
        column = f"{angle}_rad"
        span = float(np.ptp(ours[column]))
        largest = float(np.max(np.abs(other[column][:end] - ours[column][:end])))
        rows.append(
            quantity(f"{angle}_largest_difference_over_range{until}", "-", 0.0,
                     largest / span if span > 0 else math.nan, tolerance.history_relative)
        )
    return rows


def compare(case: UmbrellaCase, reduced: model.ReducedRun, dem: DemRun) -> list[Quantity]:
    """Compare a DEM run with the reduced run of the same case.

    A damped case is compared over its whole program. Without damping the motion after contact is
    chaotic: what can be compared point by point ends at the largest temperature; for the rest there
    is the ensemble (``statejump figures``).
    """
    ours, other = reduced.history, dem.history
    rows = [] if case.start.mode == "loaded" else _first_contact_rows(case, reduced, dem)
    rows += history_rows(case, ours, other)
    rows.append(_energy_row(case, ours, other))
    return rows
