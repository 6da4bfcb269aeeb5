# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns: one case, many samples of its parameters, either model, on Dask's ``distributed``."""
from __future__ import annotations

from .commands import montecarlo_command, sweep_command

__all__ = ["montecarlo_command", "sweep_command"]
