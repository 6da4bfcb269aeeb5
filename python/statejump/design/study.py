# SPDX-License-Identifier: GPL-3.0-or-later
"""The design of a truss, from a design file to a case with its checks."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from statejump.campaign.campaign_file import vary_of
from statejump.campaign.plan import MONTECARLO
from statejump.core.errors import Interrupted, MissingKey, NotAllowed, StatejumpError, located
from statejump.core.progress import OnProgress
from statejump.design import checks
from statejump.design.cost import Formula
from statejump.design.file import COBYLA, NLOPT, OF_PATH, DesignFile
from statejump.design.model import NOMINAL, Model, Setting
from statejump.design.problem import Best, Problem
from statejump.design.requirements import Requirement, at_setting, requirements_of
from statejump.design.result import Design, Stage
from statejump.design.search import search, short_steps
from statejump.design.variables import groups_of
from statejump.core import libraries
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.solve import solve
from statejump.schema.paths import plain
from statejump.schema.structure import structure
from statejump.schema.toml import read_toml

SEARCHES, SAMPLES = 0.6, 0.8  # finished fractions after the searches and after the random samples
COARSE = 1e-3  # tolerance of searches whose result is only a start
AGREE = 1e-3  # relative difference between the search and the run of the case that is reported
PROBE = 1e-2  # change of the variables for the comparison of arrays with cases
SAME = 1e-6
TINY = 1e-300
Tables = list[tuple[str, Mapping[str, Any]]]


def design(case: TrussCase, wanted: str | Path | Mapping[str, Any],
           on_progress: OnProgress = lambda share: None) -> Design:
    """Return the design of least cost that meets all requirements over a grid of friction and clearances.

    After Ctrl-C the result has the best design so far, and ``interrupted`` is true.

    :param wanted: path of a design file, or its sections as a dict
    :raises StatejumpError: the design file is invalid for this case
    """
    file = None if isinstance(wanted, Mapping) else Path(wanted)
    data = read_toml(file, "design")[1] if file is not None else plain(wanted)
    with located(file=file):
        settings = structure(DesignFile, data)
        tables: Tables = [(f"scatter[{number}]", table) for number, table in enumerate(settings.scatter, start=1)]
        if not all(isinstance(table, Mapping) for _, table in tables):
            raise MissingKey("scatter", code="campaign_without_vary", section="[[scatter]]")
        vary_of(tables, case, MONTECARLO)
        model = Model(case, groups_of(case, settings.variable))
        requirements = requirements_of(case, settings.requirement)
        formula = Formula(settings.cost.formula, tuple(dict.fromkeys(group.name for group in model.groups)))
        grid = _grid(settings.robust)
        if settings.design.method == NLOPT:
            libraries.nlopt()
    model.arrays = model.arrays and _agree(model, requirements)
    return _designed(settings, model, requirements, formula, grid, tables, on_progress)


def _grid(robust: Any) -> list[Setting]:
    for key in ("friction", "clearance"):
        if not getattr(robust, key) or min(getattr(robust, key)) <= 0:
            raise NotAllowed(f"robust.{key}", getattr(robust, key), code="design_bad_grid")
    return [Setting(*pair) for pair in product(dict.fromkeys(robust.friction), dict.fromkeys(robust.clearance))]


def _agree(model: Model, requirements: Sequence[Requirement]) -> bool:
    """Return whether arrays with changed values are those of the case with these values."""
    x = np.array([group.start for group in model.groups])
    low, high = np.transpose([(group.x(group.low), group.x(group.high)) for group in model.groups])
    x = np.where(x + PROBE < high, x + PROBE, np.maximum(x - PROBE, low))
    setting = Setting(1 + PROBE, 1 + PROBE)
    some = [one for one in requirements if one.of_path]
    found = []
    for model.arrays in (True, False):
        try:
            found.append(at_setting(model, x, some, setting))
        except Interrupted:
            raise
        except StatejumpError:
            return False
    return bool(np.abs(found[0] - found[1]).max(initial=0.0) <= SAME * np.abs(found[0]).max(initial=0.0))


def _stages(settings: DesignFile, grid: Sequence[Setting]) -> list[tuple[str, list[Setting]]]:
    """Return the searches. The first one stays on the rising side of the tent, the second one covers the grid."""
    rising = [Setting(one.friction) for one in grid if one.friction <= 1]
    rising = list(dict.fromkeys([*rising, NOMINAL]))
    whole = ("whole grid", list(grid))
    of_path = any(one.quantity in OF_PATH for one in settings.requirement)
    if settings.design.method == COBYLA or not of_path or set(grid) <= set(rising):
        return [whole]
    return [("friction up to that of the case", rising), whole]


def _designed(settings: DesignFile, model: Model, requirements: list[Requirement], formula: Formula,
              grid: list[Setting], tables: Tables, on_progress: OnProgress) -> Design:
    wanted, stages = _stages(settings, grid), list[Stage]()
    start = np.array([group.start for group in model.groups])
    x, interrupted, given, problem = start, False, settings.design, None
    for number, (name, points) in enumerate(wanted):
        problem = Problem(model, formula, requirements, points, given.step,
                          lambda share, done=number: on_progress(  # type: ignore[misc]
                              SEARCHES * (done + share) / len(wanted)), given.iterations)
        paths, solutions = model.paths, model.solutions
        try:
            last = number + 1 == len(wanted)
            tolerance = given.tolerance if last else max(given.tolerance, COARSE)
            message = search(problem, given.method, x, given.iterations, tolerance)
            if problem.best.margin < 0 and given.method != COBYLA:
                problem.best = Best(x)
                message = short_steps(problem, given.method, x, tolerance)
        except (KeyboardInterrupt, Interrupted):
            interrupted, message = True, "interrupted"
        stages.append(Stage(name, problem.best.cost, model.paths - paths, problem.derivatives,
                            model.solutions - solutions, message))
        x = problem.best.x if interrupted or problem.best.margin >= 0 or number + 1 == len(wanted) else start
        if interrupted:
            break
    assert problem is not None
    if interrupted:  # the last search may have had only a part of the grid
        problem = Problem(model, formula, requirements, grid, given.step, on_progress, given.iterations)
    return _checked(settings, problem, x, start, stages, tables, interrupted, on_progress)


def _checked(settings: DesignFile, problem: Problem, x: np.ndarray, start: np.ndarray, stages: list[Stage],
             tables: Tables, interrupted: bool, on_progress: OnProgress) -> Design:
    """Return the result after its checks, which an interrupted design does not get."""
    model, requirements, given = problem.model, problem.requirements, settings.design
    problem.on_progress = lambda share: None
    values = problem.values(x)
    margins = problem.margins_of(values)
    notes = [f"{problem.failures} points of the search have no path, for example: {problem.first_failure}"] \
        if problem.failures else []
    case = model.case(x, name=f"{model.base.name}_designed")
    elasticities, price, shape, scatter, rare = np.full(len(x), np.nan), dict[str, float](), None, None, None
    critical = int(np.argmin(margins))
    try:
        if not interrupted:
            elasticities = _elasticities(problem, x, values, critical)
            price = checks.prices(problem, x)
            shape = checks.profile(model, x, start, requirements)
            notes += _confirmed(model, case, x, requirements)
            on_progress(SEARCHES)
            if tables and given.samples:
                scatter = checks.scattered(
                    case, tables, requirements, given.samples, given.seed,
                    lambda share: on_progress(SEARCHES + (SAMPLES - SEARCHES) * share))
                few = scatter.violated <= checks.FEW and not (shape is not None and shape.falling)
                if given.tail and few and margins.min() >= 0:
                    rare, reason = checks.tail(case, tables, problem.rows[critical], given.seed,
                                               lambda share: on_progress(SAMPLES + (1 - SAMPLES) * share))
                    notes += [reason] if reason else []
            on_progress(1.0)
    except (KeyboardInterrupt, Interrupted):
        interrupted = True
        notes.append("interrupted: checks are incomplete")
    return Design(model.base, case, model.groups, x, problem.cost(x), problem.cost(start), problem.rows, values,
                  margins, problem.values(start), elasticities, price, shape, scatter, rare, stages, notes,
                  given.method, given.step, interrupted)


def _elasticities(problem: Problem, x: np.ndarray, values: np.ndarray, row: int) -> np.ndarray:
    """Return d ln(value)/d ln(factor) of the critical row, for shifts d ln(value)/dx."""
    wanted = problem.rows[row].requirement
    slope = problem.margin_gradients(x)[row] * (abs(wanted.limit) or 1.0) * (-1.0 if wanted.most else 1.0)
    scale = [1.0 if group.log or group.shifts else one for group, one in zip(problem.model.groups, x)]
    return np.asarray(slope * np.array(scale) / (values[row] or np.nan))


def _confirmed(model: Model, case: TrussCase, x: np.ndarray, requirements: Sequence[Requirement]) -> list[str]:
    """Return a note if the run of the designed case differs from the search."""
    some = [one for one in requirements if one.of_path]
    if not some:
        return []
    own = at_setting(model, x, some, NOMINAL)
    run = np.concatenate([one.values(solve(case)) for one in some])
    apart = float(np.abs(run - own).max() / max(np.abs(own).max(), *(abs(one.limit) for one in some), TINY))
    return [f"the run of {case.name} differs from the search by {100 * apart:.2g} %"] if apart > AGREE else []
