#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the cost of a joint contact and of YADE's sphere-sphere Hertz-Mindlin law, each in a new YADE process.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/run.py --build build

Runs the variants of yade_joints.py in turn, several times, and writes results/bench/joints.csv and
results/bench/README.md. A ratio compares successive runs, because other load of the machine then affects both. Exit
status 2 with a message if a program is missing.
"""
from __future__ import annotations

import argparse
import csv
import io
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from statistics import median
from typing import Any, Callable, Iterable, Sequence

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
TIMEOUT_S = 600
OURS, YADES = "joint", "sphere"
VARIANTS = (OURS, YADES, "joint_isothermal")
STEPS = {1: 300_000, 100: 15_000, 10_000: 300}  # steps of one run, by number of contacts
BUSY_LOAD = 0.3  # load average above which two threads are not compared
COLUMNS = (
    "scene", "contacts", "threads", "repetition", "steps", "cpu_time_s",
    "cpu_time_per_contact_and_step_ns", "wall_time_s",
)


class BenchError(Exception):
    """One sentence for the user."""


def run_yade(build: Path, variant: str, size: int, threads: int, **settings: int | str) -> dict[str, Any]:
    """Run one measurement in a new YADE process and return its report."""
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith("STATEJUMP_BENCH_")
    }
    environment |= {
        "PYTHONPATH": str(build / "python"),
        "PYTHONDONTWRITEBYTECODE": "1",
        "STATEJUMP_BENCH_VARIANT": variant,
        "STATEJUMP_BENCH_SIZE": str(size),
        "STATEJUMP_BENCH_STEPS": str(STEPS[size] * threads),
    }
    environment |= {f"STATEJUMP_BENCH_{name.upper()}": str(value) for name, value in settings.items()}
    try:
        done = subprocess.run(
            ["yade", "-n", "-x", f"-j{threads}", str(HERE / "yade_joints.py")],
            stdin=subprocess.DEVNULL, capture_output=True, text=True, env=environment,
            timeout=TIMEOUT_S, check=False,
        )
    except subprocess.TimeoutExpired:
        raise BenchError(f"{variant} with {size} contacts took more than {TIMEOUT_S} s") from None
    # YADE's own messages may end without a newline.
    _, found, report = done.stdout.partition("BENCH {")
    if not found:
        last = (done.stderr.strip() or done.stdout.strip() or "no output").splitlines()[-1]
        raise BenchError(f"{variant} with {size} contacts failed in YADE: {last}")
    return json.loads("{" + report.splitlines()[0])


def row(scene: str, repetition: int, threads: int, report: dict[str, Any]) -> dict[str, Any]:
    per_contact = report["cpu_time_s"] / report["steps"] / report["contacts"] * 1e9
    return {
        "scene": scene,
        "contacts": report["contacts"],
        "threads": threads,
        "repetition": repetition,
        "steps": report["steps"],
        "cpu_time_s": round(report["cpu_time_s"], 6),
        "cpu_time_per_contact_and_step_ns": round(per_contact, 2),
        "wall_time_s": round(report["wall_time_s"], 6),
    }


def measure(build: Path, repetitions: int, threads: int) -> list[dict[str, Any]]:
    """Run every variant in turn, repeatedly."""
    rows = []
    for repetition in range(1, repetitions + 1):
        for size in STEPS:
            for variant in VARIANTS:
                rows.append(
                    row(variant, repetition, threads, run_yade(build, variant, size, threads))
                )
        if threads == 1:
            rows.append(row("table1", repetition, 1, run_yade(build, "table1", 1, 1)))
            rows.append(
                row(
                    "sphere_energy", repetition, 1,
                    run_yade(build, YADES, 1, 1, energy=1, bystanders=3),
                )
            )
        print(f"repetition {repetition} of {repetitions} done", flush=True)
    return rows


def column(rows: list[dict[str, Any]], scene: str, size: int, key: str) -> list[float]:
    return [r[key] for r in rows if r["scene"] == scene and r["contacts"] == size]


def ratios(
    rows: list[dict[str, Any]], size: int, key: str, scenes: tuple[str, str] = (OURS, YADES)
) -> list[float]:
    """Return the sorted ratios of the times of the first to the second scene, one per repetition."""
    first, second = (column(rows, scene, size, key) for scene in scenes)
    return sorted(a / b for a, b in zip(first, second))


def cost_table(rows: list[dict[str, Any]], key: str) -> str:
    lines = [
        "| contacts | joint under expansion | YADE's spheres | **ratio** | ratio, lowest to highest "
        "| joint, no thermal engine |",
        "|--:|--:|--:|--:|--:|--:|",
    ]
    for size in STEPS:
        scale = 1.0 if key.endswith("_ns") else 1e9 / size
        cost = {
            v: median(
                value * (1 if scale == 1.0 else scale / steps)
                for value, steps in zip(column(rows, v, size, key), column(rows, v, size, "steps"))
            )
            for v in VARIANTS
        }
        r = ratios(rows, size, key)
        lines.append(
            f"| {size} | {cost[OURS]:.0f} ns | {cost[YADES]:.0f} ns | **{median(r):.2f}** | "
            f"{r[0]:.2f} to {r[-1]:.2f} | {cost['joint_isothermal']:.0f} ns |"
        )
    return "\n".join(lines)


def table1_table(rows: list[dict[str, Any]]) -> str:
    key = "cpu_time_per_contact_and_step_ns"
    lines = ["| scene | CPU time per step | steps per second of CPU time |", "|---|--:|--:|"]
    names = {
        "table1": "Table 1 (`yade_scripts/examples/table1.py`)",
        "sphere_energy": "one pair of YADE's spheres, three more near by",
    }
    for scene, name in names.items():
        cost = median(column(rows, scene, 1, key))
        lines.append(f"| {name} | {cost:.0f} ns | {1e9 / cost:.3g} |")
    r = ratios(rows, 1, key, ("table1", "sphere_energy"))
    lines.append(f"| **ratio** of the costs | **{median(r):.2f}** ({r[0]:.2f} to {r[-1]:.2f}) | |")
    return "\n".join(lines)


def engine_table(build: Path, repetitions: int) -> str:
    """Return each engine's fraction of the time, from O.timingEnabled. Separate runs are used: it slows YADE down."""
    engines = [
        "ForceResetter", "ThermalExpansionEngine", "InsertionSortCollider", "InteractionLoop",
        "NewtonIntegrator",
    ]
    lines = [
        "| contacts | scene | all engines per contact and step | " + " | ".join(engines) + " |",
        "|--:|---|--:|" + "--:|" * len(engines),
    ]
    for size in STEPS:
        runs: dict[str, list[dict[str, float]]] = {OURS: [], YADES: []}
        for _ in range(repetitions):
            for variant, reports in runs.items():
                report = run_yade(build, variant, size, 1, timing=1)
                reports.append(report["engines_ns_per_step"])
        for variant, reports in runs.items():
            cost = {e: median(r.get(e, 0.0) for r in reports) for e in engines}
            total = sum(cost.values())
            shares = " | ".join(
                f"{cost[e] / total:.0%}" if e in reports[0] else "" for e in engines
            )
            name = "joint" if variant == OURS else "YADE's spheres"
            lines.append(f"| {size} | {name} | {total / size:.0f} ns | {shares} |")
    return "\n".join(lines)


