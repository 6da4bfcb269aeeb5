# SPDX-License-Identifier: GPL-3.0-or-later
"""Bores given by triangles: what they are, measured. Not ``bore``, which is the function of the package."""
from __future__ import annotations

from statejump.bores.measure import Bore, measured

__all__ = ["Bore", "measured"]
