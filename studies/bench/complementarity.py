# SPDX-License-Identifier: GPL-3.0-or-later
"""Fraction of random frictional contact problems that are solved, with iterations and time.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/complementarity.py [--problems 10000] [--siconos 10]

Problems are of the six families of studies/bench/piles.py, in the plane and in space, with 1 to 200 contacts. With
--siconos N, the solvers of Debian's python3-siconos also solve the first N problems of each family and dimension, and
Siconos' merit function judges all solutions. Writes results/bench/complementarity.md.
"""
from __future__ import annotations

import argparse
import multiprocessing
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, product
from pathlib import Path
from typing import Any

import numpy as np
from piles import FAMILIES

from statejump import fclib
from statejump.core.output import write_atomically

LARGEST, TOLERANCE = 200, 1e-10
HEAD = f"""# Frictional contact problems: share solved, iterations, time

`PYTHONPATH=build/python /usr/bin/python3 studies/bench/complementarity.py --problems N --siconos M`:
random problems with one contact to {LARGEST}, as many small as large ones (logarithmic), friction 0 to 1, W of any
rank.
Solved: both merits of
[complementarity.md](../../docs/theory/complementarity.md) are at most {TOLERANCE:g}. CPU time of one core.
"""


@dataclass(frozen=True)
class Run:
    """One problem and what came of it."""

    family: str
    dimension: int
    contacts: int
    deficient: bool
    solved: bool
    method: str
    systems: int
    seconds: float


def problems(seed: int) -> Iterator[tuple[str, int, fclib.Problem, int]]:
    """Yield problems, one of each family in each dimension, and the degrees of freedom of each problem."""
    random = np.random.default_rng(seed)
    for (family, make), dimension in product(FAMILIES.items(), (2, 3)):
        contacts = round(float(np.exp(random.uniform(0.0, np.log(LARGEST)))))
        yield family, dimension, *make(dimension, contacts, random)


def runs_of(seed: int) -> list[Run]:
    """Solve the problems of a seed."""
    found = []
    for family, dimension, problem, freedoms in problems(seed):
        start = time.process_time()
        solution = fclib.solve(problem)
        seconds = time.process_time() - start
        systems = solution.iterations["newton"] + solution.iterations["interior_point"]
        found.append(Run(family, dimension, problem.contacts, freedoms < problem.q.size, solution.solved,
                         solution.method, systems, seconds))
    return found


def percent(values: Sequence[bool]) -> str:
    """Return a fraction of solved problems in percent; 100 % only if all are solved."""
    return "100" if all(values) else f"{min(100.0 * sum(values) / len(values), 99.99):.2f}"


