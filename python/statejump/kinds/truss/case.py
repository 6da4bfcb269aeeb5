# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of kind ``truss``: sections and keys (:mod:`.sections`), their checks, and the truss as arrays."""
from __future__ import annotations

from functools import cached_property

from statejump.kinds.truss import checks
from statejump.kinds.truss.plausibility import implausible
from statejump.kinds.truss.resolve import resolve
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.sections import TrussSections
from statejump.schema.fields import definition


@definition
class TrussCase(TrussSections):
    """A truss with frictional and clearance joints under one or several temperature programs."""

    @cached_property
    def _resolved(self) -> ResolvedTruss:
        return resolve(self)

    def resolve(self) -> ResolvedTruss:
        """Return the truss as arrays: indices instead of names, defaults filled in, axes of length 1. Computed once; do
        not write to it."""
        return self._resolved

    @property
    def implausible(self) -> tuple[str, ...]:
        return implausible(self.resolve())

    def check(self) -> None:
        """Raise StatejumpError for a contradiction between several keys."""
        checks.check(self, self.resolve)
