#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the cost of truss dynamics and of the DEM at equal error; writes results/motion/speed.md and speed.csv.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/motion_speed.py [--case NAME]

Both models run with several time steps, on one thread. The reference is the DEM with its default step, to which both
converge. Times are CPU times of the time steps. Chains of 100 to 10 000 blocks show how the cost of a step grows.
"""
from __future__ import annotations

from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np
import statejump as sj
from run import parse_cases, publish, start
from statejump.core.errors import StatejumpError
from statejump.kinds.truss import compare, motion, result

SAMPLES = 200  # of a cycle
REFERENCE, FRACTIONS = 0.1, (0.9, 0.1)  # of the DEM's stable step
# Steps of a cycle and theta.
MOTIONS = ((500, 1.0), (2_000, 1.0), (2_000, 0.55), (2_000, 0.5), (8_000, 0.55), (8_000, 0.5), (32_000, 0.5))
CASES: dict[str, Callable[[], Any]] = {
    "chain_100": lambda: sj.truss.chain(100),
    "chain_100, 10 s": lambda: sj.truss.chain(100).changed({"thermal.period_s": 10.0}),
    "umbrella_100": lambda: sj.load("cases/trusses/umbrella_100.toml"),
}
SIZES = (100, 1_000, 10_000)  # blocks
STEPS = 1_000  # of the scaling
COLUMNS = ("case", "model", "steps", "theta", "rms_over_largest", "jump_error_m", "jump_m", "cpu_time_s",
           "us_per_step")


def moved(case: Any) -> tuple[Any, float]:
    """Return a run of truss dynamics, and the CPU time of its steps [s]."""
    definition = case.definition
    definition.resolve()
    begun = process_time()
    found = motion.simulate(definition)
    seconds = process_time() - begun
    return result.motion_run(definition, found), seconds


def row(name: str, model: str, run: Any, reference: Any, steps: int, theta: Any, seconds: float) -> dict[str, Any]:
    """Return the cost of one run, and its error relative to the reference run."""
    apart = np.linalg.norm(run["displacement_m"] - reference["displacement_m"], axis=2)
    jumps, exact = compare.jumps_m(run), compare.jumps_m(reference)
    return {
        "case": name, "model": model, "steps": steps, "theta": theta,
        "rms_over_largest": float(np.sqrt((apart**2).mean(axis=0)).max()
                                  / np.linalg.norm(reference["displacement_m"], axis=2).max()),
        "jump_error_m": float(np.linalg.norm(jumps - exact, axis=1).max()),
        "jump_m": float(np.linalg.norm(exact, axis=1).max()), "cpu_time_s": round(seconds, 4),
        "us_per_step": round(1e6 * seconds / steps, 2),
    }


def measure(names: list[str]) -> list[dict[str, Any]]:
    """Run both models of these cases."""
    rows = []
    for name in names:
        case = CASES[name]().changed({"reduced.sticking": "elastic", "motion.masses": "lumped",
                                      "output.samples_per_cycle": SAMPLES})
        runs = {fraction: case.changed({"dem.time_step_fraction": fraction}).dem() for fraction in FRACTIONS}
        reference = runs[REFERENCE]
        for fraction, run in runs.items():
            rows.append(row(name, f"DEM, {fraction} of the stable step", run, reference, run.about["steps"], "",
                            run.about["cpu_time_s"]))
            print(rows[-1], flush=True)
        for steps, theta in MOTIONS:
            try:
                run, seconds = moved(case.changed({"motion.steps_per_cycle": steps, "motion.theta": theta}))
            except StatejumpError as failed:
                print(f"{name}, {steps} steps, theta {theta}: {failed}", flush=True)
                continue
            rows.append(row(name, "in motion", run, reference, steps, theta, seconds))
            print(rows[-1], flush=True)
    return rows


def scaling() -> list[dict[str, Any]]:
    """Run chains of sticking blocks, as studies/bench/truss_dem.py does in the DEM."""
    rows = []
    for blocks in SIZES:
        case = sj.truss.chain(blocks, temperature_change_K=1.0, friction_force_N=1e3).changed({
            "reduced.sticking": "elastic", "motion.masses": "lumped", "motion.steps_per_cycle": STEPS,
            "output.samples_per_cycle": 10, "reduced.increments_per_branch": 1})
        _, seconds = moved(case)
        rows.append({"case": f"chain of {blocks}, sticking", "model": "in motion", "steps": STEPS, "theta": 0.5,
                     "cpu_time_s": round(seconds, 4), "us_per_step": round(1e6 * seconds / STEPS, 2)})
        print(rows[-1], flush=True)
    return rows


def report(rows: list[dict[str, Any]], grown: list[dict[str, Any]]) -> str:
    """Return the tables as Markdown."""
    lines = []
    for name in dict.fromkeys(one["case"] for one in rows):
        of_case = [one for one in rows if one["case"] == name]
        for k, one in enumerate(of_case):
            first = " of the reference" if one["rms_over_largest"] == 0 else f"{one['rms_over_largest']:.1e}"
            jump = "" if one["rms_over_largest"] == 0 else f"{one['jump_error_m'] / one['jump_m']:.1e}"
            ratio = "" if one["model"] != "in motion" else " / ".join(
                f"{dem['cpu_time_s'] / one['cpu_time_s']:.3g}" for dem in of_case if dem["model"] != "in motion")
            lines.append(f"| {'' if k else name} | {one['model']} | {one['steps']:,} | {one['theta']} | {first} | "
                         f"{jump} | {one['cpu_time_s']:.3g} s | {one['us_per_step']:.3g} µs | {ratio} |")
    table = "\n".join(lines)
    sizes = "\n".join(f"| {one['case']} | {one['us_per_step']:.4g} µs | "
                      f"{1e3 * one['us_per_step'] / size:.0f} ns |" for size, one in zip(SIZES, grown))
    fractions = " and at ".join(str(fraction) for fraction in FRACTIONS)
    return f"""# Cost of trusses in motion against the DEM

100 joints with dashpots, the masses of the DEM, elastic sticking, and {SAMPLES} samples per cycle. The reference is
the DEM at {REFERENCE} of its stable step.

- rms: largest rms error of all nodes over the run, over the largest displacement
- jump: largest error of the jump of all nodes, over the largest jump
- CPU: time of the steps on one shared core
- times cheaper: than the DEM at {fractions} of the stable step

| case | model | steps | θ | rms | jump | CPU | per step | times cheaper |
|---|---|--:|--:|--:|--:|--:|--:|--:|
{table}

Explanation: [Cost of motion](../../docs/validation/motion_cost.md).

## Growth with the number of joints

Blocks that stick, {STEPS:,} steps, the start included.

| truss | per step | per step and joint |
|---|--:|--:|
{sizes}

## Again

```
PYTHONPATH=build/python /usr/bin/python3 studies/bench/motion_speed.py [--case NAME]
```
"""


def main() -> None:
    """Measure and write."""
    arguments = parse_cases(__doc__.splitlines()[0], CASES)
    grown = scaling()
    rows = measure(arguments.case)
    publish(arguments.output, "speed", COLUMNS, rows + grown, report(rows, grown))


if __name__ == "__main__":
    start(main, StatejumpError)
