# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures time and memory of bounds of class A over the number of joints, beside a path of the same truss.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/bounds.py [--largest 100000] [--outputs 10]

A row of nodes T stands on columns from fixed nodes B. Between each two of them stands a foot F that slides with
friction, scattered from foot to foot. Nodes, links and sliders are read from HDF5 tables. Each row is computed in two
processes, one for the bounds of all outputs and one for a path of one cycle with ten points for heating and ten for
cooling. Writes results/bench/bounds.md after every row.
"""
from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import tomli_w

from statejump.core.output import write_atomically
from statejump.kinds.loading import load_case
from statejump.kinds.truss import solve
from statejump.kinds.truss.bounds.study import bounds

SIZES = (1_000, 10_000, 100_000, 1_000_000)
MOST_PATH = 100_000  # joints of a path
MOST_K = 100.0
BUSY_LOAD = 0.5  # load average above which other programs take a part of the cores
HEAD = """# Bounds of class A against the number of joints

`PYTHONPATH=build/python /usr/bin/python3 studies/bench/bounds.py`: {outputs} outputs, one thread.

- `bounds` and `path` are CPU times after the case is read. The path has one cycle of twenty points. Required: bounds
  within 1/5 of the path at 100,000 joints.
- Memory is the peak of the process that computes the bounds, with the case. Required: 8 GB for a million joints.

{machine}

| joints | dofs | read [s] | bounds [s] | path [s] | bounds / path | peak memory of bounds [GB] |
|--:|--:|--:|--:|--:|--:|--:|
"""


def write(joints: int, folder: Path) -> None:
    """Write a case file and its tables: ground, top and foot nodes; columns, braces, chords and legs; sliders."""
    count, index = joints + 1, np.arange(joints + 1)
    names = {key: np.char.add(key.encode(), index.astype("S")) for key in "BTF"}
    place = {"B": np.column_stack((index, 0.0 * index)), "T": np.column_stack((index + 0.1, 0.9 + 0.0 * index)),
             "F": np.column_stack((index - 0.4, 0.0 * index))}
    fixed = {key: np.full((count, 2), b"", dtype="S1") for key in "BTF"}
    fixed["F"][:, 0] = b"y"
    fixed["B"][:] = [b"x", b"y"]
    fixed["F"][0] = [b"x", b"y"]
    with h5py.File(folder / "node.h5", "w") as file:
        file["name"] = np.concatenate([names[key] for key in "BTF"])
        file["position_m"] = np.concatenate([place[key] for key in "BTF"])
        file["fixed"] = np.concatenate([fixed[key] for key in "BTF"])
    links = [(first, at, second, at + on) for first, second, at, on in (
        ("B", "T", index, 0), ("B", "T", index[:-1], 1), ("T", "T", index[:-1], 1), ("T", "F", index[:-1], 1),
        ("F", "T", index[1:], 0))]
    with h5py.File(folder / "link.h5", "w") as file:
        ends = np.concatenate([np.column_stack((names[one][at], names[other][to])) for one, at, other, to in links])
        file["name"] = np.char.add(b"L", np.arange(len(ends)).astype("S"))
        file["nodes"] = ends
        for key, value in (("young_modulus_Pa", 70e9), ("cross_section_area_m2", 1e-4),
                           ("thermal_expansion_per_K", 2.3e-5)):
            file[key] = np.full(len(ends), value)
    with h5py.File(folder / "slider.h5", "w") as file:
        file["name"] = np.char.add(b"S", index[1:].astype("S"))
        file["nodes"] = names["F"][1:, None]
        file["axis"] = np.tile([1.0, 0.0], (joints, 1))
        file["friction_coefficient"] = 0.1 + 0.1 * np.random.default_rng(1).random(joints)
        file["normal_force_N"] = np.full(joints, 500.0)
    (folder / "case.toml").write_text(tomli_w.dumps({
        "case": {"name": "strip", "kind": "truss", "title": "Strip on feet", "source": "generated"},
        "truss": {"dimension": 2}, "tables": {section: f"{section}.h5" for section in ("node", "link", "slider")},
        "thermal": {"shape": "triangle", "temperature_change_max_K": MOST_K, "cycles": 1, "period_s": 1.0}}))


def read(folder: Path) -> tuple[Any, float]:
    """Return a case, and the CPU time to read and check it."""
    started = time.process_time()
    case = load_case(folder / "case.toml")
    case.resolve()
    return case, time.process_time() - started


def bound(joints: int, folder: Path, outputs: int) -> dict[str, float]:
    """Return CPU times of the bounds, and the peak of memory [GB]."""
    case, seconds = read(folder)
    nodes = [f"node:T{number}.y" for number in np.linspace(joints // 10, joints, outputs).astype(int)]
    started = time.process_time()
    found = bounds(case, nodes, simulate=False)
    assert len(found.bounds) == outputs and all(one.spread > 0 for one in found.bounds)
    return {"read": seconds, "bounds": time.process_time() - started,
            "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9}


def path(folder: Path) -> float:
    """Return the CPU time of a path."""
    truss = read(folder)[0].resolve()
    started = time.process_time()
    solve.path(truss, increments_per_branch=10, locate_events=False, cycle_ends_only=True)
    return time.process_time() - started


def alone(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call a function in a separate process."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(function, arguments)


def main() -> None:
    """Measure, print and write the table."""
    options = argparse.ArgumentParser(description="Time of bounds against the number of joints.")
    options.add_argument("--largest", type=int, default=SIZES[-1], help="largest number of joints")
    options.add_argument("--outputs", type=int, default=10)
    options.add_argument("--output", type=Path, default=Path("results/bench/bounds.md"))
    given = options.parse_args()
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    load = os.getloadavg()[0]
    machine = f"The machine was {'busy' if load > BUSY_LOAD else 'idle'} (load {load:.1f} before the first row)."
    text = HEAD.format(outputs=given.outputs, machine=machine)
    print(text, end="", flush=True)
    for joints in (size for size in SIZES if size <= given.largest):
        with tempfile.TemporaryDirectory(prefix="statejump-bench-") as folder:
            alone(write, joints, Path(folder))
            found = alone(bound, joints, Path(folder), given.outputs)
            walked = alone(path, Path(folder)) if joints <= MOST_PATH else float("nan")
        shown = (f"{walked:.3g} | {found['bounds'] / walked:.3f}" if joints <= MOST_PATH else " | ")
        row = (f"| {joints:,} | {3 * joints + 2:,} | {found['read']:.3g} | {found['bounds']:.3g} | {shown} | "
               f"{found['memory']:.2f} |\n")
        text += row
        print(row, end="", flush=True)
        with write_atomically(given.output) as stream:
            stream.write(text)


if __name__ == "__main__":
    main()
