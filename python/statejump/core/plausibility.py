# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about allowed but implausible values, mostly due to wrong units: one for each kind of value, about the worst
item."""
from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence

import numpy as np

from statejump.core.notes import Note

LEAST_MODULUS_PA = 1e6  # modulus of soft rubber; foams are no links
LARGEST_STRAIN = 0.1  # limit of the linear elastic models
# No structure in space is assembled at a lower temperature. 20 °C, written as kelvin, is lower.
LEAST_REFERENCE_K = 100.0


def _others(count: int) -> str:
    return "" if not count else " and 1 other" if count == 1 else f" and {count:,} others"


def clearances(what: str, names: Sequence[str], clearance_m: np.ndarray, radius_m: np.ndarray) -> Iterable[str]:
    """Yield a sentence about joints whose clearance exceeds the radius of the inner part.

    :param what: type of the joints, for example ``revolute``
    """
    found = np.flatnonzero(clearance_m > radius_m)
    if len(found):
        worst = found[np.argmax(clearance_m[found] / radius_m[found])]
        yield Note("clearance_above_radius", what=what, name=names[worst], others=_others(len(found) - 1),
                   clearance_m=float(clearance_m[worst]), radius_m=float(radius_m[worst]), items=len(found))


def moduli(what: str, names: Sequence[str], young_modulus_Pa: np.ndarray) -> Iterable[str]:
    """Yield a sentence on items softer than rubber."""
    found = np.flatnonzero(young_modulus_Pa < LEAST_MODULUS_PA)
    if len(found):
        worst = found[np.argmin(young_modulus_Pa[found])]
        yield Note("modulus_implausible", what=what, name=names[worst], others=_others(len(found) - 1),
                   young_modulus_Pa=float(young_modulus_Pa[worst]), items=len(found))


def strains(what: str, names: Sequence[str], strain: np.ndarray, cause: str) -> Iterable[str]:
    """Yield a sentence about items with a strain of more than 10 %.

    :param strain: largest absolute strain of each item
    :param cause: cause of the strain, for example ``thermal``
    """
    found = np.flatnonzero(strain > LARGEST_STRAIN)
    if len(found):
        worst = found[np.argmax(strain[found])]
        yield Note("strain_implausible", what=what, name=names[worst], others=_others(len(found) - 1), cause=cause,
                   strain=float(strain[worst]), items=len(found))


def warn_of_reference(key: str, reference_temperature_K: float) -> None:
    """Warn of a reference temperature that looks like degrees Celsius."""
    if reference_temperature_K < LEAST_REFERENCE_K:
        celsius, kelvin = reference_temperature_K - 273.15, reference_temperature_K + 273.15
        warnings.warn(Note("reference_in_kelvin", key=key, given=reference_temperature_K, celsius=celsius,
                           kelvin=kelvin), stacklevel=2)


def axial_strains(names: Sequence[str], axial_force_N: np.ndarray, rigidity_N: np.ndarray) -> Iterable[str]:
    """Yield a sentence about links whose axial strain due to forces exceeds 10 %.

    :param axial_force_N: (samples, links)
    :param rigidity_N: axial rigidity E A of every link
    """
    if axial_force_N.size:
        with np.errstate(invalid="ignore"):
            yield from strains("link", names, np.abs(axial_force_N).max(axis=0) / rigidity_N, "axial")
