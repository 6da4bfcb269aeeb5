# SPDX-License-Identifier: GPL-3.0-or-later
"""Guaranteed bounds of the state jump of trusses whose friction limits are given; docs/theory/bounds.md."""
from __future__ import annotations
