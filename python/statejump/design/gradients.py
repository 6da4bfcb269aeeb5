# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of requirements and their derivatives by the variables of the search. Only this module computes derivatives.

Derivatives are central differences over paths, in one process and without files. The step of x is that of
``design.step``: 1e-3 gives truncation errors of about 1e-6 and errors of located events of about 1e-6. If the truss has
no path on one side, the difference is one-sided.
"""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from statejump.core.errors import Interrupted, StatejumpError
from statejump.design.model import Model, Setting
from statejump.design.requirements import Requirement, at_setting


def gradients(model: Model, x: np.ndarray, requirements: Sequence[Requirement], setting: Setting | None,
              step: float, values: np.ndarray) -> np.ndarray:
    """Return the derivatives (rows, variables) of the values at one point of the grid by x.

    :param values: the values (rows,) at x
    """
    columns = []
    for index in range(len(x)):
        sides = []
        for sign in (1.0, -1.0):
            moved = x.copy()
            moved[index] += sign * step
            try:
                sides.append((at_setting(model, moved, requirements, setting), sign * step))
            except Interrupted:
                raise
            except StatejumpError:
                continue
        if len(sides) == 2:
            columns.append((sides[0][0] - sides[1][0]) / (2 * step))
        else:
            columns.append((sides[0][0] - values) / sides[0][1] if sides else np.zeros_like(values))
    return np.stack(columns, axis=1)
