# SPDX-License-Identifier: GPL-3.0-or-later
"""Varied parameters of Figures 13 to 16, and their runs in both models."""
from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass

import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError
from statejump.core.run import Run
from statejump.kinds.umbrella import reduced as model
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.compare import first_contact_K
from studies.paper.claims.findings import FirstContact
from studies.paper.claims.statistics import Groups
from studies.paper.figures.closed_forms import closed_form_first_contact
from statejump.schema.paths import with_values
from studies.paper import ensembles

CLEARANCES = (0.5, 1.0, 1.5, 2.0, 3.0)  # over that of the case
FRICTIONS = (0.0, 0.1, 0.3, 0.5)
SPRINGS_N_m_per_rad = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)
SECTIONS = (0.25, 1.0, 4.0)  # sections of the links, relative to that of the case, to vary their stiffness

# Context of a part of the work, by its name and number of runs; it yields a function to call after each run.
Part = Callable[[str, int], AbstractContextManager[Callable[[], None]]]


@dataclass(frozen=True)
class Variant:
    """Both models of the case with one value changed."""

    value: float
    case: UmbrellaCase
    reduced: Run
    ensemble: ensembles.EnsembleOfRuns
    dem: Run

    @property
    def runs(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Return temperatures and θ2 (runs, samples) by kind of run."""
        single = self.reduced, self.dem
        return {
            "reduced, ensemble": (self.ensemble.temperature_change_K, self.ensemble.theta2_rad),
            **{
                f"{name}, single": (run["temperature_change_K"], run["theta2_rad"][None, :])
                for name, run in zip(("reduced", "DEM"), single)
            },
        }


@dataclass(frozen=True)
class Study:
    """One figure: the varied parameter and its name."""

    figure: str
    key: str
    values: tuple[float, ...]
    title: str
    label: str  # of the parameter, with unit
    panel: str  # heading of a panel, a format string for the value
    scale: float = 1.0  # from SI to the label's unit
    summaries: tuple[str, ...] = ("largest",)  # of SUMMARIES, a panel each


def studies(case: UmbrellaCase) -> tuple[Study, ...]:
    """Figures 14 to 16 for a case."""
    clearance = case.joint.radial_clearance_m
    return (
        Study("fig14", "joint.radial_clearance_m", tuple(clearance * factor for factor in CLEARANCES),
              "Fig. 14: deflection of AB, clearance", "Clearance c [mm]", "c = {:g} mm", 1e3),
        Study("fig15", "joint.friction_coefficient",
              tuple(sorted({*FRICTIONS, case.joint.friction_coefficient})),
              "Fig. 15: deflection of AB, friction", "Friction coefficient μ", "μ = {:g}",
              summaries=("largest", "range")),
        Study("fig16", "torsion_spring.stiffness_N_m_per_rad", SPRINGS_N_m_per_rad,
              "Fig. 16: deflection of AB, torsion spring", "Stiffness $K_M$ [N m/rad]",
              "$K_M$ = {:g} N m/rad"),
    )


def variant_case(case: UmbrellaCase, key: str, value: float) -> UmbrellaCase:
    """Return the case with one value changed. :raises StatejumpError: the value is invalid"""
    try:
        variant = with_values(case, {key: value})
        variant.check()
    except NotAllowed as refused:
        raise StatejumpError(code="cannot_vary", varied=key, file=case.origin.file, case=case.name, key=refused.key,
                             value=refused.value, allowed=refused.allowed, cause=str(refused)) from None
    return variant


def run_variants(case: UmbrellaCase, study: Study, known: dict[str, Variant], part: Part) -> list[Variant]:
    """Run both models at every value of a study; the unchanged case is run once for all studies."""
    cases = [variant_case(case, study.key, value) for value in study.values]
    new = [variant for variant in cases if _key(variant) not in known]
    with part(f"{study.figure}, reduced", len(new) * (case.ensemble.reduced_runs + 1)) as step:
        spread = [ensembles.ensemble(variant, progress=step) for variant in new]
        singles = []
        for variant in new:
            singles.append(model.run(variant))
            step()
    with part(f"{study.figure}, DEM", len(new)) as step:
        dem_runs = ensembles.execute_all(new, step)
    for variant, ensemble, single, dem_run in zip(new, spread, singles, dem_runs):
        known[_key(variant)] = Variant(0.0, variant, single, ensemble, dem_run)
    return [
        Variant(value, variant, *(getattr(known[_key(variant)], name) for name in ("reduced", "ensemble", "dem")))
        for value, variant in zip(study.values, cases)
    ]


def _key(case: UmbrellaCase) -> str:
    return json.dumps(case.with_defaults(), sort_keys=True, default=str)


def first_contacts(case: UmbrellaCase, values: Sequence[float], part: Part) -> tuple[FirstContact, ...]:
    """Return ΔT of first contact in both models at every clearance, for links that do not vibrate."""
    start = {"start.mode": "matched", "start.eccentricity_m": 0.0}
    cases = [with_values(variant_case(case, "joint.radial_clearance_m", value), start) for value in values]
    with part("first contact, both models", 2 * len(cases)) as step:
        dem_runs = ensembles.execute_all(cases, step)
        result = []
        for value, variant, dem_run in zip(values, cases, dem_runs):
            exact = closed_form_first_contact(variant)
            if exact is not None and exact > variant.temperature_range_K[1]:
                exact = None
            result.append(FirstContact(
                value, exact, first_contact_K(model.run(variant)), first_contact_K(dem_run)
            ))
            step()
    return tuple(result)


def stiffness_jumps(case: UmbrellaCase, base: Variant, part: Part) -> Groups:
    """Return the jumps for links of other cross-sections, with as many runs as the figures."""
    others = [factor for factor in SECTIONS if factor != 1]
    jumps = {1.0: base.ensemble.jump_rad}
    with part("stiffness of the links, reduced", len(others) * case.ensemble.reduced_runs) as step:
        for factor in others:
            areas = {
                f"{name}.cross_section_area_m2": factor * getattr(case, name).cross_section_area_m2
                for name in ("link_ab", "link_bc")
            }
            jumps[factor] = ensembles.ensemble(with_values(case, areas), progress=step).jump_rad
    return Groups(SECTIONS, tuple(jumps[factor] for factor in SECTIONS))


def single_deflection(run: Run) -> np.ndarray:
    """Return θ2 − θ2(0) of one run [rad]."""
    return run["theta2_rad"] - run["theta2_rad"][0]
