# SPDX-License-Identifier: GPL-3.0-or-later
"""Libraries that take long to load and that few calls need: each is imported at its first use, here alone.

Seconds are those of the import on a warm machine.
"""
from __future__ import annotations

from typing import Any


def pandas() -> Any:
    """Return pandas, for methods that make a table of it."""
    import pandas  # 0.4 s

    return pandas


def h5py() -> Any:
    """Return h5py, for what reads and writes HDF5."""
    import h5py  # 0.1 s

    return h5py


def sparse() -> Any:
    """Return SciPy's sparse matrices."""
    from scipy import sparse  # 0.1 s

    return sparse
