# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduction of a state jump: one-at-a-time studies of parameters, for any kind of case."""
