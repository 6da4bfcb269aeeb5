# SPDX-License-Identifier: GPL-3.0-or-later
"""Axial springs between bodies."""
from __future__ import annotations

from typing import Any

from yade import wrapper


def spring(id1: int, id2: int, stiffness: float, length: float, **attributes: Any) -> wrapper.ThermalLink:
    """Return an axial spring between the centres of two bodies, without thermal expansion.

    It is a ThermalLink with the axial rigidity E A = k l0. Append it to ``ThermalLinks.links``.

    :param id1: body at the root
    :param id2: body at the tip
    :param stiffness: k [N/m]
    :param length: stress-free length l0 [m]
    :param attributes: other attributes of a ThermalLink: ``program``, ``dampingRatio``, ``tensionOnly``
    """
    area = 1.0  # [m2]
    return wrapper.ThermalLink(
        id1=id1, id2=id2, youngModulus=stiffness * length / area, crossSectionArea=area, stressFreeLength=length,
        **attributes,
    )
