# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns: one model runs one case for many samples of its parameters. Large campaigns use Dask's ``distributed``."""
from statejump.campaign.calls import montecarlo, sweep
from statejump.campaign.result import Campaign

__all__ = ["Campaign", "montecarlo", "sweep"]
