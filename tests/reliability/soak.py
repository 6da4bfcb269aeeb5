#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Soak test: hours of use in one process leak no memory, files or threads.

    soak.py --python build/python [--minutes M]

A round uses every kind of case through the public interface: reduced models, statics, comparison of result files, the
report, export, answers, a campaign; also refused input. After each round the test counts memory, open files, threads
and temporary files. In the first half memory may grow, because caches fill. The maximum of the second half may exceed
that of the first by less than SLACK_BYTES per round, and by less than LARGEST_BYTES in all. Empty pages of the
allocator are released before counting. Maxima are compared, because the memory of single rounds varies. Pages of files
do not count, because the system drops and reads them at any time. Numbers of files and threads must stay those of the
first round.
"""
from __future__ import annotations

import argparse
import ctypes
import gc
import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).resolve().parents[2]
# A history of one of the cases has some 2 000 samples of 20 values: a round that keeps one grows by ten times this.
SLACK_BYTES = 32_000
# What the allocator may hold back without anything being lost: pieces of its arenas.
LARGEST_BYTES = 2 << 20
FEWEST_ROUNDS = 4
# Rounds until a campaign has a worker process again: in the first one, so that what is loaded for it is counted there.
ROUNDS_PER_CLUSTER = 8


def rounds(folder: Path) -> Callable[[int], None]:
    """Return a function that runs one round. Its argument is the number of the round; files of the last round are
    overwritten."""
    import statejump as sj
    from statejump.cli import main

    reduced = [sj.load(REPOSITORY / "cases" / name) for name in (
        "table1.toml", "umbrella.toml", "trusses/chain_10.toml", "trusses/ring_12.toml", "trusses/umbrella_rib.toml")]
    statics = [sj.load(REPOSITORY / "cases" / name) for name in ("statics_journal.toml", "statics_slot.toml")]

    def command(wanted: int, *words: Any) -> None:
        status = main.run([*map(str, words), "--quiet"] if words[0] != "info" else list(map(str, words)))
        assert status == wanted, (status, words)

    def once(number: int) -> None:
        for case in reduced:
            run = case.reduced()
            run.frame()
            case.changed({"case.title": "another"}).to_dict()
        for case in statics:
            sj.statics(case)
        for name in ("table1", "umbrella"):
            command(0, "reduced", name, "--results", folder)
        file = folder / "table1" / "reduced.h5"
        sj.read(file).case.reduced()
        command(0, "compare", file, file)
        command(0, "info", file)
        command(0, "report", file, "-o", folder / "page.html")
        command(0, "export", file, "--to", folder / "out", "--frames", "2")
        command(0, "truss", "answers", "trusses/chain_10", "--no-sensitivity", "--results", folder)
        command(0, "sweep", REPOSITORY / "cases/campaigns/table1_friction.toml", "--restart", "--results", folder,
                *(("--workers", "1") if number % ROUNDS_PER_CLUSTER == 0 else ()))
        command(2, "reduced", "nowhere", "--results", folder)
        command(2, "info", REPOSITORY / "README.md")

    return once


def counted(temporary: Path) -> dict[str, int]:
    """Return what this process holds."""
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)  # what is free and not given back depends on the order of things in threads
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    return {
        "memory_bytes": 1024 * int(status["RssAnon"].split()[0]), "threads": int(status["Threads"]),
        "files": len(os.listdir("/proc/self/fd")), "temporary": len(list(temporary.iterdir())),
    }


def _line(found: list[dict[str, int]]) -> str:
    return f"round {len(found)}: " + ", ".join(f"{name} {value:,}" for name, value in found[-1].items())


def main() -> int:
    """Use the package for the given time and print the counts; return 1 if anything leaks."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", type=Path, required=True, help="the built package")
    parser.add_argument("--minutes", type=float, default=30.0)
    given = parser.parse_args()
    sys.path.insert(0, str(given.python.resolve()))
    os.environ["MPLBACKEND"] = "agg"
    with tempfile.TemporaryDirectory(prefix="soak-") as root:
        temporary = Path(root) / "temporary"
        temporary.mkdir()
        tempfile.tempdir, os.environ["TMPDIR"] = str(temporary), str(temporary)
        sys.stdout.flush()
        told, told_errors, quiet = os.dup(1), os.dup(2), os.open(os.devnull, os.O_WRONLY)
        os.dup2(quiet, 1)  # what the commands print
        os.dup2(quiet, 2)
        os.close(quiet)
        once, found, end = rounds(Path(root) / "results"), [], time.monotonic() + 60 * given.minutes
        try:
            while time.monotonic() < end or len(found) < FEWEST_ROUNDS:
                once(len(found))
                found.append(counted(temporary))
                if len(found).bit_count() == 1:
                    os.write(told, f"{_line(found)}\n".encode())
        finally:
            sys.stdout.flush()
            os.dup2(told, 1)
            os.dup2(told_errors, 2)
    last = found[-1]
    grown = last["memory_bytes"] - max(counts["memory_bytes"] for counts in found[:len(found) // 2 + 1])
    allowed = min(SLACK_BYTES * (len(found) - len(found) // 2) + (LARGEST_BYTES >> 1), LARGEST_BYTES)
    faults = [f"allowed are {allowed:,} bytes"] if grown > allowed else []
    faults += [f"{name}: {found[0][name]} after the first round, {last[name]} after the last"
               for name in ("threads", "files", "temporary") if last[name] != found[0][name]]
    print(_line(found))
    print(f"{len(found)} rounds, {time.process_time():.0f} s of a core; memory grew by {grown:,} bytes over the second "
          f"half; faults {len(faults)}")
    for fault in faults:
        print(f"  {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