def write(path: Path, text: str) -> None:
    """Write a temporary file and rename it, so that no incomplete file remains."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name("." + path.name + ".partial")
    partial.write_text(text)
    os.replace(partial, path)


def reduced_table(build: Path) -> str:
    """Return the table of times of the reduced model: medians of five runs of Google Benchmark."""
    done = subprocess.run(
        [build / "bench" / "engine" / "engine_bench", "--benchmark_repetitions=5",
         "--benchmark_report_aggregates_only=true", "--benchmark_format=json"],
        capture_output=True, text=True, timeout=TIMEOUT_S, check=True,
    )
    names = {
        "solve_fresh": "one Table 1 cycle, all events, new result",
        "solve_reused": "the same into a result that is there",
        "solve_cycles/1000": "1000 full sine cycles with both stops",
        "sample_cycle/1000": "1000 samples of the history",
    }
    lines = ["| reduced model | CPU time |", "|---|--:|"]
    for entry in json.loads(done.stdout)["benchmarks"]:
        if entry["aggregate_name"] == "median" and entry["run_name"] in names:
            lines.append(f"| {names[entry['run_name']]} | {entry['cpu_time'] / 1000:.3g} µs |")
    return "\n".join(lines)


def as_csv(rows: list[dict[str, Any]], columns: Sequence[str] = COLUMNS) -> str:
    stream = io.StringIO()
    writer = csv.DictWriter(stream, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


# The following functions are shared by umbrella.py, campaign.py, truss_dem.py, peers.py and yade_import.py.


def start(main: Callable[[], None], *failures: type[Exception]) -> None:
    """Run a benchmark. If it raises a BenchError, an OSError or one of the given errors, exit with status 2 and a
    message."""
    told: tuple[type[Exception], ...] = (BenchError, OSError, *failures)
    try:
        main()
    except told as error:
        print(f"bench: {error}", file=sys.stderr)
        sys.exit(2)


def parse(parser: argparse.ArgumentParser, repetitions: int) -> argparse.Namespace:
    """Return the command-line options, including --repetitions and --output."""
    parser.add_argument(
        "--repetitions", type=int, default=repetitions, help=f"of every run (default {repetitions})"
    )
    parser.add_argument("--output", type=Path, default=REPOSITORY / "results" / "bench")
    arguments = parser.parse_args()
    if arguments.repetitions < 1:
        raise BenchError(f"--repetitions {arguments.repetitions}: must be 1 or more")
    return arguments


def parse_cases(description: str, cases: Iterable[str], **more: dict[str, Any]) -> argparse.Namespace:
    """Return the options of a benchmark of truss dynamics: cases to run (``case``) and results folder.

    :param more: further options by name, with the arguments of ``add_argument``
    """
    known = list(cases)
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--case", action="append", choices=known, help="one of the cases; all")
    parser.add_argument("--output", type=Path, default=REPOSITORY / "results" / "motion")
    for name, option in more.items():
        parser.add_argument(f"--{name}", **option)
    arguments = parser.parse_args()
    arguments.case = arguments.case or known
    return arguments


def publish(
    folder: Path, name: str, columns: Sequence[str], rows: list[dict[str, Any]], report: str
) -> None:
    """Write every run to ``<name>.csv`` and the report to ``<name>.md``; print the report."""
    write(folder / f"{name}.csv", as_csv(rows, columns))
    write(folder / f"{name}.md", report)
    print(report)


def readme(
    rows: list[dict[str, Any]], engines: str, reduced: str, repetitions: int
) -> str:
    return f"""# Cost of a joint contact beside YADE's own law

