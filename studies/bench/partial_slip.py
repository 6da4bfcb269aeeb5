#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the cost of friction law mindlin_deresiewicz relative to mindlin, in YADE's loop and in the JointStepper.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/partial_slip.py --build build

Prints ratios of CPU times of two successive runs. The contacts of yade_joints.py stick after an initial vibration,
which leaves about forty points in the load history of each contact. Exit status 2 with a message if a program is
missing.
"""
from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import median

from run import STEPS, BenchError, row, run_yade

LAWS = ("mindlin", "mindlin_deresiewicz")
VARIANTS = {"joint": "YADE, heated", "joint_isothermal": "YADE", "joint_stepper": "JointStepper, heated"}
WARM_UP = 1500  # steps; they ring for some hundred


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=Path("build"), help="build tree")
    parser.add_argument("--repetitions", type=int, default=3)
    arguments = parser.parse_args()
    print("| scene | contacts | `mindlin` | `mindlin_deresiewicz` | points | ratio | lowest to highest |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    for variant, name in VARIANTS.items():
        for size in STEPS:
            costs: dict[str, list[float]] = {law: [] for law in LAWS}
            points = 0.0
            for _ in range(arguments.repetitions):
                for law in LAWS:
                    report = run_yade(arguments.build, variant, size, 1, friction_law=law, warm_up=WARM_UP)
                    costs[law].append(row(variant, 0, 1, report)["cpu_time_per_contact_and_step_ns"])
                    points = report["memory_points"]
            ratios = sorted(b / a for a, b in zip(*costs.values()))
            print(
                f"| {name} | {size} | {median(costs[LAWS[0]]):.0f} ns | {median(costs[LAWS[1]]):.0f} ns | {points:.0f} "
                f"| **{median(ratios):.2f}** | {ratios[0]:.2f} to {ratios[-1]:.2f} |", flush=True,
            )
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except BenchError as error:
        print(f"studies/bench/partial_slip.py: {error}", file=sys.stderr)
        sys.exit(2)
