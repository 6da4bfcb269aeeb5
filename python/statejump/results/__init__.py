# SPDX-License-Identifier: GPL-3.0-or-later
"""One HDF5 file per run: what was asked, what came out, what to draw.

The layout is :mod:`.layout`, in words docs/result_file.md. To read a file::

    from statejump.results import read
    result = read("results/table1/comparison.h5")
    result.models["dem"].history["displacement_m"].values
"""
from statejump.results.contents import Column, Event, ModelRun, Result, Scalar
from statejump.results.read import read
from statejump.results.write import write

__all__ = ["Column", "Event", "ModelRun", "Result", "Scalar", "read", "write"]
