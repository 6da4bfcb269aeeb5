# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification of a joint from a measured loop; :mod:`statejump.api` defines ``statejump.identify``."""
from __future__ import annotations

from statejump.identification.result import Identification, identified

__all__ = ["Identification", "identified"]
