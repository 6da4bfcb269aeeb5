# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies of the paper: its figures and claims, slow heating, a joint left alone, the energy account."""
