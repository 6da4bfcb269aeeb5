# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the processor time of the quasi-static solver in two versions of the project, case by case.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/versions.py OLD NEW [--structures 60] [--repeat 5]
        [--limit 20]

OLD and NEW are folders with a built package `statejump` each. Cases are the shipped trusses and the structures of
tests/ordinary; only cases that both versions finish count. The versions run alternately in separate processes; only the
path in the engine is timed. Prints medians, their ratio, and the solved cases.
"""
from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
WORKER = '''
import json, sys, time
from statejump import _engine, load
from statejump.kinds.truss import solve
path, spent, limit_s = _engine.truss_path, [], float(sys.argv[1])
def timed(**items):
    began = time.process_time()
    items["progress"] = lambda share: time.process_time() - began < limit_s
    try:
        return path(**items)
    finally:
        spent.append(time.process_time() - began)
_engine.truss_path = timed
for line in sys.stdin:
    spent.clear()
    try:
        found = load(line.strip()).reduced().native
        answer = {"solves": found.solves, "factorizations": found.factorizations, "events": len(found.events)}
        if not found.complete:
            answer["failed"] = "takes longer"
    except Exception as failed:
        answer = {"failed": str(failed)}
    print(json.dumps(answer | {"seconds": sum(spent)}), flush=True)
'''


class Version:
    """A process that solves case files with one version of the built package.

    :param package: folder with the package
    :param limit_s: CPU time [s] after which a path is cancelled
    """

    def __init__(self, package: Path, limit_s: float) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", WORKER, str(limit_s)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, text=True,
            env={**os.environ, "PYTHONPATH": str(package), "OMP_NUM_THREADS": "1"})

    def solve(self, file: Path) -> dict[str, Any]:
        """Return seconds and sizes, or the reason of the failure."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(f"{file}\n")
        self.process.stdin.flush()
        found: dict[str, Any] = json.loads(self.process.stdout.readline())
        return found


def ordinary(folder: Path, count: int) -> Iterator[Path]:
    """Write case files of structures of tests/ordinary, one of each family in turn; yield the files."""
    sys.path.insert(0, str(ROOT / "tests" / "ordinary"))
    import structures
    from statejump.kinds.truss.generate.document import to_toml

    for one in structures.sample(count, 1):
        made = structures.make(*one)
        file = folder / f"{made.name}.toml"
        file.write_text(to_toml(made.document))
        yield file


def measured(versions: tuple[Version, Version], file: Path, repeat: int) -> dict[str, Any] | None:
    """Return the median times of both versions; None if one fails or exceeds the limit."""
    firsts = [version.solve(file) for version in versions]  # also warms caches
    if any("failed" in first for first in firsts):
        return None
    seconds = [[version.solve(file)["seconds"] for version in versions] for _ in range(repeat)]
    return {"seconds": [median(one) for one in zip(*seconds)], "first": firsts,
            "ratio": median(new / old for old, new in seconds)}


def main() -> None:
    """Print the table."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("old", type=Path)
    given.add_argument("new", type=Path)
    given.add_argument("--structures", type=int, default=60)
    given.add_argument("--repeat", type=int, default=5)
    given.add_argument("--limit", type=float, default=20.0, help="seconds of a case beyond which it is left out")
    asked = given.parse_args()
    versions = Version(asked.old, asked.limit), Version(asked.new, asked.limit)
    totals, ratios = [0.0, 0.0], []
    print("| case | events | solves, old | new | factorizations, old | new | old [ms] | new [ms] | ratio |\n"
          "|---|--:|--:|--:|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as folder:
        shipped = sorted((ROOT / "cases" / "trusses").glob("*.toml"))
        for file in [*shipped, *ordinary(Path(folder), asked.structures)]:
            found = measured(versions, file, asked.repeat)
            if found is None:
                continue
            (old, new), (first, second) = found["seconds"], found["first"]
            totals, ratios = [totals[0] + old, totals[1] + new], [*ratios, found["ratio"]]
            print(f"| {file.stem} | {second['events']} | {first['solves']} | {second['solves']} | "
                  f"{first['factorizations']} | {second['factorizations']} | {1e3 * old:.1f} | {1e3 * new:.1f} | "
                  f"{found['ratio']:.3f} |", flush=True)
    print(f"| all {len(ratios)}, sums; median ratio | | | | | | {1e3 * totals[0]:.1f} | {1e3 * totals[1]:.1f} | "
          f"{median(ratios):.3f} |\n\nratio of sums: {totals[1] / totals[0]:.3f}")


if __name__ == "__main__":
    main()
