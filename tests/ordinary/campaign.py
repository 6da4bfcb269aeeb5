#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves many ordinary structures; prints by class which fraction of those that have a quasi-static path is solved.

    PYTHONPATH=build/python tests/ordinary/campaign.py [--count 300] [--seed 1] [--families warren boom ...] [--jobs 1]
        [--out outcomes.csv] [--limit 60] [--nice 15] [--write FOLDER] [--at-least 0.98 0.95]

Family and seed determine a structure. Theory (``oracle.py``) decides whether it has a path. A worker process, which may
crash or exceed the time limit, solves it with default options. The first table counts all outcomes by family, the
second the outcomes of structures with a path. ``--write`` writes the case files of failures.
"""
from __future__ import annotations

import argparse
import csv
import json
import os
import signal
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Any

import structures

HERE = Path(__file__).resolve().parent
FIELDS = ("family", "seed", "plan", "loaded", "joints", "clearance", "kind", "class_a", "load_factor", "slack",
          "outcome", "reason", "seconds", "start_share", "jump_m", "difference", "sentence")
# Ratio of wall time to CPU time, on a busy machine, from which a worker counts as blocked.
BUSY = 30
START_S = 60.0  # longest time for the imports of a new process on a busy machine [s]
# Kinds of failures that agree with the verdict of theory.
RIGHT = {"mechanism": ("held_mechanism", "mechanism"), "unstable": ("buckled", "held_mechanism"),
         "overloaded": ("overloaded",)}
# Kinds that deny a path.
DENYING = ("buckled", "mechanism", "held_mechanism", "opened_mechanism", "overloaded", "singular", "refused")
Row = dict[str, Any]


class Worker:
    """A process that solves structures; it is replaced after a crash.

    :param limit_s: CPU time after which the process is ended [s]
    :param nice: niceness of the process
    """

    def __init__(self, limit_s: float, nice: int) -> None:
        self.limit_s, self.nice = limit_s, nice
        self.process: subprocess.Popen[str] | None = None
        self.lines: SimpleQueue[str] = SimpleQueue()

    def _started(self) -> subprocess.Popen[str]:
        if self.process is None or self.process.poll() is not None:
            self.process = subprocess.Popen(
                ["nice", "-n", str(self.nice), sys.executable, str(HERE / "worker.py"), str(self.limit_s)],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1,
                env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
            self.lines = SimpleQueue()
            Thread(target=self._read, args=(self.process, self.lines), daemon=True).start()
        return self.process

    @staticmethod
    def _read(process: subprocess.Popen[str], lines: SimpleQueue[str]) -> None:
        """Pass lines on until the process ends, then an empty line."""
        assert process.stdout is not None
        for line in process.stdout:
            lines.put(line)
        lines.put("")

    def solve(self, family: str, seed: int) -> Row:
        """Return the row of a structure."""
        process = self._started()
        row: Row = {"family": family, "seed": seed}
        assert process.stdin is not None
        process.stdin.write(f"{family} {seed}\n")
        process.stdin.flush()
        try:
            for _ in ("what theory says", "what the solver did"):
                line = self.lines.get(timeout=START_S + self.limit_s * BUSY)
                if not line:
                    return row | self._crash(process)
                row |= json.loads(line)
        except Empty:
            process.kill()
            process.wait()
            return row | {"outcome": "time-out", "reason": "asleep"}
        return row

    @staticmethod
    def _crash(process: subprocess.Popen[str]) -> Row:
        status = process.wait()
        reason = signal.Signals(-status).name if status < 0 else f"status {status}"
        return {"outcome": "time-out" if reason == "SIGPROF" else "crash", "reason": reason}

    def close(self) -> None:
        """End the process."""
        if self.process is not None and self.process.stdin is not None:
            self.process.stdin.close()
            self.process.wait()


def solved(chosen: list[tuple[str, int]], jobs: int, limit_s: float, nice: int = 15) -> Iterator[Row]:
    """Yield the rows of structures in their order."""
    free: SimpleQueue[Worker] = SimpleQueue()
    workers = [Worker(limit_s, nice) for _ in range(jobs)]
    for worker in workers:
        free.put(worker)

    def solve(one: tuple[str, int]) -> Row:
        worker = free.get()
        try:
            return worker.solve(*one)
        finally:
            free.put(worker)

    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(solve, chosen)
    for worker in workers:
        worker.close()


def outcome(row: Row) -> str:
    """Return the class of a row's outcome."""
    return row["outcome"] if row["outcome"] == "finished" else f"{row['outcome']}: {row['reason']}"


def has_path(row: Row) -> bool:
    """Return whether the structure has a path in theory."""
    return bool(row.get("kind") == "path")


def wrong_reason(row: Row) -> bool:
    """Return whether the reason of a failure contradicts theory."""
    if row["outcome"] not in ("failed", "refused"):
        return False
    if has_path(row):
        return row["reason"] in DENYING
    return row.get("kind") in RIGHT and row["reason"] not in RIGHT[row["kind"]]