The first scene has n revolute joints: a journal in a fixed bearing, R1 = 5 mm, c = 0.1 mm, material
of Table 2, friction 0.3, with a temperature that changes in every step. The second scene has n
pairs of spheres with YADE's `Law2_ScGeom_MindlinPhys_Mindlin`; one sphere of each pair is fixed.
Both scenes have the same number of bodies and contacts, and the same collider, integrator, load and
friction. Every contact carries a normal force and a tangential force below the friction limit; a
check before and after each run confirms this. Each run is a process with one thread. Numbers are
medians of the CPU time of {repetitions} repetitions in turn. A ratio compares two consecutive runs.

Absolute numbers are those of one machine. Compare the ratios. Required: at most 1.0.

## CPU time per contact and step

{cost_table(rows, "cpu_time_per_contact_and_step_ns")}

With one contact nearly all of a step is YADE's own, the same in both columns (starting the
parallel loops, counting time). The last column is for information.

## Table 1

{table1_table(rows)}

Both scenes have five bodies, one contact, possible further contacts, and the energy account. Table 1
has a second contact while the slider is at its stop. Only the scene of Table 1 has a thermal link and
a temperature.

## Reduced model

{reduced}

Required: a full cycle with all events below 2 µs.

## What dominates

The table has the share of each engine in the time of all engines, from separate runs with
`O.timingEnabled`. It omits the time that YADE needs between engines. Compare only the shares: the
totals are wall time, which other work on the machine increases. The collider runs only when a body
has left its enlarged box, here never.

