# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies for the paper: its figures and claims, slow heating, a joint at constant load, energy account."""
