# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparison of the DEM run of an ``umbrella`` case with the reduced model."""
from __future__ import annotations

from math import nan

import numpy as np

from statejump.core.comparison import Comparison, Quantity, models, quantity, share
from statejump.core.run import Run, energy_residue_J
from statejump.kinds.umbrella import reduced as model
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.result import AT_END

STORED = tuple(f"{name}_energy_J" for name in ("kinetic", "axial", "contact", "torsion"))
DISSIPATED = tuple(f"{name}_dissipation_J" for name in ("axial", "pin", "friction", "impact"))
FIRST_CONTACT = "first_contact_temperature_change"
UNTIL = "compared point by point until the largest temperature only"
ANGLES = ("theta2", "theta4")


def largest_temperature(run: Run) -> int:
    """Return the first sample with the largest |ΔT|."""
    return int(np.argmax(np.abs(run["temperature_change_K"])))


def energy_residual(run: Run) -> float:
    """Return supplied minus stored minus dissipated energy [J], over the whole run."""
    return energy_residue_J(run.energy, ("thermal_work_J",), STORED, DISSIPATED)


def _energy_row(case: UmbrellaCase, reduced: Run, dem: Run) -> Quantity:
    """Return the row with the energy residues of both models, divided by the largest energy in the DEM run."""
    about = sum(dem[name] for name in STORED) + sum(dem[name] for name in DISSIPATED)
    scale = float(np.max(about))
    tolerance = case.tolerance.energy_balance_relative
    name = "energy_residual_over_largest_energy"
    ours, other = share(energy_residual(reduced), scale), share(energy_residual(dem), scale)
    passed = bool(abs(ours) <= tolerance and abs(other) <= tolerance)
    return Quantity(name, "-", {"reduced": ours, "dem": other}, other - ours, tolerance, passed)


def first_contact_K(run: Run) -> float | None:
    """Return ΔT [K] of the first contact as the model located it; None if the clearance never closed."""
    found = run.events.first("first_contact")
    return None if found is None else found.temperature_change_K


def _first_contact_rows(case: UmbrellaCase, reduced: Run, dem: Run) -> list[Quantity]:
    """Return the rows of the first contact: each model against the closed form or, if that is invalid, both models."""
    tolerance = case.tolerance
    ours, other = first_contact_K(reduced), first_contact_K(dem)
    exact = closed_form_first_contact(case)
    if exact is None:
        return [models(FIRST_CONTACT, "K", ours, other, tolerance.first_contact_dem_K)]
    limit = exact if exact <= case.temperature_range_K[1] else None
    return [
        quantity(f"{FIRST_CONTACT}, closed form and reduced", "K", tolerance.first_contact_reduced_K,
                 closed_form=limit, reduced=ours),
        quantity(f"{FIRST_CONTACT}, closed form and DEM", "K", tolerance.first_contact_dem_K,
                 closed_form=limit, dem=other),
    ]


def closed_form_first_contact(case: UmbrellaCase) -> float | None:
    """Return ΔT_c = c/(α |AC|) [K] of the first contact; infinity if the clearance never closes. Return None if the
    formula is invalid: it requires heating from a concentric start, links without vibration, and no torsion spring
    before contact."""
    first_heats = float(case.thermal_program().temperature_rate(0.0)) > 0
    expansions_agree = (
        case.link_ab.thermal_expansion_per_K == case.link_bc.thermal_expansion_per_K
    )
    unbiased = case.torsion_spring.stiffness_N_m_per_rad == 0 or case.torsion_spring.bias_rad == 0
    concentric = case.start.mode == "matched" and case.start.eccentricity_m == 0
    if not (first_heats and expansions_agree and unbiased and concentric):
        return None
    return float(model.linkage(case).first_contact_temperature_change())


def history_rows(case: UmbrellaCase, ours: Run, other: Run) -> list[Quantity]:
    """Compare two runs at the same times: jumps, and largest differences of both angles. A chaotic history is compared
    only until the largest temperature, see :func:`compare`."""
    tolerance = case.tolerance
    reproducible = case.is_reproducible
    rows = []
    if reproducible:
        for angle in ("theta2", "theta4"):
            key = f"{angle}_jump_rad" if case.has_jump else f"{angle}{AT_END}"
            rows.append(models(key.removesuffix("_rad"), "rad", ours.summary[key], other.summary[key],
                               tolerance.final_theta2_rad))
    end = len(ours) if reproducible else largest_temperature(ours) + 1
    until = "" if reproducible else "_until_largest_temperature"
    for angle in ("theta2", "theta4"):
        column = f"{angle}_rad"
        # Lower bound of the scale, so that an angle that hardly changes does not give a scale of zero: the allowed
        # difference of jumps.
        span = max(float(np.ptp(ours[column])), tolerance.final_theta2_rad)
        largest = float(np.max(np.abs(other[column][:end] - ours[column][:end])))
        rows.append(
            models(f"{angle}_largest_difference_over_range{until}", "-", 0.0,
                   share(largest, span), tolerance.history_relative)
        )
    return rows


def compare(case: UmbrellaCase, reduced: Run, dem: Run) -> Comparison:
    """Compare a DEM run with the reduced run of the same case.

    A damped case is compared over its whole program. Without damping, the motion after contact is chaotic. Runs are
    then compared point by point only until the largest temperature; ``statejump figures`` compares ensembles after it.
    """
    rows = [] if case.start.mode == "loaded" else _first_contact_rows(case, reduced, dem)
    rows += history_rows(case, reduced, dem)
    rows.append(_energy_row(case, reduced, dem))
    return Comparison(case, {"reduced": reduced, "dem": dem}, tuple(rows),
                      notes=() if case.is_reproducible else (UNTIL,))


def difference(case: UmbrellaCase, first: Run, second: Run) -> list[Quantity]:
    """Compare two runs of one model at the same times."""
    rows = []
    if case.start.mode != "loaded":
        rows.append(models(FIRST_CONTACT, "K", first_contact_K(first), first_contact_K(second),
                           case.tolerance.first_contact_dem_K))
    return rows + history_rows(case, first, second)


def outcomes(case: UmbrellaCase, run: Run) -> dict[str, float]:
    """Return jumps and ranges of both angles, first contact, contacts and energy residue; NaN: no such event."""
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
