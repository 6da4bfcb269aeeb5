# SPDX-License-Identifier: GPL-3.0-or-later
"""Condensation of a deck with CalculiX: stored matrices, motions of patches, one static step for each pattern."""
