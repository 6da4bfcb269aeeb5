# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of requirements and their derivatives by the variables of the search. Only this module computes derivatives.

Derivatives of jumps are exact, from one recorded path (:mod:`statejump.kinds.truss.answers.gradient`), where all
variables are parameters of joints, links and elements. Other derivatives are central differences over paths, in one
process and without files. Their step of x is that of ``design.step``: 1e-3 gives truncation errors of about 1e-6 and
errors of located events of about 1e-6. If the truss has no path on one side, the difference is one-sided.
"""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from statejump.core.errors import Interrupted, StatejumpError
from statejump.design.file import JUMP
from statejump.design.model import Model, Setting
from statejump.design.requirements import OF_GRID, Requirement, at_setting
from statejump.kinds.truss.answers.gradient import Gradient, item_derivatives
from statejump.kinds.truss.answers.outputs import node_output
from statejump.schema.paths import split_path


def gradients(model: Model, x: np.ndarray, requirements: Sequence[Requirement], setting: Setting | None,
              step: float, values: np.ndarray) -> np.ndarray:
    """Return the derivatives (rows, variables) of the values at one point of the grid by x.

    :param values: the values (rows,) at x
    """
    mine = [one for one in requirements if (one.quantity in OF_GRID) == (setting is not None)]
    if setting is not None and model.arrays and all(one.quantity == JUMP for one in mine):
        try:
            return _exact(model, x, mine, setting)
        except Interrupted:
            raise
        except StatejumpError:
            pass  # no path with all events located: differences
    return _by_differences(model, x, requirements, setting, step, values)


def _exact(model: Model, x: np.ndarray, requirements: Sequence[Requirement], setting: Setting) -> np.ndarray:
    """Return the derivatives of jumps, from one path."""
    recorded = model.recorded(x, setting)
    names = recorded.found.truss.nodes.names
    outputs = [Gradient(recorded, node_output(recorded.found, names[node])) for one in requirements
               for node in one.nodes]
    model.solutions += sum(one.solutions for one in outputs)
    found = np.zeros((len(outputs), len(x)))
    by_items: dict[tuple[str, str], np.ndarray] = {}
    for column, (group, one) in enumerate(zip(model.groups, x)):
        for target in group.targets:
            section, item, key = split_path(target.path)
            if (section, key) not in by_items:
                by_items[section, key] = item_derivatives(outputs, section, key)
            found[:, column] += by_items[section, key][:, model.places[section][item]]
        found[:, column] *= group.slope(one) / group.factor(one)
    return found


def _by_differences(model: Model, x: np.ndarray, requirements: Sequence[Requirement], setting: Setting | None,
                    step: float, values: np.ndarray) -> np.ndarray:
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
