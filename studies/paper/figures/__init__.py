# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures 13 to 16 of the paper with both models, and its claims tested: ``statejump figures``."""
