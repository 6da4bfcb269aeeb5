#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the cost of a joint per time step of trusses in the DEM; writes results/bench/truss_dem.md and
truss_dem.csv.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/truss_dem.py

Chains of 100 to 10 000 blocks with friction run on one thread, with energy account. The cost is the difference of two
runs of different length, which excludes start and samples.
"""
from __future__ import annotations

import argparse
from statistics import median
from typing import Any

from run import parse, publish, start
from statejump.core.errors import StatejumpError
from statejump.core.yade_process import execute
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import KIND, dem, generate
from statejump.kinds.truss.solve import path

SIZES = (100, 1_000, 10_000)  # joints
JOINT_STEPS = 3_000_000  # joints times steps of the shorter run; the longer one has three times as many
# The blocks stick, so that the path, from which the DEM starts, has no slips of 10 000 joints to locate.
CASES = {"chain": lambda joints: generate.chain(joints, temperature_change_K=1.0, friction_force_N=1e3)}
COLUMNS = ("truss", "joints", "links", "repetition", "steps", "cpu_time_s", "ns_per_joint_and_step")


def resolved(kind: str, joints: int) -> dict[str, Any]:
    """Return the input of the YADE script."""
    case = parse_case(CASES[kind](joints))
    found = path(case.resolve(), increments_per_branch=1, locate_events=False)
    return {"scene": KIND.scene_module(), **dem.resolved(case, found)}


def run(values: dict[str, Any], steps: int) -> float:
    """Return the CPU time [s] of a run with the given number of steps, including two samples."""
    step = values["dem"]["time_step_s"]
    shortened = {**values, "number_of_samples": 1,
                 "dem": {**values["dem"], "number_of_steps": steps, "time_step_s": step, "threads": 1}}
    return execute(shortened, lambda share: None).about["cpu_time_s"]


def measure(repetitions: int) -> list[dict[str, Any]]:
    """Run all sizes in turn, repeatedly."""
    cases = {(kind, joints): resolved(kind, joints) for kind in CASES for joints in SIZES}
    rows = []
    for repetition in range(1, repetitions + 1):
        for (kind, joints), values in cases.items():
            count = len(values["slider"]["names"]) + len(values["revolute"]["names"])
            short = JOINT_STEPS // count
            seconds = run(values, 3 * short) - run(values, short)
            rows.append({
                "truss": kind, "joints": count, "links": len(values["link"]["names"]), "repetition": repetition,
                "steps": 2 * short, "cpu_time_s": round(seconds, 6),
                "ns_per_joint_and_step": round(seconds / (2 * short * count) * 1e9, 2),
            })
            print(f"{kind}, {count} joints: {rows[-1]['ns_per_joint_and_step']} ns", flush=True)
    return rows


def report(rows: list[dict[str, Any]], repetitions: int) -> str:
    """Return the table as Markdown."""
    lines = []
    for kind in CASES:
        costs = {}
        for row in rows:
            if row["truss"] == kind:
                costs.setdefault((row["joints"], row["links"]), []).append(row["ns_per_joint_and_step"])
        for (joints, links), values in costs.items():
            lines.append(f"| {kind} | {joints:,} | {links:,} | {median(values):.0f} ns | {min(values):.0f} to "
                         f"{max(values):.0f} ns | {median(values) * joints * 1e-6:.3g} ms |")
    table = "\n".join(lines)
    return f"""# Cost of trusses in the DEM

Medians of {repetitions} repetitions on one machine, one thread, CPU time; every run is in `truss_dem.csv`.
A joint's share is that of its contact, of its links, of the collider and of the integrator, with the
energy account on.

| truss | joints | links | per joint and step | lowest to highest | per step |
|---|--:|--:|--:|--:|--:|
{table}

A chain has one link and one pad on a floor per joint; its blocks stick, which costs what sliding does.

## Again

```
PYTHONPATH=build/python /usr/bin/python3 studies/bench/truss_dem.py [--repetitions N]
```
"""


def main() -> None:
    """Measure and write."""
    arguments = parse(argparse.ArgumentParser(description=__doc__.splitlines()[0]), 3)
    rows = measure(arguments.repetitions)
    publish(arguments.output, "truss_dem", COLUMNS, rows, report(rows, arguments.repetitions))


if __name__ == "__main__":
    start(main, StatejumpError)
