#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Time and memory of condensed bodies by their size and number.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/bodies.py

A body is a ladder of beams, condensed to the nodes of its rails. It stands on a foot, expands against a spring, and its
last node slides with friction. A body of six dofs is a bar between two nodes of three dofs. Prints a table: bodies,
dofs of the interface of each, linear solves, CPU seconds of a path of one cycle (median of three), largest memory of
the process.
"""
from __future__ import annotations

import resource
import statistics
import time
from typing import Any

import numpy as np

import statejump as sj
from statejump.bodies.body import CondensedBody, from_arrays

SIZES = ((1, 6), (1, 60), (1, 600), (100, 6), (100, 60))
YOUNG_PA, AREA_M2, MOMENT_M4, EXPANSION_PER_K, BAY_M = 70e9, 6e-4, 4.5e-8, 2e-5, 0.5


def beam_stiffness(length_m: float) -> np.ndarray:
    """Return the stiffness (12, 12) of a beam along x with equal moments and half the torsional rigidity."""
    found = np.zeros((12, 12))
    axial, bending = YOUNG_PA * AREA_M2 / length_m, YOUNG_PA * MOMENT_M4 / length_m**3
    for first, stiffness in ((0, axial), (3, 0.4 * YOUNG_PA * MOMENT_M4 / length_m)):
        at = [first, first + 6]
        found[np.ix_(at, at)] += stiffness * np.array([[1, -1], [-1, 1]])
    for (move, turn), sign in (((1, 5), 1.0), ((2, 4), -1.0)):
        at, a = [move, turn, move + 6, turn + 6], sign * length_m
        found[np.ix_(at, at)] += bending * np.array(
            [[12, 6 * a, -12, 6 * a], [6 * a, 4 * a * a, -6 * a, 2 * a * a],
             [-12, -6 * a, 12, -6 * a], [6 * a, 2 * a * a, -6 * a, 4 * a * a]])
    return found


def row(nodes: int) -> CondensedBody:
    """Return a straight row of beams along x; all of its nodes are interface nodes."""
    stiffness = np.zeros((6 * nodes, 6 * nodes))
    for first in range(nodes - 1):
        at = slice(6 * first, 6 * first + 12)
        stiffness[at, at] += beam_stiffness(BAY_M)
    positions = np.zeros((nodes, 3))
    positions[:, 0] = BAY_M * np.arange(nodes)
    shape = np.hstack((EXPANSION_PER_K * positions, 0 * positions)).ravel()
    return from_arrays([f"n{k}" for k in range(nodes)], positions, stiffness, pattern_names=["uniform"],
                       free_shapes=shape[None])


def bar() -> CondensedBody:
    """Return a bar along x between two nodes of three dofs."""
    along = np.array([-1.0, 0, 0, 1, 0, 0])
    return from_arrays(["n0", "n1"], [[0, 0, 0], [BAY_M, 0, 0]], YOUNG_PA * AREA_M2 / BAY_M * np.outer(along, along),
                       node_freedoms=[3, 3], pattern_names=["uniform"],
                       free_shapes=[EXPANSION_PER_K * BAY_M * np.array([0.0, 0, 0, 1, 0, 0])])


def case(bodies: int, dofs: int) -> Any:
    """Return parallel bodies, each on a foot of its own with a slider at its far end."""
    count = max(2, dofs // 6)
    content = bar() if dofs == 6 else row(count)
    nodes: list[dict[str, Any]] = []
    parts: dict[str, list[dict[str, Any]]] = {"body": [], "slider": [], "spring": []}
    for number in range(bodies):
        names = [f"b{number}_{k}" for k in range(count)]
        for k, name in enumerate(names):
            foot: dict[str, Any] = {"fixed": ["x", "y", "z"]} if k == 0 else {}
            foot |= {"fixed_rotations": ["x", "y", "z"]} if k == 0 and dofs > 6 else {}
            end = {"fixed": ["y", "z"]} if k == count - 1 else {}
            nodes.append({"name": name, "position_m": [BAY_M * k, float(number), 0.0], **foot, **end})
        nodes.append({"name": f"w{number}", "position_m": [BAY_M * count, float(number), 0.0],
                      "fixed": ["x", "y", "z"]})
        parts["body"].append({"name": f"b{number}", "nodes": names, "content": content,
                              "position_m": [0.0, float(number), 0.0]})
        parts["slider"].append({"name": f"s{number}", "nodes": [names[-1]], "axis": [1.0, 0.0, 0.0],
                                "friction_coefficient": 0.2, "normal_force_N": 500.0 + number})
        parts["spring"].append({"name": f"k{number}", "nodes": [names[-1], f"w{number}"], "stiffness_N_per_m": 1e6})
    return sj.load({"case": {"name": "bodies", "kind": "truss"}, "truss": {"dimension": 3}, "node": nodes, **parts,
                    "thermal": {"shape": "triangle", "temperature_change_max_K": 80.0, "cycles": 1, "period_s": 1.0}})


def main() -> None:
    """Print the table."""
    print("| bodies | interface dofs | solves | CPU seconds | largest memory so far [MB] |\n|--:|--:|--:|--:|--:|")
    for bodies, dofs in SIZES:
        made = case(bodies, dofs)
        seconds = []
        for _ in range(3):
            began = time.process_time()
            run = sj.load(made.origin.document).reduced()
            seconds.append(time.process_time() - began)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(f"| {bodies} | {dofs} | {run.summary['solves']:.0f} | {statistics.median(seconds):.2f} | {memory:.0f} |",
              flush=True)


if __name__ == "__main__":
    main()