def ours(number: int, seed: int, workers: int, most_seconds: float) -> list[str]:
    """Return the table of this project's solver: fraction of problems solved within time limits."""
    end = time.monotonic() + most_seconds
    batches = range(seed, seed + -(-number // (2 * len(FAMILIES))))
    found: list[Run] = []
    with multiprocessing.Pool(workers) as pool:
        for runs in pool.imap(runs_of, batches):
            found += runs
            if time.monotonic() > end:
                break
    lines = ["| family | dimension | problems | most contacts | rank-deficient [%] | solved [%] | ended by | "
             "systems, 99 % | median time [ms] | 99 % [ms] | longest [s] |",
             "|---|--:|--:|--:|--:|--:|---|--:|--:|--:|--:|"]
    for family, dimension in product(FAMILIES, (2, 3)):
        lines.append(_row(family, str(dimension),
                          [run for run in found if (run.family, run.dimension) == (family, dimension)]))
    lines.append(_row("all", "", found))
    lines.append(_row(f"{LARGEST // 2} contacts or more", "", [run for run in found if run.contacts >= LARGEST // 2]))
    return lines


def _row(name: str, dimension: str, runs: Sequence[Run]) -> str:
    seconds = np.array([run.seconds for run in runs])
    ways = Counter(run.method for run in runs if run.solved)
    by = ", ".join(f"{way.replace('_', ' ')} {count}" for way, count in ways.most_common())
    return (f"| {name} | {dimension} | {len(runs)} | {max(run.contacts for run in runs)} | "
            f"{100 * np.mean([run.deficient for run in runs]):.0f} | {percent([run.solved for run in runs])} | {by} | "
            f"{np.quantile([run.systems for run in runs], 0.99):.0f} | {1e3 * np.median(seconds):.2g} | "
            f"{1e3 * np.quantile(seconds, 0.99):.3g} | {seconds.max():.2g} |")


def beside_siconos(number: int, seed: int) -> list[str]:
    """Return a table of this project's solver beside those of Siconos, for some of the problems."""
    import siconos.numerics as sn

    named = {2: {"NSGS": sn.SICONOS_FRICTION_2D_NSGS, "Lemke": sn.SICONOS_FRICTION_2D_LEMKE},
             3: {"NSGS": sn.SICONOS_FRICTION_3D_NSGS, "Newton, Alart-Curnier": sn.SICONOS_FRICTION_3D_NSN_AC,
                 "ADMM": sn.SICONOS_FRICTION_3D_ADMM}}
    found: dict[tuple[int, str], list[tuple[float, float]]] = defaultdict(list)
    for _, dimension, problem, _ in chain.from_iterable(problems(seed + k) for k in range(number)):
        start = time.process_time()
        solution = fclib.solve(problem)
        seconds = time.process_time() - start
        found[dimension, "statejump"].append((solution.merit.natural_map, seconds))
        for name, identifier in named[dimension].items():
            start = time.process_time()
            reactions = _siconos(sn, identifier, dimension, problem)
            seconds = time.process_time() - start
            finite = np.isfinite(reactions).all()
            reached = fclib.merit(problem, reactions).natural_map if finite else np.inf
            found[dimension, name].append((reached, seconds))
    lines = ["| dimension | solver | problems | to 1e-10 [%] | to 1e-6 [%] | median time [ms] | longest [s] |",
             "|--:|---|--:|--:|--:|--:|--:|"]
    for (dimension, name), runs in sorted(found.items()):
        seconds = [run[1] for run in runs]
        lines.append(f"| {dimension} | {name} | {len(runs)} | {percent([run[0] <= TOLERANCE for run in runs])} | "
                     f"{percent([run[0] <= 1e-6 for run in runs])} | {1e3 * np.median(seconds):.2g} | "
                     f"{max(seconds):.2g} |")
    return lines


def _siconos(sn: Any, identifier: int, dimension: int, problem: fclib.Problem) -> Any:
    reactions, velocities = np.zeros(problem.q.size), np.zeros(problem.q.size)
    theirs = sn.FrictionContactProblem(dimension, np.asfortranarray(problem.delassus), problem.q, problem.mu)
    options = sn.SolverOptions(identifier)
    options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = 10000 if "NSGS" in sn.solver_options_id_to_name(identifier) else 1000
    options.dparam[sn.SICONOS_DPARAM_TOL] = TOLERANCE
    driver = sn.fc2d_driver if dimension == 2 else sn.fc3d_driver
    driver(theirs, reactions, velocities, options)
    return reactions


def main() -> None:
    """Measure, print and write the tables."""
    options = argparse.ArgumentParser(description="Share of random frictional contact problems that are solved.")
    options.add_argument("--problems", type=int, default=10_000)
    options.add_argument("--siconos", type=int, default=0, metavar="N", help="problems of each family for Siconos")
    options.add_argument("--workers", type=int, default=1, help="processes")
    options.add_argument("--seconds", type=float, default=np.inf, help="time after which no more are solved")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--output", type=Path, default=Path("results/bench/complementarity.md"))
    given = options.parse_args()
    parts = [HEAD, "\n".join(ours(given.problems, given.seed, given.workers, given.seconds))]
    if given.siconos:
        parts += [f"\nBeside Siconos 4.4 (`--siconos {given.siconos}`), all judged by the first merit alone; tolerance "
                  f"{TOLERANCE:g}, at most 10,000 sweeps or 1,000 iterations:\n",
                  "\n".join(beside_siconos(given.siconos, given.seed))]
    text = "\n".join(parts) + "\n"
    print(text)
    with write_atomically(given.output) as stream:
        stream.write(text)


if __name__ == "__main__":
    main()
