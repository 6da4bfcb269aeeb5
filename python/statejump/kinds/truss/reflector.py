# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference surface through the nodes of [reflector]."""
from __future__ import annotations

import numpy as np

from statejump.core.errors import StatejumpError, located
from statejump.kinds.truss.body_points import positions_m
from statejump.kinds.truss.case import TrussCase
from statejump.surface.design import Design


def surface(case: TrussCase) -> tuple[Design, np.ndarray]:
    """Return the reflecting surface of a case, and the indices of its nodes in the truss.

    :raises StatejumpError: the case has no [reflector], or its nodes do not define a surface
    """
    truss = case.resolve()
    if truss.reflector is None:
        raise StatejumpError(code="reflector_missing", file=case.origin.file)
    nodes = np.asarray(truss.reflector.nodes)
    with located(file=case.origin.file):
        return Design.of(positions_m(truss)[nodes], truss.reflector.axis, truss.reflector.focal_length_m), nodes
