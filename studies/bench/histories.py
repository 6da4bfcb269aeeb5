# SPDX-License-Identifier: GPL-3.0-or-later
"""Time and memory of a truss with a separate temperature history for every member, solved to the end.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/histories.py [--members 10000] [--times 1000]

There are two trusses. The umbrella has ribs of two members and a clearance joint, with cables between the ribs; most
joints slip at once. The mast is a double-layer grid, two bays of 0.2 m across, whose length depends on the number of
members (125 m for 10 000). At every tenth bay the chords have latches: sliders with friction and free play.
`statejump.orbit` computes the temperatures of every member over ten orbits, with individual sunlit fractions; the case
reads them from HDF5. Every row of results is computed in a separate process, to measure its memory. Writes
results/bench/histories.md.
"""
from __future__ import annotations

import argparse
import multiprocessing
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Callable

import h5py
import numpy as np

from statejump import orbit
from statejump.core.output import write_atomically
from statejump.core.temperature_files import with_files
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import generate, solve
from statejump.kinds.truss.sections import TrussThermal

ORBITS, PERIOD_S, SHADOW_S = 10, 5400.0, (1800.0, 3900.0)
# The mast: number of bays across, length of a bay [m], bays from latch to latch and from support to support.
ACROSS, BAY_M, FOLD, MOUNT = 2, 0.2, 10, 25
TUBE = {"young_modulus_Pa": 1.2e11, "cross_section_area_m2": 6e-5, "thermal_expansion_per_K": 0.5e-6}
LATCH = {"axis": [1.0, 0.0, 0.0], "normal_force_N": 60.0, "friction_coefficient": 0.2, "clearance_minus_m": 5e-5,
         "clearance_plus_m": 5e-5}


