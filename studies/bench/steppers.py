#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the cost of time steps of the JointStepper and of YADE's loop; writes results/bench/steppers.md and .csv.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/steppers.py

The cost is the CPU time of the steps on one thread, without the start of YADE. A chain of 1000 joints runs without
samples; the damped rib and the paper's Table 1 run with the samples of the case and with few.
"""
from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from statistics import median
from typing import Any

import statejump
import truss_dem
from run import REPOSITORY, parse, publish, start
from statejump.core.errors import StatejumpError

JOINTS = 1000
CHAIN_STEPS = 2000  # number of steps of the shorter run; the longer one has three times as many
FEW_SAMPLES = 20
STEPPERS = ("joint", "yade")
COLUMNS = ("scene", "stepper", "repetition", "steps", "cpu_time_s", "ns_per_step")
Measure = Callable[[str], tuple[int, float]]  # returns steps and CPU time [s] for the name of a stepper
Scenes = dict[str, tuple[Measure, str, float]]  # measurement, target in words, target as a ratio to YADE's loop


def case(name: str, **changes: Any) -> Measure:
    """A shipped case, with changed keys."""
    def measure(stepper: str) -> tuple[int, float]:
        about = statejump.load(REPOSITORY / "cases" / f"{name}.toml").changed(
            {"dem.stepper": stepper, **changes}).dem().about
        return about["steps"], about["cpu_time_s"]
    return measure


def chain() -> Measure:
    """A chain of blocks that stick."""
    values = truss_dem.resolved("chain", JOINTS)

    def measure(stepper: str) -> tuple[int, float]:
        by = {**values, "dem": {**values["dem"], "stepper": stepper}}
        return 2 * CHAIN_STEPS, truss_dem.run(by, 3 * CHAIN_STEPS) - truss_dem.run(by, CHAIN_STEPS)
    return measure


def scenes() -> Scenes:
    """By name."""
    rib = "4 million steps a second where YADE's loop makes 343 755", 343_755 / 4e6
    demo = "0.5 s where YADE's loop takes 3 s", 0.5 / 3
    return {
        f"chain of {JOINTS}": (chain(), "80 ns a joint where YADE's loop takes 429", 80 / 429),
        "`cases/umbrella_damped.toml`, 2000 samples": (case("umbrella_damped"), *rib),
        f"`cases/umbrella_damped.toml`, {FEW_SAMPLES} samples": (
            case("umbrella_damped", **{"output.samples_per_cycle": FEW_SAMPLES}), *rib),
        "`cases/table1.toml` (`make demo`), 2000 samples": (case("table1"), *demo),
        f"`cases/table1.toml`, {FEW_SAMPLES} samples": (
            case("table1", **{"dem.samples_per_cycle": FEW_SAMPLES}), *demo),
    }


def report(rows: list[dict[str, Any]], measured: Scenes, repetitions: int) -> str:
    lines = []
    for scene, (_, meaning, most) in measured.items():
        costs = {stepper: [row["ns_per_step"] for row in rows if row["scene"] == scene and row["stepper"] == stepper]
                 for stepper in STEPPERS}
        found = sorted(a / b for a, b in zip(*costs.values()))
        joint, yade = (median(values) for values in costs.values())
        lines.append(f"| {scene} | {yade:,.0f} | {joint:,.0f} | {1e9 / joint:,.0f} | **{median(found):.3f}** "
                     f"({found[0]:.3f} to {found[-1]:.3f}) | {most:.3f} | {meaning} | "
                     f"{'yes' if median(found) <= most else 'no'} |")
    rows_of_table = "\n".join(lines)
    load, processors = os.getloadavg()[2], os.cpu_count()
    return f"""# Steps of cases: JointStepper and YADE's loop

Numbers are medians of the CPU time of {repetitions} repetitions in turn, on one thread, without the start of YADE and
with the energy account. `steppers.csv` has every run. Both loops make the same steps, bit for bit. The goals were set
on another machine; here they are ratios to YADE's loop in the same run. The load average of the machine was {load:.0f}
on {processors} processors at the end of the measurement, so compare ratios, not nanoseconds.

| scene | YADE's loop [ns a step] | `JointStepper` [ns a step] | steps per s | ratio (range) | to reach | it is | met |
|---|--:|--:|--:|--:|--:|---|---|
{rows_of_table}

Both columns include the samples of a StateRecorder, which Python in YADE processes in blocks. The chain has no samples.

Again: `PYTHONPATH=build/python /usr/bin/python3 studies/bench/steppers.py [--repetitions N]`.
"""


def main() -> None:
    arguments = parse(argparse.ArgumentParser(description=__doc__.splitlines()[0]), 5)
    rows, measured = [], scenes()
    for repetition in range(1, arguments.repetitions + 1):
        for scene, (measure, _, _) in measured.items():
            for stepper in STEPPERS:
                steps, seconds = measure(stepper)
                rows.append(dict(zip(COLUMNS, (scene, stepper, repetition, steps, round(seconds, 6),
                                               round(seconds / steps * 1e9, 2)))))
        print(f"repetition {repetition} of {arguments.repetitions} done", flush=True)
    publish(arguments.output, "steppers", COLUMNS, rows, report(rows, measured, arguments.repetitions))


if __name__ == "__main__":
    start(main, StatejumpError)
