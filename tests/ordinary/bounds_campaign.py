#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares bounds of many ordinary structures with the rest states after random temperature histories.

    PYTHONPATH=build/python tests/ordinary/bounds_campaign.py [--count 100] [--seed 1] [--histories 7] [--families ...]
        [--classes A B C] [--limit 60] [--out rows.csv]

Family and seed determine a structure and its histories. ``--count`` structures of each class are compared. A state
outside of a bound plus its margin is printed, and the exit status is 1. The table has, by class, the structures, their
histories, the states outside, and the medians of reached/bound and simulated/bound.
"""
from __future__ import annotations

import argparse
import csv
import signal
import sys
from collections import Counter
from collections.abc import Iterator
from copy import deepcopy
from typing import Any

import numpy as np

import statejump as sj
import structures
from statejump.core.errors import StatejumpError
from statejump.kinds.truss.bounds.result import Bounds
from statejump.kinds.truss.bounds.study import bounds
from statejump.kinds.truss.solve import solve

FIELDS = ("family", "seed", "class", "quality", "output", "spread_m", "margin_m", "reached_m", "simulated_m", "states",
          "outside")
LEGS = 5  # temperatures of each member in a history
ROUNDING = 1e-6  # of the spread
LEAST_m = 1e-13
Row = dict[str, Any]


def history(document: dict[str, Any], rng: np.random.Generator, most_K: float) -> dict[str, Any]:
    """Return a case in which every member has a random temperature history of its own that returns to zero."""
    made, time = deepcopy(document), np.linspace(0, 1, LEGS + 2).tolist()
    made["thermal"] = {"shape": "table", "table_time_s": time, "table_temperature_change_K": [0.0] * len(time)}
    made["program"] = []
    for section in ("link", "beam"):
        for number, member in enumerate(made.get(section, [])):
            member["program"] = f"{section}{number}"
            changes = [0.0, *rng.uniform(-most_K, most_K, LEGS), 0.0]
            made["program"].append({"name": member["program"], "shape": "table", "table_time_s": time,
                                    "table_temperature_change_K": changes})
    return made


def rest_states(document: dict[str, Any], rng: np.random.Generator, histories: int) -> np.ndarray:
    """Return displacements (states, nodes, 3) at the start and at the ends of histories that have a path."""
    found = []
    for _ in range(histories):
        case = sj.load(history(document, rng, float(10 ** rng.uniform(0.5, 2.5))))
        try:
            found.append(solve(case).states["displacement_m"][[0, -1]])
        except StatejumpError:
            continue
    return np.concatenate(found) if found else np.zeros((0, 0, 3))


def rows_of(family: str, seed: int, found: Bounds, states: np.ndarray) -> Iterator[Row]:
    """Yield a row for each output."""
    for bound in found.bounds:
        values = bound.output.vector(states)
        changes = np.linalg.norm(values[:, None] - values[None], axis=-1) if len(states) else np.zeros((1, 1))
        margin = 0.0 if np.isnan(bound.margin) else bound.margin
        most = bound.spread * (1 + ROUNDING) + margin + LEAST_m
        yield {"family": family, "seed": seed, "class": found.letter, "quality": found.quality,
               "output": bound.output.name, "spread_m": bound.spread, "margin_m": margin, "reached_m": bound.reached,
               "simulated_m": float(changes.max()), "states": len(states),
               "outside": int((changes > most).any() and np.isfinite(most))}


class Expired(Exception):
    """A structure takes too long."""


def _expire(*_: object) -> None:
    raise Expired


def compared(arguments: argparse.Namespace, reasons: Counter[str]) -> Iterator[Row]:
    """Yield rows until every class has its number of structures."""
    signal.signal(signal.SIGALRM, _expire)
    missing = dict.fromkeys(arguments.classes, arguments.count)
    for seed in range(arguments.seed, arguments.seed + arguments.most):
        for family in arguments.families:
            if not any(missing.values()):
                return
            signal.alarm(arguments.limit)
            try:
                document = structures.make(family, seed).document
                found = bounds(sj.load(document), simulate=False)
                if not missing.get(found.letter) or not found.bounds:
                    continue
                rng = np.random.default_rng([seed, 7])
                states = rest_states(document, rng, arguments.histories)
            except StatejumpError as refused:
                reasons[getattr(refused, "code", "") or str(refused)] += 1
                continue
            except Expired:
                reasons["limit of time"] += 1
                continue
            finally:
                signal.alarm(0)
            missing[found.letter] -= 1
            yield from rows_of(family, seed, found, states)


def table(rows: list[Row]) -> str:
    """Return the results by class."""
    lines = ["| class | quality | structures | states | outside | reached/bound, median | simulated/bound, median |",
             "|---|---|---|---|---|---|---|"]
    for letter, quality in sorted({(row["class"], row["quality"]) for row in rows}):
        ours = [row for row in rows
                if (row["class"], row["quality"]) == (letter, quality) and LEAST_m < row["spread_m"] < np.inf]
        if not ours:
            continue
        structures_ = {(row["family"], row["seed"]): row["states"] for row in ours}
        ratios = [np.nanmedian([row[key] / row["spread_m"] for row in ours]) for key in ("reached_m", "simulated_m")]
        lines.append(f"| {letter} | {quality} | {len(structures_)} | {sum(structures_.values())} | "
                     f"{sum(row['outside'] for row in ours)} | {ratios[0]:.4f} | {ratios[1]:.4f} |")
    return "\n".join(lines)


def main() -> int:
    """Compare the structures of the arguments."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--most", type=int, default=1000, help="seeds of each family that are tried")
    parser.add_argument("--histories", type=int, default=7)
    parser.add_argument("--families", nargs="+", default=list(structures.SHAPES))
    parser.add_argument("--classes", nargs="+", default=["A", "B", "C"])
    parser.add_argument("--limit", type=int, default=60, help="of a structure [s]")
    parser.add_argument("--out", default="")
    arguments = parser.parse_args()
    rows, reasons = [], Counter[str]()
    for row in compared(arguments, reasons):
        rows.append(row)
        if row["outside"]:
            print("outside:", row, flush=True)
    print(table(rows))
    print("not compared:", ", ".join(f"{number} × {reason}" for reason, number in reasons.most_common(12)))
    if arguments.out:
        with open(arguments.out, "w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, FIELDS)
            writer.writeheader()
            writer.writerows(rows)
    return int(any(row["outside"] and row["quality"] != "estimate" for row in rows))


if __name__ == "__main__":
    sys.exit(main())
