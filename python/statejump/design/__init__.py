# SPDX-License-Identifier: GPL-3.0-or-later
"""Design of trusses: variables of least cost that meet requirements over a grid of friction and clearances."""
