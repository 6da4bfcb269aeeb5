#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts instructions of the checks of numbers in the DEM's inner loop, and of the start of a command.

    cost_of_checks.py steps                        a step of the JointStepper with its checks and without them
    cost_of_checks.py start BEFORE AFTER           the start of the command in two builds (folders for PYTHONPATH)

callgrind counts the instructions, so other load of the machine does not matter. ``steps`` subtracts two runs, the
second twice as long. To remove the checks, the functions of checks.hpp and the check of four contacts are made to
return success. Compiler optimisation may change the count by more than the checks do. ``start`` runs ``--version`` and
``reduced table1``, with compiled bytecode as in an installation.
"""
from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PYTHON = "/usr/bin/python3"
# Flags of the plugin, without link-time optimisation.
FLAGS = ("-std=c++17", "-O3", "-DNDEBUG", "-ffp-contract=off", "-fno-math-errno", "-DEIGEN_DONT_ALIGN",
         "-DEIGEN_DONT_VECTORIZE", "-Wno-psabi", "-isystem", "/usr/include/eigen3")
QUESTIONS = {  # checks of every step by header, with the value that means success
    "checks.hpp": {"inline bool is_finite_fast(const Vector3& v)": "true", "inline bool is_below(": "true"},
    "contact_lanes.hpp": {"inline Mask are_below(": "~Mask{}"},
}
STEPS = {1: 4000, 100: 400}  # by number of joints
START = """
import sys
sys.argv = {words!r}
from statejump.cli.main import main
main()
"""


def instructions(*command: str, **environment: str) -> int:
    """Return the number of instructions of a command. :raises SystemExit: the command fails"""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", *command], text=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False,
            env={**os.environ, "PYTHONHASHSEED": "0", **environment})
    found = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or found is None:
        sys.exit(f"{' '.join(command)}: status {done.returncode}\n{done.stderr[-2000:]}")
    return int(found[1])


def without_checks(headers: Path) -> None:
    """Edit the sources so that every check of a step succeeds. :raises SystemExit: a check is not found"""
    for name, questions in QUESTIONS.items():
        file = headers / "statejump/stepper" / name
        text = file.read_text(encoding="utf-8")
        for question, yes in questions.items():
            if text.count(question) != 1:
                sys.exit(f"{name} has no {question}")
            begin = text.index("{", text.index(question))
            text = text[:begin] + f"{{ return {yes}; }}" + text[text.index("\n}", begin) + 2:]
        file.write_text(text, encoding="utf-8")


def steps(compiler: str) -> None:
    """Print instructions per joint and step, with and without checks."""
    headers = REPOSITORY / "contact_laws/stepper/include"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(headers, folder / "without")
        without_checks(folder / "without")
        for which, include in (("with", headers), ("without", folder / "without")):
            subprocess.run(
                [compiler, *FLAGS, f"-I{include}", f"-I{REPOSITORY}/contact_laws/kernel/include",
                 f"-I{REPOSITORY}/thermal/include", f"-I{REPOSITORY}/tests/cpp/stepper",
                 str(Path(__file__).with_suffix(".cpp")), "-o", str(folder / f"{which}.program")], check=True)
        print("| joints | without checks | with | more |\n|---:|---:|---:|---:|")
        for joints, count in STEPS.items():
            each = []
            for which in ("without", "with"):
                program = str(folder / f"{which}.program")
                short, long = (instructions(program, str(joints), str(n)) for n in (count, 2 * count))
                each.append((long - short) / (count * joints))
            print(f"| {joints} | {each[0]:.1f} | {each[1]:.1f} | {100 * (each[1] / each[0] - 1):+.1f} % |")


def start(builds: list[Path]) -> None:
    """Print instructions of two commands in two builds."""
    print("| command | before | after | more |\n|---|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as name:
        for words in (["--version"], ["reduced", str(REPOSITORY / "cases/table1.toml"), "--quiet", "--results", name]):
            each = []
            for place, build in enumerate(builds):
                copy = Path(name) / f"build{place}"
                if not copy.exists():
                    shutil.copytree(build, copy)
                    subprocess.run([PYTHON, "-m", "compileall", "-q", str(copy)], check=False)
                code = START.format(words=["statejump", *words])
                each.append(instructions(PYTHON, "-c", code, PYTHONPATH=str(copy), PYTHONDONTWRITEBYTECODE="1"))
            print(f"| `{words[0]}` | {each[0]:,} | {each[1]:,} | {100 * (each[1] / each[0] - 1):+.1f} % |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--compiler", default="g++")
    parts = parser.add_subparsers(dest="part", required=True)
    parts.add_parser("steps")
    parts.add_parser("start").add_argument("build", type=Path, nargs=2, metavar=("BEFORE", "AFTER"))
    options = parser.parse_args()
    if options.part == "steps":
        steps(options.compiler)
    else:
        start(options.build)


if __name__ == "__main__":
    main()
