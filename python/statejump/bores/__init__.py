# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured bores, given as triangle meshes. The function ``statejump.bore`` is in :mod:`statejump.api`."""
from __future__ import annotations

from statejump.bores.measure import Bore, measured

__all__ = ["Bore", "measured"]
