#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cost of a contact per step: joints of this project beside spheres of YADE, LAMMPS and LIGGGHTS.

    /usr/bin/python3 studies/bench/peers.py --build build

Every program computes the same n contacts with the material, load and time step of studies/bench/yade_joints.py, on one
thread, in a new process per run. A measured time is the processor time of a run minus that of a run that ends after the
warm-up. ``lammps_bore`` corresponds to joints under expansion: n spheres in one bore, all radii updated in every step.
``bare_loop`` (studies/bench/stepper) runs only the joint kernel in a loop, which gives a lower bound of the cost. A
program that is not installed is reported and omitted. Exit status 2 with a message if a run fails.
"""
from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from math import pi
from pathlib import Path
from statistics import median
from typing import Any

from pairs import (
    BEARING_RADIUS, CLEARANCE, EFFECTIVE_MODULUS, EXPANSION_BEARING, EXPANSION_JOURNAL, FRICTION, INCLINATION,
    JOINT_RADIUS, LOAD, MASS, POISSON, RADIUS, SEARCHED, SPACING, TIME_STEP, YOUNG, depth, places,
)
from run import REPOSITORY, BenchError, parse, publish, run_yade, start

STEPS = {1: 1_000_000, 100: 50_000, 10_000: 300}  # of one run, by number of contacts
STEPPER_STEPS = {**STEPS, 10_000: 3000}  # three times the number of its steps between two steps of YADE's loop
SUBSTEPS = 1000
WARM_UP = 300
NAME = {
    "joint_stepper": "joint under expansion, `JointStepper`",
    "bare_loop": "the same kernel in a bare loop",
    "joint": "joint under expansion, YADE's loop",
    "sphere": "YADE's spheres",
    "lammps_bore": "LAMMPS, sphere in a bore, both radii new in every step",
    "lammps_sphere": "LAMMPS' spheres",
    "liggghts_sphere": "LIGGGHTS' spheres",
}
PAIRS = (("joint_stepper", "bare_loop"), ("joint_stepper", "joint"), ("joint_stepper", "lammps_bore"),
         ("joint", "lammps_bore"), ("sphere", "lammps_sphere"))
# Largest allowed ratio of the cost of the JointStepper to that of another scene in the same run, and its meaning.
GOALS = (
    ("joint", 1, 120 / 1666, "120 ns where YADE's loop takes 1666"),
    ("joint", 100, 60 / 180, "60 ns where YADE's loop takes 180"),
    ("joint", 10_000, 60 / 368, "60 ns where YADE's loop takes 368"),
    ("joint", 10_000, 30 / 368, "four at once: 30 ns where YADE's loop takes 368"),
    ("lammps_bore", 100, 0.6, "0.6 of LAMMPS, the same work"),
    ("lammps_bore", 10_000, 0.7, "0.7 of LAMMPS, the same work"),
)
COLUMNS = ("scene", "contacts", "repetition", "steps", "cpu_time_per_contact_and_step_ns")

DENSITY = MASS / (4 / 3 * pi * RADIUS**3)


@dataclass
class Deck:
    """Input file of LAMMPS or LIGGGHTS: command lines, and bodies (type, x, y, z)."""

    program: str
    lines: list[str]
    atoms: list[tuple[int, float, float, float]]
    granular: bool = False  # LIGGGHTS: its own order of columns

    def write(self, folder: Path, steps: int) -> Path:
        """Write bodies and commands; return the file of the commands."""
        low = [min(atom[i] for atom in self.atoms) - SPACING for i in (1, 2, 3)]
        high = [max(atom[i] for atom in self.atoms) + SPACING for i in (1, 2, 3)]
        box = "".join(f"{a} {b} {n}lo {n}hi\n" for a, b, n in zip(low, high, "xyz"))
        bodies = "".join(f"{i} {kind} {2 * RADIUS} {DENSITY} {x} {y} {z}\n"
                         for i, (kind, x, y, z) in enumerate(self.atoms, 1))
        (folder / "bodies").write_text(f"spheres\n\n{len(self.atoms)} atoms\n2 atom types\n\n{box}\nAtoms\n\n{bodies}")
        file = folder / "commands"
        file.write_text("\n".join([*self.lines, "thermo 100000000", f"timestep {TIME_STEP}", f"run {WARM_UP}",
                                   *([f"run {steps}"] if steps else []), ""]))
        return file


HEAD = ("newton off", f"neighbor {SEARCHED} bin", "neigh_modify delay 0 every 1 check yes")


def pairs(size: int) -> list[tuple[int, float, float, float]]:
    """Return a pair of a fixed and a free sphere at each position of a cubic grid, as bodies of a deck."""
    offset = 2 * RADIUS - depth(RADIUS / 2)
    return [atom for x, y, z in places(size) for atom in ((1, x, y, z), (2, x + offset, y, z))]


def lammps(style: str, atoms: list[tuple[int, float, float, float]], more: list[str]) -> Deck:
    """Return a deck for LAMMPS with Hertz' law F = K_n sqrt(R d) d and Mindlin's tangential spring K_t = 8 G*."""
    normal, tangential = 4 / 3 * EFFECTIVE_MODULUS, 8 * YOUNG / (4 * (1 + POISSON) * (2 - POISSON))
    law = f"{normal} {tangential} 0.0 0.0 {FRICTION} 0"
    return Deck("lmp", [
        "units si", f"atom_style {style}", "boundary f f f", "comm_modify vel yes", HEAD[0], "read_data bodies",
        *HEAD[1:],
        f"pair_style gran/hertz/history {law}", "pair_coeff * *", *(line.replace("LAW", law) for line in more),
    ], atoms)


def lammps_sphere(size: int) -> Deck:
    push = f"fix push free addforce {-LOAD} {INCLINATION * LOAD} 0.0"
    return lammps("sphere", pairs(size), ["group free type 2", "fix move free nve", push, "fix rub free viscous 5.0"])


def lammps_bore(size: int) -> Deck:
    x = CLEARANCE + depth(JOINT_RADIUS)
    return lammps("sphere 1", [(1, x, 0.0, i * SPACING) for i in range(size)], [
        "variable heat equal 1e-10*step",
        f"variable diameter equal {2 * RADIUS}*(1+{EXPANSION_JOURNAL}*v_heat)",
        f"variable bore equal {BEARING_RADIUS}*(1+{EXPANSION_BEARING}*v_heat)",
        f"region bore cylinder z 0 0 v_bore -1 {size * SPACING + 1} side in",
        "fix move all nve",
        "fix wall all wall/gran/region hertz/history LAW region bore",
        "fix grow all adapt 1 atom diameter v_diameter",
        f"fix push all addforce {LOAD} {INCLINATION * LOAD} 0.0",
        "fix rub all viscous 5.0",
    ])


def liggghts_sphere(size: int) -> Deck:
    both = "{0} {0}".format
    four = "2 {0} {0} {0} {0}".format
    return Deck("liggghts", [
        "units si", "atom_style granular", "boundary f f f", "communicate single vel yes", HEAD[0], "read_data bodies",
        *HEAD[1:], "hard_particles yes",
        f"fix m1 all property/global youngsModulus peratomtype {both(YOUNG)}",
        f"fix m2 all property/global poissonsRatio peratomtype {both(POISSON)}",
        f"fix m3 all property/global coefficientRestitution peratomtypepair {four(0.9)}",
        f"fix m4 all property/global coefficientFriction peratomtypepair {four(FRICTION)}",
        "pair_style gran model hertz tangential history", "pair_coeff * *", "group free type 2", "fix move free nve",
        f"fix push free addforce {-LOAD} {INCLINATION * LOAD} 0.0",
    ], pairs(size))


DECKS = {"lammps_sphere": lammps_sphere, "lammps_bore": lammps_bore, "liggghts_sphere": liggghts_sphere}


def processor_time(deck: Deck, steps: int) -> float:
    """Processor time of the whole process [s]."""
    with tempfile.TemporaryDirectory(prefix="statejump-run-") as folder:
        file = deck.write(Path(folder), steps)
        process = subprocess.Popen(
            [deck.program, "-in", str(file), "-log", "none"], cwd=folder, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"},
        )
        assert process.stdout is not None
        said = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0 or f"with {len(deck.atoms)} atoms" not in said:
            errors = [line for line in said.splitlines() if line.startswith("ERROR")]
            raise BenchError(f"{deck.program}: {(errors or said.splitlines() or ['no output'])[-1]}")
        return usage.ru_utime + usage.ru_stime


def bare_loop(build: Path) -> Path:
    """Program of the bare loop."""
    return build / "bench" / "stepper" / "stepper_bench"


def steps_of(scene: str, size: int) -> int:
    """Steps of one run."""
    return (STEPPER_STEPS if scene == "joint_stepper" else STEPS)[size]


def cost(build: Path, scene: str, size: int) -> float:
    """Return the processor time of a contact per step [ns]."""
    steps = steps_of(scene, size)
    if scene == "bare_loop":
        done = subprocess.run(
            [bare_loop(build), f"--benchmark_filter=^bare_loop/{size}$", "--benchmark_format=json"],
            stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise BenchError(f"stepper_bench: {(done.stderr.splitlines() or ['no output'])[-1]}")
        return float(json.loads(done.stdout)["benchmarks"][0]["ns_per_joint_and_step"])
    if scene in DECKS:
        deck = DECKS[scene](size)
        return (processor_time(deck, steps) - processor_time(deck, 0)) / steps / size * 1e9
    report = run_yade(build, scene, size, 1, steps=steps, substeps=SUBSTEPS)
    return float(report["cpu_time_s"]) / report["steps"] / size * 1e9


def costs(rows: list[dict[str, Any]], scene: str, size: int) -> list[float]:
    """Of every repetition [ns]."""
    return [row[COLUMNS[-1]] for row in rows if row["scene"] == scene and row["contacts"] == size]


def ratios(rows: list[dict[str, Any]], first: str, second: str, size: int) -> list[float]:
    """Of runs of the same repetition, sorted."""
    return sorted(a / b for a, b in zip(costs(rows, first, size), costs(rows, second, size)))


def goals(rows: list[dict[str, Any]], scenes: list[str]) -> str:
    """Return the goals of the JointStepper, and whether it reaches them."""
    lines = ["| `JointStepper` / | contacts | to reach | | measured: median (lowest to highest) | met |",
             "|---|--:|--:|---|--:|---|"]
    for second, size, most, meaning in GOALS:
        if second in scenes:
            found = ratios(rows, "joint_stepper", second, size)
            lines.append(f"| {NAME[second]} | {size} | {most:.3f} | {meaning} | **{median(found):.3f}** "
                         f"({found[0]:.3f} to {found[-1]:.3f}) | {'yes' if median(found) <= most else 'no'} |")
    return "\n".join(lines)


def table(rows: list[dict[str, Any]], scenes: list[str]) -> str:
    lines = ["| CPU time per contact and step [ns] | " + " | ".join(f"{size} contacts" for size in STEPS) + " |",
             "|---|" + "--:|" * len(STEPS)]
    for scene in scenes:
        cells = [f"{median(costs(rows, scene, size)):.0f}" for size in STEPS]
        lines.append(f"| {NAME[scene]} | {' | '.join(cells)} |")
    lines += ["", "| ratio of neighbouring runs: median (lowest to highest) | "
              + " | ".join(f"{size} contacts" for size in STEPS) + " |", "|---|" + "--:|" * len(STEPS)]
    for first, second in PAIRS:
        if first in scenes and second in scenes:
            cells = []
            for size in STEPS:
                found = ratios(rows, first, second, size)
                cells.append(f"**{median(found):.2f}** ({found[0]:.2f} to {found[-1]:.2f})")
            lines.append(f"| {NAME[first]} / {NAME[second]} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build", help="build folder")
    options = parse(parser, 5)
    missing = sorted({program for program in ("lmp", "liggghts") if shutil.which(program) is None})
    scenes = [scene for scene in NAME if scene not in DECKS or DECKS[scene](1).program not in missing]
    left_out = "".join(f"\n`{program}` is not installed: its scenes are left out.\n" for program in missing)
    if not bare_loop(options.build.resolve()).exists():
        scenes.remove("bare_loop")
        left_out += "\n`stepper_bench` is not built (`STATEJUMP_BUILD_BENCH`): the bare loop is left out.\n"
    rows: list[dict[str, Any]] = []
    for repetition in range(1, options.repetitions + 1):
        for size in STEPS:
            for scene in scenes:
                rows.append(dict(zip(COLUMNS, (scene, size, repetition, steps_of(scene, size),
                                               round(cost(options.build.resolve(), scene, size), 2)))))
        print(f"repetition {repetition} of {options.repetitions} done", flush=True)
    load, processors = os.getloadavg()[2], os.cpu_count()
    publish(options.output, "peers", COLUMNS, rows, f"""# Cost of a contact and step beside other programs

n contacts have Hertz's normal force and Mindlin's spring under Coulomb's limit. Material, load, step and search for
neighbours are the same in each program. Numbers are medians of {options.repetitions} repetitions in turn, on one
thread. LAMMPS and LIGGGHTS are Debian's. In a bore, LAMMPS has one wall for all spheres, and one contact of a
sphere with it.
The load average of the machine was {load:.0f} on {processors} processors at the end of the measurement. Where it
exceeds their number, programs share caches and cores. Compare ratios then, not nanoseconds.

{table(rows, scenes)}

YADE's loop makes one step in {SUBSTEPS}, the default of the `JointStepper`. The cost includes this step and the copies
to and from the arrays of the `JointStepper`. Goals were set in nanoseconds on another machine. Here they are ratios to
the cost of the same scene in the same run.

{goals(rows, scenes)}
{left_out}
Again: `PYTHONPATH=build/python /usr/bin/python3 studies/bench/peers.py --build build`
(Debian's packages `lammps`, `liggghts`).
""")


if __name__ == "__main__":
    start(main)
