# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of a reflecting surface whose nodes move: RMS, tilt, focal change, Zernike terms, pointing.

::

    import statejump as sj

    design = sj.surface.Design.of(position_m, axis=(0, 0, 1), focal_length_m=2.0)
    found = design.errors(displacement_m)
    found.rms_m["rigid_focal"], found.tilt_rad, found.focal_change_m
    sj.surface.pointing_rad(position_m, displacement_m, (0, 0, 1))
    sj.surface.history(case.reduced())      # of a truss with a [reflector], over time
"""
from __future__ import annotations

from statejump.surface.design import DEFINITIONS, MEASURES, Design, Errors
from statejump.surface.motion import pointing_rad, rotation_rad
from statejump.surface.repeatability import Repeatability, repeatability
from statejump.surface.runs import history, reflector_of
from statejump.surface.zernike import noll, zernike

__all__ = ["DEFINITIONS", "MEASURES", "Design", "Errors", "Repeatability", "history", "noll", "pointing_rad",
           "reflector_of", "repeatability", "rotation_rad", "zernike"]


def __dir__() -> list[str]:
    return sorted(__all__)
