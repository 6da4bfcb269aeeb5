# SPDX-License-Identifier: GPL-3.0-or-later
"""Condensed bodies: linear structures of a finite-element model, reduced to their interface nodes.

The kinds import this package. It therefore exports no function that imports a kind; ``statejump.body`` has all of them.
"""
from __future__ import annotations

from statejump.bodies.body import CondensedBody, Measured, Mesh, Points, from_arrays
from statejump.bodies.files import read_body as read, write_body as write

__all__ = ["CondensedBody", "Measured", "Mesh", "Points", "from_arrays", "read", "write"]


def __dir__() -> list[str]:
    return sorted(__all__)
