#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the reduced model of every shipped case gives the same bits with any compiler, optimisation and number of
threads.

    determinism.py FOLDER [--beside build/python] [--compiler clang++] [--level=-O2] [--case NAME ...]

Builds engine and Python package below FOLDER with GCC and Clang at -O0, -O2 and -O3. Runs the shipped cases with each
build, and once more with two threads in libraries that use threads. Prints a row for every case: the hash of all its
numbers by the first build, and the builds with a different hash. Exit status 1: some hash differs. ``--beside`` gives
an existing package, which becomes the first build. Existing builds and results are kept.
"""
from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
from itertools import product
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PYTHON = "/usr/bin/python3"
OFF = ("YADE", "REPORT", "TESTS", "BENCH")
COMPILERS, LEVELS = ("g++", "clang++"), ("-O0", "-O2", "-O3")
# Runs inside the build's own Python: hashes by case.
HASHES = """
import hashlib, json, sys
from pathlib import Path
import numpy as np
import statejump as sj
from shipped_results import numbers
found = {}
for file in sorted(Path(sys.argv[1]).rglob("*.h5")):
    columns = numbers(sj.read(file).models["reduced"])
    together = hashlib.sha256()
    for name in sorted(columns):
        values = columns[name]
        together.update(name.encode())
        together.update(values.tobytes() if values.dtype.kind in "fiub" else repr(values.tolist()).encode())
    found[file.parent.name] = together.hexdigest()[:16]
print(json.dumps(found))
"""


def call(*words: object, **environment: str) -> str:
    """Run a command and return its output; if it fails, end the campaign."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False,
                          env={**os.environ, **environment})
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: status {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def built(folder: Path, compiler: str, level: str) -> Path:
    """Configure and compile; return the folder for PYTHONPATH."""
    call("cmake", "-G", "Ninja", "-S", REPOSITORY, "-B", folder, f"-DCMAKE_CXX_COMPILER={compiler}",
         "-DCMAKE_BUILD_TYPE=None", f"-DCMAKE_CXX_FLAGS={level} -DNDEBUG",
         *(f"-DSTATEJUMP_BUILD_{part}=OFF" for part in OFF))
    call("cmake", "--build", folder, "--parallel", str(len(os.sched_getaffinity(0))))
    return folder / "python"


def hashes(python: Path, results: Path, cases: list[str], threads: int) -> dict[str, str]:
    """Run the cases; return a hash by name of case."""
    environment = {"PYTHONPATH": f"{python}:{REPOSITORY / 'scripts'}", "PYTHONDONTWRITEBYTECODE": "1",
                   "OMP_NUM_THREADS": str(threads), "OPENBLAS_NUM_THREADS": str(threads)}
    chosen = [word for case in cases for word in ("--case", case)]
    call(PYTHON, REPOSITORY / "scripts" / "shipped_results.py", "run", results, "--model", "reduced", *chosen,
         **environment)
    found: dict[str, str] = json.loads(call(PYTHON, "-c", HASHES, results, **environment))
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--compiler", action="append", choices=COMPILERS, help="both if not given")
    parser.add_argument("--level", action="append", choices=LEVELS, help="all if not given")
    parser.add_argument("--beside", type=Path, metavar="PYTHON", help="a built package to compare with")
    parser.add_argument("--case", action="append", default=[])
    options = parser.parse_args()
    found: dict[str, dict[str, str]] = {}
    if options.beside:
        results = options.folder.resolve() / "beside"
        found[str(options.beside)] = hashes(options.beside.resolve(), results, options.case, 1)
    for compiler, level in product(options.compiler or COMPILERS, options.level or LEVELS):
        name = f"{compiler} {level}"
        folder = options.folder.resolve() / (compiler + level)
        python = built(folder / "build", compiler, level)
        found[name] = hashes(python, folder / "results", options.case, 1)
        print(f"{name}: {len(found[name])} cases", file=sys.stderr, flush=True)
        if not level.endswith("0"):
            found[f"{name}, 2 threads"] = hashes(python, folder / "results_2", options.case, 2)
    first, *others = found
    print(f"| case | {first} | other |\n|---|---|---|")
    status = 0
    for case, expected in found[first].items():
        different = [name for name in others if found[name].get(case) != expected]
        status = 1 if different else status
        print(f"| {case} | `{expected}` | {', '.join(different) or 'the same'} |")
    everything = hashlib.sha256(json.dumps(found[first], sort_keys=True).encode()).hexdigest()[:16]
    print(f"{len(found)} ways, {len(found[first])} cases; hash of all by {first}: {everything}")
    return status


if __name__ == "__main__":
    sys.exit(main())
