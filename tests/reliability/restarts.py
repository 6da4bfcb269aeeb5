#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks restarts: a run in YADE that is saved during contact and loaded in another process continues like the
uninterrupted run, bit for bit.

    restarts.py --python build/python [--saves N] [--steps N] [--threads N ...]

Scenes with every law, with and without the JointStepper, are saved after a random number of steps, in every format of
O.save in turn, by YADE with one thread or two, and loaded by YADE with one thread or two.
"""
from __future__ import annotations

import argparse
import itertools
import json
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
FORMATS = (".yade", ".yade.gz", ".yade.bz2", ".xml", ".xml.gz", ".xml.bz2")
OF_THEIR_OWN = ("mixed", "mixed_by_name", "mixed_partial_slip", "bored", "bored_partial_slip")  # laws
LAWS = {"normal": "normalLaw", "dissipation": "dissipationLaw", "friction": "frictionLaw",
        "tangential_velocity": "tangentialVelocity"}


def scenes_of(python: Path) -> list[tuple[str, dict[str, Any]]]:
    """Return cases and their laws: each law of the catalogue with default other laws, and Hertz and Mindlin without a
    name. A ball has no axis, so some laws are left out; mixed scenes and bores have fixed laws."""
    sys.path.insert(0, str(python))
    from statejump import _engine

    found: list[tuple[str, dict[str, Any]]] = [(case, {}) for case in ("rattling", "rolling", *OF_THEIR_OWN)]
    for kind, attribute in LAWS.items():
        for law in _engine.laws(kind):
            values = {attribute: law["name"], "restitution": 0.7}
            found.append(("rattling", values))
            if not law["needs_axis"]:
                found.append(("rolling", values))
    return found


def run_yade(python: Path, threads: int, action: str, plan: Path) -> list[Any]:
    """Run the scenes of a plan and return their digests."""
    paths = [str(python), str(HERE.parent / "yade" / "scripts")]
    done = subprocess.run(
        ["yade", "-n", "-x", f"-j{threads}", str(HERE / "restart_scenes.py"), action, str(plan)],
        stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths), "PYTHONDONTWRITEBYTECODE": "1",
             "OMP_WAIT_POLICY": "PASSIVE"},
    )
    for line in done.stdout.splitlines():
        if "RESULT {" in line:
            return list(json.loads(line[line.index("RESULT {") + len("RESULT "):])["digests"])
    raise SystemExit(f"no result of {action}, status {done.returncode}:\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")


def main() -> int:
    """Run the campaign and print the faults found; return 1 if there are any."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", type=Path, required=True)
    parser.add_argument("--saves", type=int, default=100)
    parser.add_argument("--steps", type=int, default=10_000, help="after a save")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2], help="of YADE, in any order of both")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    pairs = list(itertools.product(given.threads, repeat=2))  # of the process that saves, of the one that loads
    python, generator = given.python.resolve(), random.Random(given.seed)
    scenes = scenes_of(python)
    generator.shuffle(scenes)
    saves: list[dict[str, Any]] = []
    for number in range(given.saves):
        case, law = scenes[number % len(scenes)]
        saves.append({"case": case, "law": law, "first": generator.randrange(300, 4000), "stepper": number % 2 == 1,
                      "format": FORMATS[number % len(FORMATS)], "threads": pairs[number // 2 % len(pairs)]})
    faults = 0
    with tempfile.TemporaryDirectory(prefix="restarts-") as folder:
        for number, save in enumerate(saves):
            save["file"] = str(Path(folder) / f"{number}{save['format']}")
        for threads in pairs:
            part = [save for save in saves if save["threads"] == threads]
            if not part:
                continue
            plan = Path(folder) / "plan.json"
            plan.write_text(json.dumps({"steps": given.steps, "saves": part}))
            straight = run_yade(python, threads[0], "write", plan)
            resumed = run_yade(python, threads[1], "read", plan)
            wrong = [save for save, one, other in zip(part, straight, resumed, strict=True) if one != other]
            print(f"threads {threads[0]} and {threads[1]}: {len(part)} saves, {len(wrong)} go on otherwise", flush=True)
            for save in wrong:
                print(f"  {save}", flush=True)
            faults += len(wrong)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
