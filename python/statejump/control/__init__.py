# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduction of a state jump: each study varies one parameter at a time, for any kind of case."""
