#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares quasi-static solver, truss dynamics and DEM for redundant structures whose pins have play.

    PYTHONPATH=build/python tests/ordinary/slack.py [--only pratt_3 ...] [--models solver motion dem] [--write FOLDER]

Some bars end in pins with clearance, and the structure is stiff without these bars. A slack bar carries no force and
its position is undetermined; in both dynamic models dashpots in the pins bring it to rest. For each structure and model
the table has the differences from the quasi-static solver for all bars that carry force, and the eccentricity of pins
with play, over the clearance.
"""
from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import dress
import statejump as sj
import structures
from oracle import Frame
from sketch import Document, Sketch
from statejump.core.errors import StatejumpError
from statejump.core.run import Run
from statejump.kinds.truss.generate.document import to_toml
from statejump.kinds.truss.scales import COMPARED, scales

# Family, seed and number of bays of the structures, planar ones first.
CHOSEN = [
    ("pratt", 3, 2), ("pratt", 5, 2), ("pratt", 10, 3), ("tower", 1, 2), ("tower", 3, 2), ("tower", 4, 3),
    ("bracket", 5, 3), ("bracket", 11, 3), ("bracket", 13, 3), ("ring", 1, 5), ("tripod", 1, 3), ("tripod", 7, 3),
    ("tripod", 13, 3), ("boom", 1, 1),
    ("boom", 3, 1), ("boom", 4, 2), ("boom", 5, 2), ("mast", 1, 1), ("mast", 2, 2), ("grid", 4, 2),
]
PERIOD_S = 2.0
MOST_PINNED = 2  # bars with play
# Fraction of the program within which damping in the pins stops a swinging bar.
REST = 0.01
# Smallest eigenvalue of the stiffness without the bars with play, over the largest. Periods are then at most a hundred
# times that of a bar, and thousands of times shorter than the program.
STIFF = 1e-4
# Tolerance for parts that carry force, as in cases.
TOLERANCE = 0.01
# Largest eccentricity of a pin without contact over its clearance; the excess is rounding when a contact opens.
PLAY = 1.001


@dataclass(frozen=True)
class Agreement:
    """Differences of a model from the quasi-static solver.

    :param displacement: largest rms difference of a node that carries force, over the largest displacement
    :param jump: largest difference of the jumps of these nodes, over the largest displacement
    :param force: largest rms difference of an axial force, over the largest axial force
    :param play: largest eccentricity of a pin without contact, over its clearance; NaN: always in contact
    :param slack: fraction of the samples in which some pin has no contact
    """

    displacement: float
    jump: float
    force: float
    play: float
    slack: float

    @property
    def agrees(self) -> bool:
        """Whether all is within the tolerances."""
        return max(self.displacement, self.jump, self.force) <= TOLERANCE and not self.play > PLAY


def stiff(made: Sketch, without: list[str]) -> bool:
    """Return whether a shape is clearly stiff without the given bars."""
    kept = Sketch(made.dimension, made.points, made.fixed, made.guides,
                  {name: bar for name, bar in made.bars.items() if name not in without})
    heat = {"shape": "triangle", "temperature_change_max_K": 1.0, "period_s": 1.0}
    frame = Frame(kept.document("stiff", "", heat, []))
    basis = frame.motions(False)
    values = np.linalg.eigvalsh(basis.T @ frame.elastic(np.ones(len(frame.stiffness), dtype=bool)) @ basis)
    return bool(values[0] > STIFF * values[-1])


def document(family: str, seed: int, bays: int) -> Document:
    """Return the case of a redundant structure with play in many bars: as many as can be removed without leaving a
    mechanism."""
    rng = structures.random_of(f"slack_{family}", seed)
    made = structures.SHAPES[family](rng, bays)
    dress.materials(made, rng)
    pinned: list[str] = []
    for bar in map(str, rng.permutation([*made.bars])):
        if len(pinned) < MOST_PINNED and stiff(made, [*pinned, bar]):
            pinned.append(bar)
    if rng.random() < 0.6:
        weight_N = dress.weight_N(made) * float(rng.uniform(0.2, 2))
        made.forces[made.tips[-1]] = np.round(np.array(made.down) * weight_N, 3)
    thermal = {"shape": str(rng.choice(["triangle", "half_sine"])), "cycles": 1, "period_s": PERIOD_S,
               "temperature_change_max_K": float(np.round(rng.uniform(10, 60), 1)) * (1 if rng.random() < 0.7 else -1)}
    place = dress.Joiner(made, rng, 0.0)
    for bar in pinned:
        for side in ((0, 1) if rng.random() < 0.4 else (int(rng.integers(2)),)):
            place.pin(bar, side)
    found = made.document(f"slack_{family}_{seed}", f"{family} with play", thermal, [])
    if not made.joints():
        raise ValueError(f"{family} {seed} has no redundant bar that ends in pins")
    keys = {bar: made.bars[bar].keys for bar in pinned}
    moments = [made.length(bar) ** 3 / 3 * keys[bar]["cross_section_area_m2"] * keys[bar]["density_kg_per_m3"]
               for bar in pinned]  # of inertia about an end
    return found | {
        "output": {"samples_per_cycle": 200}, "reduced": {"sticking": "elastic"}, "motion": {"masses": "lumped"},
        "dem": {"time_step_fraction": 0.5, "link_damping_ratio": 0.3,
                "pin_damping_N_m_s_per_rad": float(f"{max(moments) / (REST * PERIOD_S):.2g}")},
    }


def pins(run: Run) -> list[tuple[str, str, np.ndarray, np.ndarray]]:
    """Return for every pin: the node at the end of its bar, its name, its eccentricity over the clearance at every
    sample, and which samples have no contact."""
    found, case = [], run.definition
    for section, node, before in (("revolute", "journal_node", ""), ("ball_joint", "ball_node", "ball_")):
        for number, joint in enumerate(getattr(case, section)):
            offset = np.linalg.norm(run[f"{before}eccentricity_m"][:, number], axis=-1)
            free = run[f"{before}normal_force_N"][:, number] == 0
            found.append((getattr(joint, node), joint.name, offset / joint.radial_clearance_m, free))
    return found


def agreement(exact: Run, other: Run) -> Agreement:
    """Return the differences of a run from that of the solver."""
    case, exact = exact.definition, exact.at(other.time_s)
    ends = {node for node, *_ in pins(other)}
    carries = np.array([node.name not in ends for node in case.node])
    ours, theirs = (run["displacement_m"][:, carries] for run in (exact, other))
    forces = [run.links["axial_force_N"].values for run in (exact, other)]
    scale = scales(case.resolve(), exact["displacement_m"])
    largest = max(float(np.linalg.norm(ours, axis=2).max()), COMPARED * scale.motion_m)
    apart = np.linalg.norm(theirs - ours, axis=2)
    jumps = (theirs[-1] - theirs[0]) - (ours[-1] - ours[0])
    free = np.array([one for *_, one in pins(other)])
    offsets = np.array([offset for *_, offset, _ in pins(other)])
    return Agreement(
        float(np.sqrt((apart**2).mean(axis=0)).max()) / largest, float(np.linalg.norm(jumps, axis=1).max()) / largest,
        float(np.sqrt(((forces[1] - forces[0]) ** 2).mean(axis=0)).max())
        / max(float(np.abs(forces[0]).max()), COMPARED * scale.force_N),
        float(offsets[free].max(initial=-np.inf)) if free.any() else float("nan"), float(free.any(axis=0).mean()))


def models(case: Any) -> dict[str, Callable[[], Run]]:
    """Return how each model is run."""
    return {"solver": case.reduced, "motion": lambda: case.reduced(dynamic=True), "dem": case.dem}


def rows(case: Any, chosen: list[str]) -> Iterator[tuple[str, str]]:
    """Yield a table row for each model, and the fault of the model ("" for none)."""
    exact: Run | None = None
    joints = case.definition.resolve().number_of_joints()
    for model in chosen:
        start = f"| {case.name.removeprefix('slack_')} | {len(case.definition.link)} | {joints} | {model} |"
        began = time.process_time() + children_s()
        try:
            run = models(case)[model]()
        except StatejumpError as failed:
            yield f"{start} {failed} |", str(failed)
            continue
        exact = run if exact is None else exact
        found, took = agreement(exact, run), time.process_time() + children_s() - began
        yield (f"{start} {found.displacement:.1e} | {found.jump:.1e} | {found.force:.1e} | {found.play:.4f} | "
               f"{found.slack:.2f} | {took:.1f} |"), "" if found.agrees else "beyond a tolerance"


def children_s() -> float:
    """Return the CPU time of ended child processes [s]."""
    return os.times().children_user + os.times().children_system


def main() -> int:
    """Print the table; return 1 if a tolerance is exceeded."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("--only", nargs="+", help="names of structures, as pratt_3")
    given.add_argument("--models", nargs="+", default=["solver", "motion", "dem"], choices=["solver", "motion", "dem"],
                       help="the first is what others are compared with")
    given.add_argument("--write", type=Path, help="folder for the case files")
    options = given.parse_args()
    print("| structure | bars | pins | model | displacement | jump | force | play | slack | CPU [s] |\n"
          "|---|--:|--:|---|--:|--:|--:|--:|--:|--:|")
    beyond = 0
    for family, seed, bays in CHOSEN:
        if options.only and f"{family}_{seed}" not in options.only:
            continue
        made = document(family, seed, bays)
        if options.write:
            options.write.mkdir(parents=True, exist_ok=True)
            (options.write / f"{family}_{seed}.toml").write_text(to_toml(made))
        for row, wrong in rows(sj.load(made), options.models):
            print(row, flush=True)
            beyond += bool(wrong)
    return 1 if beyond else 0


if __name__ == "__main__":
    raise SystemExit(main())
