# SPDX-License-Identifier: GPL-3.0-or-later
"""Libraries that load slowly and that few calls need. Only this module imports them, at their first use.

Seconds in comments are import times with warm file caches.
"""
from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

from statejump.core.errors import StatejumpError


def frame(data: Any, columns: Sequence[str] | None = None) -> Any:
    """Return data as a table of pandas."""
    import pandas  # 0.4 s

    return pandas.DataFrame(data, columns=columns)


def h5py() -> Any:
    """Return h5py, for reading and writing HDF5."""
    import h5py  # 0.1 s

    return h5py


def sparse() -> Any:
    """Return SciPy's sparse matrices."""
    from scipy import sparse  # 0.1 s

    return sparse


def scipy(part: str) -> Any:
    """Return a part of SciPy, such as ``linalg`` or ``sparse.linalg``."""
    return import_module(f"scipy.{part}")  # 0.1 s


def nlopt() -> Any:
    """Return NLopt, for searches of designs. :raises StatejumpError: it is not installed"""
    try:
        return import_module("nlopt")
    except ImportError:
        raise StatejumpError(code="nlopt_missing") from None


def openturns() -> Any:
    """Return OpenTURNS, for rare events. :raises StatejumpError: it is not installed"""
    try:
        return import_module("openturns")  # 1.7 s
    except ImportError:
        raise StatejumpError(code="openturns_missing") from None
