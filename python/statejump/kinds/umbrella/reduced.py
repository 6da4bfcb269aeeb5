# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduced model of an ``umbrella`` case: motion of the links, and their quasi-static path."""
from __future__ import annotations


import numpy as np

from statejump import _engine
from statejump.core.engine_failures import engine
from statejump.core.progress import OnProgress
from statejump.core.run import Run
from statejump.kinds.umbrella import result
from statejump.kinds.umbrella.case import UmbrellaCase, UmbrellaLink


def _link(link: UmbrellaLink) -> _engine.ThermalLink:
    return _engine.ThermalLink(**link.to_dict())


def linkage(case: UmbrellaCase) -> _engine.Linkage:
    """Return the engine's model of a case. :raises ValueError: a value of the case is out of range"""
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

    :param offset_m: offset (2) [m] to add to the initial position of the journal; not for a ``loaded`` start
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
    """Integrate the motion of a case over its whole program.

    :param offset_m: see :func:`start_state`
    :raises FailedRun: a contact law was used outside its range, or steps are too long; the message has the time
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
    """Return the quasi-static path of the loaded joint with rigid links and exact friction; None if statics does not
    determine the path."""
    try:
        return _engine.joint_loop(
            linkage(case), case.thermal_program(), case.start.contact_angle_rad, samples
        )
    except _engine.EngineFailure:
        return None
