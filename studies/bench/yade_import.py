#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the processor time of ``import statejump_yade`` in a new YADE process.

    /usr/bin/python3 studies/bench/yade_import.py --build build [--build OTHER] [--repetitions 20]

Several builds run in turn. "Setting up" is the time after the library is loaded: the guard compares the declared
interface with that of YADE, then the classes are registered. Prints medians, minima and maxima. Exit status 2 with a
message if a file is missing.
"""
from __future__ import annotations

import argparse
import os
import subprocess
import tempfile
from pathlib import Path
from statistics import median

from run import BenchError, start

# The script for YADE. It first loads the library by itself, to separate the time of the loader from that of the plugin.
SCRIPT = """
import importlib.util
import sys
import time
start = time.process_time()
package = importlib.util.find_spec("statejump_yade").submodule_search_locations[0]
native = importlib.util.spec_from_file_location("statejump_yade._native", package + "/_native.so")
sys.modules["statejump_yade._native"] = importlib.util.module_from_spec(native)
native.loader.exec_module(sys.modules["statejump_yade._native"])
loaded = time.process_time()
import statejump_yade
print("spent", time.process_time() - start, time.process_time() - loaded)
"""


def spent(build: Path, script: Path) -> tuple[float, float]:
    """Return the processor times in one YADE process [s] of the whole import and of setting up."""
    done = subprocess.run(
        ["yade", "-n", "-x", "-j1", str(script)], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(build / "python"), "PYTHONDONTWRITEBYTECODE": "1"},
    )
    for line in done.stdout.splitlines():
        word, *numbers = line.split()[:3] or [""]
        if word == "spent":
            whole, setting_up = map(float, numbers)
            return whole, setting_up
    last = (done.stderr.strip() or done.stdout.strip() or "no output").splitlines()[-1]
    raise BenchError(f"{build}: the import failed in YADE: {last}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, action="append", required=True, help="build tree; may be repeated")
    parser.add_argument("--repetitions", type=int, default=20)
    options = parser.parse_args()
    times: dict[Path, list[tuple[float, float]]] = {build: [] for build in options.build}
    with tempfile.TemporaryDirectory(prefix="statejump-run-") as folder:
        script = Path(folder) / "import.py"
        script.write_text(SCRIPT)
        for _ in range(options.repetitions):
            for build, found in times.items():
                found.append(spent(build.resolve(), script))
    print("| build | import [ms] | lowest to highest | setting up [ms] | lowest to highest |\n|---|--:|--:|--:|--:|")
    for build, found in times.items():
        columns = [sorted(1e3 * value for value in column) for column in zip(*found)]
        cells = [f"{median(column):.1f} | {column[0]:.1f} to {column[-1]:.1f}" for column in columns]
        print(f"| {build} | {' | '.join(cells)} |")


if __name__ == "__main__":
    start(main)
