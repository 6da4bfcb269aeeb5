# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured bores as triangle meshes; :mod:`statejump.api` defines ``statejump.bore``."""
from __future__ import annotations

from statejump.bores.measure import Bore, measured

__all__ = ["Bore", "measured"]
