# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact laws: what each says of itself, curves of what it does, laws of one's own."""
from __future__ import annotations

from statejump.laws.traits import KINDS, Law, Parameter, catalogue, law, names

__all__ = ["KINDS", "Law", "Parameter", "catalogue", "law", "names"]
