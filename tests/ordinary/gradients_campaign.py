#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares exact derivatives of the jumps of many ordinary structures with extrapolated differences of their paths.

    PYTHONPATH=build/python tests/ordinary/gradients_campaign.py [--count 100] [--seed 1] [--families ...] [--limit 60]
        [--out rows.csv]

Family and seed determine a structure. ``--count`` structures with a jump are compared, every parameter of all items of
a section together. The deviation is that of the elasticities, as a fraction of the largest one of the structure. A
parameter whose differences do not converge is counted apart: there is a kink within the change.
"""
from __future__ import annotations

import argparse
import csv
import signal
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import statejump as sj
import structures
from statejump.core.errors import StatejumpError
from statejump.kinds.truss.answers.gradient import Gradient, RecordedPath
from statejump.kinds.truss.answers.outputs import node_output
from statejump.kinds.truss.answers.parameters import changed, parameters
from statejump.kinds.truss.resolved import ResolvedTruss

FIELDS = ("family", "seed", "parameter", "rolls", "elasticity", "by_differences", "error", "deviation", "solutions",
          "events", "kinks")
Row = dict[str, Any]
STEP = 2e-3  # first relative change of a parameter
LEVELS = 7
CONVERGED = 1e-6  # estimated error of differences, over the largest elasticity, beyond which there is a kink
LEAST_JUMP = 1e-9  # of the displacements


def extrapolated(function: Callable[[float], float]) -> tuple[float, float]:
    """Return the derivative at 0 by Ridders' extrapolation of central differences, and its estimated error."""
    last: list[float] = []
    best, error, step = float("nan"), float("inf"), STEP
    for level in range(LEVELS):
        now = [(function(step) - function(-step)) / (2 * step)]
        for order in range(level):
            now.append((4 ** (order + 1) * now[order] - last[order]) / (4 ** (order + 1) - 1))
            estimate = max(abs(now[-1] - now[-2]), abs(now[-1] - last[order]))
            if estimate < error:
                best, error = now[-1], estimate
        last, step = now, step / 2
    return best, error


def rolls(truss: ResolvedTruss) -> bool:
    """Return whether slides of the truss are integrals along the path, of second order in the increments."""
    return truss.sticking == "elastic" and any(len(truss.joints[kind].names) for kind in ("revolute", "ball_joint"))


def rows_of(family: str, seed: int) -> Iterator[Row]:
    """Yield a row for each parameter of a structure; none if it does not jump."""
    truss = sj.load(structures.make(family, seed).document).resolve()
    recorded = RecordedPath(truss)
    output = node_output(recorded.found)
    jump = output.jump(recorded.found)
    if abs(jump) <= LEAST_JUMP * np.abs(recorded.found.cycle_ends["displacement_m"]).max():
        return
    gradient = Gradient(recorded, output)
    made: list[Row] = []
    for section, key, values in parameters(truss):
        there = np.isfinite(values) & (values != 0)
        if not there.any():
            continue

        def jump_at(step: float) -> float:
            other = changed(truss, section, key, np.where(there, 1 + step, 1.0))
            return output.jump(RecordedPath(other).found)

        try:
            by_differences, error = extrapolated(jump_at)
        except StatejumpError:
            by_differences, error = float("nan"), float("inf")
        made.append({"family": family, "seed": seed, "parameter": f"{section}.{key}", "rolls": rolls(truss),
                     "elasticity": gradient.by_parameter(section, key).total / jump,
                     "by_differences": by_differences / jump, "error": abs(error / jump),
                     "solutions": gradient.solutions, "events": gradient.events, "kinks": gradient.kinks})
    largest = max((abs(row["elasticity"]) for row in made), default=1.0)
    for row in made:
        row["deviation"] = abs(row["elasticity"] - row["by_differences"]) / largest
        row["error"] /= largest
        yield row


class Expired(Exception):
    """A structure takes too long."""


def _expire(*_: object) -> None:
    raise Expired


def compared(arguments: argparse.Namespace, reasons: Counter[str]) -> Iterator[Row]:
    """Yield rows until there are enough structures."""
    signal.signal(signal.SIGALRM, _expire)
    missing = arguments.count
    for seed in range(arguments.seed, arguments.seed + arguments.most):
        for family in arguments.families:
            if not missing:
                return
            signal.alarm(arguments.limit)
            try:
                rows = list(rows_of(family, seed))
            except StatejumpError as refused:
                reasons[getattr(refused, "code", "") or str(refused)] += 1
                continue
            except Expired:
                reasons["limit of time"] += 1
                continue
            finally:
                signal.alarm(0)
            reasons["no jump"] += not rows
            missing -= bool(rows)
            yield from rows


def table(rows: list[Row]) -> str:
    """Return the deviations by class."""
    lines = ["| memory | structures | parameters | at a kink | deviation: median | 95 % | largest |",
             "|---|---|---|---|---|---|---|"]
    for path_integrals in (False, True):
        ours = [row for row in rows if row["rolls"] == path_integrals]
        if not ours:
            continue
        smooth = [row for row in ours if row["error"] < CONVERGED]
        found = np.array([row["deviation"] for row in smooth] or [np.nan])
        memory = "integral along the path" if path_integrals else "function of the state"
        lines.append(f"| {memory} | "
                     f"{len({(row['family'], row['seed']) for row in ours})} | {len(ours)} | "
                     f"{len(ours) - len(smooth)} | "
                     f"{np.median(found):.1e} | {np.quantile(found, 0.95):.1e} | {found.max():.1e} |")
    return "\n".join(lines)


def main() -> int:
    """Compare the structures of the arguments."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--most", type=int, default=1000, help="seeds of each family that are tried")
    parser.add_argument("--families", nargs="+", default=list(structures.SHAPES))
    parser.add_argument("--limit", type=int, default=60, help="of a structure [s]")
    parser.add_argument("--out", default="")
    arguments = parser.parse_args()
    rows, reasons = [], Counter[str]()
    for row in compared(arguments, reasons):
        rows.append(row)
        if row["error"] < CONVERGED and row["deviation"] > 1e-7 + 10 * row["error"]:
            print("deviates:", row, flush=True)
    print(table(rows))
    print("not compared:", ", ".join(f"{number} × {reason}" for reason, number in reasons.most_common(12)))
    if arguments.out:
        with open(arguments.out, "w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, FIELDS)
            writer.writeheader()
            writer.writerows(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
