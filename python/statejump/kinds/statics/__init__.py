# SPDX-License-Identifier: GPL-3.0-or-later
"""Kind ``statics``: where a loaded clearance joint can rest, the paper's section 2."""
from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from statejump.kinds.protocol import Kind
from statejump.kinds.statics.case import StaticsCase

if TYPE_CHECKING:
    from statejump.kinds.statics.solve import Statics as RestSets


class Statics(Kind):
    """The kind as one object."""

    name: ClassVar[str] = "statics"
    Case = StaticsCase

    def statics(self, case: StaticsCase, friction_coefficient: float | None = None) -> RestSets:
        from statejump.kinds.statics import solve

        return solve.solve(case, friction_coefficient)

    def describe(self, case: StaticsCase) -> list[str]:
        from statejump.kinds.statics import words

        return words.describe(case)


KIND = Statics()