def table(rows: list[Row]) -> str:
    """Return outcomes by family."""
    counted = Counter((row["family"], outcome(row)) for row in rows)
    classes = [name for name, _ in Counter(outcome(row) for row in rows).most_common()]
    lines = ["| family | " + " | ".join(classes) + " |", "|---|" + "---|" * len(classes)]
    for family in [*dict.fromkeys(row["family"] for row in rows), ""]:
        counts = [sum(count for (of, name), count in counted.items() if name == one and (not family or of == family))
                  for one in classes]
        lines.append(f"| {family or 'all'} | " + " | ".join(str(count or "") for count in counts) + " |")
    return "\n".join(lines)


def groups(rows: list[Row]) -> dict[str, list[Row]]:
    """Return the table rows of structures with a quasi-static path, grouped by the requirement on their class."""
    path = [row for row in rows if has_path(row)]
    return {
        "path, no clearance joint": [row for row in path if not row["clearance"]],
        "path, clearance joints": [row for row in path if row["clearance"]],
        "path, clearance joints, all loaded": [row for row in path if row["clearance"] and not row["slack"]],
        "class A, no clearance joint": [row for row in path if row["class_a"] and not row["clearance"]],
        "path, no joint": [row for row in path if row["joints"] == 0],
    }


def fraction(rows: list[Row]) -> float:
    """Return the fraction of rows that finished with correct results."""
    return sum(row["outcome"] == "finished" for row in rows) / max(len(rows), 1)


def summary(rows: list[Row]) -> str:
    """Return a table: fraction of structures with a quasi-static path that was finished, and count of wrong outcomes.
    """
    lines = ["| structures | number | finished | fraction |", "|---|---|---|---|"]
    for name, chosen in groups(rows).items():
        finished = sum(row["outcome"] == "finished" for row in chosen)
        lines.append(f"| {name} | {len(chosen)} | {finished} | {fraction(chosen):.3f} |")
    for name, chosen in (
        ("no path, but finished", [row for row in rows if row["outcome"] == "finished"
                                   and row.get("kind") in RIGHT]),
        ("wrong reason", [row for row in rows if wrong_reason(row)]),
        ("crash", [row for row in rows if row["outcome"] == "crash"]),
        ("time-out", [row for row in rows if row["outcome"] == "time-out"]),
        ("far start", [row for row in rows if row["reason"] == "far start"]),
        ("other wrong numbers", [row for row in rows if row["outcome"] == "wrong" and row["reason"] != "far start"]),
    ):
        lines.append(f"| {name} | {len(chosen)} | | {len(chosen) / max(len(rows), 1):.4f} |")
    verdicts = Counter(str(row.get("kind")) for row in rows)
    lines.append("\nverdicts: " + ", ".join(f"{name} {count}" for name, count in verdicts.most_common()))
    return "\n".join(lines)


def write_cases(rows: list[Row], folder: Path) -> None:
    """Write the case files of structures with a quasi-static path that were not finished, and of wrong outcomes."""
    from statejump.kinds.truss.generate.document import to_toml

    folder.mkdir(parents=True, exist_ok=True)
    for row in rows:
        if row["outcome"] == "finished" and row.get("kind") not in RIGHT:
            continue
        made = structures.make(row["family"], row["seed"])
        said = f"# {row.get('kind')}: {outcome(row)}\n# {row.get('sentence', '')}\n"
        (folder / f"{made.name}.toml").write_text(said + to_toml(made.document))


def arguments() -> argparse.Namespace:
    """Return what the command was given."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("--count", type=int, default=300, help="number of structures")
    given.add_argument("--seed", type=int, default=1, help="of the first structure of each family")
    given.add_argument("--families", nargs="+", choices=list(structures.FAMILIES), help="all")
    given.add_argument("--jobs", type=int, default=1, help="processes at a time")
    given.add_argument("--out", type=Path, help="CSV file with a row per structure")
    given.add_argument("--limit", type=float, default=60.0, help="seconds of the processor for a structure")
    given.add_argument("--nice", type=int, default=15, help="of the processes")
    given.add_argument("--write", type=Path, help="folder for the case files of what failed")
    given.add_argument("--at-least", type=float, nargs=2, metavar="FRACTION",
                       help="status 1 if fewer finish of those that have a path, without and with clearance joints")
    return given.parse_args()


def main() -> int:
    """Run a campaign; return the exit status."""
    given = arguments()
    rows = []
    out = given.out.open("w", newline="") if given.out else None
    writer = csv.DictWriter(out, FIELDS, extrasaction="ignore") if out else None
    if writer:
        writer.writeheader()
    for row in solved(structures.sample(given.count, given.seed, given.families), given.jobs, given.limit,
                      given.nice):
        rows.append(row)
        if writer and out:
            writer.writerow(row)
            out.flush()
    if out:
        out.close()
    print(f"{table(rows)}\n\n{summary(rows)}")
    if given.write:
        write_cases(rows, given.write)
    never = any(row["outcome"] in ("crash", "wrong") for row in rows)
    if given.at_least is None:
        return 0
    found = groups(rows)
    enough = (fraction(found["path, no clearance joint"]) >= given.at_least[0]
              and fraction(found["path, clearance joints"]) >= given.at_least[1])
    return int(never or not enough)


if __name__ == "__main__":
    sys.exit(main())