def umbrella(members: int) -> dict[str, Any]:
    """Return an umbrella of so many members."""
    document = generate.umbrella(members // 2, cable_preload_N=1.0)
    for link in document["link"]:  # the histories say how warm each is
        link.pop("temperature_fraction", None)
    return document


def mast(members: int) -> dict[str, Any]:
    """Return a double-layer grid with 16 members per bay of its length. Each layer consists of squares; the upper layer
    is shifted by half a bay, and four diagonals descend from each of its nodes. At every 25th bay supports hold the
    edges across the mast, but not along it."""
    bays = members // (8 * ACROSS)
    places = {f"B{i}_{j}": (i * BAY_M, j * BAY_M, 0.0) for i in range(bays + 1) for j in range(ACROSS + 1)}
    places |= {f"T{i}_{j}": ((i + 0.5) * BAY_M, (j + 0.5) * BAY_M, BAY_M / 2**0.5)
               for i in range(bays) for j in range(ACROSS)}
    links: list[dict[str, Any]] = []
    sliders: list[dict[str, Any]] = []

    def bar(first: str, second: str, latched: bool = False) -> None:
        start = first
        if latched:
            start = f"{first}_latch"
            places[start] = places[first]
            sliders.append({"name": f"latch_{first}", "nodes": [start, first], **LATCH})
        links.append({"name": f"{first}-{second}", "nodes": [start, second], **TUBE})

    for layer, last, across in (("B", bays, ACROSS), ("T", bays - 1, ACROSS - 1)):
        for i in range(last + 1):
            for j in range(across + 1):
                if i < last:
                    bar(f"{layer}{i}_{j}", f"{layer}{i + 1}_{j}", latched=0 < i and i % FOLD == 0)
                if j < across:
                    bar(f"{layer}{i}_{j}", f"{layer}{i}_{j + 1}")
    for i in range(bays):
        for j in range(ACROSS):
            for down in (0, 1):
                for side in (0, 1):
                    bar(f"T{i}_{j}", f"B{i + down}_{j + side}")
    held = {f"B{i}_{j}": "yz" if j == 0 else "z" for i in range(0, bays + 1, MOUNT) for j in (0, ACROSS)}
    held["B0_0"] = "xyz"
    nodes = [{"name": name, "position_m": list(place), **({"fixed": list(held[name])} if name in held else {})}
             for name, place in places.items()]
    return {"case": {"name": "mast", "kind": "truss"}, "truss": {"dimension": 3}, "node": nodes, "link": links,
            "slider": sliders}


TRUSSES: dict[str, tuple[Callable[[int], dict[str, Any]], tuple[int, ...]]] = {
    "umbrella": (umbrella, (100, 1000)), "mast": (mast, (1000, 10_000)),
}


def peak_MB() -> float:
    """Return the largest memory of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def write_histories(file: Path, names: list[str], times: int) -> None:
    """Write the temperatures of a periodic orbit."""
    views = 0.1 + 0.2 * np.random.default_rng(1).random(len(names))
    found = orbit.temperatures(
        [orbit.Member(name, 0.8, 0.8, float(view), 2500.0) for name, view in zip(names, views)], period_s=PERIOD_S,
        shadow_s=[SHADOW_S], orbits=ORBITS, samples_per_orbit=times // ORBITS - 2)
    with h5py.File(file, "w") as made:
        made["time_s"], made["temperature_K"] = found.time_s, found.temperature_K
        made["members"] = np.array(names, dtype=h5py.string_dtype())


def on_progress(share: float) -> bool:
    """Say how far the path is."""
    if sys.stderr.isatty():
        print(f"\r{100 * share:5.1f} %", end="", file=sys.stderr, flush=True)
    return True


def measure(truss: str, members: int, times: int) -> str:
    """Return one row of the table."""
    document = TRUSSES[truss][0](members)
    with tempfile.TemporaryDirectory() as folder:
        write_histories(Path(folder, "members.h5"), [link["name"] for link in document["link"]], times)
        document["thermal"] = {"shape": "table", "members_file": "members.h5", "reference_temperature_K": 250.0,
                               "lead_in_s": 600.0}
        document["reduced"] = {"increments_per_branch": 1}
        started = time.process_time()
        case = parse_case(with_files(document, Path(folder), TrussThermal))
        read_s, read_MB = time.process_time() - started, peak_MB()
    resolved = case.resolve()
    started = time.process_time()
    found = solve.path(resolved, increments_per_branch=1, locate_events=False, cycle_ends_only=True,
                       progress=on_progress)
    seconds = time.process_time() - started
    assert found.complete
    rows = len(case.thermal.members.time_s)
    return (f"| {truss} | {len(case.link):,} | {resolved.number_of_joints():,} | {rows:,} | {read_s:.3g} | "
            f"{read_MB:.0f} | {len(found.events):,} | {found.solves:,} | {found.factorizations:,} | {seconds:.3g} | "
            f"{1e3 * seconds / rows:.3g} | {peak_MB():.0f} |")


def main() -> None:
    """Measure, print and write the table."""
    options = argparse.ArgumentParser(description="Members with temperatures of their own, followed by the solver.")
    options.add_argument("--members", type=int, default=10_000, help="largest number of members")
    options.add_argument("--times", type=int, default=1000, help="rows of the history")
    options.add_argument("--truss", choices=tuple(TRUSSES), action="append", help="only this one")
    options.add_argument("--output", type=Path, default=Path("results/bench/histories.md"))
    given = options.parse_args()
    lines = [
        "# Members with temperatures of their own", "",
        "Measured by `studies/bench/histories.py`: CPU time of one core, memory of a process of its own at its peak.",
        "",
        "| truss | members | joints | rows | read and checked [s] | memory then [MB] | events | solves | "
        "factorizations | followed [s] | per row [ms] | memory at the end [MB] |", "|---|" + "---:|" * 11,
    ]
    for truss in given.truss or TRUSSES:
        for size in (size for size in TRUSSES[truss][1] if size <= given.members):
            with multiprocessing.get_context("spawn").Pool(1) as alone:
                lines.append(alone.apply(measure, (truss, size, given.times)))
            print(lines[-1], flush=True)
    with write_atomically(given.output) as stream:
        stream.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
