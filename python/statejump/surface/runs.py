# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors of the reflecting surface of a truss over the time of a run, for either model."""
from __future__ import annotations

import numpy as np

from statejump.core.case import Case
from statejump.core.errors import StatejumpError
from statejump.core.run import Run
from statejump.kinds import require
from statejump.kinds.protocol import ReflectorSurface
from statejump.surface.design import DEFINITIONS, Design, check_measure, rms
from statejump.surface.motion import pointing_rad


def reflector_of(case: Case) -> tuple[Design, np.ndarray]:
    """Return the reference surface of a case and the indices of its nodes.

    :raises StatejumpError: the kind of case has no surface, or the case has no [reflector]
    """
    found: tuple[Design, np.ndarray] = require(case, ReflectorSurface).surface(case)
    return found


def displacements_m(run: Run, design: Design, nodes: np.ndarray) -> np.ndarray:
    """Return the displacements (samples, nodes, 3) of the nodes and points of a surface [m]."""
    places = [np.asarray(run.history[key].values) for key in ("position_m", "point_position_m") if key in run.history]
    return np.asarray(np.concatenate(places, axis=1)[:, nodes] - design.position_m)


def history(run: Run, measure: str = "normal") -> dict[str, np.ndarray]:
    """Return the errors of the surface at every sample of a run of a truss, relative to the reference configuration.

    :param measure: as for :meth:`~statejump.surface.Design.errors`
    :return: arrays by column: ``time_s``, ``temperature_change_K``, RMS by definition, tilt, focal change (NaN: not
        determined), pointing error of the axis under the rigid motion of the nodes (NaN: they lie on one line)
    :raises StatejumpError: the run is not that of a truss with a [reflector]
    """
    design, nodes = reflector_of(run.definition)
    moved = displacements_m(run, design, nodes)
    check_measure(measure)
    residual, moves = design.best_fits(moved, measure)
    best = moves["rigid_focal"]
    columns = {name: np.asarray(run.history[name].values) for name in ("time_s", "temperature_change_K")}
    for name in DEFINITIONS:
        columns[f"rms_{name}_m"] = rms(residual[name])
    for place in range(len(design.frame) - 1):
        columns[f"tilt_{place + 1}_rad"] = best[f"tilt{place}"]
    columns["focal_change_m"] = design.focal_change_m(best)
    try:
        columns["pointing_error_rad"] = pointing_rad(design.position_m, moved, design.frame[-1].tolist())
    except StatejumpError:
        columns["pointing_error_rad"] = np.full(len(moved), np.nan)
    return columns
