# SPDX-License-Identifier: GPL-3.0-or-later
"""What a measured loop says of a joint. Not ``identify``, which is the function of the package."""
from __future__ import annotations

from statejump.identification.result import Identification, identified

__all__ = ["Identification", "identified"]
