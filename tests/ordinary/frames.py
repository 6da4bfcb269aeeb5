#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves frames with joints, and checks that their jumps do not depend on order, names and units.

    PYTHONPATH=build/python tests/ordinary/frames.py [--count 300] [--seed 1] [--families ...] [--most-nodes 60]
        [--changes 0] [--out FILE.csv]

A frame is an ordinary structure (``structures.py``) whose bars are tubes with rigid connections. Half of the tubes have
a thermal gradient. Bars that have keys of links only stay bars. The nodes of tubes turn the parts of revolutes and
balls. Some feet rest on pads. Prints a table of the outcomes by family. Frames whose joints lose contact are not
changed: statics determines neither the position of slack parts nor the jump that they leave.
"""
from __future__ import annotations

import argparse
import csv
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from copy import deepcopy
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np

import statejump as sj
import structures
from invariance import INCREMENTS, Solved, solved
from sketch import CLEARANCE, Document
from statejump.core.errors import StatejumpError
from transforms import TRANSFORMS

THICKNESS = 0.1  # of a tube, over its outer radius
GRADIENT = 0.3  # largest difference of temperature across a tube over that of its program
KEYS = {"name", "nodes", "young_modulus_Pa", "thermal_expansion_per_K", "density_kg_per_m3", "temperature_fraction",
        "program"}
OTHERS = ("latch_hinge", "torsion_spring")  # items that turn with bars
# Newton's method ends at 1e-13 of the displacements for each of some hundred increments, and the condition number of
# slender frames, (length/radius)², multiplies the rounding of lengths.
SAME = 1e-6
FIELDS = ("family", "seed", "beams", "joints", "outcome", "seconds", "jump_m", "changed", "difference")


def frame(document: Document, rng: np.random.Generator) -> Document:
    """Return the structure with tubes in place of bars."""
    made = deepcopy(document)
    dimension, bars, made["beam"] = made["truss"]["dimension"], made.pop("link"), []
    kept = []
    for bar in bars:
        if not set(bar) <= KEYS | {"cross_section_area_m2", "poisson_ratio"}:
            kept.append(bar)
            continue
        radius = sqrt(bar["cross_section_area_m2"] / (pi * THICKNESS * (2 - THICKNESS)))
        beam = {key: value for key, value in bar.items() if key in KEYS}
        beam |= {"shape": "tube", "dimensions_m": [2 * radius, THICKNESS * radius]}
        if dimension == 3:
            beam["axis_y"] = rng.normal(size=3).tolist()
        if rng.random() < 0.5:
            beam["gradient_per_m"] = [float(rng.uniform(-GRADIENT, GRADIENT) / (2 * radius)), 0.0]
        made["beam"].append(beam)
    set_on_pads(made, rng)
    bent = {beam["name"] for beam in made["beam"]}
    for joint in (joint for section in CLEARANCE for joint in made.get(section, [])):
        for key in [key for key, value in joint.items() if key.endswith("_link") and value in bent]:
            del joint[key]
    return made | ({"link": kept} if kept else {})


def set_on_pads(made: Document, rng: np.random.Generator) -> None:
    """Put some of the feet that slide on ground on pads: a force presses the foot on its plane, which its support was
    before."""
    nodes = {node["name"]: node for node in made["node"]}
    dimension, kept = made["truss"]["dimension"], []
    for slider in made.get("slider", []):
        foot = nodes[slider["nodes"][0]]
        across = [axis for axis in foot.get("fixed", []) if not slider["axis"]["xyz".index(axis)]]
        stops = {"clearance_minus_m", "clearance_plus_m", "stop_stiffness_N_per_m", "play_m"} & set(slider)
        if len(slider["nodes"]) > 1 or not across or stops or rng.random() < 0.5:
            kept.append(slider)
            continue
        normal = np.eye(dimension)["xyz".index(across[0])]
        foot["fixed"] = [axis for axis in foot["fixed"] if axis != across[0]]
        foot["force_N"] = (foot.get("force_N", 0 * normal) - slider["normal_force_N"] * normal).tolist()
        # It sinks by a millionth of its size under its force.
        size = max(np.ptp([node["position_m"] for node in made["node"]], axis=0))
        made.setdefault("pad", []).append({
            "name": slider["name"], "nodes": slider["nodes"], "normal": normal.tolist(),
            "friction_coefficient": slider["friction_coefficient"],
            "normal_stiffness_N_per_m": max(slider["normal_force_N"], 1.0) / (1e-6 * float(size))})
    made["slider"] = kept
    if not kept:
        del made["slider"]


def frames(count: int, seed: int, families: list[str] | None = None, most_nodes: int = 60
           ) -> Iterator[tuple[structures.Structure, Document]]:
    """Yield frames together with the structures from which they are made."""
    chosen, number, found = families or list(structures.FAMILIES), 0, 0
    while found < count:
        one = structures.make(chosen[number % len(chosen)], seed + number // len(chosen))
        number += 1
        if len(one.document["node"]) > most_nodes or any(one.document.get(section) for section in OTHERS):
            continue
        made = frame(one.document, structures.random_of(f"frame_{one.family}", one.seed))
        if made["beam"]:
            found += 1
            yield one, made


def outcome(document: Document) -> tuple[str, Solved]:
    """Return the code of the failure of a frame, "" for none, and its jumps."""
    try:
        sj.load(document)
    except StatejumpError as refused:
        return str(refused.code), Solved({})
    found = solved(document)
    return found.failure, found


def difference(document: Document, first: Solved, name: str, rng: np.random.Generator) -> float:
    """Return the difference of the jumps of a changed frame, over the largest displacement."""
    changed = TRANSFORMS[name](document, rng)
    failure, second = outcome(changed.document)
    if failure:
        return float("inf")
    back = changed.back(second.jump_m)
    most = max(float(np.abs(back[node] - jump).max()) for node, jump in first.jump_m.items())
    return most / first.largest_m if first.largest_m else most


def row(one: structures.Structure, made: Document, changes: int) -> dict[str, Any]:
    """Return the row of a frame."""
    began = time.process_time()
    failure, found = outcome(made)
    seconds = time.process_time() - began
    jump = max((float(np.abs(value).max()) for value in found.jump_m.values()), default=0.0)
    worst = ("", 0.0)
    rng = structures.random_of(f"changes_{one.family}", one.seed)
    for name in [] if failure or found.loose else rng.permutation(list(TRANSFORMS))[:changes]:
        allowed = SAME if name != "finer" else INCREMENTS**-2
        share = difference(made, found, str(name), rng) / allowed
        worst = max(worst, (str(name), share), key=lambda entry: entry[1])
    return {"family": one.family, "seed": one.seed, "beams": len(made["beam"]), "joints": one.joints,
            "outcome": failure or "finished", "seconds": seconds, "jump_m": jump, "changed": worst[0],
            "difference": worst[1]}


def table(rows: list[dict[str, Any]]) -> str:
    """Return the table of outcomes by family."""
    by_family: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for one in rows:
        by_family[one["family"]].append(one)
    lines = ["| family | frames | finished | other outcomes | longest [s] | largest difference over the allowed one |",
             "|---|--:|--:|---|--:|--:|"]
    for family, of in [*sorted(by_family.items()), ("all", rows)]:
        others = Counter(one["outcome"] for one in of if one["outcome"] != "finished")
        named = ", ".join(f"{code}: {number}" for code, number in others.most_common())
        lines.append(f"| {family} | {len(of)} | {len(of) - others.total()} | {named} | "
                     f"{max(one['seconds'] for one in of):.1f} | {max(one['difference'] for one in of):.2g} |")
    return "\n".join(lines)


def main() -> int:
    """Solve frames and print their outcomes."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("--count", type=int, default=300)
    given.add_argument("--seed", type=int, default=1)
    given.add_argument("--families", nargs="+", choices=list(structures.FAMILIES))
    given.add_argument("--most-nodes", type=int, default=60)
    given.add_argument("--changes", type=int, default=0, help="how many changes of order, names, units of each")
    given.add_argument("--out", type=Path, help="CSV file with a row per frame")
    asked = given.parse_args()
    rows = []
    for one, made in frames(asked.count, asked.seed, asked.families, asked.most_nodes):
        rows.append(row(one, made, asked.changes))
        if rows[-1]["outcome"] != "finished" or rows[-1]["difference"] > 1:
            print(rows[-1], flush=True)
    if asked.out:
        with asked.out.open("w", newline="") as to:
            writer = csv.DictWriter(to, FIELDS)
            writer.writeheader()
            writer.writerows(rows)
    print(table(rows))
    return int(any(one["difference"] > 1 for one in rows))


if __name__ == "__main__":
    sys.exit(main())