{engines}

The InteractionLoop computes geometry, physics and law of the contacts. The
ThermalExpansionEngine sets the strain of all 2 n bodies in every step.

## Again

```
make bench
```

or `PYTHONPATH=build/python /usr/bin/python3 studies/bench/run.py --build build [--repetitions N]`; every
run is in `joints.csv`. `--threads 2` compares both with `-j2` by wall time and refuses on a busy
machine. One measurement alone:

```
PYTHONPATH=build/python STATEJUMP_BENCH_VARIANT=joint STATEJUMP_BENCH_SIZE=100 STATEJUMP_BENCH_STEPS=15000 \\
    yade -n -x -j1 studies/bench/yade_joints.py
```
"""


def prepare(arguments: argparse.Namespace) -> None:
    """Check what is needed before anything runs."""
    if shutil.which("yade") is None:
        raise BenchError("yade is not on PATH; 'make setup' installs it")
    if not list((arguments.build / "python" / "statejump_yade").glob("_native*.so")):
        raise BenchError(
            f"--build {arguments.build}: no plugin in python/statejump_yade; run 'make build'"
        )
    if not (arguments.build / "bench" / "engine" / "engine_bench").exists():
        raise BenchError(f"--build {arguments.build}: no engine_bench; run 'make build'")
    if arguments.repetitions < 1:
        raise BenchError(f"--repetitions {arguments.repetitions}: must be 1 or more")
    if arguments.threads not in (1, 2):
        raise BenchError(f"--threads {arguments.threads}: must be 1 or 2")
    if arguments.threads > 1:
        cores = len(os.sched_getaffinity(0))
        if cores < arguments.threads:
            raise BenchError(f"--threads {arguments.threads}: there are {cores} cores")
        load = os.getloadavg()[0]
        if load > BUSY_LOAD:
            raise BenchError(
                f"--threads {arguments.threads}: the machine is busy (load average {load:.2f}, "
                f"allowed {BUSY_LOAD}), and threads that wait for each other would be measured"
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build", help="build folder")
    parser.add_argument("--repetitions", type=int, default=7, help="of every run (default 7)")
    parser.add_argument(
        "--threads", type=int, default=1, help="2: both laws with -j2, by wall time, idle machine"
    )
    parser.add_argument(
        "--output", type=Path, default=REPOSITORY / "results" / "bench", help="results folder"
    )
    arguments = parser.parse_args()
    prepare(arguments)
    arguments.build = arguments.build.resolve()
    rows = measure(arguments.build, arguments.repetitions, arguments.threads)
    if arguments.threads > 1:
        write(arguments.output / f"joints_{arguments.threads}_threads.csv", as_csv(rows))
        print(cost_table(rows, "wall_time_s"))
        return
    engines = engine_table(arguments.build, min(3, arguments.repetitions))
    write(arguments.output / "joints.csv", as_csv(rows))
    reduced = reduced_table(arguments.build)
    write(arguments.output / "README.md", readme(rows, engines, reduced, arguments.repetitions))
    print(cost_table(rows, "cpu_time_per_contact_and_step_ns"))
    print(table1_table(rows))
    print(reduced)
    print(engines)


if __name__ == "__main__":
    start(main)
