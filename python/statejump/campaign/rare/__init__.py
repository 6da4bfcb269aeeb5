# SPDX-License-Identifier: GPL-3.0-or-later
"""Rare events: the small probability that an outcome of a Monte Carlo campaign is beyond a limit. OpenTURNS does the
search for the design point, subset simulation and Sobol indices; it is imported when one of them runs."""
from statejump.campaign.rare.calls import rare
from statejump.campaign.rare.result import Rare

__all__ = ["Rare", "rare"]
