# SPDX-License-Identifier: GPL-3.0-or-later
"""Results of the runs of Figures 13 to 16 as input of :mod:`studies.paper.claims`."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from statejump.core.run import Run
from statejump.kinds.umbrella import compare, reduced as model
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.compare import first_contact_K
from studies.paper import ensembles
from studies.paper.claims.findings import Amplification, Envelope, Findings, FirstContact
from studies.paper.claims.statistics import Groups, two_sample_test
from studies.paper.figures.closed_forms import (
    closed_form_first_contact, envelope, static_deflection, static_deflection_elastic,
)
from studies.paper.figures.runs import Study, Variant, single_deflection

TWIN_RAD = 1e-12  # rotation of AB between two otherwise equal initial states [rad]
ONSET = 0.01  # fraction of c/|AB| at the smallest clearance, above which AB counts as deflected


def findings_of(
    case: UmbrellaCase, done: Sequence[tuple[Study, Sequence[Variant]]], base: Variant,
    dem_ensemble: ensembles.EnsembleOfRuns, contacts: tuple[FirstContact, ...], stiffness: Groups,
) -> Findings:
    """Return the results of the runs, the input of the claims.

    :param done: the studies of Figures 14 to 16 with their runs
    :param base: runs of the unchanged case
    :param contacts: first contact by clearance, for links without vibration
    :param stiffness: jumps by cross-section of the links
    """
    clearances, frictions, springs = (variants for _, variants in done)
    threshold = ONSET * min(v.value for v in clearances) / case.link_ab.stress_free_length_m
    warmest = case.temperature_range_K[1]
    first = closed_form_first_contact(case)
    onset = _groups(
        clearances, lambda v: _onset(v.ensemble.temperature_change_K, v.ensemble.deflection_rad, threshold)
    )
    onset_dem = tuple(
        float(_onset(v.dem["temperature_change_K"], single_deflection(v.dem)[None, :], threshold)[0])
        for v in clearances
    )
    unbiased = case.torsion_spring.bias_rad == 0
    return Findings(
        start_spread_m=case.ensemble.start_spread_m,
        end_shift_reduced_m=_end_shift(case, base.ensemble),
        end_shift_dem_m=_end_shift(case, dem_ensemble),
        first_contacts=tuple(
            replace(
                contact,
                reduced_ringing_K=first_contact_K(v.reduced),
                dem_ringing_K=first_contact_K(v.dem),
            )
            for contact, v in zip(contacts, clearances)
        ),
        tolerance_reduced_K=case.tolerance.first_contact_reduced_K,
        tolerance_dem_K=case.tolerance.first_contact_dem_K,
        onset_K=onset,
        onset_dem_K=onset_dem,
        clearance_limit_m=(
            float("nan") if first is None
            else case.link_ab.thermal_expansion_per_K * warmest * case.frame.length_m
        ),
        range_by_friction=_groups(frictions, lambda v: v.ensemble.range_rad),
        jump_by_friction=_groups(frictions, lambda v: v.ensemble.jump_rad),
        friction_coefficient=case.joint.friction_coefficient,
        largest_by_spring=_groups(springs, _largest),
        jump_by_spring=_groups(springs, lambda v: v.ensemble.jump_rad),
        static_rigid_rad=static_deflection(case, warmest) if unbiased else None,
        static_elastic_rad=tuple(
            static_deflection_elastic(v.case, warmest) if unbiased else None for v in springs
        ),
        jump_by_stiffness=stiffness,
        free_turn_rad=case.joint.radial_clearance_m / case.frame.length_m,
        spring_bias_rad=case.torsion_spring.bias_rad,
        tests=(
            two_sample_test("range of θ2", base.ensemble.range_rad, dem_ensemble.range_rad),
            two_sample_test("jump of θ2", base.ensemble.jump_rad, dem_ensemble.jump_rad),
        ),
        envelopes=_check_envelopes(
            [(study.figure, variants) for study, variants in done], dem_ensemble, base
        ),
        amplification=_amplification(base.case, base.reduced),
        spring_stiffness_N_m_per_rad=case.torsion_spring.stiffness_N_m_per_rad,
        damped=case.is_reproducible,
        rings=case.start.mode == "rest",
    )


def _amplification(case: UmbrellaCase, reduced: Run) -> Amplification:
    """Run the case once more, with AB rotated by TWIN_RAD."""
    across = np.array([np.sin(case.theta2_rad), -np.cos(case.theta2_rad)])  # d = journal − bearing
    twin = model.run(case, offset_m=TWIN_RAD * case.link_ab.stress_free_length_m * across)
    apart = np.abs(twin["theta2_rad"] - reduced["theta2_rad"])
    warmest = compare.largest_temperature(reduced)
    return Amplification(TWIN_RAD, float(apart[warmest]), float(apart[-1]))


def _slack(case: UmbrellaCase, run: Run) -> float:
    """Return the largest sum [m] of contact depth and elongation of both links, by which rigid links seem to leave the
    clearance."""
    first, second = case.link_lengths_m(run["temperature_change_K"])
    return float(np.max(
        np.maximum(run["penetration_depth_m"], 0)
        + np.abs(run["length_ab_m"] - first) + np.abs(run["length_bc_m"] - second)
    ))


def _check_envelopes(
    groups: Sequence[tuple[str, Sequence[Variant]]], dem_ensemble: ensembles.EnsembleOfRuns, base: Variant
) -> tuple[Envelope, ...]:
    def check(case: UmbrellaCase, margin: float, change: np.ndarray, theta2: np.ndarray) -> tuple[float, int]:
        low, high = envelope(case, change)
        low_margin, high_margin = envelope(case, change, margin)
        excess = np.maximum(low - theta2, theta2 - high)
        return float(np.max(excess)), int(np.sum((theta2 < low_margin) | (theta2 > high_margin)))

    def margin(variant: Variant) -> float:
        return 2 * max(_slack(variant.case, run) for run in (variant.reduced, variant.dem))

    rows = []
    for name, variants in groups:
        for kind in variants[0].runs:
            checked = [check(v.case, margin(v), *v.runs[kind]) for v in variants]
            rows.append(Envelope(
                f"{name}, {kind}", sum(len(v.runs[kind][1]) for v in variants),
                max(excess for excess, _ in checked), max(margin(v) for v in variants),
                sum(beyond for _, beyond in checked),
            ))
    excess, beyond = check(base.case, margin(base), dem_ensemble.temperature_change_K, dem_ensemble.theta2_rad)
    rows.append(Envelope(
        "case, DEM ensemble", len(dem_ensemble.theta2_rad), excess, margin(base), beyond
    ))
    return tuple(rows)


def _onset(change_K: np.ndarray, deflection: np.ndarray, threshold: float) -> np.ndarray:
    """Return ΔT at which the deflection of each run first exceeds the threshold; infinity if it never exceeds it."""
    moved = np.abs(deflection) > threshold
    return np.where(moved.any(axis=1), change_K[np.argmax(moved, axis=1)], np.inf)


def _largest(variant: Variant) -> np.ndarray:
    return np.abs(variant.ensemble.deflection_rad).max(axis=1)


def _groups(variants: Sequence[Variant], quantity: Callable[[Variant], np.ndarray]) -> Groups:
    return Groups(tuple(v.value for v in variants), tuple(quantity(v) for v in variants))


def _end_shift(case: UmbrellaCase, runs: ensembles.EnsembleOfRuns) -> np.ndarray:
    """Distance [m] of the journal's position in the play at the end of each run from that at its start."""
    angle = case.start.eccentricity_angle_rad
    centre = case.start.eccentricity_m * np.array([np.cos(angle), np.sin(angle)])
    starts = centre + np.array(list(ensembles.start_offsets(case, len(runs.theta2_rad))))
    return np.hypot(*(runs.end_eccentricity_m - starts).T)
