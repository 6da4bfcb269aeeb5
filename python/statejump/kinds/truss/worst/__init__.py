# SPDX-License-Identifier: GPL-3.0-or-later
"""Search for the temperature history with the largest state jump, or the largest excursion, of a truss."""
from __future__ import annotations
