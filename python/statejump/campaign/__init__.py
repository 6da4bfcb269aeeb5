# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns: one case, many samples of its parameters, either model, on Dask's ``distributed``."""
