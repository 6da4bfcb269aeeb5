# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured bores, given as triangle meshes."""
from __future__ import annotations

from statejump.bores.measure import Bore, bore

__all__ = ["Bore", "bore"]
