#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves random trusses without loads and joints: each must expand freely, without forces, and return.

    PYTHONPATH=build/python tests/ordinary/free_expansion.py [--count 1000] [--seed 1] [--limit 60] [--write FOLDER]

Six supports in space, or three in a plane, hold a truss without hindering uniform expansion. A redundant truss has
uniform expansion coefficient and temperature. Bars of a determinate truss have individual coefficients, temperatures
and programs; each bar must have its free length.
"""
from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import Delaunay

import dress
import evolution
import programs
import statejump as sj
import structures
from oracle import FREE, Frame, softest
from sketch import Document, Sketch
from statejump.core.errors import StatejumpError
from statejump.kinds.truss.generate.document import to_toml

Random = np.random.Generator
EPSILON = float(np.finfo(float).eps)
# Number of roundings of a length: coordinates, displacements, direction, a few bars at a node.
ROUNDINGS = 64
MOST = 500  # members
# Largest rotation of a bar [rad]. A determinate truss with unequal expansions changes its shape, and beyond this
# rotation it may become a mechanism without a path.
ROTATION = 0.05
STANDING = ("warren", "pratt", "k_truss", "tower", "ring", "boom", "mast", "grid", "ring_truss")


@dataclass(frozen=True)
class Truss:
    """A truss without loads and joints.

    :param redundant: degree of static indeterminacy
    :param conditioning: smallest singular value of its equilibrium matrix
    """

    seed: int
    shape: str
    document: Document
    redundant: int
    conditioning: float

    @property
    def members(self) -> int:
        """How many bars it has."""
        return len(self.document["link"])

    @property
    def group(self) -> str:
        """Plane or space, determinate or not."""
        return (f"{'planar' if self.document['truss']['dimension'] == 2 else 'spatial'}, "
                f"{'redundant' if self.redundant else 'determinate'}")


def grown(rng: Random, dimension: int, members: int) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """Return a determinate truss. Each new node has as many bars as dimensions, none nearly in the plane of the other
    bars. Some trusses are long, some compact."""
    recent = int(rng.choice([dimension + 1, 8, 10_000]))
    places = [np.zeros(dimension)]
    bars: list[tuple[int, int]] = []
    while len(bars) < members:
        known = min(len(places), dimension)
        feet = rng.choice(np.arange(max(0, len(places) - recent), len(places)), known, replace=False)
        place = np.mean([places[foot] for foot in feet], axis=0) + rng.normal(0, 1, dimension)
        arms = np.array([place - places[foot] for foot in feet])
        lengths = np.linalg.norm(arms, axis=1)
        if lengths.min() < 0.3 or lengths.max() > 3.0:
            continue
        if np.linalg.svd(arms / lengths[:, None], compute_uv=False)[-1] < 0.3 and known > 1:
            continue
        if bars and len(bars) + known > members:
            break
        bars += [(int(foot), len(places)) for foot in feet]
        places.append(place)
    return np.array(places), bars


def meshed(rng: Random, dimension: int, members: int) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """Return the edges of triangles or tetrahedra between random points."""
    per_node = 3 if dimension == 2 else 7
    points = rng.uniform(0, 1, (max(dimension + 2, members // per_node), dimension)) * rng.uniform(0.3, 8, dimension)
    cells = np.sort(Delaunay(points).simplices, axis=1)
    pairs = [cells[:, [i, j]] for i in range(dimension + 1) for j in range(i)]
    edges = np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)
    return points, [(int(one), int(two)) for one, two in edges]


def standing(rng: Random, shape: str, members: int) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """Return an engineering shape without its supports."""
    made = structures.SHAPES[shape](rng, int(np.clip(members / (4 if shape in ("warren", "pratt") else 9), 3, 40)))
    number = {name: place for place, name in enumerate(made.points)}
    return (np.array(list(made.points.values())),
            [(number[bar.ends[0]], number[bar.ends[1]]) for bar in made.bars.values()])


def mounted(places: np.ndarray, bars: list[tuple[int, int]]) -> Sketch:
    """Return a structure with statically determinate supports: one node is fixed, the farthest from it is held across
    their line, and in space a third across the plane of the three."""
    dimension = places.shape[1]
    first = places - places[0]
    second = int(np.linalg.norm(first, axis=1).argmax())
    frame = [first[second] / np.linalg.norm(first[second])]
    held = {0: "xyz"[:dimension], second: "yz"[: dimension - 1]}
    if dimension == 3:
        off = first - np.outer(first @ frame[0], frame[0])
        third = int(np.linalg.norm(off, axis=1).argmax())
        if len(places) > 2:
            frame.append(off[third] / np.linalg.norm(off[third]))
            held[third] = "z"
    # Directions that are left are across those.
    basis = np.linalg.qr(np.array([*frame, *np.eye(dimension)]).T)[0].T[:dimension]
    turned = first @ basis.T
    made = Sketch(dimension)
    for number, place in enumerate(turned):
        if number in held:  # exactly in the directions that supports leave
            place = np.where([axis in held[number] for axis in "xyz"[:dimension]], 0.0, place)
        made.node(f"N{number}", *place, fixed=held.get(number, ""))
    for one, two in bars:
        made.bar(f"N{one}", f"N{two}")
    return made


def heated(made: Sketch, rng: Random, uniform: bool) -> tuple[Document, list[Document]]:
    """Assign sections and materials to the bars; return the programs."""
    thermal = programs.program(rng)
    if rng.random() < 0.03:
        thermal = programs.table("plateau", 0.0, 60.0, 1)
    material = dress.MATERIALS[str(rng.choice(list(dress.MATERIALS)))]
    others = [] if uniform or rng.random() < 0.7 else [programs.of_others(rng, thermal)]
    area = float(10 ** rng.uniform(-6, -2))
    for bar in made.bars.values():
        chosen = material if uniform else dress.MATERIALS[str(rng.choice(list(dress.MATERIALS)))]
        bar.keys |= {"young_modulus_Pa": chosen.young_Pa, "cross_section_area_m2": area * float(rng.uniform(0.5, 2)),
                     "thermal_expansion_per_K": chosen.expansion_per_K}
        if not uniform:
            bar.keys["temperature_fraction"] = float(rng.uniform(0, 1))
            if others and rng.random() < 0.3:
                bar.keys["program"] = "shade"
    return thermal, others


def truss(seed: int) -> Truss | None:
    """Return the truss of a seed; None if its shape is (nearly) a mechanism or heating changes it too much."""
    rng = structures.random_of("free_expansion", seed)
    shape = str(rng.choice(["grown", "meshed", *STANDING], p=[0.35, 0.35, *[0.3 / len(STANDING)] * len(STANDING)]))
    members = int(round(10 ** rng.uniform(0, np.log10(MOST))))
    if shape in STANDING:
        places, bars = standing(rng, shape, members)
    else:
        places, bars = (grown if shape == "grown" else meshed)(rng, int(rng.integers(2, 4)), members)
    if len(bars) > MOST:
        return None
    made = mounted(places, bars)
    supports = sum(len(held) for held in made.fixed.values())
    redundant = len(bars) + supports - places.size
    thermal, others = heated(made, rng, uniform=redundant > 0 or rng.random() < 0.3)
    document = made.document(f"free_{seed}", f"free expansion, {shape}", thermal, others)
    frame = Frame(document)
    basis = frame.motions(True)
    if not basis.shape[1] or softest(frame.elastic(np.ones(len(bars), dtype=bool)), basis) < FREE:
        return None
    rows = frame.rows @ basis
    if redundant == 0 and _rotation(frame, basis, rows) > ROTATION:
        return None
    return Truss(seed, shape, document, redundant, float(np.linalg.svd(rows, compute_uv=False)[basis.shape[1] - 1]))


def _rotation(frame: Frame, basis: np.ndarray, rows: np.ndarray) -> float:
    """Return the largest bar rotation [rad] in a determinate truss, at the extremes of its temperature programs."""
    stretched = -np.array(frame.thermal_tensions()) / frame.stiffness
    moved = (basis @ np.linalg.lstsq(rows, stretched.T, rcond=None)[0]).T.reshape(len(stretched), *frame.x.shape)
    ends = np.array([ends for ends, _ in frame.directions])
    return float((np.linalg.norm(np.diff(moved[:, ends], axis=2)[:, :, 0], axis=2) / frame.lengths).max())


def trusses(count: int, seed: int) -> Iterator[Truss]:
    """Yield so many trusses."""
    found = 0
    while found < count:
        one = truss(seed)
        seed += 1
        if one is not None:
            found += 1
            yield one


def _allowed(one: Truss, path: Any) -> tuple[float, float]:
    """Return the allowed rounding errors of bar forces [N] and bar lengths [m].

    Rounding of coordinates changes lengths and thereby bar forces. The inverse of the equilibrium matrix converts nodal
    residuals to bar forces, which strain bars of other stiffness.
    """
    links, places = path.truss.links, path.truss.nodes.position_m
    stiffness = links.young_modulus_Pa * links.cross_section_area_m2 / links.stress_free_length_m
    size = float(np.ptp(places, axis=0).max()) + float(np.abs(path.states["displacement_m"]).max())
    enlarged = np.sqrt(places.size) / min(one.conditioning, 1.0)
    force = ROUNDINGS * EPSILON * size * float(stiffness.max()) * enlarged
    return force, force / float(stiffness.min()) + ROUNDINGS * EPSILON * size


def _strains(one: Truss, path: Any) -> np.ndarray:
    """Return the free strains of bars (states, bars) from the programs."""
    common = one.document["thermal"]
    period = common["table_time_s"][-1] if common["shape"] == "table" else common["period_s"]
    named = {None: common, **{other["name"]: other for other in one.document.get("program", ())}}
    changes = {name: evolution.changes_K(program, path.states["time_s"] % period, period)
               for name, program in named.items()}
    return np.array([link["thermal_expansion_per_K"] * link.get("temperature_fraction", 1.0)
                     * changes[link.get("program")] for link in one.document["link"]]).T


def _over_rounding(one: Truss, path: Any) -> dict[str, float]:
    """Return, over their rounding errors: forces, lengths, jump, and displacement under uniform expansion. Forces are
    relative to that of a bar of fixed length, the jump to the expansion of the truss."""
    states, links, places = path.states, path.truss.links, path.truss.nodes.position_m
    force_N, length_m = _allowed(one, path)
    # From lengths to displacements, the equilibrium matrix enters once more.
    moved_m = length_m * np.sqrt(places.size) / min(one.conditioning, 1.0)
    moved, ends = states["displacement_m"], path.cycle_ends["displacement_m"]
    lengths = np.linalg.norm(np.diff((places + moved)[:, links.nodes], axis=2)[:, :, 0], axis=2)
    force, jump = np.abs(states["axial_force_N"]).max(), np.abs(ends[1:] - ends[:1]).max()
    strain = _strains(one, path)
    held = (np.abs(strain).max(axis=0) * links.young_modulus_Pa * links.cross_section_area_m2).max()
    motion = np.abs(strain).max() * np.ptp(places, axis=0).max()
    found = {
        "forces": force / force_N, "jump": jump / moved_m,
        "lengths": np.abs(lengths - links.stress_free_length_m * (1 + strain)).max() / length_m,
        "force_share": force / held if held else 0.0, "jump_share": jump / motion if motion else 0.0,
    }
    if np.ptp(strain, axis=1).max() == 0:
        found["displacements"] = np.abs(moved - strain[:, :1, None] * places).max() / moved_m
    return {key: float(value) for key, value in found.items()}


def checked(one: Truss) -> dict[str, Any]:
    """Return the results of a truss, and its faults as text ("" for none)."""
    began = time.process_time()
    try:
        path = sj.load(one.document).reduced().native
    except StatejumpError as failed:
        return {"wrong": str(failed), "seconds": time.process_time() - began}
    seconds = time.process_time() - began
    found = _over_rounding(one, path)
    beyond = [f"{key} {found[key]:.1e} of rounding" for key in ("forces", "lengths", "jump", "displacements")
              if found.get(key, 0.0) > 1]
    if len(path.events) or not path.complete:
        beyond.append("events, or not complete")
    return found | {"wrong": "; ".join(beyond), "seconds": seconds}


def main() -> int:
    """Print the table and the faults; return 1 if there are any faults."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("--count", type=int, default=1000)
    given.add_argument("--seed", type=int, default=1)
    given.add_argument("--limit", type=float, default=60.0, help="seconds of the processor for a truss")
    given.add_argument("--write", type=Path, help="folder for the case files of what is wrong")
    asked = given.parse_args()
    rows: dict[str, list[tuple[Truss, dict[str, Any]]]] = {}
    for one in trusses(asked.count, asked.seed):
        found = checked(one)
        rows.setdefault(one.group, []).append((one, found))
        if found["seconds"] > asked.limit:
            found["wrong"] += f"; more than {asked.limit:g} s"
        if found["wrong"]:
            print(f"{one.document['case']['name']} ({one.shape}, {one.members} members, "
                  f"{one.document['thermal']['shape']}): {found['wrong']}", flush=True)
            if asked.write:
                asked.write.mkdir(parents=True, exist_ok=True)
                (asked.write / f"{one.document['case']['name']}.toml").write_text(to_toml(one.document))
    print("| trusses | number | members | exact | largest force over that of a held bar | largest jump over the "
          "expansion | of rounding | CPU [s] |\n|---|--:|--:|--:|--:|--:|--:|--:|")
    for group in sorted(rows):
        print(_row(group, rows[group]))
    return int(any(found["wrong"] for group in rows.values() for _, found in group))


def _row(group: str, rows: list[tuple[Truss, dict[str, Any]]]) -> str:
    """Return the row of a group."""
    members = [one.members for one, _ in rows]

    def worst(*keys: str) -> float:
        return max(found.get(key, 0.0) for _, found in rows for key in keys)

    exact = sum(not found["wrong"] for _, found in rows)
    return (f"| {group} | {len(rows)} | {min(members)} to {max(members)} | {exact} | {worst('force_share'):.1e} | "
            f"{worst('jump_share'):.1e} | {worst('forces', 'lengths', 'jump', 'displacements'):.2g} | "
            f"{sum(found['seconds'] for _, found in rows):.0f} |")


if __name__ == "__main__":
    raise SystemExit(main())
