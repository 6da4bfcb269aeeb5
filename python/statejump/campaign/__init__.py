# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns: one case, many samples of its parameters, either model. Large campaigns use Dask's ``distributed``."""
from statejump.campaign.calls import montecarlo, sweep
from statejump.campaign.result import Campaign

__all__ = ["Campaign", "montecarlo", "sweep"]
