#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares hashes of the final states of the JointStepper and of YADE's loop; writes results/bench/equality.md.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/equality.py --build build

For shipped cases the hash covers all numbers of the results, with one thread. For the scenes and laws of
tests/yade/test_stepper.py and test_stepper_bores.py it covers everything in O: positions, velocities, orientations,
forces, contacts, links, springs, energies, bounds. Exit status: 2 with a message if a run fails, 1 if a pair of hashes
differs.
"""
from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import statejump
from run import REPOSITORY, BenchError, start, write
from statejump.core.errors import StatejumpError
from statejump.core.run import GROUPS

CASES = ("table1", "table1_frictionless", "table1_wide", "umbrella_damped", "trusses/chain_10", "trusses/latch_lever")
SCRIPTS = REPOSITORY / "tests" / "yade" / "scripts"
SCENES = {"stepper.py": "joint", "stepper_bores.py": "journal in a bore of triangles"}  # what has laws
DIGITS = 12
Row = tuple[str, str, int, str, str]  # name, law, steps, hash of YADE's loop, hash of the stepper


def of_case(name: str) -> Row:
    """Both runs of a shipped case."""
    case = statejump.load(REPOSITORY / "cases" / f"{name}.toml")
    hashes, steps = [], 0
    for stepper in ("yade", "joint"):
        run = case.changed({"dem.stepper": stepper}).dem()
        steps = run.about["steps"]
        found = hashlib.sha256()
        for group in GROUPS:
            for column, one in getattr(run, group).items():
                found.update(f"{group}/{column}".encode() + one.values.tobytes())
        hashes.append(found.hexdigest()[:DIGITS])
    return f"`cases/{name}.toml`", "of the case", steps, hashes[0], hashes[1]


def of_scenes(build: Path, script: str, joint: str, part: str) -> list[Row]:
    """Return the rows of one part of a test script."""
    paths = [build / "python", SCRIPTS, *(REPOSITORY / "yade_scripts" / name for name in ("examples", "runner"))]
    done = subprocess.run(
        ["yade", "-n", "-x", "-j1", str(SCRIPTS / script), part], stdin=subprocess.DEVNULL, capture_output=True,
        text=True, check=False, env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, paths))})
    _, there, result = done.stdout.partition("RESULT {")
    if not there:
        said = (done.stderr.strip() or done.stdout.strip() or "no output").splitlines()[-1]
        raise BenchError(f"{script} {part}: {said}")
    rows = []
    for name, found in json.loads("{" + result.splitlines()[0]).items():
        kind, _, law = name.rpartition(" ")
        what, law = (joint, f"{kind} {law}") if part == "laws" else (name, "of the scene")
        rows.append((what, law, found["steps"], *(one[:DIGITS] for one in found["hashes"])))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build", help="build folder")
    parser.add_argument("--output", type=Path, default=REPOSITORY / "results" / "bench")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    rows = [of_case(name) for name in CASES]
    for script, joint in SCENES.items():
        rows += [*of_scenes(build, script, joint, "scenes"), *of_scenes(build, script, joint, "laws")]
    lines = "\n".join(f"| {what} | {law} | {steps:,} | {yade} | {joint} | {'yes' if yade == joint else '**no**'} |"
                      for what, law, steps, yade, joint in rows)
    equal = sum(yade == joint for *_, yade, joint in rows)
    text = f"""# The JointStepper's bits beside YADE's loop

The table has the first {DIGITS} digits of the SHA-256 of each run, on one thread. For shipped cases the hash covers
every number of the results. For the scenes and laws of [test_stepper.py](../../tests/yade/test_stepper.py), and for the
bores of triangles of [test_stepper_bores.py](../../tests/yade/test_stepper_bores.py), it covers everything in `O` at
the end. {equal} of {len(rows)} pairs are equal. Another compiler or processor may change the hashes, both columns
together.

| scene | law | steps | YADE's loop | `JointStepper` | equal |
|---|---|--:|---|---|---|
{lines}

Again: `PYTHONPATH=build/python /usr/bin/python3 studies/bench/equality.py --build build`.
"""
    write(arguments.output / "equality.md", text)
    print(text)
    if equal < len(rows):
        sys.exit(1)


if __name__ == "__main__":
    start(main, StatejumpError)
