# SPDX-License-Identifier: GPL-3.0-or-later
"""Searches of SciPy and NLopt for the point of least cost."""
from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from statejump.core import libraries
from statejump.design.file import COBYLA, NLOPT, SLSQP
from statejump.design.problem import RADIUS, Problem

MOST_SHORT, SHORT = 12, 8  # short steps, and iterations of each
COBYLA_PATHS = 20  # evaluations per iteration of the other methods
FIRST = 0.3  # first change of x
COBYLA_RADIUS = 1.0
MOST_REPEATED = 8  # searches with SLSQP, each from the end of the last
GAIN = 1e-4  # relative decrease of the cost for which a search is repeated


def search(problem: Problem, method: str, x: np.ndarray, iterations: int, tolerance: float) -> str:
    """Search from a point; the problem keeps the best point. Return how the search ended."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of steps outside of the bounds
        return {SLSQP: _slsqp, COBYLA: _cobyla, NLOPT: _nlopt}.get(method, _trust)(problem, x, iterations, tolerance)


def short_steps(problem: Problem, method: str, x: np.ndarray, tolerance: float) -> str:
    """Search from a point in boxes of limited size, so that no step leads across the top of a tent."""
    message = ""
    for _ in range(MOST_SHORT):
        problem.centre = x
        message = search(problem, method, x, SHORT, tolerance)
        moved, x = np.abs(problem.best.x - x), problem.best.x
        if problem.best.margin >= 0 and moved.max() < 0.99 * RADIUS or moved.max() < tolerance:
            break
    problem.centre = None
    return f"short steps: {message}"


def _slsqp(problem: Problem, x: np.ndarray, iterations: int, tolerance: float) -> str:
    """Search with SLSQP. A search that ends is repeated from its end without its curvature, until that gains nothing:
    the approximate curvature may end a search in a valley of the cost."""
    constraint = {"type": "ineq", "fun": problem.margins, "jac": problem.margin_gradients}
    last = np.inf
    for _ in range(MOST_REPEATED):
        found = libraries.scipy("optimize").minimize(
            lambda at: problem.cost(at) / problem.scale, x, jac=lambda at: problem.cost_gradient(at) / problem.scale,
            bounds=problem.bounds, constraints=[constraint], method="SLSQP",
            options={"maxiter": iterations, "ftol": tolerance})
        if not found.fun < last - max(tolerance, GAIN) * abs(found.fun):
            break
        x, last = found.x, found.fun
    return str(found.message)


def _trust(problem: Problem, x: np.ndarray, iterations: int, tolerance: float) -> str:
    optimize = libraries.scipy("optimize")
    constraint = optimize.NonlinearConstraint(problem.margins, 0.0, np.inf, jac=problem.margin_gradients,
                                              hess=optimize.BFGS())
    found = optimize.minimize(
        lambda at: problem.cost(at) / problem.scale, x,
        jac=lambda at: problem.cost_gradient(at) / problem.scale,
        hess=optimize.BFGS(), constraints=[constraint],
        bounds=optimize.Bounds(*np.transpose(problem.bounds), keep_feasible=False), method="trust-constr",
        options={"maxiter": iterations, "gtol": tolerance, "xtol": tolerance, "initial_tr_radius": FIRST})
    return str(found.message)


def _cobyla(problem: Problem, x: np.ndarray, iterations: int, tolerance: float) -> str:
    low, high = np.transpose(problem.bounds)
    constraints = [{"type": "ineq", "fun": problem.margins}, {"type": "ineq", "fun": lambda x: x - low},
                   {"type": "ineq", "fun": lambda x: high - x}]
    found = libraries.scipy("optimize").minimize(
        lambda at: problem.cost(at) / problem.scale, x, constraints=constraints, method="COBYLA",
        options={"maxiter": COBYLA_PATHS * iterations, "rhobeg": COBYLA_RADIUS, "tol": tolerance})
    return str(found.message)


def _nlopt(problem: Problem, x: np.ndarray, iterations: int, tolerance: float) -> str:
    nlopt = libraries.nlopt()
    solver = nlopt.opt(nlopt.LD_MMA, len(x))
    solver.set_lower_bounds([low for low, _ in problem.bounds])
    solver.set_upper_bounds([high for _, high in problem.bounds])

    def cost(at: np.ndarray, gradient: Any) -> float:
        if gradient.size:
            gradient[:] = problem.cost_gradient(at) / problem.scale
        return problem.cost(at) / problem.scale

    def violated(result: np.ndarray, at: np.ndarray, gradient: Any) -> None:
        result[:] = -problem.margins(at)
        if gradient.size:
            gradient[:] = -problem.margin_gradients(at)

    solver.set_min_objective(cost)
    solver.add_inequality_mconstraint(violated, np.zeros(len(problem.rows)))
    solver.set_ftol_rel(tolerance)
    solver.set_maxeval(iterations)
    solver.optimize(x)
    return f"NLopt ended with {solver.last_optimize_result()}"
