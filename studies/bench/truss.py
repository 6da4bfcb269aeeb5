# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures time and memory of the quasi-static truss solver over the number of joints.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/truss.py [--largest 1000000] [--trusses ring umbrella]

Two trusses run through one temperature cycle with ten points for heating and ten for cooling: the ring of `statejump
truss ring` with preload, and the umbrella with cables between its ribs. The umbrella's friction is scattered, so that
every joint slips at a different temperature. Nodes, links and joints are read from HDF5 tables; for 100 000 joints also
passed as Python objects. OMP_NUM_THREADS sets the number of threads. Every row is computed in a separate process, to
measure its memory. Writes results/bench/truss.md after every row.
"""
from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import tomli_w

from statejump.core.output import write_atomically
from statejump.kinds.loading import load_case, parse_case
from statejump.kinds.truss import generate, solve

SIZES = (10, 100, 1_000, 10_000, 100_000, 1_000_000)
AS_OBJECTS = 100_000
REPEATED = 3  # number of runs from tables up to that size; the median counts
TRUSSES = ("ring", "umbrella")
ITEMS = ("node", "link", "revolute", "spring", "torsion_spring")
BUSY_LOAD = 0.5  # load average above which other programs take a part of the cores
HEAD = """# Quasi-static truss solver against the number of joints

`PYTHONPATH=build/python /usr/bin/python3 studies/bench/truss.py`: one cycle, ten points a branch, with
{threads} (results have the same bits with any number of threads).

- `read` is CPU time, `solve` is wall time, and `CPU` is the CPU time of all threads in `solve`.
- Events are changes of stick, slip and contact. In rings of 100 joints and more the truss is stiff around each joint,
  and no joint slips. In the umbrella every joint slips out and back, each at its own temperature.
- Items come from HDF5 tables beside the case file, or from Python objects. `read` includes their checks.
- Memory is the peak of the process. Python itself needs 50 MiB of it.
- Rows with tables are medians of {repeated} runs, except the single run of a million joints.

{machine}

| truss | items as | joints | unknowns | events | solves | factorizations | read [s] | solve [s] | CPU [s] | \
per joint [µs] | peak memory [MiB] |
|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|
"""


def document(truss: str, joints: int) -> dict[str, Any]:
    """Return the case of a size."""
    if truss == "ring":
        return generate.ring(joints)
    made = generate.umbrella(joints, cable_preload_N=1.0)
    scatter = np.random.default_rng(1)
    for joint in made["revolute"]:
        joint["friction_coefficient"] = 0.1 + 0.1 * float(scatter.random())
    return made


def column(items: Sequence[Mapping[str, Any]], key: str) -> Any:
    """Return the values of a key for all nodes, links or joints as a data set; a missing value is NaN or empty text."""
    given: Any = next(item[key] for item in items if key in item)
    if not isinstance(given, list):
        none: Any = "" if isinstance(given, str) else np.nan
        return [item.get(key, none) for item in items]
    none = "" if isinstance(given[0], str) else np.nan
    width = max(len(item.get(key, ())) for item in items)
    return [[*(entries := item.get(key, ())), *[none] * (width - len(entries))] for item in items]


def write(truss: str, joints: int, folder: Path) -> None:
    """Write a case file and its tables."""
    made = document(truss, joints)
    beside = {}
    for section in (section for section in ITEMS if section in made):
        items = made.pop(section)
        with h5py.File(folder / f"{section}.h5", "w") as file:
            for key in dict.fromkeys(key for item in items for key in item):
                file[key] = column(items, key)
        beside[section] = f"{section}.h5"
    made.pop("reflector", None)  # it lists a node of every rib, and the path does not need it
    (folder / "case.toml").write_text(tomli_w.dumps({**made, "tables": beside}), encoding="utf-8")


def measure(truss: str, joints: int, folder: Path | None) -> tuple[float, str]:
    """Return the time of a quasi-static path [s], and a row of the results table.

    :param folder: folder of the case file with tables; None: items as Python objects
    """
    given = document(truss, joints) if folder is None else {}
    started = time.process_time()
    case = parse_case(given) if folder is None else load_case(folder / "case.toml")
    resolved = case.resolve()
    read = time.process_time() - started
    started, busy = time.perf_counter(), time.process_time()
    found = solve.path(resolved, increments_per_branch=10, locate_events=False, cycle_ends_only=True)
    seconds, busy = time.perf_counter() - started, time.process_time() - busy
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return seconds, (
        f"| {truss} | {'objects' if folder is None else 'tables'} | {joints:,} | {found.unknowns:,} | "
        f"{len(found.events):,} | {found.solves} | {found.factorizations} | {read:.3g} | {seconds:.3g} | "
        f"{busy:.3g} | {1e6 * seconds / joints:.0f} | {peak:.0f} |"
    )


def alone(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call a function in a separate process."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(function, arguments)


def main() -> None:
    """Measure, print and write the table."""
    options = argparse.ArgumentParser(description="Time of the truss solver against the number of joints.")
    options.add_argument("--largest", type=int, default=SIZES[-1], help="largest number of joints")
    options.add_argument("--trusses", nargs="+", choices=TRUSSES, default=TRUSSES)
    options.add_argument("--output", type=Path, default=Path("results/bench/truss.md"))
    given = options.parse_args()
    load = os.getloadavg()[0]
    machine = f"The machine was {'busy' if load > BUSY_LOAD else 'idle'} (load {load:.1f} before the first row)."
    threads = int(os.environ.get("OMP_NUM_THREADS", len(os.sched_getaffinity(0))))
    shown = "one thread" if threads == 1 else f"{threads} threads"
    text = HEAD.format(machine=machine, repeated=REPEATED, threads=shown)
    print(text, end="", flush=True)
    for truss in given.trusses:
        for joints in (size for size in SIZES if size <= given.largest):
            with tempfile.TemporaryDirectory(prefix="statejump-bench-") as folder:
                alone(write, truss, joints, Path(folder))
                runs = range(REPEATED if joints <= AS_OBJECTS else 1)
                rows = [sorted(alone(measure, truss, joints, Path(folder)) for _ in runs)[len(runs) // 2][1]]
            if joints == AS_OBJECTS:
                rows.append(alone(measure, truss, joints, None)[1])
            text += "".join(f"{row}\n" for row in rows)
            print(*rows, sep="\n", flush=True)
            with write_atomically(given.output) as stream:
                stream.write(text)


if __name__ == "__main__":
    main()
