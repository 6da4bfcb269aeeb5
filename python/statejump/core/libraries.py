# SPDX-License-Identifier: GPL-3.0-or-later
"""Libraries that load slowly and that few calls need. Only this module imports them, at their first use.

The seconds are import times on a warm machine.
"""
from __future__ import annotations

from typing import Any


def pandas() -> Any:
    """Return pandas, for methods that return tables."""
    import pandas  # 0.4 s

    return pandas


def h5py() -> Any:
    """Return h5py, for reading and writing HDF5."""
    import h5py  # 0.1 s

    return h5py


def sparse() -> Any:
    """Return SciPy's sparse matrices."""
    from scipy import sparse  # 0.1 s

    return sparse
