# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact laws: descriptions, response of a law along a path, curves, and laws of the user."""
from __future__ import annotations

from statejump.laws.drive import drive
from statejump.laws.traits import KINDS, Law, Parameter, catalogue, law, names

__all__ = ["KINDS", "Law", "Parameter", "catalogue", "drive", "law", "names"]


def __dir__() -> list[str]:
    return sorted(__all__)
