#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves sheets and pipes that walk down an incline, and compares the walk with theory. All runs must finish.

    PYTHONPATH=build/python tests/ordinary/walking.py [--blocks 4 5 ...] [--friction 0.2 0.3 ...] [--kinds sheet pipe]
        [--limit 60] [--write FOLDER]

A sheet of n blocks expands away from one resting block and shrinks towards another one. Because of the weight, the two
are m blocks apart. In a cycle the sheet (length L, weight w per length, slope β) walks by m (L/n) (α ΔT - (μ cos β -
sin β) w L/EA). With infinitely many blocks m/n becomes tan β/μ. Each case is solved with default options in a separate
process with a time limit.
"""
from __future__ import annotations

import argparse
import math
import signal
import time
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import statejump as sj
from sketch import Document, Sketch
from statejump.core.errors import FailedRun
from statejump.kinds.truss.generate.document import to_toml

BLOCKS = (4, 5, 6, 7, 8, 9, 10, 12, 13, 16, 20, 21, 25, 32, 40, 50, 64, 80, 100, 128, 160, 200)
FRICTION = (0.2, 0.3, 0.342, 0.4, 0.466, 0.6)
CYCLES = 3
# Events are located within 1e-9 of a branch (reduced.event_tolerance). A block that reverses late has an error of that
# fraction of its motion and passes it to the next block, once per block, upwards and downwards.
EVENT = 1e-9


@dataclass(frozen=True)
class Walker:
    """A row of blocks on an incline; each block has an equal part of weight and friction.

    :param weight_N_per_m: weight per length of the sheet
    :param stiffness_N: Young's modulus times area
    """

    name: str
    blocks: int
    friction: float
    slope_rad: float
    length_m: float
    weight_N_per_m: float
    young_Pa: float
    area_m2: float
    expansion_per_K: float
    change_K: float
    density_kg_per_m3: float = 0.0

    @property
    def expansion(self) -> float:
        """Strain of a sheet that is free."""
        return self.expansion_per_K * self.change_K

    @property
    def lost(self) -> float:
        """Strain that friction holds back."""
        held = self.friction * math.cos(self.slope_rad) - math.sin(self.slope_rad)
        return held * self.weight_N_per_m * self.length_m / (self.young_Pa * self.area_m2)

    @property
    def _strain(self) -> float:
        """Strain of bars between both resting blocks in a cycle."""
        return max(self.expansion - self.lost, 0.0)

    @property
    def walk_m(self) -> float:
        """Walk per cycle with infinitely many blocks [m]."""
        return self.length_m * math.tan(self.slope_rad) / self.friction * self._strain

    @property
    def apart(self) -> int:
        """Number of blocks between the two resting blocks.

        A block rests if its friction balances the forces. Of the n - 1 other blocks, m more slide down than up, so the
        resting block carries the fraction n tan β/μ - m of its friction limit. The others all slide, so m has the
        parity of n - 1.
        """
        share = self.blocks * math.tan(self.slope_rad) / self.friction
        odd = (self.blocks - 1) % 2
        return 2 * round((share - odd) / 2) + odd

    @property
    def walk_of_blocks_m(self) -> float:
        """Walk per cycle [m] with this number of blocks, if every block slides during heating and during cooling."""
        return self.apart * self.length_m / self.blocks * self._strain

    def document(self) -> Document:
        """Return the case."""
        made, n = Sketch(2), self.blocks
        per_block = self.weight_N_per_m * self.length_m / n
        for k in range(n):
            made.node(f"N{k}", (k + 0.5) * self.length_m / n, 0, fixed="y")
            made.forces[f"N{k}"] = [per_block * math.sin(self.slope_rad), 0.0]
            made.add("slider", f"S{k}", nodes=[f"N{k}"], axis=[1.0, 0.0], friction_coefficient=self.friction,
                     normal_force_N=per_block * math.cos(self.slope_rad))
            if k:
                keys = {"density_kg_per_m3": self.density_kg_per_m3} if self.density_kg_per_m3 else {}
                made.bar(f"N{k - 1}", f"N{k}", "sheet", young_modulus_Pa=self.young_Pa,
                         cross_section_area_m2=self.area_m2, thermal_expansion_per_K=self.expansion_per_K, **keys)
        thermal = {"shape": "triangle", "temperature_change_max_K": self.change_K, "cycles": CYCLES, "period_s": 1.0}
        return made.document(self.name, f"sheet of {n} blocks that walks", thermal, [])


def walker(kind: str, blocks: int, friction: float) -> Walker:
    """Return a lead roof sheet (6 m long, 2.4 mm thick) or a steel pipeline (4 km). With the largest friction,
    compression reduces the pipeline's expansion by a third. Slopes are chosen so that no number of blocks is exactly in
    balance."""
    name = f"{kind}_{blocks}_{1000 * friction:.0f}"
    if kind == "sheet":
        return Walker(name, blocks, friction, 0.13, 6.0, 150.0, 1.6e10, 2.4e-3, 2.9e-5, 40.0)
    return Walker(name, blocks, friction, 0.07, 4000.0, 500.0, 2.05e11, 0.02, 1.2e-5, 80.0)


def _solve(document: Document, limit_s: float, answer: Connection) -> None:
    signal.setitimer(signal.ITIMER_PROF, limit_s)
    began = time.process_time()
    found: dict[str, Any] = {}
    try:
        path = sj.load(document).reduced().native
        ends = path.cycle_ends["displacement_m"][:, :, 0]
        found = {"walks_m": [float(walk) for walk in (ends[2:] - ends[1:-1]).mean(axis=1)],
                 "events": len(path.events), "free_m": float(abs(path.states["displacement_m"]).max())}
    except FailedRun as failed:
        found = {"sentence": str(failed)}
    answer.send(found | {"seconds": time.process_time() - began})


def solved(one: Walker, limit_s: float) -> dict[str, Any]:
    """Return the walk of every cycle except the first, or the message of the failure."""
    context = get_context("fork")
    mine, theirs = context.Pipe(False)
    process = context.Process(target=_solve, args=(one.document(), limit_s, theirs))
    process.start()
    theirs.close()
    try:
        found: dict[str, Any] = mine.recv()
    except EOFError:
        process.join()
        ended = signal.Signals(-process.exitcode).name if process.exitcode and process.exitcode < 0 else "nothing"
        found = {"sentence": f"more than {limit_s:g} s" if ended == "SIGPROF" else ended, "seconds": limit_s}
    process.join()
    return found


def row(one: Walker, found: dict[str, Any]) -> tuple[str, bool]:
    """Return the table row, and whether the structure finished and walks as theory predicts."""
    start = f"| {one.name.split('_')[0]} | {one.blocks} | {one.friction:g} |"
    if "walks_m" not in found:
        return f"{start} {found['sentence']} | | | {found['seconds']:.2f} |", False
    exact, walks = one.walk_of_blocks_m, found["walks_m"]
    expansion_m = one.expansion * one.length_m
    off_m = max(abs(walk - exact) for walk in walks)
    # Strains are added in theory but multiplied in the solver; the difference is their product.
    second_m = one.apart * one.length_m / one.blocks * one.lost * one.expansion
    # Each resting block may be off by half a block.
    good = (off_m <= 4 * one.blocks * EVENT * expansion_m + second_m
            and abs(exact - one.walk_m) <= expansion_m / one.blocks)
    return (f"{start} finished | {off_m / max(abs(exact), expansion_m / one.blocks):.1e} | "
            f"{walks[-1] / one.walk_m - 1:+.3f} | {found['seconds']:.2f} |"), good


def main() -> int:
    """Print the table; return 1 if a walk is wrong."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("--blocks", type=int, nargs="+", default=list(BLOCKS))
    given.add_argument("--friction", type=float, nargs="+", default=list(FRICTION))
    given.add_argument("--kinds", nargs="+", default=["sheet", "pipe"], choices=["sheet", "pipe"])
    given.add_argument("--limit", type=float, default=60.0, help="seconds of the processor for a case")
    given.add_argument("--write", type=Path, help="folder for the case files of what fails")
    asked = given.parse_args()
    print("| kind | blocks | friction | outcome | difference from blocks | difference from the sheet | CPU [s] |\n"
          "|---|--:|--:|---|--:|--:|--:|")
    wrong = 0
    for kind in asked.kinds:
        for blocks in asked.blocks:
            for friction in asked.friction:
                one = walker(kind, blocks, friction)
                text, good = row(one, solved(one, asked.limit))
                print(text, flush=True)
                wrong += not good
                if asked.write and not good:
                    asked.write.mkdir(parents=True, exist_ok=True)
                    (asked.write / f"{one.name}.toml").write_text(to_toml(one.document()))
    return int(bool(wrong))


if __name__ == "__main__":
    raise SystemExit(main())
