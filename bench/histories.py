# SPDX-License-Identifier: GPL-3.0-or-later
"""Time and memory of a truss whose every member has a temperature history of its own, followed to the end.

    PYTHONPATH=build/python /usr/bin/python3 bench/histories.py [--members 10000] [--times 1000]

An umbrella with cables between its ribs, two members and a clearance joint each. `statejump.orbit` gives every member
its temperatures over ten orbits, each with a sunlit share of its own; they are written as HDF5, as a case takes them.
Read, checked and followed in a process of its own for every size, so that the memory is its own. Writes
results/bench/histories.md.
"""
from __future__ import annotations

import argparse
import multiprocessing
import resource
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

from statejump import orbit
from statejump.core.output import write_atomically
from statejump.core.temperature_files import with_files
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import generate, solve
from statejump.kinds.truss.case import TrussThermal

ORBITS, PERIOD_S, SHADOW_S = 10, 5400.0, (1800.0, 3900.0)
SIZES = (100, 1000, 10_000)


def peak_MB() -> float:
    """Return the largest memory of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def write_histories(file: Path, names: list[str], times: int) -> None:
    """Write the temperatures of an orbit that is repeated."""
    views = 0.1 + 0.2 * np.random.default_rng(1).random(len(names))
    found = orbit.temperatures(
        [orbit.Member(name, 0.8, 0.8, float(view), 2500.0) for name, view in zip(names, views)], period_s=PERIOD_S,
        shadow_s=[SHADOW_S], orbits=ORBITS, samples_per_orbit=times // ORBITS - 2)
    with h5py.File(file, "w") as made:
        made["time_s"], made["temperature_K"] = found.time_s, found.temperature_K
        made["members"] = np.array(names, dtype=h5py.string_dtype())


def measure(members: int, times: int) -> str:
    """Return one row of the table."""
    document = generate.umbrella(members // 2, cable_preload_N=1.0)
    for link in document["link"]:  # the histories say how warm each is
        link.pop("temperature_fraction", None)
    with tempfile.TemporaryDirectory() as folder:
        write_histories(Path(folder, "members.h5"), [link["name"] for link in document["link"]], times)
        document["thermal"] = {"shape": "table", "members_file": "members.h5", "reference_temperature_K": 250.0,
                               "lead_in_s": 600.0}
        document["reduced"] = {"increments_per_branch": 1}
        started = time.process_time()
        case = parse_case(with_files(document, Path(folder), TrussThermal))
        read_s, read_MB = time.process_time() - started, peak_MB()
    truss = case.resolve()
    started = time.process_time()
    found = solve.path(truss, increments_per_branch=1, locate_events=False, cycle_ends_only=True)
    seconds = time.process_time() - started
    rows = len(case.thermal.members.time_s)
    return (f"| {members:,} | {rows:,} | {read_s:.3g} | {read_MB:.0f} | {len(found.events):,} | {found.solves:,} | "
            f"{found.factorizations:,} | {seconds:.3g} | {1e3 * seconds / rows:.3g} | {peak_MB():.0f} |")


def main() -> None:
    """Measure, print and write the table."""
    options = argparse.ArgumentParser(description="Members with temperatures of their own, followed by the solver.")
    options.add_argument("--members", type=int, default=SIZES[-1], help="largest number of members")
    options.add_argument("--times", type=int, default=1000, help="rows of the history")
    options.add_argument("--output", type=Path, default=Path("results/bench/histories.md"))
    given = options.parse_args()
    lines = [
        "# Members with temperatures of their own", "", "Measured by `bench/histories.py`, one core.", "",
        "| members | rows | read and checked [s] | memory then [MB] | events | solves | factorizations | "
        "followed [s] | per row [ms] | memory at the end [MB] |", "|" + "---:|" * 10,
    ]
    for size in (size for size in SIZES if size <= given.members):
        with multiprocessing.get_context("spawn").Pool(1) as alone:
            lines.append(alone.apply(measure, (size, given.times)))
        print(lines[-1], flush=True)
    with write_atomically(given.output) as stream:
        stream.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
