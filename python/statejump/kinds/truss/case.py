# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of kind ``truss``: their checks, and their conversion to arrays; :mod:`.sections` has sections and keys."""
from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from statejump.core.later import Later
from statejump.core.plausibility import clearances, moduli, strains
from statejump.kinds.truss import checks
from statejump.kinds.truss.elements.beam import BEAM, eccentric
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.round_parts import RoundParts
from statejump.kinds.truss.resolve import resolve
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.sections import TrussSections
from statejump.schema.fields import definition

_DERIVATIVES = Later("statejump.kinds.truss.answers.derivatives:derivatives")
_BOUNDS = Later("statejump.kinds.truss.bounds.study:bounds")


@definition
class TrussCase(TrussSections):
    """A truss with frictional and clearance joints under one or several temperature programs."""

    @cached_property
    def _resolved(self) -> ResolvedTruss:
        return resolve(self)

    def resolve(self) -> ResolvedTruss:
        """Return the truss as arrays: indices instead of names, defaults filled in, axes of length 1. The result is
        cached, so do not write to it."""
        return self._resolved

    def bounds(self, **settings: Any) -> Any:
        """Return bounds of the state jump over any temperature history.

        :param settings: those of :func:`statejump.kinds.truss.bounds.study.bounds`
        :return: :class:`statejump.kinds.truss.bounds.study.Bounds`
        :raises StatejumpError: the truss has no such bounds yet
        """
        return _BOUNDS(self, **settings)

    def gradient(self, output: str = "node", **settings: Any) -> Any:
        """Return the exact derivatives of the jump of an output by all parameters.

        :param settings: those of :func:`statejump.kinds.truss.answers.derivatives.derivatives`
        :return: :class:`statejump.kinds.truss.answers.derivatives.JumpGradient`
        :raises StatejumpError: the output does not exist, or the solver finds no path
        """
        return _DERIVATIVES(self, output=output, **settings)

    @property
    def implausible(self) -> tuple[str, ...]:
        return (*implausible(self.resolve()), *eccentric(self.beam, self.truss.dimension))

    def check(self) -> None:
        """Raise StatejumpError for a contradiction between several keys."""
        checks.check(self, self.resolve)


def implausible(truss: ResolvedTruss) -> tuple[str, ...]:
    """Return one sentence for each kind of implausible value, about the item with the worst value."""
    largest_K = np.abs(truss.temperature_ranges_K).max(axis=1)
    found: list[str] = []
    for section, parts in (("link", truss.links), (BEAM.section, truss.elements[BEAM.section])):
        found += moduli(section, parts.names, parts.young_modulus_Pa)
        if len(parts.names):
            strain = np.abs(parts.thermal_expansion_per_K * parts.temperature_fraction) * largest_K[parts.program]
            found += strains(section, parts.names, strain, "thermal")
    for kind in JOINTS:
        if isinstance(kind, RoundParts) and (joints := truss.joints.get(kind.section)) is not None:
            radius = kind.radius_m(joints, kind.inner)
            found += clearances(kind.section, joints.names, joints.radial_clearance_m, radius)
            found += moduli(kind.section, joints.names, joints.young_modulus_Pa)
    return tuple(found)
