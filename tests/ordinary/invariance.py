#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the jump does not depend on order, names, position, orientation, units and duration in a case.

    PYTHONPATH=build/python tests/ordinary/invariance.py [--count 300] [--seed 1] [--families ...] [--most-nodes 60]
        [--out FILE.csv]

The structures are of class A (``oracle.py``) and their joints all carry forces, so their paths are unique. A row has
the largest difference of jumps, over the rounding error.
"""
from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import statejump as sj
import structures
from oracle import FREE, Frame, judge, softest
from sketch import Document
from statejump.core.errors import FailedRun, StatejumpError
from transforms import TRANSFORMS, Changed

EVENT = 1e-9  # reduced.event_tolerance, of a branch
INCREMENTS = 50  # of a branch
EPSILON = float(np.finfo(float).eps)
FIELDS = ("family", "seed", "transform", "same", "failure", "changed_failure", "difference_m", "allowed_m", "jump_m",
          "largest_m", "slack_nodes")
DASHPOT = 1e-8  # stiffness of the softest dashpots of slack parts over the largest one, see System::slack_stiffness()
IDLE = 1e-6  # forces of slack parts over the largest one: those of their dashpots remain below it
ROUNDINGS = 64  # number of roundings of a length: coordinates, direction, a few bars per node


@dataclass(frozen=True)
class Solved:
    """Jumps of a solved case.

    :param jump_m: jumps [m] by node (cycles, dimension)
    :param slack: nodes whose links all carry no force in some state, so that only dashpots determine their position
    :param closes: whether one of these links carries force in another state
    :param largest_m: largest displacement on the path [m]
    :param loose: whether joints lost contact, so that statics does not determine the position of a part
    :param failure: kind of the failure, "" for none
    """

    jump_m: dict[str, np.ndarray]
    slack: frozenset[str] = frozenset()
    closes: bool = False
    largest_m: float = 0.0
    states: int = 0
    events: int = 0
    loose: bool = False
    failure: str = ""


def solved(document: Document) -> Solved:
    """Return the jumps of a case, solved with the options in its document."""
    try:
        run = sj.load(document).reduced()
    except FailedRun as failed:
        return Solved({}, failure=str(getattr(failed, "reason", type(failed).__name__)))
    except StatejumpError as refused:
        return Solved({}, failure=f"refused: {refused}")
    path = run.native
    ends = path.cycle_ends["displacement_m"][:, :, : document["truss"]["dimension"]]
    jumps = ends[1:] - ends[:1]
    loose = any(getattr(one, "code", "") == "slack" for one in run.warnings)
    idle = (force_n := np.abs(path.states["axial_force_N"])) <= IDLE * force_n.max(initial=0.0)
    return Solved({name: jumps[:, number] for number, name in enumerate(path.truss.nodes.names)},
                  slack_nodes(document, idle), bool((idle.any(axis=0) & ~idle.all(axis=0)).any()),
                  float(np.abs(path.states["displacement_m"]).max()), len(path.states["time_s"]), len(path.events),
                  loose)


def slack_nodes(document: Document, idle: np.ndarray) -> frozenset[str]:
    """Return the nodes of which all links are without force in some state.

    :param idle: which links carry no force (states, links)
    """
    alone: dict[str, np.ndarray] = {}
    for number, link in enumerate(document.get("link", ())):
        for node in link["nodes"]:
            alone[node] = alone.get(node, True) & idle[:, number]
    return frozenset(node for node, states in alone.items() if states.any())


def tolerance_m(document: Document, first: Solved, changed: Changed) -> float:
    """Return the allowed difference of jumps [m].

    Events are located to a fraction of a branch, so the slip of a joint is uncertain by this fraction of the largest
    displacement. Rounding of lengths is amplified by at most the root of the stiffness' condition number. With smooth
    laws, twice the increments change the path to second order.
    """
    frame = Frame(document)
    stiffness = frame.elastic(np.ones(len(frame.stiffness), dtype=bool)) + frame.geometric(frame.tension)
    soft = max(softest(stiffness, frame.motions(True)), FREE)
    rounding = ROUNDINGS * EPSILON * frame.size + ROUNDINGS * changed.rounding_m
    found = 2 * (first.events + 1) * EVENT * first.largest_m + rounding / np.sqrt(soft)
    return float(found if changed.exact else found + first.largest_m / INCREMENTS**2)


def slack_tolerance_m(first: Solved, node: str) -> float:
    """Return the additional tolerance of a node in a structure with slack parts [m].

    Dashpots of DASHPOT times the largest stiffness determine the position of slack parts. So the rounding of a force,
    ROUNDINGS roundings of the largest displacement times that stiffness, moves them in each state; the roundings of
    different states are independent and add as a random walk. A slack part that closes passes its position on to the
    others. One that stays slack passes on the force of its dashpots.
    """
    if not first.slack:
        return 0.0
    if node in first.slack or first.closes:
        return float(ROUNDINGS * EPSILON / DASHPOT * first.largest_m * np.sqrt(first.states))
    return DASHPOT * first.largest_m


def apart(document: Document, first: Solved, name: str, rng: np.random.Generator) -> dict[str, Any]:
    """Return a table row: difference of the jumps of the changed case from the original ones [m], and allowed
    difference."""
    changed = TRANSFORMS[name](document, rng)
    second = solved(changed.document)
    row: dict[str, Any] = {"transform": name, "failure": first.failure, "changed_failure": second.failure}
    if first.failure or second.failure:
        return row | {"same": first.failure == second.failure}
    back = changed.back(second.jump_m)
    difference = {node: float(np.abs(back[node] - jump).max()) for node, jump in first.jump_m.items()}
    tolerance = tolerance_m(document, first, changed)
    allowed = {node: tolerance + slack_tolerance_m(first, node) for node in difference}
    worst = max(difference, key=lambda node: difference[node] / allowed[node])
    largest = max(float(np.abs(jump).max()) for jump in first.jump_m.values())
    return row | {"difference_m": difference[worst], "allowed_m": allowed[worst], "jump_m": largest,
                  "largest_m": first.largest_m, "slack_nodes": len(first.slack),
                  "same": difference[worst] <= allowed[worst]}


def suitable(count: int, seed: int, families: list[str] | None = None, most_nodes: int = 10_000) -> Iterator[
        structures.Structure]:
    """Yield structures whose jump is unique."""
    number = found = 0
    chosen = families or list(structures.FAMILIES)
    while found < count:
        one = structures.make(chosen[number % len(chosen)], seed + number // len(chosen))
        number += 1
        if len(one.document["node"]) > most_nodes:
            continue
        verdict = judge(one.document)
        if verdict.kind == "path" and verdict.class_a and not verdict.slack:
            found += 1
            yield one


def rows(one: structures.Structure, names: list[str]) -> Iterator[dict[str, Any]]:
    """Yield the rows of a structure."""
    first = solved(one.document)
    for name in names:
        rng = structures.random_of(name, one.seed)
        yield {"family": one.family, "seed": one.seed, **apart(one.document, first, name, rng)}


def median(values: list[float]) -> float:
    """Return the median, 0 of none."""
    return float(np.median(values)) if values else 0.0


def table(found: list[dict[str, Any]]) -> str:
    """Return the table of differences of jumps by type of change."""
    lines = ["| change | structures | the same | largest difference over the allowed one | median | over the largest "
             "displacement | median |",
             "|---|--:|--:|--:|--:|--:|--:|"]
    for name in TRANSFORMS:
        chosen = [row for row in found if row["transform"] == name]
        over = [row["difference_m"] / row["allowed_m"] for row in chosen if "allowed_m" in row]
        share = [row["difference_m"] / row["largest_m"] for row in chosen if row.get("largest_m")]
        same = sum(row["same"] for row in chosen)
        lines.append(f"| {name} | {len(chosen)} | {same} | {max(over, default=0.0):.2g} | {median(over):.1e} | "
                     f"{max(share, default=0.0):.1e} | {median(share):.1e} |")
    return "\n".join(lines)


def main() -> int:
    """Compare structures with what they become."""
    given = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    given.add_argument("--count", type=int, default=300)
    given.add_argument("--seed", type=int, default=1)
    given.add_argument("--families", nargs="+", choices=list(structures.FAMILIES))
    given.add_argument("--most-nodes", type=int, default=10_000)
    given.add_argument("--out", type=Path, help="CSV file with a row per structure and change")
    asked = given.parse_args()
    found: list[dict[str, Any]] = []
    out = asked.out.open("w", newline="") if asked.out else None
    writer = csv.DictWriter(out, FIELDS) if out else None
    if writer:
        writer.writeheader()
    for one in suitable(asked.count, asked.seed, asked.families, asked.most_nodes):
        for row in rows(one, list(TRANSFORMS)):
            found.append(row)
            if not row["same"]:
                print(row, flush=True)
            if writer and out:
                writer.writerow(row)
                out.flush()
    if out:
        out.close()
    print(table(found))
    return int(not all(row["same"] for row in found))


if __name__ == "__main__":
    sys.exit(main())
