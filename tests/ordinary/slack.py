#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Redundant structures whose pins have play: quasi-static solver, motion and DEM side by side.

    PYTHONPATH=build/python tests/ordinary/slack.py [--only pratt_3 ...] [--models solver motion dem] [--write FOLDER]

Some bars end in pins with clearance, and the structure is stiff without them. While such a bar hangs in its play it
carries nothing and its position is undetermined; dashpots in the pins bring it to rest in motion and in the DEM. The
table gives, for each structure and model, the differences from the quasi-static solver of all that carries force, and
how far the pins with play are from the middle of their bearings, over their clearance.
"""
from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import dress
import planar
import spatial
import statejump as sj
import structures
from oracle import Frame
from sketch import Document, Sketch
from statejump.core.errors import StatejumpError
from statejump.core.run import Run
from statejump.kinds.truss.scales import COMPARED, scales

# Family, seed and bays of the structures; planar ones first.
CHOSEN = [
    ("pratt", 3, 2), ("pratt", 5, 2), ("pratt", 10, 3), ("tower", 1, 2), ("tower", 3, 2), ("tower", 4, 3), ("bracket", 5, 3),
    ("bracket", 11, 3), ("bracket", 13, 3), ("ring", 1, 5), ("tripod", 1, 3), ("tripod", 7, 3), ("tripod", 13, 3),
    ("boom", 1, 1), ("boom", 3, 1), ("boom", 4, 2), ("boom", 5, 2), ("mast", 1, 1), ("mast", 2, 2), ("grid", 4, 2),
]
PERIOD_S = 2.0
MOST_PINNED = 2  # bars with play
# Pins bring a bar that swings to rest in this fraction of the program.
REST = 0.01
# Eigenvalues of the stiffness without the bars with play, over the largest: their periods are a hundred times that of a
# bar at most, thousands of times shorter than the program.
STIFF = 1e-4
# What carries force: as the tolerances of a case.
TOLERANCE = 0.01
# Of the clearance, where a pin has no contact: but for the rounding of a contact that just parts.
PLAY = 1.001


@dataclass(frozen=True)
class Agreement:
    """What a model differs from the solver by.

    :param displacement: largest rms difference of a node that carries force, over the largest displacement
    :param jump: largest difference of their jumps, over the largest displacement
    :param force: largest rms difference of axial forces, over the largest
    :param play: largest eccentricity of a pin without contact over its clearance; NaN: always in contact
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
    """Return whether a shape is stiff without some of its bars, and not only nearly a mechanism."""
    kept = Sketch(made.dimension, made.points, made.fixed, made.guides,
                  {name: bar for name, bar in made.bars.items() if name not in without})
    frame = Frame(kept.document("stiff", "", {"shape": "triangle", "temperature_change_max_K": 1.0, "period_s": 1.0}, []))
    basis = frame.motions(False)
    values = np.linalg.eigvalsh(basis.T @ frame.elastic(np.ones(len(frame.stiffness), dtype=bool)) @ basis)
    return bool(values[0] > STIFF * values[-1])


def document(family: str, seed: int, bays: int) -> Document:
    """Return the case of a redundant structure: bars with play are as many as keep it stiff without them."""
    rng = structures.random_of(f"slack_{family}", seed)
    made = structures.SHAPES[family](rng, bays)
    dress.materials(made, rng)
    pinned: list[str] = []
    for bar in map(str, rng.permutation([*made.bars])):
        if len(pinned) < MOST_PINNED and stiff(made, [*pinned, bar]):
            pinned.append(bar)
    if rng.random() < 0.6:
        made.forces[made.tips[-1]] = np.round(np.array(made.down) * dress.weight_N(made) * float(rng.uniform(0.2, 2)), 3)
    thermal = {"shape": str(rng.choice(["triangle", "half_sine"])), "cycles": 1, "period_s": PERIOD_S,
               "temperature_change_max_K": float(np.round(rng.uniform(10, 60), 1)) * (1 if rng.random() < 0.7 else -1)}
    place = dress.Joiner(made, rng, 0.0)
    for bar in pinned:
        for side in ((0, 1) if rng.random() < 0.4 else (int(rng.integers(2)),)):
            place.pin(bar, side)
    found = made.document(f"slack_{family}_{seed}", f"{family} with play", thermal, [])
    if not made.joints():
        raise ValueError(f"{family} {seed} has no redundant bar that ends in pins")
    masses = [made.length(bar) ** 3 * made.bars[bar].keys["cross_section_area_m2"] * made.bars[bar].keys["density_kg_per_m3"]
              for bar in pinned]
    return found | {
        "output": {"samples_per_cycle": 200}, "reduced": {"sticking": "elastic"}, "motion": {"masses": "lumped"},
        "dem": {"time_step_fraction": 0.5, "link_damping_ratio": 0.3,
                "pin_damping_N_m_s_per_rad": float(f"{max(masses) / 3 / (REST * PERIOD_S):.2g}")},
    }


def pins(run: Run) -> list[tuple[str, str, np.ndarray, np.ndarray]]:
    """Return of every pin the node at the end of its bar, its name, its eccentricity over its clearance at every
    sample, and where it has no contact."""
    found, case = [], run.definition
    for section, node, before in (("revolute", "journal_node", ""), ("ball_joint", "ball_node", "ball_")):
        for number, joint in enumerate(getattr(case, section)):
            offset = np.linalg.norm(run[f"{before}eccentricity_m"][:, number], axis=-1)
            free = run[f"{before}normal_force_N"][:, number] == 0
            found.append((getattr(joint, node), joint.name, offset / joint.radial_clearance_m, free))
    return found


def agreement(exact: Run, other: Run) -> Agreement:
    """Return what a run differs from the solver's by."""
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


def main() -> None:
    """Print the table."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("--only", nargs="+", help="names of structures, as pratt_3")
    given.add_argument("--models", nargs="+", default=["solver", "motion", "dem"])
    given.add_argument("--write", type=Path, help="folder for the case files")
    options = given.parse_args()
    print("| structure | bars | pins | model | displacement | jump | force | play | slack | CPU [s] |\n|---|--:|--:|---|--:|--:|--:|--:|--:|--:|")
    for family, seed, bays in CHOSEN:
        name = f"{family}_{seed}"
        if options.only and name not in options.only:
            continue
        made = document(family, seed, bays)
        if options.write:
            from statejump.kinds.truss.generate.document import to_toml
            options.write.mkdir(parents=True, exist_ok=True)
            (options.write / f"{name}.toml").write_text(to_toml(made))
        loaded = sj.load(made)
        case = loaded.definition
        runs: dict[str, Run] = {}
        for model in options.models:
            began = time.perf_counter()
            try:
                runs[model] = {"solver": loaded.reduced, "motion": lambda: loaded.reduced(dynamic=True), "dem": loaded.dem}[model]()
            except StatejumpError as failed:
                print(f"| {name} | {len(case.link)} | {case.resolve().number_of_joints()} | {model} | {failed} |", flush=True)
                continue
            if "solver" not in runs:
                continue
            f = agreement(runs["solver"], runs[model])
            print(f"| {name} | {len(case.link)} | {case.resolve().number_of_joints()} | {model} | {f.displacement:.1e} | {f.jump:.1e} "
                  f"| {f.force:.1e} | {f.play:.4f} | {f.slack:.2f} | {time.perf_counter() - began:.1f} |", flush=True)


if __name__ == "__main__":
    main()
