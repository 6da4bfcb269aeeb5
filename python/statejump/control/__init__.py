# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduction of a state jump: studies of one parameter after another, for any kind of case."""
