# SPDX-License-Identifier: GPL-3.0-or-later
"""Generators of trusses: functions that return case documents. :mod:`statejump.truss` converts these to cases."""
from __future__ import annotations

from collections.abc import Callable

from statejump.kinds.truss.generate.document import Document
from statejump.kinds.truss.generate.lattices import mast, ring
from statejump.kinds.truss.generate.planar import chain, iwan, umbrella

GENERATORS: dict[str, Callable[..., Document]] = {
    "chain": chain, "iwan": iwan, "umbrella": umbrella, "ring": ring, "mast": mast,
}
__all__ = ["GENERATORS", "chain", "iwan", "mast", "ring", "umbrella"]
