# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies of the paper: figures and claims, slow heating, a joint at constant load, energy account."""
