# SPDX-License-Identifier: GPL-3.0-or-later
"""The formula of the cost: an expression of factors with exact derivatives, by complex steps."""
from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from statejump.core.errors import NotAllowed

KEY = "cost.formula"
MASS = "mass_kg"
FUNCTIONS: dict[str, Callable[[Any], Any]] = {"sum": np.sum, "sqrt": np.sqrt, "exp": np.exp, "log": np.log}
OPERATORS: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow}
STEP = 1e-30  # of the imaginary part; its square vanishes beside 1
LONGEST, LARGEST_POWER = 10_000, 100.0


class Formula:
    """A checked formula. :raises NotAllowed: it has a name, a function or an operator that is not supported"""

    def __init__(self, text: str, names: tuple[str, ...]) -> None:
        self.text, self.names = text, (*names, MASS)
        if len(text) > LONGEST:
            raise self._refused("longer than a formula may be")
        try:
            self.tree = ast.parse(text, mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise self._refused("not an expression") from None
        self.uses_mass = any(isinstance(one, ast.Name) and one.id == MASS for one in ast.walk(self.tree))
        self(dict.fromkeys(self.names, np.ones(1, dtype=complex)))

    def _refused(self, reason: str) -> NotAllowed:
        return NotAllowed(KEY, self.text, code="design_bad_formula", reason=reason, names=", ".join(self.names))

    def __call__(self, values: Mapping[str, np.ndarray]) -> complex:
        """Return the cost. :raises NotAllowed: it is not one finite number"""
        with np.errstate(all="ignore"):
            found = np.asarray(self._value(self.tree, values))
        if found.size != 1 or not np.isfinite(found).all():
            raise self._refused("not one finite number; use sum() for all factors of a variable")
        return complex(found.ravel()[0])

    def _value(self, node: ast.AST, values: Mapping[str, np.ndarray]) -> Any:
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return float(node.value)
        if isinstance(node, ast.Name) and node.id in values:
            return values[node.id]
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
            found = self._value(node.operand, values)
            return -found if isinstance(node.op, ast.USub) else found
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            left, right = self._value(node.left, values), self._value(node.right, values)
            if isinstance(node.op, ast.Pow) and not np.all(np.abs(right) <= LARGEST_POWER):
                raise self._refused(f"a power above {LARGEST_POWER:g}")
            return OPERATORS[type(node.op)](np.asarray(left, dtype=complex), right)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS \
                and len(node.args) == 1 and not node.keywords:
            return FUNCTIONS[node.func.id](np.asarray(self._value(node.args[0], values), dtype=complex))
        raise self._refused(f"{ast.unparse(node)!r} is not supported")

    def gradient(self, values: Mapping[str, np.ndarray], slopes: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return the derivatives (k,) along k directions; ``slopes`` has the derivatives (k, n) of the values."""
        count = len(next(iter(slopes.values())))
        steps = ({name: values[name] + 1j * STEP * slopes[name][index] for name in values} for index in range(count))
        return np.array([self(one).imag / STEP for one in steps])
