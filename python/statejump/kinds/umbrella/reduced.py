# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduced model of an ``umbrella`` case: single runs, ensembles, the quasi-static path."""
from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from statejump import _engine
from statejump.core.engine_failures import engine
from statejump.core.progress import OnProgress
from statejump.core.run import Columns, Run
from statejump.kinds.umbrella import result
from statejump.kinds.umbrella.case import UmbrellaCase, UmbrellaLink
from statejump.schema.paths import with_values


def _link(link: UmbrellaLink) -> _engine.ThermalLink:
    return _engine.ThermalLink(**link.to_dict())


def linkage(case: UmbrellaCase) -> _engine.Linkage:
    """Return the engine's model of a case. :raises ValueError: a changed case is out of range"""
    joint = case.joint.to_dict()
    del joint["radial_clearance_m"]
    return _engine.Linkage(
        frame_length_m=case.frame.length_m,
        link_ab=_link(case.link_ab),
        link_bc=_link(case.link_bc),
        bearing_radius_m=case.bearing_radius_m,
        torsion_stiffness_N_m_per_rad=case.torsion_spring.stiffness_N_m_per_rad,
        torsion_free_angle_rad=case.free_flare_angle_rad,
        **case.damping.to_dict(),
        **joint,
    )


def start_state(case: UmbrellaCase, offset_m: np.ndarray | None = None) -> _engine.LinkageState:
    """Return the state at t = 0.

    :param offset_m: added to the journal's place in the play (2) [m]; not for ``loaded``
    """
    model, start = linkage(case), case.start
    if start.mode == "loaded":
        return _engine.loaded_state(model, start.contact_angle_rad)
    angle = start.eccentricity_angle_rad
    eccentricity = start.eccentricity_m * np.array([np.cos(angle), np.sin(angle)])
    if offset_m is not None:
        eccentricity = eccentricity + offset_m
    rate = float(case.thermal_program().temperature_rate(0.0))
    return _engine.initial_state(model, start.mode, rate, eccentricity)


def integrate(case: UmbrellaCase, offset_m: np.ndarray | None = None) -> _engine.LinkageRun:
    """Integrate a case over its whole program.

    :param offset_m: see :func:`start_state`
    :raises FailedRun: a law left its range or the steps are too long; with time and temperature
    """
    with engine("the reduced run failed", case=case.name):
        model, program, start = linkage(case), case.thermal_program(), start_state(case, offset_m)
        cycles, samples = case.thermal.cycles, case.samples_per_cycle
        if case.reduced_settings.method == "adaptive":
            return _engine.simulate_adaptive(
                model, program, start, case.reduced_settings.relative_tolerance, samples * cycles
            )
        steps = case.reduced_settings.steps_per_cycle
        return _engine.simulate(model, program, start, steps * cycles, steps // samples)


def run(case: UmbrellaCase, on_progress: OnProgress = lambda share: None, offset_m: np.ndarray | None = None) -> Run:
    """Run the reduced model; see :func:`integrate`."""
    made = result.reduced_run(case, integrate(case, offset_m))
    on_progress(1.0)
    return made


def quasi_static(case: UmbrellaCase, samples: int = 400) -> _engine.JointLoop | None:
    """Return the path of the loaded joint, rigid links and exact friction; None if statics leaves it open."""
    try:
        return _engine.joint_loop(
            linkage(case), case.thermal_program(), case.start.contact_angle_rad, samples
        )
    except _engine.EngineFailure:
        return None


def start_offsets(case: UmbrellaCase, count: int) -> Iterator[np.ndarray]:
    """Yield places of the journal near the start (2) [m], evenly spread over a disc; the same for
    the same seed, each independent of how many are asked for."""
    for index in range(count):
        generator = np.random.default_rng([case.ensemble.seed, index])
        radius = case.ensemble.start_spread_m * np.sqrt(generator.random())
        angle = 2 * np.pi * generator.random()
        yield radius * np.array([np.cos(angle), np.sin(angle)])


@dataclass(frozen=True)
class EnsembleOfRuns:
    """Runs from nearby starts, on common times."""

    time_s: np.ndarray  # (samples)
    temperature_change_K: np.ndarray  # (samples)
    theta2_rad: np.ndarray  # (runs, samples)
    end_eccentricity_m: np.ndarray  # (runs, 2)

    @property
    def deflection_rad(self) -> np.ndarray:
        """θ2 − θ2(0) of every run (runs, samples)."""
        return self.theta2_rad - self.theta2_rad[:, :1]

    @property
    def range_rad(self) -> np.ndarray:
        """Largest less smallest θ2 of every run (runs)."""
        return np.ptp(self.theta2_rad, axis=1)

    @property
    def jump_rad(self) -> np.ndarray:
        """θ2 at the end less at the start of every run (runs)."""
        return self.deflection_rad[:, -1]


def for_ensemble(case: UmbrellaCase) -> UmbrellaCase:
    """Return the case with the steps of its ensemble in both models."""
    return with_values(
        case,
        {
            "reduced.steps_per_cycle": case.ensemble.reduced_steps_per_cycle,
            "dem.steps_per_cycle": case.ensemble.dem_steps_per_cycle,
        },
    )


def gather(runs: Sequence[Columns | Run]) -> EnsembleOfRuns:
    """Stack the runs of an ensemble."""
    first = runs[0]
    return EnsembleOfRuns(
        first["time_s"],
        first["temperature_change_K"],
        np.stack([run["theta2_rad"] for run in runs]),
        np.array([[run["eccentricity_x_m"][-1], run["eccentricity_y_m"][-1]] for run in runs]),
    )


def ensemble(
    case: UmbrellaCase, runs: int | None = None, progress: Callable[[], None] = lambda: None
) -> EnsembleOfRuns:
    """Run the reduced model from ``runs`` starts (default: as the case says), on all cores.

    The result does not depend on the number of cores.
    """
    offsets = list(start_offsets(case, runs or case.ensemble.reduced_runs))
    case = for_ensemble(case)

    def one(offset: np.ndarray) -> Columns:
        columns: Columns = integrate(case, offset).columns()
        progress()
        return columns

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return gather(list(pool.map(one, offsets)))
