#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost of exact derivatives of a jump beside central differences of paths, in one run.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/gradients.py [--ribs 8 100 1000] [--differences 6]

Prints a table for umbrellas of several sizes: parameters of single items, seconds of a path without located events, of
the recorded path, of the adjoint solution with all derivatives, and of differences (four paths for each parameter,
measured on a few of them and multiplied), and the ratio of differences to exact derivatives with their path.
"""
from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np

import statejump as sj
from statejump.kinds.truss.answers.gradient import Gradient, RecordedPath
from statejump.kinds.truss.answers.jumps import quick_path
from statejump.kinds.truss.answers.outputs import node_output
from statejump.kinds.truss.answers.parameters import parameters
from statejump.kinds.truss.answers.sensitivity import differences
from statejump.kinds.truss.resolved import ResolvedTruss


def seconds(work: Callable[[], object]) -> float:
    """Return the median processor time of three calls [s]."""
    taken = []
    for _ in range(3):
        start = time.process_time()
        work()
        taken.append(time.process_time() - start)
    return statistics.median(taken)


def asked(truss: ResolvedTruss) -> list[tuple[str, str, np.ndarray]]:
    """Return section, key and items of the parameters that have a value."""
    return [(section, key, there) for section, key, values in parameters(truss)
            if (there := np.isfinite(values) & (values != 0)).any()]


def row(ribs: int, several: int) -> str:
    """Return the row of an umbrella."""
    truss = sj.truss.umbrella(ribs).resolve()
    recorded = RecordedPath(truss)
    output = node_output(recorded.found)
    jump = output.jump(recorded.found)

    def all_exact() -> None:
        gradient = Gradient(recorded, output)
        for section, key, _ in asked(truss):
            gradient.by_parameter(section, key)

    def some_differences() -> None:
        for section, key, there in asked(truss)[:several]:
            differences(truss, section, key, np.arange(len(there)) == np.flatnonzero(there)[0], output, jump)

    count = sum(int(there.sum()) for _, _, there in asked(truss))
    path, record = seconds(lambda: quick_path(truss, cycle_ends_only=True)), seconds(lambda: RecordedPath(truss))
    exact = seconds(all_exact)
    by_differences = seconds(some_differences) / min(several, len(asked(truss))) * count
    return (f"| {ribs} | {count} | {path:.3g} | {record:.3g} | {exact:.3g} | {by_differences:.3g} | "
            f"{by_differences / (record + exact):.0f} |")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ribs", type=int, nargs="+", default=[8, 100, 1000])
    parser.add_argument("--differences", type=int, default=6, help="parameters whose differences are measured")
    arguments = parser.parse_args()
    print("| ribs | parameters | path [s] | recorded path [s] | all exact derivatives [s] | differences [s] | ratio |\n"
          "|--:|--:|--:|--:|--:|--:|--:|")
    for ribs in arguments.ribs:
        print(row(ribs, arguments.differences), flush=True)


if __name__ == "__main__":
    main()
