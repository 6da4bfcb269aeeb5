# SPDX-License-Identifier: GPL-3.0-or-later
"""Provenance of a result: versions, threads, seed; neither machine nor date."""
from __future__ import annotations

import platform
from typing import Any

import h5py
import numpy as np

from statejump import _paths
from statejump._version import __version__
from statejump.core.case import Case
from statejump.core.run import Run


def provenance(case: Case, dem: Run | None) -> dict[str, Any]:
    """Return the attributes of ``/provenance``.

    :param dem: the DEM run; None without one
    """
    found: dict[str, Any] = {
        "statejump_version": __version__,
        "git_commit": _paths.GIT_COMMIT,
        "python_version": platform.python_version(),
        "numpy_version": np.__version__,
        "h5py_version": h5py.__version__,
        "hdf5_version": h5py.version.hdf5_version,
    }
    sections = case.with_defaults()
    seed = sections.get("ensemble", {}).get("seed")
    if seed is not None:
        found["seed"] = seed
    if dem is not None:
        if "yade_version" in dem.about:
            found["yade_version"] = dem.about["yade_version"]
        threads = sections.get("dem", {}).get("threads")
        if threads is not None:
            found["threads"] = threads
    return found
