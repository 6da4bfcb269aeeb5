# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification of a joint from a measured loop."""
from __future__ import annotations

from statejump.identification.result import Identification, identify

__all__ = ["Identification", "identify"]
