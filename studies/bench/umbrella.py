#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the speed of DEM and reduced model of the umbrella rib; writes results/bench/umbrella.md and umbrella.csv.

PYTHONPATH=build/python /usr/bin/python3 studies/bench/umbrella.py --build build
"""
from __future__ import annotations

import argparse
import json
import subprocess
from pathlib import Path
from statistics import median

from run import REPOSITORY, TIMEOUT_S, BenchError, parse, publish, start
import statejump
from statejump.core.errors import StatejumpError

STEPS = 100_000  # steps of one run of the reduced model, as in the paper
DEM_STEPS = 400_000
NAMES = {
    "bare_loop": "bare hand-written loop, frictionless",
    "engine/frictionless": "engine, frictionless, with energy account and events",
    "engine/ambrosio": "engine, friction `ambrosio`",
    "engine/mindlin": "engine, friction `mindlin`",
    "adaptive": "engine, frictionless, adaptive, tolerance 1e-8 (whole run)",
}
COLUMNS = ("model", "scene", "repetition", "steps", "time_s", "ns_per_step")


def reduced_rows(build: Path, repetitions: int) -> list[dict[str, object]]:
    """Run the engine's benchmarks in random order; return CPU times."""
    done = subprocess.run(
        [build / "bench" / "engine" / "engine_bench", "--benchmark_filter=bare_loop|engine|adaptive",
         f"--benchmark_repetitions={repetitions}", "--benchmark_enable_random_interleaving=true",
         "--benchmark_format=json"],
        capture_output=True, text=True, timeout=TIMEOUT_S, check=True,
    )
    rows = []
    for entry in json.loads(done.stdout)["benchmarks"]:
        if entry["run_type"] == "iteration":
            seconds = entry["cpu_time"] * 1e-3
            rows.append({
                "model": "reduced", "scene": entry["run_name"], "repetition": entry["repetition_index"],
                "steps": STEPS, "time_s": seconds, "ns_per_step": seconds / STEPS * 1e9,
            })
    return rows


def dem_rows(repetitions: int) -> list[dict[str, object]]:
    """Run the DEM scene; return the wall time of the time steps [s], without the start of YADE."""
    rows = []
    for name in ("umbrella_damped", "umbrella"):
        case = statejump.load(REPOSITORY / "cases" / f"{name}.toml").changed({"dem.steps_per_cycle": DEM_STEPS})
        for repetition in range(repetitions):
            seconds = case.dem().about["wall_time_s"]
            rows.append({
                "model": "DEM", "scene": name, "repetition": repetition, "steps": DEM_STEPS,
                "time_s": seconds, "ns_per_step": seconds / DEM_STEPS * 1e9,
            })
    return rows


def cost(rows: list[dict[str, object]], scene: str) -> float:
    return median(float(row["ns_per_step"]) for row in rows if row["scene"] == scene)


def report(rows: list[dict[str, object]], repetitions: int) -> str:
    ratio = cost(rows, "engine/frictionless") / cost(rows, "bare_loop")
    reduced = "\n".join(
        f"| {text} | {cost(rows, name):.0f} ns | {cost(rows, name) * STEPS * 1e-6:.1f} ms |"
        for name, text in NAMES.items()
    )
    scenes = "\n".join(
        f"| `cases/{name}.toml` | {cost(rows, name):.0f} ns | {1e9 / cost(rows, name):,.0f} |"
        for name in ("umbrella_damped", "umbrella")
    )
    return f"""# Speed of the umbrella rib

Medians of {repetitions} repetitions on one machine; every run is in `umbrella.csv`.

## Reduced model: {STEPS:,} Runge-Kutta steps over the cycle

CPU time, the five in random order in one process.

| | per step | whole run |
|---|--:|--:|
{reduced}

Frictionless engine over the bare loop: **{ratio:.2f}**. Required: at most 3. The bare loop
(`studies/bench/engine/bare_linkage.hpp`) has the same arithmetic and nothing else: no energy account, no
samples, no events, no laws to choose from. The adaptive method takes far fewer steps: its time is
shown per fixed step for comparison.

## DEM: one rib in YADE, one thread

Wall time of the steps, with energy account and 2000 samples, without the start of YADE.

| case | per step | steps per second |
|---|--:|--:|
{scenes}

## Again

```
PYTHONPATH=build/python /usr/bin/python3 studies/bench/umbrella.py --build build [--repetitions N]
```
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build", help="build folder")
    arguments = parse(parser, 7)
    if not (arguments.build / "bench" / "engine" / "engine_bench").exists():
        raise BenchError(f"--build {arguments.build}: no engine_bench; run 'make build'")
    rows = reduced_rows(arguments.build.resolve(), arguments.repetitions)
    rows += dem_rows(arguments.repetitions)
    publish(arguments.output, "umbrella", COLUMNS, rows, report(rows, arguments.repetitions))


if __name__ == "__main__":
    start(main, StatejumpError)
