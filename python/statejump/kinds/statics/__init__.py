# SPDX-License-Identifier: GPL-3.0-or-later
"""Kind ``statics``: rest positions of a loaded clearance joint (section 2 of the paper)."""
from __future__ import annotations

from typing import ClassVar

from statejump.core.later import Later
from statejump.kinds.protocol import Kind
from statejump.kinds.statics.case import StaticsCase


class Statics(Kind):
    """The kind as one object."""

    name: ClassVar[str] = "statics"
    Case = StaticsCase

    statics = Later("statejump.kinds.statics.solve:solve")
    describe = Later("statejump.kinds.statics.summary:describe")


KIND = Statics()
