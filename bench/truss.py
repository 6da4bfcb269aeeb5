# SPDX-License-Identifier: GPL-3.0-or-later
"""Time and memory of the quasi-static truss solver against the number of joints.

    PYTHONPATH=build/python /usr/bin/python3 bench/truss.py [--largest 100000]

Two trusses, one temperature cycle, ten points a branch: the ring with preload as
`statejump truss ring` makes it, and the umbrella with cables between its ribs, whose friction scatters so
that every joint slips at its own temperature. Every size runs in a process of its own, so that the memory
is its own. Writes results/bench/truss.md.
"""
from __future__ import annotations

import argparse
import multiprocessing
import resource
import time
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.output import write_atomically
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import generate, solve

SIZES = (10, 100, 1_000, 10_000, 100_000)
TRUSSES = ("ring", "umbrella")


def document(truss: str, joints: int) -> dict[str, Any]:
    """Return the case of a size."""
    if truss == "ring":
        return generate.ring(joints)
    made = generate.umbrella(joints, cable_preload_N=1.0)
    scatter = np.random.default_rng(1)
    for joint in made["revolute"]:
        joint["friction_coefficient"] = 0.1 + 0.1 * float(scatter.random())
    return made


def measure(truss: str, joints: int) -> str:
    """Return one row of the table."""
    resolved = parse_case(document(truss, joints)).resolve()
    started = time.process_time()
    found = solve.path(resolved, increments_per_branch=10, locate_events=False, cycle_ends_only=True)
    seconds = time.process_time() - started
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    per = 1e6 * seconds / (found.factorizations * found.unknowns)
    return (
        f"| {truss} | {joints:,} | {found.unknowns:,} | {len(found.events):,} | {found.solves} | "
        f"{found.factorizations} | {seconds:.3g} | {1e6 * seconds / joints:.0f} | {per:.2f} | {peak:.0f} |"
    )


def main() -> None:
    """Measure, print and write the table."""
    options = argparse.ArgumentParser(description="Time of the truss solver against the number of joints.")
    options.add_argument("--largest", type=int, default=SIZES[-1], help="largest number of joints")
    options.add_argument("--output", type=Path, default=Path("results/bench/truss.md"))
    given = options.parse_args()
    lines = [
        "# Quasi-static truss solver against the number of joints", "",
        "`PYTHONPATH=build/python /usr/bin/python3 bench/truss.py`: one cycle, ten points a branch, CPU time of one",
        "core (the solver is serial, so its results do not depend on threads). Events: changes of stick, slip and",
        "contact. The ring of many bays is stiff around each joint, and none slips from 100 on; in the umbrella every",
        "joint slips out and back, each at its own temperature. Memory: peak of the process, 50 MB of it Python",
        "itself, most of the rest the case as Python objects.", "",
        "| truss | joints | unknowns | events | solves | factorizations | CPU time [s] | per joint [µs] | "
        "per factorization and unknown [µs] | peak memory [MB] |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    print("\n".join(lines), flush=True)
    fresh = multiprocessing.get_context("spawn")
    for truss in TRUSSES:
        for joints in (size for size in SIZES if size <= given.largest):
            with fresh.Pool(1) as pool:
                lines.append(pool.apply(measure, (truss, joints)))
            print(lines[-1], flush=True)
    with write_atomically(given.output) as stream:
        stream.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
